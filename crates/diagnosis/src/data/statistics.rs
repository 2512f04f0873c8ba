//! Mean, median, quantiles, standard deviation and root mean square.

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
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The value below which the part `share` of ascending values lies; zero for no values.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(0.0)
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

/// The root of the mean square; `None` for no values.
pub fn rms(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values = values.into_iter().peekable();
    values.peek()?;
    Some(mean(values.map(|value| value * value)).sqrt())
}
