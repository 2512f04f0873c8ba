//! Values between samples by polynomials through the nearest ones.

/// If the absolute weights of the nodes have a larger sum, the polynomial is not used, because it would amplify noise
/// by that factor. The sum is 3.6 for the widest gap that is filled on a regular clock; without a regular clock, two
/// stamps may be very close.
pub const MOST_WEIGHT: f64 = 20.0;

/// The value at `at` of the polynomial through `nodes` (place, value), which have different places.
pub fn lagrange(nodes: &[(f64, f64)], at: f64) -> f64 {
    weighted(nodes, at).0
}

/// The value of that polynomial, and the sum of the absolute weights of the nodes.
pub fn weighted(nodes: &[(f64, f64)], at: f64) -> (f64, f64) {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, (place, value)) in nodes.iter().enumerate() {
        let mut weight = 1.0;
        for (j, (other, _)) in nodes.iter().enumerate() {
            if i != j {
                weight *= (at - other) / (place - other);
            }
        }
        sum += weight * value;
        weights += weight.abs();
    }
    (sum, weights)
}

/// The value at `at` from up to `side` samples on either side of the gap before sample `next`; by linear interpolation
/// between the nearest two if a polynomial would amplify noise (see [`MOST_WEIGHT`]).
///
/// # Panics
/// If there is no sample on one of the two sides.
pub fn between(places: &[f64], values: &[f64], next: usize, side: usize, at: f64) -> f64 {
    let from = next.saturating_sub(side);
    let to = (next + side).min(places.len());
    let mut nodes = [(0.0, 0.0); 6];
    let count = (to - from).min(nodes.len());
    for (node, k) in nodes.iter_mut().zip(from..from + count) {
        *node = (places[k], values[k]);
    }
    let (value, weights) = weighted(&nodes[..count], at);
    if weights <= MOST_WEIGHT { value } else { lagrange(&[next - 1, next].map(|k| (places[k], values[k])), at) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_its_own_interpolation() {
        let places = [0.0, 1.0, 2.0, 4.0, 5.0, 6.0];
        let cube = |x: f64| x * x * x - 2.0 * x * x + 0.5;
        let values = places.map(cube);
        for side in [2, 3] {
            assert!((between(&places, &values, 3, side, 3.0) - cube(3.0)).abs() < 1e-12);
        }
        assert!((between(&places, &values, 1, 3, 0.5) - cube(0.5)).abs() < 1e-12);
    }

    /// Rows in pairs, as from messages that wait for each other: their slope consists of noise.
    #[test]
    fn samples_next_to_each_other_do_not_amplify_their_noise() {
        let (places, values) = ([0.0, 0.001, 2.0, 2.001], [1.0, 1.001, 1.0, 0.999]);
        for at in [0.5, 1.0, 1.5] {
            let value = between(&places, &values, 2, 2, at);
            assert!((1.0..=1.001).contains(&value), "{value}");
        }
    }

    /// In gaps that are filled on a regular clock, the polynomial is used, also at the ends.
    #[test]
    fn ticks_are_trusted() {
        let square = |x: f64| x * x;
        for missing in 1..=5 {
            let after = f64::from(missing + 1);
            for places in [vec![-1.0, 0.0, after, after + 1.0], vec![0.0, after, after + 1.0]] {
                let values: Vec<f64> = places.iter().map(|place| square(*place)).collect();
                for at in 1..=missing {
                    let at = f64::from(at);
                    let value = between(&places, &values, places.len() - 2, 2, at);
                    assert!((value - square(at)).abs() < 1e-9, "{places:?} at {at}: {value}");
                }
            }
        }
    }
}
