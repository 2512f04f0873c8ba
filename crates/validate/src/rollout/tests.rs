//! Rollouts of recordings that the plant itself made.

use super::*;
use effects::friction::{COULOMB_FRICTION, VISCOUS_FRICTION};
use effects::sensor::{ENCODER_OFFSET, TORQUE_OFFSET, TORQUE_SCALE};
use plant::{Plant, PlantOptions};
use recording::Recording;
use torque::Corrected;

fn puma() -> Arm {
    Arm::from_urdf_text(include_str!("../../../../assets/puma560.urdf"), "puma560.urdf").expect("it is an arm")
}

/// Records `seconds` of the plant of `arm` with viscous and dry friction, held near slow sines by a stiff loop, at 250 Hz;
/// `distort` gives the recorded torque and position.
fn record(
    arm: &Arm,
    viscous: f64,
    coulomb: f64,
    seconds: f64,
    distort: impl Fn(usize, f64, f64) -> (f64, f64),
) -> RegularRecording {
    let dof = arm.dof();
    let options = PlantOptions { step: 1e-3, order: 2, viscous: vec![viscous; dof], coulomb: vec![coulomb; dof] };
    let mut plant = Plant::new(arm, &options).expect("it can be simulated");
    let reference = |j: usize, t: f64| {
        let omega = 1.3 + 0.4 * j as f64;
        (0.5 * (omega * t).sin(), 0.5 * omega * (omega * t).cos())
    };
    let (q0, qd0): (Vec<f64>, Vec<f64>) = (0..dof).map(|j| reference(j, 0.0)).unzip();
    plant.set_state(&q0, &qd0).expect("it is a state");
    let mut recording = Recording {
        joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
        q: vec![Vec::new(); dof],
        tau: vec![Vec::new(); dof],
        ..Recording::default()
    };
    let mut scratch = arm::Workspace::new(arm);
    let mut tau = vec![0.0; dof];
    let mut wanted = vec![0.0; dof];
    for k in 0..(seconds * 1e3) as usize {
        let time = plant.time();
        for j in 0..dof {
            let (q, qd) = reference(j, time);
            wanted[j] = 900.0 * (q - plant.q()[j]) + 60.0 * (qd - plant.qd()[j]);
        }
        arm.inverse_dynamics(&mut scratch, plant.q(), plant.qd(), &wanted, &mut tau);
        if k % 4 == 0 {
            recording.time.push(time);
            for j in 0..dof {
                let (torque, q) = distort(j, tau[j], plant.q()[j]);
                recording.q[j].push(q);
                recording.tau[j].push(torque);
            }
        }
        plant.step(&tau).expect("it holds");
    }
    recording.regular().expect("it has a clock").0
}

fn as_it_is(_: usize, tau: f64, q: f64) -> (f64, f64) {
    (tau, q)
}

fn every_joint(arm: &Arm, effect: impl Fn(String) -> Effect) -> Vec<Effect> {
    arm.joints().iter().map(|joint| effect(joint.name.clone())).collect()
}

#[track_caller]
fn assert_better(result: &Rollout, joints: std::ops::Range<usize>, factor: f64) {
    println!("{:?} {:?}", result.joints, result.remarks);
    for joint in &result.joints[joints] {
        assert!(joint.augmented_rms_rad * factor < joint.nominal_rms_rad, "{:?}", result.joints);
    }
    assert_eq!(result.runaway_augmented, 0);
}

