//! The completed report: with the figures that need a learned model and a simulated arm.

use arm::Arm;
use diagnosis::{Diagnosis, Input, JointRollout, Report, Step, Trace};
use effects::Effect;
use recording::RegularRecording;
use recording::statistics::{mean_square, moments};

use crate::error::ValidateError;
use crate::learned::{self, LearnedOptions, RecordedMotion};
use crate::rollout::{RolloutOptions, rollout};

/// A complete report.
#[derive(Clone, Debug)]
pub struct Complete {
    /// The diagnosis' report, with `held_out_nrmse_learned` of each joint and `rollout`.
    pub report: Report,
    /// What the simulation omits, or why there is none, in sentences.
    pub remarks: Vec<String>,
}

/// Completes the report of `diagnosis`, which was made of `recordings` with the effects `known` in the model.
///
/// A correction is learned from the training traces and tested on the held-out ones. The plant is driven by the torques of the
/// last held-out recording (or of the last recording), with and without the named effects; without named effects, nothing is
/// compared. `progress` receives each step as it begins.
///
/// # Errors
/// [`ValidateError::Learning`]. An arm that cannot be simulated (a link without mass) is a note, because the torques alone are
/// also useful.
pub fn complete(
    arm: &Arm,
    known: &[Effect],
    diagnosis: &Diagnosis,
    recordings: &[Input<'_>],
    progress: &dyn Fn(Step<'_>),
) -> Result<Complete, ValidateError> {
    let mut report = diagnosis.report.clone();
    progress(Step::new(0.86, "learned correction, for comparison"));
    learn(arm, &diagnosis.traces.recordings, &mut report)?;
    progress(Step::new(0.93, "simulation"));
    // The corrected arm has the load of most recordings.
    let as_most = |input: &&Input<'_>| {
        let load = report.different_load.as_ref();
        !load.is_some_and(|load| load.recordings.iter().any(|name| name == input.name))
    };
    let held_out = |input: &&Input<'_>| input.held_out;
    let simulated = recordings
        .iter()
        .rfind(|input| held_out(input) && as_most(input))
        .or_else(|| recordings.iter().rfind(held_out))
        .or(recordings.last())
        .filter(|_| !diagnosis.effects.is_empty());
    // The friction of a joint that no training recording moves is unknown.
    let training = || diagnosis.traces.recordings.iter().filter(|trace| !trace.held_out);
    let never_moves = |joint: usize| !training().any(|trace| trace.moving[joint].iter().any(|&moving| moving));
    let options = RolloutOptions { guided: (0..arm.dof()).map(never_moves).collect(), ..RolloutOptions::default() };
    let remarks = simulated.map_or_else(Vec::new, |input| {
        // Known effects are part of the model to which the findings are added.
        let corrected = [known, &diagnosis.effects].concat();
        simulate(arm, known, &corrected, input.recording, &options, &mut report)
    });
    Ok(Complete { report, remarks })
}

fn motion(trace: &Trace) -> RecordedMotion<'_> {
    RecordedMotion { q: &trace.q, qd: &trace.qd, qdd: &trace.qdd, tau: &trace.tau, moving: &trace.moving }
}

/// Adds the held-out error of a correction learned from the same recordings.
fn learn(arm: &Arm, traces: &[Trace], report: &mut Report) -> Result<(), ValidateError> {
    let of = |held_out: bool| -> Vec<&Trace> { traces.iter().filter(|trace| trace.held_out == held_out).collect() };
    let (train, held) = (of(false), of(true));
    let moves = |traces: &[&Trace]| traces.iter().any(|trace| trace.moving.iter().flatten().any(|&moving| moving));
    if held.is_empty() || !moves(&train) {
        return Ok(());
    }
    let training: Vec<RecordedMotion<'_>> = train.iter().map(|trace| motion(trace)).collect();
    let tried: Vec<RecordedMotion<'_>> = held.iter().map(|trace| motion(trace)).collect();
    let predicted = learned::predict(arm, &training, &tried, &LearnedOptions::default())?;
    for (joint, described) in arm.joints().iter().enumerate() {
        // The samples in motion, as for the other errors; all samples where the joint hardly moves.
        let moving: usize = held.iter().map(|trace| trace.moving[joint].iter().filter(|&&m| m).count()).sum();
        let (mut torques, mut misses) = (Vec::new(), Vec::new());
        for (trace, prediction) in held.iter().zip(&predicted) {
            for (row, tau) in trace.tau[joint].iter().enumerate() {
                if moving < diagnosis::LEAST_ROWS || trace.moving[joint][row] {
                    misses.push(tau - prediction[joint][row]);
                    torques.push(*tau);
                }
            }
        }
        let (_, power) = moments(torques.iter());
        if let Some(fit) = report.fit.get_mut(&described.name) {
            fit.held_out_nrmse_learned = (power > 0.0).then(|| (mean_square(misses) / power).sqrt());
        }
    }
    Ok(())
}

/// Drives the simulated arm by the recorded torques, with and without the effects found; returns notes for the user.
fn simulate(
    arm: &Arm,
    known: &[Effect],
    corrected: &[Effect],
    recording: &RegularRecording,
    options: &RolloutOptions,
    report: &mut Report,
) -> Vec<String> {
    let result = match rollout(arm, known, corrected, recording, options) {
        Ok(result) => result,
        Err(error) => return vec![format!("not done: {error}")],
    };
    report.rollout = arm
        .joints()
        .iter()
        .zip(&result.joints)
        .zip(&options.guided)
        .filter(|(_, guided)| !**guided)
        .map(|((joint, rollout), _)| (joint.name.clone(), JointRollout { ..*rollout }))
        .collect();
    let mut remarks = result.remarks;
    let names: Vec<&str> = arm
        .joints()
        .iter()
        .zip(&options.guided)
        .filter_map(|(joint, guided)| guided.then_some(joint.name.as_str()))
        .collect();
    if !names.is_empty() {
        remarks.push(format!(
            "{} follow{} the recorded motion, because no training recording has motion and torque of {}",
            names.join(", "),
            if names.len() == 1 { "s" } else { "" },
            if names.len() == 1 { "it" } else { "them" },
        ));
    }
    let windows = result.windows.len();
    for (name, count) in [("nominal", result.runaway_nominal), ("corrected", result.runaway_augmented)] {
        if count > 0 {
            remarks.push(format!(
                "the {name} arm departs from the recorded motion by more than one revolution or one metre in {count} of {windows} windows; the windows end there"
            ));
        }
    }
    remarks
}
