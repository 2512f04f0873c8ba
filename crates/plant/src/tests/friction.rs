//! Dry friction on one joint against its closed-form solution; sticking and breaking away.

use crate::test_arms::{distance, puma, slider};
use crate::{Plant, PlantOptions};
use arm::Workspace;

/// The EMPS drive (Janot, Gautier and Brunot 2019): mass (kg), viscous (N s/m) and dry friction (N).
const MASS: f64 = 95.0;
const VISCOUS: f64 = 203.0;
const COULOMB: f64 = 20.0;

fn emps() -> Plant {
    let options = PlantOptions { viscous: vec![VISCOUS], coulomb: vec![COULOMB], ..PlantOptions::default() };
    Plant::new(&slider(), &options).unwrap()
}

/// The closed-form solution of m v̇ = F − F_v v − F_c sign v over `time` (s), from stop to stop.
fn exact(mut q: f64, mut v: f64, force: f64, mut time: f64) -> (f64, f64) {
    let rate = VISCOUS / MASS;
    loop {
        if v == 0.0 && force.abs() <= COULOMB {
            return (q, v);
        }
        let sign = if v == 0.0 { force.signum() } else { v.signum() };
        let steady = (force - sign * COULOMB) / VISCOUS;
        let stop = if sign * steady < 0.0 { ((steady - v) / steady).ln() / rate } else { f64::INFINITY };
        let until = time.min(stop);
        let decay = (-rate * until).exp();
        q += steady * until + (v - steady) / rate * (1.0 - decay);
        v = if stop <= time { 0.0 } else { steady + (v - steady) * decay };
        time -= until;
        if time <= 0.0 {
            return (q, v);
        }
    }
}

/// m v̇ = F − F_v v − F_c sign v, with ten reversals and ten stops, each within a step. A stop that is located at the
/// end of its step would cost 1e-7 m each time; measured: 5e-11 m after 5 s.
#[test]
fn a_drive_stops_and_reverses_as_the_closed_form() {
    let mut plant = emps();
    let (mut q, mut v) = (0.0, 0.5);
    plant.set_state(&[q], &[v]).unwrap();
    let (mut worst, mut rests): (f64, u32) = (0.0, 0);
    for i in 0..5000 {
        let force = 30.0 * (f64::from(i) * 6e-3).sin() + if i % 7 == 0 { 15.0 } else { 0.0 };
        (q, v) = exact(q, v, force, 1e-3);
        plant.step(&[force]).unwrap();
        worst = worst.max((plant.q()[0] - q).abs());
        rests += u32::from(v == 0.0);
        assert_eq!(plant.qd()[0] == 0.0, v == 0.0, "step {i}: {} and not {v}", plant.qd()[0]);
    }
    println!("{worst:e} m, {rests} rests");
    assert!(rests > 100 && worst < 1e-9, "{worst:e} m, {rests} rests");
}

/// A stuck joint does not creep: under 99 % of its level for 10 s, its position keeps all bits (rapier's own joint
/// friction creeps by 2.5e-3 rad). Under 101 % it moves from the first step on.
#[test]
fn a_stuck_joint_does_not_creep_and_breaks_away() {
    let mut plant = emps();
    plant.set_state(&[0.1], &[0.0]).unwrap();
    for _ in 0..10_000 {
        plant.step(&[0.99 * COULOMB]).unwrap();
    }
    assert_eq!((plant.q()[0], plant.qd()[0], plant.is_stuck(0)), (0.1, 0.0, true));
    plant.step(&[1.01 * COULOMB]).unwrap();
    let expected = exact(0.1, 0.0, 1.01 * COULOMB, 1e-3);
    assert!(!plant.is_stuck(0) && (plant.q()[0] - expected.0).abs() < 1e-15);
    assert!((plant.qd()[0] / expected.1 - 1.0).abs() < 1e-6);
}

