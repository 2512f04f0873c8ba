//! Notes on doubtful arguments, and on the robot and the reference.

use crate::cli::RunArgs;
use crate::models::ModelKind;
use crate::output;
use crate::scenario::Scenario;
use crate::training;

/// The number of samples from which a note announces a long training.
const MANY_SAMPLES: usize = 8000;

/// The same for samples that are not smooth: their kernel matrices have full rank.
const MANY_ROUGH_SAMPLES: usize = 1500;

/// Whether the torques of the training may not be smooth functions of the motion: by noise, by dry friction, or because they were
/// recorded.
fn is_rough(scenario: &Scenario, sources: &[String]) -> bool {
    let any = |values: &[f64]| values.iter().any(|value| *value > 0.0);
    any(&scenario.sensor_noise.torque)
        || any(&scenario.coulomb_friction)
        || sources.iter().any(|source| training::is_recording(source))
}

/// The number of samples of `sources` from which a note announces a long training.
fn many(scenario: &Scenario, sources: &[String]) -> usize {
    if is_rough(scenario, sources) { MANY_ROUGH_SAMPLES } else { MANY_SAMPLES }
}

/// Prints the notes on a run of `scenario` under the model `kind`, which is trained on `samples` samples of `sources`.
pub fn print(args: &RunArgs, kind: ModelKind, scenario: &Scenario, sources: &[String], samples: usize) {
    for note in &scenario.notes {
        output::say(format_args!("note: {note}"));
    }
    if args.train.is_some() && !kind.learns() {
        eprintln!("note: the model \"{}\" is not trained; --train is ignored", kind.flag());
    }
    if args.length_scales.is_some() && !kind.has_length_scales() {
        eprintln!("note: the model \"{}\" has no length scales; --length-scales is ignored", kind.flag());
    }
    if args.inducing.is_some() && !kind.learns() {
        eprintln!("note: the model \"{}\" is not trained; --inducing is ignored", kind.flag());
    }
    if args.fade.is_some() && !kind.learns() {
        eprintln!("note: the model \"{}\" has no learned torque; --fade is ignored", kind.flag());
    }
    if samples > many(scenario, sources) && args.inducing.is_none() && kind.has_length_scales() {
        eprintln!(
            "note: training on {samples} samples may take minutes; --inducing 200 or a lower reference.sample_rate shortens it"
        );
    }
    let mut motion = torque::Motion::new(scenario.arm.dof());
    let mut outside = vec![false; scenario.arm.dof()];
    for time in scenario.sample_times() {
        scenario.reference.at(time, &mut motion);
        for (joint, outside) in scenario.arm.joints().iter().zip(&mut outside).enumerate() {
            let q = motion.q[joint];
            let limits = outside.0.limits;
            *outside.1 |= q < limits.lower || q > limits.upper;
        }
    }
    let names: Vec<&str> = scenario
        .arm
        .joints()
        .iter()
        .zip(&outside)
        .filter(|(_, outside)| **outside)
        .map(|(joint, _)| joint.name.as_str())
        .collect();
    if !names.is_empty() {
        output::say(format_args!(
            "note: the reference exceeds the position limits of {}; the plant does not enforce them",
            names.join(", ")
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_training_on_rough_torques_is_announced_earlier() {
        let mut scenario = Scenario::built_in("taskA").expect("it comes with testbed");
        let sources = ["taskA".to_owned()];
        assert_eq!(many(&scenario, &sources), MANY_SAMPLES);
        assert_eq!(many(&scenario, &["run.csv".to_owned()]), MANY_ROUGH_SAMPLES);
        scenario.coulomb_friction[2] = 1.0;
        assert_eq!(many(&scenario, &sources), MANY_ROUGH_SAMPLES);
    }
}
