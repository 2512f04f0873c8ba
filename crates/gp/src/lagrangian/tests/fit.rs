//! Fits, posteriors and ranges: against dense formulas, against the reference implementation, and the refusals.

use super::super::likelihood::Objective;
use super::*;
use crate::climb::Likelihood;
use crate::starts::Bounds;

/// Motion and torques of a double pendulum (masses, lengths and gravity of order one) along two sines a joint; with friction on the
/// first joint, and noise.
pub(super) fn pendulum(count: usize, hertz: f64, friction: f64, noise: f64) -> TorqueSamples {
    let (mut q, mut qd, mut qdd, mut tau) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let random = numbers(2 * count, 77);
    for k in 0..count {
        let time = 10.0 * k as f64 / count as f64;
        let mut motion = [[0.0; 2]; 3];
        for joint in 0..2 {
            for (amplitude, factor) in [(0.9, 1.0), (0.4, 2.3)] {
                let omega = std::f64::consts::TAU * hertz * factor * (1.0 + 0.3 * joint as f64);
                let (sin, cos) = (omega * time + joint as f64).sin_cos();
                motion[0][joint] += amplitude * sin;
                motion[1][joint] += amplitude * omega * cos;
                motion[2][joint] -= amplitude * omega * omega * sin;
            }
        }
        let [[q1, q2], [p1, p2], [a1, a2]] = motion;
        let (sin, cos) = q2.sin_cos();
        let (first, second) = (8.0 * q1.cos(), 3.0 * (q1 + q2).cos());
        let coriolis = 0.6 * sin;
        let of_first =
            (2.0 + 1.2 * cos) * a1 + (0.4 + 0.6 * cos) * a2 - coriolis * p2 * (2.0 * p1 + p2) + first + second;
        let of_second = (0.4 + 0.6 * cos) * a1 + 0.4 * a2 + coriolis * p1 * p1 + second;
        tau.push(of_first + friction * (p1 + 2.0 * p1.signum()) + noise * random[2 * k]);
        tau.push(of_second + noise * random[2 * k + 1]);
        for (column, values) in [&mut q, &mut qd, &mut qdd].into_iter().zip(motion) {
            column.extend(values);
        }
    }
    TorqueSamples::new(&[JointType::Revolute; 2], [&q, &qd, &qdd], &tau).expect("valid")
}

pub(super) fn options(support: usize) -> LagrangianOptions {
    LagrangianOptions { support, ..LagrangianOptions::default() }
}

/// The RMS error of each joint's torque on `tests`, as a part of the RMS torque.
fn errors(gp: &LagrangianGp, tests: &TorqueSamples) -> Vec<f64> {
    let dof = tests.dof();
    let mut workspace = gp.workspace();
    let mut torques = vec![0.0; dof];
    let mut squares = vec![0.0; dof];
    for k in 0..tests.len() {
        let [q, qd, qdd, tau] = tests.values.each_ref().map(|values| &values[k * dof..(k + 1) * dof]);
        gp.mean([q, qd, qdd], &mut workspace, &mut torques);
        for joint in 0..dof {
            squares[joint] += (torques[joint] - tau[joint]).powi(2) / tests.len() as f64;
        }
    }
    let unit = |joint: usize| tests.root_mean_square(3, joint);
    squares.iter().enumerate().map(|(joint, square)| square.sqrt() / unit(joint)).collect()
}

#[test]
fn the_likelihoods_gradient_is_that_of_differences() {
    let samples = samples(&JOINTS, 11);
    let units = [0.5, 0.7, 0.4, 0.6];
    let mut free = prior(4).to_free();
    free.extend([0.01_f64, 0.1, 0.03, 0.2].map(f64::ln));
    let bounds = Bounds::of_logs(free.iter().map(|x| (x - 6.0, x + 7.0)));
    let free = bounds.free_from_log(&free);
    let objective = Objective::new(&samples, &samples.scales(), &units, &bounds);
    let (value, gradient) = objective.value_and_gradient(&free).expect("it is finite");
    assert_eq!(value, objective.value(&free));
    let largest = gradient.iter().fold(0.0_f64, |most, by| most.max(by.abs()));
    for at in 0..free.len() {
        let moved = |by: f64| {
            let mut free = free.clone();
            free[at] += by;
            objective.value(&free)
        };
        let difference = (moved(1e-4) - moved(-1e-4)) / 2e-4;
        assert!((gradient[at] - difference).abs() < 1e-6 * largest, "{at}: {} {difference}", gradient[at]);
    }
}

