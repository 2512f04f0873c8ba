//! A column map is tried before it is proposed: its changes are applied to the recording in memory.

use recording::{Quantity, Recording};

use super::column_map::{Change, Value};

/// `recording` as it would be read with `changes`.
pub fn applied(recording: &Recording, changes: &[Change]) -> Recording {
    let mut new = recording.clone();
    for change in changes.iter().filter(|change| change.is_of_time()) {
        let seconds = number(change.value());
        new.time.iter_mut().for_each(|time| *time *= seconds);
    }
    for (joint, name) in recording.joints.iter().enumerate() {
        let own: Vec<&Change> = changes.iter().filter(|change| change.is_of(name)).collect();
        let factor = |key: &str| {
            let found = own.iter().find(|change| change.key() == key);
            found.map_or(1.0, |change| number(change.value()))
        };
        let source = |quantity: Quantity| {
            let key = quantity.prefix().trim_end_matches('_');
            let found = own
                .iter()
                .find(|change| change.key() == key)
                .map(|change| change.value());
            match found {
                Some(Value::ColumnOf(other)) => recording.joints.iter().position(|name| name == other).unwrap_or(joint),
                _ => joint,
            }
        };
        let sign = factor("sign");
        let offset = own.iter().find(|change| change.key() == "q_offset");
        let offset = offset.map_or(0.0, |change| number(change.value()));
        let place = |values: &mut Vec<f64>, from: &[f64], factor: f64, offset: f64| {
            *values = from.iter().map(|value| factor * value + offset).collect();
        };
        let motion = sign * factor("q_unit");
        place(
            &mut new.q[joint],
            &recording.q[source(Quantity::Position)],
            motion,
            offset,
        );
        if let (Some(new), Some(old)) = (&mut new.qd, &recording.qd) {
            place(
                &mut new[joint],
                &old[source(Quantity::Velocity)],
                sign * factor("qd_unit"),
                0.0,
            );
        }
        if let (Some(new), Some(old)) = (&mut new.qdd, &recording.qdd) {
            place(&mut new[joint], &old[source(Quantity::Acceleration)], motion, 0.0);
        }
        let torque = sign * factor("tau_sign") * factor("tau_scale");
        place(
            &mut new.tau[joint],
            &recording.tau[source(Quantity::Torque)],
            torque,
            0.0,
        );
    }
    new
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Number(number) | Value::Unit(_, number) => *number,
        Value::ColumnOf(_) => 1.0,
    }
}
