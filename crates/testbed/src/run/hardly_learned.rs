//! Sentences on joints whose torque error a learned torque hardly reduces.

use report::numbers::rounded;

use super::torque_errors::TorqueErrors;
use crate::cli::LengthScalesArg;
use crate::scenario::Scenario;

/// A learned torque hardly reduces the RMS torque error if more than this part of the rigid body's error remains.
const HARDLY_LEARNED: f64 = 0.5;
/// From this ratio on, the error is larger than the rigid body's. A smaller one is rounded to at most 100 %.
const LARGER: f64 = 1.005;
/// An RMS torque error of at most this part of the joint's RMS torque counts as none.
const NO_ERROR: f64 = 1e-6;

/// What the learned torque does to the RMS torque error of a joint.
#[derive(Debug, PartialEq)]
enum Change {
    /// The rigid body has no error, and the feed-forward has one.
    Added,
    /// The error with the learned torque over that of the rigid body.
    Remaining(f64),
}

/// Sentences on the joints on which the error of the torque that is fed forward is hardly below that of the rigid body alone, or above
/// it.
pub(super) fn remarks(scenario: &Scenario, errors: &TorqueErrors, length_scales: Option<LengthScalesArg>) -> String {
    let joints = scenario.arm.joints().iter().enumerate();
    let changes: Vec<(&str, Change)> = joints
        .filter_map(|(k, joint)| {
            Some((joint.name.as_str(), change(errors.fed_forward[k], errors.rigid[k], errors.torque[k])?))
        })
        .collect();
    sentences(&changes, length_scales)
}

/// What the learned torque does to the error of a joint, from the mean squares of the error, of the rigid body's error and of the torque
/// itself ((N m)² or N²); `None` if neither has an error.
fn change(error: f64, rigid: f64, torque: f64) -> Option<Change> {
    let none = NO_ERROR * NO_ERROR * torque;
    match (error > none, rigid > none) {
        (_, true) => Some(Change::Remaining((error / rigid).sqrt())),
        (true, false) => Some(Change::Added),
        (false, false) => None,
    }
}

/// The sentences of [`remarks`] on joints, each with its change.
fn sentences(changes: &[(&str, Change)], length_scales: Option<LengthScalesArg>) -> String {
    let added: Vec<&str> =
        changes.iter().filter(|(_, change)| *change == Change::Added).map(|(name, _)| *name).collect();
    let remaining: Vec<(&str, f64)> = changes
        .iter()
        .filter_map(|(name, change)| match change {
            Change::Remaining(remaining) => Some((*name, *remaining)),
            Change::Added => None,
        })
        .collect();
    let (hardly, larger): (Vec<_>, Vec<_>) = remaining
        .iter()
        .filter(|(_, remaining)| *remaining > HARDLY_LEARNED)
        .partition(|(_, remaining)| *remaining < LARGER);
    if added.is_empty() && hardly.is_empty() && larger.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    if !hardly.is_empty() {
        let joints: Vec<String> = hardly
            .iter()
            .map(|(name, remaining)| format!("{name} ({:.0} % of it remains)", 100.0 * remaining))
            .collect();
        let joints = report::words::list(&joints);
        text += &format!("The learned torque hardly reduces the rigid body's RMS torque error on {joints}. ");
    }
    if !larger.is_empty() {
        let joints: Vec<String> = larger
            .iter()
            .map(|(name, remaining)| format!("{name} ({} times as large)", rounded(*remaining, 2)))
            .collect();
        let joints = report::words::list(&joints);
        text += &format!("With the learned torque, the RMS torque error is larger than the rigid body's on {joints}. ");
    }
    if !added.is_empty() {
        let joints = report::words::list(&added);
        text += &format!("The rigid body has no torque error on {joints}; the learned torque adds one. ");
    }
    let advice = match length_scales {
        Some(LengthScalesArg::One) => {
            "; one length scale for all inputs can hide small torques: compare with --length-scales per-input"
        }
        Some(LengthScalesArg::PerInput) | None => "",
    };
    format!("{text}Compare the tracking there with --model rigid-body{advice}.\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An error that has grown is stated as a ratio, and not as a part that remains.
    #[test]
    fn an_error_that_grows_is_stated_as_a_ratio() {
        let remaining = [("a", 0.3), ("b", 0.62), ("c", 1.002), ("d", 3.21), ("e", 198_737.37)]
            .map(|(name, remaining)| (name, Change::Remaining(remaining)));
        let text = sentences(&remaining, Some(LengthScalesArg::PerInput));
        assert_eq!(
            text,
            "The learned torque hardly reduces the rigid body's RMS torque error on b (62 % of it remains) and c (100 % of it \
             remains). With the learned torque, the RMS torque error is larger than the rigid body's on d (3.2 times as large) and \
             e (2.0e5 times as large). Compare the tracking there with --model rigid-body.\n"
        );
        let grown = sentences(&remaining[3..4], Some(LengthScalesArg::One));
        assert!(
            grown.starts_with("With the learned torque, ") && grown.contains("--length-scales per-input"),
            "{grown}"
        );
        assert_eq!(sentences(&remaining[..1], Some(LengthScalesArg::One)), "");
    }
    /// Where the rigid body is exact, a learned torque can only add an error. Rounding is none, on either side.
    #[test]
    fn an_error_that_is_added_to_an_exact_rigid_body_is_stated() {
        assert_eq!(change(9.8, 0.0, 100.0), Some(Change::Added));
        assert_eq!(change(9.8, 1e-13, 100.0), Some(Change::Added));
        assert_eq!(change(1e-13, 0.0, 100.0), None);
        assert_eq!(change(1.0, 4.0, 100.0), Some(Change::Remaining(0.5)));
        let changes = [("a", Change::Added), ("b", Change::Added), ("c", Change::Remaining(0.1))];
        let text = sentences(&changes, None);
        assert_eq!(
            text,
            "The rigid body has no torque error on a and b; the learned torque adds one. Compare the tracking there with --model \
             rigid-body.\n"
        );
    }
}
