//! A written URDF, read again, equals the corrected model.

use super::*;
use effects::arm::link_effect;
use effects::friction::{COULOMB_FRICTION, FRICTION_ASYMMETRY, STRIBECK_FRICTION, VISCOUS_FRICTION};
use effects::sensor::TORQUE_OFFSET;
use torque::{Prediction, TorqueModel, Workspace};

/// Welded links, one of them without inertial, comments, odd spacing, a transmission with a joint of the same name.
const TWO: &str = r#"<?xml version="1.0"?>
<!-- a <link name="decoy"/> in a comment -->
<robot name="two"   xmlns:xacro="x">
  <link name="base"/>
  <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <dynamics friction="0.5" damping='0.25'></dynamics>
  </joint>
  <link name="upper"><!-- kept -->
    <inertial><mass value="2"/><origin xyz=".3 0 .1" rpy="0.1 0.2 0.3"/>
      <inertia ixx=".1" ixy="0.01" ixz="0" iyy=".2" iyz="0" izz=".15"/></inertial>
    <visual><origin xyz="1 2 3"/><geometry><box size="1 1 1"/></geometry></visual>
  </link>
  <joint name="b" type="revolute"><origin xyz="0.6 0 0" rpy="0.3 0 0"/><parent link="upper"/><child link="fore"/><axis xyz="0 1 1"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
  <link name="fore"><inertial><mass value="1"/><inertia ixx=".02" ixy="0" ixz="0" iyy=".02" iyz="0" izz=".02"/></inertial></link>
  <joint name="f" type="fixed"><origin xyz="0.2 0 0.1" rpy="0 0.5 0"/><parent link="fore"/><child link="flange"/></joint>
  <link name="flange"><inertial><mass value=".5"/><inertia ixx=".01" ixy="0" ixz="0" iyy=".01" iyz="0" izz=".01"/></inertial></link>
  <joint name="g" type="fixed"><origin xyz="0 0 0.1" rpy="0.7 0 0"/><parent link="flange"/><child link="tool"/></joint>
  <link name="tool" />
  <transmission name="t"><joint name="a"><dynamics damping="77"/></joint></transmission>
</robot>
"#;

fn effects() -> Vec<Effect> {
    vec![
        Effect::of(&VISCOUS_FRICTION).on("a").with("coefficient", 1.25),
        Effect::of(&COULOMB_FRICTION).on("b").with("level", 0.75),
        Effect::of(&PAYLOAD)
            .with("mass", 1.5)
            .with("com", [0.1, 0.02, 0.3])
            .with("inertia", [0.03, 0.001, 0.025, 0.0, 0.002, 0.02]),
        Effect::of(&LINK_INERTIAL_ERROR).on("b").with("relative", 0.2),
        Effect::of(&INERTIAL_SCALE).with("factor", 1.1),
        Effect::of(&TORQUE_OFFSET).on("b").with("offset", 0.3),
    ]
}

fn read(urdf: &str) -> Arm {
    Arm::from_urdf_text(urdf, "test.urdf").expect("it is an arm")
}

#[track_caller]
fn assert_same_dynamics(written: &Arm, corrected: &Corrected) {
    let dof = written.dof();
    let mut workspace = Workspace::new(dof);
    let mut expected = Prediction::new(dof);
    let mut scratch = arm::Workspace::new(written);
    let mut found = vec![0.0; dof];
    for k in 0..20 {
        let vector = |a: f64| -> Vec<f64> { (0..dof).map(|j| (a + f64::from(k) * (1.0 + j as f64)).sin()).collect() };
        let (q, qd, qdd) = (vector(0.1), vector(0.5), vector(2.0));
        corrected.predict(&mut workspace, &q, &qd, &qdd, &mut expected);
        written.inverse_dynamics(&mut scratch, &q, &qd, &qdd, &mut found);
        for j in 0..dof {
            let (found, expected) = (found[j], expected.rigid[j]);
            assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "joint {j}: {found}, {expected}");
        }
    }
}

