//! The covariance against differences of the energies' covariance, gradients against differences, the mean against the covariance.

mod file;
mod fit;

use faer::Mat;

use super::contraction::Contraction;
use super::covariance::Covariance;
use super::samples::{Motions, Spread};
use super::*;

/// Numbers between −1 and 1, the same in every run.
fn numbers(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

const JOINTS: [JointType; 4] = [JointType::Revolute, JointType::Prismatic, JointType::Revolute, JointType::Revolute];

fn prior(dof: usize) -> LagrangianPrior {
    let positive =
        |count: usize, seed: u64| -> Vec<f64> { numbers(count, seed).iter().map(|x| (0.5 * x).exp()).collect() };
    let share = |seed: u64| numbers(dof, seed).iter().map(|x| 0.5 + 0.4 * x).collect();
    LagrangianPrior {
        kinetic: positive(dof * (dof + 1) / 2, 1),
        potential: positive(dof, 2),
        viscous: positive(dof, 10),
        coulomb: positive(dof, 11),
        kinetic_share: share(3),
        potential_share: share(4),
    }
}

fn samples(joints: &[JointType], count: usize) -> TorqueSamples {
    let dof = joints.len();
    let part = |seed: u64| numbers(count * dof, seed);
    let (q, qd, qdd, tau) = (part(5), part(6), part(7), part(8));
    TorqueSamples::new(joints, [&q, &qd, &qdd], &tau).expect("valid")
}

fn matrix(prior: &LagrangianPrior, units: &[f64], motions: &Motions) -> Mat<f64> {
    let n = motions.len() * units.len();
    let mut to = Mat::zeros(n, n);
    Covariance { prior, units, first: motions, second: motions, lower_only: false, to: to.as_mut() }.write();
    to
}

/// The covariance of the Lagrangians at two states, from the formula in [`LagrangianPrior`].
fn lagrangian(prior: &LagrangianPrior, scales: &[f64], a: [&[f64]; 2], b: [&[f64]; 2]) -> f64 {
    let mut total = 0.0;
    for i in 0..JOINTS.len() {
        let (mut s, mut g, mut h) = (0.0, 1.0, 1.0);
        for c in 0..=i {
            let kappa = match JOINTS[c] {
                JointType::Revolute => (a[0][c] - b[0][c]).cos(),
                JointType::Prismatic => a[0][c] * b[0][c] / (scales[c] * scales[c]),
            };
            let mixed = |share: f64| 1.0 - share + share * kappa;
            s += prior.kinetic[i * (i + 1) / 2 + c] * a[1][c] * b[1][c];
            g *= mixed(prior.kinetic_share[c]).powi(2);
            h *= mixed(prior.potential_share[c]);
        }
        total += s * s * g + prior.potential[i] * h;
    }
    total
}

/// d/dt ∂f/∂q̇_j − ∂f/∂q_j by central differences along the motion.
fn lagrange(f: &dyn Fn(&[f64], &[f64]) -> f64, [q, qd, qdd]: [&[f64]; 3], j: usize) -> f64 {
    let h = 2e-3;
    let moved = |values: &[f64], by: f64| {
        let mut values = values.to_vec();
        values[j] += by;
        values
    };
    let momentum = |t: f64| {
        let q: Vec<f64> = (0..q.len()).map(|c| q[c] + t * qd[c] + 0.5 * t * t * qdd[c]).collect();
        let qd: Vec<f64> = (0..q.len()).map(|c| qd[c] + t * qdd[c]).collect();
        (f(&q, &moved(&qd, h)) - f(&q, &moved(&qd, -h))) / (2.0 * h)
    };
    let force = (f(&moved(q, h), qd) - f(&moved(q, -h), qd)) / (2.0 * h);
    (momentum(h) - momentum(-h)) / (2.0 * h) - force
}

#[test]
fn the_covariance_is_that_of_lagranges_equations() {
    let (prior, samples) = (prior(4), samples(&JOINTS, 2));
    let scales = samples.scales();
    let motions = samples.motions(&scales);
    let k = matrix(&prior, &[1.0; 4], &motions);
    let row = |n: usize| -> [&[f64]; 3] { std::array::from_fn(|part| &samples.values[part][4 * n..4 * n + 4]) };
    let largest = (0..8).map(|at| k[(at, at)]).fold(0.0, f64::max);
    for (n, m) in [(0, 1), (0, 0)] {
        for j in 0..4 {
            for l in 0..4 {
                let inner = |q: &[f64], qd: &[f64]| {
                    let f = |q2: &[f64], qd2: &[f64]| lagrangian(&prior, &scales, [q, qd], [q2, qd2]);
                    lagrange(&f, row(m), l)
                };
                let mut expected = lagrange(&inner, row(n), j);
                if j == l {
                    let (p, p2) = (row(n)[1][j], row(m)[1][j]);
                    expected += prior.viscous[j] * p * p2 + prior.coulomb[j] * p.signum() * p2.signum();
                }
                let value = k[(motions.entry(n, j), motions.entry(m, l))];
                assert!((value - expected).abs() < 2e-4 * largest, "{n} {m} {j} {l}: {value} {expected}");
            }
        }
    }
}

#[test]
fn the_covariance_is_symmetric_and_positive() {
    let (prior, samples) = (prior(4), samples(&JOINTS, 21));
    let motions = samples.motions(&samples.scales());
    let k = matrix(&prior, &[1.0, 3.0, 0.2, 1.0], &motions);
    for row in 0..84 {
        for column in 0..84 {
            let difference = (k[(row, column)] - k[(column, row)]).abs();
            assert!(difference < 1e-13 * k[(row, row)].max(k[(column, column)]));
        }
    }
    let eigenvalues = k.self_adjoint_eigenvalues(faer::Side::Lower).expect("it converges");
    let (least, largest) = (eigenvalues[0], eigenvalues[83]);
    assert!(least > -1e-14 * largest && largest > 0.0, "{least} of {largest}");
}

#[test]
fn contracted_derivatives_are_those_of_differences() {
    let (prior, samples) = (prior(4), samples(&JOINTS, 13));
    let motions = samples.motions(&samples.scales());
    let units = [1.0, 3.0, 0.2, 1.0];
    let n = 52;
    let entries = numbers(n * n, 9);
    let weights = Mat::from_fn(n, n, |row, column| entries[row.max(column) * n + row.min(column)]);
    let gradient = Contraction { prior: &prior, units: &units, motions: &motions, weights: weights.as_ref() }.value();
    let value = |free: &[f64]| {
        let k = matrix(&LagrangianPrior::from_free(free, 4), &units, &motions);
        let pairs = (0..n * n).map(|at| k[(at / n, at % n)] * weights[(at / n, at % n)]);
        pairs.sum::<f64>()
    };
    let free = prior.to_free();
    assert_eq!(gradient.len(), free.len());
    let largest = gradient.iter().fold(0.0_f64, |most, by| most.max(by.abs()));
    for at in 0..free.len() {
        let h = 1e-4;
        let moved = |by: f64| {
            let mut free = free.clone();
            free[at] += by;
            value(&free)
        };
        let difference = (moved(h) - moved(-h)) / (2.0 * h);
        assert!((gradient[at] - difference).abs() < 1e-6 * largest, "{at}: {} {difference}", gradient[at]);
    }
}

/// The fast mean is the covariance times the weights.
#[test]
fn the_mean_is_the_covariance_times_the_weights() {
    let (prior, samples) = (prior(4), samples(&JOINTS, 21));
    let motions = samples.motions(&samples.scales());
    let k = matrix(&prior, &[1.0; 4], &motions);
    let alpha = numbers(84, 12);
    let weights = mean::Weights::new(&prior, &motions, &alpha);
    let mut scratch = mean::Scratch::new(4);
    let mut spread = Spread::new(4);
    for at in [0, 7, 8, 20] {
        motions.spread(at, &mut spread);
        let mut torques = [0.0; 4];
        mean::Mean {
            prior: &prior,
            motions: &motions,
            weights: &weights,
            at: &spread,
            scratch: &mut scratch,
            torques: &mut torques,
        }
        .write();
        for joint in 0..4 {
            let row = motions.entry(at, joint);
            let expected: f64 = (0..84).map(|column| k[(row, column)] * alpha[column]).sum();
            let most: f64 = (0..84).map(|column| (k[(row, column)] * alpha[column]).abs()).sum();
            assert!((torques[joint] - expected).abs() < 1e-13 * most, "{at} {joint}: {} {expected}", torques[joint]);
        }
    }
}
