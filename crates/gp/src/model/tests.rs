//! Tests of fitting, prediction, saving and loading.

use super::*;
use crate::dense::Dense;

/// Uniform numbers in [0, 1): xorshift64*, so that the tests need no generator of their own version.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal, by Box and Muller.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn scattered(random: &mut Random, n: usize, dim: usize) -> Vec<f64> {
    (0..n * dim).map(|_| 4.0 * random.uniform() - 2.0).collect()
}

/// A draw from a Gaussian process, with noise.
fn draw(random: &mut Random, n: usize, truth: &Hyperparameters, dim: usize) -> TrainingSet {
    let inputs = scattered(random, n, dim);
    let blank = TrainingSet::new(dim, &inputs, &vec![0.0; n]).expect("valid");
    let points = blank.scaled(&truth.lengths.each(dim));
    let rho = (truth.noise / truth.amplitude).powi(2);
    let factor = Dense::new(&points, blank.targets(), rho).expect("definite").outer;
    let normals: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    let targets: Vec<f64> =
        (0..n).map(|i| (0..=i).map(|j| factor[(i, j)] * normals[j]).sum::<f64>() * truth.amplitude).collect();
    TrainingSet::new(dim, &inputs, &targets).expect("valid")
}

/// Smooth and noise-free: the kernel matrix is nearly singular.
fn smooth(n: usize) -> TrainingSet {
    let time = |i: usize| i as f64 / n as f64 * 6.0;
    let inputs: Vec<f64> = (0..n).flat_map(|i| [time(i).sin(), (1.3 * time(i)).cos(), 0.7]).collect();
    let targets: Vec<f64> = (0..n).map(|i| 5.0 * (time(i).sin() + 0.5 * (1.3 * time(i)).cos()).tanh()).collect();
    TrainingSet::new(3, &inputs, &targets).expect("valid")
}

fn assert_close(name: &str, value: f64, expected: f64, factor: f64) {
    let ratio = value / expected;
    assert!(
        ratio < factor && ratio > factor.recip(),
        "{name} is {value}, expected {expected} within a factor of {factor}"
    );
}

#[test]
fn recovers_the_hyperparameters_of_a_draw() {
    let mut random = Random(7);
    let truth = Hyperparameters { amplitude: 3.0, lengths: Lengths::Isotropic(0.8), noise: 0.05 };
    let training = draw(&mut random, 300, &truth, 2);
    let gp = Gp::fit(&training, &FitOptions::default()).expect("fits");
    let found = gp.hyperparameters();
    assert_close("amplitude", found.amplitude, 3.0, 1.6);
    assert_close("noise", found.noise, 0.05, 1.2);
    let Lengths::Isotropic(length) = found.lengths else { panic!("one length asked for") };
    assert_close("length", length, 0.8, 1.2);
    let at_truth = Gp::with_hyperparameters(&training, &truth).expect("valid");
    assert!(gp.log_marginal_likelihood() >= at_truth.log_marginal_likelihood());
    assert_eq!(gp.conditioning().added, 0.0);
}

#[test]
fn recovers_one_length_an_input() {
    let mut random = Random(11);
    let truth = Hyperparameters { amplitude: 2.0, lengths: Lengths::PerInput(vec![0.7, 2.5, 1e3]), noise: 0.02 };
    let training = draw(&mut random, 400, &truth, 3);
    let options = FitOptions { lengths: LengthScales::PerInput, ..FitOptions::default() };
    let gp = Gp::fit(&training, &options).expect("fits");
    let Lengths::PerInput(lengths) = &gp.hyperparameters().lengths else { panic!("one length an input asked for") };
    assert_close("first length", lengths[0], 0.7, 1.25);
    assert_close("second length", lengths[1], 2.5, 1.5);
    assert!(lengths[2] > 20.0, "the third input does not matter: {lengths:?}");
    let at_truth = Gp::with_hyperparameters(&training, &truth).expect("valid");
    assert!(gp.log_marginal_likelihood() >= at_truth.log_marginal_likelihood());
}

