//! The torque models and the controller: where each must be accurate, and what they refuse.

mod support;

use arm::{Arm, DMatrix};
use support::{motion, puma560, samples, samples_of};
use torque::{
    Command, Controller, Feedback, Inputs, Lagrangian, LagrangianOptions, Learned, Prediction, RigidBody, Samples,
    TorqueError, TorqueModel, TrainingOptions, Workspace, faded_squared_error,
};

fn nominal() -> Arm {
    puma560().with_scaled_inertias(1.2)
}

fn learned(inputs: Inputs) -> Learned {
    Learned::on_top_of(&nominal(), inputs, &samples(300, 0), &TrainingOptions::default()).expect("it trains")
}

/// The model error of the paper is one factor: the torque of the scaled model is 1.2 times the true one.
#[test]
fn scaled_inertias_scale_the_torque() {
    let tests = samples(100, 1);
    let wrong = RigidBody::new(nominal()).mean_squared_error(&tests);
    let mut power = [0.0; 6];
    for sample in tests.iter() {
        for joint in 0..6 {
            power[joint] += sample.tau[joint].powi(2) / 100.0;
        }
    }
    for joint in 0..6 {
        assert!((wrong[joint] / power[joint] - 0.04).abs() < 1e-9);
    }
    assert!(RigidBody::new(puma560()).mean_squared_error(&tests).iter().all(|error| *error == 0.0));
}

/// The paper's "GPR only".
fn gp_only(samples: &Samples) -> Result<Learned, TorqueError> {
    Learned::train(None, Inputs::JointMotion, samples, &TrainingOptions::default(), &|| {})
}

/// Every learned model predicts its training samples. Fails if inputs and targets are mismatched.
#[test]
fn learned_models_explain_their_training() {
    let train = samples(300, 0);
    let wrong = RigidBody::new(nominal()).mean_squared_error(&train);
    let gp_only = gp_only(&train).expect("it trains");
    let models =
        [gp_only, learned(Inputs::JointMotion), learned(Inputs::NewtonEuler12), learned(Inputs::NewtonEuler13)];
    for model in models {
        let error = model.mean_squared_error(&train);
        for joint in 0..3 {
            assert!(error[joint] < 1e-6 * wrong[joint], "joint {joint}: {error:?} of {wrong:?}");
        }
    }
}

/// On another motion, thirteen inputs are the most accurate, then twelve, then q, q̇, q̈: the paper's result. Twelve with the loads in the
/// link's own frame are more accurate than the paper's twelve.
#[test]
fn newton_euler_inputs_transfer_to_another_task() {
    let tests = samples(300, 1);
    let error = |model: &dyn TorqueModel| model.mean_squared_error(&tests).iter().sum::<f64>();
    let thirteen = error(&learned(Inputs::NewtonEuler13));
    let twelve = error(&learned(Inputs::NewtonEuler12));
    let own_frame = error(&learned(Inputs::NewtonEulerOwnFrame));
    let joint_motion = error(&learned(Inputs::JointMotion));
    let rigid = error(&RigidBody::new(nominal()));
    assert!(
        thirteen < twelve && twelve < joint_motion && joint_motion < rigid,
        "{thirteen} {twelve} {joint_motion} {rigid}"
    );
    assert!(own_frame < 0.2 * twelve, "{own_frame} {twelve}");
}

/// Energies learned from one motion are those of another, on a rigid body and without one; fails if the torques of the joints are
/// mixed up, or those of the rigid body are not subtracted.
#[test]
fn energies_transfer_to_another_task() {
    let (train, tests) = (samples(400, 0), samples(300, 1));
    let rigid = RigidBody::new(nominal()).mean_squared_error(&tests);
    let options = LagrangianOptions { starts: 2, ..LagrangianOptions::default() };
    let on_top = Lagrangian::on_top_of(&nominal(), &train, &options).expect("it trains");
    let alone = Lagrangian::alone(&nominal(), &train, &options).expect("it trains");
    for (model, most) in [(&on_top, 5e-3), (&alone, 0.2)] {
        let error = model.mean_squared_error(&tests);
        for joint in 0..3 {
            assert!(error[joint] < most * rigid[joint], "joint {joint}: {error:?} of {rigid:?}");
        }
        assert!((0..6).all(|joint| model.noise(joint) > 0.0));
        assert!(model.regressions().is_empty() && model.energies().is_some());
    }
    assert!(alone.stands_alone() && !on_top.stands_alone());
}

