//! Recordings that were made with different loads at the tip.

use crate::support::{
    ELBOW, Motion, SHOULDER, baseline_friction, diagnosed_with, inputs, motion, named, recorded, regular, sentences,
    start, trio,
};
use arm::{Arm, Inertia, Matrix3, Vector3, Workspace};
use diagnosis::{Diagnosis, Options, diagnose};
use recording::RegularRecording;

/// The arm with `mass` (kg) at the tip.
fn with_load(arm: &Arm, mass: f64) -> Arm {
    arm.clone().with_payload(&Inertia {
        mass,
        com: Vector3::new(0.01, 0.02, 0.1),
        tensor: Matrix3::identity() * 1e-3 * mass,
    })
}

/// The diagnosis of four recordings of 16 s with the loads `masses` (kg), the third held out. In each, only the joints that
/// `moves` selects move; a joint at rest carries its weight without friction, as a torque sensor beyond the gear reads it.
fn diagnosed(
    masses: [f64; 4],
    moves: impl Fn(usize, usize) -> bool,
    injected: impl Fn(usize, &Motion, &mut [f64]),
) -> Diagnosis {
    let recordings: Vec<RegularRecording> = (0..4)
        .map(|variant| {
            let robot = with_load(&trio(), masses[variant]);
            let still = motion(3, 0.0, 0).q;
            let of_robot = |motion: &mut Motion, tau: &mut [f64]| {
                for joint in (0..3).filter(|&joint| !moves(variant, joint)) {
                    (motion.q[joint], motion.qd[joint], motion.qdd[joint]) = (still[joint], 0.0, 0.0);
                }
                robot.inverse_dynamics(&mut Workspace::new(&robot), &motion.q, &motion.qd, &motion.qdd, tau);
                let mut friction = [0.0; 3];
                baseline_friction(motion, &mut friction);
                for joint in (0..3).filter(|&joint| moves(variant, joint)) {
                    tau[joint] += friction[joint];
                }
                injected(variant, motion, tau);
            };
            regular(&recorded(&robot, variant, 16.0, &of_robot))
        })
        .collect();
    diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed")
}

fn nothing(_: usize, _: &Motion, _: &mut [f64]) {}

#[track_caller]
fn assert_load(diagnosis: &Diagnosis, recordings: &[&str], mass: f64) {
    let load = diagnosis.report.different_load.as_ref();
    let load = load.unwrap_or_else(|| panic!("{:?}", sentences(diagnosis)));
    assert_eq!(load.recordings, recordings);
    let [low, high] = load.more_than_others.ci95;
    assert!(low <= mass && mass <= high && high - low < 0.3, "{load:?}");
}

/// The load is reported with its recordings, and is in no name. The load of all recordings is a payload.
#[test]
fn recordings_with_another_load_are_reported() {
    let diagnosis = diagnosed([0.0, 0.8, 0.8, 0.0], |_, _| true, nothing);
    assert_load(&diagnosis, &["b", "c"], 0.8);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
    let errors = diagnosis.report.fit.values().map(|fit| fit.held_out_nrmse_augmented);
    assert!(errors.flatten().all(|error| error < 0.03), "{:?}", diagnosis.report.fit);

    let diagnosis = diagnosed([0.5, 0.5, 1.0, 0.5], |_, _| true, nothing);
    assert_load(&diagnosis, &["c"], 0.5);
    assert_eq!(named(&diagnosis), [("payload", None)], "{:?}", sentences(&diagnosis));
}

/// If each joint moves in recordings of its own, only torques at rest show that the load differs.
#[test]
fn torques_at_rest_show_another_load() {
    let alone = |variant: usize, joint: usize| joint == [SHOULDER, ELBOW, ELBOW, SHOULDER][variant];
    let diagnosis = diagnosed([0.0, 0.8, 0.8, 0.0], alone, nothing);
    assert_load(&diagnosis, &["b", "c"], 0.8);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
}

/// The same load everywhere, one that changes once on a common clock, and a push are not recordings with another load.
#[test]
fn what_an_effect_explains_is_not_reported_as_another_load() {
    let is_reported = |diagnosis: &Diagnosis| diagnosis.report.different_load.is_some();
    let diagnosis = diagnosed([0.8; 4], |_, _| true, nothing);
    assert!(!is_reported(&diagnosis));
    assert_eq!(named(&diagnosis), [("payload", None)], "{:?}", sentences(&diagnosis));

    // A load of all that is heavier than any error of the last link.
    assert!(!is_reported(&diagnosed([9.0; 4], |_, _| true, nothing)));

    let diagnosis = diagnosed([0.0, 0.0, 0.8, 0.8], |_, _| true, nothing);
    assert!(!is_reported(&diagnosis));
    let payload = diagnosis.report.findings.iter().find(|finding| finding.effect == "payload");
    assert!(payload.is_some_and(|payload| payload.parameters.contains_key("onset")), "{:?}", sentences(&diagnosis));

    // A load that was put down is no effect of the model today.
    let diagnosis = diagnosed([0.8, 0.8, 0.0, 0.0], |_, _| true, nothing);
    assert_load(&diagnosis, &["a", "b"], 0.8);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));

    // The later recordings are fewer than those with the load.
    let diagnosis = diagnosed([0.8, 0.8, 0.8, 0.0], |_, _| true, nothing);
    assert_load(&diagnosis, &["a", "b", "c"], 0.8);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
}

/// A load that is put down within a recording is found with the time.
#[test]
fn a_load_that_is_put_down_within_a_recording() {
    for (end, recordings) in [(start(1) + 7.0, &["a", "b"][..]), (start(2) + 7.0, &["a", "b", "c"][..])] {
        put_down_at(end, recordings);
    }
}

