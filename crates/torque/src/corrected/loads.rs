//! The effects as loads on a simulated arm: dry friction, smooth torques, and contacts.

use arm::JointKind;
use effects::{Circumstance, Contact, State};

use super::{Corrected, acts};
use crate::model::Workspace;

impl Corrected {
    /// Viscous friction of each joint (N m s/rad or N s/m).
    pub fn viscous(&self) -> Vec<f64> {
        let mut coefficients = vec![0.0; self.machine.arm.dof()];
        for smooth in &self.machine.smooth {
            if let Some(coefficient) = smooth.viscous {
                coefficients[smooth.joint] += coefficient;
            }
        }
        coefficients
    }

    /// The loads on the joints of a simulated [`Self::arm`] at `time` (s) in addition to gravity and inertia, in two
    /// parts (N m or N): `dry` is the level of dry friction, and `opposing` the torque of all other effects except
    /// viscous friction, to be subtracted from the drives' torque. `q` are the encoders' positions; `qdd` is needed
    /// for couplings and loads only, and may be that of the previous step.
    ///
    /// Friction that differs by direction is a level and an offset, also at rest. Torque scale and torque limit are
    /// properties of the drive and not included.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    #[expect(clippy::too_many_arguments, reason = "a motion, its time, scratch and two results")]
    pub fn joint_loads(
        &self,
        time: f64,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        dry: &mut [f64],
        opposing: &mut [f64],
    ) {
        let needs_rigid =
            !self.machine.contacts.is_empty() || self.machine.dry.iter().any(|(_, dry)| dry.depends_on_load());
        if needs_rigid {
            // `dry` contains the rigid torque until it is no longer needed.
            self.rigid_torque(Some(time), workspace, State { q, qd, qdd }, dry);
            workspace.rigid.copy_from_slice(dry);
        }
        dry.fill(0.0);
        opposing.fill(0.0);
        for (joint, law) in &self.machine.dry {
            let at = Circumstance {
                time: Some(time),
                load: if needs_rigid { self.gear_load(*joint, &workspace.rigid, qdd) } else { 0.0 },
            };
            dry[*joint] += law.level(qd[*joint], at);
            opposing[*joint] += law.bias();
        }
        for smooth in &self.machine.smooth {
            if smooth.viscous.is_none() && acts(smooth.onset, Some(time)) {
                opposing[smooth.joint] += smooth.torque(State { q, qd, qdd });
            }
        }
        self.add_contacts(Some(time), workspace, opposing);
    }

    /// Adds the torques −Jᵀ F of the contacts at `time`; the workspace contains the true positions.
    pub(super) fn add_contacts(&self, time: Option<f64>, workspace: &mut Workspace, tau: &mut [f64]) {
        let Some(time) = time else { return };
        let lasts = |contact: &&Contact| contact.start <= time && time < contact.end;
        for contact in self.machine.contacts.iter().filter(lasts) {
            let Workspace { arm: scratch, input, .. } = &mut *workspace;
            let scratch = scratch.get_or_insert_with(|| arm::Workspace::new(&self.machine.arm));
            self.machine.arm.forward_kinematics(scratch, &input[..tau.len()]);
            let tool = scratch.base_from_frame(&self.tool).translation;
            for (i, (joint, tau)) in self.machine.arm.joints().iter().zip(tau.iter_mut()).enumerate() {
                let base_from_link = scratch.base_from_link(i);
                let axis = base_from_link.rotation * joint.axis;
                *tau -= match joint.kind {
                    JointKind::Revolute => axis.cross(&(tool - base_from_link.translation)).dot(&contact.force),
                    JointKind::Prismatic => axis.dot(&contact.force),
                };
            }
        }
    }
}