#[test]
fn effects_that_a_urdf_can_hold_are_written() {
    let arm = read(TWO);
    let Export { text, omitted } = corrected_urdf(TWO, &arm, &effects()).expect("it is written");
    let written = read(&text);
    assert_same_dynamics(&written, &Corrected::new(&arm, &effects()).expect("they are physical"));
    let [a, b] = written.joints() else { panic!("two joints") };
    // The joint's friction is the found one, and not that of the file.
    assert_eq!((a.damping, a.friction), (1.25, 0.0));
    assert_eq!((b.damping, b.friction), (0.0, 0.75));
    let [offset] = &omitted[..] else { panic!("{omitted:?}") };
    assert_eq!(offset, "torque_offset of b: offset 0.3000 N m");
    assert!(text.contains(offset) && text.contains("5 of 6 effects"), "{text}");
}

#[test]
fn the_rest_of_the_file_is_unchanged() {
    let arm = read(TWO);
    let text = corrected_urdf(TWO, &arm, &effects()).expect("it is written").text;
    for kept in [
        "<!-- a <link name=\"decoy\"/> in a comment -->\n<robot name=\"two\"   xmlns:xacro=\"x\">",
        "<link name=\"base\"/>",
        "<!-- kept -->",
        "<visual><origin xyz=\"1 2 3\"/><geometry><box size=\"1 1 1\"/></geometry></visual>",
        "<transmission name=\"t\"><joint name=\"a\"><dynamics damping=\"77\"/></joint></transmission>\n</robot>\n",
    ] {
        assert!(text.contains(kept), "{kept} is not in\n{text}");
    }
    // Without effects only the comment is new.
    let same = corrected_urdf(TWO, &arm, &[]).expect("it is written").text;
    let (before, rest) = same.split_once("\n  <!-- Corrected").expect("there is a comment");
    let (_, after) = rest.split_once("-->").expect("it ends");
    assert_eq!(format!("{before}{after}"), TWO);
}

#[test]
fn the_puma_is_read_as_written() {
    let urdf = include_str!("../../../../assets/puma560.urdf");
    let arm = read(urdf);
    let joint = |j: usize| arm.joints()[j].name.clone();
    let effects = [
        Effect::of(&PAYLOAD)
            .with("mass", 2.0)
            .with("com", [0.0, 0.0, 0.1])
            .with("inertia", [0.01, 0.0, 0.01, 0.0, 0.0, 0.01]),
        Effect::of(&LINK_INERTIAL_ERROR).on(joint(1)).with("relative", -0.15),
        Effect::of(&VISCOUS_FRICTION).on(joint(2)).with("coefficient", 3.5),
    ];
    let written = read(&corrected_urdf(urdf, &arm, &effects).expect("it is written").text);
    assert_same_dynamics(&written, &Corrected::new(&arm, &effects).expect("they are physical"));
    assert_eq!(written.joints()[2].damping, 3.5);
}

#[test]
fn effects_of_another_robot_are_refused() {
    let arm = read(TWO);
    let unknown = [Effect::of(&COULOMB_FRICTION).on("z").with("level", 1.0)];
    assert!(corrected_urdf(TWO, &arm, &unknown).is_err());
    let other = TWO.replace("name=\"upper\"", "name=\"other\"");
    let error = corrected_urdf(&other, &arm, &effects()).expect_err("it is another robot's");
    assert!(error.to_string().contains("no link \"upper\""), "{error}");
}

/// A friction with more than one level is written as its most similar level; the rest is listed.
#[test]
fn what_a_urdf_holds_in_part_is_written_and_listed() {
    let arm = read(TWO);
    let found = [
        Effect::of(&FRICTION_ASYMMETRY).on("a").with("positive", 3.0).with("negative", 2.0),
        Effect::of(&STRIBECK_FRICTION).on("b").with("coulomb", 1.0).with("breakaway", 1.5).with("velocity", 0.1),
    ];
    let Export { text, omitted } = corrected_urdf(TWO, &arm, &found).expect("it is written");
    let written = read(&text);
    let friction: Vec<f64> = written.joints().iter().map(|joint| joint.friction).collect();
    assert_eq!(friction, [2.5, 1.0]);
    assert_eq!(omitted.len(), 2);
    assert!(omitted[0].starts_with("friction_asymmetry of a (the difference between the directions"), "{}", omitted[0]);
    assert!(text.contains("0 of 2 effects"), "{text}");
    assert_eq!(diagnosed_joints(&text).expect("it reads"), ["a", "b"]);
}

