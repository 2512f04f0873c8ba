//! Effects that set in halfway, with their onset.

mod support;

use arm::Vector3;
use support::{ELBOW, Motion, diagnosed, ordinary, sentences, trio};

/// What sets in halfway is named with its onset, whatever it is.
#[test]
fn what_sets_in_has_its_onset() {
    let name = trio().joints()[ELBOW].name.clone();
    let onset = 1006.0;
    let offset = |_: &Motion| 1.5;
    let spring = |m: &Motion| 4.0 * (m.q[ELBOW] - 0.3);
    type Torque<'a> = &'a dyn Fn(&Motion) -> f64;
    let effects: [(&str, Torque<'_>); 2] = [("torque_offset", &offset), ("spring", &spring)];
    for (effect, torque) in effects {
        let concealed = |motion: &mut Motion, tau: &mut [f64]| {
            ordinary(motion, tau);
            if motion.clock >= onset {
                tau[ELBOW] += torque(motion);
            }
        };
        let diagnosis = diagnosed(&trio(), &trio(), &concealed, Vec::new());
        let finding = diagnosis.report.findings.iter().find(|f| f.effect == effect);
        let left = &diagnosis.report.unexplained;
        let finding = finding.unwrap_or_else(|| panic!("{effect}: {:?} {left:?}", sentences(&diagnosis)));
        assert_eq!(finding.joint.as_deref(), Some(name.as_str()));
        let found = finding.parameters["onset"].value;
        assert!((found - onset).abs() < 0.1, "{effect}: {found}");
        assert!(finding.sentence.contains("from 1006 s on"), "{}", finding.sentence);
        let again = diagnosed(&trio(), &trio(), &concealed, diagnosis.effects.clone());
        assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
    }
}

/// A payload picked up halfway is one payload, not what it does to each joint.
#[test]
fn a_payload_picked_up_has_its_onset() {
    let body = arm::Inertia {
        mass: 1.2,
        com: Vector3::new(0.02, -0.01, 0.08),
        tensor: arm::Matrix3::identity() * 2e-3,
    };
    let (empty, loaded) = (trio(), trio().with_payload(&body));
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        if motion.clock >= 1006.0 {
            loaded.inverse_dynamics(
                &mut arm::Workspace::new(&loaded),
                &motion.q,
                &motion.qd,
                &motion.qdd,
                tau,
            );
        }
        ordinary(motion, tau);
    };
    let diagnosis = diagnosed(&empty, &empty, &concealed, Vec::new());
    let plain = ["viscous_friction", "coulomb_friction"];
    let special = diagnosis.report.findings.iter().filter(|f| !plain.contains(&f.effect));
    let special: Vec<_> = special.collect();
    assert_eq!(special.len(), 1, "{:?}", sentences(&diagnosis));
    assert_eq!(special[0].effect, "payload");
    let parameters = &special[0].parameters;
    assert!((parameters["mass"].value - 1.2).abs() < 0.03, "{parameters:?}");
    assert!((parameters["onset"].value - 1006.0).abs() < 0.1, "{parameters:?}");
    let again = diagnosed(&empty, &empty, &concealed, diagnosis.effects.clone());
    assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
}