#[test]
fn a_pendulum_is_learned_from_one_motion_for_another() {
    let gp = LagrangianGp::fit(&pendulum(200, 0.3, 0.0, 0.0), &options(60)).expect("it fits");
    let error = errors(&gp, &pendulum(50, 0.2, 0.0, 0.0));
    assert!(error.iter().all(|error| *error < 1e-5), "{error:?}");
    assert_eq!(gp.conditioning().samples, 60);
    let gp = LagrangianGp::fit(&pendulum(200, 0.3, 0.5, 0.0), &options(60)).expect("it fits");
    let error = errors(&gp, &pendulum(50, 0.2, 0.5, 0.0));
    assert!(error.iter().all(|error| *error < 1e-4), "with friction {error:?}");
}

/// With noise, all samples determine the posterior, not only its support; and the noise is found.
#[test]
fn noise_is_found_and_averaged() {
    let deviation = 0.3 / 3.0_f64.sqrt();
    let noisy = pendulum(1500, 0.3, 0.0, 0.3);
    let gp = LagrangianGp::fit(&noisy, &options(40)).expect("it fits");
    assert_eq!((gp.conditioning().samples, gp.conditioning().support), (1500, 40));
    for noise in gp.noise() {
        assert!((noise / deviation - 1.0).abs() < 0.2, "{:?}", gp.noise());
    }
    let tests = pendulum(50, 0.25, 0.0, 0.0);
    let few = LagrangianGp::fit(&noisy.thinned(40), &options(40)).expect("it fits");
    let (all, few) = (errors(&gp, &tests), errors(&few, &tests));
    for joint in 0..2 {
        assert!(all[joint] < 0.5 * few[joint], "{all:?} of all, {few:?} of 40");
    }
}

/// The same function in other units of torque, to the accuracy of the fit.
#[test]
fn units_of_torque_are_of_no_account() {
    let samples = pendulum(60, 0.3, 0.0, 0.0);
    let scaled = |factor: f64| {
        let mut samples = samples.clone();
        samples.values[3].iter_mut().for_each(|tau| *tau *= factor);
        LagrangianGp::fit(&samples, &options(60)).expect("it fits")
    };
    let gp = scaled(1.0);
    let motion: [&[f64]; 3] = [&[0.3, -0.4], &[1.0, 0.7], &[-2.0, 3.0]];
    let mean = |gp: &LagrangianGp| {
        let mut torques = [0.0; 2];
        gp.mean(motion, &mut gp.workspace(), &mut torques);
        torques
    };
    assert!(errors(&gp, &pendulum(50, 0.2, 0.0, 0.0)).iter().all(|error| *error < 1e-5));
    for factor in [4.0, 1000.0 / 3.0, 1e-6] {
        for (one, other) in mean(&gp).into_iter().zip(mean(&scaled(factor))) {
            assert!((one * factor / other - 1.0).abs() < 1e-5, "{factor}: {one} {other}");
        }
    }
}

