//! The complete column map (TOML) that corrects contradictions between a recording and its URDF.

use std::fmt::Write;

use recording::{Origin, OriginColumn, Quantity, Recording};

/// The value of a key of a column map.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A unit, and its size in the unit in which the recording was read.
    Unit(&'static str, f64),
    /// The column that the named joint has for this key.
    ColumnOf(String),
}

/// A key of a column map that corrects something.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The joint's table, or that of the time.
    joint: Option<String>,
    key: &'static str,
    value: Value,
    remark: Option<&'static str>,
}

impl Change {
    /// Whether it is a change of `joint`.
    pub fn is_of(&self, joint: &str) -> bool {
        self.joint.as_deref() == Some(joint)
    }

    /// Whether it is a change of the time.
    pub fn is_of_time(&self) -> bool {
        self.joint.is_none()
    }

    /// The key.
    pub fn key(&self) -> &'static str {
        self.key
    }

    /// The value.
    pub fn value(&self) -> &Value {
        &self.value
    }

    /// `key = value` in the table of `joint`.
    pub fn new(joint: &str, key: &'static str, value: Value) -> Self {
        Self { joint: Some(joint.to_owned()), key, value, remark: None }
    }

    /// The unit of the time stamps, with its size in seconds.
    pub fn time(unit: &'static str, seconds: f64) -> Self {
        Self { joint: None, key: "unit", value: Value::Unit(unit, seconds), remark: None }
    }

    /// A factor of the torque, estimated from the model, with three digits.
    pub fn scale(joint: &str, factor: f64) -> Self {
        let short = format!("{factor:.2e}").parse().unwrap_or(factor);
        Self::new(joint, "tau_scale", Value::Number(short))
    }

    /// This change with a comment at the end of its line.
    pub fn with_remark(self, remark: &'static str) -> Self {
        Self { remark: Some(remark), ..self }
    }
}

/// The columns of a recording, from which its column map is written.
#[derive(Clone, Debug)]
pub struct Layout {
    origin: Origin,
    joints: Vec<String>,
}

impl Layout {
    /// The columns of `recording`.
    pub fn of(recording: &Recording) -> Self {
        Self {
            origin: recording.origin.clone().unwrap_or_else(|| own_columns(recording)),
            joints: recording.joints.clone(),
        }
    }

    /// The whole map with `changes`; `None` if there are none.
    pub fn map(&self, changes: &[Change]) -> Option<String> {
        if changes.is_empty() {
            return None;
        }
        let Self { origin, joints } = self;
        let mut text = format!("[time]\ncolumn = {}\n", quoted(&origin.time));
        let of_time = changes.iter().find(|change| change.joint.is_none());
        let unit = match of_time.map(|change| &change.value) {
            Some(Value::Unit(unit, _)) => Some(*unit),
            _ => time_unit(origin.time_factor),
        };
        let keys = [("unit", unit), ("nanosec", origin.nanosec.as_deref()), ("run", origin.run.as_deref())];
        for (key, value) in keys {
            if let Some(value) = value {
                let _ = writeln!(text, "{key} = {}", quoted(value));
            }
        }
        if let Some(one) = for_all(joints, origin, changes) {
            return Some(text + &one);
        }
        for (index, joint) in joints.iter().enumerate() {
            let here: Vec<&Change> = changes.iter().filter(|change| change.joint.as_ref() == Some(joint)).collect();
            let _ = writeln!(text, "[joints.{}]", key_of(joint));
            text += &keys_of_joint(origin, joints, index, &here);
        }
        Some(text)
    }
}

/// One table for all joints, if all have the same changes and column names that differ only in the joint's name.
fn for_all(names: &[String], origin: &Origin, changes: &[Change]) -> Option<String> {
    const JOINT: &str = "{joint}";
    let tables = names.iter().enumerate().map(|(index, joint)| {
        let here: Vec<&Change> = changes.iter().filter(|change| change.joint.as_ref() == Some(joint)).collect();
        let is_named = |column: &OriginColumn| column.header.matches(joint.as_str()).count() == 1;
        let own = origin.columns.iter().filter(|column| column.joint == index);
        let is_alone = names.iter().filter(|other| other.contains(joint.as_str())).count() == 1;
        let is_whole = here.iter().any(|change| matches!(change.value, Value::ColumnOf(_)));
        if !is_alone || is_whole || !own.clone().all(is_named) {
            return None;
        }
        Some(keys_of_joint(origin, names, index, &here).replace(joint.as_str(), JOINT))
    });
    let tables: Vec<String> = tables.collect::<Option<_>>()?;
    let first = tables.first().filter(|first| tables.len() > 2 && tables.iter().all(|table| table == *first))?;
    Some(format!("[joints.\"{JOINT}\"]\n{first}"))
}

