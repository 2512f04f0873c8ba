//! rapier's accelerations equal those of the analytic forward dynamics; links that rapier cannot simulate are refused.

use crate::test_arms::{Random, Reference, distance, gantry, puma, read, skew};
use crate::{LARGEST_ORDER, Plant, PlantError, PlantOptions};
use arm::Arm;

/// The largest relative difference between the plant's accelerations and the analytic ones over random states.
fn acceleration_error(arm: &Arm, options: &PlantOptions) -> f64 {
    let n = arm.dof();
    let mut plant = Plant::new(arm, options).unwrap();
    let mut reference = Reference::new(arm);
    reference.viscous[..options.viscous.len()].copy_from_slice(&options.viscous);
    let mut random = Random(3);
    let mut worst: f64 = 0.0;
    for _ in 0..100 {
        let (q, qd, tau) = (random.vector(n, 3.0), random.vector(n, 2.0), random.vector(n, 40.0));
        let mut found = vec![0.0; n];
        plant.set_state(&q, &qd).unwrap();
        plant.accelerations(&tau, &mut found).unwrap();
        let expected = reference.accelerations(&q, &qd, &tau);
        let scale = expected.iter().fold(1.0_f64, |scale, qdd| scale.max(qdd.abs()));
        worst = worst.max(distance(&found, &expected) / scale);
    }
    worst
}

/// q̈ = M⁻¹ (τ − C q̇ − g). A wrong joint frame, inertial frame, gravity or torque gives a difference of order 1, a
/// rounded tensor one of 1e-8. Measured: 6e-15.
#[test]
fn accelerations_are_the_analytic_ones() {
    let drives = |arm: Arm| {
        let rotors: Vec<f64> = (0..arm.dof()).map(|i| 0.3 + 0.1 * i as f64).collect();
        arm.with_rotor_inertias(&rotors)
    };
    let tilted = puma().with_gravity(arm::Vector3::new(3.0, -2.0, 9.0));
    for arm in [puma(), skew(), gantry(), drives(skew()), drives(gantry()), tilted] {
        let error = acceleration_error(&arm, &PlantOptions::default());
        println!("{}: {error:e}", arm.name());
        assert!(error < 1e-9, "{}: {error:e}", arm.name());
        let viscous =
            PlantOptions { viscous: (0..arm.dof()).map(|i| 1.0 + i as f64).collect(), ..PlantOptions::default() };
        let error = acceleration_error(&arm, &viscous);
        assert!(error < 1e-9, "{} in oil: {error:e}", arm.name());
    }
}

/// The torque is applied without rounding: with a badly chosen K, a spring with the rest position τ/K loses 1e-6 of
/// the gravity torque of a light wrist. Without gravity and motion, q̈ must follow from τ alone, up to rounding, at
/// 1e-9 and at 1e6 N m.
#[test]
fn torques_are_exact() {
    let arm = puma().with_gravity(arm::Vector3::zeros());
    let mut plant = Plant::new(&arm, &PlantOptions::default()).unwrap();
    let mut qdd = [[0.0; 6]; 2];
    plant.accelerations(&[1e-9; 6], &mut qdd[0]).unwrap();
    plant.accelerations(&[1e6; 6], &mut qdd[1]).unwrap();
    for i in 0..6 {
        assert!((qdd[0][i] * 1e15 / qdd[1][i] - 1.0).abs() < 1e-6, "{qdd:?}");
    }
}

const LINK: &str = r#"<joint name="j1" type="continuous"><origin xyz="0 0 1" rpy="0.4 0.2 0"/><parent link="base"/><child link="l1"/><axis xyz="0.2 1 0"/></joint>
<link name="l1"><inertial><origin xyz="0 0 0"/><mass value="M1"/><inertia ixx="I1" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="I1"/></inertial></link>
<joint name="j2" type="KIND"><origin xyz="0.1 0 0.3" rpy="1 0.5 0.2"/><parent link="l1"/><child link="l2"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="0" velocity="0"/></joint>
<link name="l2"><inertial><origin xyz="0.1 0 0" rpy="0 0.6 0"/><mass value="M2"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="I2"/></inertial></link>
<joint name="j3" type="continuous"><origin xyz="0.3 0 0"/><parent link="l2"/><child link="l3"/><axis xyz="0 1 0.3"/></joint>
<link name="l3"><inertial><origin xyz="0.1 0 0.05"/><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.025"/></inertial></link>"#;

fn bare(m1: f64, i1: f64, m2: f64, i2: f64, kind: &str) -> Arm {
    let text = LINK.replace("M1", &m1.to_string()).replace("I1", &i1.to_string());
    let text = text.replace("M2", &m2.to_string()).replace("I2", &i2.to_string());
    let text = text.replace("KIND", kind);
    read(&format!("<robot name=\"bare\"><link name=\"base\"/>{text}</robot>"))
}

