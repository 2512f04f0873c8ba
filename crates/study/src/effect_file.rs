//! Effects as a TOML file: the argument of `--known`, and the corrected model that a diagnosis writes.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, anyhow, ensure};
use arm::{Arm, JointKind};
use effects::{Effect, EffectError, NAMES, ReadError};
use recording::{nearest, toml_reason, unknown_key};
use serde::Deserialize;
use toml::Spanned;
use torque::{Corrected, TorqueError};

use crate::source::Source;

/// The value of the key `schema`.
const SCHEMA: &str = "testbed.model/1";

/// The largest absolute value of a parameter (SI).
const MOST: f64 = 1e12;

/// Effects, and the robot that they belong to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectFile {
    /// The robot's name in its URDF, if the file gives it.
    pub robot: Option<String>,
    /// The effects, in the file's order.
    pub effects: Vec<Effect>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    schema: Option<Spanned<String>>,
    robot: Option<Spanned<String>>,
    #[serde(default)]
    effects: Vec<Spanned<toml::Table>>,
}

impl EffectFile {
    /// Reads the file at `path`, whose effects must fit `arm`.
    ///
    /// # Errors
    /// With file, line, reason and remedy: if the file is unreadable, is not such a TOML file, or belongs to another robot;
    /// if an effect or joint does not exist; if a parameter is physically impossible.
    pub fn load(path: &Path, arm: &Arm) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| {
            let path = path.display();
            format!("{path}: the effects cannot be read; give a file with schema = \"{SCHEMA}\"")
        })?;
        Self::parse(text, path, arm)
    }

    /// Reads effects from text; `path` is its name in errors.
    ///
    /// # Errors
    /// Those of [`Self::load`].
    pub fn parse(text: String, path: &Path, arm: &Arm) -> anyhow::Result<Self> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let path = path.to_owned();
        let source = Source { name, path, text };
        let (robot, tables) = tables(&source, arm)?;
        let mut effects: Vec<Effect> = Vec::new();
        let mut places: Vec<Range<usize>> = Vec::new();
        for table in tables {
            let span = table.span();
            let effect = effect(&source, span.clone(), table.into_inner(), arm)?;
            if let Some(first) = effects.iter().position(|other| is_twin(other, &effect)) {
                let joint = effect.joint().map_or_else(String::new, |joint| format!(" on {joint}"));
                let first = source.place(places[first].clone());
                let reason = format!("{}{joint} is given twice, first at {first}; keep one of the two", effect.name());
                return Err(fail(&source, span, &reason));
            }
            effects.push(effect);
            places.push(span);
        }
        Ok(Self { robot, effects })
    }

    /// The file's text, each parameter with its unit.
    ///
    /// # Errors
    /// If an effect cannot be written as TOML.
    pub fn to_text(&self) -> anyhow::Result<String> {
        let mut text = String::from(
            "# Effects that the URDF omits; testbed diagnose reads them with --known.\n\
             # SI units at the joint; for a prismatic joint, read N for N m and m for rad.\n\n",
        );
        text.push_str(&format!("schema = \"{SCHEMA}\"\n"));
        if let Some(robot) = &self.robot {
            text.push_str(&format!("robot = {}\n", toml::Value::from(robot.as_str())));
        }
        for effect in &self.effects {
            text.push_str("\n[[effects]]\n");
            let table = toml::to_string(effect).with_context(|| format!("{} cannot be written", effect.name()))?;
            for line in table.lines().filter(|line| *line != "curve = []") {
                let key = line.split(" = ").next().unwrap_or_default();
                text.push_str(line);
                if let Some(unit) = unit(effect, key) {
                    text.push_str(&format!(" # {unit}"));
                }
                text.push('\n');
            }
        }
        Ok(text)
    }

    /// Writes the file completely or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> anyhow::Result<()> {
        let text = self.to_text()?;
        Ok(recording::write_whole(path, |file| file.write_all(text.as_bytes()))?)
    }
}

fn fail(source: &Source, span: Range<usize>, reason: &str) -> anyhow::Error {
    anyhow!("{}: {reason}", source.place(span))
}

/// The robot and the tables of effects of a file, after a check of its schema and its robot.
///
/// # Errors
/// With file, line, reason and remedy.
pub fn tables(source: &Source, arm: &Arm) -> anyhow::Result<(Option<String>, Vec<Spanned<toml::Table>>)> {
    if source.text.trim_start().starts_with('{') {
        return Err(fail(source, 0..0, "is JSON; give the .toml file that --model wrote"));
    }
    let raw: RawFile = toml::from_str(&source.text)
        .map_err(|error| fail(source, error.span().unwrap_or(0..0), &toml_reason(error.message())))?;
    let Some(schema) = &raw.schema else {
        let reason = format!("the line schema = \"{SCHEMA}\" is missing; add it at the top");
        return Err(fail(source, 0..0, &reason));
    };
    let (schema, at) = (schema.get_ref(), schema.span());
    ensure!(
        schema == SCHEMA,
        fail(source, at, &format!("the schema is \"{schema}\"; this program reads \"{SCHEMA}\""))
    );
    if let Some(robot) = &raw.robot {
        let (found, wanted) = (robot.get_ref(), arm.name());
        ensure!(
            found == wanted,
            fail(
                source,
                robot.span(),
                &format!(
                    "the effects are of robot \"{found}\", not of \"{wanted}\"; give its file, or leave the line out"
                )
            )
        );
    }
    Ok((raw.robot.map(Spanned::into_inner), raw.effects))
}

