//! Anybody's headers, units, signs and joint order, told in TOML.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use crate::header::{Channel, Plan};
use crate::units::{self, Conversion};
use crate::{Quantity, RecordingError, nearest, toml_reason};

/// Which column holds what, in which unit: `docs/recordings.md` has the keys.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    path: PathBuf,
    delimiter: Option<u8>,
    time: (String, usize),
    time_factor: f64,
    /// In the order of the file.
    joints: Vec<String>,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug, PartialEq)]
struct Entry {
    header: String,
    line: usize,
    quantity: Quantity,
    joint: usize,
    factor: f64,
    offset: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMap {
    delimiter: Option<Spanned<String>>,
    time: RawTime,
    joints: BTreeMap<String, Spanned<RawJoint>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTime {
    column: Spanned<String>,
    unit: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJoint {
    q: Spanned<String>,
    q_unit: Option<Spanned<String>>,
    q_scale: Option<Spanned<f64>>,
    q_offset: Option<Spanned<f64>>,
    qd: Option<Spanned<String>>,
    qd_unit: Option<Spanned<String>>,
    qd_scale: Option<Spanned<f64>>,
    qdd: Option<Spanned<String>>,
    qdd_unit: Option<Spanned<String>>,
    qdd_scale: Option<Spanned<f64>>,
    tau: Spanned<String>,
    tau_unit: Option<Spanned<String>>,
    tau_scale: Option<Spanned<f64>>,
    tau_sign: Option<Spanned<f64>>,
    sign: Option<Spanned<f64>>,
    gear: Option<Spanned<f64>>,
    q_secondary: Option<Spanned<String>>,
    q_secondary_unit: Option<Spanned<String>>,
    q_secondary_scale: Option<Spanned<f64>>,
    tau_current: Option<Spanned<String>>,
    tau_current_unit: Option<Spanned<String>>,
    tau_current_scale: Option<Spanned<f64>>,
    current: Option<Spanned<String>>,
    current_unit: Option<Spanned<String>>,
    temperature: Option<Spanned<String>>,
    temperature_unit: Option<Spanned<String>>,
}

/// The text of a map and where it came from.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    fn line(&self, span: Range<usize>) -> usize {
        let before = &self.text.as_bytes()[..span.start.min(self.text.len())];
        before.iter().filter(|byte| **byte == b'\n').count() + 1
    }

    fn error(&self, span: Range<usize>, reason: impl Into<String>) -> RecordingError {
        RecordingError::Map {
            path: self.path.to_owned(),
            line: self.line(span),
            reason: reason.into(),
        }
    }
}

impl ColumnMap {
    /// Reads the map at `path`.
    ///
    /// # Errors
    /// [`RecordingError::Read`], or [`RecordingError::Map`] with the line.
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        let text = std::fs::read_to_string(path).map_err(|reason| RecordingError::Read {
            path: path.to_owned(),
            reason,
        })?;
        Self::parse(&text, path)
    }

    /// Understands the text of a map; `path` is for the errors.
    ///
    /// # Errors
    /// [`RecordingError::Map`] with the line; an unknown key comes with the nearest known one.
    pub fn parse(text: &str, path: &Path) -> Result<Self, RecordingError> {
        let source = Source { path, text };
        let raw: RawMap = toml::from_str(text)
            .map_err(|error| source.error(error.span().unwrap_or(0..0), toml_reason(error.message())))?;
        let delimiter = match &raw.delimiter {
            None => None,
            Some(text) => match text.get_ref().as_bytes() {
                [byte] => Some(*byte),
                _ => return Err(source.error(text.span(), "delimiter must be one character: \",\", \";\" or \"\\t\"")),
            },
        };
        let time_factor = match &raw.time.unit {
            None => 1.0,
            Some(unit) => units::time(unit.get_ref()).map_err(|known| unknown_unit(&source, unit, &known))?,
        };
        let mut joints: Vec<(&String, &Spanned<RawJoint>)> = raw.joints.iter().collect();
        joints.sort_by_key(|(_, joint)| joint.span().start);
        if joints.is_empty() {
            return Err(source.error(0..0, "there are no joints; give a table [joints.<name>] for each"));
        }
        let mut entries = Vec::new();
        for (joint, (_, raw)) in joints.iter().enumerate() {
            joint_entries(&source, joint, raw.get_ref(), &mut entries)?;
        }
        refuse_shared(&source, &raw.time.column, &entries)?;
        for (quantity, key) in [(Quantity::Velocity, "qd"), (Quantity::Acceleration, "qdd")] {
            let has = |joint: usize| {
                entries
                    .iter()
                    .any(|entry: &Entry| entry.joint == joint && entry.quantity == quantity)
            };
            let count = (0..joints.len()).filter(|&joint| has(joint)).count();
            if count > 0 && count < joints.len() {
                let missing = (0..joints.len()).find(|&joint| !has(joint)).unwrap_or(0);
                let (name, raw) = joints[missing];
                return Err(source.error(
                    raw.span(),
                    format!("joint \"{name}\" has no `{key}`, though others have; give it for all joints or for none"),
                ));
            }
        }
        Ok(Self {
            path: path.to_owned(),
            delimiter,
            time: (raw.time.column.get_ref().clone(), source.line(raw.time.column.span())),
            time_factor,
            joints: joints.iter().map(|(name, _)| (*name).clone()).collect(),
            entries,
        })
    }

