//! Batches of states have the same results as single states, to the last bit.

use std::path::{Path, PathBuf};

use arm::{Arm, DMatrix, PARAMETERS_PER_LINK, Workspace};

fn robots() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut robots = Vec::new();
    for folder in [root.join("tests/robots"), root.join("../../assets")] {
        for entry in std::fs::read_dir(&folder).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "urdf") {
                robots.push(path);
            }
        }
    }
    robots.sort();
    assert!(robots.len() > 3, "{robots:?}");
    robots
}

/// A signal without repeated values, joint after joint, with one entry per state.
fn signal(dof: usize, samples: usize, phase: f64) -> Vec<f64> {
    let at = |i: usize, k: usize| 1.7 * ((k * 7 + i) as f64 * 0.37 + phase).sin();
    (0..dof * samples).map(|entry| at(entry / samples, entry % samples)).collect()
}

fn state(signal: &[f64], samples: usize, k: usize) -> Vec<f64> {
    signal.chunks_exact(samples).map(|joint| joint[k]).collect()
}

#[track_caller]
fn assert_same(what: &str, many: &[f64], samples: usize, k: usize, alone: &[f64]) {
    let many = state(many, samples, k);
    assert_eq!(many.len(), alone.len(), "{what}");
    for (at, (a, b)) in many.iter().zip(alone).enumerate() {
        assert_eq!(a.to_bits(), b.to_bits(), "{what}, state {k} of {samples}, entry {at}: {a} and {b}");
    }
}

fn compare(arm: &Arm, samples: usize) {
    let n = arm.dof();
    let [q, qd, qdd] = [0.0, 1.0, 2.0].map(|phase| signal(n, samples, phase));
    // Not zero before the call, because every entry must be written.
    let dirty = |entries: usize| vec![f64::NAN; entries * samples];
    let (mut tau, mut accelerations) = (dirty(n), dirty(n));
    let mut mass = dirty(n * n);
    // Zero before this call, because it does not write the zeros.
    let mut regressor = vec![0.0; n * n * PARAMETERS_PER_LINK * samples];
    let (mut by_position, mut by_velocity) = (dirty(n * n), dirty(n * n));
    arm.inverse_dynamics_batch(&q, &qd, &qdd, &mut tau);
    arm.forward_dynamics_batch(&q, &qd, &qdd, &mut accelerations);
    arm.mass_matrix_batch(&q, &mut mass);
    arm.torque_regressor_batch(&q, &qd, &qdd, &mut regressor);
    arm.inverse_dynamics_derivatives_batch(&q, &qd, &qdd, &mut by_position, &mut by_velocity);

    let mut workspace = Workspace::new(arm);
    let mut vector = vec![0.0; n];
    let (mut square, mut other) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    let mut wide = DMatrix::from_element(n, n * PARAMETERS_PER_LINK, f64::NAN);
    for k in 0..samples {
        let [q, qd, qdd] = [&q, &qd, &qdd].map(|signal| state(signal, samples, k));
        arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut vector);
        assert_same("inverse dynamics", &tau, samples, k, &vector);
        arm.forward_dynamics(&mut workspace, &q, &qd, &qdd, &mut vector);
        assert_same("forward dynamics", &accelerations, samples, k, &vector);
        arm.mass_matrix(&mut workspace, &q, &mut square);
        assert_same("mass matrix", &mass, samples, k, square.as_slice());
        arm.torque_regressor(&mut workspace, &q, &qd, &qdd, &mut wide);
        assert_same("regressor", &regressor, samples, k, wide.as_slice());
        arm.inverse_dynamics_derivatives_batch(&q, &qd, &qdd, square.as_mut_slice(), other.as_mut_slice());
        assert_same("by position", &by_position, samples, k, square.as_slice());
        assert_same("by velocity", &by_velocity, samples, k, other.as_slice());
    }
}

#[test]
fn every_state_has_the_bits_it_has_alone() {
    for path in robots() {
        let arm = Arm::from_urdf(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        // Several complete vectors, and one that is not.
        for samples in [1, 2, 3, 4, 5, 8, 67] {
            compare(&arm, samples);
        }
    }
}

#[test]
fn no_states_give_nothing() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/puma560.urdf");
    let arm = Arm::from_urdf(path).expect("it loads");
    arm.inverse_dynamics_batch(&[], &[], &[], &mut []);
}

#[test]
#[should_panic(expected = "the signals have one length")]
fn signals_of_two_lengths_are_refused() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/puma560.urdf");
    let arm = Arm::from_urdf(path).expect("it loads");
    arm.inverse_dynamics_batch(&[0.0; 12], &[0.0; 6], &[0.0; 12], &mut [0.0; 12]);
}
