//! The units of published values, with their factors to the SI unit at the joint.

use std::f64::consts::PI;

use arm::JointKind;
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
        relative if relative < -1.0 => format!("−{} times", rounded(-1.0 - relative, 2)),
        relative if relative < 0.0 => format!("−{text}"),
        relative if relative >= 1.0 => format!("{} times", factor(1.0 + relative)),
        _ => format!("+{text}"),
    }
}

/// A unit's name, and its factor to the first of its list.
type Unit = (&'static str, f64);

const TORQUE: &[Unit] = &[("N m", 1.0), ("mN m", 1e-3), ("kN m", 1e3)];
const FORCE: &[Unit] = &[("N", 1.0), ("kN", 1e3)];
const ANGLE: &[Unit] = &[("rad", 1.0), ("mrad", 1e-3), ("deg", PI / 180.0)];
const LENGTH: &[Unit] = &[("m", 1.0), ("mm", 1e-3)];
const TIME: &[Unit] = &[("s", 1.0), ("ms", 1e-3)];
const MASS: &[Unit] = &[("kg", 1.0), ("g", 1e-3)];
const NONE: &[Unit] = &[("1", 1.0), ("%", 1e-2)];

/// The units of a parameter at a joint of `kind`; `None` is the whole arm.
fn units(effect: &str, parameter: &str, kind: Option<JointKind>) -> &'static [Unit] {
    let turns = kind != Some(JointKind::Prismatic);
    let either = |turning: &'static [Unit], sliding: &'static [Unit]| if turns { turning } else { sliding };
    match (effect, parameter) {
        ("encoder_offset", "offset") | (_, "rest" | "halfgap" | "angle") => either(ANGLE, LENGTH),
        ("quadratic_drag", "coefficient") => either(&[("N m s²/rad²", 1.0)], &[("N s²/m²", 1.0)]),
        ("viscous_friction", "coefficient") | (_, "damping" | "viscous") => {
            either(&[("N m s/rad", 1.0), ("N m s/deg", 180.0 / PI)], &[("N s/m", 1.0)])
        }
        (_, "stiffness") => either(
            &[("N m/rad", 1.0), ("kN m/rad", 1e3), ("N m/deg", 180.0 / PI)],
            &[("N/m", 1.0), ("kN/m", 1e3)],
        ),
        (_, "inertia") => either(&[("kg m²", 1.0)], MASS),
        (_, "velocity") => either(
            &[("rad/s", 1.0), ("deg/s", PI / 180.0)],
            &[("m/s", 1.0), ("mm/s", 1e-3)],
        ),
        (_, "mass") => MASS,
        (_, "com_x" | "com_y" | "com_z") => LENGTH,
        (_, "force") => FORCE,
        (_, "delay" | "duration" | "time_constant") => TIME,
        ("thermal_drift", "amplitude") | (_, "factor" | "gain" | "relative" | "periods") => NONE,
        _ => either(TORQUE, FORCE),
    }
}

/// The factor from `unit` to the SI unit, and the SI unit; the error states the possible units.
pub fn si(effect: &str, parameter: &str, kind: Option<JointKind>, unit: &str) -> Result<(f64, &'static str), String> {
    let known = units(effect, parameter, kind);
    let found = known.iter().find(|(name, _)| *name == unit);
    match (found, known.first()) {
        (Some((_, factor)), Some((si, _))) => Ok((*factor, si)),
        _ => {
            let known: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
            Err(format!(
                "\"{unit}\" is no unit of {effect}\u{2019}s {parameter} here; give {}",
                known.join(" or ")
            ))
        }
    }
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
        assert_eq!(
            si("rotor_inertia", "inertia", Some(JointKind::Prismatic), "g"),
            Ok((1e-3, "kg"))
        );
        assert_eq!(si("payload", "mass", None, "kg"), Ok((1.0, "kg")));
    }

    #[test]
    fn the_diagnosis_says_the_same_units() {
        // One parameter of each kind, with its unit in `diagnose --json`.
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
        for effect in catalogue() {
            assert!(!compared_parameters(effect).is_empty(), "{effect}");
        }
    }
}
