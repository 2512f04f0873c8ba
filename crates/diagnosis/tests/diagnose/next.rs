//! The next experiment: a motion within the limits that distinguishes what the recordings do not, and no motion if none
//! does.

use crate::support::{ELBOW, Motion, SHOULDER, diagnosed_with, inputs, recorded, regular, trio};
use diagnosis::{Diagnosis, NextExperiment, Obstacle, Options, diagnose};
use effects::Effect;
use effects::drive::TORQUE_SATURATION;
use recording::{Recording, RegularRecording};
use torque::Reference;

fn proposed(injected: crate::support::Injected<'_>) -> (Diagnosis, NextExperiment) {
    let options = Options { next: true, ..Options::default() };
    let diagnosis = diagnosed_with(&trio(), &trio(), injected, &options).expect("it can be diagnosed");
    let next = diagnosis.report.next_experiment.clone().expect("it was asked for");
    (diagnosis, next)
}

/// Friction that only a wider range of speeds distinguishes from drag.
fn friction(motion: &mut Motion, tau: &mut [f64]) {
    for (joint, level, coefficient) in [(SHOULDER, 0.8, 0.18), (ELBOW, 0.4, 0.084)] {
        let speed = motion.qd[joint];
        tau[joint] += level * speed.signum() + coefficient * speed;
    }
}

fn is_confused(diagnosis: &Diagnosis, effect: &str, rival: &str) -> bool {
    let mut findings = diagnosis.report.findings.iter();
    findings.any(|f| f.effect == effect && f.confusable_with.iter().any(|other| other.effect == rival))
}

/// A recording of the arm with the torques `injected` along `reference`.
fn made(reference: &Reference, seconds: f64, injected: crate::support::Injected<'_>) -> Recording {
    let along = |motion: &mut Motion, tau: &mut [f64]| {
        let mut wanted = torque::Motion::new(3);
        reference.at(motion.time, &mut wanted);
        *motion = Motion { time: motion.time, clock: motion.clock, q: wanted.q, qd: wanted.qd, qdd: wanted.qdd };
        let arm = trio();
        let mut workspace = arm::Workspace::new(&arm);
        arm.inverse_dynamics(&mut workspace, &motion.q, &motion.qd, &motion.qdd, tau);
        injected(motion, tau);
    };
    recorded(&trio(), 3, seconds, &along)
}

#[test]
fn a_faster_motion_distinguishes_viscous_friction_from_drag() {
    let (diagnosis, next) = proposed(&friction);
    assert!(is_confused(&diagnosis, "viscous_friction", "quadratic_drag"), "{next:#?}");
    let listed = next.separates.iter().filter(|pair| pair.rival.effect == "quadratic_drag");
    assert!(listed.clone().count() > 0, "{next:#?}");
    for pair in listed {
        assert!(pair.after > pair.needed && pair.after > pair.before, "{pair:?}");
    }
    // The prediction is correct.
    let motion = diagnosis.next.expect("a motion");
    let seconds = next.duration.expect("a duration");
    let mut recordings: Vec<RegularRecording> = [16.0, 16.0, 10.0]
        .into_iter()
        .enumerate()
        .map(|(variant, seconds)| regular(&recorded(&trio(), variant, seconds, &friction)))
        .collect();
    recordings.push(regular(&made(&motion, seconds, &friction)));
    let second = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    let named = second.report.findings.iter().filter(|f| f.effect == "viscous_friction");
    assert_eq!(named.count(), 2, "{:?}", second.report.findings);
    assert!(!is_confused(&second, "viscous_friction", "quadratic_drag"));
}