    /// What separates the cells, where the map says.
    pub(crate) fn delimiter(&self) -> Option<u8> {
        self.delimiter
    }

    /// What to read from a file with these headers.
    pub(crate) fn plan(&self, headers: &[String], file: &Path) -> Result<Plan, RecordingError> {
        let find = |name: &str, line: usize| {
            headers.iter().position(|header| header == name).ok_or_else(|| {
                let hint =
                    nearest(name, headers).map_or(String::new(), |nearest| format!("did you mean \"{nearest}\"? "));
                RecordingError::Map {
                    path: self.path.clone(),
                    line,
                    reason: format!(
                        "{} has no column \"{name}\"; {hint}its columns are {}",
                        file.display(),
                        headers.join(", ")
                    ),
                }
            })
        };
        let time = find(&self.time.0, self.time.1)?;
        let mut channels = Vec::new();
        for entry in &self.entries {
            channels.push(Channel {
                index: find(&entry.header, entry.line)?,
                header: entry.header.clone(),
                quantity: entry.quantity,
                joint: entry.joint,
                factor: entry.factor,
                offset: entry.offset,
            });
        }
        let others = (0..headers.len())
            .filter(|&index| index != time && !channels.iter().any(|channel| channel.index == index))
            .map(|index| (index, headers[index].clone()))
            .collect();
        Ok(Plan {
            joints: self.joints.clone(),
            time,
            time_header: headers[time].clone(),
            time_factor: self.time_factor,
            channels,
            others,
        })
    }
}

/// Refuses a column that is to be two things; a current may be the torque, too.
fn refuse_shared(source: &Source<'_>, time: &Spanned<String>, entries: &[Entry]) -> Result<(), RecordingError> {
    let drives = |entry: &Entry| ["tau_", "tau_current_", "current_"].contains(&entry.quantity.prefix());
    for (k, entry) in entries.iter().enumerate() {
        let taken = |other: &&Entry| {
            other.header == entry.header && !(other.joint == entry.joint && drives(other) && drives(entry))
        };
        let line = match entries[..k].iter().find(taken) {
            Some(other) => other.line,
            None if *time.get_ref() == entry.header => source.line(time.span()),
            None => continue,
        };
        return Err(RecordingError::Map {
            path: source.path.to_owned(),
            line: entry.line,
            reason: format!(
                "column \"{}\" is taken in line {line} already; name another in one of the two",
                entry.header
            ),
        });
    }
    Ok(())
}

fn unknown_unit(source: &Source<'_>, unit: &Spanned<String>, known: &str) -> RecordingError {
    let reason = format!("unknown unit \"{}\"; known here: {known}", unit.get_ref());
    source.error(unit.span(), reason)
}

/// A number that must be finite and not zero.
fn factor(source: &Source<'_>, value: Option<&Spanned<f64>>, key: &str) -> Result<f64, RecordingError> {
    match value {
        None => Ok(1.0),
        Some(value) if value.get_ref().is_finite() && *value.get_ref() != 0.0 => Ok(*value.get_ref()),
        Some(value) => Err(source.error(
            value.span(),
            format!("{key} is {}; it must be finite and not zero", value.get_ref()),
        )),
    }
}

