//! Formats of numbers: prefixes, intervals, errors.

use diagnosis::Parameter;

/// A factor and the unit that a value divided by it has.
pub struct Scaled {
    /// What to divide by.
    pub factor: f64,
    /// The unit with its prefix.
    pub unit: String,
}

/// The usual prefix for values of `magnitude`; none where it would be unusual (kg m²).
pub fn scaled(magnitude: f64, unit: &str) -> Scaled {
    let first = unit.split([' ', '/']).next().unwrap_or_default();
    let prefixes: &[(f64, f64, &str)] = match first {
        "N" => &[(1e6, 1e6, "M"), (1e3, 1e3, "k"), (0.1, 1.0, ""), (0.0, 1e-3, "m")],
        "s" if unit == "s" => &[(0.1, 1.0, ""), (1e-4, 1e-3, "m"), (0.0, 1e-6, "µ")],
        "m" if unit == "m" => &[(0.1, 1.0, ""), (1e-4, 1e-3, "m"), (0.0, 1e-6, "µ")],
        "rad" if unit == "rad" => &[(0.1, 1.0, ""), (1e-4, 1e-3, "m"), (0.0, 1e-6, "µ")],
        _ => &[],
    };
    if first == "kg" && unit == "kg" && magnitude > 0.0 && magnitude < 0.1 {
        return Scaled { factor: 1e-3, unit: "g".into() };
    }
    let found = prefixes.iter().find(|(from, _, _)| magnitude >= *from && magnitude > 0.0);
    let (factor, prefix) = found.map_or((1.0, ""), |(_, factor, prefix)| (*factor, *prefix));
    Scaled { factor, unit: format!("{prefix}{unit}") }
}

/// Replaces the hyphen by a minus sign, and removes it before a zero.
fn signed(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().any(|digit| ('1'..='9').contains(&digit)) => format!("−{rest}"),
        Some(rest) => rest.to_owned(),
        None => text.to_owned(),
    }
}

/// `value` with `decimals` decimals; as a power of ten beyond six digits.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    if value.abs() >= 1e6 || (value != 0.0 && value.abs() < 1e-6) {
        return signed(&format!("{value:.1e}"));
    }
    signed(&format!("{value:.decimals$}"))
}

/// The number of decimals that give `value` `digits` significant digits.
fn decimals_of(value: f64, digits: i32) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    digits - 1 - value.abs().log10().floor() as i32
}

/// Three significant digits.
pub fn short(value: f64) -> String {
    fixed(value, decimals_of(value, 3).clamp(0, 8) as usize)
}

/// Three significant digits without trailing zeros.
pub fn trimmed(value: f64) -> String {
    without_trailing_zeros(&short(value))
}

