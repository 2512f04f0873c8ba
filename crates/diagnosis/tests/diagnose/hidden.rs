//! Effects that a part of the recordings hides: their own joint, the size of the held-out torques, noise.

use std::cell::{Cell, RefCell};

use crate::support::{
    ELBOW, Motion, SHOULDER, TURN, baseline_friction, diagnosed, effects_on, named, sentences, start, trio, uniform,
};
use arm::{Inertia, Joint, Matrix3, Vector3, Workspace};

/// The drive of the shoulder also turns with the column. Noise hides it on the shoulder, and the column shows it.
#[test]
fn a_coupling_that_only_the_other_joint_shows() {
    for seed in 1..=6 {
        let state = Cell::new(seed);
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            tau[SHOULDER] += 0.1 * motion.qd[TURN] + 10.0 * uniform(&state);
            tau[TURN] += 0.1 * motion.qd[SHOULDER];
        };
        let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
        let expected = [("transmission_coupling", Some("shoulder"))];
        assert_eq!(named(&diagnosis), expected, "{seed}: {:?}", sentences(&diagnosis));
    }
}

/// A torque on the column alone that follows the speed of the shoulder: no drive turns with both, because the shoulder has no reaction,
/// although noise hides most of it.
#[test]
fn a_torque_on_one_joint_alone_is_no_coupling() {
    let state = Cell::new(1);
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 4.0 * uniform(&state);
        tau[TURN] += 0.4 * motion.qd[SHOULDER];
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    assert_eq!(named(&diagnosis), [], "{:?}", sentences(&diagnosis));
    let column = trio().joints()[TURN].name.clone();
    let open = diagnosis.report.unexplained.iter().map(|open| &open.joint);
    assert!(open.eq([&column]), "{:?}", diagnosis.report.unexplained);
}

/// A body on the tool in the second of two recordings, so heavy that no masses explain both, but some explain each.
#[test]
fn a_load_in_one_recording_is_no_other_signal() {
    let loaded = trio().with_payload(&Inertia {
        mass: 25.0,
        com: Vector3::new(0.0, 0.0, -1.2),
        tensor: Matrix3::identity() * 0.1,
    });
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        if motion.clock >= start(1) {
            loaded.inverse_dynamics(&mut Workspace::new(&loaded), &motion.q, &motion.qd, &motion.qdd, tau);
        }
        baseline_friction(motion, tau);
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    assert!(diagnosis.report.not_diagnosed.is_empty(), "{:?}", diagnosis.report.not_diagnosed);
}

/// The torques that the held-out recording commands are several times as large as those of the training recordings, in which the
/// limit is found.
#[test]
fn a_torque_limit_far_below_the_held_out_torques() {
    let limit = 33.0;
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        // A position loop commands far more than the limit: the held-out one when the joint nears it.
        let (is_held_out, size) = (motion.clock >= start(2), tau[SHOULDER].abs());
        let beyond = match is_held_out {
            true if size > 29.0 => limit + 112.0 - size,
            true => 0.0,
            false => 15.0 * (size - limit).max(0.0),
        };
        tau[SHOULDER] += beyond * tau[SHOULDER].signum();
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let mut findings = diagnosis.report.findings.iter();
    let is_limit = |finding: &&diagnosis::Finding| finding.effect == "torque_saturation";
    let found = findings.find(|finding| is_limit(finding) && finding.joint.as_deref() == Some("shoulder"));
    let found = found.unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis))).parameters["limit"];
    assert!((found.value / limit - 1.0).abs() < 0.03, "{found:?}");
}

