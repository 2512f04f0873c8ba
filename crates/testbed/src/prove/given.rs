//! Given cases, and their ground truths, which a person may have written.

use std::path::Path;

use anyhow::{Context, bail, ensure};
use arm::Arm;
use effects::arm::INERTIAL_PARAMETERS;
use recording::nearest;
use scoring::{Injected, Truth, parameters, truth_value};

use super::case_paths::{CasePaths, Files};
use super::rows;

/// The cases in a folder that have a ground truth.
///
/// # Errors
/// If there is none.
pub fn places(cases: &Path, truth: &Path) -> anyhow::Result<Vec<CasePaths>> {
    let entries = std::fs::read_dir(cases).with_context(|| format!("--cases-from {}", cases.display()))?;
    let mut names: Vec<String> = entries
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("case_"))
        .collect();
    names.sort();
    let all = names.len();
    names.retain(|name| truth.join(format!("{name}.json")).is_file());
    ensure!(
        !names.is_empty(),
        "{}: has no folder case_* with a ground truth in {}; give the folder of the ground truths with --truth",
        cases.display(),
        truth.display()
    );
    if names.len() < all {
        let (left_out, truth) = (all - names.len(), truth.display());
        crate::output::say(format_args!(
            "note: {left_out} of {all} cases have no ground truth in {truth}; they are omitted"
        ));
    }
    let place = |(number, name): (usize, String)| CasePaths {
        number,
        folder: cases.join(&name),
        truth: truth.join(format!("{name}.json")),
        name,
    };
    Ok(names.into_iter().enumerate().map(place).collect())
}

/// Checks a ground truth before hours of diagnoses: an effect or a joint that does not exist would count as missed, and a main size that
/// is not stated as right.
///
/// # Errors
/// With the file, the effect and the remedy.
pub fn check(place: &CasePaths) -> anyhow::Result<()> {
    let file = place.truth.display();
    let text = std::fs::read_to_string(&place.truth).with_context(|| file.to_string())?;
    let truth: Truth = rows::truth(&place.name, &text).with_context(|| format!("{file}: correct or remove it"))?;
    let arm = Arm::from_urdf(place.folder.join(Files::of(&place.folder)?.robot))?;
    let joints: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    // Recordings may be of a part of the URDF's joints.
    ensure!(
        (1..=joints.len()).contains(&truth.torque_noise.len()),
        "{file}: torque_noise has {} values, and the URDF of {} has {} joints; give one per recorded joint, base to tip",
        truth.torque_noise.len(),
        place.name,
        joints.len()
    );
    for (number, injected) in truth.injected.iter().enumerate() {
        check_effect(injected, &joints).with_context(|| format!("{file}: entry {} of \"concealed\"", number + 1))?;
    }
    Ok(())
}

