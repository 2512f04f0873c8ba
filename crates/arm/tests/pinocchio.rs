//! Every algorithm against Pinocchio, on 1000 random states of three arms (see `pinocchio/generate.py`).

use std::path::Path;

use arm::{Arm, DMatrix, FEATURES, Matrix6xX, NewtonEulerFeatures, Workspace};

/// Largest error allowed, relative to the largest value of the quantity in that state.
const TOLERANCE: f64 = 1e-10;

/// Takes `count` values from the beginning of `row`.
fn take<'a>(row: &mut &'a [f64], count: usize) -> &'a [f64] {
    let (head, tail) = row.split_at(count);
    *row = tail;
    head
}

fn check(robot: &str, urdf: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let arm = Arm::from_urdf(folder.join(urdf)).expect("the robot loads");
    let bytes = std::fs::read(folder.join(format!("tests/pinocchio/{robot}.bin"))).expect("the reference is there");
    let values: Vec<f64> =
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes"))).collect();
    let n = arm.dof();
    let width = 4 * n + 12 + 6 + 4 * n + n * (n + 1) / 2 + 2 * n;
    assert_eq!(values.len(), 1000 * width);

    let mut workspace = Workspace::new(&arm);
    let tool = arm.tool_frame();
    let mut tau_out = vec![0.0; n];
    let mut mass_matrix = DMatrix::zeros(n, n);
    let mut jacobian = Matrix6xX::zeros(n);
    let mut regressor = DMatrix::zeros(n, 10 * n);
    let mut features = vec![[0.0; FEATURES]; n];
    let p: Vec<f64> = (0..10 * n).map(|k| (k as f64 + 1.0).sin()).collect();
    let mut worst: Vec<(&str, f64)> = Vec::new();

    for (state, mut row) in values.chunks_exact(width).enumerate() {
        let mut compare = |what: &'static str, ours: &[f64], theirs: &[f64]| {
            assert_eq!(ours.len(), theirs.len());
            let scale = theirs.iter().fold(1e-3, |m: f64, x| m.max(x.abs()));
            let error = ours.iter().zip(theirs).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale;
            assert!(error <= TOLERANCE, "{robot}, state {state}: {what} is off by {error:e}\n{ours:?}\n{theirs:?}");
            match worst.iter_mut().find(|(name, _)| *name == what) {
                Some((_, e)) => *e = e.max(error),
                None => worst.push((what, error)),
            }
        };
        let [q, qd, qdd, tau] = [(); 4].map(|()| take(&mut row, n));

        arm.jacobian(&mut workspace, q, &tool, &mut jacobian);
        let pose = workspace.base_from_frame(&tool);
        compare("rotation", pose.rotation.transpose().as_slice(), take(&mut row, 9));
        compare("translation", pose.translation.as_slice(), take(&mut row, 3));
        let twist = &jacobian * nalgebra::DVector::from_column_slice(qd);
        compare("twist", twist.as_slice(), take(&mut row, 6));

        arm.inverse_dynamics(&mut workspace, q, qd, qdd, &mut tau_out);
        compare("inverse dynamics", &tau_out, take(&mut row, n));
        arm.bias_torque(&mut workspace, q, qd, &mut tau_out);
        compare("bias torque", &tau_out, take(&mut row, n));
        arm.gravity_torque(&mut workspace, q, &mut tau_out);
        compare("gravity torque", &tau_out, take(&mut row, n));

        arm.forward_dynamics(&mut workspace, q, qd, tau, &mut tau_out);
        compare("forward dynamics", &tau_out, take(&mut row, n));

        arm.mass_matrix(&mut workspace, q, &mut mass_matrix);
        let lower: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|ij| mass_matrix[ij]).collect();
        compare("mass matrix", &lower, take(&mut row, lower.len()));

        arm.torque_regressor(&mut workspace, q, qd, qdd, &mut regressor);
        let tau = &regressor * nalgebra::DVector::from_column_slice(&p);
        compare("regressor", tau.as_slice(), take(&mut row, n));

        arm.newton_euler_features(&mut workspace, q, qd, qdd, &mut tau_out, &mut features);
        let sum = |feature: &NewtonEulerFeatures| (0..12).map(|k| (k as f64 + 1.0).sin() * feature[k]).sum();
        let sums: Vec<f64> = features.iter().map(sum).collect();
        compare("Newton-Euler features", &sums, take(&mut row, n));
        assert!((0..n).all(|i| features[i][12] == tau_out[i]));
    }
    println!("{robot}: largest relative errors {worst:?}");
}

/// ∂τ/∂q and ∂τ/∂q̇ on the states of `pinocchio/derivatives.py`.
fn check_derivatives(robot: &str, urdf: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let arm = Arm::from_urdf(folder.join(urdf)).expect("the robot loads");
    let file = folder.join(format!("tests/pinocchio/{robot}_derivatives.bin"));
    let bytes = std::fs::read(file).expect("the reference is there");
    let values: Vec<f64> =
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes"))).collect();
    let n = arm.dof();
    let width = 3 * n + 2 * n * n;
    assert_eq!(values.len(), 50 * width);
    let mut ours = [DMatrix::zeros(n, n), DMatrix::zeros(n, n)];
    for (state, mut row) in values.chunks_exact(width).enumerate() {
        let [q, qd, qdd] = [(); 3].map(|()| take(&mut row, n));
        let [by_position, by_velocity] = ours.each_mut().map(DMatrix::as_mut_slice);
        arm.inverse_dynamics_derivatives_batch(q, qd, qdd, by_position, by_velocity);
        for (what, ours) in ["by position", "by velocity"].iter().zip(&ours) {
            let theirs = DMatrix::from_row_slice(n, n, take(&mut row, n * n));
            let error = (ours - &theirs).amax() / theirs.amax().max(1e-3);
            assert!(error <= TOLERANCE, "{robot}, state {state}: {what} is off by {error:e}\n{ours}{theirs}");
        }
    }
}

#[test]
fn derivatives_agree_with_pinocchio() {
    check_derivatives("puma560", "../../assets/puma560.urdf");
    check_derivatives("seven_axis", "tests/robots/seven_axis.urdf");
    check_derivatives("prismatic", "tests/robots/prismatic.urdf");
}

#[test]
fn puma560_agrees_with_pinocchio() {
    check("puma560", "../../assets/puma560.urdf");
}

#[test]
fn seven_axis_arm_agrees_with_pinocchio() {
    check("seven_axis", "tests/robots/seven_axis.urdf");
}

#[test]
fn arm_with_prismatic_joints_agrees_with_pinocchio() {
    check("prismatic", "tests/robots/prismatic.urdf");
}
