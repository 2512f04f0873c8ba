//! Messages `sensor_msgs/msg/JointState` of ROS 2, in CDR, and the table that the messages of a bag make.

use std::collections::BTreeMap;

use crate::RecordingError;
use crate::Warning;
use crate::bag_order::{Latest, Order, set_back};
use crate::bag_windows::BagWindows;
use crate::bytes::Bytes;
use crate::input::Input;
use crate::series::{Series, at};
use crate::table::{Column, Table};

/// The type's names: of ROS 2, and of an older form.
pub const TYPES: [&str; 2] = ["sensor_msgs/msg/JointState", "sensor_msgs/JointState"];
const FIELDS: [&str; 3] = ["position", "velocity", "effort"];
const NANOS: i64 = 1_000_000_000;
/// A topic is joined with another one if it covers this share of its time.
const COVERED: f64 = 0.9;

/// One message.
#[derive(Debug, PartialEq)]
struct JointState<'a> {
    /// The stamp in its header (ns); 0 if it is not set.
    stamp: i64,
    names: Vec<&'a str>,
    /// Positions, velocities and efforts; each has as many values as there are names, or none.
    fields: [Vec<f64>; 3],
}

/// Parses a message in CDR (version 1, little or big endian).
fn decode(data: &[u8]) -> Result<JointState<'_>, String> {
    let (kind, body) = match data {
        [0, kind @ (0 | 1), _, _, body @ ..] => (*kind, body),
        [first, second, ..] => {
            return Err(format!(
                "it begins with the bytes {first}, {second}, and CDR with 0, 0 or 0, 1; record it with a rosbag2 that writes CDR"
            ));
        }
        _ => return Err("it is cut".to_owned()),
    };
    let message = decode_body(Bytes::new(body, kind == 0)).ok_or("it is cut or damaged")?;
    let names = message.names.len();
    for (field, values) in FIELDS.iter().zip(&message.fields) {
        if !values.is_empty() && values.len() != names {
            let count = values.len();
            return Err(format!(
                "it has {names} names and {count} values of {field}; publish one of each joint"
            ));
        }
    }
    Ok(message)
}

