//! The units of published values, with their factors to the SI unit at the joint.

use std::f64::consts::PI;
use std::iter;

use arm::JointKind;
use effects::Quantity;
use report::numbers::{factor, percent_to_a_tenth as percent, rounded};

/// Whether an effect acts on the whole arm.
pub fn is_on_the_arm(effect: &str) -> bool {
    effects::spec(effect).is_some_and(|spec| spec.scope == effects::Scope::Arm)
}

/// A relative difference from a published value in per cent with its sign, or the ratio to that value from 2 on and below zero.
pub fn difference(relative: f64) -> String {
    let text = percent(relative.abs());
    match relative {
        relative if text == "0 %" || relative == 0.0 => text,
        relative if relative <= -1.005 => format!("−{} times", rounded(-1.0 - relative, 2)),
        relative if relative < 0.0 => format!("−{text}"),
        relative if relative >= 1.0 => format!("{} times", factor(1.0 + relative)),
        _ => format!("+{text}"),
    }
}

/// A unit's name, and its factor to the SI unit.
type Unit = (&'static str, f64);

const ANGLE: &[Unit] = &[("mrad", 1e-3), ("deg", PI / 180.0)];
const LENGTH: &[Unit] = &[("mm", 1e-3)];
const FORCE: &[Unit] = &[("kN", 1e3)];
const MASS: &[Unit] = &[("g", 1e-3)];

/// The units of a quantity at a joint of `kind` that are accepted beside the SI unit.
fn other_units(quantity: Quantity, kind: JointKind) -> &'static [Unit] {
    let either = |turning: &'static [Unit], sliding: &'static [Unit]| match kind {
        JointKind::Revolute => turning,
        JointKind::Prismatic => sliding,
    };
    match quantity {
        Quantity::Torque => either(&[("mN m", 1e-3), ("kN m", 1e3)], FORCE),
        Quantity::Position => either(ANGLE, LENGTH),
        Quantity::Speed => either(&[("deg/s", PI / 180.0)], &[("mm/s", 1e-3)]),
        Quantity::Damping => either(&[("N m s/deg", 180.0 / PI)], &[]),
        Quantity::Stiffness => either(&[("kN m/rad", 1e3), ("N m/deg", 180.0 / PI)], &[("kN/m", 1e3)]),
        Quantity::Inertia => either(&[], MASS),
        Quantity::Acceleration | Quantity::Drag => &[],
        Quantity::Ratio => &[("%", 1e-2)],
        Quantity::Angle => ANGLE,
        Quantity::Time => &[("ms", 1e-3)],
        Quantity::Mass => MASS,
        Quantity::Length => LENGTH,
        Quantity::Force => FORCE,
    }
}

/// The factor from `unit` to the SI unit of a parameter, and that unit, at a joint of `kind` (`None` is the whole arm); the error
/// states the possible units.
pub fn si(effect: &str, parameter: &str, kind: Option<JointKind>, unit: &str) -> Result<(f64, &'static str), String> {
    let found = effects::spec(effect).and_then(|spec| spec.parameter(parameter));
    let quantity = found.ok_or_else(|| format!("{effect} has no parameter {parameter}"))?.quantity;
    let kind = kind.unwrap_or(JointKind::Revolute);
    let si = quantity.unit(kind);
    let known = || iter::once((si, 1.0)).chain(other_units(quantity, kind).iter().copied());
    if let Some((_, factor)) = known().find(|(name, _)| *name == unit) {
        return Ok((factor, si));
    }
    let known: Vec<&str> = known().map(|(name, _)| name).collect();
    Err(format!("\"{unit}\" is no unit of {effect}\u{2019}s {parameter} here; give {}", known.join(" or ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use faults::catalogue;
    use scoring::compared_parameters;

    #[test]
    fn large_differences_are_ratios() {
        let texts = [0.0, 0.265, -0.3, 1.4, -1.5].map(difference);
        assert_eq!(texts, ["0 %", "+26.5 %", "−30 %", "2.4 times", "−0.50 times"]);
    }

    #[test]
    fn units_are_those_of_the_joint() {
        let (factor, unit) = si("spring", "rest", Some(JointKind::Revolute), "deg").expect("degrees");
        assert!((factor * 180.0 - PI).abs() < 1e-15 && unit == "rad");
        let viscous = |kind, unit| si("viscous_friction", "coefficient", Some(kind), unit);
        assert_eq!(viscous(JointKind::Prismatic, "N s/m"), Ok((1.0, "N s/m")));
        let refused = viscous(JointKind::Prismatic, "N m s/rad").expect_err("a slide does not turn");
        assert!(refused.ends_with("give N s/m"), "{refused}");
        assert_eq!(si("rotor_inertia", "inertia", Some(JointKind::Prismatic), "g"), Ok((1e-3, "kg")));
        assert_eq!(si("payload", "mass", None, "kg"), Ok((1.0, "kg")));
    }

    /// One parameter of each kind, with its unit in `diagnose --json`.
    #[test]
    fn the_diagnosis_says_the_same_units() {
        for (effect, parameter, unit) in [
            ("coulomb_friction", "level", "N m"),
            ("torque_offset", "offset", "N m"),
            ("encoder_offset", "offset", "rad"),
            ("joint_elasticity", "stiffness", "N m/rad"),
            ("joint_elasticity", "damping", "N m s/rad"),
            ("quadratic_drag", "coefficient", "N m s²/rad²"),
            ("stribeck_friction", "velocity", "rad/s"),
            ("actuation_delay", "delay", "s"),
        ] {
            assert_eq!(si(effect, parameter, Some(JointKind::Revolute), unit), Ok((1.0, unit)));
        }
    }

    #[test]
    fn all_parameters_that_are_compared_have_a_unit() {
        for effect in catalogue() {
            let compared = compared_parameters(effect);
            assert!(!compared.is_empty(), "{effect}");
            for parameter in compared {
                let unit = effects::spec(effect).and_then(|spec| spec.unit(parameter, JointKind::Revolute));
                let unit = unit.unwrap_or_else(|| panic!("{effect} has no {parameter}"));
                assert_eq!(si(effect, parameter, None, unit), Ok((1.0, unit)));
            }
        }
    }
}
