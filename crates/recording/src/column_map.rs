//! Column maps: headers, units, signs and the order of the joints, in TOML.

mod joint;
pub(crate) mod template;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use self::joint::RawJoint;
use crate::header::{Channel, Plan, TimeColumn};
use crate::{Quantity, RecordingError, nearest, toml_reason, units};

/// The assignment of columns, with their units; `docs/recordings.md` describes the keys.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    path: PathBuf,
    delimiter: Option<u8>,
    /// The topics to read of a file that has topics.
    topics: Vec<String>,
    /// For a ready map: the system, the columns by which it is recognised, and the remedy where it has no torques.
    pub(crate) system: Option<System>,
    time: Option<Time>,
    /// The columns whose cells are the joints' names.
    names: Option<String>,
    /// The joints in the order of the file. A name with `{joint}` in it stands for all joints whose columns are there.
    joints: Vec<String>,
    entries: Vec<Entry>,
}

/// The system of a ready map.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct System {
    /// The system's name.
    pub name: String,
    /// The columns by which it is recognised.
    pub known_by: Vec<String>,
    /// The remedy where a column is missing.
    pub remedy: String,
}

/// The columns of the time: the header and the line of each.
#[derive(Clone, Debug, PartialEq)]
struct Time {
    column: (String, usize),
    nanosec: Option<(String, usize)>,
    run: Option<(String, usize)>,
    factor: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
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
    #[serde(default)]
    topics: Vec<String>,
    system: Option<System>,
    names: Option<String>,
    time: Option<RawTime>,
    #[serde(default)]
    joints: BTreeMap<String, Spanned<RawJoint>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTime {
    column: Spanned<String>,
    unit: Option<Spanned<String>>,
    nanosec: Option<Spanned<String>>,
    run: Option<Spanned<String>>,
}

/// The text of a map and where it came from.
pub(crate) struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    fn line(&self, span: Range<usize>) -> usize {
        let before = &self.text.as_bytes()[..span.start.min(self.text.len())];
        before.iter().filter(|byte| **byte == b'\n').count() + 1
    }

    fn error(&self, span: Range<usize>, reason: impl Into<String>) -> RecordingError {
        RecordingError::Map { path: self.path.to_owned(), line: self.line(span), reason: reason.into() }
    }
}

