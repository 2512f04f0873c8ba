//! Regions of state and stretches of time in which a residual is largest, in words.

use arm::{Joint, JointKind};
use diagnosis::{Axis, Region, TimeWindow};

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
    let is_sliding = joint.kind == JointKind::Prismatic;
    let unit = |turning, sliding| if is_sliding { sliding } else { turning };
    let unit = match region.axis {
        Axis::Angle => unit("rad", "m"),
        Axis::NearReversal | Axis::Speed => unit("rad/s", "m/s"),
        Axis::Load => unit("N m", "N"),
        Axis::ElapsedTime => "s",
    };
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