#[test]
fn a_function_too_fine_for_the_first_samples_is_found() {
    // A quarter of the samples, on which the search starts, seems to be noise only.
    let mut random = Random(13);
    let inputs = scattered(&mut random, 1000, 2);
    let targets: Vec<f64> =
        inputs.chunks_exact(2).map(|x| (14.0 * x[0]).sin() * (12.0 * x[1]).cos() + 0.05 * random.normal()).collect();
    let training = TrainingSet::new(2, &inputs, &targets).expect("valid");
    let gp = Gp::fit(&training, &FitOptions::default()).expect("fits");
    assert_close("noise", gp.hyperparameters().noise, 0.05, 1.5);
}

#[test]
fn noise_free_data_are_conditioned_and_it_is_said() {
    let training = smooth(400);
    let gp = Gp::fit(&training, &FitOptions::default()).expect("fits");
    let conditioning = gp.conditioning();
    assert!(conditioning.rank < 100, "{conditioning}");
    assert!(conditioning.added > 0.0, "{conditioning}");
    assert!(conditioning.to_string().contains("added to the diagonal"));
    for i in 0..400 {
        let error = gp.mean(training.row(i)) - training.targets()[i];
        assert!(error.abs() < 1e-5, "sample {i} is off by {error:e}");
    }
    let asked = FitOptions { min_relative_noise: 1e-6, ..FitOptions::default() };
    let gp = Gp::fit(&training, &asked).expect("fits");
    assert_close("relative noise", gp.conditioning().relative_noise, 1e-6, 1.01);
}

#[test]
fn too_little_noise_is_raised_to_the_floor() {
    let hyperparameters = Hyperparameters { amplitude: 2.0, lengths: Lengths::Isotropic(1.0), noise: 0.0 };
    let gp = Gp::with_hyperparameters(&smooth(200), &hyperparameters).expect("valid");
    let floor = 200.0 * f64::EPSILON;
    assert_eq!(gp.conditioning().added, floor);
    assert_eq!(gp.hyperparameters().noise, 2.0 * floor.sqrt());
}

#[test]
fn two_fits_are_the_same_bit_for_bit() {
    let training = draw(
        &mut Random(3),
        350,
        &Hyperparameters { amplitude: 1.0, lengths: Lengths::Isotropic(1.5), noise: 0.01 },
        2,
    );
    let fit = || Gp::fit(&training, &FitOptions::default()).expect("fits");
    let text = |gp: &Gp| serde_json::to_string(gp).expect("serialises");
    assert_eq!(text(&fit()), text(&fit()));
}

#[test]
fn a_model_saved_and_loaded_predicts_the_same_bits() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.json");
    let noisy = Hyperparameters { amplitude: 1.0, lengths: Lengths::PerInput(vec![0.2, 0.3, 0.4]), noise: 0.3 };
    let low_rank = Gp::fit(&smooth(300), &FitOptions::default()).expect("fits");
    let training = draw(&mut Random(5), 60, &noisy, 3);
    let dense = Gp::with_hyperparameters(&training, &noisy).expect("valid");
    let zeros = TrainingSet::new(3, &[0.5; 9], &[0.0; 3]).expect("valid");
    let zero = Gp::fit(&zeros, &FitOptions::default()).expect("fits");
    let (mut a, mut b) = (Workspace::default(), Workspace::default());
    for gp in [low_rank, dense, zero] {
        gp.save(&path).expect("saves");
        let loaded = Gp::load(&path).expect("loads");
        assert_eq!(loaded.hyperparameters(), gp.hyperparameters());
        assert_eq!(loaded.conditioning(), gp.conditioning());
        assert_eq!(loaded.log_marginal_likelihood(), gp.log_marginal_likelihood());
        for x in [[0.1, 0.2, 0.7], [3.0, -1.0, 0.0]] {
            assert_eq!(loaded.mean(&x).to_bits(), gp.mean(&x).to_bits());
            let (ours, theirs) = (gp.mean_and_variance(&x, &mut a), loaded.mean_and_variance(&x, &mut b));
            assert_eq!(ours.1.to_bits(), theirs.1.to_bits());
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("lists").count(), 1);
}