impl ColumnMap {
    /// Reads the map at `path`.
    ///
    /// # Errors
    /// [`RecordingError::Read`], or [`RecordingError::Map`] with the line.
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        let text =
            std::fs::read_to_string(path).map_err(|reason| RecordingError::Read { path: path.to_owned(), reason })?;
        Self::parse(&text, path)
    }

    /// Parses the text of a map; `path` is its name in errors.
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
        let time = raw.time.as_ref().map(|time| time_columns(&source, time)).transpose()?;
        let mut joints: Vec<(&String, &Spanned<RawJoint>)> = raw.joints.iter().collect();
        joints.sort_by_key(|(_, joint)| joint.span().start);
        if joints.is_empty() && raw.topics.is_empty() {
            return Err(source.error(0..0, "there are no joints; give a table [joints.<name>] for each"));
        }
        if !joints.is_empty() && time.is_none() {
            return Err(source.error(0..0, "there is no table [time]; give it with the column of the time"));
        }
        let mut entries = Vec::new();
        for (joint, (_, raw)) in joints.iter().enumerate() {
            joint::entries(&source, joint, raw.get_ref(), &mut entries)?;
        }
        if let Some(time) = &raw.time {
            refuse_shared(&source, &time.column, &entries)?;
        }
        template::check(&source, &joints, &entries)?;
        for (quantity, key) in [(Quantity::Velocity, "qd"), (Quantity::Acceleration, "qdd")] {
            let has =
                |joint: usize| entries.iter().any(|entry: &Entry| entry.joint == joint && entry.quantity == quantity);
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
            topics: raw.topics,
            system: raw.system,
            time,
            names: raw.names,
            joints: joints.iter().map(|(name, _)| (*name).clone()).collect(),
            entries,
        })
    }

    /// The separator of the cells, if the map gives one.
    pub(crate) fn delimiter(&self) -> Option<u8> {
        self.delimiter
    }

    /// The topics to read of a file that has topics; all if there are none.
    pub(crate) fn topics(&self) -> &[String] {
        &self.topics
    }

    /// Whether it names columns, and not only how to read the file.
    pub(crate) fn has_joints(&self) -> bool {
        !self.joints.is_empty()
    }

    /// This map for these topics only.
    pub(crate) fn with_topics(&self, topics: &[String]) -> Self {
        Self { topics: topics.to_vec(), ..self.clone() }
    }

    /// The column that numbers the runs. A file of a known system may lack it, if it holds one run.
    fn run_of<'a>(&self, time: &'a Time, headers: &[String]) -> Option<&'a (String, usize)> {
        let may_lack = |run: &&(String, usize)| self.system.is_none() || headers.contains(&run.0);
        time.run.as_ref().filter(may_lack)
    }

    /// The plan for a file with these headers, whose first row has the cells `first`.
    pub(crate) fn plan(&self, headers: &[String], first: &[String], file: &Path) -> Result<Plan, RecordingError> {
        let find = |(name, line): &(String, usize)| {
            let index = headers.iter().position(|header| header == name).ok_or_else(|| {
                let hint =
                    nearest(name, headers).map_or(String::new(), |nearest| format!("did you mean \"{nearest}\"? "));
                self.refuse(
                    *line,
                    format!(
                        "{} has no column \"{name}\"; {hint}its columns are {}",
                        file.display(),
                        headers.join(", ")
                    ),
                )
            })?;
            Ok::<_, RecordingError>((index, name.clone()))
        };
        let time = self.time.as_ref().ok_or_else(|| {
            let reason = "there is no table [time]; give it with the column of the time".to_owned();
            self.refuse(1, reason)
        })?;
        let (index, header) = find(&time.column)?;
        let time = TimeColumn {
            index,
            header,
            factor: time.factor,
            nanos: time.nanosec.as_ref().map(find).transpose()?,
            run: self.run_of(time, headers).map(find).transpose()?,
        };
        let expanded = self.expand(headers, first)?;
        let mut channels = Vec::new();
        for entry in &expanded.entries {
            let (index, header) = find(&(entry.header.clone(), entry.line))?;
            channels.push(Channel {
                index,
                header,
                quantity: entry.quantity,
                joint: entry.joint,
                factor: entry.factor,
                offset: entry.offset,
            });
        }
        let mut plan = Plan::new(headers, expanded.joints, time, channels);
        plan.others.retain(|(index, _)| !expanded.names.iter().any(|(name, _)| name == index));
        plan.names = expanded.names;
        Ok(plan)
    }

    fn refuse(&self, line: usize, reason: String) -> RecordingError {
        RecordingError::Map { path: self.path.clone(), line, reason }
    }
}

fn time_columns(source: &Source<'_>, raw: &RawTime) -> Result<Time, RecordingError> {
    let placed = |column: &Spanned<String>| (column.get_ref().clone(), source.line(column.span()));
    let factor = match &raw.unit {
        None => 1.0,
        Some(unit) => units::time(unit.get_ref()).map_err(|known| unknown_unit(source, unit, &known))?,
    };
    if let (Some(unit), Some(_)) = (&raw.unit, &raw.nanosec) {
        return Err(
            source.error(unit.span(), "the stamps are whole seconds and nanoseconds; take `unit` or `nanosec` out")
        );
    }
    Ok(Time {
        column: placed(&raw.column),
        nanosec: raw.nanosec.as_ref().map(placed),
        run: raw.run.as_ref().map(placed),
        factor,
    })
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

#[cfg(test)]
#[path = "column_map_tests.rs"]
mod tests;
