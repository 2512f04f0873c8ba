//! A control step does not allocate, whatever the model; nor does the variance once its scratch has grown.

mod support;

use support::{motion, puma560, samples};
use torque::{Command, Controller, Feedback, Inputs, Learned, TrainingOptions};

#[test]
fn no_control_step_allocates() {
    let nominal = puma560().with_scaled_inertias(1.2);
    for inputs in [Inputs::JointMotion, Inputs::NewtonEuler12, Inputs::NewtonEuler13] {
        let model =
            Learned::on_top_of(&nominal, inputs, &samples(100, 0), &TrainingOptions::default()).expect("it trains");
        let feedback = Feedback::MassMatrix {
            kp: vec![100.0; 6],
            kd: vec![20.0; 6],
        };
        let mut controller = Controller::new(&model, nominal.clone(), feedback).expect("it fits");
        let mut command = Command::new(6);
        let [q, qd, qdd] = motion(0.4, 0);
        let mut step = || {
            controller.feed_forward(&q, &qd, &qdd, &mut command);
            controller.feed_back(&q, &qd, &qdd, &mut command);
            controller.variance(&q, &qd, &qdd).map(<[f64]>::len)
        };
        step();
        let counted = allocation_counter::measure(|| {
            step();
        });
        assert_eq!(counted.count_total, 0, "{inputs:?}");
    }
}