/// Mean and variance are those of the dense formulas, without noise and with it; the range bounds the variance from above.
#[test]
fn the_posterior_is_that_of_the_dense_formulas() {
    for noise in [0.0, 0.3] {
        let samples = pendulum(40, 0.3, 0.2, noise);
        let gp = LagrangianGp::fit(&samples, &options(40)).expect("it fits");
        let motions = samples.motions(&samples.scales());
        let ones = [1.0; 2];
        let mut k = matrix(gp.prior(), &ones, &motions);
        for at in 0..40 {
            for joint in 0..2 {
                let at = motions.entry(at, joint);
                k[(at, at)] += gp.noise()[joint].powi(2);
            }
        }
        use faer::linalg::solvers::Solve;
        let solver = k.llt(faer::Side::Lower).expect("it is positive definite");
        let targets = samples.targets(&motions, &ones);
        let weights = solver.solve(faer::ColRef::from_slice(&targets).as_mat());
        let range = gp.range();
        let mut workspace = gp.workspace();
        let typical = |joint: usize| {
            let k = matrix(gp.prior(), &ones, &motions);
            (0..40).map(|at| k[(motions.entry(at, joint), motions.entry(at, joint))]).sum::<f64>() / 40.0
        };
        for speed in [1.0, 3.0, 30.0] {
            let (q, qd, qdd) = ([0.5, 2.0], [0.8 * speed, 0.1], [1.0, -speed]);
            let motion: [&[f64]; 3] = [&q, &qd, &qdd];
            let other = Motions::new(motions.joints(), motions.scales(), motion);
            let mut cross = Mat::zeros(80, 2);
            Covariance {
                prior: gp.prior(),
                units: &ones,
                first: &motions,
                second: &other,
                lower_only: false,
                to: cross.as_mut(),
            }
            .write();
            let known = cross.transpose() * solver.solve(&cross);
            let mean = cross.transpose() * &weights;
            let own = matrix(gp.prior(), &ones, &other);
            let (mut torques, mut variances) = ([0.0; 2], [0.0; 2]);
            gp.variance(motion, &mut workspace, &mut variances);
            gp.mean(motion, &mut workspace, &mut torques);
            for joint in 0..2 {
                let whole = own[(joint, joint)];
                let exact = whole - known[(joint, joint)];
                assert!((torques[joint] - mean[(joint, 0)]).abs() < 1e-5 * whole.sqrt(), "{noise} {speed}");
                assert!(
                    (variances[joint] - exact).abs() < 1e-9 * whole + 1e-4 * exact,
                    "{noise} {speed} {joint}: {} {exact}",
                    variances[joint]
                );
                let share = range.variance_share(joint, &mut workspace);
                let exact_share = exact / whole.max(typical(joint));
                assert!(share > exact_share * (1.0 - 1e-3) - 1e-9 && share <= 1.0, "{share} {exact_share}");
            }
        }
        assert!((0..2).all(|joint| range.mean_variance_share(joint) < 0.05), "{range:?}");
        gp.mean([&[f64::NAN, 0.0], &[0.0; 2], &[0.0; 2]], &mut workspace, &mut [0.0; 2]);
        assert!(range.variance_share(1, &mut workspace).is_nan());
    }
}

/// The covariance and the predictions of the implementation in benches/models, whose figures tests/lagrangian/reference.py wrote.
#[test]
fn the_reference_implementation_agrees() {
    let text = include_str!("../../../tests/lagrangian/reference.json");
    let reference: serde_json::Value = serde_json::from_str(text).expect("it is JSON");
    let list = |value: &serde_json::Value| -> Vec<f64> {
        let list = value.as_array().expect("a list").iter();
        list.map(|number| number.as_f64().expect("a number")).collect()
    };
    let part = |key: &str| list(&reference[key]);
    let prior = LagrangianPrior {
        kinetic: part("kinetic"),
        potential: part("potential"),
        kinetic_share: part("kinetic_share"),
        potential_share: part("potential_share"),
        viscous: vec![0.0; 3],
        coulomb: vec![0.0; 3],
    };
    let joints = [JointType::Revolute; 3];
    let motion: Vec<Vec<f64>> = (0..3).map(|part| list(&reference["motion"][part])).collect();
    let train: Vec<&[f64]> = motion.iter().map(|part| &part[..21]).collect();
    let samples = TorqueSamples::new(&joints, [train[0], train[1], train[2]], &part("torques")).expect("valid");
    let motions = samples.motions(&[1.0; 3]);
    let k = matrix(&prior, &[1.0; 3], &motions);
    for (at, expected) in part("covariance").iter().enumerate() {
        let value = k[(motions.entry(0, at / 3), motions.entry(1, at % 3))];
        assert!((value - expected).abs() < 1e-10 * k[(0, 0)], "{at}: {value} {expected}");
    }
    let noise = reference["noise"].as_f64().expect("a number");
    let rho = vec![noise; 3];
    let scales = [1.0; 3];
    // Noise is there, but the support is all there is: both ways to the posterior must agree with the reference.
    let gp =
        LagrangianGp::condition(&samples, &scales, &part("units"), prior, rho, &options(7)).expect("it conditions");
    let predicted = part("predicted");
    let mut torques = [0.0; 3];
    for test in 0..2 {
        let row: Vec<&[f64]> = motion.iter().map(|part| &part[21 + 3 * test..24 + 3 * test]).collect();
        gp.mean([row[0], row[1], row[2]], &mut gp.workspace(), &mut torques);
        for joint in 0..3 {
            let expected = predicted[3 * test + joint];
            assert!(
                (torques[joint] - expected).abs() < 1e-6 * expected.abs().max(1.0),
                "{test} {joint}: {} {expected}",
                torques[joint]
            );
        }
    }
}

