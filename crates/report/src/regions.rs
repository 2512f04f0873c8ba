//! Regions of state and stretches of time in which a residual is largest, in words.

use arm::Joint;
use diagnosis::{Axis, Region, TimeWindow};
use effects::Quantity;

use crate::numbers;

/// Intervals of time, six at most.
pub fn windows(windows: &[TimeWindow]) -> String {
    let shown = windows
        .iter()
        .take(6)
        .map(|window| format!("{:.1} to {:.1} s of {}", window.start, window.end, window.recording));
    let mut text = shown.collect::<Vec<_>>().join(", ");
    if windows.len() > 6 {
        text += &format!(" and {} more intervals", windows.len() - 6);
    }
    text
}

/// A region of the state of `joint`, with its unit.
pub fn region(region: &Region, joint: &Joint) -> String {
    let quantity = match region.axis {
        Axis::Angle => Quantity::Position,
        Axis::NearReversal | Axis::Speed => Quantity::Speed,
        Axis::Load => Quantity::Torque,
        Axis::ElapsedTime => Quantity::Time,
    };
    let unit = quantity.unit(joint.kind);
    let [from, to] = region.range.map(numbers::trimmed);
    let quantity = match region.axis {
        Axis::NearReversal => return format!("speed below {to} {unit}"),
        Axis::Speed => "speed",
        Axis::Load => "load",
        Axis::Angle => "angle",
        Axis::ElapsedTime => "elapsed time",
    };
    format!("{quantity} from {from} to {to} {unit}")
}
