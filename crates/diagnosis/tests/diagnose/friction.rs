//! Friction curves of real drives: neither their form nor their change between recordings is named as another effect.

use crate::support::{
    ELBOW, Motion, baseline_friction, diagnosed, effects_on, inputs, recorded, regular, sentences, start, trio,
};
use diagnosis::{Diagnosis, Input, Options, diagnose};
use recording::RegularRecording;

/// Friction that only reaches its level at some speed is not larger at standstill.
#[test]
fn friction_that_grows_gradually_is_not_stribeck_friction() {
    for (reached, level) in [(0.2, 0.5), (0.3, 1.0), (0.4, 0.5)] {
        // Linear up to the speed at which it slides.
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            for (tau, &speed) in tau.iter_mut().zip(&motion.qd) {
                *tau += level * (speed / reached).clamp(-1.0, 1.0) + 0.15 * level * speed;
            }
        };
        let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
        let is_stribeck = |finding: &diagnosis::Finding| finding.effect == "stribeck_friction";
        assert!(!diagnosis.report.findings.iter().any(is_stribeck), "{reached} rad/s: {:?}", sentences(&diagnosis));
    }
}

/// Friction that is larger throughout the held-out recording is not a transient.
#[test]
fn more_friction_in_the_held_out_recording_is_not_a_burst() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if motion.clock >= start(2) {
            for (tau, &speed) in tau.iter_mut().zip(&motion.qd) {
                *tau += 0.1 * (0.6 * speed.signum() + 0.4 * speed * speed.abs());
            }
        }
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let left = &diagnosis.report.unexplained;
    assert!(left.iter().all(|left| left.time.is_empty()), "{left:?}");
}

/// Two dry frictions on one joint share one Coulomb level, which only one of them states: their torques add up.
#[test]
fn two_dry_frictions_on_a_joint_add_up() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let speed = motion.qd[ELBOW];
        let directional = if speed > 0.0 { 3.0 } else { -1.0 };
        tau[ELBOW] += directional + 3.0 * (-(speed / 0.12).powi(2)).exp() * speed.signum();
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let number = |effect: &str, key: &str| {
        let mut effects = diagnosis.effects.iter();
        let found = effects.find(|found| found.spec().name == effect && found.joint() == Some("elbow"));
        found.expect("it is found").number(key)
    };
    for (key, truth) in [("positive", 3.6), ("negative", 1.6)] {
        let found = number("friction_asymmetry", key);
        assert!((found / truth - 1.0).abs() < 0.1, "{key}: {found} instead of {truth}");
    }
    assert_eq!(number("stribeck_friction", "coulomb"), 0.0);
    // The level in motion is that of the asymmetric friction, and the sentence does not say that it is zero.
    let said = sentences(&diagnosis);
    let larger = |said: &&&str| {
        said.starts_with("elbow: dry friction that is larger by ") && said.contains("at breakaway than in motion")
    };
    assert!(said.iter().any(|said| larger(&said)), "{said:?}");
    assert!((number("stribeck_friction", "breakaway") / 3.0 - 1.0).abs() < 0.25);
    let again = diagnosed(&trio(), &trio(), &injected, diagnosis.effects.clone());
    assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
    // The rows near reversals are above the noise. Twice the Coulomb level would leave a third of the torque.
    let left = &again.report.unexplained;
    assert!(left.iter().all(|left| left.share < 0.03), "{left:?}");
}

/// A drag with a smaller exponent resembles drag and viscous friction, and has as many sizes.
#[test]
fn a_drag_does_not_take_the_place_of_viscous_friction() {
    let (drag, viscous) = (0.6, 0.25);
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let speed = motion.qd[ELBOW];
        let noise = ((250.0 * motion.time).round() * 12.9898 + 7.1 * motion.clock).sin() * 43758.5453;
        tau[ELBOW] += drag * speed * speed.abs() + (viscous - 0.4) * speed + 0.34 * (noise - noise.floor() - 0.5);
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let found = |effect: &str| {
        let mut findings = diagnosis.report.findings.iter();
        let is_this =
            |finding: &&diagnosis::Finding| finding.effect == effect && finding.joint.as_deref() == Some("elbow");
        findings.find(is_this).unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis)))
    };
    for (effect, size, truth) in [
        ("quadratic_drag", "coefficient", drag),
        ("quadratic_drag", "exponent", 2.0),
        ("viscous_friction", "coefficient", viscous),
    ] {
        let [low, high] = found(effect).parameters[size].ci95;
        assert!(low <= truth && truth <= high, "{effect}: {low} to {high}");
    }
}

