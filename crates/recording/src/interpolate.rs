//! Values between samples, by polynomials through the nearest ones.

/// The value at `at` of the polynomial through `nodes` (place, value), of which no two share a place.
pub fn lagrange(nodes: &[(f64, f64)], at: f64) -> f64 {
    let mut sum = 0.0;
    for (i, (place, value)) in nodes.iter().enumerate() {
        let mut weight = 1.0;
        for (j, (other, _)) in nodes.iter().enumerate() {
            if i != j {
                weight *= (at - other) / (place - other);
            }
        }
        sum += weight * value;
    }
    sum
}

/// The value at `at` from up to `side` samples on either side of the gap before sample `next`.
///
/// # Panics
/// If there is no sample before `next` or none from it on.
pub fn between(places: &[f64], values: &[f64], next: usize, side: usize, at: f64) -> f64 {
    let from = next.saturating_sub(side);
    let to = (next + side).min(places.len());
    let mut nodes = [(0.0, 0.0); 6];
    let count = (to - from).min(nodes.len());
    for (node, k) in nodes.iter_mut().zip(from..from + count) {
        *node = (places[k], values[k]);
    }
    lagrange(&nodes[..count], at)
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
}
