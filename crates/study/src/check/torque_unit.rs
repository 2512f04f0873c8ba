//! Detects torques of all joints in another unit or on the motors' side of the gears.

use super::column_map::{Change, Value};
use super::fit::Fit;
use super::thresholds::{LARGE_EVERYWHERE, MOTOR_SIDE, NEAR_UNIT, SMALL_BESIDE, SMALL_EVERYWHERE};
use report::numbers::rounded;

/// A unit of torque that is a power of ten of N m.
struct Unit {
    /// The ratio of the recorded torque to the model's.
    factor: f64,
    /// The unit that the ratio suggests, also for forces.
    name: &'static str,
    /// The remedy in words.
    remedy: &'static str,
    /// The remedy as a key of a column map.
    key: (&'static str, Value),
}

const UNITS: [Unit; 4] = [
    Unit {
        factor: 1e3,
        name: "mN m (or mN)",
        remedy: "tau_unit = \"mN m\", or tau_scale = 0.001",
        key: ("tau_scale", Value::Number(1e-3)),
    },
    Unit { factor: 1e2, name: "N cm", remedy: "tau_scale = 0.01", key: ("tau_scale", Value::Number(1e-2)) },
    Unit { factor: 1e6, name: "µN m (or µN)", remedy: "tau_scale = 1e-6", key: ("tau_scale", Value::Number(1e-6)) },
    Unit {
        factor: 1e-3,
        name: "kN m (or kN), or the masses of the URDF in g",
        remedy: "tau_unit = \"kN m\", or \"kN\"",
        key: ("tau_scale", Value::Number(1e3)),
    },
];

/// Whether torques that are `factor` times the model's may be in a unit that is a power of ten of N m.
pub fn may_be_decimal(factor: f64) -> bool {
    UNITS.iter().any(|unit| NEAR_UNIT.contains(&(factor / unit.factor)))
}

/// The message on a wrong unit of the torques, if all joints that move have the same error, and the keys of a column map
/// that correct it.
pub fn of(names: &[&str], moves: &[bool], fit: &Fit) -> Option<(String, Vec<Change>)> {
    // A channel without a torque has no unit.
    let has_torque = |joint: usize| fit.size[joint] > 1e-9;
    let moving: Vec<usize> = (0..moves.len()).filter(|&joint| moves[joint] && has_torque(joint)).collect();
    let is_evident = |joint: &usize| fit.factor[*joint] > 0.0 && fit.needs_model(*joint);
    let evident: Vec<usize> = moving.iter().copied().filter(is_evident).collect();
    let all = |outside: &dyn Fn(f64) -> bool| {
        evident.iter().all(|&joint| outside(fit.factor[joint])) && moving.iter().all(|&joint| outside(fit.size[joint]))
    };
    if evident.is_empty() {
        // Friction makes a measured torque larger than the model's, and no effect makes it that much smaller. Columns
        // without a torque are checked elsewhere.
        let sizes: Vec<f64> = moving.iter().map(|&joint| fit.size[joint]).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        return (sizes.len() > 1 && largest < MOTOR_SIDE).then(|| {
            let least = 1.0 / largest;
            let text = format!(
                "on all joints that move, the model's torque is {} times the recorded one or more, and explains none of \
                 it: check units, signs, order and zeros of positions and torques",
                rounded(least, 2)
            );
            (text, Vec::new())
        });
    }
    let large = all(&|size| size > LARGE_EVERYWHERE);
    let small = all(&|size| size < MOTOR_SIDE);
    // A joint with more friction than weight does not show the unit. All others must agree, or most of them, and there must be
    // more than one.
    let mut factors: Vec<f64> = evident.iter().map(|&joint| fit.factor[joint]).collect();
    factors.sort_by(f64::total_cmp);
    let largest = factors[factors.len() - 1];
    let agree = largest < SMALL_EVERYWHERE;
    let most_agree = factors.len() > 2 && factors[factors.len() / 2] < SMALL_EVERYWHERE && largest < SMALL_BESIDE;
    let currents = evident.len() > 1 && (agree || most_agree);
    if !(large || small || currents) {
        return None;
    }
    let (least, most) = (factors[0], largest);
    let middle = factors[factors.len() / 2];
    // All joints have the same unit.
    let decimal = UNITS.into_iter().find(|unit| {
        let near = |found: f64| NEAR_UNIT.contains(&(found / unit.factor));
        near(middle) && near((least * most).sqrt())
    });
    let said = format!("the torques of all joints that move are about {} times the model's", rounded(middle, 2));
    Some(match decimal {
        Some(Unit { name, remedy, key, .. }) => (
            format!("{said}: are they in {name}? Say so for each joint in a column map (--map): {remedy}"),
            names.iter().map(|name| Change::new(name, key.0, key.1.clone())).collect(),
        ),
        None => {
            let each: Vec<String> =
                evident.iter().map(|&joint| format!("{} {}", names[joint], rounded(fit.factor[joint], 2))).collect();
            let text = format!(
                "{said} ({}): another unit, motor currents, or the motor's side of the gears? Give each joint's tau_unit, \
                 tau_scale or gear in a column map (--map); the factors below are those of the URDF's masses",
                each.join(", ")
            );
            let scale = |&joint: &usize| {
                if evident.contains(&joint) {
                    return Change::scale(names[joint], 1.0 / fit.factor[joint]);
                }
                Change::scale(names[joint], 1.0 / middle)
                    .with_remark("not determined by its torque: the median of the others")
            };
            let all: Vec<usize> = (0..names.len()).collect();
            (text, all.iter().map(scale).collect())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of joints whose torques are `factors` times the model's.
    fn said(factors: &[f64]) -> Option<String> {
        let count = factors.len();
        let fit = Fit {
            residual_share: vec![0.01; count],
            factor: factors.to_vec(),
            without: vec![1.0; count],
            size: factors.to_vec(),
        };
        of(&["a", "b", "c", "d", "e"][..count], &vec![true; count], &fit).map(|(text, _)| text)
    }

    #[test]
    fn currents_of_drives_with_different_constants_are_reported() {
        // Of 12 to 4 N m per A, and with a payload that the URDF does not have.
        for currents in [&[0.08, 0.07, 0.15, 0.3, 0.55][..], &[0.1, 0.12, 0.22], &[0.1, 0.15]] {
            let said = said(currents);
            assert!(said.as_ref().is_some_and(|said| said.contains("motor currents")), "{said:?}");
        }
        // A model may be wrong by much, and on single joints by more.
        for torques in [&[0.3, 0.4, 0.3, 0.35, 0.3][..], &[0.1, 0.12, 0.15, 0.19, 0.8], &[0.1, 0.3], &[1.0, 0.9, 0.1]] {
            assert_eq!(said(torques), None, "{torques:?}");
        }
    }
}
