//! Arms that differ from the one in the URDF: in gravity, masses, drives, or by a payload.

use nalgebra::{Rotation3, Unit, Vector3};

use crate::inertia::Inertia;
use crate::joint::Joint;
use crate::model::Arm;

impl Arm {
    /// This arm with another gravity (m/s², base frame).
    pub fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.gravity = gravity;
        self
    }

    /// This arm on a base that is turned by `angle` (rad) about `axis` (in the base's frame, of any length but zero).
    /// In the base's frame, gravity turns in the opposite direction: g' = R(axis, angle)ᵀ g.
    ///
    /// # Panics
    /// If the axis has zero length.
    pub fn with_turned_base(mut self, axis: Vector3<f64>, angle: f64) -> Self {
        let axis = Unit::try_new(axis, 0.0).expect("an axis has a length");
        let world_from_base = Rotation3::from_axis_angle(&axis, angle);
        self.gravity = world_from_base.inverse_transform_vector(&self.gravity);
        self
    }

    /// This arm on a base that turns about its x axis, and on that about its y axis: joints 0 and 1 of the result, whose links have no mass.
    /// The shapes of the URDF are left out.
    pub fn on_turning_base(&self) -> Self {
        let turning = [Vector3::x(), Vector3::y()].map(|axis| Joint::without_link(&self.base_link, axis));
        let frames = self.frames.iter().cloned().map(|mut frame| {
            frame.link = Some(frame.link.map_or(1, |link| link + 2));
            frame
        });
        Self {
            frames: frames.collect(),
            joints: turning.into_iter().chain(self.joints.iter().cloned()).collect(),
            visuals: Vec::new(),
            ..self.clone()
        }
    }

    /// This arm with reflected rotor inertias (kg m² or kg), one per joint.
    ///
    /// # Panics
    /// If there is not one value per joint.
    pub fn with_rotor_inertias(mut self, rotor_inertias: &[f64]) -> Self {
        assert_eq!(rotor_inertias.len(), self.dof(), "one rotor inertia per joint");
        for (joint, &inertia) in self.joints.iter_mut().zip(rotor_inertias) {
            joint.rotor_inertia = inertia;
        }
        self
    }

    /// The arm with every link's mass and inertia tensor multiplied by `factor` and unchanged centres of mass: the
    /// model error of the paper (section IV.A) at 1.2.
    pub fn with_scaled_inertias(mut self, factor: f64) -> Self {
        for link in 0..self.dof() {
            self = self.with_scaled_link(link, factor);
        }
        self
    }

    /// The arm with the mass and inertia tensor of moving link `link` (from 0) multiplied by `factor` and unchanged
    /// centre of mass.
    ///
    /// # Panics
    /// If there is no such link.
    pub fn with_scaled_link(mut self, link: usize, factor: f64) -> Self {
        let mut body = self.joints[link].inertia;
        body.mass *= factor;
        body.tensor *= factor;
        self.joints[link].set_inertia(body);
        self
    }

    /// The arm with `inertias` as the bodies of its moving links, base to tip.
    ///
    /// # Panics
    /// If there is not one body per joint.
    pub fn with_inertias(mut self, inertias: &[Inertia]) -> Self {
        assert_eq!(inertias.len(), self.dof(), "one body a joint");
        for (joint, inertia) in self.joints.iter_mut().zip(inertias) {
            joint.set_inertia(*inertia);
        }
        self
    }

    /// The arm with `body` (in the link's frame) as moving link `link` (from 0).
    ///
    /// # Panics
    /// If there is no such link.
    pub fn with_link_inertia(mut self, link: usize, body: Inertia) -> Self {
        self.joints[link].set_inertia(body);
        self
    }

    /// The arm with `payload` fixed to its tool: mass (kg), centre of mass (m) and inertia tensor about it (kg m²) in
    /// the frame of [`Self::tool_frame`].
    pub fn with_payload(mut self, payload: &Inertia) -> Self {
        let tool = self.tool_frame();
        let last = self.dof() - 1;
        let body = self.joints[last].inertia.merged(&payload.transformed(&tool.link_from_frame));
        self.joints[last].set_inertia(body);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Workspace;
    use nalgebra::Matrix3;

    /// A vertical axis whose link has its centre of mass 0.5 m from the axis, and a tool that is turned by a right
    /// angle about z.
    const ARM: &str = r#"<robot name="a"><link name="base"/>
<joint name="j" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/></joint>
<link name="l"><inertial><origin xyz=".5 0 0"/><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
<joint name="f" type="fixed"><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/><parent link="l"/><child link="tool"/></joint>
<link name="tool"/></robot>"#;

    fn holding(arm: &Arm) -> f64 {
        let mut tau = [0.0];
        arm.gravity_torque(&mut Workspace::new(arm), &[0.0], &mut tau);
        tau[0]
    }

    #[test]
    fn a_payload_is_given_in_the_tools_frame() {
        let arm = Arm::from_urdf_text(ARM, "a.urdf").expect("it is an arm");
        // The tool's y axis is the link's −x axis: 0.2 m along it puts the payload at 0.8 m.
        let payload = Inertia {
            mass: 3.0,
            com: Vector3::new(0.0, 0.2, 0.0),
            tensor: Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03)),
        };
        let loaded = arm.clone().with_payload(&payload);
        assert!((holding(&arm) + 9.81 * 2.0 * 0.5).abs() < 1e-12);
        assert!((holding(&loaded) + 9.81 * (2.0 * 0.5 + 3.0 * 0.8)).abs() < 1e-12);
        // A rotation about the link's y axis is one about the tool's x axis.
        let about_origin = loaded.joints()[0].inertia.tensor_about_origin()[(1, 1)];
        assert!((about_origin - (0.1 + 2.0 * 0.25 + 0.01 + 3.0 * 0.64)).abs() < 1e-12);
    }

    /// A joint of the base that is held at an angle is a turned base, and its torque is that of the arm's weight about it.
    #[test]
    fn a_turning_base_holds_the_arm() {
        let arm = Arm::from_urdf_text(ARM, "a.urdf").expect("it is an arm");
        let turning = arm.on_turning_base();
        let mut tau = [0.0; 3];
        turning.gravity_torque(&mut Workspace::new(&turning), &[0.2, 0.3, 0.0], &mut tau);
        // The joint of the base turns about the y axis after the one about the x axis, and the arm's joint about the same axis.
        assert!((tau[1] - tau[2]).abs() < 1e-12);
        let turned = arm.with_turned_base(Vector3::x(), 0.2).with_turned_base(Vector3::y(), 0.3);
        assert!((tau[2] - holding(&turned)).abs() < 1e-12, "{} {}", tau[2], holding(&turned));
    }

    #[test]
    fn a_turned_base_turns_gravity_the_other_way() {
        let arm = Arm::from_urdf_text(ARM, "a.urdf").expect("it is an arm");
        // Turned by +30° about x, the base's y axis points upwards by 30°, and gravity has a component along −y.
        let turned = arm.with_turned_base(Vector3::new(2.0, 0.0, 0.0), std::f64::consts::FRAC_PI_6);
        let expected = 9.81 * Vector3::new(0.0, -0.5, -(0.75_f64).sqrt());
        assert!((turned.gravity() - expected).norm() < 1e-12);
    }

    #[test]
    fn one_link_scales_alone() {
        let arm = Arm::from_urdf_text(ARM, "a.urdf").expect("it is an arm");
        assert!((holding(&arm.clone().with_scaled_link(0, 1.5)) - 1.5 * holding(&arm)).abs() < 1e-12);
    }
}