/// For a link without mass, without inertia tensor, or with a moment about one axis only, an equivalent body gives the
/// same motion. Without it, links of the last kind move wrongly, by 6e-3 on the PUMA 560.
#[test]
fn bare_links_move_rightly() {
    for (i, arm) in [
        bare(1.0, 0.2, 1.0, 0.02, "continuous"),
        bare(0.0, 0.0, 1.0, 0.02, "continuous"),
        bare(0.0, 0.2, 0.0, 0.0, "continuous"),
        bare(1.0, 0.2, 1.0, 0.0, "prismatic"),
        bare(1.0, 0.2, 1.0, 0.02, "prismatic"),
    ]
    .iter()
    .enumerate()
    {
        match acceleration_error(arm, &PlantOptions::default()) {
            error if error < 1e-9 => (),
            error => panic!("arm {i}: {error:e}"),
        }
    }
}

/// A link without an equivalent body is refused by name.
#[test]
fn what_rapier_cannot_simulate_is_refused() {
    // Slender along the axis of its own joint.
    let rod = r#"<robot name="rod"><link name="base"/>
<joint name="j1" type="continuous"><parent link="base"/><child link="shaft"/><axis xyz="0 0 1"/></joint>
<link name="shaft"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0"/></inertial></link></robot>"#;
    let error = Plant::new(&read(rod), &PlantOptions::default()).err().unwrap();
    assert!(matches!(&error, PlantError::Singular { link, .. } if link == "shaft"), "{error}");
    // The last link needs an inertia, unless its drive has a rotor.
    let tip = r#"<robot name="tip"><link name="base"/>
<joint name="j1" type="continuous"><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/></joint>
<link name="l1"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="j2" type="continuous"><parent link="l1"/><child link="l2"/><axis xyz="1 0 0"/></joint><link name="l2"/></robot>"#;
    let error = Plant::new(&read(tip), &PlantOptions::default()).err().unwrap();
    assert!(matches!(&error, PlantError::Massless { joint } if joint == "j2"), "{error}");
    let driven = read(tip).with_rotor_inertias(&[0.0, 0.1]);
    assert!(acceleration_error(&driven, &PlantOptions::default()) < 1e-9);
}

#[test]
fn bad_options_and_vectors_are_refused() {
    let arm = puma();
    let refuse = |options: PlantOptions| Plant::new(&arm, &options).err().unwrap().to_string();
    let default = PlantOptions::default;
    assert!(refuse(PlantOptions { step: 0.0, ..default() }).contains("step is 0 s"));
    assert!(refuse(PlantOptions { step: f64::NAN, ..default() }).contains("step is NaN"));
    assert!(refuse(PlantOptions { order: 0, ..default() }).contains("give 1 to 8"));
    assert!(refuse(PlantOptions { order: LARGEST_ORDER + 1, ..default() }).contains("order is 9"));
    assert!(refuse(PlantOptions { viscous: vec![1.0; 5], ..default() }).contains("5 values"));
    let coulomb = vec![0.0, 0.0, -1.0, 0.0, 0.0, 0.0];
    assert!(refuse(PlantOptions { coulomb, ..default() }).contains("\"joint3\" is -1"));
    assert!(refuse(PlantOptions { viscous: vec![f64::NAN; 6], ..default() }).contains("\"joint1\" is NaN"));
    let driven = arm.clone().with_rotor_inertias(&[-1.0; 6]);
    assert!(matches!(Plant::new(&driven, &default()), Err(PlantError::Value { .. })));

    let mut plant = Plant::new(&arm, &default()).unwrap();
    assert!(matches!(plant.step(&[0.0; 5]), Err(PlantError::Count { .. })));
    assert!(matches!(plant.set_state(&[f64::NAN; 6], &[0.0; 6]), Err(PlantError::Diverged { .. })));
    let mut tau = [0.0; 6];
    tau[4] = f64::NAN;
    assert!(matches!(plant.step(&tau), Err(PlantError::Diverged { .. })));
    tau[4] = f64::INFINITY;
    assert!(matches!(plant.step(&tau), Err(PlantError::Diverged { .. })));
    // A refused step does not change the state.
    let mut fresh = Plant::new(&arm, &default()).unwrap();
    plant.step(&[1.0; 6]).unwrap();
    fresh.step(&[1.0; 6]).unwrap();
    assert_eq!((plant.q(), plant.qd(), plant.time()), (fresh.q(), fresh.qd(), fresh.time()));
}