/// The diagnosis of three recordings in which the elbow's friction falls from 2 N m at breakaway to its level of 0.6 N m, the
/// last held out, with a number of recordings from `before`, in which it falls from 0.6 N m plus `old` (N m).
fn with_new_stribeck_friction(before: usize, old: f64) -> Diagnosis {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let speed = motion.qd[ELBOW];
        let additional = if motion.clock >= start(2) { 1.4 } else { old };
        tau[ELBOW] += additional * (-(speed / 0.12).powi(2)).exp() * speed.signum();
    };
    let recordings: Vec<RegularRecording> =
        (2 - before..5).map(|variant| regular(&recorded(&trio(), variant, 16.0, &injected))).collect();
    let input = |(number, recording)| Input {
        name: ["a", "b", "c", "d", "e"][number],
        recording,
        held_out: number == recordings.len() - 1,
        before: number < before,
    };
    let inputs: Vec<Input<'_>> = recordings.iter().enumerate().map(input).collect();
    diagnose(&trio(), &inputs, &Options::default(), &|_| {}).expect("it can be diagnosed")
}

/// Its parameters are those of the whole friction, as without recordings from before, which do not widen the intervals.
#[test]
fn recordings_from_before_do_not_worsen_the_size_of_new_stribeck_friction() {
    let widths = [0, 2].map(|before| {
        let diagnosis = with_new_stribeck_friction(before, 0.0);
        let said = sentences(&diagnosis);
        let mut findings = diagnosis.report.findings.iter();
        let found = findings.find(|finding| finding.effect == "stribeck_friction");
        let found = found.unwrap_or_else(|| panic!("{before}: {said:?}"));
        assert_eq!(found.since_before, before > 0, "{said:?}");
        let has_changed = found.sentence.contains("of another form in the recordings from before");
        assert_eq!(has_changed, before > 0, "{said:?}");
        let widths = [("coulomb", 0.6), ("breakaway", 2.0), ("velocity", 0.12)].map(|(key, truth)| {
            let parameter = found.parameters[key];
            let [low, high] = parameter.ci95;
            assert!(low <= truth && truth <= high, "{before}, {key}: {low} … {high}, {truth} is true");
            assert!((parameter.value / truth - 1.0).abs() < 0.1, "{before}, {key}: {parameter:?}");
            high - low
        });
        let names = effects_on(&diagnosis, "elbow");
        assert!(!names.contains(&"coulomb_friction"), "its level is stated: {said:?}");
        widths
    });
    for (alone, with_before) in widths[0].iter().zip(widths[1]) {
        assert!(with_before < 1.5 * alone, "{widths:?}");
    }
}

/// Stribeck friction that has grown is that from before and what is new: their torques add up to the present one.
#[test]
fn stribeck_friction_that_has_grown_is_not_counted_twice() {
    let diagnosis = with_new_stribeck_friction(2, 0.7);
    let level = |key: &str| -> f64 {
        let effects = diagnosis.effects.iter().filter(|effect| effect.joint() == Some("elbow"));
        let of = |effect: &effects::Effect| match effect.name() {
            "stribeck_friction" => effect.number(key),
            "coulomb_friction" => effect.number("level"),
            _ => 0.0,
        };
        effects.map(of).sum()
    };
    for (key, truth) in [("coulomb", 0.6), ("breakaway", 2.0)] {
        let found = level(key);
        assert!((found / truth - 1.0).abs() < 0.1, "{key}: {found}, {:?}", sentences(&diagnosis));
    }
}