#[test]
fn what_cannot_be_learned_is_refused() {
    let new = |values: [&[f64]; 4]| TorqueSamples::new(&JOINTS[..2], [values[0], values[1], values[2]], values[3]);
    let two: &[f64] = &[0.0, 1.0];
    assert!(matches!(new([&[]; 4]), Err(GpError::Empty { samples: 0, dim: 6 })));
    assert!(matches!(new([two, two, &[0.0], two]), Err(GpError::Shape { values: 1, .. })));
    let bad = new([two, two, &[0.0, f64::NAN], two]);
    assert!(matches!(bad, Err(GpError::Input { row: 0, column: 5, .. })));
    let bad = new([two, two, two, &[f64::INFINITY, 0.0]]);
    assert!(matches!(bad, Err(GpError::Target { row: 0, .. })));
    let samples = pendulum(10, 0.3, 0.0, 0.0);
    let none = LagrangianOptions { starts: 0, ..LagrangianOptions::default() };
    let message = LagrangianGp::fit(&samples, &none).expect_err("it is refused").to_string();
    assert_eq!(message, "starts is 0: it must be at least 1");
}

/// A workspace may be used with one model after the other, also where positions have other scales or joints are fewer.
#[test]
fn workspaces_can_be_shared() {
    let options = LagrangianOptions { starts: 1, max_iterations: 5, ..options(20) };
    let fit = |samples: &TorqueSamples| LagrangianGp::fit(samples, &options).expect("it fits");
    let wide = {
        let mut samples = samples(&JOINTS, 20);
        samples.values[0].iter_mut().for_each(|q| *q *= 3.0);
        samples
    };
    let models = [fit(&samples(&JOINTS, 20)), fit(&wide), fit(&pendulum(20, 0.3, 0.0, 0.0))];
    let mut shared = models[0].workspace();
    for gp in models.iter().chain(&models) {
        let dof = gp.dof();
        let motion: [&[f64]; 3] = [&[0.4, -0.1, 0.9, 0.2][..dof]; 3];
        let (mut own, mut with_shared) = (vec![0.0; dof], vec![1.0; dof]);
        gp.mean(motion, &mut gp.workspace(), &mut own);
        gp.mean(motion, &mut shared, &mut with_shared);
        assert_eq!(own, with_shared);
    }
}

/// Torques that are all zero have neither mean nor variance; one sample is enough to learn from.
#[test]
fn nothing_and_little_are_learned() {
    let motion = [0.1, 0.2, 0.3, 0.4];
    let samples = |tau: f64| TorqueSamples::new(&JOINTS, [&motion; 3], &[tau; 4]).expect("valid");
    for tau in [0.0, 2.0] {
        let gp = LagrangianGp::fit(&samples(tau), &LagrangianOptions::default()).expect("it fits");
        let (mut torques, mut variances) = ([1.0; 4], [1.0; 4]);
        let mut workspace = gp.workspace();
        gp.variance([&motion; 3], &mut workspace, &mut variances);
        gp.mean([&motion; 3], &mut workspace, &mut torques);
        for joint in 0..4 {
            assert!((torques[joint] - tau).abs() <= 0.05 * tau, "{tau}: {torques:?}");
            assert!(variances[joint] >= 0.0 && (tau > 0.0 || variances[joint] == 0.0));
            assert!(gp.range().variance_share(joint, &mut workspace) <= 1.0);
        }
    }
}
