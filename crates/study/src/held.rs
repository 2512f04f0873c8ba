//! The parts of effects that the formats of other programs can hold: what URDF and MJCF have in common.

use arm::{Arm, Joint, JointKind};
use effects::drive::ROTOR_INERTIA;
use effects::friction::{
    COULOMB_FRICTION, FRICTION_ASYMMETRY, LOAD_DEPENDENT_FRICTION, STRIBECK_FRICTION, VISCOUS_FRICTION,
};
use effects::{Effect, InUrdf};
use report::numbers;

/// A robot in the format of another program.
#[derive(Debug)]
pub struct Export {
    /// The text of the file.
    pub text: String,
    /// The effects, or parts of them, that the format cannot hold, one line each.
    pub omitted: Vec<String>,
}

/// The part of an effect that a format can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// All of it.
    Whole,
    /// All but this part.
    Without(&'static str),
    /// Nothing.
    Nothing,
}

/// The level of a dry friction (N m or N) in a format that has one level for all speeds and both directions, and the part
/// of the effect that this level holds; `None` for an effect that is not dry friction.
pub fn level(effect: &Effect) -> Option<(f64, Held)> {
    if effect.onset().is_some() {
        None
    } else if effect.is(&COULOMB_FRICTION) {
        Some((effect.number("level"), Held::Whole))
    } else if effect.is(&FRICTION_ASYMMETRY) {
        let mean = 0.5 * (effect.number("positive") + effect.number("negative"));
        Some((mean, Held::Without("the difference between the directions; their mean is in it")))
    } else if effect.is(&STRIBECK_FRICTION) {
        let held = Held::Without("the rise towards standstill; the level in motion is in it");
        Some((effect.number("coulomb"), held))
    } else if effect.is(&LOAD_DEPENDENT_FRICTION) {
        let held = Held::Without("the part in proportion to the load; the level without load is in it");
        Some((effect.number("coulomb"), held))
    } else {
        None
    }
}

/// The part of an effect that URDF and MJCF can both hold: damping, one level of dry friction, bodies, rotor inertias.
pub fn in_common(effect: &Effect) -> Held {
    if effect.onset().is_some() {
        Held::Nothing
    } else if let Some((_, held)) = level(effect) {
        held
    } else if effect.spec().in_urdf != InUrdf::Nothing || effect.is(&ROTOR_INERTIA) {
        Held::Whole
    } else {
        Held::Nothing
    }
}

/// The damping (N m s/rad or N s/m) and the level of dry friction (N m or N) of a joint with these effects, if any of them is a
/// friction.
pub fn friction(joint: &Joint, effects: &[Effect]) -> Option<(f64, f64)> {
    let on_joint =
        effects.iter().filter(|effect| effect.joint() == Some(joint.name.as_str()) && effect.onset().is_none());
    let mut found = None;
    for effect in on_joint {
        let (damping, friction) = if effect.is(&VISCOUS_FRICTION) {
            (effect.number("coefficient"), 0.0)
        } else if let Some((level, _)) = level(effect) {
            (0.0, level)
        } else {
            continue;
        };
        let (d, f) = found.unwrap_or((0.0, 0.0));
        found = Some((d + damping, f + friction));
    }
    found
}

/// The effects that a format cannot hold, completely or in part, one line each.
///
/// # Errors
/// If an effect cannot be written.
pub fn left_out(arm: &Arm, effects: &[Effect], held: impl Fn(&Effect) -> Held) -> anyhow::Result<Vec<String>> {
    let mut lines = Vec::new();
    for effect in effects {
        let what = match held(effect) {
            Held::Whole => continue,
            Held::Without(what) => format!(" ({what})"),
            Held::Nothing => String::new(),
        };
        let table = toml::Table::try_from(effect)?;
        let is_shown = |(key, value): &(&String, &toml::Value)| {
            !matches!(key.as_str(), "effect" | "joint") && value.as_array().is_none_or(|list| !list.is_empty())
        };
        let place = |key: &str| effect.spec().parameters.iter().position(|parameter| parameter.key == key);
        let kind = effect.joint().and_then(|name| arm.joints().iter().find(|joint| joint.name == name));
        let kind = kind.map_or(JointKind::Revolute, |joint| joint.kind);
        let mut parameters: Vec<(&String, &toml::Value)> = table.iter().filter(is_shown).collect();
        parameters.sort_by_key(|(key, _)| place(key).unwrap_or(usize::MAX));
        let parameters = parameters.into_iter().map(|(key, value)| {
            let unit = effect.spec().unit(key, kind).filter(|unit| *unit != "1");
            let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
            format!("{key} {}{unit}", shown(value))
        });
        let parameters: Vec<String> = parameters.collect();
        let joint = effect.joint().map_or_else(String::new, |joint| format!(" of {joint}"));
        lines.push(format!("{}{joint}{what}: {}", effect.name(), parameters.join(", ")));
    }
    Ok(lines)
}

/// A parameter with four digits; the file that `--model` writes has all of them.
fn shown(value: &toml::Value) -> String {
    match value {
        toml::Value::Float(number) => numbers::rounded(*number, 4),
        toml::Value::Array(list) => list.iter().map(shown).collect::<Vec<_>>().join(" "),
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Lines as the text of an XML comment.
pub fn comment(lines: &[String]) -> String {
    // A comment in XML must not contain two hyphens in a row.
    lines.join("\n       ").replace("--", "- -").replace("--", "- -")
}
