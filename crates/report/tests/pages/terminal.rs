//! What is printed is narrow and says it all.

use report::terminal;

use crate::made_up::{self, Plot};

#[test]
fn the_table_is_narrow_and_says_it_all() {
    let (report, ..) = made_up::diagnosis(6, Plot::Rich);
    let text = terminal::diagnosis(&report);
    println!("{text}");
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    for part in [
        "shoulder_lift_joint",
        "whole arm",
        "62.0 ± 3.1 N m/rad",
        "could also be payload",
        "next experiment: Sweep",
        "not testable with these recordings: ",
        "backlash on 6 joints",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(text.starts_with("The model omits 8 effects on 4 joints and the whole arm. An unmodelled residual\n"));
}

#[test]
fn an_empty_diagnosis_has_no_table() {
    let (report, ..) = made_up::diagnosis(7, Plot::Clean);
    let text = terminal::diagnosis(&report);
    assert!(text.starts_with("The model explains the recordings") && !text.contains("share"));
    let (report, ..) = made_up::diagnosis(1, Plot::TooShort);
    assert!(terminal::diagnosis(&report).contains("not enough data: 1.9 s in motion"));
}

#[test]
fn a_residual_above_the_torques_spread_is_no_percentage() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    report.unexplained[0].share = 3.21;
    let text = terminal::diagnosis(&report);
    assert!(
        text.contains("unexplained residual 3.2 times the torque's standard"),
        "{text}"
    );
}

#[test]
fn little_explained_and_no_held_out_recording_are_said_first() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    for fit in report.fit.values_mut() {
        fit.held_out_nrmse_nominal = Some(1.2);
        fit.held_out_nrmse_augmented = Some(0.9);
    }
    let text = terminal::diagnosis(&report);
    assert!(text.starts_with("Most of the mismatch is unexplained: "), "{text}");
    report.verdict = diagnosis::Verdict::Explained;
    report.recordings.held_out.clear();
    let text = terminal::diagnosis(&report);
    assert!(!text.contains("held-out") && text.contains("not validated"), "{text}");
}