#[test]
fn named_friction_and_payload_are_simulated() {
    let nominal = puma();
    let mut effects = every_joint(&nominal, |joint| Effect::of(&VISCOUS_FRICTION).on(joint).with("coefficient", 0.8));
    effects.extend(every_joint(&nominal, |joint| Effect::of(&COULOMB_FRICTION).on(joint).with("level", 0.6)));
    effects.push(
        Effect::of(&PAYLOAD)
            .with("mass", 2.0)
            .with("com", [0.0, 0.0, 0.1])
            .with("inertia", [0.01, 0.0, 0.01, 0.0, 0.0, 0.01]),
    );
    let truth = Corrected::new(&nominal, &effects).expect("they are physical").arm().clone();
    let recording = record(&truth, 0.8, 0.6, 6.0, as_it_is);
    let started = std::time::Instant::now();
    let result = rollout(&nominal, &[], &effects, &recording, &RolloutOptions::default()).expect("it runs");
    println!("{:.3} s for {} windows", started.elapsed().as_secs_f64(), result.windows.len());
    assert_better(&result, 0..6, 5.0);
    let again = rollout(&nominal, &[], &effects, &recording, &RolloutOptions::default()).expect("it runs");
    for (again, first) in again.windows.iter().zip(&result.windows) {
        assert_eq!(again.augmented, first.augmented);
    }
    let window = &result.windows[0];
    assert_eq!(window.measured[5].len(), window.augmented[5].len());
}

#[test]
fn effects_of_drives_and_encoders_are_simulated() {
    let arm = puma();
    let name = |j: usize| arm.joints()[j].name.clone();
    let effects = [
        Effect::of(&TORQUE_SCALE).on(name(1)).with("factor", 1.15),
        Effect::of(&ENCODER_OFFSET).on(name(2)).with("offset", -0.1),
        Effect::of(&TORQUE_OFFSET).on(name(0)).with("offset", 3.0),
    ];
    let recording = record(&arm, 0.0, 0.0, 5.0, |j, tau, q| match j {
        0 => (tau + 3.0, q),
        1 => (1.15 * tau, q),
        2 => (tau, q - 0.1),
        _ => (tau, q),
    });
    let result = rollout(&arm, &[], &effects, &recording, &RolloutOptions::default()).expect("it runs");
    assert_better(&result, 0..3, 10.0);
}

#[test]
fn windows_that_cannot_be_simulated_are_reported() {
    let arm = puma();
    let mut recording = record(&arm, 0.0, 0.0, 1.0, as_it_is);
    let options = RolloutOptions { window: 5.0, ..RolloutOptions::default() };
    let error = rollout(&arm, &[], &[], &recording, &options).expect_err("it is too short").to_string();
    assert!(error.contains("no gap-free part"), "{error}");
    // Torques unlike the robot's: both variants leave the windows and report it.
    for tau in &mut recording.tau {
        tau.fill(500.0);
    }
    let result = rollout(&arm, &[], &[], &recording, &RolloutOptions::default()).expect("it runs");
    assert!(result.runaway_nominal > 0 && result.runaway_augmented == result.runaway_nominal);
    assert!(result.joints.iter().all(|joint| joint.nominal_rms_rad.is_finite()));
    for tau in &mut recording.tau {
        tau.fill(5000.0);
    }
    let error = rollout(&arm, &[], &[], &recording, &RolloutOptions::default())
        .expect_err("nothing can be compared")
        .to_string();
    assert!(error.contains("within one step"), "{error}");
    recording.joints[0] = "other".into();
    let error = rollout(&arm, &[], &[], &recording, &RolloutOptions::default()).expect_err("a joint lacks").to_string();
    assert!(error.contains("is not in the recording"), "{error}");
}

/// A guided joint stays on its recorded path whatever its torque is, and the others move as if it did.
#[test]
fn a_guided_joint_follows_its_recorded_path() {
    let arm = puma();
    let recording = record(&arm, 0.0, 0.0, 3.0, |j, tau, q| (if j == 5 { 20.0 } else { tau }, q));
    let free = rollout(&arm, &[], &[], &recording, &RolloutOptions::default()).expect("it runs");
    assert!(free.joints[5].nominal_rms_rad > 1.0, "{:?}", free.joints);
    let options = RolloutOptions { guided: vec![false, false, false, false, false, true], ..RolloutOptions::default() };
    let guided = rollout(&arm, &[], &[], &recording, &options).expect("it runs");
    assert_eq!(guided.runaway_nominal, 0);
    let farthest = guided.joints.iter().map(|joint| joint.nominal_rms_rad);
    assert!(farthest.fold(0.0, f64::max) < 2e-3, "{:?}", guided.joints);
}
