//! Prediction: one joint's mean, a control step's six means, and mean with variance; n = 2000, thirteen inputs.

use divan::{Bencher, black_box};
use gp::{Gp, Hyperparameters, Lengths, TrainingSet, Workspace};

const DIM: usize = 13;

fn main() {
    divan::main();
}

/// A model of 2000 samples along a smooth path, by relative noise deviation: at 1e-6 a mean costs the rank, at 1e-2 all samples.
fn model(noise: f64) -> Gp {
    let input = |i: usize, d: usize| ((0.3 + 0.17 * d as f64) * i as f64 / 80.0 + d as f64).sin();
    let inputs: Vec<f64> = (0..2000 * DIM).map(|at| input(at / DIM, at % DIM)).collect();
    let targets: Vec<f64> = inputs.chunks_exact(DIM).map(|x| x[0] * x[1] + x[5].cos()).collect();
    let training = TrainingSet::new(DIM, &inputs, &targets).expect("valid");
    let hyperparameters = Hyperparameters { amplitude: 1.0, lengths: Lengths::Isotropic(4.5), noise };
    Gp::with_hyperparameters(&training, &hyperparameters).expect("valid")
}

#[divan::bench(args = [1e-6, 1e-2])]
fn mean(bencher: Bencher, noise: f64) {
    let gp = model(noise);
    let x = [0.1; DIM];
    bencher.bench_local(|| gp.mean(black_box(&x)));
}

#[divan::bench(args = [1e-6, 1e-2])]
fn six_means(bencher: Bencher, noise: f64) {
    let joints = vec![model(noise); 6];
    let x = [0.1; DIM];
    bencher.bench_local(|| joints.iter().map(|gp| gp.mean(black_box(&x))).sum::<f64>());
}

#[divan::bench(args = [1e-6, 1e-2])]
fn mean_and_variance(bencher: Bencher, noise: f64) {
    let gp = model(noise);
    let x = [0.1; DIM];
    let mut workspace = Workspace::default();
    bencher.bench_local(|| gp.mean_and_variance(black_box(&x), &mut workspace));
}
