//! Fitting: smooth noise-free motion, where the rank is low, and noisy scatter, where it is full.

use std::f64::consts::TAU;

use divan::Bencher;
use gp::{FitOptions, Gp, Hyperparameters, LengthScales, Lengths, TrainingSet};

const DIM: usize = 13;

fn main() {
    divan::main();
}

/// `n` samples of thirteen inputs along a smooth path, and a smooth function of them.
fn motion(n: usize) -> TrainingSet {
    let input = |i: usize, d: usize| {
        let time = i as f64 / 80.0;
        let scale = 10_f64.powi(d as i32 % 3);
        scale * ((0.3 + 0.07 * d as f64) * time + d as f64).sin()
    };
    let inputs: Vec<f64> = (0..n * DIM).map(|at| input(at / DIM, at % DIM)).collect();
    let targets: Vec<f64> =
        inputs.chunks_exact(DIM).map(|x| x[2] * (x[0]).cos() + 3.0 * x[1] + (x[3] * x[6]).sin()).collect();
    TrainingSet::new(DIM, &inputs, &targets).expect("valid")
}

/// `n` samples of two inputs, scattered, with noise: full rank.
fn scatter(n: usize) -> TrainingSet {
    let share = |i: usize, step: f64| (i as f64 * step).fract();
    let inputs: Vec<f64> = (0..n).flat_map(|i| [share(i, 0.754_877_666), share(i, 0.569_840_291)]).collect();
    let targets: Vec<f64> = (0..n)
        .map(|i| {
            (40.0 * inputs[2 * i]).sin() * (35.0 * inputs[2 * i + 1]).cos() + 0.2 * (TAU * share(i, 0.1234567)).sin()
        })
        .collect();
    TrainingSet::new(2, &inputs, &targets).expect("valid")
}

#[divan::bench(args = [800, 2000], sample_count = 3)]
fn isotropic(bencher: Bencher, n: usize) {
    let training = motion(n);
    bencher.bench_local(|| Gp::fit(&training, &FitOptions::default()));
}

#[divan::bench(args = [800, 2000], sample_count = 3)]
fn per_input(bencher: Bencher, n: usize) {
    let training = motion(n);
    let options = FitOptions { lengths: LengthScales::PerInput, ..FitOptions::default() };
    bencher.bench_local(|| Gp::fit(&training, &options));
}

#[divan::bench(args = [800, 2000], sample_count = 1)]
fn full_rank(bencher: Bencher, n: usize) {
    let training = scatter(n);
    bencher.bench_local(|| Gp::fit(&training, &FitOptions::default()));
}

/// One posterior without the search, by length scale: from low rank to full rank.
#[divan::bench(args = [0.3, 0.1, 0.06, 0.04, 0.03, 0.01], sample_count = 3)]
fn given_hyperparameters(bencher: Bencher, length: f64) {
    let training = scatter(2000);
    let hyperparameters = Hyperparameters { amplitude: 1.0, lengths: Lengths::Isotropic(length), noise: 1e-4 };
    bencher.bench_local(|| Gp::with_hyperparameters(&training, &hyperparameters));
}
