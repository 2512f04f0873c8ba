//! Laws of mechanics that hold for every arm, in random states of three arms; `properties.rs` has those of random arms.

use std::path::Path;

use arm::{Arm, DMatrix, Matrix6xX, Vector3, Workspace};
use nalgebra::DVector;

/// A small deterministic generator of numbers in ±1 (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| scale * self.next()).collect()
    }
}

fn for_each_state(mut law: impl FnMut(&Arm, &mut Workspace, &mut Random)) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    for urdf in ["../../assets/puma560.urdf", "tests/robots/seven_axis.urdf", "tests/robots/prismatic.urdf"] {
        let arm = Arm::from_urdf(folder.join(urdf)).expect("the robot loads");
        let rotors: Vec<f64> = (0..arm.dof()).map(|i| 0.1 + 0.05 * i as f64).collect();
        // Gravity in a general direction, and rotors, so that every term contributes.
        let arm = arm.with_gravity(Vector3::new(1.2, -0.7, -9.6)).with_rotor_inertias(&rotors);
        let mut workspace = Workspace::new(&arm);
        let mut random = Random(7);
        for _ in 0..100 {
            law(&arm, &mut workspace, &mut random);
        }
    }
}

fn assert_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    let scale = b.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (x, y) in a.iter().zip(b) {
        assert!((x - y).abs() <= tolerance * scale, "{what}: {a:?} is not {b:?}");
    }
}

fn mass_matrix_at(arm: &Arm, workspace: &mut Workspace, q: &[f64]) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(arm.dof(), arm.dof());
    arm.mass_matrix(workspace, q, &mut m);
    m
}

/// τ = M q̈ + bias, and the kinetic energy is ½ q̇ᵀ M q̇. Fails if the composite bodies are wrong.
#[test]
fn mass_matrix_gives_torque_and_energy() {
    for_each_state(|arm, workspace, random| {
        let n = arm.dof();
        let (q, qd, qdd) = (random.vector(n, 3.0), random.vector(n, 3.0), random.vector(n, 3.0));
        let m = mass_matrix_at(arm, workspace, &q);
        let (mut tau, mut bias) = (vec![0.0; n], vec![0.0; n]);
        arm.inverse_dynamics(workspace, &q, &qd, &qdd, &mut tau);
        arm.bias_torque(workspace, &q, &qd, &mut bias);
        let sum = &m * DVector::from_column_slice(&qdd) + DVector::from_column_slice(&bias);
        assert_close("M qdd + bias", sum.as_slice(), &tau, 1e-12);
        let v = DVector::from_column_slice(&qd);
        let energy = 0.5 * v.dot(&(&m * &v));
        assert_close("energy", &[arm.kinetic_energy(workspace, &q, &qd)], &[energy], 1e-12);
    });
}

/// Gravity torque is the gradient of potential energy. Fails if a centre of mass or a frame is off.
#[test]
fn gravity_torque_is_the_gradient_of_potential_energy() {
    for_each_state(|arm, workspace, random| {
        let n = arm.dof();
        let q = random.vector(n, 3.0);
        let mut tau = vec![0.0; n];
        arm.gravity_torque(workspace, &q, &mut tau);
        let h = 1e-5;
        let gradient: Vec<f64> = (0..n)
            .map(|i| {
                let mut at = |d: f64| {
                    let mut q = q.clone();
                    q[i] += d;
                    arm.potential_energy(workspace, &q)
                };
                (at(h) - at(-h)) / (2.0 * h)
            })
            .collect();
        assert_close("gradient", &gradient, &tau, 1e-7);
    });
}

