//! Sine and cosine of an angle up to 1e5 rad, with the same bits in every lane, on every processor and beside every C library.
//!
//! The angle is reduced to [−π/4, π/4] (Cody and Waite, 1980, with π/2 in two parts), where polynomials approximate both functions
//! (their coefficients are those of FreeBSD's libm). There are no branches, so that a vector takes hardly longer than a number.

use super::Real;

/// 2/π.
const TURNS: f64 = std::f64::consts::FRAC_2_PI;
/// π/2 to 33 bits, so that its product with a small integer is exact, and the rest.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// The sum of this and a number of moderate size has no fractional bits: adding and subtracting it rounds.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// The largest angle (rad) whose multiples of π/2 are subtracted exactly.
pub(crate) const LARGEST: f64 = 1e5;

/// The coefficients of x³, x⁵, … in the sine.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// The coefficients of x⁴, x⁶, … in the cosine.
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine of `angle` (rad), whose size is at most [`LARGEST`], to an absolute error of 2e-16.
#[inline(always)]
pub(crate) fn sin_cos<T: Real>(context: T::Context, angle: T) -> (T, T) {
    let number = |value: f64| T::constant(context, value);
    let (one, two, half) = (number(1.0), number(2.0), number(0.5));
    let rounding = number(ROUNDING);
    let rounded = |value: T| value + rounding - rounding;
    // x is the angle without `quarters` times π/2.
    let quarters = rounded(angle * number(TURNS));
    let x = angle - quarters * number(QUARTER[0]) - quarters * number(QUARTER[1]);
    let square = x * x;
    let sin = x + square * x * series(context, square, SINE);
    let cos = one - (half * square - square * square * series(context, square, COSINE));

    // Odd quarters exchange the two; the others change their signs. All factors are 0, 1 or −1.
    let remainder = quarters - two * rounded(half * quarters);
    let odd = remainder * remainder;
    let pairs = half * (quarters - odd);
    let remainder = pairs - two * rounded(half * pairs);
    let sign = one - two * remainder * remainder;
    let even = one - odd;
    (sign * (sin * even + cos * odd), sign * (even - odd) * (cos * even + sin * odd))
}

/// A polynomial with the given coefficients, of which the first is constant.
#[inline(always)]
fn series<T: Real>(context: T::Context, x: T, [a, b, c, d, e, f]: [f64; 6]) -> T {
    let number = |value: f64| T::constant(context, value);
    number(a) + x * (number(b) + x * (number(c) + x * (number(d) + x * (number(e) + x * number(f)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the standard library, whose error is below 1e-16 here.
    #[test]
    fn the_error_is_below_two_units_in_the_last_place_of_one() {
        let mut angle = -30.0;
        while angle < 30.0 {
            for scale in [1e-9, 1.0, 1e3] {
                let angle = angle * scale;
                let (sin, cos) = sin_cos((), angle);
                assert!((sin - angle.sin()).abs() <= 2e-16, "sin {angle}: {sin}");
                assert!((cos - angle.cos()).abs() <= 2e-16, "cos {angle}: {cos}");
            }
            angle += 0.000_7;
        }
        for quarters in -20..=20 {
            let angle = f64::from(quarters) * std::f64::consts::FRAC_PI_2;
            let (sin, cos) = sin_cos((), angle);
            assert!((sin - angle.sin()).abs() <= 2e-16 && (cos - angle.cos()).abs() <= 2e-16, "{angle}");
        }
        assert_eq!(sin_cos((), 0.0), (0.0, 1.0));
        assert!(sin_cos((), f64::NAN).0.is_nan() && sin_cos((), f64::INFINITY).1.is_nan());
    }
}
