//! What a learned torque leaves of the rigid body's torque error, in sentences.

use report::numbers::rounded;
use torque::RigidBody;

use super::torque_error;
use crate::cli::LengthScalesArg;
use crate::scenario::Scenario;

/// The part of the rigid body's RMS torque error from which what is left of it is too much for a learned torque to be worth it.
const HARDLY_LEARNED: f64 = 0.5;
/// The part from which the error is larger than the rigid body's: what is below it is 100 % at most when rounded.
const LARGER: f64 = 1.005;

/// Sentences on the joints whose torque error, with the model's `errors` ((N m)²), is hardly below that of the rigid body alone,
/// or above it.
///
/// # Errors
/// If the reference cannot be sampled.
pub(super) fn hardly_learned(
    scenario: &Scenario,
    errors: &[f64],
    length_scales: Option<LengthScalesArg>,
) -> anyhow::Result<String> {
    let rigid = torque_error(scenario, &RigidBody::new(scenario.nominal_arm()))?;
    let joints = scenario.arm.joints().iter().map(|joint| joint.name.as_str());
    let left = joints.zip(errors.iter().zip(&rigid));
    let left = left.filter(|(_, (_, rigid))| **rigid > 0.0);
    let left: Vec<(&str, f64)> = left
        .map(|(name, (error, rigid))| (name, (error / rigid).sqrt()))
        .collect();
    Ok(left_of_the_error(&left, length_scales))
}

/// The sentences of [`hardly_learned`] on joints with what is `left` of the error, as a part of that of the rigid body.
fn left_of_the_error(left: &[(&str, f64)], length_scales: Option<LengthScalesArg>) -> String {
    let (hardly, larger): (Vec<_>, Vec<_>) = left
        .iter()
        .filter(|(_, left)| *left > HARDLY_LEARNED)
        .partition(|(_, left)| *left < LARGER);
    if hardly.is_empty() && larger.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    if !hardly.is_empty() {
        let joints: Vec<String> = hardly
            .iter()
            .map(|(name, left)| format!("{name} ({:.0} % of it remains)", 100.0 * left))
            .collect();
        let joints = report::words::list(&joints);
        text += &format!("The learned torque hardly reduces the rigid body's RMS torque error on {joints}. ");
    }
    if !larger.is_empty() {
        let joints: Vec<String> = larger
            .iter()
            .map(|(name, left)| format!("{name} ({} times as large)", rounded(*left, 2)))
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

    /// What is more than all of the error is told as a ratio, and not as a part that remains.
    #[test]
    fn an_error_that_grows_is_no_part_that_remains() {
        let left = [("a", 0.3), ("b", 0.62), ("c", 1.002), ("d", 3.21), ("e", 198_737.37)];
        let text = left_of_the_error(&left, Some(LengthScalesArg::PerInput));
        assert_eq!(
            text,
            "The learned torque hardly reduces the rigid body's RMS torque error on b (62 % of it remains) and c (100 % of it \
             remains). With the learned torque, the RMS torque error is larger than the rigid body's on d (3.2 times as large) and \
             e (2.0e5 times as large). Compare the tracking there with --model rigid-body.\n"
        );
        let grown = left_of_the_error(&left[3..4], Some(LengthScalesArg::One));
        assert!(
            grown.starts_with("With the learned torque, ") && grown.contains("--length-scales per-input"),
            "{grown}"
        );
        assert_eq!(left_of_the_error(&left[..1], Some(LengthScalesArg::One)), "");
    }
}
