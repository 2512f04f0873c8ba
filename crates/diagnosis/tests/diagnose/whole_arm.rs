//! What acts on the whole arm and is not in the catalogue, or differs in the held-out recordings, is named as nothing else.

use crate::support::{
    ELBOW, Injected, Motion, SHOULDER, baseline_friction, diagnosed, effects_on, motion, named, sentences, start, trio,
};
use arm::{Arm, Vector3, Workspace};
use diagnosis::{Diagnosis, Unexplained, Verdict};
use effects::Regressor;
use nalgebra::Matrix6xX;

/// Diagnoses an arm on which only plain friction has a name, and checks that a residual on some joint depends on `on`.
fn check(injected: Injected<'_>, on: Regressor) -> Diagnosis {
    let diagnosis = diagnosed(&trio(), &trio(), injected, Vec::new());
    assert_eq!(named(&diagnosis), [], "{:?}", sentences(&diagnosis));
    let open = &diagnosis.report.unexplained;
    let first = |open: &Unexplained| open.depends_on.first().map(|first| first.on);
    assert!(open.iter().any(|open| first(open) == Some(on)), "{open:?}");
    diagnosis
}

/// Adds the torque that a force on the tool requires, which is a function of the tool's position (m) and velocity (m/s), in the base's frame.
fn with_force(force: impl Fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64>) -> impl Fn(&mut Motion, &mut [f64]) {
    let arm = trio();
    move |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let (tool, mut workspace, mut jacobian) = (arm.tool_frame(), Workspace::new(&arm), Matrix6xX::zeros(3));
        arm.forward_kinematics(&mut workspace, &motion.q);
        arm.jacobian(&mut workspace, &motion.q, &tool, &mut jacobian);
        let linear = jacobian.fixed_rows::<3>(3);
        let velocity = linear * nalgebra::DVector::from_column_slice(&motion.qd);
        let force = force(workspace.base_from_frame(&tool).translation, velocity);
        for (joint, tau) in tau.iter_mut().enumerate() {
            *tau -= linear.column(joint).dot(&force);
        }
    }
}

#[test]
fn an_elastic_cord_at_the_tool_is_neither_a_tilted_base_nor_a_spring() {
    let anchor = Vector3::new(0.9, 0.6, 1.4);
    check(&with_force(|position, _| 25.0 * (anchor - position)), Regressor::ToolPosition);
}

#[test]
fn drag_on_the_tool_is_neither_a_coupling_nor_a_contact() {
    check(&with_force(|_, velocity| -12.0 * velocity.norm() * velocity), Regressor::ToolVelocity);
}

/// With a wrong ratio of a belt, all recorded positions are wrong by a factor.
#[test]
fn a_wrong_gear_ratio_of_an_encoder_is_not_its_zero() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        motion.q[ELBOW] *= 0.94;
    };
    let diagnosis = check(&injected, Regressor::PositionScale);
    assert!(diagnosis.report.unexplained.iter().all(|open| open.joint == "elbow"));
}

/// The sensor of the elbow senses a part of the shoulder's load.
#[test]
fn crosstalk_of_a_torque_channel_is_no_offset() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[ELBOW] += 0.1 * tau[SHOULDER];
    };
    let diagnosis = check(&injected, Regressor::OtherTorque);
    assert!(diagnosis.report.unexplained.iter().all(|open| open.joint == "elbow"));
}

/// The base turns by about ten milliradians under the torque of the arm, and follows it at once.
#[test]
fn a_soft_base_is_no_joint_elasticity() {
    const STIFFNESS: f64 = 4000.0;
    let arm = trio().on_turning_base();
    let injected = |now: &mut Motion, tau: &mut [f64]| {
        baseline_friction(now, tau);
        let is_this = |&variant: &usize| motion(3, now.time, variant).q == now.q;
        let variant = (0..3).find(is_this).expect("it is one of the three");
        let mut workspace = Workspace::new(&arm);
        let mut needed = |base: [[f64; 2]; 2], later: f64| {
            let then = motion(3, now.time + later, variant);
            let mut torque = [0.0; 5];
            let [q, qdd] = [(base[0], &then.q), (base[1], &then.qdd)].map(|(base, arm)| [&base[..], arm].concat());
            let qd = [&[0.0; 2][..], &then.qd].concat();
            arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut torque);
            torque
        };
        let mut angle = |later: f64| {
            let torque = needed([[0.0; 2]; 2], later);
            [0, 1].map(|axis: usize| -torque[axis] / STIFFNESS)
        };
        let step = 0.01;
        let [before, at, after] = [-step, 0.0, step].map(&mut angle);
        let acceleration = [0, 1].map(|axis: usize| (before[axis] - 2.0 * at[axis] + after[axis]) / (step * step));
        let (rigid, swaying) = (needed([[0.0; 2]; 2], 0.0), needed([at, acceleration], 0.0));
        for (joint, tau) in tau.iter_mut().enumerate() {
            *tau += swaying[2 + joint] - rigid[2 + joint];
        }
    };
    check(&injected, Regressor::BaseMotion);
}

/// On a warmer day, all friction is less. It keeps its names and sizes, and the held-out errors have their reason.
#[test]
fn less_friction_in_the_held_out_recording_is_reported() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        let part = if motion.clock >= start(2) { 0.6 } else { 1.0 };
        for (tau, speed) in tau.iter_mut().zip(&motion.qd) {
            *tau += part * (1.2 * speed.signum() + 0.8 * speed);
        }
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    assert_eq!(diagnosis.report.verdict, Verdict::Explained, "{:?}", diagnosis.report.unexplained);
    for joint in ["turn", "shoulder", "elbow"] {
        assert_eq!(effects_on(&diagnosis, joint).len(), 2, "{:?}", sentences(&diagnosis));
    }
    let different = &diagnosis.report.held_out_friction;
    assert!(different.iter().any(|of| of.joint == "elbow"), "{different:?}");
    assert!(different.iter().all(|of| (of.factor - 0.6).abs() < 0.05 && of.recording == "c"), "{different:?}");
}

/// An arm of one joint has fewer joints than a base has axes.
#[test]
fn an_arm_of_one_joint_is_diagnosed() {
    const PENDULUM: &str = r#"<robot name="pendulum"><link name="base"/>
<joint name="hinge" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
<link name="rod"><inertial><origin xyz=".4 0 0"/><mass value="3"/><inertia ixx=".02" ixy="0" ixz="0" iyy=".2" iyz="0" izz=".2"/></inertial></link></robot>"#;
    let arm = Arm::from_urdf_text(PENDULUM, "pendulum.urdf").expect("it is an arm");
    let injected = |motion: &mut Motion, tau: &mut [f64]| tau[0] += 0.8 * motion.qd[0].signum();
    let diagnosis = diagnosed(&arm, &arm, &injected, Vec::new());
    assert_eq!(effects_on(&diagnosis, "hinge"), ["coulomb_friction"], "{:?}", sentences(&diagnosis));
}
