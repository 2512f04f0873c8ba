//! A joint of a column map that represents many: `{joint}` in its name and in its columns, `{topic}` before it.

use toml::Spanned;

use super::joint::RawJoint;
use super::{ColumnMap, Entry, Source};
use crate::{Quantity, RecordingError};

const JOINT: &str = "{joint}";
const TOPIC: &str = "{topic}";

/// The joints of one file, and their columns.
pub struct Expanded {
    pub joints: Vec<String>,
    pub entries: Vec<Entry>,
    /// The columns whose cells are the joints' names, with the names.
    pub names: Vec<(usize, String)>,
}

/// The topic and the joint of a column named by `pattern`; the topic is empty where the pattern has none.
pub fn capture<'a>(pattern: &str, header: &'a str) -> Option<(&'a str, &'a str)> {
    let (before, after) = pattern.split_once(JOINT)?;
    let rest = header.strip_suffix(after)?;
    let (topic, joint) = match before.strip_prefix(TOPIC) {
        Some(between) => rest.rsplit_once(between)?,
        None => ("", rest.strip_prefix(before)?),
    };
    (!joint.is_empty()).then_some((topic, joint))
}

fn filled(pattern: &str, topic: &str, joint: &str) -> String {
    pattern.replace(TOPIC, topic).replace(JOINT, joint)
}

/// Refuses a template beside other joints, and a column of a template that is the same for all joints.
pub fn check(
    source: &Source<'_>,
    joints: &[(&String, &Spanned<RawJoint>)],
    entries: &[Entry],
) -> Result<(), RecordingError> {
    let Some((_, raw)) = joints.iter().find(|(name, _)| name.contains(JOINT)) else {
        return Ok(());
    };
    if joints.len() > 1 {
        let reason = "a joint with \"{joint}\" in its name stands for all joints; it must be the only one";
        return Err(source.error(raw.span(), reason));
    }
    match entries.iter().find(|entry| !entry.header.contains(JOINT)) {
        None => Ok(()),
        Some(entry) => Err(RecordingError::Map {
            path: source.path.to_owned(),
            line: entry.line,
            reason: format!(
                "column \"{}\" would be that of every joint; write \"{{joint}}\" where its name differs",
                entry.header
            ),
        }),
    }
}

impl ColumnMap {
    /// The joints and columns of a file with these headers, whose first row has the cells `first`.
    pub(super) fn expand(&self, headers: &[String], first: &[String]) -> Result<Expanded, RecordingError> {
        let [template] = &self.joints[..] else {
            return Ok(self.as_it_is());
        };
        if !template.contains(JOINT) {
            return Ok(self.as_it_is());
        }
        let pattern = |quantity: Quantity| {
            let entry = self.entries.iter().find(|entry| entry.quantity == quantity);
            entry.map_or("", |entry| entry.header.as_str())
        };
        let (q, tau) = (pattern(Quantity::Position), pattern(Quantity::Torque));
        let mut expanded = Expanded { joints: Vec::new(), entries: Vec::new(), names: Vec::new() };
        let is_wanted =
            |topic: &str| topic.is_empty() || self.topics.is_empty() || self.topics.iter().any(|t| t == topic);
        let with = |pattern: &str, wanted: &str| -> Vec<String> {
            let found = headers.iter().filter_map(|header| capture(pattern, header));
            let of_joint = found.filter(|(topic, joint)| *joint == wanted && is_wanted(topic));
            of_joint.map(|(topic, _)| topic.to_owned()).collect()
        };
        let mut captured: Vec<&str> = Vec::new();
        for (topic, joint) in headers.iter().filter_map(|header| capture(q, header)) {
            if is_wanted(topic) && !captured.contains(&joint) {
                captured.push(joint);
            }
        }
        for joint in captured {
            let (of_q, of_tau) = (with(q, joint), with(tau, joint));
            let both: Vec<&String> = of_q.iter().filter(|topic| of_tau.contains(topic)).collect();
            let topics = match (&both[..], &of_q[..], &of_tau[..]) {
                (_, _, []) => continue,
                ([both], _, _) => (*both, *both),
                ([], [q], [tau]) => (q, tau),
                _ => {
                    let mut all = [of_q, of_tau].concat();
                    all.sort();
                    all.dedup();
                    return Err(self.refuse(
                        1,
                        format!(
                            "joint \"{joint}\" is in the topics {}; choose in a column map (--map): topics = [\"{}\"]",
                            all.join(", "),
                            all[0]
                        ),
                    ));
                }
            };
            self.add(&mut expanded, headers, first, joint, (topics.0.as_str(), topics.1.as_str()))?;
        }
        // Velocities and accelerations are for all joints or for none.
        for quantity in [Quantity::Velocity, Quantity::Acceleration] {
            let count = expanded.entries.iter().filter(|entry| entry.quantity == quantity).count();
            if count < expanded.joints.len() {
                expanded.entries.retain(|entry| entry.quantity != quantity);
            }
        }
        if expanded.joints.is_empty() {
            let is_there = headers.iter().any(|header| capture(q, header).is_some_and(|(topic, _)| is_wanted(topic)));
            let lacking = if is_there { tau } else { q };
            return Err(self.refuse(1, format!("there is no column \"{lacking}\"")));
        }
        Ok(expanded)
    }

    fn as_it_is(&self) -> Expanded {
        Expanded { joints: self.joints.clone(), entries: self.entries.clone(), names: Vec::new() }
    }

    /// Adds one joint with its existing columns; `topics` are those of its positions and of its torques.
    fn add(
        &self,
        expanded: &mut Expanded,
        headers: &[String],
        first: &[String],
        joint: &str,
        (of_q, of_tau): (&str, &str),
    ) -> Result<(), RecordingError> {
        let at = |name: &str| headers.iter().position(|header| header == name);
        let number = expanded.joints.len();
        let name = match &self.names {
            None => filled(&self.joints[0], of_q, joint),
            Some(pattern) => {
                let column = filled(pattern, of_q, joint);
                let index = at(&column);
                let index = index.ok_or_else(|| self.refuse(1, format!("there is no column \"{column}\"")))?;
                let name = first.get(index).cloned().unwrap_or_default();
                expanded.names.push((index, name.clone()));
                name
            }
        };
        for entry in &self.entries {
            let is_torque = matches!(entry.quantity, Quantity::Torque | Quantity::CurrentTorque | Quantity::Current);
            let topics = if is_torque { [of_tau, of_q] } else { [of_q, of_tau] };
            let header = topics.map(|topic| filled(&entry.header, topic, joint));
            if let Some(header) = header.into_iter().find(|header| at(header).is_some()) {
                expanded.entries.push(Entry { header, joint: number, ..entry.clone() });
            }
        }
        expanded.joints.push(name);
        Ok(())
    }
}