/// Links that are all wrong explain as much of the recordings in the prediction as they do in the diagnosis.
#[test]
fn a_motion_is_predicted_beside_links_that_are_all_wrong() {
    let mut believed = trio();
    for (link, factor, shift) in [(0, 1.08, 0.006), (1, 0.92, -0.008), (2, 1.1, 0.01)] {
        let mut body = believed.joints()[link].inertia;
        body.com += shift * arm::Vector3::new(1.0, -1.0, 1.0);
        believed = believed.with_link_inertia(link, body).with_scaled_link(link, factor);
    }
    let options = Options { next: true, ..Options::default() };
    let diagnosis = diagnosed_with(&believed, &trio(), &friction, &options).expect("it can be diagnosed");
    assert!(!diagnosis.report.inertials.is_empty(), "no link is wrong");
    assert!(is_confused(&diagnosis, "viscous_friction", "quadratic_drag"));
    let next = diagnosis.report.next_experiment.expect("it was asked for");
    // Without the background, no such pair was predicted.
    let is_drag = |pair: &&diagnosis::NotSeparated| pair.rival.effect == "quadratic_drag";
    let predicted = [Obstacle::OutOfReach, Obstacle::AnotherMotion, Obstacle::SameTorque];
    let is_any_predicted = next.separates.iter().any(|pair| pair.rival.effect == "quadratic_drag")
        || next.not_separated.iter().filter(is_drag).any(|pair| predicted.contains(&pair.kind));
    assert!(is_any_predicted, "{next:#?}");
    for seen in &next.shows {
        let is_an_angle = seen.effect == "encoder_offset";
        assert!(!is_an_angle || seen.after < std::f64::consts::PI, "{seen:?}");
    }
}

#[test]
fn a_motion_stays_within_the_limits() {
    let (diagnosis, next) = proposed(&friction);
    let motion = diagnosis.next.expect("a motion");
    let arm = trio();
    let mut at = torque::Motion::new(3);
    let mut workspace = arm::Workspace::new(&arm);
    let mut tau = vec![0.0; 3];
    for k in 0..25_000 {
        motion.at(f64::from(k) / 1e3, &mut at);
        arm.inverse_dynamics(&mut workspace, &at.q, &at.qd, &at.qdd, &mut tau);
        for (j, joint) in arm.joints().iter().enumerate() {
            assert!((joint.limits.lower..=joint.limits.upper).contains(&at.q[j]), "{} {}", joint.name, at.q[j]);
            assert!(at.qd[j].abs() <= 0.85 * joint.limits.velocity, "{} {}", joint.name, at.qd[j]);
            assert!(tau[j].abs() + 2.5 <= 0.9 * joint.limits.effort, "{} {}", joint.name, tau[j]);
        }
    }
    for joint in &next.limits {
        assert!(joint.position_allowed[0] <= joint.position[0] && joint.position[1] <= joint.position_allowed[1]);
        assert!(joint.velocity <= joint.velocity_allowed && joint.torque <= joint.torque_allowed, "{joint:?}");
    }
    // It begins and ends at rest.
    for time in [0.0, 25.0] {
        motion.at(time, &mut at);
        assert!(at.qd.iter().chain(&at.qdd).all(|&v| v == 0.0));
    }
    // For a weak and slow arm, a motion that it can perform is proposed.
    let weak = crate::support::TRIO.replace("effort=\"200\" velocity=\"5\"", "effort=\"45\" velocity=\"1.5\"");
    let weak = arm::Arm::from_urdf_text(&weak, "weak.urdf").expect("it is an arm");
    let options = Options { next: true, ..Options::default() };
    let diagnosis = diagnosed_with(&weak, &weak, &friction, &options).expect("it can be diagnosed");
    let next = diagnosis.report.next_experiment.expect("it was asked for");
    for joint in &next.limits {
        assert!(joint.velocity <= 1.5 && joint.torque <= 45.0, "{joint:?}");
    }
}

#[test]
fn effects_that_no_motion_distinguishes_have_advice() {
    let asymmetric = |motion: &mut Motion, tau: &mut [f64]| {
        let speed = motion.qd[ELBOW];
        tau[ELBOW] += if speed > 0.0 { 2.2 } else { -1.1 };
    };
    let (diagnosis, next) = proposed(&asymmetric);
    assert!(is_confused(&diagnosis, "friction_asymmetry", "torque_offset"), "{:?}", diagnosis.report.findings);
    assert!(!next.separates.iter().any(|pair| pair.rival.effect == "torque_offset"));
    let pair = next.not_separated.iter().find(|pair| pair.rival.effect == "torque_offset");
    let pair = pair.expect("it is said");
    assert_eq!(pair.kind, Obstacle::SameTorque);
    assert!(pair.instead.contains("brake"), "{}", pair.instead);
}

