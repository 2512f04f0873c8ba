//! Time of a control step (feed-forward and feedback) of the PUMA 560 under each model, trained on 2000 samples.

#[path = "../tests/support/mod.rs"]
mod support;

use divan::Bencher;
use support::{motion, puma560, samples};
use torque::{
    Command, Controller, Feedback, Inputs, Lagrangian, LagrangianOptions, Learned, RigidBody, TorqueModel,
    TrainingOptions,
};

fn bench(bencher: Bencher, model: &dyn TorqueModel, fades: bool) {
    let nominal = puma560().with_scaled_inertias(1.2);
    let feedback = Feedback::MassMatrix { kp: vec![100.0; 6], kd: vec![20.0; 6] };
    let mut controller = Controller::new(model, nominal, feedback).expect("it fits");
    if fades {
        controller = controller.fading();
    }
    let mut command = Command::new(6);
    let motions: Vec<_> = (0..256).map(|k| motion(f64::from(k) / 25.0, 1)).collect();
    let mut k = 0;
    bencher.bench_local(|| {
        k = (k + 1) % motions.len();
        let [q, qd, qdd] = &motions[k];
        controller.feed_forward(q, qd, qdd, &mut command);
        controller.feed_back(q, qd, qdd, &mut command);
        command.torque[0]
    });
}

fn learned(inputs: Inputs) -> Learned {
    let nominal = puma560().with_scaled_inertias(1.2);
    Learned::on_top_of(&nominal, inputs, &samples(2000, 0), &TrainingOptions::default()).expect("it trains")
}

#[divan::bench]
fn rigid_body(bencher: Bencher) {
    bench(bencher, &RigidBody::new(puma560()), false);
}

#[divan::bench]
fn hybrid(bencher: Bencher) {
    bench(bencher, &learned(Inputs::JointMotion), false);
}

#[divan::bench]
fn independent_joint(bencher: Bencher) {
    bench(bencher, &learned(Inputs::NewtonEuler12), false);
}

#[divan::bench]
fn independent_joint_13(bencher: Bencher) {
    bench(bencher, &learned(Inputs::NewtonEuler13), false);
}

#[divan::bench]
fn independent_joint_13_fading(bencher: Bencher) {
    bench(bencher, &learned(Inputs::NewtonEuler13), true);
}

fn energies() -> Lagrangian {
    let nominal = puma560().with_scaled_inertias(1.2);
    Lagrangian::on_top_of(&nominal, &samples(2000, 0), &LagrangianOptions::default()).expect("it trains")
}

#[divan::bench]
fn lagrangian(bencher: Bencher) {
    bench(bencher, &energies(), false);
}

#[divan::bench]
fn lagrangian_fading(bencher: Bencher) {
    bench(bencher, &energies(), true);
}

fn main() {
    divan::main();
}