fn check_effect(injected: &Injected, joints: &[String]) -> anyhow::Result<()> {
    let name = injected.name();
    let check_joint = |joint: &String| -> anyhow::Result<()> {
        if joints.contains(joint) {
            return Ok(());
        }
        let hint = nearest(joint, joints).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
        bail!("{name}: the URDF has no joint \"{joint}\"; {hint}it has {}", joints.join(", "))
    };
    if let Some(joint) = &injected.joint {
        check_joint(joint)?;
    }
    if injected.is_outside_the_catalogue() {
        return Ok(());
    }
    let Some(spec) = effects::spec(name) else {
        let known: Vec<String> = effects::CATALOGUE.iter().map(|spec| spec.name.to_owned()).collect();
        let hint = nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
        bail!(
            "there is no effect \"{name}\"; {hint}there are {}, and for other physics names that end in _unknown",
            known.join(", ")
        )
    };
    // Inertial parameters without a joint are those of all links, and have no size.
    let is_of_all_links = injected.joint.is_none() && spec.name == INERTIAL_PARAMETERS.name;
    match (spec.scope, &injected.joint) {
        (effects::Scope::Joint, None) if !is_of_all_links => {
            bail!("{name} acts on a joint; give one as \"joint\": {}", joints.join(", "))
        }
        (effects::Scope::Arm, Some(joint)) => {
            bail!("{name} acts on the whole arm and not on {joint}; write \"joint\": null")
        }
        _ => {}
    }
    if spec.has_other {
        let Some(serde_json::Value::String(other)) = injected.parameters.get("other") else {
            bail!("{name} has another joint; give it as \"other\": \"NAME\"")
        };
        check_joint(other)?;
        let place = |name: &String| joints.iter().position(|joint| joint == name);
        ensure!(
            place(other) < injected.joint.as_ref().and_then(place),
            "{name}: \"other\" is {other}; a coupling is stated on the joint that is farther from the base, and \"other\" is the nearer one"
        );
    }
    // Another form may have other parameters, and a coupling need not have all of its own.
    let sizes = parameters(name);
    let wanted = if spec.has_other { sizes } else { &sizes[..sizes.len().min(1)] };
    let is_stated = wanted.is_empty() || wanted.iter().any(|size| truth_value(injected, size).is_some());
    ensure!(
        injected.form.is_some() || is_of_all_links || is_stated,
        "{name} has no size; state {}",
        wanted.join(" or ")
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(effect: &str) -> String {
        let injected: Injected = serde_json::from_str(effect).expect("an effect");
        let joints = ["shoulder", "elbow"].map(str::to_owned);
        check_effect(&injected, &joints).map_or_else(|error| error.to_string(), |()| "ok".to_owned())
    }

    #[test]
    fn effects_that_cannot_be_scored_are_refused() {
        for right in [
            r#"{"effect": "torque_offset", "joint": "elbow", "offset": 0.1}"#,
            r#"{"effect": "transmission_coupling", "joint": "elbow", "other": "shoulder", "coulomb": 0.1}"#,
            r#"{"effect": "payload", "joint": null, "mass": 0.1, "com": [0, 0, 0.1]}"#,
            r#"{"effect": "dead_band_unknown", "joint": "elbow", "width": 0.1}"#,
            r#"{"effect": "link_mass_error", "joint": "elbow", "relative": 0.1}"#,
            r#"{"effect": "link_inertial_error", "joint": "elbow", "form": "turned"}"#,
            r#"{"effect": "inertial_parameters", "joint": null}"#,
        ] {
            assert_eq!(checked(right), "ok", "{right}");
        }
        for (wrong, says) in [
            (r#"{"effect": "torque_ofset", "joint": "elbow", "offset": 0.1}"#, "did you mean \"torque_offset\"?"),
            (r#"{"effect": "torque_offset", "joint": "elbov", "offset": 0.1}"#, "did you mean \"elbow\"?"),
            (r#"{"effect": "torque_offset", "joint": null, "offset": 0.1}"#, "acts on a joint"),
            (r#"{"effect": "link_inertial_error", "joint": null, "relative": 0.1}"#, "acts on a joint"),
            (r#"{"effect": "payload", "joint": "elbow", "mass": 0.1}"#, "acts on the whole arm"),
            (r#"{"effect": "torque_offset", "joint": "elbow"}"#, "state offset"),
            (r#"{"effect": "payload", "joint": null, "com": [0, 0, 0.1]}"#, "state mass"),
            (r#"{"effect": "transmission_coupling", "joint": "elbow", "coulomb": 0.1}"#, "has another joint"),
            (
                r#"{"effect": "transmission_coupling", "joint": "shoulder", "other": "elbow", "coulomb": 0.1}"#,
                "farther from the base",
            ),
            (r#"{"effect": "torque_offset", "joint": "elbow", "offset": "much"}"#, "state offset"),
            (
                r#"{"effect": "transmission_coupling", "joint": "elbow", "other": "wrist", "coulomb": 0.1}"#,
                "the URDF has no joint \"wrist\"",
            ),
        ] {
            assert!(checked(wrong).contains(says), "{wrong}: {}", checked(wrong));
        }
    }
}
