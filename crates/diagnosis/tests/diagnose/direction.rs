//! Constant torques of a sensor, and friction that depends on the direction: they differ where friction differs between recordings.

use crate::support::{ELBOW, Motion, effects_on, exports_what_it_reports, inputs, recorded, regular, sentences, trio};
use diagnosis::{Diagnosis, Finding, Options, diagnose};
use effects::Effect;
use recording::RegularRecording;

/// The diagnosis of four recordings of 16 s, the third held out, with friction of `warmth` times its level in each. On the elbow, the
/// friction forwards exceeds that backwards by twice `half`, and the sensor has an `offset` (N m).
fn diagnosed(warmth: [f64; 4], half: f64, offset: f64) -> Diagnosis {
    diagnosed_with(warmth, [half, offset, 0.0], &[])
}

/// The same with `known` effects, and with `excess` of the friction at standstill (N m) on the elbow.
fn diagnosed_with(warmth: [f64; 4], [half, offset, excess]: [f64; 3], known: &[Effect]) -> Diagnosis {
    let robot = trio();
    let record = |variant: usize| {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            for (joint, &speed) in motion.qd.iter().enumerate() {
                let [half, excess] = if joint == ELBOW { [half, excess] } else { [0.0; 2] };
                let level = 0.6 + excess * (-(speed / 0.1).powi(2)).exp();
                tau[joint] += warmth[variant] * (level * speed.signum() + half) + 0.4 * speed;
            }
            tau[ELBOW] += offset;
        };
        regular(&recorded(&robot, variant, 16.0, &injected))
    };
    let recordings: Vec<RegularRecording> = (0..4).map(record).collect();
    let options = Options { known: known.to_vec(), ..Options::default() };
    diagnose(&robot, &inputs(&recordings), &options, &|_| {}).expect("it can be diagnosed")
}

/// The only finding for a constant torque, and whether the other name is its alternative.
fn constant(diagnosis: &Diagnosis) -> (&Finding, bool) {
    let names = ["friction_asymmetry", "torque_offset"];
    let findings = diagnosis.report.findings.iter();
    let constants: Vec<&Finding> = findings.filter(|finding| names.contains(&finding.effect)).collect();
    let [finding] = constants[..] else {
        panic!("{:?}", sentences(diagnosis));
    };
    assert_eq!(finding.joint.as_deref(), Some("elbow"));
    let is_alias = |other: &diagnosis::Confusable| names.contains(&other.effect) && other.joint == finding.joint;
    (finding, finding.confusable_with.iter().any(is_alias))
}

/// The friction of each recording, relative to its usual level.
const WARMTH: [f64; 4] = [0.8, 1.25, 1.1, 1.0];

#[test]
fn a_constant_that_changes_with_the_friction_is_asymmetric_friction() {
    // The larger one, three quarters of the friction, would be called an offset by its size.
    for half in [0.2, 0.45] {
        let diagnosis = diagnosed(WARMTH, half, 0.0);
        let (finding, _) = constant(&diagnosis);
        assert_eq!(finding.effect, "friction_asymmetry", "{half}");
        assert!(finding.probability > Some(0.55), "{half}: {finding:?}");
    }
}

#[test]
fn a_constant_that_stays_while_the_friction_changes_is_an_offset() {
    // By its size, a third of the friction, it would be called asymmetric friction.
    let diagnosis = diagnosed(WARMTH, 0.0, 0.2);
    let (finding, _) = constant(&diagnosis);
    assert_eq!(finding.effect, "torque_offset");
    assert!((finding.parameters["offset"].value - 0.2).abs() < 0.02, "{finding:?}");
}

/// The same friction in all recordings distinguishes nothing.
#[test]
fn equal_friction_leaves_the_alternative() {
    // The last has friction in one direction only, and a fit of it may be negative in the other.
    for (half, offset) in [(0.2, 0.0), (0.0, 0.2), (0.605, 0.0)] {
        let diagnosis = diagnosed([1.0; 4], half, offset);
        let (finding, has_alias) = constant(&diagnosis);
        assert!(has_alias && finding.probability == Some(0.5), "{finding:?}");
    }
}

/// Beside another dry friction, the Coulomb level is stated once, so that the exported model is the fitted one.
#[test]
fn an_offset_beside_another_friction_states_no_second_level() {
    let sizes = [0.0, 0.25, 0.6];
    let diagnosis = diagnosed_with(WARMTH, sizes, &[]);
    let (finding, _) = constant(&diagnosis);
    assert_eq!(finding.effect, "torque_offset");
    let elbow = effects_on(&diagnosis, "elbow");
    assert!(elbow.contains(&"stribeck_friction") && !elbow.contains(&"coulomb_friction"), "{elbow:?}");
    exports_what_it_reports(&diagnosis, &diagnosed_with(WARMTH, sizes, &diagnosis.effects), 0.2);
}