/// Along the training motion, the torque of energies does not fade; where joints leave the little that they moved in training, it
/// does, to the rigid body, also for a model that has none.
#[test]
fn energies_fade_where_they_are_not_known() {
    let small = |time: f64| motion(time, 0).map(|part| part.iter().map(|value| 0.03 * value).collect::<Vec<_>>());
    let train = samples_of(300, small);
    let (mut workspace, mut below) = (Workspace::new(6), Prediction::new(6));
    let options = LagrangianOptions { starts: 1, ..LagrangianOptions::default() };
    let rigid = RigidBody::new(nominal());
    for model in [
        Lagrangian::on_top_of(&nominal(), &train, &options).expect("it trains"),
        Lagrangian::alone(&nominal(), &train, &options).expect("it trains"),
    ] {
        let gains = Feedback::Gains { kp: vec![0.0; 6], kd: vec![0.0; 6] };
        let mut plain = Prediction::new(6);
        let mut least = 1.0_f64;
        for ([q, qd, qdd], known) in [(small(100.0 / 80.0), true), (motion(1.0, 1), false)] {
            let mut controller = Controller::new(&model, nominal(), gains.clone()).expect("it fits").fading();
            let mut command = Command::new(6);
            controller.feed_forward(&q, &qd, &qdd, &mut command);
            model.predict(&mut workspace, &q, &qd, &qdd, &mut plain);
            rigid.predict(&mut workspace, &q, &qd, &qdd, &mut below);
            for (joint, weight) in controller.weights().expect("it fades").iter().enumerate() {
                let expected = below.rigid[joint] + weight * (plain.torque(joint) - below.rigid[joint]);
                assert!((command.feedforward.torque(joint) - expected).abs() < 1e-9 * expected.abs().max(1.0));
                assert!((0.0..=1.0).contains(weight) && (!known || joint > 2 || *weight > 0.99), "{weight}");
                least = least.min(*weight);
            }
        }
        assert!(least < 0.5, "{least}");
    }
}

/// The variance increases with the distance from the data, and only learned models have one.
#[test]
fn variance_tells_how_far_the_data_are() {
    let model = learned(Inputs::NewtonEuler12);
    let mut workspace = Workspace::new(6);
    let mut at = |[q, qd, qdd]: [Vec<f64>; 3]| -> Vec<f64> {
        model.variance(&mut workspace, &q, &qd, &qdd).expect("it has one").to_vec()
    };
    let near = at(motion(1.0, 0));
    let [q, qd, qdd] = motion(1.0, 0);
    let far = at([q, qd.iter().map(|v| 20.0 * v).collect(), qdd.iter().map(|a| 20.0 * a).collect()]);
    assert!(near.iter().all(|v| *v >= 0.0));
    assert!((0..3).all(|joint| far[joint] > 100.0 * near[joint]), "{far:?} {near:?}");
    let [q, qd, qdd] = motion(1.0, 0);
    assert!(RigidBody::new(puma560()).variance(&mut Workspace::new(6), &q, &qd, &qdd).is_none());
}

