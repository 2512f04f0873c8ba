//! Statistics of several values.

/// The root mean square of `values`, in their order; `None` for no values.
pub fn rms(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let squares: Vec<f64> = values.into_iter().map(|value| value.powi(2)).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// The quantile of `values` at `share` (0 to 1); 0 for no values. The values are sorted in place.
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_few_values() {
        assert_eq!(rms([3.0, -4.0, 5.0, 0.0]), Some(12.5_f64.sqrt()));
        assert_eq!(rms([]), None);
        let mut values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(quantile(&mut values, 0.5), 3.0);
        assert_eq!((quantile(&mut values, 0.0), quantile(&mut values, 1.0)), (1.0, 4.0));
        assert_eq!(quantile(&mut [], 0.5), 0.0);
    }
}
