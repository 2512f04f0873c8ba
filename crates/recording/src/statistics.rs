//! Mean, median, quantiles, standard deviation and root mean square, summed in the order of the values.

use std::borrow::Borrow;

/// The 97.5 % quantile of the standard normal distribution: half of a 95 % interval over the standard deviation.
pub const NORMAL_95: f64 = 1.96;

/// The mean; zero for no values.
pub fn mean<T: Borrow<f64>>(values: impl IntoIterator<Item = T>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value.borrow();
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// The median, the upper one of an even number; zero for no values.
pub fn median(mut values: Vec<f64>) -> f64 {
    quantile(&mut values, 0.5)
}

/// The value below which the part `share` (0 to 1) of `values` lies, one of them; zero for no values. The values change their order.
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = place(values.len(), share);
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// [`quantile`] of ascending values.
pub fn quantile_of_sorted(sorted: &[f64], share: f64) -> f64 {
    sorted.get(place(sorted.len(), share)).copied().unwrap_or(0.0)
}

/// The place of a quantile among `count` ascending values.
fn place(count: usize, share: f64) -> usize {
    (share * count.saturating_sub(1) as f64).round() as usize
}

/// The mean and the variance about it; zero for no values.
pub fn moments<T: Borrow<f64>>(values: impl Iterator<Item = T> + Clone) -> (f64, f64) {
    let middle = mean(values.clone());
    (middle, mean(values.map(|value| (value.borrow() - middle).powi(2))))
}

/// The standard deviation; zero for no values.
pub fn deviation<T: Borrow<f64>>(values: impl Iterator<Item = T> + Clone) -> f64 {
    moments(values).1.sqrt()
}

/// A signal of which less than this part of its square is its own, beside others, is not distinguished from them.
const LEAST_OF_ITS_OWN: f64 = 1e-9;

/// Subtracts what `signal` explains of the others from the inner products `left`, which are those of `whole` without what the signals
/// before it explain; returns its row before. `None`, and nothing is subtracted, if it hardly differs from the signals before it.
pub fn eliminate<const N: usize>(left: &mut [[f64; N]; N], whole: &[[f64; N]; N], signal: usize) -> Option<[f64; N]> {
    let row = left[signal];
    let own = row[signal];
    if own <= LEAST_OF_ITS_OWN * whole[signal][signal] || own <= 0.0 {
        return None;
    }
    for (other, values) in left.iter_mut().enumerate() {
        let share = row[other] / own;
        values.iter_mut().zip(row).for_each(|(value, row)| *value -= share * row);
    }
    Some(row)
}

/// The mean of the squares; zero for no values.
pub fn mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    mean(values.into_iter().map(|value| value * value))
}

/// The root of the mean square; `None` for no values.
pub fn rms(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values = values.into_iter().peekable();
    values.peek()?;
    Some(mean_square(values).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_few_values() {
        assert_eq!(rms([3.0, -4.0, 5.0, 0.0]), Some(12.5_f64.sqrt()));
        assert_eq!(mean_square([3.0, -4.0]), 12.5);
        assert_eq!(moments([1.0, 3.0].iter()), (2.0, 1.0));
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), 3.0);
        let mut values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!([0.0, 0.5, 1.0].map(|share| quantile(&mut values, share)), [1.0, 3.0, 4.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|share| quantile_of_sorted(&[1.0, 2.0, 3.0, 4.0], share)), [1.0, 3.0, 4.0]);
    }

    #[test]
    fn of_no_values() {
        assert_eq!(rms([]), None);
        assert_eq!([mean_square([]), median(Vec::new()), quantile_of_sorted(&[], 0.5)], [0.0; 3]);
    }
}