/// q̇ᵀ (Ṁ − 2 C) q̇ = 0 for every q̇: with C q̇ = bias − gravity, ½ q̇ᵀ Ṁ q̇ = q̇ᵀ C q̇. Fails if a
/// Coriolis or centrifugal term is missing or does work.
#[test]
fn coriolis_forces_do_no_work_beyond_the_change_of_inertia() {
    for_each_state(|arm, workspace, random| {
        let n = arm.dof();
        let (q, qd) = (random.vector(n, 3.0), random.vector(n, 2.0));
        let h = 1e-5;
        let along = |d: f64| -> Vec<f64> { q.iter().zip(&qd).map(|(q, v)| q + d * v).collect() };
        let m_dot =
            (mass_matrix_at(arm, workspace, &along(h)) - mass_matrix_at(arm, workspace, &along(-h))) / (2.0 * h);
        let (mut bias, mut gravity) = (vec![0.0; n], vec![0.0; n]);
        arm.bias_torque(workspace, &q, &qd, &mut bias);
        arm.gravity_torque(workspace, &q, &mut gravity);
        let v = DVector::from_column_slice(&qd);
        let power: f64 = (0..n).map(|i| qd[i] * (bias[i] - gravity[i])).sum();
        let change = 0.5 * v.dot(&(m_dot * &v));
        assert!((power - change).abs() <= 1e-6 * (1.0 + power.abs()), "{power} is not {change}");
    });
}

/// The Jacobian is the derivative of the pose. Fails if a column uses the wrong point or frame.
#[test]
fn jacobian_is_the_derivative_of_the_pose() {
    for_each_state(|arm, workspace, random| {
        let n = arm.dof();
        let (q, qd) = (random.vector(n, 3.0), random.vector(n, 1.0));
        let tool = arm.tool_frame();
        let mut jacobian = Matrix6xX::zeros(n);
        arm.jacobian(workspace, &q, &tool, &mut jacobian);
        let twist = jacobian * DVector::from_column_slice(&qd);
        let h = 1e-6;
        let mut pose = |d: f64| {
            let q: Vec<f64> = q.iter().zip(&qd).map(|(q, v)| q + d * v).collect();
            arm.forward_kinematics(workspace, &q);
            workspace.base_from_frame(&tool)
        };
        let (ahead, behind) = (pose(h), pose(-h));
        let linear = (ahead.translation - behind.translation) / (2.0 * h);
        let spin = (ahead.rotation - behind.rotation) / (2.0 * h) * pose(0.0).rotation.transpose();
        let derivative = [spin[(2, 1)], spin[(0, 2)], spin[(1, 0)], linear.x, linear.y, linear.z];
        assert_close("J qd", twist.as_slice(), &derivative, 1e-7);
    });
}

/// The features of algorithm 1: ω and ω̇ are the motion of the link itself, τ_{i+1} and f_{i+1} the wrench on the rest
/// of the arm. At rest, the force is the weight of the distal links, and it is zero at the last link. In link i's frame, it is the same
/// vector.
#[test]
fn newton_euler_features_are_the_loads_between_links() {
    for_each_state(|arm, workspace, random| {
        let n = arm.dof();
        let q = random.vector(n, 3.0);
        let zeros = vec![0.0; n];
        let mut tau = vec![0.0; n];
        let mut features = vec![[0.0; arm::FEATURES]; n];
        arm.newton_euler_features(workspace, &q, &zeros, &zeros, &mut tau, &mut features);
        let mut own_frame = features.clone();
        arm.turn_loads_into_own_frames(workspace, &mut own_frame);
        arm.forward_kinematics(workspace, &q);
        for i in 0..n {
            let distal: f64 = arm.joints()[i + 1..].iter().map(|joint| joint.inertia.mass).sum();
            let vector = |feature: &[f64], from: usize| Vector3::from_column_slice(&feature[from..from + 3]);
            assert_close("weight", &[vector(&features[i], 9).norm()], &[distal * arm.gravity().norm()], 1e-12);
            let in_base = workspace.base_from_link(i).rotation * vector(&own_frame[i], 9);
            assert_close("force", in_base.as_slice(), (-distal * arm.gravity()).as_slice(), 1e-12);
            let moment = workspace.base_from_link(i).rotation * vector(&own_frame[i], 6);
            let next = workspace.base_from_link((i + 1).min(n - 1)).rotation * vector(&features[i], 6);
            assert_close("moment", moment.as_slice(), next.as_slice(), 1e-12);
            assert_eq!((features[i][12], own_frame[i][12]), (tau[i], tau[i]));
            assert!(features[i][..6].iter().chain(&own_frame[i][..6]).all(|x| *x == 0.0));
        }
        assert!(features[n - 1][6..12].iter().all(|x| *x == 0.0));
    });
}
