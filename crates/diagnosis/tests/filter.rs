//! The second look through a slower filter, on a drive that swings on the ends of a gap in its gear.

mod support;

use diagnosis::{Action, Diagnosis, Options};
use support::gap::with_gap;
use support::{TURN, diagnosed_with, effects_on, sentences, trio};

/// Half the gap (rad).
const HALFGAP: f64 = 0.013;
fn diagnosis(cutoff: Option<f64>) -> Diagnosis {
    let options = Options {
        cutoff,
        ..Options::default()
    };
    diagnosed_with(&trio(), &trio(), &with_gap(trio(), HALFGAP), &options).expect("it can be diagnosed")
}

fn filters(diagnosis: &Diagnosis) -> Vec<&str> {
    let rows = diagnosis.trace.iter().filter(|row| row.action == Action::Filter);
    rows.map(|row| row.effect.as_str()).collect()
}

#[test]
fn a_gap_that_a_quick_filter_hides_is_found_through_a_slower_one() {
    let turn = trio().joints()[TURN].name.clone();
    let found = diagnosis(None);
    let finding = found
        .report
        .findings
        .iter()
        .find(|finding| finding.effect == "backlash");
    let finding = finding.unwrap_or_else(|| panic!("{:?}", sentences(&found)));
    assert_eq!(finding.joint.as_ref(), Some(&turn));
    let half = finding.parameters["halfgap"].value;
    assert!((half - HALFGAP).abs() < 0.2 * HALFGAP, "{half}");
    assert!(found.report.unexplained.is_empty(), "{:?}", found.report.unexplained);
    assert_eq!(filters(&found), ["5.0 Hz"]);
    assert!(
        found.report.cutoff.is_some_and(|cutoff| (cutoff - 5.0).abs() < 0.1),
        "{:?}",
        found.report.cutoff
    );
    let note = found
        .remarks
        .iter()
        .find(|remark| remark.contains("backlash of turn explains residuals of turn"));
    assert!(note.is_some(), "{:?}", found.remarks);
}

/// A stated filter is used, whatever stays unexplained.
#[test]
fn a_stated_filter_is_kept() {
    let found = diagnosis(Some(12.0));
    assert!(
        !effects_on(&found, "turn").contains(&"backlash"),
        "{:?}",
        sentences(&found)
    );
    assert!(!found.report.unexplained.is_empty());
    assert_eq!(found.report.cutoff, Some(12.0));
    assert!(filters(&found).is_empty());
}
