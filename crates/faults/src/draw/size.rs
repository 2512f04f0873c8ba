//! Sizes made to fit: effects that can be of any size, times a factor.

use serde_json::{Value, json};

use crate::physics::UNKNOWN;
use crate::truth::Injected;

/// Whether `effect` can be of any size; the others have sizes that machines have.
pub(crate) fn is_sized(effect: &str) -> bool {
    UNKNOWN.contains(&effect)
        || [
            "stribeck_friction",
            "load_dependent_friction",
            "friction_asymmetry",
            "thermal_drift",
            "quadratic_drag",
            "rotor_inertia",
            "torque_offset",
            "torque_ripple",
            "spring",
            "transmission_coupling",
            "external_contact",
        ]
        .contains(&effect)
}

/// Makes an effect `factor` as large, as far as physics lets it.
pub(crate) fn resize(effect: &mut Injected, factor: f64) {
    let number = |name: &str| effect.number(name).unwrap_or(0.0);
    let changed: Vec<(&str, Value)> = match effect.effect.as_str() {
        "stribeck_friction" => {
            let coulomb = number("coulomb");
            let extra = (factor * (number("breakaway") - coulomb)).min(2.5 * coulomb);
            vec![("breakaway", json!(coulomb + extra))]
        }
        "load_dependent_friction" => vec![("gain", json!((factor * number("gain")).min(0.35)))],
        "friction_asymmetry" => {
            let mean = 0.5 * (number("positive") + number("negative"));
            let half = (factor * (number("positive") - mean)).clamp(-0.95 * mean, 0.95 * mean);
            vec![("positive", json!(mean + half)), ("negative", json!(mean - half))]
        }
        "thermal_drift" => vec![("amplitude", json!((factor * number("amplitude")).min(2.0)))],
        // Beyond this the drive would be lighter than nothing.
        "transmission_coupling" => {
            let factor = factor.min(1.4);
            vec![
                ("viscous", json!(factor * number("viscous"))),
                ("inertia", json!(factor * number("inertia"))),
            ]
        }
        "external_contact" => {
            let force = effect.parameters.get("force").and_then(Value::as_array);
            let force = force.into_iter().flatten().filter_map(Value::as_f64);
            vec![("force", json!(force.map(|part| factor * part).collect::<Vec<f64>>()))]
        }
        "quadratic_drag" => vec![("coefficient", json!(factor * number("coefficient")))],
        "rotor_inertia" => vec![("inertia", json!(factor * number("inertia")))],
        "torque_offset" => vec![("offset", json!(factor * number("offset")))],
        "spring" => vec![("stiffness", json!(factor * number("stiffness")))],
        _ => vec![("amplitude", json!(factor * number("amplitude")))],
    };
    for (name, value) in changed {
        effect.parameters.insert(name.to_owned(), value);
    }
}
