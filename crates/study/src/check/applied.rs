//! A column map is tried before it is proposed: its changes are applied to the recording in memory.

use recording::Recording;

use super::column_map::{Change, Value};

/// `recording` as it would be read with `changes` of units.
pub fn applied(recording: &Recording, changes: &[Change]) -> Recording {
    let mut new = recording.clone();
    for change in changes.iter().filter(|change| change.is_of_time()) {
        let seconds = number(change.value());
        new.time.iter_mut().for_each(|time| *time *= seconds);
    }
    for (joint, name) in recording.joints.iter().enumerate() {
        let factor = |key: &str| {
            let found = changes.iter().find(|change| change.is_of(name) && change.key() == key);
            found.map_or(1.0, |change| number(change.value()))
        };
        let multiply = |values: &mut Vec<f64>, factor: f64| values.iter_mut().for_each(|value| *value *= factor);
        multiply(&mut new.q[joint], factor("q_unit"));
        if let Some(qd) = &mut new.qd {
            multiply(&mut qd[joint], factor("qd_unit"));
        }
        if let Some(qdd) = &mut new.qdd {
            multiply(&mut qdd[joint], factor("q_unit"));
        }
        multiply(&mut new.tau[joint], factor("tau_scale"));
    }
    new
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Number(number) | Value::Unit(_, number) => *number,
        Value::ColumnOf(_) => 1.0,
    }
}