/// An arm with all joints stuck remains at rest under gravity that its friction can hold; if the friction of one joint
/// is too small, that joint is released.
#[test]
fn friction_holds_an_arm_up() {
    let arm = puma();
    let start = [0.2, -0.4, 0.6, 0.3, 0.5, 0.1];
    let mut gravity = [0.0; 6];
    arm.gravity_torque(&mut Workspace::new(&arm), &start, &mut gravity);
    let mut levels: Vec<f64> = gravity.iter().map(|torque| 1.01 * torque.abs() + 20.0).collect();
    let run = |levels: &[f64]| {
        let options = PlantOptions { coulomb: levels.to_vec(), ..PlantOptions::default() };
        let mut plant = Plant::new(&arm, &options).unwrap();
        plant.set_state(&start, &[0.0; 6]).unwrap();
        for _ in 0..200 {
            plant.step(&[0.0; 6]).unwrap();
        }
        plant
    };
    let held = run(&levels);
    assert_eq!(held.q(), start);
    assert!((0..6).all(|i| held.is_stuck(i)));
    levels[1] = 0.9 * gravity[1].abs();
    let fallen = run(&levels);
    assert!((fallen.q()[1] - start[1]).abs() > 1e-3 && fallen.is_stuck(0), "{:?}", fallen.q());
}

/// Joints without dry friction are not affected by it, and friction with a level of zero has no effect.
#[test]
fn no_friction_is_no_friction() {
    let arm = puma();
    let run = |coulomb: Vec<f64>| {
        let options = PlantOptions { coulomb, ..PlantOptions::default() };
        let mut plant = Plant::new(&arm, &options).unwrap();
        plant.set_state(&[0.3; 6], &[0.0; 6]).unwrap();
        for _ in 0..100 {
            plant.step(&[0.0; 6]).unwrap();
        }
        plant.q().to_vec()
    };
    assert_eq!(run(vec![]), run(vec![0.0; 6]));
    // A level of 1e-9 N m has almost no effect, although events are located for it.
    let little = run(vec![1e-9; 6]);
    assert!(distance(&run(vec![]), &little) < 1e-6, "{little:?}");
}

/// Levels that are set later act as levels that are set at the beginning; impossible levels are refused.
#[test]
fn levels_may_change() {
    let arm = puma();
    let options = PlantOptions { coulomb: vec![2.0; 6], ..PlantOptions::default() };
    let mut at_first = Plant::new(&arm, &options).unwrap();
    let mut later = Plant::new(&arm, &PlantOptions::default()).unwrap();
    later.set_dry_friction(&[2.0; 6]).unwrap();
    for plant in [&mut at_first, &mut later] {
        plant.set_state(&[0.3; 6], &[0.1; 6]).unwrap();
        for _ in 0..100 {
            plant.step(&[0.0; 6]).unwrap();
        }
    }
    assert_eq!(at_first.q(), later.q());
    assert!(later.set_dry_friction(&[2.0; 5]).is_err());
    assert!(later.set_dry_friction(&[0.0, 0.0, -1.0, 0.0, 0.0, 0.0]).is_err());
}

/// Dry friction removes energy and never adds any, until all joints have stopped. The wrist, which is light and has a
/// thousand times the friction that its weight would need, stops and breaks away several times within some steps.
#[test]
fn a_swing_dies_out() {
    let arm = puma();
    let options = PlantOptions { coulomb: vec![3.0, 60.0, 20.0, 0.3, 0.3, 0.1], ..PlantOptions::default() };
    let mut plant = Plant::new(&arm, &options).unwrap();
    let mut workspace = Workspace::new(&arm);
    let mut energy = |plant: &Plant| {
        arm.kinetic_energy(&mut workspace, plant.q(), plant.qd()) + arm.potential_energy(&mut workspace, plant.q())
    };
    plant.set_state(&[0.3, 0.2, 0.7, 0.9, 1.1, 1.3], &[0.0, 1.0, 0.0, 2.0, -2.0, 3.0]).unwrap();
    let mut last = energy(&plant);
    for i in 0..4000 {
        plant.step(&[0.0; 6]).unwrap();
        let now = energy(&plant);
        assert!(now < last + 1e-6, "step {i}: {now} J after {last} J");
        last = now;
    }
    assert!((0..6).all(|i| plant.is_stuck(i)), "{:?}", plant.qd());
}
