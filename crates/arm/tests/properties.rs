//! Laws of mechanics on random arms: 1 to 10 joints, revolute and prismatic in any order.
//!
//! The arms are drawn with a fixed seed; `PROPTEST_RNG_SEED=7 PROPTEST_CASES=10000` draws other and more arms.

mod random_arm;

use arm::{Arm, DMatrix, JointKind, Pose, Vector3, Workspace};
use nalgebra::{DVector, Rotation3};
use proptest::prelude::*;

use random_arm::{Case, arm, cases, config, urdf};

/// Fails if a value differs from its counterpart by more than `tolerance` times the largest of them (or one).
fn is_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) -> Result<(), TestCaseError> {
    let scale = b.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (x, y) in a.iter().zip(b) {
        prop_assert!((x - y).abs() <= tolerance * scale, "{}: {:?} is not {:?} (to {})", what, a, b, tolerance);
    }
    Ok(())
}

fn torque(arm: &Arm, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
    let mut tau = vec![0.0; arm.dof()];
    arm.inverse_dynamics(&mut Workspace::new(arm), q, qd, qdd, &mut tau);
    tau
}

fn mass_matrix(arm: &Arm, q: &[f64]) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(arm.dof(), arm.dof());
    arm.mass_matrix(&mut Workspace::new(arm), q, &mut m);
    m
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn the_arm_is_what_its_urdf_says(case in cases()) {
        let arm = arm(&case);
        prop_assert_eq!(arm.dof(), case.bodies.len());
        for (joint, body) in arm.joints().iter().zip(&case.bodies) {
            prop_assert_eq!(joint.kind == JointKind::Prismatic, body.slides);
            is_close("mass", &[joint.inertia.mass], &[body.mass], 1e-12)?;
            is_close("com", joint.inertia.com.as_slice(), &body.com, 1e-12)?;
        }
    }

    /// Forward dynamics is the inverse of inverse dynamics, up to the condition of the mass matrix.
    #[test]
    fn forward_and_inverse_dynamics_undo_each_other(case in cases()) {
        let (arm, [q, qd, qdd]) = (arm(&case), &case.state());
        let tau = torque(&arm, q, qd, qdd);
        let mut back = vec![0.0; arm.dof()];
        arm.forward_dynamics(&mut Workspace::new(&arm), q, qd, &tau, &mut back);
        let moments = mass_matrix(&arm, q).symmetric_eigenvalues();
        let condition = moments.max() / moments.min();
        is_close("forward of inverse", &back, qdd, 1e-13 * condition.max(100.0))?;
        is_close("inverse of forward", &torque(&arm, q, qd, &back), &tau, 1e-9)?;
    }

    #[test]
    fn the_mass_matrix_is_symmetric_positive_and_the_columns_of_inverse_dynamics(case in cases()) {
        let (arm, [q, ..]) = (arm(&case).with_gravity(Vector3::zeros()), &case.state());
        let (n, m) = (arm.dof(), mass_matrix(&arm, q));
        prop_assert_eq!(&m, &m.transpose());
        prop_assert!(m.clone().cholesky().is_some(), "{m} is not positive");
        let mut columns = DMatrix::zeros(n, n);
        for column in 0..n {
            let mut qdd = vec![0.0; n];
            qdd[column] = 1.0;
            columns.set_column(column, &DVector::from_vec(torque(&arm, q, &vec![0.0; n], &qdd)));
        }
        is_close("mass matrix", m.as_slice(), columns.as_slice(), 1e-12)?;
    }

    #[test]
    fn the_regressor_times_the_parameters_is_the_torque(case in cases()) {
        let (arm, [q, qd, qdd]) = (arm(&case), &case.state());
        let n = arm.dof();
        let mut regressor = DMatrix::zeros(n, 10 * n);
        arm.torque_regressor(&mut Workspace::new(&arm), q, qd, qdd, &mut regressor);
        let mut sum = regressor * DVector::from_vec(arm.inertial_parameters());
        for (joint, body) in case.bodies.iter().enumerate() {
            sum[joint] += body.rotor * qdd[joint];
        }
        is_close("Y pi", sum.as_slice(), &torque(&arm, q, qd, qdd), 1e-12)?;
    }

    /// The torque is linear in the masses: twice the masses and rotors give twice the torque.
    #[test]
    fn masses_and_torques_scale_alike(case in cases(), factor in 0.1..10.0) {
        let (light, [q, qd, qdd]) = (arm(&case), &case.state());
        let rotors: Vec<f64> = case.bodies.iter().map(|body| factor * body.rotor).collect();
        let heavy = light.clone().with_scaled_inertias(factor).with_rotor_inertias(&rotors);
        let scaled: Vec<f64> = torque(&light, q, qd, qdd).iter().map(|tau| factor * tau).collect();
        is_close("scaled", &torque(&heavy, q, qd, qdd), &scaled, 1e-12)?;
    }

    /// Power equals the rate of change of energy: d/dt (T + V) = q̇ᵀ τ along the motion.
    #[test]
    fn power_is_the_rate_of_change_of_energy(case in cases()) {
        let (arm, [q, qd, qdd]) = (arm(&case), &case.state());
        let mut workspace = Workspace::new(&arm);
        let tau = torque(&arm, q, qd, qdd);
        let h = 1e-5;
        let mut energy = |d: f64| {
            let ahead: Vec<f64> = (0..arm.dof()).map(|i| q[i] + d * qd[i] + 0.5 * d * d * qdd[i]).collect();
            let speed: Vec<f64> = (0..arm.dof()).map(|i| qd[i] + d * qdd[i]).collect();
            arm.kinetic_energy(&mut workspace, &ahead, &speed) + arm.potential_energy(&mut workspace, &ahead)
        };
        let rate = (energy(h) - energy(-h)) / (2.0 * h);
        let power: f64 = qd.iter().zip(&tau).map(|(v, t)| v * t).sum();
        let scale: f64 = qd.iter().zip(&tau).map(|(v, t)| (v * t).abs()).sum();
        prop_assert!((rate - power).abs() <= 1e-5 * (1.0 + scale), "{} is not {}", rate, power);
    }

    #[test]
    fn the_derivatives_are_the_differences(case in cases()) {
        let (arm, states) = (arm(&case), case.state());
        let n = arm.dof();
        let mut ours = [DMatrix::zeros(n, n), DMatrix::zeros(n, n)];
        let [by_position, by_velocity] = ours.each_mut().map(DMatrix::as_mut_slice);
        arm.inverse_dynamics_derivatives_batch(&states[0], &states[1], &states[2], by_position, by_velocity);
        for (which, ours) in ours.iter().enumerate() {
            let mut differences = DMatrix::zeros(n, n);
            let h = 1e-5;
            for by in 0..n {
                let at = |d: f64| {
                    let mut states = states.clone();
                    states[which][by] += d;
                    DVector::from_vec(torque(&arm, &states[0], &states[1], &states[2]))
                };
                differences.set_column(by, &((at(h) - at(-h)) / (2.0 * h)));
            }
            is_close("derivative", ours.as_slice(), differences.as_slice(), 1e-6)?;
        }
    }

    /// An arm on another base frame has the same torques if gravity is given in that frame, and so has an arm whose
    /// links are divided by fixed joints.
    #[test]
    fn frames_do_not_change_the_torque(case in cases(), xyz in prop::array::uniform3(-2.0..2.0), rpy in prop::array::uniform3(-3.0..3.0)) {
        let (here, [q, qd, qdd]) = (arm(&case), &case.state());
        let tau = torque(&here, q, qd, qdd);
        let stand = Pose::from_xyz_rpy(xyz, rpy);
        let text = urdf(&Case { stand: Some((xyz, rpy)), ..case.clone() });
        let moved = random_arm::read(&text, &case).with_gravity(stand.rotation * here.gravity());
        is_close("on a stand", &torque(&moved, q, qd, qdd), &tau, 1e-10)?;
        let text = urdf(&Case { cut: Some((xyz, rpy)), ..case.clone() });
        let cut = random_arm::read(&text, &case);
        is_close("cut by fixed joints", &torque(&cut, q, qd, qdd), &tau, 1e-10)?;
        // The tool stands where the stand puts it.
        let mut workspaces = [Workspace::new(&here), Workspace::new(&moved)];
        here.forward_kinematics(&mut workspaces[0], q);
        moved.forward_kinematics(&mut workspaces[1], q);
        let [a, b] = [(&here, &workspaces[0]), (&moved, &workspaces[1])].map(|(arm, workspace)| {
            workspace.base_from_frame(&arm.tool_frame())
        });
        let expected = stand.compose(&a);
        is_close("the tool's place", b.translation.as_slice(), expected.translation.as_slice(), 1e-12)?;
        is_close("the tool's axes", b.rotation.as_slice(), expected.rotation.as_slice(), 1e-12)?;
    }

    /// A rotated base is equivalent to gravity rotated in the opposite direction.
    #[test]
    fn a_turned_base_is_turned_gravity(case in cases(), axis in prop::array::uniform3(-1.0..1.0), angle in -3.0..3.0) {
        let axis = Vector3::from(axis) + Vector3::new(0.0, 0.0, 2.0);
        let (arm, [q, qd, qdd]) = (arm(&case), &case.state());
        let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle);
        let gravity = turn.inverse_transform_vector(arm.gravity());
        let by_gravity = torque(&arm.clone().with_gravity(gravity), q, qd, qdd);
        is_close("turned", &torque(&arm.with_turned_base(axis, angle), q, qd, qdd), &by_gravity, 1e-12)?;
    }

    /// The results do not depend on earlier uses of the workspace.
    #[test]
    fn a_used_workspace_is_as_good_as_a_new_one(case in cases()) {
        let (arm, [q, qd, qdd]) = (arm(&case), &case.state());
        let mut used = Workspace::new(&arm);
        let mut tau = vec![0.0; arm.dof()];
        arm.forward_dynamics(&mut used, qdd, q, qd, &mut tau);
        arm.inverse_dynamics(&mut used, q, qd, qdd, &mut tau);
        prop_assert_eq!(tau, torque(&arm, q, qd, qdd));
    }
}
