//! Values of a bag with their own times, and between them.

/// Values are not interpolated over gaps of more periods.
const GAP: i64 = 10;

/// Position, velocity and effort of a joint in a message, as far as it has them.
pub type Values = [Option<f64>; 3];

/// Values with their times (ns).
pub type Series = Vec<(i64, f64)>;

/// The values of `series` at `times` (ns), interpolated linearly between samples, and the number of interpolated ones;
/// NaN outside its time span and in its gaps.
pub fn at(series: &[(i64, f64)], times: &[i64]) -> (Vec<Option<f64>>, usize) {
    let mut steps: Vec<i64> = series.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let middle = steps.len() / 2;
    let longest = match steps.is_empty() {
        true => 0,
        false => GAP * *steps.select_nth_unstable(middle).1,
    };
    let mut between = 0;
    let values = times.iter().map(|&time| {
        let next = series.partition_point(|(stamp, _)| *stamp < time);
        let &(after, upper) = series.get(next)?;
        if after == time {
            return Some(upper);
        }
        let &(before, lower) = series.get(next.checked_sub(1)?)?;
        if after - before > longest {
            return None;
        }
        between += 1;
        let share = (time - before) as f64 / (after - before) as f64;
        Some(lower + share * (upper - lower))
    });
    let values = values.collect();
    (values, between)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_between_two_are_interpolated_and_none_in_a_gap() {
        let series = [(0, 0.0), (10, 1.0), (20, 2.0), (30, 3.0), (500, 50.0)];
        let (values, between) = at(&series, &[-5, 0, 5, 30, 100, 500, 600]);
        assert_eq!(values, [None, Some(0.0), Some(0.5), Some(3.0), None, Some(50.0), None]);
        assert_eq!(between, 1);
    }
}
