//! Corrections in words, and as keys of a column map.

use std::ops::Range;

use super::column_map::{Change, Value};
use super::correction::Correction;

impl Correction {
    /// What is wrong, in a few words; `None` for a correction that is never mentioned beside another one.
    pub fn words(self, names: &[&str]) -> Option<String> {
        Some(match self {
            Self::AsItIs | Self::Unit(_) | Self::UnitOf(..) | Self::Gravity(_) => return None,
            Self::Flipped(joint) => format!("the position of {} has the other sign", names[joint]),
            Self::TorqueFlipped(joint) => format!("the torque of {} has the other sign", names[joint]),
            Self::BothFlipped(joint) => format!("the position and torque of {} have the other sign", names[joint]),
            Self::Swapped(a, b) => format!("the columns of {} and {} are swapped", names[a], names[b]),
            Self::TorquesSwapped(a, b) => format!("the torques of {} and {} are swapped", names[a], names[b]),
            Self::PositionsSwapped(a, b) => format!("the positions of {} and {} are swapped", names[a], names[b]),
            Self::Zero(joint, added) => format!("the zero of {} is off by {}", names[joint], turn(added)),
            Self::AllTorquesFlipped => "all torques have the other sign".to_owned(),
            Self::AllPositionsFlipped => "all positions have the other sign".to_owned(),
            Self::AllFlipped => "all positions and torques have the other sign".to_owned(),
            Self::Reversed => "all columns are in the opposite order".to_owned(),
            Self::TorquesReversed => "all torques are in the opposite order".to_owned(),
        })
    }

    /// The correction of the sign of the torque in the place of that of the position.
    pub fn as_sign_of_the_torque(self) -> Option<Self> {
        match self {
            Self::AllPositionsFlipped => Some(Self::AllTorquesFlipped),
            Self::Flipped(joint) => Some(Self::TorqueFlipped(joint)),
            _ => None,
        }
    }

    /// The keys of a column map that correct it.
    pub fn changes(self, names: &[&str]) -> Vec<Change> {
        let number = |joint: usize, key, value| Change::new(names[joint], key, Value::Number(value));
        let inverted = |joints: Range<usize>, keys: &[&'static str]| {
            joints.flat_map(|joint| keys.iter().map(move |key| number(joint, key, -1.0))).collect()
        };
        let exchanged = |pairs: &[(usize, usize)], keys: &[&'static str]| {
            let of = |&(at, other): &(usize, usize)| {
                let column = Value::ColumnOf(names[other].to_owned());
                keys.iter().map(move |key| Change::new(names[at], key, column.clone()))
            };
            pairs.iter().flat_map(of).collect()
        };
        let all = || 0..names.len();
        let opposite: Vec<(usize, usize)> = all().map(|joint| (joint, names.len() - 1 - joint)).collect();
        match self {
            Self::AsItIs | Self::Unit(_) | Self::UnitOf(..) | Self::Gravity(_) => Vec::new(),
            Self::Flipped(joint) => inverted(joint..joint + 1, &["sign", "tau_sign"]),
            Self::TorqueFlipped(joint) => inverted(joint..joint + 1, &["tau_sign"]),
            Self::BothFlipped(joint) => inverted(joint..joint + 1, &["sign"]),
            Self::AllPositionsFlipped => inverted(all(), &["sign", "tau_sign"]),
            Self::AllTorquesFlipped => inverted(all(), &["tau_sign"]),
            Self::AllFlipped => inverted(all(), &["sign"]),
            Self::Zero(joint, added) => vec![number(joint, "q_offset", added)],
            Self::Swapped(a, b) => exchanged(&[(a, b), (b, a)], &["q", "qd", "tau"]),
            Self::TorquesSwapped(a, b) => exchanged(&[(a, b), (b, a)], &["tau"]),
            Self::PositionsSwapped(a, b) => exchanged(&[(a, b), (b, a)], &["q", "qd"]),
            Self::Reversed => exchanged(&opposite, &["q", "qd", "tau"]),
            Self::TorquesReversed => exchanged(&opposite, &["tau"]),
        }
    }

    /// What is wrong, with the remedy. What is not certain may be wrong.
    pub fn sentence(self, names: &[&str], is_certain: bool) -> String {
        let pick = |certain: &'static str, possible: &'static str| if is_certain { certain } else { possible };
        let has = pick("has", "may have");
        let have = pick("have", "may have");
        let swapped = |what: &str, a: usize, b: usize| {
            format!(
                "the {what} of {} and {} {} swapped; correct the header, or map the columns (--map)",
                names[a],
                names[b],
                pick("seem", "may be")
            )
        };
        let in_order = |what: &str| {
            format!(
                "the {what} {} in the opposite order, tip to base; correct the header, or map the columns (--map)",
                pick("seem to be", "may be")
            )
        };
        match self {
            Self::AsItIs | Self::Unit(_) | Self::UnitOf(..) | Self::Gravity(_) => String::new(),
            Self::AllTorquesFlipped => format!(
                "the torques of all joints {have} the sign opposite to the URDF's axes; invert them (tau_sign = -1 for each joint in \
                 a column map)"
            ),
            Self::AllPositionsFlipped => format!(
                "the positions of all joints {have} the sign opposite to the URDF's axes; invert them (sign = -1 and tau_sign = -1 \
                 for each joint in a column map)"
            ),
            Self::AllFlipped => format!(
                "positions and torques of all joints {have} the sign opposite to the URDF's axes; invert both (sign = -1 for each \
                 joint in a column map)"
            ),
            Self::Flipped(_) => format!(
                "the position {has} the sign opposite to the URDF's axis; invert it (sign = -1 and tau_sign = -1 in a column map)"
            ),
            Self::TorqueFlipped(_) => {
                format!(
                    "the torque {has} the sign opposite to the URDF's axis; invert it (tau_sign = -1 in a column map)"
                )
            }
            Self::BothFlipped(_) => format!(
                "position and torque {have} the sign opposite to the URDF's axis; invert both (sign = -1 in a column map)"
            ),
            Self::Zero(_, added) => {
                let turn = turn(added);
                format!(
                    "the position's zero {} off by {turn} from the URDF's; correct it (q_offset = {added:.4} in a column map)",
                    pick("is", "may be")
                )
            }
            Self::Swapped(a, b) => swapped("columns", a, b),
            Self::TorquesSwapped(a, b) => swapped("torques", a, b),
            Self::PositionsSwapped(a, b) => swapped("positions", a, b),
            Self::Reversed => in_order("columns of the joints"),
            Self::TorquesReversed => in_order("torques of the joints"),
        }
    }
}

/// By how much a zero is off to which `added` must be added.
fn turn(added: f64) -> &'static str {
    match added {
        added if added.abs() > 3.0 => "π",
        added if added > 0.0 => "-π/2",
        _ => "π/2",
    }
}
