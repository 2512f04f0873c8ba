//! Courses of time, sample by sample.

use super::*;

/// The numbers of the samples that are used of those at `times` (s), and of those with a wrong stamp.
fn used(times: &[f64]) -> Result<(Vec<u64>, u64), Late> {
    let mut course = Course::default();
    let (mut used, mut wrong) = (Vec::new(), 0);
    let forget = |used: &mut Vec<Sample>, removed: &[i64]| {
        while used.last().is_some_and(|sample| removed.contains(&sample.time)) {
            used.pop();
        }
    };
    for (number, time) in (1..).zip(times) {
        let values = [None; 3];
        let sample = Sample { number, time: (time * 1e9).round() as i64, values };
        match course.take(sample)? {
            Taken::Used(_) => used.push(sample),
            Taken::HeldBack => {}
            Taken::Decided(decided) => {
                forget(&mut used, &decided.removed);
                used.extend(decided.used);
                wrong += decided.wrong.map_or(0, |(_, count)| count);
            }
        }
    }
    let decided = course.finish();
    forget(&mut used, &decided.removed);
    wrong += decided.wrong.map_or(0, |(_, count)| count);
    assert_eq!(course.messages, used.len());
    Ok((used.iter().map(|sample| sample.number).collect(), wrong))
}

/// So many times every 0.1 s from `start` (s).
fn from(start: f64, count: u32) -> Vec<f64> {
    (0..count).map(|step| start + 0.1 * f64::from(step)).collect()
}

#[test]
fn every_sample_is_used_or_wrong() {
    let cases = [
        (from(0.0, 30), 0),
        ([from(0.0, 30), vec![500.0], from(3.0, 30)].concat(), 1),
        ([from(0.0, 30), vec![6.0], from(3.0, 60)].concat(), 1),
        ([from(0.0, 30), vec![500.0, 1e7, 400.0], from(3.0, 30)].concat(), 3),
        ([from(100.0, 30), vec![5.0], from(103.0, 30)].concat(), 1),
        ([from(100.0, 30), vec![5.0, 4.0, 90.0, 101.0], from(103.0, 30)].concat(), 4),
        // Both, one after the other.
        ([from(100.0, 30), vec![1e6, 5.0], from(103.0, 30)].concat(), 2),
        // A pause is none.
        ([from(0.0, 30), from(1000.0, 5)].concat(), 0),
        ([from(0.0, 30), from(1000.0, 50)].concat(), 0),
    ];
    for (times, expected) in cases {
        let (used, wrong) = used(&times).expect("no clock was set back");
        assert_eq!((used.len() + wrong as usize, wrong), (times.len(), expected), "{times:?}");
    }
}

#[test]
fn eleven_early_ones_are_no_wrong_stamps() {
    let early = |count| [from(100.0, 100), from(105.0, count), from(110.0, 20)].concat();
    assert!(used(&early(10)).is_ok_and(|(_, wrong)| wrong == 10));
    assert!(used(&early(11)).is_err_and(|late| late == Late::new(101, 105_000_000_000, 109_900_000_000)));
    // Where the time is that of the beginning, another run begins; but not after a few messages.
    let again = |first| [from(100.0, first), from(100.0, 30)].concat();
    assert!(used(&again(60)).is_ok_and(|(used, _)| used.len() == 90));
    assert!(used(&again(49)).is_err());
}

/// Takes the samples of several files; whether a run restarts, and the number of wrong stamps.
fn files(all: &[Vec<f64>]) -> Result<(bool, u64), Late> {
    let mut course = Course::default();
    let (mut restarts, mut wrong, mut number) = (false, 0, 0);
    let mut count = |decided: &Decided| wrong += decided.wrong.map_or(0, |(_, count)| count);
    for file in all {
        course.begin_file();
        for time in file {
            number += 1;
            let time = (time * 1e9).round() as i64;
            let values = [None; 3];
            if let Taken::Decided(decided) = course.take(Sample { number, time, values })? {
                restarts |= decided.restarts_after.is_some();
                count(&decided);
            }
        }
    }
    count(&course.finish());
    Ok((restarts, wrong))
}

#[test]
fn files_that_overlap_are_not_mixed() {
    for start in [0.0, 0.4, 0.5, 1.0] {
        // The second file begins where the first one did: another run.
        assert_eq!(files(&[from(0.5, 2000), from(start, 2000)]).ok(), Some((true, 0)), "{start}");
    }
    assert!(files(&[from(0.0, 2000), from(50.0, 2000)]).is_err());
    assert_eq!(files(&[from(200.0, 2000), from(0.0, 2000)]).ok(), Some((false, 0)));
    assert_eq!(files(&[from(0.0, 2000), from(199.9, 2000)]).ok(), Some((false, 0)));
}

#[test]
fn a_wrong_stamp_at_the_end_of_a_file_is_left_out() {
    let first = [from(100.0, 200), vec![1e7]].concat();
    assert_eq!(files(&[first, from(20.0, 200)]).ok(), Some((false, 1)));
}