fn decode_body(mut body: Bytes<'_>) -> Option<JointState<'_>> {
    let seconds = body.u32()?.cast_signed();
    let nanos = body.u32()?;
    body.text()?;
    body.align(4)?;
    let count = body.u32()?;
    let mut names = Vec::new();
    for _ in 0..count {
        body.align(4)?;
        names.push(body.text()?);
    }
    let mut fields = [const { Vec::new() }; 3];
    for values in &mut fields {
        body.align(4)?;
        let count = body.u32()? as usize;
        if count == 0 {
            continue;
        }
        body.align(8)?;
        if count > body.left() / 8 {
            return None;
        }
        for _ in 0..count {
            values.push(body.f64()?);
        }
    }
    Some(JointState {
        stamp: i64::from(seconds) * NANOS + i64::from(nanos),
        names,
        fields,
    })
}

/// The joint states of a bag, by topic and joint.
#[derive(Debug, Default)]
pub struct JointStates {
    topics: BTreeMap<String, Vec<Joint>>,
    messages: u64,
    order: Order,
    /// The windows that are kept, if not everything is.
    windows: Option<BagWindows>,
}

#[derive(Debug)]
struct Joint {
    name: String,
    fields: [Series; 3],
    latest: Latest,
}

impl JointStates {
    /// None yet; of bags that last longer than `seconds` (s), windows of that time in all are kept.
    pub fn new(seconds: Option<f64>) -> Self {
        Self {
            windows: seconds.map(BagWindows::new),
            ..Self::default()
        }
    }

    /// The number of messages so far.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// Takes a message of `topic` that was logged at `logged` (ns).
    ///
    /// # Errors
    /// The reason why it is not a joint state.
    pub fn add(&mut self, topic: &str, logged: i64, data: &[u8]) -> Result<(), String> {
        self.messages += 1;
        let number = self.messages;
        let message =
            decode(data).map_err(|reason| format!("message {number} of joint states, in {topic}: {reason}"))?;
        let time = if message.stamp == 0 { logged } else { message.stamp };
        if !self.topics.contains_key(topic) {
            self.topics.insert(topic.to_owned(), Vec::new());
        }
        let Some(joints) = self.topics.get_mut(topic) else {
            return Ok(());
        };
        let known: Vec<usize> = message.names.iter().enumerate().map(|at| place(joints, at)).collect();
        let mut late = None;
        for &known in &known {
            let lateness = joints[known].latest.lateness((number, time), message.stamp != 0);
            late = late.max(lateness.map_err(|first| set_back(first, topic))?);
        }
        if let Some(late) = late {
            self.order.count(late, topic);
        }
        if let Some(windows) = &mut self.windows {
            let topics = &mut self.topics;
            let give_up = |windows: &BagWindows| {
                for series in topics.values_mut().flatten().flat_map(|joint| &mut joint.fields) {
                    series.retain(|(time, _)| windows.takes(*time));
                }
            };
            if !windows.wants(time, give_up) {
                return Ok(());
            }
        }
        let Some(joints) = self.topics.get_mut(topic) else {
            return Ok(());
        };
        for (index, known) in known.into_iter().enumerate() {
            for (series, values) in joints[known].fields.iter_mut().zip(&message.fields) {
                if let Some(value) = values.get(index) {
                    series.push((time, *value));
                }
            }
        }
        Ok(())
    }

    /// The table of all joint states, with the columns `<topic>/<joint>/position` and so on, at the stamps of the
    /// joint with the most values. `chosen` topics are always joined, others if they add something.
    ///
    /// # Errors
    /// [`RecordingError::Format`] if there are none.
    pub fn into_table(
        mut self,
        input: &Input,
        format: &'static str,
        chosen: &[String],
    ) -> Result<Table, RecordingError> {
        let joints = self.topics.values_mut().flatten();
        joints.flat_map(|joint| &mut joint.fields).for_each(|series| {
            series.sort_by_key(|(time, _)| *time);
        });
        let samples = |(_, joints): &(&String, &Vec<Joint>)| {
            let count = joints.iter().map(|joint| joint.fields[0].len()).max();
            // The first of equal ones.
            (count.unwrap_or(0), std::cmp::Reverse(joints.len()))
        };
        let base = self.topics.iter().rev().max_by_key(samples);
        let base = base.map(|(topic, joints)| (topic.clone(), joints.iter().max_by_key(|joint| joint.fields[0].len())));
        let Some((base, Some(most))) = base.filter(|(_, joint)| joint.is_some_and(|joint| !joint.fields[0].is_empty()))
        else {
            return Err(input.error(
                format,
                "its joint states have no positions; record a topic that has them",
            ));
        };
        let times: Vec<i64> = most.fields[0].iter().map(|(time, _)| *time).collect();
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        let mut warnings = self.order.warnings();
        let mut keeps = vec![true; times.len()];
        for (topic, joints) in &self.topics {
            if *topic != base && !chosen.contains(topic) && adds_nothing(joints, &self.topics[&base]) {
                let what = format!("topic {topic} was left out: it adds nothing to {base}");
                warnings.push(Warning::LeftOut { what });
                continue;
            }
            for joint in joints {
                join(topic, joint, &times, &mut columns, &mut keeps, &mut warnings);
            }
        }
        let kept = |values: Vec<f64>| -> Vec<f64> {
            let kept = values.into_iter().zip(&keeps).filter(|(_, keeps)| **keeps);
            kept.map(|(value, _)| value).collect()
        };
        let stamps = times.iter().zip(&keeps).filter(|(_, keeps)| **keeps);
        let stamps = Column::Nanos(stamps.map(|(time, _)| *time).collect());
        let columns = columns
            .into_iter()
            .map(|(name, values)| (name, Column::Numbers(kept(values))));
        let mut table = Table::of_columns(std::iter::once(("__time".to_owned(), stamps)).chain(columns).collect());
        table.warnings = warnings;
        table.left_out = self.windows.as_ref().map_or(0.0, BagWindows::left_out);
        Ok(table)
    }
}

/// The place in `joints` of the joint that has this index and name in a message; it is added if it is new.
fn place(joints: &mut Vec<Joint>, (index, name): (usize, &&str)) -> usize {
    // The order of the joints rarely changes.
    let known = match joints.get(index) {
        Some(joint) if joint.name == *name => Some(index),
        _ => joints.iter().position(|joint| joint.name == *name),
    };
    known.unwrap_or_else(|| {
        joints.push(Joint {
            name: (*name).to_owned(),
            fields: [const { Vec::new() }; 3],
            latest: Latest::default(),
        });
        joints.len() - 1
    })
}

/// Whether the base topic has positions and efforts of all `joints`, each of which lacks one or the other.
fn adds_nothing(joints: &[Joint], base: &[Joint]) -> bool {
    let has = |joint: &Joint| !joint.fields[0].is_empty() && !joint.fields[2].is_empty();
    let in_base = |name: &str| base.iter().any(|joint| joint.name == name && has(joint));
    joints.iter().all(|joint| in_base(&joint.name) && !has(joint))
}

/// Adds the columns of a joint at `times`; rows without values are removed.
fn join(
    topic: &str,
    joint: &Joint,
    times: &[i64],
    columns: &mut Vec<(String, Vec<f64>)>,
    keeps: &mut [bool],
    warnings: &mut Vec<Warning>,
) {
    let (mut interpolated, mut left_out) = (0, 0);
    for (field, series) in FIELDS.iter().zip(&joint.fields) {
        if series.is_empty() {
            continue;
        }
        let name = format!("{topic}/{}/{field}", joint.name);
        if series.len() == times.len() && series.iter().zip(times).all(|((a, _), b)| a == b) {
            columns.push((name, series.iter().map(|(_, value)| *value).collect()));
            continue;
        }
        let (values, between) = at(series, times);
        let found = values.iter().filter(|value| value.is_some()).count();
        if (found as f64) < COVERED * times.len() as f64 {
            let what = format!(
                "{name} was left out: it has values in {found} of {} rows only",
                times.len()
            );
            warnings.push(Warning::LeftOut { what });
            continue;
        }
        for (keep, value) in keeps.iter_mut().zip(&values) {
            *keep &= value.is_some();
        }
        (interpolated, left_out) = (between.max(interpolated), left_out.max(times.len() - found));
        columns.push((
            name,
            values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect(),
        ));
    }
    if interpolated + left_out > 0 {
        warnings.push(Warning::Joined {
            what: format!("{} in {topic}", joint.name),
            interpolated,
            left_out,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A message in CDR of either byte order, with a stamp of 3.5 s.
    fn message(big_endian: bool) -> Vec<u8> {
        let mut data = vec![0, u8::from(!big_endian), 0, 0];
        let word = |value: u32| {
            if big_endian {
                value.to_be_bytes()
            } else {
                value.to_le_bytes()
            }
        };
        let number = |value: f64| {
            if big_endian {
                value.to_be_bytes()
            } else {
                value.to_le_bytes()
            }
        };
        let pad = |data: &mut Vec<u8>, size: usize| {
            while !(data.len() - 4).is_multiple_of(size) {
                data.push(0);
            }
        };
        data.extend(word(3));
        data.extend(word(500_000_000));
        let text = |data: &mut Vec<u8>, text: &str| {
            pad(data, 4);
            data.extend(word(text.len() as u32 + 1));
            data.extend(text.bytes());
            data.push(0);
        };
        text(&mut data, "base");
        pad(&mut data, 4);
        data.extend(word(2));
        text(&mut data, "elbow");
        text(&mut data, "wrist");
        for values in [&[1.5, -2.5][..], &[], &[7.0, f64::NAN]] {
            pad(&mut data, 4);
            data.extend(word(values.len() as u32));
            if !values.is_empty() {
                pad(&mut data, 8);
            }
            values.iter().for_each(|&value| data.extend(number(value)));
        }
        data
    }

    #[test]
    fn both_byte_orders_are_read() {
        for big_endian in [false, true] {
            let data = message(big_endian);
            let read = decode(&data).expect("it is a message");
            assert_eq!((read.stamp, read.names), (3_500_000_000, vec!["elbow", "wrist"]));
            assert_eq!(read.fields[0], [1.5, -2.5]);
            assert!(read.fields[1].is_empty() && read.fields[2][0] == 7.0 && read.fields[2][1].is_nan());
        }
    }

    #[test]
    fn a_cut_or_damaged_message_is_refused() {
        let data = message(false);
        for length in 0..data.len() {
            assert!(decode(&data[..length]).is_err(), "{length}");
        }
        for at in 0..data.len() {
            for value in [0, 1, 0x7F, 0xFF] {
                let mut damaged = data.clone();
                damaged[at] = value;
                // Both results are allowed; the test is that reading ends.
                let _ = decode(&damaged);
            }
        }
    }
}