/// The lines of a joint's table.
fn keys_of_joint(origin: &Origin, joints: &[String], joint: usize, changes: &[&Change]) -> String {
    let mut text = String::new();
    let change = |key: &str| changes.iter().find(|change| change.key == key);
    let mut columns: Vec<(&str, &OriginColumn)> = Vec::new();
    for own in origin.columns.iter().filter(|column| column.joint == joint) {
        let key = own.quantity.prefix().trim_end_matches('_');
        let of = |name: &String| {
            let other = joints.iter().position(|other| other == name)?;
            let mut all = origin.columns.iter();
            all.find(|column| column.joint == other && column.quantity == own.quantity)
        };
        let column = match change(key).map(|change| &change.value) {
            Some(Value::ColumnOf(name)) => of(name).unwrap_or(own),
            _ => own,
        };
        columns.push((key, column));
    }
    // If the columns were read without factors, the changes are written as keys of their own. Otherwise a factor holds the
    // product of the change and the factor of the reading.
    let is_plain = columns.iter().all(|(_, column)| column.factor == 1.0 && column.offset == 0.0);
    for (key, column) in &columns {
        // A factor does not reveal the unit of a current or a temperature.
        let is_written = matches!(column.quantity, Quantity::Current | Quantity::Temperature);
        if is_written && (column.factor != 1.0 || column.offset != 0.0) {
            continue;
        }
        let _ = writeln!(text, "{key} = {}", quoted(&column.header));
        if is_plain || is_written {
            continue;
        }
        let (factor, offset) = folded(column, changes);
        if factor != 1.0 {
            let _ = writeln!(text, "{key}_scale = {factor}");
        }
        if offset != 0.0 && column.quantity == Quantity::Position {
            let _ = writeln!(text, "q_offset = {offset}");
        }
    }
    for change in changes.iter().filter(|_| is_plain) {
        let value = match &change.value {
            Value::Number(number) => number.to_string(),
            Value::Unit(unit, _) => quoted(unit),
            Value::ColumnOf(_) => continue,
        };
        // The recording has no velocities whose unit could be set.
        if change.key == "qd_unit" && columns.iter().all(|(key, _)| *key != "qd") {
            continue;
        }
        let remark = change.remark.map_or(String::new(), |remark| format!(" # {remark}"));
        let _ = writeln!(text, "{} = {value}{remark}", change.key);
    }
    text
}

/// Factor and offset of a column after `changes`.
fn folded(column: &OriginColumn, changes: &[&Change]) -> (f64, f64) {
    let value = |key: &str, missing: f64| {
        let found = changes.iter().find(|change| change.key == key);
        found.map_or(missing, |change| match change.value {
            Value::Number(number) | Value::Unit(_, number) => number,
            Value::ColumnOf(_) => missing,
        })
    };
    let sign = value("sign", 1.0);
    let torque = sign * value("tau_sign", 1.0) * value("tau_scale", 1.0);
    let motion = match column.quantity {
        Quantity::Position | Quantity::Acceleration => sign * value("q_unit", 1.0),
        Quantity::Velocity => sign * value("qd_unit", 1.0),
        Quantity::Torque => return (column.factor * torque, 0.0),
        _ => sign,
    };
    (column.factor * motion, sign * column.offset + value("q_offset", 0.0))
}

/// The columns of a recording that was not read from a file, with the names that a file of it would have.
fn own_columns(recording: &Recording) -> Origin {
    let mut quantities = vec![Quantity::Position, Quantity::Torque];
    if recording.qd.is_some() {
        quantities.push(Quantity::Velocity);
    }
    let columns = recording.joints.iter().enumerate().flat_map(|(joint, name)| {
        quantities.iter().map(move |&quantity| OriginColumn {
            joint,
            quantity,
            header: format!("{}{name}", quantity.prefix()),
            factor: 1.0,
            offset: 0.0,
        })
    });
    Origin { time: "t".to_owned(), time_factor: 1.0, columns: columns.collect(), ..Origin::default() }
}

