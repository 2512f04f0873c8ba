//! Torques of all joints in another unit, or on the motors' side.

use super::model_check::Fit;
use report::numbers::rounded;

/// A torque less than this times the model's is on the motor's side; a payload only makes it larger.
pub const MOTOR_SIDE: f64 = 0.05;
/// As much on all joints is another unit; no payload does that.
const LARGE_EVERYWHERE: f64 = 30.0;
/// Factors of the torques, the unit that each suggests (for forces, too), and the remedy.
const UNITS: [(f64, &str, &str); 4] = [
    (1e3, "mN m (or mN)", "tau_unit = \"mN m\", or tau_scale = 0.001"),
    (1e2, "N cm", "tau_scale = 0.01"),
    (1e6, "µN m (or µN)", "tau_scale = 1e-6"),
    (1e-3, "kN m (or kN)", "tau_unit = \"kN m\", or \"kN\""),
];

/// The standard deviation.
pub fn deviation(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// What is wrong with the torques' unit, where all joints that move have the same.
pub fn of(moves: &[bool], fit: &Fit) -> Option<String> {
    let moving: Vec<usize> = (0..moves.len()).filter(|&joint| moves[joint]).collect();
    let evident = |joint: &&usize| fit.factor[**joint] > 0.0 && fit.told_by_model(**joint);
    let mut factors: Vec<f64> = moving.iter().filter(evident).map(|&joint| fit.factor[joint]).collect();
    let all = |outside: &dyn Fn(f64) -> bool| {
        factors.iter().all(|&factor| outside(factor)) && moving.iter().all(|&joint| outside(fit.size[joint]))
    };
    let large = all(&|size| size > LARGE_EVERYWHERE);
    let small = all(&|size| size < MOTOR_SIDE);
    if factors.is_empty() || !(large || small) {
        return None;
    }
    factors.sort_by(f64::total_cmp);
    let (least, most) = (factors[0], factors[factors.len() - 1]);
    let middle = factors[factors.len() / 2];
    // Masses are known to a third or so, and all joints have one unit.
    let decimal = UNITS.iter().find(|(factor, ..)| {
        let near = |found: f64| (0.5..2.0).contains(&(found / factor));
        near(middle) && near((least * most).sqrt())
    });
    let said = format!(
        "the torques of all joints that move are about {} times the model's",
        rounded(middle, 2)
    );
    Some(match decimal {
        Some((_, name, remedy)) => {
            format!("{said}: are they in {name}? Say so for each joint in a column map (--map): {remedy}")
        }
        None => format!(
            "{said}: another unit, a current, or the motor's side of the gears? Give each joint's tau_unit, tau_scale or \
             gear in a column map (--map)"
        ),
    })
}
