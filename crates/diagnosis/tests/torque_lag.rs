//! Torques that were recorded later than the positions, on all joints or on one.

mod support;

use diagnosis::{Action, Diagnosis, Options, diagnose};
use recording::RegularRecording;
use support::{baseline_friction, effects_on, inputs, named, recorded, regular, sentences, trio};

/// The time constant of the filter in the drives (s), which is its lag at low frequencies.
const LAG: f64 = 0.012;

/// Recordings of a robot with friction, of which the torques of `lagging` joints passed a first-order filter.
fn recordings(lagging: &[usize]) -> Vec<RegularRecording> {
    let one = |variant: usize| {
        let mut recording = recorded(&trio(), variant, 20.0, &|motion, tau| baseline_friction(motion, tau));
        for &joint in lagging {
            let mut state = recording.tau[joint][0];
            let keep = (-0.004 / LAG).exp();
            for tau in &mut recording.tau[joint] {
                state = keep * state + (1.0 - keep) * *tau;
                *tau = state;
            }
        }
        regular(&recording)
    };
    (0..3).map(one).collect()
}

fn diagnosed(lagging: &[usize], torque_lag: Option<f64>) -> Diagnosis {
    let options = Options {
        torque_lag,
        ..Options::default()
    };
    diagnose(&trio(), &inputs(&recordings(lagging)), &options, &|_| {}).expect("it can be diagnosed")
}

#[test]
fn a_lag_of_all_torques_is_removed_and_noted() {
    let found = diagnosed(&[0, 1, 2], None);
    let lag = found.report.torque_lag.expect("there is one");
    // The filter at 250 Hz delays by half a period less than its time constant.
    assert!((lag - LAG + 0.002).abs() < 0.001, "{lag}");
    assert!(named(&found).is_empty(), "{:?}", sentences(&found));
    assert!(found.report.unexplained.is_empty(), "{:?}", found.report.unexplained);
    assert!(found.trace.iter().any(|row| row.action == Action::Lag));
    let note = found
        .remarks
        .iter()
        .find(|remark| remark.contains("later than the positions"));
    assert!(note.is_some(), "{:?}", found.remarks);
    for (joint, fit) in &found.report.fit {
        let error = fit.held_out_nrmse_augmented.expect("a recording is held out");
        assert!(error < 0.02, "{joint}: {error}");
    }
}

#[test]
fn a_lag_of_one_joint_is_not_one_of_all() {
    for lagging in [&[][..], &[1]] {
        let found = diagnosed(lagging, None);
        assert_eq!(found.report.torque_lag, None, "{lagging:?}");
    }
}

#[test]
fn a_stated_lag_is_used() {
    let found = diagnosed(&[0, 1, 2], Some(0.010));
    assert_eq!(found.report.torque_lag, Some(0.010));
    assert!(named(&found).is_empty(), "{:?}", sentences(&found));
    let found = diagnosed(&[0, 1, 2], Some(0.0));
    assert_eq!(found.report.torque_lag, None);
}

/// A late torque of gravity depends on the velocities of all joints that gravity depends on.
#[test]
fn a_lag_is_not_a_drive_that_turns_with_two_joints() {
    let found = diagnosed(&[0, 1, 2], Some(0.0));
    for joint in ["turn", "shoulder", "elbow"] {
        assert!(
            !effects_on(&found, joint).contains(&"transmission_coupling"),
            "{:?}",
            sentences(&found)
        );
    }
}
