//! A sentence on joints that do not follow their reference.

use arm::JointKind;
use report::numbers::rounded;
use torque::Feedback;

use crate::models::ModelKind;
use crate::scenario::Scenario;
use crate::simulation::Outcome;

/// The RMS error (rad or m) from which a joint that is to stand still does not follow.
const AT_REST: f64 = 0.1;

/// A reference that deviates less from its mean (RMS, rad or m) stands still.
const STANDS_STILL: f64 = 1e-3;

/// A sentence on the joints whose RMS tracking error exceeds the motion that they were to make; empty if there is none.
pub fn remark(scenario: &Scenario, kind: ModelKind, outcome: &Outcome) -> String {
    let joints = scenario.arm.joints().iter().enumerate();
    let joints: Vec<String> = joints
        .filter(|(joint, _)| exceeds(outcome.rms_error[*joint], outcome.reference_rms[*joint]))
        .map(|(index, joint)| {
            let unit = if joint.kind == JointKind::Revolute { "rad" } else { "m" };
            format!(
                "{} ({} {unit} against {} {unit}, {:.1} % saturated)",
                joint.name,
                rounded(outcome.rms_error[index], 3),
                rounded(outcome.reference_rms[index], 3),
                100.0 * outcome.saturated[index]
            )
        })
        .collect();
    if joints.is_empty() {
        return String::new();
    }
    let [kp, kd] = match scenario.feedback {
        Feedback::MassMatrix { .. } => ["1/s²", "1/s"],
        Feedback::Gains { .. } => ["N m/rad, or N/m", "N m s/rad, or N s/m"],
    };
    let model = match kind {
        ModelKind::True => "",
        _ => "; --model true shows what the exact torque model gives",
    };
    format!(
        "The loop does not follow its reference: the RMS error is larger than the RMS of the motion itself on {}. Check controller.kp \
         ({kp}), controller.kd ({kd}), controller.rate and the effort limits of the URDF{model}.\n",
        report::words::list(&joints)
    )
}

/// Whether an RMS error is larger than the RMS deviation of the reference from its mean, `motion`.
fn exceeds(error: f64, motion: f64) -> bool {
    error > if motion < STANDS_STILL { AT_REST } else { motion }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_compared_with_the_motion_and_at_rest_with_a_limit() {
        assert!(exceeds(0.6, 0.5) && !exceeds(0.4, 0.5));
        assert!(exceeds(0.2, 0.0) && !exceeds(0.05, 0.0));
        assert!(!exceeds(3e-6, 2e-6));
        assert!(exceeds(f64::INFINITY, 0.5));
    }
}