#[test]
fn what_does_not_fit_is_refused() {
    let none = gp_only(&Samples::new(6));
    assert!(matches!(none, Err(TorqueError::NoSamples)));
    let options = LagrangianOptions::default();
    let none = Lagrangian::alone(&puma560(), &Samples::new(6), &options);
    assert!(matches!(none, Err(TorqueError::NoSamples)));
    let other = Lagrangian::on_top_of(&puma560(), &Samples::new(5), &options);
    assert!(matches!(other, Err(TorqueError::Joints { found: 5, .. })));
    let options = LagrangianOptions { starts: 0, ..options };
    let message = Lagrangian::alone(&puma560(), &samples(9, 0), &options).expect_err("it is refused");
    assert_eq!(message.to_string(), "the energies cannot be learned: starts is 0: it must be at least 1");
    let model = RigidBody::new(puma560());
    let gains = |kp: Vec<f64>| Controller::new(&model, puma560(), Feedback::Gains { kp, kd: vec![1.0; 6] });
    assert!(matches!(gains(vec![1.0; 5]), Err(TorqueError::Joints { found: 5, expected: 6, .. })));
    let mut negative = vec![1.0; 6];
    negative[3] = -1.0;
    let message = gains(negative).err().expect("it is refused").to_string();
    assert_eq!(message, "kp of joint 4 is -1; it must be finite and not negative");
    assert!(gains(vec![f64::NAN; 6]).is_err());
}

/// The feedback is M(q)(K_p e + K_d ė), or that of the gains alone, and the sum is limited to the effort limits.
#[test]
fn the_controller_feeds_back_and_saturates() {
    let arm = puma560();
    let model = RigidBody::new(arm.clone());
    let (kp, kd) = (vec![100.0; 6], vec![20.0; 6]);
    let [q, qd, qdd] = motion(0.3, 0);
    let error: Vec<f64> = (0..6).map(|i| 0.01 * (f64::from(i) - 2.0)).collect();
    let rate: Vec<f64> = (0..6).map(|i| 0.02 * (f64::from(i) - 3.0)).collect();
    let run = |feedback: Feedback, scale: f64| {
        let mut controller = Controller::new(&model, arm.clone(), feedback).expect("it fits");
        let mut command = Command::new(6);
        controller.feed_forward(&q, &qd, &qdd, &mut command);
        let scaled: Vec<f64> = error.iter().map(|e| scale * e).collect();
        controller.feed_back(&q, &scaled, &rate, &mut command);
        command
    };
    let command = run(Feedback::MassMatrix { kp: kp.clone(), kd: kd.clone() }, 1.0);
    let mut mass_matrix = DMatrix::zeros(6, 6);
    arm.mass_matrix(&mut arm::Workspace::new(&arm), &q, &mut mass_matrix);
    let mut prediction = Prediction::new(6);
    model.predict(&mut Workspace::new(6), &q, &qd, &qdd, &mut prediction);
    for i in 0..6 {
        let expected: f64 = (0..6).map(|j| mass_matrix[(i, j)] * (100.0 * error[j] + 20.0 * rate[j])).sum();
        assert!((command.feedback[i] - expected).abs() < 1e-12);
        assert!((command.torque[i] - expected - prediction.rigid[i]).abs() < 1e-12);
        assert!(!command.saturated[i]);
    }
    let command = run(Feedback::Gains { kp, kd }, 1000.0);
    for (i, joint) in arm.joints().iter().enumerate() {
        let wanted = 100.0 * 1000.0 * error[i] + 20.0 * rate[i];
        assert!((command.feedback[i] - wanted).abs() < 1e-9);
        assert_eq!(command.saturated[i], command.torque[i].abs() == joint.limits.effort);
        assert!(command.torque[i].abs() <= joint.limits.effort);
    }
    assert!(command.saturated[0] && !command.saturated[2]);
}

