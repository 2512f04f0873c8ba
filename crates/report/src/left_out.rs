//! What the files of the corrected model do not have.

use diagnosis::{JointFit, Report};

use crate::{numbers, words};

/// The error of the exported model is stated only if it is at least this multiple of the table's.
const LARGER_WITHOUT: f64 = 1.5;
/// The least difference of the two errors at which that of the exported model is stated (over the torque's standard deviation).
const LARGER_BY: f64 = 0.02;

/// What they do not have, in sentences: effects between two sensors of a joint, and the background's
/// corrections where the error is clearly larger without them.
pub fn notes(report: &Report) -> Vec<String> {
    let mut notes = Vec::new();
    let between = report.findings.iter().filter(|finding| finding.sensor.is_some() && finding.acts_today());
    let between: Vec<String> = between
        .map(|finding| format!("{} of {}", words::effect(finding), words::joint(finding.joint.as_deref())))
        .collect();
    if !between.is_empty() {
        notes.push(format!(
            "no file of the corrected model has {}: it acts between two sensors of a joint, and not on its torque",
            words::list(&between)
        ));
    }
    let is_larger = |fit: &JointFit| -> Option<[f64; 2]> {
        let [table, exported] = [fit.held_out_nrmse_augmented?, fit.held_out_nrmse_exported?];
        (exported > LARGER_WITHOUT * table && exported > table + LARGER_BY).then_some([table, exported])
    };
    let joints = report.fit.iter().filter_map(|(name, fit)| Some((name, is_larger(fit)?)));
    let larger: Vec<String> = joints
        .map(|(name, errors)| {
            let [table, exported] = errors.map(numbers::nrmse);
            format!("{exported} instead of {table} on {name}")
        })
        .collect();
    if !larger.is_empty() {
        notes.push(format!(
            "the error of an exported model is {}: no file has the background's corrections of friction and torque constants",
            words::list(&larger)
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use diagnosis::{Diagnosis, Finding, Parameter, RecordingNames};
    use effects::Effect;
    use effects::drive::JOINT_ELASTICITY;

    use super::*;

    fn fit(augmented: f64, exported: f64) -> JointFit {
        JointFit {
            held_out_nrmse_augmented: Some(augmented),
            held_out_nrmse_exported: Some(exported),
            ..JointFit::default()
        }
    }

    #[test]
    fn springs_between_encoders_and_larger_errors_are_noted() {
        let mut report = Diagnosis::units_first("arm", RecordingNames::default(), Vec::new()).report;
        assert!(notes(&report).is_empty());
        let mut spring = Finding::of(Effect::of(&JOINT_ELASTICITY).on("a".to_owned()));
        let (value, ci95, unit) = (2e6, [1e6, 3e6], "N m/rad");
        spring.parameters.insert("stiffness", Parameter { value, ci95, unit });
        assert!(notes(&report).is_empty());
        spring.sensor = Some("second_encoder");
        report.findings = vec![spring];
        report.fit = [("a".to_owned(), fit(0.015, 0.063)), ("b".to_owned(), fit(0.1, 0.11))].into();
        let notes = notes(&report).join("\n");
        assert!(notes.contains("joint elasticity of a:"), "{notes}");
        assert!(notes.contains("0.06 instead of 0.01 on a:"), "{notes}");
    }
}
