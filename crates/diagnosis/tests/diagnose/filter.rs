//! What the filter hides, on a drive that swings on the ends of a gap in its gear, and noise that passes the filter.

use crate::support::gap::with_gap;
use crate::support::{
    TURN, baseline_friction, diagnosed_with, effects_on, inputs, named, recorded, regular, sentences, trio,
};
use diagnosis::{Diagnosis, Options, diagnose};
use recording::RegularRecording;

/// Half the gap (rad).
const HALFGAP: f64 = 0.013;
fn diagnosis(cutoff: Option<f64>) -> Diagnosis {
    let options = Options { cutoff, ..Options::default() };
    diagnosed_with(&trio(), &trio(), &with_gap(trio(), HALFGAP), &options).expect("it can be diagnosed")
}

/// No model is right about the fast torque after an impact in a gear, which hides the slower part of the same torque.
#[test]
fn a_gap_that_a_quick_filter_hides_is_found_through_a_slower_one() {
    let turn = trio().joints()[TURN].name.clone();
    let found = diagnosis(Some(5.0));
    let finding = found.report.findings.iter().find(|finding| finding.effect == "backlash");
    let finding = finding.unwrap_or_else(|| panic!("{:?}", sentences(&found)));
    assert_eq!(finding.joint.as_ref(), Some(&turn));
    let half = finding.parameters["halfgap"].value;
    assert!((half - HALFGAP).abs() < 0.2 * HALFGAP, "{half}");
    assert!(found.report.unexplained.is_empty(), "{:?}", found.report.unexplained);
}

/// Through the usual filter, the gap stays unexplained, and the advice is the slower one.
#[test]
fn a_gap_that_is_hidden_stays_unexplained() {
    let found = diagnosis(None);
    assert!(!effects_on(&found, "turn").contains(&"backlash"), "{:?}", sentences(&found));
    assert!(found.report.unexplained.iter().any(|open| open.joint == "turn"), "{:?}", sentences(&found));
    assert!(found.remarks.iter().any(|remark| remark.contains("--cutoff 5.0")), "{:?}", found.remarks);
}

/// Recordings of the exact model with its baseline friction, and uniform noise of this width (rad) on the positions.
fn with_noise(width: f64) -> [RegularRecording; 3] {
    let mut state: u64 = 49;
    [0, 1, 2].map(|variant| {
        let mut recording = recorded(&trio(), variant, 20.0, &|motion, tau| baseline_friction(motion, tau));
        for q in recording.q.iter_mut().flatten() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *q += width * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        }
        regular(&recording)
    })
}

fn diagnosed_with_noise(width: f64) -> Diagnosis {
    diagnose(&trio(), &inputs(&with_noise(width)), &Options::default(), &|_| {}).expect("it can be diagnosed")
}

/// A spring between drive and link filters the noise of the positions out of the link's inertial torque, in held-out recordings, too.
/// It is not named for that.
#[test]
fn the_noise_of_positions_is_not_a_spring() {
    let diagnosis = diagnosed_with_noise(2e-4);
    assert!(named(&diagnosis).is_empty(), "{:?}", named(&diagnosis));
}

/// A base that sways under the arm would filter it, too.
#[test]
fn the_noise_of_positions_is_not_a_swaying_base() {
    let report = diagnosed_with_noise(5e-4).report;
    assert!(report.unexplained.is_empty(), "{:?}", report.unexplained);
}

/// So much noise that a joint does not seem to move at the usual cut-off lowers it nevertheless.
#[test]
fn noise_that_hides_the_motion_lowers_the_cut_off() {
    for width in [2e-3, 4e-3] {
        let report = diagnosed_with_noise(width).report;
        assert!(report.cutoff.is_some_and(|cutoff| cutoff < 6.0), "{width}: {:?}", report.cutoff);
        assert!(report.unexplained.is_empty(), "{width}: {:?}", report.unexplained);
    }
}
