//! Single time stamps that are far from all others, as of a clock that is set after the first message.

use crate::Warning;
use crate::doubt::short;
use crate::location::Location;
use crate::stamp::CALENDAR;

/// A first or last stamp is stray if its distance from the next one is this multiple of the duration of all others.
const FAR: f64 = 10.0;
/// The smallest number of rows beside it.
const ROWS: usize = 50;
/// The longest plausible duration of a recording (s), some thirty years. Beyond it, numbers do not resolve its periods any more.
const LONGEST: f64 = 1e9;

/// A row of a run, and its stamp in the file (s).
#[derive(Clone, Copy, Debug)]
struct Stamped {
    place: Location,
    stamp: f64,
}

/// The stamps at both ends of the run that is read.
#[derive(Debug, Default)]
pub struct Ends {
    /// The first two rows of the file.
    first: [Option<Stamped>; 2],
    /// The last two rows of the run, the last one first.
    last: [Option<Stamped>; 2],
    /// Whether another run began.
    has_more_runs: bool,
}

/// A row that is left out because its stamp is stray.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stray {
    /// Its line or row.
    place: Location,
    /// Its stamp, from the epoch on (s).
    stamp: f64,
    /// The stamp of the row beside it (s).
    next: f64,
}

impl Ends {
    /// Adds a row, which may begin another run.
    pub fn add(&mut self, place: Location, stamp: f64, begins: bool) {
        let row = Some(Stamped { place, stamp });
        self.has_more_runs |= begins && self.last[0].is_some();
        self.last = [row, self.last[0].filter(|_| !begins)];
        if let Some(free) = self.first.iter_mut().find(|first| first.is_none()) {
            *free = row;
        }
    }

    /// Why the row before, after which time goes back to `stamp`, has a stray stamp; `None` if a run begins with `stamp` instead: a run
    /// begins earlier than the row before the last one. Stamps count from the `epoch` (s).
    pub fn jumped(&self, stamp: f64, epoch: Option<i64>) -> Option<(Location, String)> {
        let [Some(last), Some(before)] = self.last else { return None };
        let short = |stamp: f64| short(stamp + epoch.unwrap_or(0) as f64);
        let text = || {
            format!(
                "its time stamp of {} s is between {} s and {} s, so that it is wrong; delete the row, or correct the stamp",
                short(last.stamp),
                short(before.stamp),
                short(stamp)
            )
        };
        (stamp > before.stamp).then(|| (last.place, text()))
    }

    /// Leaves the rows with stray stamps out of the `columns` of a single run of so many `rows`, the time first, unless they are not among its rows, or are a
    /// part of a mean; the `epoch` (s), from which stamps count, becomes that of the first remaining row.
    pub fn leave_out(&self, rows: usize, columns: &mut [Vec<f64>], epoch: &mut Option<i64>) -> Vec<Warning> {
        let [first, last] = self.strays(rows);
        let is_row = |stray: &Stray, time: Option<&f64>| time == Some(&stray.stamp);
        let first = first.filter(|stray| is_row(stray, columns[0].first()));
        let last = last.filter(|stray| is_row(stray, columns[0].last()));
        let before = epoch.unwrap_or(0);
        for column in &mut *columns {
            column.truncate(column.len() - usize::from(last.is_some()));
            column.drain(..usize::from(first.is_some()));
        }
        if first.is_some() {
            let begin = before + columns[0][0].floor() as i64;
            *epoch = Some(begin).filter(|begin| begin.abs() > CALENDAR);
            let shift = (before - epoch.unwrap_or(0)) as f64;
            columns[0].iter_mut().for_each(|time| *time += shift);
        }
        let in_file = |stamp: f64| stamp + before as f64;
        let warning = |Stray { place, stamp, next }| Warning::StrayStamp {
            line: place,
            stamp: in_file(stamp),
            next: in_file(next),
        };
        [first, last].into_iter().flatten().map(warning).collect()
    }

    /// The stray stamps at the beginning and at the end of a file with a single run of so many rows.
    fn strays(&self, rows: usize) -> [Option<Stray>; 2] {
        let ([Some(first), Some(second)], [Some(last), Some(before)]) = (self.first, self.last) else {
            return [None; 2];
        };
        if self.has_more_runs || rows <= ROWS + 2 {
            return [None; 2];
        }
        let stray = |row: Stamped, next: Stamped, others: f64| {
            let is_far = (row.stamp - next.stamp).abs() > FAR * others;
            is_far.then_some(Stray { place: row.place, stamp: row.stamp, next: next.stamp })
        };
        let inner = before.stamp - second.stamp;
        [stray(first, second, inner), stray(last, before, inner)]
    }
}

/// Why a recording that lasts from `first` to `last` (s) is refused; `None` if it is not.
pub fn too_long(first: f64, last: f64) -> Option<String> {
    (last - first > LONGEST).then(|| {
        format!(
            "the time stamps span {} s, from {} s to {} s; check the column of the time, its unit, and single wrong stamps",
            short(last - first),
            short(first),
            short(last)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(stamps: impl IntoIterator<Item = f64>) -> Ends {
        let mut ends = Ends::default();
        stamps.into_iter().enumerate().for_each(|(row, stamp)| ends.add(Location::Line(row as u64 + 2), stamp, false));
        ends
    }

    fn steps(rows: usize) -> impl Iterator<Item = f64> {
        (0..rows).map(|row| 5.0 + 0.01 * row as f64)
    }

    #[test]
    fn a_stamp_far_from_all_others_is_stray() {
        let [first, last] = ends([0.0].into_iter().chain(steps(200).map(|t| t + 1.7e9)).chain([2e9])).strays(202);
        assert_eq!(first.map(|stray| (stray.place, stray.stamp)), Some((Location::Line(2), 0.0)));
        assert_eq!(last.map(|stray| (stray.place, stray.stamp)), Some((Location::Line(203), 2e9)));
    }

    #[test]
    fn a_gap_of_a_few_durations_is_a_gap() {
        assert_eq!(ends(steps(200).chain([20.0])).strays(201), [None; 2]);
        assert_eq!(ends(steps(20).chain([1e4])).strays(21), [None; 2], "too few rows");
    }

    #[test]
    fn time_that_goes_on_after_a_jump_is_no_further_run() {
        let jumped = ends(steps(100).chain([1e4]));
        let (place, text) = jumped.jumped(6.0, None).expect("it goes on");
        assert_eq!(place, Location::Line(102));
        assert!(text.contains("10000 s is between 5.99 s and 6 s"), "{text}");
        assert!(jumped.jumped(5.0, None).is_none(), "a run begins");
    }

    #[test]
    fn no_recording_lasts_for_a_century() {
        assert!(too_long(0.0, 4e9).is_some_and(|text| text.contains("span 4000000000 s")));
        assert!(too_long(1.7e9, 1.7e9 + 3600.0).is_none());
    }
}