/// Friction that is larger only next to reversals, where rows are hardly fitted, is named, and its interval says that it may be
/// larger than the rows show.
#[test]
fn friction_that_fitted_rows_show_in_part_may_be_larger() {
    for velocity in [0.01, 0.02] {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            let speed = motion.qd[ELBOW];
            tau[ELBOW] += 3.0 * (-(speed / velocity).abs()).exp() * speed.signum();
        };
        let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
        let is_stribeck = |finding: &&diagnosis::Finding| finding.effect == "stribeck_friction";
        let found = diagnosis.report.findings.iter().find(is_stribeck);
        let found = found.unwrap_or_else(|| panic!("{velocity}: {:?}", sentences(&diagnosis)));
        for (key, truth) in [("coulomb", 0.6), ("breakaway", 3.6), ("velocity", velocity)] {
            let [low, high] = found.parameters[key].ci95;
            assert!(low <= truth && truth <= high, "{velocity}: {key} {low} to {high}");
        }
    }
}

/// Full identification is measured on the rows of the final fit: friction that rises only near standstill is in its error.
#[test]
fn the_control_is_measured_on_the_rows_near_reversals_too() {
    let identified = |rise: f64| {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            for (tau, &speed) in tau.iter_mut().zip(&motion.qd) {
                *tau += rise * speed.signum() * (-(speed / 0.01).powi(2)).exp();
            }
        };
        let fit = diagnosed(&trio(), &trio(), &injected, Vec::new()).report.fit;
        fit["elbow"].held_out_nrmse_identified.expect("a recording is held out")
    };
    let (without, with) = (identified(0.0), identified(3.0));
    assert!(with > 2.0 * without, "{without} {with}");
}

/// Friction of one joint that is much larger in one of the recordings: it is that of the others, which they determine, and so is the friction
/// of the other joints.
#[test]
fn friction_of_one_recording_is_noted_and_leaves_the_others_alone() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if (start(1)..start(2)).contains(&motion.clock) {
            tau[ELBOW] += 0.9 * motion.qd[ELBOW].signum();
        }
    };
    let recordings: Vec<_> = (0..4).map(|variant| regular(&recorded(&trio(), variant, 16.0, &injected))).collect();
    let diagnosis = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    for joint in ["turn", "shoulder", "elbow"] {
        let mut findings = diagnosis.report.findings.iter();
        let found = findings.find(|found| found.effect == "coulomb_friction" && found.joint.as_deref() == Some(joint));
        let [low, high] = found.unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis))).parameters["level"].ci95;
        assert!(low < 0.6 && 0.6 < high && high - low < 0.1, "{joint}: {low} to {high}");
    }
    let mut notes = diagnosis.remarks.iter().filter(|note| note.starts_with("dry friction is not the same"));
    let note = notes.next().unwrap_or_else(|| panic!("{:?}", diagnosis.remarks));
    assert!(note.contains("(elbow: +0.9") && note.contains(" in b)"), "{note}");
}

/// The friction of two joints differs from recording to recording. A small friction of the third one, which does not, keeps its name.
#[test]
fn friction_that_all_recordings_have_keeps_its_name() {
    const LEVEL: f64 = 0.12;
    let recordings = [0, 1, 2, 3].map(|variant: usize| {
        let warm = [1.0, 1.6, 1.2, 0.7][variant];
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            for (joint, tau) in tau.iter_mut().enumerate() {
                let speed = motion.qd[joint];
                *tau += if joint == ELBOW { LEVEL * speed.signum() } else { warm * (1.5 * speed.signum() + speed) };
            }
        };
        regular(&recorded(&trio(), variant, 16.0, &injected))
    });
    let diagnosis = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    let is_it = |finding: &&diagnosis::Finding| {
        finding.effect == "coulomb_friction" && finding.joint.as_deref() == Some("elbow")
    };
    let finding = diagnosis.report.findings.iter().find(is_it);
    let level = &finding.unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis))).parameters["level"];
    assert!((level.value - LEVEL).abs() < 0.2 * LEVEL, "{level:?}");
}
