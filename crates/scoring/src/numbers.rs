//! The scored parameters of an effect, and the errors of a finding's parameters.

use serde::{Deserialize, Serialize};

use crate::answer::Named;
use crate::catalogue::{is_dry_friction, is_friction_curve, is_weighed, neutral, parameters};
use crate::truth::{Injected, Truth};

/// A parameter of a finding and its true value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScoredNumber {
    /// The case.
    pub case: String,
    /// The effect.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// The parameter's name in the catalogue.
    pub parameter: String,
    /// Whether it is the main parameter of the effect.
    pub main: bool,
    /// The true value, in the unit of the joint's recorded torque.
    pub truth: f64,
    /// The estimate.
    pub value: f64,
    /// |estimate − truth| over |truth|; for a factor, over its distance from one; for a centre of mass, over its distance from
    /// the tool's origin.
    pub error: f64,
    /// Whether the 95 % interval contains the true value.
    pub covered: bool,
}

/// A parameter of the ground truth under the name that findings use.
pub fn truth_value(injected: &Injected, parameter: &str) -> Option<f64> {
    let at = |key: &str, k: usize| injected.parameters.get(key)?.get(k)?.as_f64();
    match parameter {
        "com_x" => at("com", 0),
        "com_y" => at("com", 1),
        "com_z" => at("com", 2),
        "force" => match (at("force", 0), at("force", 1), at("force", 2)) {
            (Some(x), Some(y), Some(z)) => Some((x * x + y * y + z * z).sqrt()),
            _ => injected.parameters.get("force")?.as_f64(),
        },
        parameter => injected.parameters.get(parameter)?.as_f64(),
    }
}

/// The denominator of a relative error.
fn scale(injected: &Injected, parameter: &str, truth: f64) -> f64 {
    if parameter.starts_with("com_") {
        let com = ["com_x", "com_y", "com_z"].map(|key| truth_value(injected, key).unwrap_or(0.0));
        return com.iter().map(|x| x * x).sum::<f64>().sqrt();
    }
    (truth - neutral(injected.name())).abs()
}

/// Whether several forms of dry friction act on the joint, so that the split of the level between them is arbitrary.
fn shares_a_level(truth: &Truth, injected: &Injected) -> bool {
    let same = |other: &&Injected| other.joint == injected.joint && is_dry_friction(other.name());
    is_dry_friction(injected.name()) && truth.of_note().filter(same).count() > 1
}

/// Whether the parameters have a meaning other than the catalogue's, because the effect, or another part of the joint's
/// friction curve, has a form other than the textbook form.
fn is_of_another_form(truth: &Truth, injected: &Injected) -> bool {
    let bends = |other: &Injected| {
        let of_the_curve = is_friction_curve(other.name()) && is_friction_curve(injected.name());
        other.form.is_some() && other.joint == injected.joint && of_the_curve
    };
    injected.form.is_some() || truth.of_note().any(bends)
}

/// The parameters of a finding of `injected`.
pub fn sized(truth: &Truth, injected: &Injected, finding: &Named) -> Vec<ScoredNumber> {
    let is_level = |key: &str| matches!(key, "level" | "coulomb" | "breakaway" | "positive" | "negative");
    let shared = shares_a_level(truth, injected);
    let mut list = Vec::new();
    if is_of_another_form(truth, injected) {
        return list;
    }
    for (k, key) in parameters(injected.name()).iter().enumerate() {
        if shared && (is_level(key) || *key == "amplitude") {
            continue;
        }
        let (Some(true_value), Some(number)) = (truth_value(injected, key), finding.parameters.get(*key)) else {
            continue;
        };
        let unit = match is_weighed(injected.name(), key) {
            true => truth.torque_unit(injected.joint.as_deref()),
            false => 1.0,
        };
        let true_value = unit * true_value;
        let scale = unit * scale(injected, key, true_value / unit);
        let Some(value) = number.value.filter(|_| scale > 0.0) else {
            continue;
        };
        list.push(ScoredNumber {
            case: truth.case.clone(),
            effect: injected.name().to_owned(),
            joint: injected.joint.clone(),
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
