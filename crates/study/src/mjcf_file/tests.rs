//! The MJCF equals the corrected model, also in MuJoCo.

use std::fmt::Write as _;
use std::process::Command;

use effects::arm::{GRAVITY_MISALIGNMENT, INERTIAL_SCALE, link_effect};
use effects::drive::ROTOR_INERTIA;
use effects::friction::{COULOMB_FRICTION, FRICTION_ASYMMETRY, VISCOUS_FRICTION};
use effects::sensor::{ENCODER_OFFSET, TORQUE_OFFSET};
use torque::{Prediction, TorqueModel, Workspace};

use arm::Matrix3;

use super::*;

const PUMA: &str = include_str!("../../../../assets/puma560.urdf");
const SEVEN: &str = include_str!("../../../arm/tests/robots/seven_axis.urdf");
const PRISMATIC: &str = include_str!("../../../arm/tests/robots/prismatic.urdf");

fn read(urdf: &str) -> Arm {
    Arm::from_urdf_text(urdf, "test.urdf").expect("it is an arm")
}

/// All effects that MJCF can hold, each on a joint.
fn held(arm: &Arm) -> Vec<Effect> {
    let name = |j: usize| arm.joints()[j % arm.dof()].name.clone();
    let body = Inertia {
        mass: 1.5,
        com: [0.02, -0.03, 0.1].into(),
        tensor: Matrix3::new(0.03, 0.001, 0.0, 0.001, 0.04, 0.002, 0.0, 0.002, 0.02),
    };
    vec![
        Effect::of(&INERTIAL_SCALE).with("factor", 1.1),
        link_effect(name(2), &body),
        Effect::of(&VISCOUS_FRICTION).on(name(0)).with("coefficient", 3.5),
        Effect::of(&VISCOUS_FRICTION).on(name(1)).with("coefficient", 0.25),
        Effect::of(&COULOMB_FRICTION).on(name(1)).with("level", 1.25),
        Effect::of(&COULOMB_FRICTION).on(name(0)).with("level", 0.5),
        Effect::of(&ROTOR_INERTIA).on(name(1)).with("inertia", 0.75),
        Effect::of(&SPRING).on(name(0)).with("stiffness", 20.0).with("rest", 0.3),
        Effect::of(&SPRING).on(name(0)).with("stiffness", 5.0).with("rest", -0.7),
        Effect::of(&ENCODER_OFFSET).on(name(1)).with("offset", 0.05),
        Effect::of(&GRAVITY_MISALIGNMENT).with("angle", 0.1).with("axis", [0.6, 0.8, 0.0]),
        Effect::of(&PAYLOAD)
            .with("mass", 2.0)
            .with("com", [0.01, 0.02, 0.1])
            .with("inertia", [0.01, 0.001, 0.012, 0.0, 0.0, 0.008]),
    ]
}