#[test]
fn the_proposal_does_not_depend_on_the_threads() {
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| proposed(&friction).0.next)
    };
    assert_eq!(of(1), of(3));
}

/// A torque offset that is too small to be named as friction that depends on the direction may be such friction.
#[test]
fn an_offset_beside_larger_friction_has_advice() {
    let offset = |motion: &mut Motion, tau: &mut [f64]| {
        crate::support::baseline_friction(motion, tau);
        tau[ELBOW] += 3.0 * motion.qd[ELBOW].signum() + 0.3;
    };
    let (diagnosis, next) = proposed(&offset);
    assert!(
        is_confused(&diagnosis, "torque_offset", "friction_asymmetry"),
        "{:?}",
        crate::support::sentences(&diagnosis)
    );
    let mut pairs = next.not_separated.iter();
    let pair = pairs.find(|pair| pair.rival.effect == "friction_asymmetry");
    let pair = pair.expect("it is said");
    assert_eq!(pair.kind, Obstacle::SameTorque);
    assert!(pair.instead.contains("brake"), "{}", pair.instead);
}

/// An onset of direction-dependent friction equals an onset of an offset in every motion, so that no motion is promised to
/// distinguish them.
#[test]
fn no_motion_is_promised_for_an_offset_with_an_onset() {
    let later = |motion: &mut Motion, tau: &mut [f64]| {
        crate::support::baseline_friction(motion, tau);
        if motion.clock >= 1006.0 {
            tau[ELBOW] += 0.4;
        }
    };
    let (diagnosis, next) = proposed(&later);
    let is_it = |finding: &diagnosis::Confusable, rival: &diagnosis::Confusable| {
        (finding.effect, rival.effect) == ("torque_offset", "friction_asymmetry")
    };
    assert!(
        is_confused(&diagnosis, "torque_offset", "friction_asymmetry"),
        "{:?}",
        crate::support::sentences(&diagnosis)
    );
    assert!(!next.separates.iter().any(|pair| is_it(&pair.finding, &pair.rival)));
    let pair = next.not_separated.iter().find(|pair| is_it(&pair.finding, &pair.rival));
    let pair = pair.expect("it is said");
    assert_eq!((pair.kind, pair.best), (Obstacle::SameTorque, 0.0));
    // No pair that is already distinguished is listed.
    for pair in &next.separates {
        assert!(pair.before < pair.needed, "{pair:?}");
    }
}

/// A torque limit that was found bounds the motion, and is not a part of the predicted torque.
#[test]
fn a_motion_stays_within_a_torque_limit_that_was_found() {
    let (_, unlimited) = proposed(&friction);
    let limit = 36.0;
    assert!(unlimited.limits[SHOULDER].torque > 1.1 * limit, "{unlimited:#?}");
    let options = Options {
        next: true,
        known: vec![Effect::of(&TORQUE_SATURATION).on("shoulder").with("limit", limit)],
        ..Options::default()
    };
    let diagnosis = diagnosed_with(&trio(), &trio(), &friction, &options).expect("it can be diagnosed");
    let next = diagnosis.report.next_experiment.expect("it was asked for");
    let motion = diagnosis.next.expect("a motion");
    assert!(next.limits[SHOULDER].torque_allowed <= limit, "{:?}", next.limits);
    let arm = trio();
    let (mut at, mut tau) = (torque::Motion::new(3), vec![0.0; 3]);
    let mut workspace = arm::Workspace::new(&arm);
    for k in 0..5000 {
        motion.at(f64::from(k) / 200.0, &mut at);
        arm.inverse_dynamics(&mut workspace, &at.q, &at.qd, &at.qdd, &mut tau);
        assert!(tau[SHOULDER].abs() <= limit, "{k}: {}", tau[SHOULDER]);
    }
}
