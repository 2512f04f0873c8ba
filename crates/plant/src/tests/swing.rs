//! Free motion: accuracy by order, energy, and properties of a game engine that would spoil it.

use crate::test_arms::{Reference, distance, puma, skew, slider};
use crate::{Plant, PlantOptions};
use arm::{Arm, Workspace};

fn plant(arm: &Arm, order: usize) -> Plant {
    let options = PlantOptions { order, ..PlantOptions::default() };
    Plant::new(arm, &options).unwrap()
}

/// The error (rad) of 1 s of free motion from rest at 1 ms, relative to Runge-Kutta steps of 0.1 ms.
fn swing_error(arm: &Arm, order: usize) -> f64 {
    let n = arm.dof();
    let mut q: Vec<f64> = (0..n).map(|i| 0.3 + 0.2 * i as f64).collect();
    let (mut qd, tau) = (vec![0.0; n], vec![0.0; n]);
    let mut plant = plant(arm, order);
    plant.set_state(&q, &qd).unwrap();
    for _ in 0..1000 {
        plant.step(&tau).unwrap();
    }
    Reference::new(arm).run(&mut q, &mut qd, &tau, 1.0, 10_000);
    distance(plant.q(), &q)
}

/// Extrapolation of order k has an error of order stepᵏ: each order gains at least two digits. A state that is not
/// restored exactly, or a wrong weight, reduces the order to 1. Measured on the PUMA 560: 9.8e-2, 1.0e-3, 2.7e-7,
/// 7.7e-9 rad; with rotors of 0.5 kg m² 3.5e-3, 5.6e-6, 9.7e-9, 7.9e-12 rad.
#[test]
fn every_order_gains_two_digits() {
    let bounds = [2e-1, 2e-3, 1e-6, 5e-8];
    for (k, bound) in bounds.iter().enumerate() {
        let error = swing_error(&puma(), k + 1);
        println!("order {}: {error:e} rad", k + 1);
        assert!(error < *bound, "order {}: {error:e}", k + 1);
        let driven = puma().with_rotor_inertias(&[0.5; 6]);
        let error = swing_error(&driven, k + 1);
        println!("order {} with rotors: {error:e} rad", k + 1);
        assert!(error < bound * 0.2, "order {} with rotors: {error:e}", k + 1);
    }
}

/// The sum of kinetic and potential energy is constant without torques. A plain step loses joules of the 68 J in
/// motion, and rapier's default damping even more. Measured over 10 s: 9e-6 J.
#[test]
fn a_free_swing_keeps_its_energy() {
    let arm = puma();
    let mut plant = plant(&arm, 3);
    let mut workspace = Workspace::new(&arm);
    let mut energy = |plant: &Plant| {
        let kinetic = arm.kinetic_energy(&mut workspace, plant.q(), plant.qd());
        (kinetic, kinetic + arm.potential_energy(&mut workspace, plant.q()))
    };
    plant.set_state(&[0.3, 0.5, 0.7, 0.9, 1.1, 1.3], &[0.0; 6]).unwrap();
    let (_, start) = energy(&plant);
    let (mut drift, mut motion): (f64, f64) = (0.0, 0.0);
    for _ in 0..10_000 {
        plant.step(&[0.0; 6]).unwrap();
        let (kinetic, total) = energy(&plant);
        drift = drift.max((total - start).abs());
        motion = motion.max(kinetic);
    }
    println!("drift {drift:e} J of {motion} J");
    assert!(motion > 20.0 && drift < 1e-3, "{drift:e} J of {motion} J");
}

/// Under the gravity torques of its pose, the arm remains there (to 1e-9 rad), and after 10 s at rest a torque still
/// moves it: rapier puts a body at rest to sleep within 5 s, and it would ignore 20 N m.
#[test]
fn a_compensated_arm_holds_and_does_not_sleep() {
    let arm = puma();
    let mut plant = plant(&arm, 3);
    let mut workspace = Workspace::new(&arm);
    let start = [0.2, -0.4, 0.6, 0.3, 0.5, 0.1];
    let mut tau = [0.0; 6];
    plant.set_state(&start, &[0.0; 6]).unwrap();
    for _ in 0..10_000 {
        arm.gravity_torque(&mut workspace, plant.q(), &mut tau);
        plant.step(&tau).unwrap();
    }
    let held = distance(plant.q(), &start);
    assert!(held < 1e-9, "crept by {held:e} rad");
    tau[0] += 20.0;
    for _ in 0..100 {
        plant.step(&tau).unwrap();
    }
    assert!(plant.q()[0] - start[0] > 0.01, "asleep: {:?}", plant.q());
}