/// The largest absolute number in a value.
fn largest(value: &toml::Value) -> f64 {
    match value {
        toml::Value::Float(number) => number.abs(),
        toml::Value::Integer(number) => (*number as f64).abs(),
        toml::Value::Array(list) => list.iter().map(largest).fold(0.0, f64::max),
        toml::Value::Table(table) => table.values().map(largest).fold(0.0, f64::max),
        _ => 0.0,
    }
}

/// The effect of a table at `span` in the file, which must fit `arm`.
///
/// # Errors
/// With file, line, reason and remedy.
pub fn effect(source: &Source, span: Range<usize>, table: toml::Table, arm: &Arm) -> anyhow::Result<Effect> {
    let huge = |(key, value)| Some((key, largest(value))).filter(|(_, value)| value.is_finite() && *value > MOST);
    if let Some((key, value)) = table.iter().find_map(huge) {
        let reason = format!("{key} is {value:e}, which no arm has; check its unit");
        return Err(fail(source, key_span(&source.text, &span, Some(key)), &reason));
    }
    let read = Effect::read(toml::Value::Table(table));
    // A value of a type that no effect has, such as a date.
    let read =
        read.map_err(|error| fail(source, key_span(&source.text, &span, None), &toml_reason(error.message())))?;
    let effect = read.map_err(|error| {
        let (key, reason) = reason(&error, arm);
        fail(source, key_span(&source.text, &span, key), &reason)
    })?;
    if let Err(error) = Corrected::new(arm, std::slice::from_ref(&effect)) {
        let (key, reason) = refusal(&error);
        return Err(fail(source, key_span(&source.text, &span, key.as_deref()), &reason));
    }
    Ok(effect)
}

/// Whether two effects are the same, given twice (perhaps with other sizes).
fn is_twin(a: &Effect, b: &Effect) -> bool {
    // An effect with an onset is in addition to one that always acts.
    let same = a.kind() == b.kind() && a.onset() == b.onset() && a.joint() == b.joint();
    same && (a.spec().is_twin)(a, b)
}

/// The key whose line is wrong in a table, and the reason with the remedy.
fn reason<'a>(error: &'a ReadError, arm: &Arm) -> (Option<&'a str>, String) {
    match error {
        ReadError::UnknownEffect { name } => {
            let known: Vec<String> = NAMES.iter().map(|&name| name.to_owned()).collect();
            let hint = nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
            let reason = format!("there is no effect \"{name}\"; {hint}there are {}", known.join(", "));
            (Some("effect"), reason)
        }
        ReadError::Missing { key: "joint" } => {
            let joints = joints(arm).join(", ");
            (None, format!("the line joint = \"…\" is missing; the robot has {joints}"))
        }
        ReadError::Missing { key } => (None, format!("the line {key} = … is missing; add it")),
        ReadError::UnknownKey { key, known } => {
            let known: Vec<String> = known.iter().map(|&key| key.to_owned()).collect();
            (Some(key), unknown_key(key, &known))
        }
        ReadError::Twice { key } | ReadError::Type { key, .. } => (Some(key), error.to_string()),
    }
}

fn joints(arm: &Arm) -> Vec<String> {
    arm.joints().iter().map(|joint| joint.name.clone()).collect()
}

/// The key for which an effect is refused, and the reason.
fn refusal(error: &TorqueError) -> (Option<String>, String) {
    match error {
        TorqueError::Effect(EffectError::UnknownJoint { joint, known, .. }) => {
            let hint = nearest(joint, known).map_or(String::new(), |near| format!("; did you mean \"{near}\"?"));
            (Some(joint.clone()), format!("{error}{hint}"))
        }
        TorqueError::Effect(EffectError::OwnJoint { .. }) => (Some("other".to_owned()), error.to_string()),
        TorqueError::Effect(EffectError::Parameter { parameter, .. }) => {
            (Some((*parameter).to_owned()), error.to_string())
        }
        _ => (None, error.to_string()),
    }
}

/// The range of bytes of the line in `table` that has `key` as its key or as its text value; `table` itself if there is
/// none.
fn key_span(text: &str, table: &Range<usize>, key: Option<&str>) -> Range<usize> {
    let start = table.start.min(text.len());
    let Some(key) = key else { return start..start };
    let mut at = start;
    for line in text[start..].split_inclusive('\n') {
        if at > start && line.trim_start().starts_with("[[") {
            break;
        }
        let mut parts = line.split('#').next().unwrap_or_default().splitn(2, '=').map(str::trim);
        let (name, value) = (parts.next(), parts.next());
        if name == Some(key) || value.is_some_and(|value| value.trim_matches(['"', '\'']) == key) {
            return at..at;
        }
        at += line.len();
    }
    start..start
}

/// The unit of a parameter, for a comment.
pub(crate) fn unit(effect: &Effect, key: &str) -> Option<&'static str> {
    let parameter = effect.spec().parameter(key)?;
    let remark = parameter.remark.unwrap_or_else(|| parameter.quantity.unit(JointKind::Revolute));
    (!remark.is_empty()).then_some(remark)
}

#[cfg(test)]
mod tests;