/// Along the training motion nothing fades; far from the data only the rigid body remains, also for a model without a
/// rigid-body part; in between, the command follows from the weights.
#[test]
fn a_learned_torque_fades_where_it_knows_nothing() {
    let train = samples(300, 0);
    let on_top = learned(Inputs::NewtonEuler13);
    let alone = gp_only(&train).expect("it trains");
    for model in [on_top, alone] {
        let rigid = RigidBody::new(nominal());
        let gains = Feedback::Gains { kp: vec![0.0; 6], kd: vec![0.0; 6] };
        let mut workspace = Workspace::new(6);
        let (mut plain, mut below) = (Prediction::new(6), Prediction::new(6));
        let mut smallest = [1.0_f64; 6];
        for speed in [1.0, 2.0, 4.0, 100.0] {
            let mut controller = Controller::new(&model, nominal(), gains.clone()).expect("it fits").fading();
            let mut command = Command::new(6);
            let [q, qd, qdd] = motion(1.0, 0);
            let qd: Vec<f64> = qd.iter().map(|v| speed * v).collect();
            let qdd: Vec<f64> = qdd.iter().map(|a| speed * speed * a).collect();
            controller.feed_forward(&q, &qd, &qdd, &mut command);
            model.predict(&mut workspace, &q, &qd, &qdd, &mut plain);
            rigid.predict(&mut workspace, &q, &qd, &qdd, &mut below);
            let weights = controller.weights().expect("it fades").to_vec();
            for joint in 0..6 {
                let weight = weights[joint];
                let expected = below.rigid[joint] + weight * (plain.torque(joint) - below.rigid[joint]);
                assert!((command.feedforward.torque(joint) - expected).abs() < 1e-9 * expected.abs().max(1.0));
                assert!((0.0..=1.0).contains(&weight));
                assert!(weight <= smallest[joint] + 0.2, "{weights:?} at {speed}, {smallest:?} before");
                smallest[joint] = smallest[joint].min(weight);
                if speed == 1.0 {
                    assert!(joint > 2 || weight == 1.0, "{weights:?}");
                }
                if speed == 100.0 {
                    assert!(joint > 2 || weight < 1e-6, "{weights:?}");
                }
            }
        }
        // The torque that is fed forward has the error of the model along the training motion, and of the rigid body far from it.
        let far = samples_of(50, |time| {
            let [q, qd, qdd] = motion(time, 0);
            [q, qd.iter().map(|v| 100.0 * v).collect(), qdd.iter().map(|a| 1e4 * a).collect()]
        });
        let (faded, full) = (faded_squared_error(&model, &nominal(), &far), model.mean_squared_error(&far));
        let below = rigid.mean_squared_error(&far);
        let known = faded_squared_error(&model, &nominal(), &train);
        for joint in 0..3 {
            assert!((faded[joint] / below[joint] - 1.0).abs() < 1e-3, "{faded:?} {below:?}");
            // A regression of the residual returns to the rigid body by itself.
            assert!(!model.stands_alone() || (full[joint] / below[joint] - 1.0).abs() > 1e-2, "{full:?} {below:?}");
            assert!(known[joint] < 1e-3 * rigid.mean_squared_error(&train)[joint], "{known:?}");
        }
    }
}

/// After the first step, each step renews the weight of one joint, so that all are renewed in six steps.
#[test]
fn one_weight_is_renewed_in_a_step() {
    let model = learned(Inputs::NewtonEuler13);
    let gains = Feedback::Gains { kp: vec![0.0; 6], kd: vec![0.0; 6] };
    let mut controller = Controller::new(&model, nominal(), gains).expect("it fits").fading();
    let mut command = Command::new(6);
    let [q, qd, qdd] = motion(1.0, 0);
    controller.feed_forward(&q, &qd, &qdd, &mut command);
    let near = controller.weights().expect("it fades").to_vec();
    let fast = |values: &[f64], factor: f64| -> Vec<f64> { values.iter().map(|value| factor * value).collect() };
    let (qd, qdd) = (fast(&qd, 100.0), fast(&qdd, 10_000.0));
    let mut changed = 0;
    for step in 1..=6 {
        controller.feed_forward(&q, &qd, &qdd, &mut command);
        let weights = controller.weights().expect("it fades");
        let now = weights.iter().zip(&near).filter(|(now, then)| now != then).count();
        assert!(now <= changed + 1, "step {step}: {weights:?} after {near:?}");
        changed = now;
    }
    assert_eq!(changed, 6);
}