#[track_caller]
fn put_down_at(end: f64, recordings: &[&str]) {
    let load = with_load(&trio(), 0.8);
    let put_down = |_: usize, motion: &Motion, tau: &mut [f64]| {
        if motion.clock < end {
            let [mut with, mut without] = [[0.0; 3]; 2];
            for (arm, tau) in [(&load, &mut with), (&trio(), &mut without)] {
                arm.inverse_dynamics(&mut Workspace::new(arm), &motion.q, &motion.qd, &motion.qdd, tau);
            }
            (0..3).for_each(|joint| tau[joint] += with[joint] - without[joint]);
        }
    };
    let diagnosis = diagnosed([0.0; 4], |_, _| true, put_down);
    assert_load(&diagnosis, recordings, 0.8);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
    let until = diagnosis.report.different_load.and_then(|load| load.until);
    assert!(until.is_some_and(|until| (until - end).abs() < 0.1), "{until:?}, not {end}");
}

/// A push is no load.
#[test]
fn a_push_is_not_reported_as_another_load() {
    let is_reported = |diagnosis: &Diagnosis| diagnosis.report.different_load.is_some();
    let push = |variant: usize, motion: &Motion, tau: &mut [f64]| {
        if variant == 1 && (5.0..7.0).contains(&motion.time) {
            tau[SHOULDER] += 6.0;
            tau[ELBOW] += 3.0;
        }
    };
    assert!(!is_reported(&diagnosed([0.0; 4], |_, _| true, push)));
}

/// A body at the tool is a change of the last link, so that either is named alone. An error of that link and a body of the opposite
/// sign would need fewer coefficients than another body of the link.
#[test]
fn a_change_of_the_last_link_is_one_body() {
    let arm = trio();
    let last = arm.joints()[ELBOW].inertia.mass;
    for share in [0.5, 1.0] {
        let robot = arm.clone().with_scaled_link(ELBOW, 1.0 + share).with_payload(&Inertia {
            mass: -0.8 * share * last,
            com: Vector3::new(0.01, 0.0, -0.02),
            tensor: Matrix3::zeros(),
        });
        let friction = |motion: &mut Motion, tau: &mut [f64]| baseline_friction(motion, tau);
        let diagnosis = crate::support::diagnosed(&arm, &robot, &friction, Vec::new());
        let bodies = ["payload", "link_inertial_error", "inertial_parameters"];
        let named = named(&diagnosis);
        let of_bodies = named.iter().filter(|(effect, _)| bodies.contains(effect)).count();
        assert_eq!(of_bodies, 1, "{:?}", sentences(&diagnosis));
    }
}

/// Rows at rest are not fitted. A push on a joint that rests is in no finding, and is noted with its time.
#[test]
fn a_push_on_a_joint_at_rest_is_noted() {
    let notes = |push: f64| {
        let injected = |variant: usize, motion: &Motion, tau: &mut [f64]| {
            if variant == 1 && (6.0..7.5).contains(&motion.time) {
                tau[ELBOW] += push;
            }
        };
        let diagnosis = diagnosed([0.0; 4], |variant, joint| variant != 1 || joint != ELBOW, injected);
        assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
        let notes = diagnosis.remarks.into_iter();
        notes.filter(|note| note.contains("dry friction explains")).collect::<Vec<_>>()
    };
    assert!(notes(0.0).is_empty());
    let [note] = &notes(15.0)[..] else { panic!("one note is expected") };
    assert!(note.starts_with("b: elbow rests between 1006."), "{note}");
}

/// The load of the held-out recording, the last one on a common clock, is found there, and in its prediction.
#[test]
fn a_load_of_the_held_out_recording_alone_is_in_its_prediction() {
    let recordings: Vec<RegularRecording> = (0..3)
        .map(|variant| {
            let robot = with_load(&trio(), if variant == 2 { 0.8 } else { 0.0 });
            let friction = |motion: &mut Motion, tau: &mut [f64]| baseline_friction(motion, tau);
            regular(&recorded(&robot, variant, 16.0, &friction))
        })
        .collect();
    let diagnosis = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    assert_load(&diagnosis, &["c"], 0.8);
    assert!(
        named(&diagnosis).is_empty() && diagnosis.report.unexplained.is_empty(),
        "{:?}",
        diagnosis.report.unexplained
    );
    for (joint, fit) in &diagnosis.report.fit {
        assert!(fit.held_out_nrmse_augmented.is_some_and(|error| error < 0.03), "{joint}: {fit:?}");
    }
}

/// A stated accuracy of the torque constants is in the interval of a mass once, not multiplied by what is not known of the drives. Constants
/// that differ from joint to joint change the mass by more than their deviation.
#[test]
fn the_interval_of_a_payload_has_the_stated_accuracy_once() {
    let accuracy = 0.03;
    let options = Options { torque_accuracy: Some(accuracy), urdf_accuracy: Some(0.0), ..Options::default() };
    let friction = |motion: &mut Motion, tau: &mut [f64]| baseline_friction(motion, tau);
    let found = diagnosed_with(&trio(), &with_load(&trio(), 1.0), &friction, &options);
    let report = found.expect("it can be diagnosed").report;
    let payload = report.findings.iter().find(|finding| finding.effect == "payload").expect("there is one");
    let mass = &payload.parameters["mass"];
    let half = 0.5 * (mass.ci95[1] - mass.ci95[0]) / mass.value;
    assert!((mass.value - 1.0).abs() < 0.02, "{mass:?}");
    assert!((1.96 * accuracy..5.0 * accuracy).contains(&half), "{half}: {mass:?}");
}