fn without_trailing_zeros(text: &str) -> String {
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

/// A value with its unit and prefix: `1.90 kN m/rad`.
pub fn quantity(value: f64, unit: &str) -> String {
    let scaled = scaled(value.abs(), without_one(unit));
    join(short(value / scaled.factor), &scaled.unit)
}

/// A quantity without trailing zeros, for thresholds: `2 ms`.
pub fn round_quantity(value: f64, unit: &str) -> String {
    let scaled = scaled(value.abs(), without_one(unit));
    let value = value / scaled.factor;
    let text = without_trailing_zeros(&fixed(value, decimals_of(value, 2).clamp(0, 8) as usize));
    join(text, &scaled.unit)
}

fn join(text: String, unit: &str) -> String {
    if unit.is_empty() { text } else { format!("{text} {unit}") }
}

/// The unit; empty for a dimensionless value, whose unit may be written as `1`, `-` or `–`.
fn without_one(unit: &str) -> &str {
    if matches!(unit, "1" | "-" | "–") { "" } else { unit }
}

/// Whether the parameter is a share of something, which is shown in per cent.
fn is_relative(name: &str, unit: &str) -> bool {
    without_one(unit).is_empty() && matches!(name, "relative" | "amplitude")
}

/// The unit and the decimals with which a parameter is shown.
struct Shown {
    value: f64,
    ci95: [f64; 2],
    decimals: usize,
    unit: String,
}

fn shown(name: &str, parameter: &Parameter) -> Shown {
    let Parameter { value, ci95, unit } = *parameter;
    let Scaled { factor, unit } = if is_relative(name, unit) {
        Scaled { factor: 0.01, unit: "%".into() }
    } else {
        scaled(value.abs(), without_one(unit))
    };
    let (value, ci95) = (value / factor, ci95.map(|bound| bound / factor));
    let half = 0.5 * (ci95[1] - ci95[0]);
    let decimals = if half > 0.0 && half.is_finite() {
        decimals_of(half, 2).min(decimals_of(value, 4))
    } else {
        decimals_of(value, 3)
    };
    Shown { value, ci95, decimals: decimals.clamp(0, 8) as usize, unit }
}

/// `2.10 ± 0.10 N m`; an asymmetric interval is written with both bounds.
pub fn with_interval(name: &str, parameter: &Parameter) -> String {
    let Shown { value, ci95: [low, high], decimals, unit } = shown(name, parameter);
    let (half, middle) = (0.5 * (high - low), 0.5 * (high + low));
    let text = if !half.is_finite() {
        format!("≈ {}", fixed(value, decimals))
    } else if (middle - value).abs() <= 0.15 * half || half == 0.0 {
        format!("{} ± {}", fixed(value, decimals), fixed(half, decimals))
    } else {
        format!("{} ({} … {})", fixed(value, decimals), fixed(low, decimals), fixed(high, decimals))
    };
    let sign = if name == "factor" { "× " } else { "" };
    join(format!("{sign}{text}"), &unit)
}

/// The value and its interval separately: `1.90 kN m/rad` and `1.78 … 2.02`.
pub fn value_and_interval(name: &str, parameter: &Parameter) -> (String, String) {
    let shown = shown(name, parameter);
    let [low, high] = shown.ci95.map(|bound| fixed(bound, shown.decimals));
    let value = fixed(shown.value, shown.decimals);
    (join(value, &shown.unit), join(format!("{low} … {high}"), &shown.unit))
}

/// A relative error: `0.94`, `2.3`, `0.004`.
pub fn nrmse(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let text = match value.abs() {
        size if size >= 9.95 => format!("{value:.0}"),
        size if size >= 0.995 => format!("{value:.1}"),
        size if !(0.0005..0.0095).contains(&size) => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    };
    if text == "0.00" { "0".into() } else { text }
}

/// `0.94 → 0.12`, with a dash for a missing value.
pub fn before_after(before: Option<f64>, after: Option<f64>) -> String {
    let text = |value: Option<f64>| value.map_or("–".to_owned(), nrmse);
    match (before, after) {
        (None, None) => "–".into(),
        _ => format!("{} → {}", text(before), text(after)),
    }
}

/// Whole per cents; a positive share below 0.5 % is written as `<1 %`.
pub fn percent(share: f64) -> String {
    if !share.is_finite() {
        "–".into()
    } else if share > 0.0 && share < 0.005 {
        "<1 %".into()
    } else {
        format!("{:.0} %", 100.0 * share)
    }
}

/// A ratio to a standard deviation: `12 %`, or `3.2 ×` for a ratio of one and more.
pub fn share(ratio: f64) -> String {
    if ratio.is_finite() && ratio >= 1.005 { format!("{} ×", factor(ratio)) } else { percent(ratio) }
}

/// A ratio to the standard deviation of a joint's torque, in words.
pub fn of_torque_spread(ratio: f64) -> String {
    if ratio.is_finite() && ratio >= 1.005 {
        format!("{} times the torque's standard deviation", factor(ratio))
    } else {
        format!("{} of the torque's standard deviation", percent(ratio))
    }
}

/// A ratio: two significant digits below ten, whole numbers above, powers of ten far above.
pub fn factor(ratio: f64) -> String {
    fixed(ratio, usize::from(ratio < 9.95))
}

/// Per cent, to a tenth where it is not a whole number; a ratio above one is a factor: `1.4 times`.
pub fn percent_to_a_tenth(ratio: f64) -> String {
    let percent = 100.0 * ratio;
    if percent.is_finite() && percent >= 100.05 {
        format!("{} times", factor(ratio))
    } else if (percent - percent.round()).abs() < 0.05 {
        format!("{percent:.0} %")
    } else {
        format!("{percent:.1} %")
    }
}

/// `digits` significant digits, with an exponent where the number is far from one.
pub fn rounded(value: f64, digits: usize) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-2..1e4).contains(&magnitude) {
        let decimals = (digits as i32 - 1 - magnitude.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.*e}", digits - 1)
    }
}

