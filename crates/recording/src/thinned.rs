//! Columns with as many rows as fit into memory; for a longer file, means over equal time spans.

/// The columns read so far, the time (s) first.
///
/// If there are more than `most` values, rows are replaced by means over two periods, then over four, and so on. The
/// result is a recording at a lower rate, in which positions and torques passed the same filter.
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
        }
    }

    /// The number of rows read.
    pub fn read(&self) -> usize {
        self.read
    }

    /// Adds a row, the time first; `begins` if another run begins with it.
    pub fn push(&mut self, row: &[f64], begins: bool) {
        self.read += 1;
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
            self.columns
                .iter_mut()
                .zip(row)
                .for_each(|(column, &value)| column.push(value));
        }
        // The present span remains: it ends before the next span of double length.
        if self.columns[0].len() >= self.most {
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

/// The index of the span that contains a time. A shift by 0.0005 spans prevents rounding from separating regular
/// stamps.
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
            thinned.push(&row, begins);
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
}
