//! The regions of state and time in which a joint's residual is largest, in words.

use arm::Joint;
use diagnosis::Located;
use maud::{Markup, html};

use crate::numbers;

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
                (crate::regions::region(region, joint)) " (" (numbers::before_after(Some(region.residual), Some(region.residual_augmented)))
                " times the torque's standard deviation)"
            }
            @if !located.time.is_empty() {
                @if !located.regions.is_empty() { "; " }
                (crate::regions::windows(&located.time))
            }
            "."
        }
    }
}