fn sign(source: &Source<'_>, value: Option<&Spanned<f64>>, key: &str) -> Result<f64, RecordingError> {
    match value {
        Some(value) if value.get_ref().abs() != 1.0 => Err(source.error(
            value.span(),
            format!("{key} is {}; it must be 1 or -1", value.get_ref()),
        )),
        value => Ok(value.map_or(1.0, |value| *value.get_ref())),
    }
}

fn joint_entries(
    source: &Source<'_>,
    joint: usize,
    raw: &RawJoint,
    entries: &mut Vec<Entry>,
) -> Result<(), RecordingError> {
    let joint_sign = sign(source, raw.sign.as_ref(), "sign")?;
    let tau_sign = sign(source, raw.tau_sign.as_ref(), "tau_sign")?;
    let gear = factor(source, raw.gear.as_ref(), "gear")?;
    let q_offset = match &raw.q_offset {
        Some(value) if !value.get_ref().is_finite() => {
            return Err(source.error(value.span(), "q_offset must be finite (rad or m)"));
        }
        value => value.as_ref().map_or(0.0, |value| *value.get_ref()),
    };
    // Motor-side motion is divided by the gear's ratio, motor-side torque multiplied; the second
    // encoder sits on the link's side.
    let motion = joint_sign / gear;
    let torque = joint_sign * tau_sign * gear;
    let rows = [
        (
            Quantity::Position,
            "q",
            Some(&raw.q),
            &raw.q_unit,
            &raw.q_scale,
            motion,
            q_offset,
        ),
        (
            Quantity::Velocity,
            "qd",
            raw.qd.as_ref(),
            &raw.qd_unit,
            &raw.qd_scale,
            motion,
            0.0,
        ),
        (
            Quantity::Acceleration,
            "qdd",
            raw.qdd.as_ref(),
            &raw.qdd_unit,
            &raw.qdd_scale,
            motion,
            0.0,
        ),
        (
            Quantity::Torque,
            "tau",
            Some(&raw.tau),
            &raw.tau_unit,
            &raw.tau_scale,
            torque,
            0.0,
        ),
        (
            Quantity::SecondaryPosition,
            "q_secondary",
            raw.q_secondary.as_ref(),
            &raw.q_secondary_unit,
            &raw.q_secondary_scale,
            joint_sign,
            q_offset,
        ),
        (
            Quantity::CurrentTorque,
            "tau_current",
            raw.tau_current.as_ref(),
            &raw.tau_current_unit,
            &raw.tau_current_scale,
            torque,
            0.0,
        ),
        (
            Quantity::Current,
            "current",
            raw.current.as_ref(),
            &raw.current_unit,
            &None,
            joint_sign * tau_sign,
            0.0,
        ),
        (
            Quantity::Temperature,
            "temperature",
            raw.temperature.as_ref(),
            &raw.temperature_unit,
            &None,
            1.0,
            0.0,
        ),
    ];
    for (quantity, key, column, unit, scale, side, offset) in rows {
        let Some(column) = column else {
            if let Some(unit) = unit {
                return Err(source.error(unit.span(), format!("{key}_unit is given, but no column `{key}`")));
            }
            continue;
        };
        let conversion = match unit {
            None => Conversion::NONE,
            Some(unit) => units::of(quantity, unit.get_ref()).map_err(|known| unknown_unit(source, unit, &known))?,
        };
        if let (true, None, Some(unit)) = (conversion.needs_scale, scale, unit) {
            return Err(source.error(
                unit.span(),
                format!(
                    "a torque in \"{}\" needs {key}_scale, the N m (or N) that one unit makes",
                    unit.get_ref()
                ),
            ));
        }
        let scale = factor(source, scale.as_ref(), &format!("{key}_scale"))?;
        entries.push(Entry {
            header: column.get_ref().clone(),
            line: source.line(column.span()),
            quantity,
            joint,
            factor: conversion.factor * scale * side,
            offset: offset + conversion.offset,
        });
    }
    Ok(())
}

#[cfg(test)]
#[path = "column_map_tests.rs"]
mod tests;
