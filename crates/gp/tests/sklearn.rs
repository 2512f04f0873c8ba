//! With the same hyperparameters, likelihood, mean and variance equal those of scikit-learn
//! (tests/sklearn/reference.py).

use gp::{Gp, Hyperparameters, Lengths, TrainingSet, Workspace};
use serde::Deserialize;

#[derive(Deserialize)]
struct Reference {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrMany {
    One(f64),
    Many(Vec<f64>),
}

#[derive(Deserialize)]
struct Case {
    name: String,
    dim: usize,
    inputs: Vec<f64>,
    targets: Vec<f64>,
    amplitude: f64,
    lengths: OneOrMany,
    noise: f64,
    log_marginal_likelihood: f64,
    at: Vec<f64>,
    mean: Vec<f64>,
    variance: Vec<f64>,
    exact_log_marginal_likelihood: f64,
    exact_mean: Vec<f64>,
}

/// Differences relative to the likelihood, the largest target, and amplitude².
const TOLERANCE: f64 = 1e-8;

/// Where the relative noise is below 1e-8, likelihood and mean are compared with 80-bit arithmetic instead: rounding, of order
/// ε √n / relative noise, puts scikit-learn itself off by up to 7e-8 (likelihood) and 2e-7 (mean).
const ILL_CONDITIONED: f64 = 1e-7;

#[test]
fn likelihood_mean_and_variance_agree_with_scikit_learn() {
    let reference: Reference =
        serde_json::from_str(include_str!("sklearn/reference.json")).expect("the reference is well formed");
    assert!(!reference.cases.is_empty());
    for case in reference.cases {
        let training = TrainingSet::new(case.dim, &case.inputs, &case.targets).expect("valid");
        let ill_conditioned = (case.noise / case.amplitude).powi(2) < 1e-8;
        let hyperparameters = Hyperparameters {
            amplitude: case.amplitude,
            lengths: match case.lengths {
                OneOrMany::One(length) => Lengths::Isotropic(length),
                OneOrMany::Many(lengths) => Lengths::PerInput(lengths),
            },
            noise: case.noise,
        };
        let gp = Gp::with_hyperparameters(&training, &hyperparameters).expect("valid");
        assert!(gp.conditioning().added == 0.0, "{}", case.name);
        let scale = case.targets.iter().fold(0.0_f64, |a, y| a.max(y.abs()));
        let off = |value: f64, reference: f64| (value / reference - 1.0).abs();
        let likelihood = off(gp.log_marginal_likelihood(), case.log_marginal_likelihood);
        let exact_likelihood = off(gp.log_marginal_likelihood(), case.exact_log_marginal_likelihood);
        let (mut mean, mut exact_mean, mut variance) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut workspace = Workspace::default();
        for (k, at) in case.at.chunks_exact(case.dim).enumerate() {
            let ours = gp.mean_and_variance(at, &mut workspace);
            assert_eq!(ours.0, gp.mean(at));
            mean = mean.max((ours.0 - case.mean[k]).abs() / scale);
            exact_mean = exact_mean.max((ours.0 - case.exact_mean[k]).abs() / scale);
            variance = variance.max((ours.1 - case.variance[k]).abs() / case.amplitude.powi(2));
        }
        println!(
            "{}: n {}, rank {}; off scikit-learn: likelihood {likelihood:.1e}, mean {mean:.1e}, variance {variance:.1e}; \
             off 80-bit: likelihood {exact_likelihood:.1e}, mean {exact_mean:.1e}",
            case.name,
            training.samples(),
            gp.rank()
        );
        if ill_conditioned {
            assert!(exact_likelihood < ILL_CONDITIONED);
            assert!(exact_mean < ILL_CONDITIONED);
            assert!(variance < ILL_CONDITIONED);
        } else {
            assert!(likelihood < TOLERANCE);
            assert!(mean < TOLERANCE);
            assert!(variance < TOLERANCE);
        }
    }
}
