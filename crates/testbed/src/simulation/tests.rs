//! The closed loop outside the range of the training data.

use super::*;
use crate::cli::ChainArgs;
use crate::training;

/// The root mean square tracking error over the joints (mrad).
fn all_joints(outcome: &Outcome) -> f64 {
    let squares: f64 = outcome.rms_error.iter().map(|error| error * error).sum();
    1e3 * (squares / outcome.rms_error.len() as f64).sqrt()
}

/// On the scenario that leaves the training tasks, the loop with the fade tracks better than with the full learned torque,
/// and better than with the rigid body alone. This holds for the paper's model and for the regression without a rigid body.
#[test]
fn the_fade_tracks_better_beyond_the_training_tasks() {
    let mut scenario = Scenario::built_in("beyond").expect("it comes with testbed");
    assert!(scenario.fade && scenario.model == ModelKind::IndependentJoint);
    let samples =
        training::training_samples(&scenario, &scenario.training, &ChainArgs::default(), 0).expect("they are there");
    let options = scenario.length_scales.training_options();
    let mut track = |kind: ModelKind, model: &dyn TorqueModel, fade: bool| {
        scenario.fade = fade;
        let outcome = run(&scenario, kind, model, 0, &mut []).expect("it runs");
        assert_eq!(outcome.weights.len(), if fade && kind.learns() { 6 } else { 0 });
        for weight in &outcome.weights {
            assert!(0.0 <= weight.least && weight.least <= weight.mean && weight.mean <= 1.0, "{weight:?}");
        }
        all_joints(&outcome)
    };
    let (true_arm, nominal) = {
        let scenario = Scenario::built_in("beyond").expect("it comes with testbed");
        (scenario.arm.clone(), scenario.nominal_arm())
    };
    let build = |kind: ModelKind| kind.build(&true_arm, &nominal, &samples, &options).expect("it trains");
    let rigid = track(ModelKind::RigidBody, build(ModelKind::RigidBody).as_ref(), true);
    for (kind, against_rigid) in [(ModelKind::IndependentJoint, 0.9), (ModelKind::Gp, 1.1)] {
        let model = build(kind);
        let with = track(kind, model.as_ref(), true);
        let without = track(kind, model.as_ref(), false);
        println!("{kind:?}: {with:.2} mrad with the fade, {without:.2} without, {rigid:.2} rigid body alone");
        assert!(with < 0.8 * without, "{kind:?}: {with} with, {without} without");
        assert!(with < against_rigid * rigid, "{kind:?}: {with} with, {rigid} rigid body alone");
    }
}

/// The paper's tasks have the paper's controller without a fade; other scenarios fade by default.
#[test]
fn the_papers_tasks_do_not_fade() {
    for task in ["taskA", "taskB", "taskC", "taskD"] {
        assert!(!Scenario::built_in(task).expect("it comes with testbed").fade);
    }
}
