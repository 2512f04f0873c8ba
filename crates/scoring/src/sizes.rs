//! The numbers of an effect that are scored, and how far a finding's are from the truth's.

use serde::{Deserialize, Serialize};

use crate::answer::Named;
use crate::truth::{Injected, Truth};

/// One number of a finding against the truth's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sized {
    /// The case.
    pub case: String,
    /// The effect.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// The parameter's name in the catalogue.
    pub parameter: String,
    /// Whether it is the number that says how large the effect is.
    pub main: bool,
    /// What it is.
    pub truth: f64,
    /// What was said.
    pub value: f64,
    /// |said − true| over |true|; of a factor, over its distance from one; of a centre of mass, over its distance from the
    /// tool's origin.
    pub error: f64,
    /// Whether the 95 % interval holds the truth.
    pub covered: bool,
}

/// The scored parameters of an effect, the main one first. Phases, times of day, directions and what depends on a choice of zero
/// have no relative error and are left out.
pub fn parameters(effect: &str) -> &'static [&'static str] {
    match effect {
        "viscous_friction" | "quadratic_drag" => &["coefficient"],
        "coulomb_friction" => &["level"],
        "friction_asymmetry" => &["positive", "negative"],
        "stribeck_friction" => &["breakaway", "coulomb", "velocity"],
        "load_dependent_friction" => &["gain", "coulomb"],
        "thermal_drift" => &["amplitude", "coulomb", "time_constant"],
        "rotor_inertia" => &["inertia"],
        "torque_scale" | "inertial_scale" => &["factor"],
        "torque_offset" | "encoder_offset" => &["offset"],
        "torque_ripple" => &["amplitude", "periods"],
        "torque_saturation" => &["limit"],
        "actuation_delay" => &["delay"],
        "joint_elasticity" => &["stiffness", "damping"],
        "backlash" => &["halfgap"],
        "transmission_coupling" => &["viscous", "coulomb", "inertia"],
        "payload" => &["mass", "com_x", "com_y", "com_z"],
        "link_inertial_error" => &["relative"],
        "gravity_misalignment" => &["angle"],
        "spring" => &["stiffness"],
        "external_contact" => &["force", "duration"],
        _ => &[],
    }
}

/// A parameter of the truth under the name that findings have for it.
pub fn truth_value(concealed: &Injected, parameter: &str) -> Option<f64> {
    let at = |key: &str, k: usize| concealed.parameters.get(key)?.get(k)?.as_f64();
    match parameter {
        "com_x" => at("com", 0),
        "com_y" => at("com", 1),
        "com_z" => at("com", 2),
        "force" => match (at("force", 0), at("force", 1), at("force", 2)) {
            (Some(x), Some(y), Some(z)) => Some((x * x + y * y + z * z).sqrt()),
            _ => concealed.parameters.get("force")?.as_f64(),
        },
        parameter => concealed.parameters.get(parameter)?.as_f64(),
    }
}

/// What an error is told in parts of.
fn scale(concealed: &Injected, parameter: &str, truth: f64) -> f64 {
    if parameter == "factor" {
        return (truth - 1.0).abs();
    }
    if parameter.starts_with("com_") {
        let com = ["com_x", "com_y", "com_z"].map(|key| truth_value(concealed, key).unwrap_or(0.0));
        return com.iter().map(|x| x * x).sum::<f64>().sqrt();
    }
    truth.abs()
}

/// Whether an effect is dry friction in some form.
pub fn is_dry_friction(effect: &str) -> bool {
    matches!(
        effect,
        "coulomb_friction" | "friction_asymmetry" | "stribeck_friction" | "load_dependent_friction" | "thermal_drift"
    )
}

/// Whether several forms of dry friction are on the joint: how much of the level is whose is then a matter of words.
fn shares_a_level(truth: &Truth, concealed: &Injected) -> bool {
    let same = |other: &&Injected| other.joint == concealed.joint && is_dry_friction(other.name());
    is_dry_friction(concealed.name()) && truth.concealed.iter().filter(same).count() > 1
}

/// Whether the numbers mean something else than the catalogue's: the effect, or another part of the joint's friction curve, has
/// another form than the textbook's.
fn is_of_another_form(truth: &Truth, concealed: &Injected) -> bool {
    let curve =
        |effect: &str| effect.ends_with("_friction") || matches!(effect, "friction_asymmetry" | "quadratic_drag");
    let bends = |other: &Injected| {
        other.form.is_some() && other.joint == concealed.joint && curve(other.name()) && curve(concealed.name())
    };
    concealed.form.is_some() || truth.concealed.iter().any(bends)
}

/// The numbers of a finding of `concealed`.
pub fn sized(truth: &Truth, concealed: &Injected, finding: &Named) -> Vec<Sized> {
    let is_level = |key: &str| matches!(key, "level" | "coulomb" | "breakaway" | "positive" | "negative");
    let shared = shares_a_level(truth, concealed);
    let mut list = Vec::new();
    if is_of_another_form(truth, concealed) {
        return list;
    }
    for (k, key) in parameters(concealed.name()).iter().enumerate() {
        if shared && (is_level(key) || *key == "amplitude") {
            continue;
        }
        let (Some(true_value), Some(number)) = (truth_value(concealed, key), finding.parameters.get(*key)) else {
            continue;
        };
        let scale = scale(concealed, key, true_value);
        let Some(value) = number.value.filter(|_| scale > 0.0) else {
            continue;
        };
        list.push(Sized {
            case: truth.case.clone(),
            effect: concealed.name().to_owned(),
            joint: concealed.joint.clone(),
            parameter: (*key).to_owned(),
            main: k == 0,
            truth: true_value,
            value,
            error: (value - true_value).abs() / scale,
            covered: number.holds(true_value),
        });
    }
    list
}
