//! Torques that were recorded later than the positions, on all joints or on one.

use crate::support::{baseline_friction, effects_on, inputs, named, recorded, regular, sentences, trio};
use diagnosis::{Action, Diagnosis, Options, Parameter, diagnose};
use recording::RegularRecording;

/// The time constant of the filter in the drives (s), which is its lag at low frequencies.
const LAG: f64 = 0.012;

/// The viscous friction of each joint of the robot (N m s/rad), that of `baseline_friction`.
const VISCOUS: f64 = 0.4;

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
    let options = Options { torque_lag, ..Options::default() };
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
    let note = found.remarks.iter().find(|remark| remark.contains("later than the positions"));
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
        assert!(!effects_on(&found, joint).contains(&"transmission_coupling"), "{:?}", sentences(&found));
    }
}

/// A lag that is too short to be removed is a part of every fit, so that it does not change friction.
#[test]
fn a_short_lag_does_not_change_viscous_friction() {
    let late = |recording: &RegularRecording| recording.without_torque_lag(-0.0015);
    let recordings: Vec<RegularRecording> = recordings(&[]).iter().map(late).collect();
    let found = |torque_lag: Option<f64>| -> (f64, bool) {
        let options = Options { torque_lag, ..Options::default() };
        let found = diagnose(&trio(), &inputs(&recordings), &options, &|_| {}).expect("it can be diagnosed");
        assert!(named(&found).is_empty(), "{:?}", sentences(&found));
        assert_eq!(found.report.torque_lag, None);
        let is_noted = found.remarks.iter().any(|remark| remark.contains("later than the positions"));
        assert_eq!(is_noted, torque_lag.is_none(), "{:?}", found.remarks);
        let viscous = found.report.findings.iter().filter(|finding| finding.effect == "viscous_friction");
        let sizes: Vec<_> = viscous.map(|finding| &finding.parameters["coefficient"]).collect();
        assert_eq!(sizes.len(), 3, "{:?}", sentences(&found));
        let off = |size: &&Parameter| (size.value - VISCOUS).abs();
        let is_within = |size: &&Parameter| size.ci95[0] <= VISCOUS && VISCOUS <= size.ci95[1];
        (sizes.iter().map(off).fold(0.0, f64::max), sizes.iter().all(is_within))
    };
    let ((error, holds), (as_recorded, _)) = (found(None), found(Some(0.0)));
    assert!(holds && error < 0.02 * VISCOUS, "{error}");
    assert!(as_recorded > 2.0 * error, "{as_recorded} against {error}");
}

/// The torques of one file come from another clock. They are compared on that of the others, also by the simulation of the findings.
#[test]
fn a_lag_of_one_recording_is_removed_from_it_alone() {
    let mut recordings: Vec<RegularRecording> = (0..4)
        .map(|variant| regular(&recorded(&trio(), variant, 20.0, &|motion, tau| baseline_friction(motion, tau))))
        .collect();
    recordings[1] = recordings[1].without_torque_lag(-0.024);
    let found = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    let own = &found.report.own_torque_lags;
    assert_eq!(own.keys().collect::<Vec<_>>(), ["b"], "{own:?}");
    assert!((own["b"] - 0.024).abs() < 0.002, "{own:?}");
    assert_eq!(found.report.torque_lag, None);
    assert!(named(&found).is_empty(), "{:?}", sentences(&found));
    assert!(found.remarks.iter().any(|remark| remark.contains("(b: 2")), "{:?}", found.remarks);
    let viscous = found.report.findings.iter().filter(|finding| finding.effect == "viscous_friction");
    let sizes: Vec<f64> = viscous.map(|finding| finding.parameters["coefficient"].value).collect();
    assert!(sizes.len() == 3 && sizes.iter().all(|size| (size - VISCOUS).abs() < 0.05 * VISCOUS), "{sizes:?}");
}