#[test]
fn a_file_that_is_no_model_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.json");
    let missing = Gp::load(&path).expect_err("missing").to_string();
    assert!(missing.contains("model.json"), "{missing}");
    Gp::fit(&smooth(50), &FitOptions::default()).and_then(|gp| gp.save(&path)).expect("saves");
    let good = std::fs::read_to_string(&path).expect("reads");
    let weights = good.find("\"weights\":[").expect("has weights") + "\"weights\":[".len();
    let comma = weights + good[weights..].find(',').expect("several weights");
    let without_weight = format!("{}{}", &good[..weights], &good[comma + 1..]);
    for (text, complaint) in [
        (good.replace("testbed.gp/1", "testbed.gp/2"), "expected \"testbed.gp/1\""),
        (good.replacen("\"dim\":3", "\"dim\":2", 1), "points of 2 inputs"),
        (without_weight, "points has"),
        (good[..good.len() / 2].to_owned(), "line 1"),
        ("{}".to_owned(), "missing field `format`"),
        (good.replacen("\"amplitude\":", "\"amplitude\":-", 1), "amplitude"),
    ] {
        std::fs::write(&path, text).expect("writes");
        let error = Gp::load(&path).expect_err("refused").to_string();
        assert!(error.contains("model.json") && error.contains(complaint), "{error}");
    }
}

