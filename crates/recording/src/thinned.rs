//! Columns of as many rows as fit into memory; of a longer file, means over equal spans of time, or windows of it.

use crate::windows::{Next, Windows};

/// A window has at most this part of the rows that are kept.
const PART: usize = 4;

/// The columns read so far, the time (s) first.
///
/// When there are more than `most` values, rows are replaced by their means over two periods, then over four, and so on:
/// what is left is a recording at a lower rate, of which positions and torques went through the same filter. With
/// [`Self::in_windows`], windows at the full rate are left instead.
pub struct Thinned {
    columns: Vec<Vec<f64>>,
    /// The rows at which a run begins, except the first run.
    breaks: Vec<usize>,
    most: usize,
    /// The span of a mean (s); 0 while every row is kept.
    span: f64,
    /// The present span, the number of its rows and their sums.
    at: i64,
    count: usize,
    sums: Vec<f64>,
    /// The number of rows read.
    read: usize,
    /// The windows that are kept, if not means are.
    windows: Option<Windows>,
    /// The number and the first row of each.
    begun: Vec<(u64, usize)>,
    /// Whether the next row that is kept begins another run.
    breaks_off: bool,
}

impl Thinned {
    /// An empty set of `columns` columns, of which at most `most` values are kept.
    pub fn new(columns: usize, most: usize) -> Self {
        Self {
            columns: vec![Vec::new(); columns],
            breaks: Vec::new(),
            // A mean consists of at least two rows.
            most: (most / columns).max(4),
            span: 0.0,
            at: 0,
            count: 0,
            sums: vec![0.0; columns],
            read: 0,
            windows: None,
            begun: Vec::new(),
            breaks_off: false,
        }
    }

    /// Keeps windows of `seconds` in all of a longer recording.
    pub fn in_windows(mut self, seconds: f64) -> Self {
        self.windows = Some(Windows::new(seconds));
        self
    }

    /// Rows read.
    pub fn read(&self) -> usize {
        self.read
    }

    /// The time that was read and is not kept (s).
    pub fn left_out(&self) -> f64 {
        self.windows.as_ref().map_or(0.0, Windows::left_out)
    }

    /// Counts a row at `time` (s); whether it is kept. `begins` if another run begins with it.
    pub fn wants(&mut self, time: f64, begins: bool) -> bool {
        self.read += 1;
        self.breaks_off |= begins;
        let Some(windows) = &mut self.windows else {
            return true;
        };
        let rows = self.columns[0].len();
        let since = self.begun.last().map_or(0, |(_, first)| *first);
        if let Next::Begins(number) = windows.next(time, (rows - since) * PART > self.most) {
            while windows.is_full() || self.columns[0].len() > self.most {
                windows.thin();
                let taken: Vec<bool> = self.begun.iter().map(|(number, _)| windows.takes(*number)).collect();
                self.breaks_off |= give_up(&mut self.columns, &mut self.breaks, &mut self.begun, &taken);
            }
            if windows.takes(number) {
                self.begun.push((number, self.columns[0].len()));
            }
        }
        windows.takes_now()
    }

    /// Takes a row that is wanted, the time first.
    pub fn push(&mut self, row: &[f64]) {
        let begins = std::mem::take(&mut self.breaks_off);
        if self.span > 0.0 {
            let at = place(row[0], self.span);
            if begins || at != self.at {
                self.flush();
                self.at = at;
            }
            if begins {
                self.breaks.push(self.columns[0].len());
            }
            self.count += 1;
            self.sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
        } else {
            if begins {
                self.breaks.push(self.columns[0].len());
            }
            self.columns.iter_mut().zip(row).for_each(|(column, &value)| column.push(value));
        }
        // A span that is being summed keeps its place: it ends before the next doubled one.
        if self.columns[0].len() >= self.most && self.windows.is_none() {
            self.halve();
            self.at = place(row[0], self.span);
        }
    }

    fn flush(&mut self) {
        if self.count > 0 {
            for (column, sum) in self.columns.iter_mut().zip(&mut self.sums) {
                column.push(*sum / self.count as f64);
                *sum = 0.0;
            }
            self.count = 0;
        }
    }

    /// Doubles the span.
    fn halve(&mut self) {
        if self.span == 0.0 {
            let time = &self.columns[0];
            let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let middle = steps.len() / 2;
            self.span = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        }
        self.span *= 2.0;
        let time = &self.columns[0];
        // The first row of each span.
        let mut firsts = Vec::with_capacity(time.len() / 2 + 1);
        let mut breaks = Vec::with_capacity(self.breaks.len());
        for row in 0..time.len() {
            let begins = self.breaks.binary_search(&row).is_ok();
            if begins {
                breaks.push(firsts.len());
            }
            if begins || row == 0 || place(time[row], self.span) != place(time[row - 1], self.span) {
                firsts.push(row);
            }
        }
        let rows = time.len();
        for column in &mut self.columns {
            for (mean, &first) in firsts.iter().enumerate() {
                let end = firsts.get(mean + 1).copied().unwrap_or(rows);
                column[mean] = column[first..end].iter().sum::<f64>() / (end - first) as f64;
            }
            column.truncate(firsts.len());
        }
        self.breaks = breaks;
    }

    /// The columns, the rows at which runs begin, and the span of a mean (s), if rows are means.
    pub fn finish(mut self) -> (Vec<Vec<f64>>, Vec<usize>, Option<f64>) {
        self.flush();
        let span = (self.span > 0.0).then_some(self.span);
        (self.columns, self.breaks, span)
    }
}