/// A revolute joint counts its turns; an angle computed from a rotation would be within ±π.
#[test]
fn positions_do_not_wrap() {
    let arm = skew().with_gravity(arm::Vector3::zeros());
    let mut plant = plant(&arm, 3);
    plant.set_state(&[0.0; 7], &[8.0, 0.0, 0.0, 0.0, 0.0, 0.0, -8.0]).unwrap();
    let (mut q, mut qd) = ([0.0; 7], [8.0, 0.0, 0.0, 0.0, 0.0, 0.0, -8.0]);
    Reference::new(&arm).run(&mut q, &mut qd, &[0.0; 7], 1.0, 10_000);
    for _ in 0..1000 {
        plant.step(&[0.0; 7]).unwrap();
    }
    assert!(q.iter().any(|q| q.abs() > 3.5), "the test should turn further: {q:?}");
    assert!(distance(plant.q(), &q) < 1e-4, "{:?} and not {q:?}", plant.q());
    plant.set_state(&[25.0; 7], &[0.0; 7]).unwrap();
    plant.step(&[0.0; 7]).unwrap();
    assert!((plant.q()[0] - 25.0).abs() < 0.1);
}

/// The same inputs give the same bits in a new plant, in one that was in another state before, and after a reset.
#[test]
fn runs_repeat_to_the_bit() {
    let arm = puma();
    let friction =
        PlantOptions { viscous: vec![1.0; 6], coulomb: vec![5.0, 5.0, 5.0, 0.0, 0.5, 0.5], ..PlantOptions::default() };
    for options in [PlantOptions::default(), friction] {
        let run = |plant: &mut Plant| {
            plant.set_state(&[0.1; 6], &[0.4; 6]).unwrap();
            for i in 0..300 {
                let swing = (f64::from(i) * 0.05).sin();
                plant.step(&[5.0 * swing; 6]).unwrap();
            }
            (plant.q().to_vec(), plant.qd().to_vec())
        };
        let mut plant = Plant::new(&arm, &options).unwrap();
        let first = run(&mut plant);
        assert_eq!(first, run(&mut plant));
        plant.reset();
        assert_eq!((plant.q(), plant.time()), ([0.0; 6].as_slice(), 0.0));
        assert_eq!(first, run(&mut plant));
        assert_eq!(first, run(&mut Plant::new(&arm, &options).unwrap()));
    }
}

/// v̇ = −(F_v/m) v. Stiff friction (a time constant of a tenth of the step) must decay and not diverge as with an
/// explicit step; with the friction of the EMPS drive (95 kg, 203 N s/m) the solution is exact to 4e-11 m. The time is
/// the number of steps times the step, without accumulated rounding.
#[test]
fn viscous_friction_is_accurate_and_stable() {
    for (friction, bound) in [(203.0, 1e-10), (95.0 / 0.02, 1e-7), (95.0 / 1e-4, 1e-3), (95.0 / 1e-7, 1e-3)] {
        let options = PlantOptions { viscous: vec![friction], ..PlantOptions::default() };
        let mut plant = Plant::new(&slider(), &options).unwrap();
        plant.set_state(&[0.0], &[0.5]).unwrap();
        let rate = friction / 95.0;
        let mut worst: f64 = 0.0;
        for i in 1..=500 {
            plant.step(&[0.0]).unwrap();
            let time = f64::from(i) * 1e-3;
            assert_eq!(plant.time(), time);
            worst = worst.max((plant.q()[0] - 0.5 / rate * (1.0 - (-rate * time).exp())).abs());
        }
        println!("F_v {friction:e}: {worst:e} m");
        assert!(worst < bound && plant.qd()[0].abs() < 0.5, "F_v {friction}: {worst:e} m");
    }
}