#[test]
fn degenerate_data_make_no_nan() {
    let options = FitOptions::default();
    let per_input = FitOptions { lengths: LengthScales::PerInput, ..FitOptions::default() };
    let inputs: Vec<f64> = (0..80).map(|i| if i % 2 == 0 { f64::from(i) } else { 0.7 }).collect();
    let zigzag: Vec<f64> = (0..40).map(|i| f64::from(i % 3) - 1.0).collect();
    let line: Vec<f64> = (0..40).map(|i| 1e-9 * f64::from(i)).collect();
    for options in [&options, &per_input] {
        for targets in [vec![0.0; 40], vec![-3.5; 40], zigzag.clone(), line.clone()] {
            let training = TrainingSet::new(2, &inputs, &targets).expect("valid");
            let gp = Gp::fit(&training, options).expect("fits");
            let (mean, variance) = gp.mean_and_variance(&[4.0, 0.7], &mut Workspace::default());
            assert!(mean.is_finite() && variance >= 0.0 && variance.is_finite());
            if targets.iter().all(|y| *y == targets[0]) {
                assert!((mean - targets[1]).abs() < 1e-4, "constant {}: {mean}", targets[1]);
            }
        }
        let same_place = TrainingSet::new(1, &[2.0; 5], &[1.0, 2.0, 3.0, 2.0, 2.0]).expect("valid");
        let gp = Gp::fit(&same_place, options).expect("fits");
        assert!((gp.mean(&[2.0]) - 2.0).abs() < 0.1, "{}", gp.mean(&[2.0]));
        let single = TrainingSet::new(1, &[2.0], &[1.0]).expect("valid");
        let gp = Gp::fit(&single, options).expect("fits");
        assert!((gp.mean(&[2.0]) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn predictions_far_away_and_at_no_number() {
    let gp = Gp::fit(&smooth(100), &FitOptions::default()).expect("fits");
    let mut workspace = Workspace::default();
    let (mean, variance) = gp.mean_and_variance(&[1e9, 0.0, 0.0], &mut workspace);
    assert!(mean.abs() < 1e-290);
    assert_eq!(variance, gp.hyperparameters().amplitude.powi(2));
    assert!(gp.mean(&[f64::NAN, 0.0, 0.0]).is_nan());
    assert!(gp.mean_and_variance(&[f64::NAN, 0.0, 0.0], &mut workspace).1.is_nan());
    assert!(gp.mean(&[f64::INFINITY, 0.0, 0.0]).abs() < 1e-290);
}

#[test]
fn bad_data_and_settings_are_refused_by_name() {
    let message = |dim, inputs: &[f64], targets: &[f64]| {
        let refused = TrainingSet::new(dim, inputs, targets);
        refused.expect_err("refused").to_string()
    };
    assert!(message(2, &[], &[]).contains("no training data"));
    assert!(message(2, &[1.0; 5], &[1.0; 2]).contains("expected 4"));
    let nan = message(2, &[1.0, 1.0, 1.0, f64::NAN], &[1.0; 2]);
    assert!(nan.contains("input 1 of sample 1 is NaN"), "{nan}");
    assert!(message(1, &[1.0; 2], &[1.0, f64::INFINITY]).contains("target of sample 1 is inf"));
    let training = TrainingSet::new(2, &[1.0; 4], &[1.0; 2]).expect("valid");
    for (amplitude, lengths, noise, complaint) in [
        (0.0, Lengths::Isotropic(1.0), 0.1, "amplitude is 0"),
        (1.0, Lengths::Isotropic(-1.0), 0.1, "length scale is -1"),
        (1.0, Lengths::PerInput(vec![1.0; 3]), 0.1, "3 length scales for 2 inputs"),
        (1.0, Lengths::Isotropic(1.0), f64::NAN, "noise is NaN"),
    ] {
        let given = Hyperparameters { amplitude, lengths, noise };
        let error = Gp::with_hyperparameters(&training, &given).expect_err("refused").to_string();
        assert!(error.contains(complaint), "{error}");
    }
    let options = FitOptions { starts: 0, ..FitOptions::default() };
    assert!(Gp::fit(&training, &options).is_err());
}

#[test]
fn inducing_points_predict_nearly_as_all_points_do() {
    let n = 600;
    let mut random = Random(7);
    let inputs: Vec<f64> = (0..2 * n).map(|_| 4.0 * random.uniform()).collect();
    let truth = |x: &[f64]| (2.0 * x[0]).sin() + (1.5 * x[1]).cos();
    let targets: Vec<f64> = inputs.chunks_exact(2).map(|x| truth(x) + 0.05 * random.normal()).collect();
    let training = TrainingSet::new(2, &inputs, &targets).expect("valid");
    let fit = |inducing| {
        let options = FitOptions { inducing, ..FitOptions::default() };
        Gp::fit(&training, &options).expect("valid")
    };
    let (exact, approximate) = (fit(None), fit(Some(40)));
    assert_eq!(approximate.support(), 40);
    assert_eq!(exact.conditioning().likelihood_gap, None);
    let gap = approximate.conditioning().likelihood_gap.expect("an approximation");
    assert!(gap > 0.0);
    let bound = approximate.log_marginal_likelihood();
    assert!(bound < exact.log_marginal_likelihood(), "the bound is one: {bound}");
    assert!(approximate.conditioning().to_string().contains("40 inducing points"));
    let at = [1.1, 2.3];
    let (mean, variance) = approximate.mean_and_variance(&at, &mut Workspace::default());
    assert!((mean - exact.mean(&at)).abs() < 0.02, "{mean} and {}", exact.mean(&at));
    assert!(variance > 0.0 && variance < 0.01, "{variance}");
    // The conditioning of a model that is saved and loaded is unchanged.
    let again: Gp = serde_json::from_str(&serde_json::to_string(&approximate).expect("valid")).expect("valid");
    assert_eq!(again.conditioning(), approximate.conditioning());
    // As many inducing points as samples are exact.
    assert_eq!(fit(Some(n)).log_marginal_likelihood(), exact.log_marginal_likelihood());
    let none = FitOptions { inducing: Some(0), ..FitOptions::default() };
    assert!(matches!(Gp::fit(&training, &none), Err(GpError::OutOfRange { name: "inducing", .. })));
}