/// Estimated bodies replace the inertials of all links that are welded together.
#[test]
fn inertial_parameters_are_written() {
    let arm = read(TWO);
    let body = Inertia {
        mass: 1.75,
        com: [0.01, -0.02, 0.3].into(),
        tensor: arm::Matrix3::new(0.03, 0.001, 0.0, 0.001, 0.04, 0.002, 0.0, 0.002, 0.02),
    };
    let found = [link_effect("b", &body), Effect::of(&PAYLOAD).with("mass", 0.5).with("com", [0.0, 0.1, 0.2])];
    let written = read(&corrected_urdf(TWO, &arm, &found).expect("it is written").text);
    assert_same_dynamics(&written, &Corrected::new(&arm, &found).expect("they are physical"));
    assert!((written.joints()[1].inertia.mass - 2.25).abs() < 1e-12);
}

/// A drive's inertia is written for Drake, unless the file describes the drive.
#[test]
fn drive_inertias_are_written_for_drake() {
    let arm = read(TWO);
    let drive = |joint: &str| Effect::of(&ROTOR_INERTIA).on(joint).with("inertia", 0.125);
    let Export { text, omitted } = corrected_urdf(TWO, &arm, &[drive("b")]).expect("it is written");
    assert!(omitted.is_empty(), "{omitted:?}");
    for part in [
        "<robot name=\"two\"   xmlns:xacro=\"x\" xmlns:drake=\"http://drake.mit.edu\">",
        "<joint name=\"b\"/><actuator name=\"b_drive\"><drake:rotor_inertia value=\"0.125\"/><drake:gear_ratio value=\"1\"/>",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert_eq!(read(&text).dof(), 2);
    // The joint has a transmission in the file.
    let Export { text, omitted } = corrected_urdf(TWO, &arm, &[drive("a")]).expect("it is written");
    assert!(omitted[0].contains("transmission of this joint"), "{omitted:?}");
    assert!(!text.contains("drake:"), "{text}");
}

/// A payload whose moments the recordings do not determine may leave a tool that no body has. What is written can be read again.
#[test]
fn a_payload_that_leaves_no_body_is_written_as_the_nearest_one() {
    let payload = Effect::of(&PAYLOAD)
        .with("mass", -0.2)
        .with("com", [0.15, 0.0, 0.0])
        .with("inertia", [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let urdf = TWO.replace(
        "<link name=\"tool\" />",
        "<link name=\"tool\"><inertial><mass value=\"0.5\"/><inertia ixx=\"0.001\" ixy=\"0\" ixz=\"0\" iyy=\"0.001\" iyz=\"0\" izz=\"0.001\"/></inertial></link>",
    );
    let corrected = corrected_urdf(&urdf, &read(&urdf), &[payload]).expect("it can be written");
    assert!(
        corrected.omitted.iter().any(|line| line.contains("the inertia tensor of link \"tool\"")),
        "{:?}",
        corrected.omitted
    );
    let again = Places::of(&corrected.text).expect("it is XML");
    let tool = &again.links["tool"].inertia;
    assert!((tool.mass - 0.3).abs() < 1e-12, "{tool:?}");
    assert!(!nearest_body(tool).1, "{tool:?}");
}

#[test]
fn known_bodies_that_a_corrected_urdf_may_hold_are_noted() {
    let arm = read(TWO);
    let corrected = corrected_urdf(TWO, &arm, &effects()).expect("it can be corrected").text;
    let note = may_count_twice(&corrected, &effects()).expect("the payload may count twice");
    assert!(note.contains("put inertial_scale, link_inertial_error, payload into it"), "{note}");
    assert_eq!(may_count_twice(TWO, &effects()), None);
    assert_eq!(may_count_twice(&corrected, &effects()[..2]), None);
}