/// A probability between 0 and 100 %, both excluded; a dash if there is none.
pub fn probability(value: Option<f64>) -> String {
    match value {
        None => "–".into(),
        Some(p) if p > 0.995 => ">99 %".into(),
        Some(p) if p < 0.005 => "<1 %".into(),
        Some(p) => percent(p),
    }
}

/// Five significant digits without prefix or unit, for programs.
pub fn for_programs(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..6).contains(&magnitude) {
        format!("{value:.*}", (4 - magnitude).max(0) as usize)
    } else {
        format!("{value:.4e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(value: f64, ci95: [f64; 2], unit: &'static str) -> Parameter {
        Parameter { value, ci95, unit }
    }

    #[test]
    fn parameters_read_as_an_engineer_writes_them() {
        let cases = [
            ("stiffness", parameter(1912.0, [1790.0, 2034.0], "N m/rad"), "1.91 ± 0.12 kN m/rad"),
            ("level", parameter(2.1, [2.0, 2.2], "N m"), "2.10 ± 0.10 N m"),
            ("delay", parameter(0.004, [0.0039, 0.0042], "s"), "4.00 (3.90 … 4.20) ms"),
            ("relative", parameter(0.12, [0.1, 0.14], ""), "12.0 ± 2.0 %"),
            ("factor", parameter(0.85, [0.84, 0.86], "1"), "× 0.850 ± 0.010"),
            ("mass", parameter(151.3, [149.1, 153.5], "kg"), "151.3 ± 2.2 kg"),
            ("inertia", parameter(0.0313, [0.03, 0.0326], "kg m²"), "0.0313 ± 0.0013 kg m²"),
            ("offset", parameter(-3.16, [-3.2, -3.12], "N"), "−3.160 ± 0.040 N"),
            ("level", parameter(20.0, [f64::NEG_INFINITY, 22.0], "N"), "≈ 20.0 N"),
        ];
        for (name, parameter, text) in cases {
            assert_eq!(with_interval(name, &parameter), text);
        }
    }

    #[test]
    fn a_ratio_above_one_is_no_percentage() {
        let texts = [0.0, 0.26, 0.9996, 1.0, 1.13, 6.578].map(percent_to_a_tenth);
        assert_eq!(texts, ["0 %", "26 %", "100 %", "100 %", "1.1 times", "6.6 times"]);
    }

    #[test]
    fn errors_and_shares_are_short() {
        for (value, text) in [(0.94, "0.94"), (2.31, "2.3"), (0.004, "0.004"), (0.0, "0"), (0.999, "1.0")] {
            assert_eq!(nrmse(value), text);
        }
        assert_eq!(before_after(Some(0.94), Some(0.12)), "0.94 → 0.12");
        assert_eq!(percent(0.002), "<1 %");
        assert_eq!(share(0.92), "92 %");
        assert_eq!(share(8564.8), "8565 ×");
        assert_eq!(of_torque_spread(3.21), "3.2 times the torque's standard deviation");
        assert_eq!(of_torque_spread(0.4), "40 % of the torque's standard deviation");
        assert_eq!(probability(Some(0.999)), ">99 %");
        assert_eq!(round_quantity(0.002, "s"), "2 ms");
        assert_eq!(quantity(-0.00001, ""), "−0.0000100");
    }
}
