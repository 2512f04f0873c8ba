//! A message `sensor_msgs/msg/JointState` of ROS 2, in CDR.

use crate::bytes::Bytes;

/// The names of its fields with values of each joint.
pub const FIELDS: [&str; 3] = ["position", "velocity", "effort"];
const NANOS: i64 = 1_000_000_000;

/// One message.
#[derive(Debug, PartialEq)]
pub struct JointState<'a> {
    /// The stamp in its header (ns); 0 if it is not set.
    pub stamp: i64,
    /// The names of its joints.
    pub names: Vec<&'a str>,
    /// Positions, velocities and efforts; each has as many values as there are names, or none.
    pub fields: [Vec<f64>; 3],
}

/// Parses a message in CDR (version 1, little or big endian).
pub fn decode(data: &[u8]) -> Result<JointState<'_>, String> {
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
            return Err(format!("it has {names} names and {count} values of {field}; publish one of each joint"));
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
    Some(JointState { stamp: i64::from(seconds) * NANOS + i64::from(nanos), names, fields })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A message in CDR of either byte order, with a stamp of 3.5 s.
    fn message(big_endian: bool) -> Vec<u8> {
        let mut data = vec![0, u8::from(!big_endian), 0, 0];
        let word = |value: u32| {
            if big_endian { value.to_be_bytes() } else { value.to_le_bytes() }
        };
        let number = |value: f64| {
            if big_endian { value.to_be_bytes() } else { value.to_le_bytes() }
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