/// The name of the unit of time that is `seconds` long; `None` for any other length.
fn time_unit(seconds: f64) -> Option<&'static str> {
    let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0)];
    let unit = units.iter().find(|(_, factor)| *factor == seconds);
    unit.map(|(name, _)| *name)
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A key of TOML needs quotation marks if it has other characters than these.
fn key_of(joint: &str) -> String {
    let is_bare = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    if !joint.is_empty() && joint.chars().all(is_bare) { joint.to_owned() } else { quoted(joint) }
}

#[cfg(test)]
mod tests {
    use recording::Column;

    use super::*;

    fn recording(velocities: bool) -> Recording {
        let names = if velocities {
            &["t", "q_a", "q_b/c", "qd_a", "qd_b/c", "tau_a", "tau_b/c"][..]
        } else {
            &["t", "q_a", "q_b/c", "tau_a", "tau_b/c"]
        };
        let columns = names.iter().map(|name| (name.to_string(), Column::Numbers(vec![0.0, 1.0])));
        Recording::of_columns("r", columns.collect(), None).expect("it is whole")
    }

    #[test]
    fn the_map_is_complete() {
        let changes = [
            Change::new("a", "tau", Value::ColumnOf("b/c".into())),
            Change::new("b/c", "q_unit", Value::Unit("deg", 0.0174)),
            Change::new("b/c", "qd_unit", Value::Unit("deg/s", 0.0174)),
            Change::scale("b/c", 0.012_345).with_remark("a guess"),
            Change::time("ms", 1e-3),
        ];
        let whole = Layout::of(&recording(true)).map(&changes).expect("there are changes");
        let expected = "[time]\ncolumn = \"t\"\nunit = \"ms\"\n[joints.a]\nq = \"q_a\"\nqd = \"qd_a\"\ntau = \"tau_b/c\"\n\
                        [joints.\"b/c\"]\nq = \"q_b/c\"\nqd = \"qd_b/c\"\ntau = \"tau_b/c\"\nq_unit = \"deg\"\n\
                        qd_unit = \"deg/s\"\ntau_scale = 0.0123 # a guess\n";
        assert_eq!(whole, expected);
        let without = Layout::of(&recording(false)).map(&changes[1..3]).expect("there are changes");
        assert!(without.contains("q_unit") && !without.contains("qd"), "{without}");
        assert_eq!(Layout::of(&recording(true)).map(&[]), None);
    }

    #[test]
    fn joints_with_the_same_changes_share_one_table() {
        let names = ["t", "q_one", "q_two", "q_six", "tau_one", "tau_two", "tau_six"];
        let columns = names.map(|name| (name.to_owned(), Column::Numbers(vec![0.0, 1.0])));
        let recording = Recording::of_columns("r", columns.into(), None).expect("it is whole");
        let mut changes: Vec<Change> = ["one", "two", "six"]
            .iter()
            .map(|joint| Change::new(joint, "q_unit", Value::Unit("deg", 0.0174)))
            .collect();
        let expected = "[time]\ncolumn = \"t\"\n[joints.\"{joint}\"]\nq = \"q_{joint}\"\ntau = \"tau_{joint}\"\nq_unit = \"deg\"\n";
        assert_eq!(Layout::of(&recording).map(&changes).as_deref(), Some(expected));
        changes.pop();
        let apart = Layout::of(&recording).map(&changes).expect("there are changes");
        assert!(apart.contains("[joints.six]") && !apart.contains('{'), "{apart}");
    }

    #[test]
    fn factors_of_a_map_are_multiplied() {
        let mut recording = recording(false);
        let origin = recording.origin.as_mut().expect("it was read");
        (origin.time, origin.time_factor) = ("stamp".to_owned(), 1e-3);
        for column in &mut origin.columns {
            (column.factor, column.offset) = match column.quantity {
                Quantity::Position => (0.5, 0.25),
                _ => (3.0, 0.0),
            };
        }
        let changes = [
            Change::new("a", "sign", Value::Number(-1.0)),
            Change::new("a", "q_offset", Value::Number(1.0)),
            Change::new("a", "tau_scale", Value::Number(2.0)),
        ];
        let expected = "[time]\ncolumn = \"stamp\"\nunit = \"ms\"\n[joints.a]\nq = \"q_a\"\nq_scale = -0.5\nq_offset = 0.75\n\
                        tau = \"tau_a\"\ntau_scale = -6\n[joints.\"b/c\"]\nq = \"q_b/c\"\nq_scale = 0.5\nq_offset = 0.25\n\
                        tau = \"tau_b/c\"\ntau_scale = 3\n";
        assert_eq!(Layout::of(&recording).map(&changes).as_deref(), Some(expected));
    }
}
