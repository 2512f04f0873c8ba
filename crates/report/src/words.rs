//! What the catalogue's names mean to a person.

use std::collections::BTreeSet;

use diagnosis::{Finding, Parameter, Report, Verdict};

/// How an effect is spoken of.
pub struct Wording {
    /// Its name in two or three words.
    pub name: &'static str,
    /// What it is, for somebody who has not met it.
    pub meaning: &'static str,
    /// Which experiment tells it from what looks like it.
    pub told_by: &'static str,
    /// The parameters that say how large it is, the best first.
    main: &'static [&'static str],
}

/// What a finding is called: friction that only the motor's current shows is on the motor's side of the torque sensor.
pub fn cause(finding: &Finding) -> String {
    let name = wording(finding.effect).name;
    if !finding.corrects && finding.effect.ends_with("_friction") {
        format!("motor-side {name}")
    } else {
        name.to_owned()
    }
}

/// The wording of a catalogue name; an unknown name stands for itself.
pub fn wording(effect: &'static str) -> Wording {
    match effects::spec(effect) {
        Some(spec) => Wording {
            name: spec.title,
            meaning: spec.meaning,
            told_by: spec.told_by,
            main: spec.main,
        },
        None => Wording {
            name: effect,
            meaning: "",
            told_by: "",
            main: &[],
        },
    }
}

/// The parameter that says how large a finding is, with its name.
pub fn main_parameter(finding: &Finding) -> Option<(&'static str, &Parameter)> {
    let main = wording(finding.effect).main;
    let named = main
        .iter()
        .find_map(|name| finding.parameters.get_key_value(name).filter(|(_, p)| p.value != 0.0));
    let found = named.or_else(|| finding.parameters.iter().next());
    found.map(|(name, parameter)| (*name, parameter))
}

/// `start` with a capital.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

/// The joint, or the whole arm.
pub fn joint(joint: Option<&str>) -> &str {
    joint.unwrap_or("whole arm")
}

/// `own_position`, `other_joint:NAME` and the like, in words.
pub fn dependence(code: &str) -> String {
    if let Some((kind, name)) = code.split_once(':') {
        let kind = kind.replace('_', " ");
        return match kind.as_str() {
            "other joint" => format!("the motion of {name}"),
            _ => format!("{kind} {name}"),
        };
    }
    match code {
        "own_position" => "its own position".into(),
        "own_speed" => "its own speed".into(),
        "own_acceleration" => "its own acceleration".into(),
        "time" => "time".into(),
        "history" => "what it did before (hysteresis)".into(),
        "load" => "the torque it carries".into(),
        other => other.replace('_', " "),
    }
}

/// A, B and C.
pub fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The joint on which a finding shows most: its own, or the largest share of a whole-arm effect.
pub fn shows_on(finding: &Finding) -> Option<&str> {
    finding.joint.as_deref().or_else(|| {
        let shares = finding.share_by_joint.iter();
        let largest = shares.max_by(|(_, a), (_, b)| a.total_cmp(b));
        largest.map(|(joint, _)| joint.as_str())
    })
}

/// The verdict as a sentence, before everything else.
pub fn verdict(report: &Report) -> String {
    let effects = count(report.findings.len(), "effect");
    let joints: BTreeSet<_> = report.findings.iter().filter_map(|f| f.joint.as_deref()).collect();
    let has_whole_arm = report.findings.iter().any(|finding| finding.joint.is_none());
    let mut on = Vec::new();
    if !joints.is_empty() {
        on.push(match joints.len() {
            1 => joints.iter().map(|joint| (*joint).to_owned()).collect(),
            several => format!("{several} joints"),
        });
    }
    if has_whole_arm {
        on.push("the whole arm".to_owned());
    }
    let on = list(&on);
    let left: Vec<String> = report.unexplained.iter().map(|left| left.joint.clone()).collect();
    let left = if left.len() > 3 {
        format!("{} joints", left.len())
    } else {
        list(&left)
    };
    match report.verdict {
        Verdict::NoMismatch if report.findings.is_empty() => {
            "The model explains the recordings: nothing is missing that they could show.".into()
        }
        Verdict::NoMismatch => format!("The model explains the recordings up to {effects} on {on}."),
        Verdict::Explained => {
            format!("The model leaves out {effects} on {on}. Named and added, they explain the difference.")
        }
        Verdict::PartlyExplained if left.is_empty() => {
            format!("The model leaves out {effects} on {on}. They explain part of the difference, not all of it.")
        }
        Verdict::PartlyExplained => {
            format!("The model leaves out {effects} on {on}, and something without a name on {left}.")
        }
        Verdict::Unexplained if left.is_empty() => {
            "Robot and model differ, and no effect that was tried explains how.".into()
        }
        Verdict::Unexplained => {
            format!("Robot and model differ on {left}, and no effect that was tried explains how.")
        }
        Verdict::NotEnoughData => "These recordings do not say enough for a diagnosis.".into(),
    }
}

/// `1 effect`, `3 effects`.
pub fn count(number: usize, what: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {what}{ending}")
}
