//! Gaps in the gear of a joint about the vertical, on which gravity does not act, and delays.

use crate::support::gap::{Ends, with_ends, with_gap};
use crate::support::{baseline_friction, diagnosed, effects_on, sentences, trio};
use diagnosis::{Diagnosis, NotObservable};

/// The diagnosis of a gap on a URDF whose links are wrong by `wrong`, and its size found over the true one.
fn found(halfgap: f64, wrong: f64) -> (Diagnosis, f64) {
    let believed = (0..3)
        .fold(trio(), |arm, link| arm.with_scaled_link(link, if link % 2 == 0 { 1.0 + wrong } else { 1.0 - wrong }));
    let diagnosis = diagnosed(&believed, &trio(), &with_gap(trio(), halfgap), Vec::new());
    let findings = &diagnosis.report.findings;
    let finding = findings.iter().find(|finding| finding.effect == "backlash");
    let finding = finding.unwrap_or_else(|| panic!("{halfgap}: {:?}", sentences(&diagnosis)));
    assert_eq!(finding.joint.as_deref(), Some("turn"));
    let ratio = finding.parameters["halfgap"].value / halfgap;
    (diagnosis, ratio)
}

/// A gap explains little until its size, and the stiffness and damping of its ends, are found; a delay, which has one size, explains a
/// part of it at once.
#[test]
fn gaps_are_named_with_their_size() {
    for wrong in [0.0, 0.1] {
        for halfgap in [0.003, 0.006, 0.01] {
            let (diagnosis, ratio) = found(halfgap, wrong);
            assert!((ratio - 1.0).abs() < 0.1, "{ratio} of {halfgap}, links wrong by {wrong}");
            let on = effects_on(&diagnosis, "turn");
            assert!(!on.contains(&"actuation_delay") && !on.contains(&"joint_elasticity"), "{on:?}");
        }
    }
}

/// The shoulder moves slowly under a large weight: even a delay as long as a drive may have changes its torque too little. On the elbow,
/// only the longest delay that is named would be seen, and none above it. No size is stated for either.
#[test]
fn a_delay_that_no_drive_has_is_not_stated() {
    let arm = trio();
    let diagnosis = diagnosed(&arm, &arm, &|motion, tau| baseline_friction(motion, tau), Vec::new());
    for joint in ["shoulder", "elbow"] {
        let of = |entry: &&NotObservable| entry.effect == "actuation_delay" && entry.joint.as_deref() == Some(joint);
        let entry = diagnosis.report.not_observable.iter().find(of).expect("it is listed");
        assert!(entry.would_be_seen_above.is_empty(), "{entry:?}");
    }
}

/// A gap whose ends become stiff gradually seems to be smaller than it is, and the link bounces between them, so that the fit is far from
/// exact. The interval holds the true size, or the gap has no name; no link takes the blame.
#[test]
fn a_gap_with_rounded_ends_is_known_to_be_larger_than_it_seems() {
    let mut named = 0;
    for part in [0.1, 0.25, 0.4] {
        for halfgap in [0.003, 0.006, 0.01] {
            let machine = with_ends(trio(), halfgap, Ends::Rounded(part));
            let diagnosis = diagnosed(&trio(), &trio(), &machine, Vec::new());
            let what = format!("{part} {halfgap}: {:?}", sentences(&diagnosis));
            let on = effects_on(&diagnosis, "turn");
            assert!(on.contains(&"rotor_inertia") && !on.contains(&"inertial_parameters"), "{what}");
            let mut gaps = diagnosis.report.findings.iter();
            if let Some(gap) = gaps.find(|finding| finding.effect == "backlash") {
                let [low, high] = gap.parameters["halfgap"].ci95;
                assert!(low < halfgap && halfgap < high, "{what}");
                named += 1;
            }
        }
    }
    assert!(named >= 5, "{named} of 9");
}
