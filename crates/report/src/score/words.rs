//! Counts, shares and names of a score as text.

use scoring::{Counted, Figure, Name, Target};

use crate::numbers::percent_to_a_tenth as percent;

/// `k of n (p %, low to high %)`.
pub fn counted(counted: &Counted) -> String {
    let [low, high] = counted.wilson.map(|bound| 100.0 * bound);
    match counted.share() {
        Some(share) => format!("{} of {} ({}; {low:.0} to {high:.0} %)", counted.hits, counted.of, percent(share)),
        None => "none to count".to_owned(),
    }
}

/// The number with two decimals, or a dash.
pub fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

/// A share in per cent, or a dash.
pub fn share(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), percent)
}

/// An effect and its joint in words.
pub fn name((effect, joint): &Name) -> String {
    match joint {
        Some(joint) => format!("`{effect}` on {joint}"),
        None => format!("`{effect}`"),
    }
}

/// A target's figure in words.
pub fn figure(target: &Target) -> String {
    match (target.figure, &target.counted) {
        (None, _) => "–".to_owned(),
        (Some(share), Some(_)) => percent(share),
        (Some(figure), None) if target.id == Figure::ParameterErrors => percent(figure),
        (Some(figure), None) => format!("{figure:.3}"),
    }
}

/// The required values of a target.
pub fn wanted(target: &Target) -> String {
    let is_share = target.counted.is_some() || target.id == Figure::ParameterErrors;
    let show = |value: f64| if is_share { percent(value) } else { format!("{value}") };
    match (target.at_least, target.at_most) {
        (Some(low), Some(high)) => format!("{} to {}", show(low), show(high)),
        (Some(low), None) => format!("≥ {}", show(low)),
        (None, Some(high)) => format!("≤ {}", show(high)),
        (None, None) => String::new(),
    }
}
