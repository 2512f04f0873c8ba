//! The regions of state and time in which a joint's residual is largest, in words.

use arm::{Joint, JointKind};
use diagnosis::{Located, Region, TimeWindow};
use maud::{Markup, html};

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

/// Where the nominal residual is largest.
pub fn regions(located: &Located, joint: &Joint) -> Markup {
    if located.regions.is_empty() && located.time.is_empty() {
        return html! {};
    }
    html! {
        p.small {
            b { "Largest nominal residual: " }
            @for (number, region) in located.regions.iter().enumerate() {
                @if number > 0 { "; " }
                (words_of(region, joint)) " (" (numbers::before_after(Some(region.residual), Some(region.residual_augmented)))
                " times the torque's standard deviation)"
            }
            @if !located.time.is_empty() {
                @if !located.regions.is_empty() { "; " }
                (windows(&located.time))
            }
            "."
        }
    }
}

fn words_of(region: &Region, joint: &Joint) -> String {
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
