//! The page needs nothing else, escapes names, and can be made of any diagnosis.

use diagnosis::Traces;

use crate::made_up::{self, Plot};

fn page(joints: usize, plot: Plot) -> String {
    let (report, traces, arm) = made_up::diagnosis(joints, plot);
    report::page(&report, &traces, &arm)
}

#[test]
fn the_page_needs_nothing_else_and_says_it_all() {
    let text = page(7, Plot::Rich);
    for foreign in ["http:", "https:", "src=", "url(", "@import", "<script", "<link"] {
        assert!(!text.contains(foreign), "the page has {foreign}");
    }
    for part in [
        "The model omits 8 effects",
        "shoulder_lift_joint",
        "62.0 ± 3.1 N m/rad",
        "could also be",
        "Sweep this joint alone",
        "Not testable with these recordings",
        "c_held_out.csv",
        "six &amp; one",
        env!("CARGO_PKG_VERSION"),
    ] {
        assert!(text.contains(part), "{part} is not in the page");
    }
    assert!(text.len() < 2_000_000, "{} bytes", text.len());
    assert!(!text.contains("NaN") && !text.contains("inf "));
}

#[test]
fn names_are_escaped() {
    let text = page(7, Plot::Rich);
    assert!(!text.contains("<b>tool") && text.contains("&lt;b&gt;tool &amp; swivel&lt;/b&gt;"));
}

#[test]
fn the_same_diagnosis_gives_the_same_bytes() {
    assert_eq!(page(6, Plot::Rich), page(6, Plot::Rich));
}

#[test]
fn any_arm_and_any_verdict_make_a_page() {
    for joints in 1..=7 {
        for plot in [Plot::Clean, Plot::Rich, Plot::TooShort] {
            let text = page(joints, plot);
            assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>"));
        }
    }
    let (report, _, arm) = made_up::diagnosis(3, Plot::Rich);
    let text = report::page(&report, &Traces::default(), &arm);
    assert!(text.contains("elbow_joint"));
}