/// Where noise hides viscous friction, Coulomb friction takes its place and is too large; its interval contains the true level.
#[test]
fn the_level_of_friction_beside_viscous_friction_that_noise_hides() {
    let (level, coefficient) = (0.6, 0.12);
    let state = Cell::new(1);
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        for joint in 0..3 {
            let speed = motion.qd[joint];
            tau[joint] += level * speed.signum() + coefficient * speed + [6.0, 20.0, 8.0][joint] * uniform(&state);
        }
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let findings = diagnosis.report.findings.iter();
    let frictions = findings.filter(|finding| finding.effect == "coulomb_friction");
    let elbow = trio().joints()[ELBOW].name.clone();
    let mut seen = false;
    for finding in frictions {
        let [low, high] = finding.parameters["level"].ci95;
        assert!(low <= level && level <= high, "{low} to {high}: {}", finding.sentence);
        seen |= finding.joint.as_ref() == Some(&elbow);
    }
    assert!(seen, "{:?}", sentences(&diagnosis));
    let is_viscous = |finding: &diagnosis::Finding| finding.effect == "viscous_friction";
    assert!(!diagnosis.report.findings.iter().any(is_viscous), "{:?}", sentences(&diagnosis));
}

/// The largest torque of a recording lasts for a few samples, so that a limit just below it would not show.
#[test]
fn a_limit_that_would_be_seen_removes_enough_torque_to_show() {
    let torques = RefCell::new(Vec::new());
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        torques.borrow_mut().push(tau.to_vec());
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let limits = diagnosis.report.not_observable.iter().filter(|entry| entry.effect == "torque_saturation");
    let mut seen = 0;
    for entry in limits {
        let joint =
            trio().joints().iter().position(|joint| Some(&joint.name) == entry.joint.as_ref()).expect("a joint");
        let Some(&limit) = entry.would_be_seen_below.get("limit") else { continue };
        let torques = torques.borrow();
        let sum_of_squares = |of: &dyn Fn(f64) -> f64| torques.iter().map(|tau| of(tau[joint]).powi(2)).sum::<f64>();
        let removed = sum_of_squares(&|tau| tau - tau.clamp(-limit, limit)) / sum_of_squares(&|tau| tau);
        assert!(removed.sqrt() > 0.005, "{:?}: {limit}, {removed}", entry.joint);
        seen += 1;
    }
    assert!(seen > 0, "{:?}", diagnosis.report.not_observable);
}

/// All links are wrong in the URDF. The elbow has a torque that resembles a weight, which is the opposite one in the
/// held-out recording, so that the correction of the links increases its error. The ripple on the elbow does not, and keeps its name.
#[test]
fn a_joint_that_something_else_harms_keeps_its_names() {
    let changed = |(joint, (factor, shift)): (&Joint, (f64, f64))| Inertia {
        mass: joint.inertia.mass * factor,
        com: joint.inertia.com + Vector3::new(shift, -shift, shift),
        ..joint.inertia
    };
    let wrong: Vec<Inertia> =
        trio().joints().iter().zip([(1.15, 0.05), (0.88, -0.04), (1.09, 0.0)]).map(changed).collect();
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        let without_friction = tau[ELBOW];
        baseline_friction(motion, tau);
        let is_held_out = motion.clock >= start(2);
        let weight = 0.5 * (motion.q[SHOULDER] + motion.q[ELBOW]).sin();
        let ripple = 0.25 * (17.0 * motion.q[ELBOW] + 0.6).sin();
        tau[ELBOW] = without_friction + ripple + if is_held_out { -weight } else { weight };
    };
    let diagnosis = diagnosed(&trio().with_inertias(&wrong), &trio(), &injected, Vec::new());
    let elbow = &diagnosis.report.fit["elbow"];
    let [nominal, found] =
        [elbow.held_out_nrmse_nominal, elbow.held_out_nrmse_augmented].map(|error| error.expect("it is moved"));
    assert!(found > 1.05 * nominal, "nothing harms it: {elbow:?}");
    assert!(named(&diagnosis).contains(&("inertial_parameters", None)), "{:?}", sentences(&diagnosis));
    assert_eq!(effects_on(&diagnosis, "elbow"), ["torque_ripple"], "{:?}", sentences(&diagnosis));
}
