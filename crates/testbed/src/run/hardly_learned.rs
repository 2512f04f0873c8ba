//! Sentences on joints whose torque error a learned torque hardly reduces.

use report::numbers::rounded;
use torque::RigidBody;

use super::torque_error;
use crate::cli::LengthScalesArg;
use crate::scenario::Scenario;

/// A learned torque hardly reduces the RMS torque error if more than this part of the rigid body's error remains.
const HARDLY_LEARNED: f64 = 0.5;
/// From this ratio on, the error is larger than the rigid body's. A smaller one is rounded to at most 100 %.
const LARGER: f64 = 1.005;

/// Sentences on the joints whose torque error, with the model's `errors` ((N m)²), is hardly below that of the rigid body alone,
/// or above it.
///
/// # Errors
/// If the reference cannot be sampled.
pub(super) fn remarks(
    scenario: &Scenario,
    errors: &[f64],
    length_scales: Option<LengthScalesArg>,
) -> anyhow::Result<String> {
    let rigid = torque_error(scenario, &RigidBody::new(scenario.nominal_arm()))?;
    let joints = scenario.arm.joints().iter().map(|joint| joint.name.as_str());
    let errors = joints.zip(errors.iter().zip(&rigid));
    let errors = errors.filter(|(_, (_, rigid))| **rigid > 0.0);
    let remaining: Vec<(&str, f64)> = errors.map(|(name, (error, rigid))| (name, (error / rigid).sqrt())).collect();
    Ok(sentences(&remaining, length_scales))
}

/// The sentences of [`remarks`] on joints, each with its RMS torque error over that of the rigid body.
fn sentences(remaining: &[(&str, f64)], length_scales: Option<LengthScalesArg>) -> String {
    let (hardly, larger): (Vec<_>, Vec<_>) = remaining
        .iter()
        .filter(|(_, remaining)| *remaining > HARDLY_LEARNED)
        .partition(|(_, remaining)| *remaining < LARGER);
    if hardly.is_empty() && larger.is_empty() {
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
        let remaining = [("a", 0.3), ("b", 0.62), ("c", 1.002), ("d", 3.21), ("e", 198_737.37)];
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
}
