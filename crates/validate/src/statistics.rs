//! Mean square and variance, computed in the order of the values.

/// The mean of the squares of `values`; 0 for no values.
pub(crate) fn mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for value in values {
        sum += value.powi(2);
        count += 1;
    }
    sum / f64::from(count.max(1))
}

/// The mean square distance of `values` from their mean; 0 for no values.
pub(crate) fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    mean_square(values.iter().map(|value| value - mean))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_few_values() {
        assert_eq!(mean_square([3.0, -4.0]), 12.5);
        assert_eq!(variance(&[1.0, 3.0]), 1.0);
        assert_eq!((mean_square([]), variance(&[])), (0.0, 0.0));
    }
}
