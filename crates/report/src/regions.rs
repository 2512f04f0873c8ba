//! Regions of state and stretches of time in which a residual is largest, in words.

use arm::{Joint, JointKind};
use diagnosis::{Region, TimeWindow};

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
        "angle" => unit("rad", "m"),
        "near_reversal" | "speed" => unit("rad/s", "m/s"),
        "load" => unit("N m", "N"),
        "elapsed_time" => "s",
        _ => "",
    };
    let [from, to] = region.range.map(numbers::trimmed);
    match region.axis {
        "near_reversal" => format!("speed below {to} {unit}"),
        axis => format!("{} from {from} to {to} {unit}", axis.replace('_', " ")),
    }
}