/// Removes the rows of the windows that begin with the rows `begun` and are not `taken`; whether another run begins with the next
/// row that is kept.
fn give_up(columns: &mut [Vec<f64>], breaks: &mut Vec<usize>, begun: &mut Vec<(u64, usize)>, taken: &[bool]) -> bool {
    let rows = columns[0].len();
    let ends = begun.iter().skip(1).map(|(_, first)| *first).chain([rows]);
    let spans: Vec<_> = begun.iter().zip(ends).map(|(&(_, first), end)| first..end).collect();
    let kept = || spans.iter().zip(taken).filter(|(_, taken)| **taken).map(|(span, _)| span);
    for column in columns.iter_mut() {
        let mut to = 0;
        for span in kept() {
            column.copy_within(span.clone(), to);
            to += span.len();
        }
        column.truncate(to);
    }
    let rows_before = |row: usize| kept().map(|span| span.end.min(row).saturating_sub(span.start)).sum::<usize>();
    for row in breaks.iter_mut() {
        *row = rows_before(*row);
    }
    breaks.dedup();
    let left = columns[0].len();
    let is_at_end = breaks.last() == Some(&left);
    breaks.retain(|&row| row < left);
    let firsts: Vec<(u64, usize)> = begun
        .iter()
        .zip(taken)
        .filter(|(_, taken)| **taken)
        .map(|((number, first), _)| (*number, rows_before(*first)))
        .collect();
    *begun = firsts;
    is_at_end
}

/// The number of the span in which a time lies. Half a thousandth later, so that rounding does not part regular stamps.
fn place(time: f64, span: f64) -> i64 {
    (time / span + 5e-4).floor() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 rows at 1 kHz of a line and of a sine, a few of them lost, in two runs.
    fn rows() -> Vec<([f64; 3], bool)> {
        (0..1000)
            .filter(|row| row % 97 != 5)
            .map(|row| {
                let pause = if row < 400 { 0.0 } else { 5.0 };
                let t = f64::from(row) * 1e-3 + pause;
                ([t, 2.0 * t, (6.0 * t).sin()], row == 400)
            })
            .collect()
    }

    fn thinned(most: usize) -> (Vec<Vec<f64>>, Vec<usize>, Option<f64>) {
        let mut thinned = Thinned::new(3, most);
        for (row, begins) in rows() {
            assert!(thinned.wants(row[0], begins));
            thinned.push(&row);
        }
        assert_eq!(thinned.read(), rows().len());
        thinned.finish()
    }

    #[test]
    fn what_fits_is_kept_as_it_is() {
        let (columns, breaks, span) = thinned(10_000);
        assert_eq!(columns[0].len(), rows().len());
        assert_eq!((breaks, span), (vec![395], None));
    }

    #[test]
    fn a_longer_file_is_kept_as_means_over_powers_of_two() {
        for (most, rows_a_mean) in [(2400, 2.0), (1300, 4.0), (600, 8.0)] {
            let (columns, breaks, span) = thinned(most);
            let span = span.expect("rows are means");
            assert!((span - rows_a_mean * 1e-3).abs() < 1e-12, "{span}");
            assert!(3 * columns[0].len() <= most + 3);
            for row in 0..columns[0].len() {
                let t = columns[0][row];
                assert!((columns[1][row] - 2.0 * t).abs() < 1e-9);
                assert!((columns[2][row] - (6.0 * t).sin()).abs() < 2e-4);
            }
            let [begins] = breaks[..] else { panic!("{breaks:?}") };
            assert!(columns[0][begins] > 5.0 && columns[0][begins - 1] < 0.5);
        }
    }

    /// Windows of 20 s at 100 Hz of a recording of 2000 s, in two runs.
    #[test]
    fn windows_are_kept_at_the_full_rate() {
        let mut thinned = Thinned::new(2, 1_000_000).in_windows(300.0);
        for row in 0..200_000 {
            let t = f64::from(row) * 0.01;
            if thinned.wants(t, row == 110_000) {
                thinned.push(&[t, 3.0 * t]);
            }
        }
        let left_out = thinned.left_out();
        let (columns, breaks, span) = thinned.finish();
        let held = columns[0].len() as f64 * 0.01;
        assert!(span.is_none() && (140.0..330.0).contains(&held), "{held}");
        assert!((held + left_out - 2000.0).abs() < 1.0, "{held} {left_out}");
        assert!(columns[0].iter().zip(&columns[1]).all(|(t, x)| *x == 3.0 * t));
        let steps = columns[0].windows(2).filter(|pair| pair[1] - pair[0] > 0.015);
        assert!(steps.count() >= 5 && columns[0][0] == 0.0);
        let [begins] = breaks[..] else { panic!("{breaks:?}") };
        assert!(columns[0][begins] >= 1100.0 && columns[0][begins - 1] < 1100.0);
    }

    /// A window ends before its time where its rows would not fit.
    #[test]
    fn windows_fit_into_memory() {
        let mut thinned = Thinned::new(2, 2000).in_windows(300.0);
        for row in 0..50_000 {
            let t = f64::from(row) * 1e-4;
            if thinned.wants(t, false) {
                thinned.push(&[t, t]);
            }
        }
        let (columns, ..) = thinned.finish();
        assert!((400..1300).contains(&columns[0].len()), "{}", columns[0].len());
    }
}
