//! Numbers in warnings.

/// Four significant digits, with an exponent only for very small and very large values.
pub fn short(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-3..1e4).contains(&magnitude) {
        let digits = if value == 0.0 { 0.0 } else { 3.0 - magnitude.log10().floor() };
        format!("{value:.*}", digits.max(0.0) as usize)
    } else {
        format!("{value:.3e}")
    }
}
