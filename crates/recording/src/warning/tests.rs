//! The sentences of warnings.

use super::Warning;

/// A gap in which the clock is shifted may be long, or shorter than two periods.
#[test]
fn a_gap_states_its_ends_and_the_shift_of_the_clock() {
    let gap = |shift| Warning::Gap { from: 2.3, to: 2.343, shift }.to_string();
    assert_eq!(gap(0.0), "no rows from 2.3000 s to 2.3430 s; treated as separate segments");
    assert_eq!(
        gap(-0.5),
        "no rows from 2.3000 s to 2.3430 s, after which the samples are -0.50 periods off the clock of those before; treated as separate segments"
    );
}

#[test]
fn one_row_is_singular() {
    let lost = |rows| Warning::LostRows { rows, of: 4999, time: 1.5 }.to_string();
    assert_eq!(lost(1), "1 of 4999 rows is missing, at 1.500 s; interpolated");
    assert_eq!(lost(2), "2 of 4999 rows are missing, one or a few at a time (the first at 1.500 s); interpolated");
}