#[test]
fn what_mjcf_cannot_hold_is_listed() {
    let arm = read(SEVEN);
    let joint = arm.joints()[0].name.clone();
    let mut effects = held(&arm);
    let Export { text, omitted } = mjcf(&arm, &effects).expect("it is written");
    assert_eq!(omitted, ["shapes and meshes of the links"]);
    for part in
        ["<body name=\"payload\"", "stiffness=\"25\"", "springref=\"0.1", "armature=\"0.75\"", "frictionloss=\"1.25\""]
    {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    effects.push(Effect::of(&TORQUE_OFFSET).on(&joint).with("offset", 0.5));
    effects.push(
        Effect::of(&FRICTION_ASYMMETRY).on(arm.joints()[3].name.clone()).with("positive", 3.0).with("negative", 1.0),
    );
    effects.push(Effect::of(&PAYLOAD).with("mass", 1.0).with("com", [0.0; 3]).since(Some(2.0)));
    let Export { text, omitted } = mjcf(&arm, &effects).expect("it is written");
    for (line, start) in
        omitted.iter().zip(["torque_offset of ", "friction_asymmetry of axis4 (the diff", "payload: mass 1.000 kg"])
    {
        assert!(line.starts_with(start) && text.contains(line.as_str()), "{line}");
    }
    assert_eq!(omitted.len(), 4);
    assert!(text.contains("frictionloss=\"2\""), "{text}");
    // A tool that is not mounted is a body of negative mass, in the last link.
    let less = [Effect::of(&PAYLOAD).with("mass", -0.1).with("com", [0.0; 3])];
    let text = mjcf(&arm, &less).expect("it is written").text;
    assert!(!text.contains("\"payload\""), "{text}");
}

#[test]
fn an_impossible_tensor_is_replaced_by_the_nearest_and_reported() {
    let omitted = mjcf(&read(PUMA), &[]).expect("it is written").omitted;
    assert!(omitted[0].contains("link \"link3\"") && omitted.len() == 2, "{omitted:?}");
    let flat = Inertia { mass: 1.0, com: [0.0; 3].into(), tensor: Matrix3::from_diagonal(&[0.1, 0.2, 0.5].into()) };
    let (body, is_wrong) = nearest_body(&flat);
    let moments = body.tensor.diagonal();
    assert!(is_wrong && moments[0] + moments[1] >= moments[2], "{moments}");
    let (massless, is_wrong) = nearest_body(&Inertia::zero());
    assert!(!is_wrong && massless.mass > 1e-15 && massless.tensor.diagonal().min() > 1e-15);
}

/// Motions with the torques of the corrected model, as rows q, qd, qdd, tau. Each joint moves faster than 0.3 rad/s or m/s,
/// because MuJoCo's dry friction rises over a small range of speeds.
fn rows(arm: &Arm, effects: &[Effect]) -> String {
    let model = Corrected::new(arm, effects).expect("they are physical");
    let dof = arm.dof();
    let (mut workspace, mut prediction) = (Workspace::new(dof), Prediction::new(dof));
    let mut text = String::new();
    for k in 0..200 {
        let wave = |j: usize, a: f64, b: f64| (a * f64::from(k) + b * (j as f64 + 1.0)).sin();
        let within = |j: usize| {
            let limits = arm.joints()[j].limits;
            let (lower, upper) = (limits.lower.max(-3.0) + 0.1, limits.upper.min(3.0) - 0.1);
            let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
            middle + 0.9 * half * wave(j, 0.37, 1.1)
        };
        let q: Vec<f64> = (0..dof).map(within).collect();
        let qd: Vec<f64> =
            (0..dof).map(|j| wave(j, 0.53, 2.3)).map(|speed| 2.0 * speed + 0.3 * speed.signum()).collect();
        let qdd: Vec<f64> = (0..dof).map(|j| 4.0 * wave(j, 0.71, 0.7)).collect();
        model.predict(&mut workspace, &q, &qd, &qdd, &mut prediction);
        let tau: Vec<f64> = (0..dof).map(|joint| prediction.torque(joint)).collect();
        let words: Vec<String> = [q, qd, qdd, tau].concat().iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", words.join(","));
    }
    text
}

#[test]
#[ignore = "needs Python with the package mujoco; PYTHON names the interpreter"]
fn mujoco_needs_the_same_torques() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/mjcf_in_mujoco.py");
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let has_mujoco = Command::new(&python).args(["-c", "import mujoco, numpy"]).output();
    assert!(
        has_mujoco.is_ok_and(|output| output.status.success()),
        "{python} has no package mujoco: run tests/packages, which installs it (PYTHON names the interpreter)"
    );
    // The tensor of the Puma's link3 is physically impossible, also when scaled.
    let mut bodies: Vec<Inertia> = read(PUMA).joints().iter().map(|joint| joint.inertia).collect();
    bodies[2] = nearest_body(&bodies[2]).0;
    let robots =
        [("puma560", read(PUMA).with_inertias(&bodies)), ("seven_axis", read(SEVEN)), ("prismatic", read(PRISMATIC))];
    for (name, arm) in robots {
        for (kind, effects) in [("plain", Vec::new()), ("corrected", held(&arm))] {
            let (model, motion) = (folder.path().join("robot.xml"), folder.path().join("motion.csv"));
            std::fs::write(&model, mjcf(&arm, &effects).expect("it is written").text).expect("it writes");
            std::fs::write(&motion, rows(&arm, &effects)).expect("it writes");
            let output = Command::new(&python).arg(script).arg(&model).arg(&motion).output().expect("Python runs");
            let (said, wrong) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
            print!("{name}, {kind}: {said}");
            assert!(output.status.success(), "{name}, {kind}: {said}{wrong}");
        }
    }
}
