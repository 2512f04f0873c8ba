//! No control step allocates, whatever the model; the variance does not allocate once its scratch has grown.

mod support;

use effects::Effect;
use effects::arm::EXTERNAL_CONTACT;
use effects::friction::LOAD_DEPENDENT_FRICTION;
use effects::joint::SPRING;
use support::{motion, puma560, samples};
use torque::{
    Command, Controller, Corrected, Feedback, Inputs, Lagrangian, LagrangianOptions, Learned, Prediction, TorqueModel,
    TrainingOptions, Workspace,
};

#[test]
fn no_control_step_allocates() {
    let nominal = puma560().with_scaled_inertias(1.2);
    let learned = |inputs: Inputs| -> Box<dyn TorqueModel> {
        let model = Learned::on_top_of(&nominal, inputs, &samples(100, 0), &TrainingOptions::default());
        Box::new(model.expect("it trains"))
    };
    let options = LagrangianOptions { starts: 1, max_iterations: 5, ..LagrangianOptions::default() };
    let energies = Lagrangian::on_top_of(&nominal, &samples(60, 0), &options).expect("it trains");
    let alone = Lagrangian::alone(&nominal, &samples(60, 0), &options).expect("it trains");
    let models: [(&str, Box<dyn TorqueModel>); 6] = [
        ("joint motion", learned(Inputs::JointMotion)),
        ("12 inputs", learned(Inputs::NewtonEuler12)),
        ("13 inputs", learned(Inputs::NewtonEuler13)),
        ("12 inputs, own frame", learned(Inputs::NewtonEulerOwnFrame)),
        ("energies", Box::new(energies)),
        ("energies only", Box::new(alone)),
    ];
    for (name, model) in models {
        let feedback = Feedback::MassMatrix { kp: vec![100.0; 6], kd: vec![20.0; 6] };
        let mut controller = Controller::new(model.as_ref(), nominal.clone(), feedback).expect("it fits").fading();
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
        assert_eq!(counted.count_total, 0, "{name}");
    }
}

#[test]
fn a_corrected_model_does_not_allocate() {
    let joint = || puma560().joints()[1].name.clone();
    let effects = [
        Effect::of(&LOAD_DEPENDENT_FRICTION).on(joint()).with("coulomb", 1.0).with("gain", 0.1),
        Effect::of(&SPRING)
            .on(joint())
            .with("stiffness", 1.0)
            .with("rest", 0.0)
            .with("curve", vec![[0.0, 0.0], [1.0, 2.0]]),
        Effect::of(&EXTERNAL_CONTACT).with("start", 0.0).with("duration", 1.0).with("force", [1.0, 2.0, 3.0]),
    ];
    let model = Corrected::new(&puma560(), &effects).expect("they are physical");
    let mut workspace = Workspace::new(6);
    let mut prediction = Prediction::new(6);
    let [q, qd, qdd] = motion(0.4, 0);
    model.predict(&mut workspace, &q, &qd, &qdd, &mut prediction);
    let counted = allocation_counter::measure(|| {
        model.predict(&mut workspace, &q, &qd, &qdd, &mut prediction);
        model.predict_at(0.5, &mut workspace, &q, &qd, &qdd, &mut prediction);
    });
    assert_eq!(counted.count_total, 0);
}
