//! Poses of the links and the geometric Jacobian.

use nalgebra::Matrix6xX;

use crate::joint::JointKind;
use crate::model::{Arm, Frame};
use crate::pose::Pose;
use crate::workspace::Workspace;

impl Arm {
    /// Computes the pose of every link in the base frame at `q`; [`Workspace::base_from_link`] returns them.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn forward_kinematics(&self, workspace: &mut Workspace, q: &[f64]) {
        workspace.check(self, &[q]);
        let mut base_from_parent = Pose::identity();
        for (i, joint) in self.joints.iter().enumerate() {
            base_from_parent = base_from_parent.compose(&joint.parent_from_link(q[i]));
            workspace.base_from_link[i] = base_from_parent;
        }
    }

    /// The geometric Jacobian of the origin of `frame` at `q`, in the base's axes: 6 × dof, angular rows first (rad/s,
    /// then m/s, per unit of q̇). The poses of the links are in the workspace afterwards.
    ///
    /// In Pinocchio it is the `LOCAL_WORLD_ALIGNED` Jacobian with the two halves exchanged.
    ///
    /// # Panics
    /// If a slice, the workspace or `jacobian` is of another size than the arm.
    pub fn jacobian(&self, workspace: &mut Workspace, q: &[f64], frame: &Frame, jacobian: &mut Matrix6xX<f64>) {
        self.forward_kinematics(workspace, q);
        assert_eq!(jacobian.ncols(), self.dof(), "one column per joint");
        jacobian.fill(0.0);
        let Some(link) = frame.link else { return };
        let point = workspace.base_from_link[link].transform_point(&frame.link_from_frame.translation);
        for (i, joint) in self.joints.iter().enumerate().take(link + 1) {
            let base_from_link = &workspace.base_from_link[i];
            let axis = base_from_link.rotation * joint.axis;
            let mut column = jacobian.column_mut(i);
            match joint.kind {
                JointKind::Revolute => {
                    let arm = point - base_from_link.translation;
                    column.fixed_rows_mut::<3>(0).copy_from(&axis);
                    column.fixed_rows_mut::<3>(3).copy_from(&axis.cross(&arm));
                }
                JointKind::Prismatic => column.fixed_rows_mut::<3>(3).copy_from(&axis),
            }
        }
    }
}

impl Workspace {
    /// The pose of moving link `link` in the base frame, after [`Arm::forward_kinematics`] or [`Arm::jacobian`].
    pub fn base_from_link(&self, link: usize) -> &Pose {
        &self.base_from_link[link]
    }

    /// The pose of `frame` in the base frame, after [`Arm::forward_kinematics`] or [`Arm::jacobian`].
    pub fn base_from_frame(&self, frame: &Frame) -> Pose {
        frame.link.map_or(frame.link_from_frame, |link| self.base_from_link[link].compose(&frame.link_from_frame))
    }
}
