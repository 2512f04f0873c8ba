//! Effects with an onset within the recordings.

use crate::support::{ELBOW, Motion, baseline_friction, diagnosed, diagnosed_with, named, sentences, trio};
use arm::Vector3;
use diagnosis::{Options, Wanted};

/// Effects that begin within the recordings are named with their onset.
#[test]
fn an_effect_with_an_onset_is_named_with_it() {
    let name = trio().joints()[ELBOW].name.clone();
    let onset = 1006.0;
    let offset = |_: &Motion| 1.5;
    let spring = |m: &Motion| 4.0 * (m.q[ELBOW] - 0.3);
    // The exponent is found by a refinement, so that no candidate with this exponent always acts.
    let drag = |m: &Motion| 3.0 * m.qd[ELBOW] * m.qd[ELBOW].abs().powf(1.3);
    type Torque<'a> = &'a dyn Fn(&Motion) -> f64;
    let effects: [(&str, Torque<'_>); 3] = [("torque_offset", &offset), ("spring", &spring), ("quadratic_drag", &drag)];
    for (effect, torque) in effects {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            if motion.clock >= onset {
                tau[ELBOW] += torque(motion);
            }
        };
        let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
        let finding = diagnosis.report.findings.iter().find(|f| f.effect == effect);
        let left = &diagnosis.report.unexplained;
        let finding = finding.unwrap_or_else(|| panic!("{effect}: {:?} {left:?}", sentences(&diagnosis)));
        assert_eq!(finding.joint.as_deref(), Some(name.as_str()));
        let found = &finding.parameters["onset"];
        assert!((found.value - onset).abs() < 0.1, "{effect}: {found:?}");
        // The interval is that of the recordings, and not a part of the absolute time.
        let [low, high] = found.ci95;
        assert!(low <= onset && onset <= high && high - low < 1.0, "{effect}: {found:?}");
        assert!(finding.sentence.contains("from 1006 s on"), "{}", finding.sentence);
        let again = diagnosed(&trio(), &trio(), &injected, diagnosis.effects.clone());
        assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
    }
}

/// The torques of the arm, with a payload of 1.2 kg from 1006 s on.
fn picked_up() -> impl Fn(&mut Motion, &mut [f64]) {
    let loaded = trio().with_payload(&arm::Inertia {
        mass: 1.2,
        com: Vector3::new(0.02, -0.01, 0.08),
        tensor: arm::Matrix3::identity() * 2e-3,
    });
    move |motion, tau| {
        if motion.clock >= 1006.0 {
            let mut workspace = arm::Workspace::new(&loaded);
            loaded.inverse_dynamics(&mut workspace, &motion.q, &motion.qd, &motion.qdd, tau);
        }
    }
}

/// A payload that is picked up within the recordings is named as one payload, and not as effects on each joint.
#[test]
fn a_payload_picked_up_has_its_onset() {
    let (empty, picked_up) = (trio(), picked_up());
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        picked_up(motion, tau);
        baseline_friction(motion, tau);
    };
    let diagnosis = diagnosed(&empty, &empty, &injected, Vec::new());
    let plain = ["viscous_friction", "coulomb_friction"];
    let special = diagnosis.report.findings.iter().filter(|f| !plain.contains(&f.effect));
    let special: Vec<_> = special.collect();
    assert_eq!(special.len(), 1, "{:?}", sentences(&diagnosis));
    assert_eq!(special[0].effect, "payload");
    let parameters = &special[0].parameters;
    assert!((parameters["mass"].value - 1.2).abs() < 0.03, "{parameters:?}");
    assert!((parameters["onset"].value - 1006.0).abs() < 0.1, "{parameters:?}");
    let again = diagnosed(&empty, &empty, &injected, diagnosis.effects.clone());
    assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
}

/// A wrong torque constant also multiplies the torque of a payload that is picked up within the recordings.
#[test]
fn a_torque_constant_multiplies_a_payload_picked_up() {
    let (empty, picked_up) = (trio(), picked_up());
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        picked_up(motion, tau);
        baseline_friction(motion, tau);
        tau[ELBOW] *= 1.3;
    };
    let diagnosis = diagnosed(&empty, &empty, &injected, Vec::new());
    let names = [("payload", None), ("torque_scale", Some("elbow"))];
    let mut found = named(&diagnosis);
    found.sort_unstable();
    assert_eq!(found, names, "{:?}", sentences(&diagnosis));
    let of = |effect: &str, parameter: &str| {
        let mut findings = diagnosis.report.findings.iter();
        let finding = findings.find(|finding| finding.effect == effect);
        finding.expect("it is found").parameters[parameter].value
    };
    assert!((of("payload", "mass") - 1.2).abs() < 0.03, "{}", of("payload", "mass"));
    let factor = of("torque_scale", "factor");
    assert!((factor - 1.3).abs() < 0.02, "{factor}");
}

/// An effect that is requested with an onset is fitted with an onset.
#[test]
fn an_effect_requested_with_an_onset_is_fitted_with_it() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        if motion.clock >= 1006.0 {
            tau[ELBOW] += 1.5;
        }
    };
    let offset_of = |sets_in: Option<bool>| {
        let offset = Wanted {
            effect: "torque_offset".to_owned(),
            joint: Some(trio().joints()[ELBOW].name.clone()),
            sets_in,
            ..Wanted::default()
        };
        let options = Options { only: Some(vec![offset]), ..Options::default() };
        let diagnosis = diagnosed_with(&trio(), &trio(), &injected, &options).expect("it can be fitted");
        let parameters = diagnosis.report.findings[0].parameters.clone();
        let onset = parameters.get("onset").map(|onset| onset.value);
        (onset, parameters["offset"].value)
    };
    for open_or_late in [None, Some(true)] {
        let (onset, offset) = offset_of(open_or_late);
        assert!(onset.is_some_and(|onset| (onset - 1006.0).abs() < 0.1), "{onset:?}");
        assert!((offset - 1.5).abs() < 0.05, "{offset}");
    }
    let (onset, offset) = offset_of(Some(false));
    assert!(onset.is_none() && offset < 1.4, "{onset:?} {offset}");
}

/// A torque constant that changes multiplies friction and the rotor's torque, too: neither a wrong factor nor a constant torque is
/// named.
#[test]
fn a_torque_constant_that_changes_multiplies_the_whole_torque() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        tau[ELBOW] += 1.5 * motion.qdd[ELBOW] + 3.0 * motion.qd[ELBOW];
        baseline_friction(motion, tau);
        if motion.clock >= 1006.0 {
            tau[ELBOW] *= 1.2;
        }
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let name = trio().joints()[ELBOW].name.clone();
    let special: Vec<_> = named(&diagnosis).into_iter().filter(|(effect, _)| *effect != "rotor_inertia").collect();
    assert_eq!(special, [("torque_scale", Some(name.as_str()))], "{:?}", sentences(&diagnosis));
    let finding = diagnosis.report.findings.iter().find(|finding| finding.effect == "torque_scale");
    let parameters = &finding.expect("it is named").parameters;
    assert!((parameters["factor"].value - 1.2).abs() < 0.01, "{parameters:?}");
}
