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
        "next: Sweep",
        "could not be seen: ",
        "backlash on 6 joints",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(text.starts_with("The model leaves out 8 effects on 4 joints and the whole arm, and something"));
}

#[test]
fn an_empty_diagnosis_has_no_table() {
    let (report, ..) = made_up::diagnosis(7, Plot::Clean);
    let text = terminal::diagnosis(&report);
    assert!(text.starts_with("The model explains the recordings") && !text.contains("cause"));
    let (report, ..) = made_up::diagnosis(1, Plot::TooShort);
    assert!(terminal::diagnosis(&report).contains("not enough data: 1.9 s in motion"));
}
