//! The arm is the chain that the options choose, or the only possible one; all other links are fixed to it.

use arm::{Arm, ChainOptions, FixedBecause, Workspace};

/// A revolute column with a prismatic lift that carries two arms of two joints; the left arm has a gripper of two
/// fingers, one of which mimics the other.
fn robot() -> String {
    let mut text = String::from("<robot name=\"two_arms\"><link name=\"root\"/>\n");
    let mut add = |name: &str, kind: &str, parent: &str, child: &str, rest: &str| {
        text.push_str(&format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{rest}</joint>\n<link \
             name=\"{child}\"><inertial><origin xyz=\"0.1 0 0.2\"/><mass value=\"2\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" \
             iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>\n"
        ));
    };
    add("mount", "fixed", "root", "column", "<origin rpy=\"0 0.5 0\"/>");
    add(
        "lift",
        "prismatic",
        "column",
        "carriage",
        "<axis xyz=\"0 0 1\"/><limit lower=\"0.2\" upper=\"1\" effort=\"1\" velocity=\"1\"/>",
    );
    for side in ["left", "right"] {
        let hinge = "<origin xyz=\"0 0 0.5\"/><axis xyz=\"0 1 0\"/><limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>";
        let (upper, lower) = (format!("{side}_upper"), format!("{side}_lower"));
        add(&format!("{side}_shoulder"), "revolute", "carriage", &upper, hinge);
        add(&format!("{side}_elbow"), "revolute", &upper, &lower, hinge);
    }
    let slide = "<axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"0.04\" effort=\"1\" velocity=\"1\"/>";
    add("hand_joint", "fixed", "left_lower", "hand", "<origin xyz=\"0 0 0.1\"/>");
    add("finger_1", "prismatic", "hand", "thumb", slide);
    let mimic = format!("{slide}<mimic joint=\"finger_1\" multiplier=\"0.5\" offset=\"0.01\"/>");
    add("finger_2", "prismatic", "hand", "index", &mimic);
    text + "</robot>"
}

fn load(options: &ChainOptions) -> Result<Arm, String> {
    Arm::from_urdf_chain(&robot(), "two.urdf", options).map_err(|error| error.to_string())
}

fn names(arm: &Arm) -> Vec<&str> {
    arm.joints().iter().map(|joint| joint.name.as_str()).collect()
}

fn tip(link: &str) -> ChainOptions {
    ChainOptions { tip: Some(link.into()), ..ChainOptions::default() }
}

fn recorded(joints: &[&str]) -> ChainOptions {
    ChainOptions { recorded: joints.iter().map(|&joint| joint.into()).collect(), ..ChainOptions::default() }
}

#[test]
fn a_branching_robot_is_refused_with_the_flags_to_give() {
    let message = load(&ChainOptions::default()).expect_err("it has two arms");
    for part in [
        "chains of moving joints with 2 ends",
        "--base carriage --tip left_lower (2 joints: left_shoulder … left_elbow) or --base root --tip left_lower (3 joints: \
         lift … left_elbow)",
        "--base carriage --tip right_lower (2 joints",
    ] {
        assert!(message.contains(part), "{part} is not in\n{message}");
    }
    assert!(!message.contains("finger"), "{message}");
}

#[test]
fn base_and_tip_choose_the_chain() {
    let arm = load(&tip("right_lower")).expect("it loads");
    assert_eq!(names(&arm), ["lift", "right_shoulder", "right_elbow"]);
    assert_eq!(arm.tool_frame().name, "right_lower");
    // The carriage carries the left arm: its own mass, two links, the hand and two fingers.
    assert!((arm.joints()[0].inertia.mass - 2.0 * 6.0).abs() < 1e-12);

    let options = ChainOptions { base: Some("carriage".into()), ..tip("hand") };
    let arm = load(&options).expect("it loads");
    assert_eq!(names(&arm), ["left_shoulder", "left_elbow"]);
    assert_eq!(arm.base_link(), "carriage");
    assert_eq!(arm.tool_frame().name, "hand");
    // The column leans by 0.5 rad about y.
    let expected = arm::Vector3::new(9.81 * 0.5_f64.sin(), 0.0, -9.81 * 0.5_f64.cos());
    assert!((arm.gravity() - expected).norm() < 1e-12, "{}", arm.gravity());
    // The lift is not part of this arm, but is listed as fixed.
    let lift = arm.fixed_joints().iter().find(|joint| joint.name == "lift").expect("it is known");
    assert_eq!((lift.position, lift.is_carried), (0.2, false));
    assert_eq!(lift.reason, FixedBecause::OffChain);
}

#[test]
fn an_arm_with_its_lift_fixed_moves_as_the_arm_on_it() {
    // The same physics: the left arm on a base of its own, and on the root with all other joints locked.
    let own = ChainOptions { base: Some("carriage".into()), ..tip("left_lower") };
    let locked = ChainOptions {
        locks: ["lift", "right_shoulder", "right_elbow"].map(|name| (name.into(), 0.3)).into(),
        ..ChainOptions::default()
    };
    let torque = |options: &ChainOptions| {
        let arm = load(options).expect("it loads");
        let mut tau = [0.0; 2];
        arm.inverse_dynamics(&mut Workspace::new(&arm), &[0.3, -0.7], &[1.0, 2.0], &[-3.0, 4.0], &mut tau);
        tau
    };
    let (a, b) = (torque(&own), torque(&locked));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?}, {b:?}");
}

#[test]
fn the_recorded_joints_choose_the_chain() {
    let arm = load(&recorded(&["right_elbow", "right_shoulder"])).expect("it loads");
    assert_eq!(names(&arm), ["right_shoulder", "right_elbow"]);
    let lift = &arm.fixed_joints()[0];
    assert_eq!((lift.reason.clone(), lift.position), (FixedBecause::NotRecorded, 0.2));
    // A joint between recorded joints is not fixed: its column is missing.
    let arm = load(&recorded(&["lift", "right_elbow"])).expect("it loads");
    assert_eq!(names(&arm), ["lift", "right_shoulder", "right_elbow"]);
    // Both arms were recorded, so that both are possible; a tip decides.
    let both = ["left_shoulder", "left_elbow", "right_shoulder", "right_elbow"];
    assert!(load(&recorded(&both)).is_err());
    let options = ChainOptions { tip: Some("left_lower".into()), base: Some("carriage".into()), ..recorded(&both) };
    assert_eq!(names(&load(&options).expect("it loads")), ["left_shoulder", "left_elbow"]);
    // The joints of another robot have no influence.
    assert!(load(&recorded(&["a"])).is_err());
}

#[test]
fn grippers_and_mimicking_joints_are_fixed() {
    let arm = load(&recorded(&["left_shoulder", "left_elbow", "finger_1"])).expect("it loads");
    assert_eq!(names(&arm), ["left_shoulder", "left_elbow"]);
    let fixed = |name: &str| {
        let found = arm.fixed_joints().iter().find(|joint| joint.name == name);
        let found = found.expect("it is fixed");
        (found.position, found.reason.clone(), found.is_carried)
    };
    assert_eq!(fixed("finger_1"), (0.0, FixedBecause::Gripper, true));
    // It stands at the position that the mimicked joint gives it.
    assert_eq!(fixed("finger_2"), (0.01, FixedBecause::Mimics("finger_1".into()), true));
    let [note] = arm.warnings() else { panic!("{:?}", arm.warnings()) };
    assert!(note.contains("finger_1 at 0 m (gripper), finger_2 at 0.01 m (mimics finger_1)"), "{note}");
    // The fingers' frames are no tool; they are at the forearm's end.
    assert_eq!(arm.tool_frame().name, "hand");
    assert!((arm.joints()[1].inertia.mass - 8.0).abs() < 1e-12);
    // A tip beyond the gripper lets it move; the other finger, which follows it, is fixed with a warning.
    let arm = load(&tip("thumb")).expect("it loads");
    assert_eq!(names(&arm), ["lift", "left_shoulder", "left_elbow", "finger_1"]);
    let warning = "joints beyond the tip that follow a moving joint of the arm, and are fixed in the model all the same: finger_2 \
                   (finger_1)";
    assert!(arm.warnings().iter().any(|text| text == warning), "{:?}", arm.warnings());
}

#[test]
fn locks_say_where_joints_are_fixed() {
    let with = |locks: &[(&str, f64)]| ChainOptions {
        locks: locks.iter().map(|&(name, value)| (name.into(), value)).collect(),
        ..tip("left_lower")
    };
    let arm = load(&with(&[("finger_1", 0.03), ("lift", 0.5)])).expect("it loads");
    assert_eq!(names(&arm), ["left_shoulder", "left_elbow"]);
    let open = arm.joints()[1].inertia.com.x;
    let closed = load(&with(&[("lift", 0.5)])).expect("it loads").joints()[1].inertia.com.x;
    // Of four bodies of 2 kg, one moves by 0.03 m and another, which mimics it, by half of that.
    assert!((open - closed - (0.03 + 0.015) / 4.0).abs() < 1e-12, "{open}, {closed}");
    let message = load(&with(&[("lift", 0.5), ("lift", 0.6)])).expect_err("it is refused");
    assert!(
        message.contains("has one joint \"lift\", which is locked at 0.5 and at 0.6; give one --lock for each joint"),
        "{message}"
    );
    for (locks, reason) in [
        ([("finger_1", 3.0)], "joint \"finger_1\" is locked at 3, outside its limits 0 … 0.04"),
        ([("elbow", 0.0)], "has no moving joint \"elbow\" for --lock; its moving joints are lift, "),
        ([("left_elbow", f64::NAN)], "is locked at NaN"),
    ] {
        let message = load(&with(&locks)).expect_err("it is refused");
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn links_that_are_not_there_are_refused_by_name() {
    let message = load(&tip("nowhere")).expect_err("there is no such link");
    assert!(message.contains("has no link \"nowhere\" for --tip; its links are root, "), "{message}");
    let message = load(&tip("left_elbow")).expect_err("it is a joint");
    assert!(message.contains("but a joint of this name; the link that it moves is left_lower"), "{message}");
    let opposite = ChainOptions { base: Some("left_lower".into()), ..tip("root") };
    let message = load(&opposite).expect_err("they are the other way round");
    assert!(message.contains("exchange --base and --tip"), "{message}");
    let options = ChainOptions { base: Some("right_upper".into()), ..tip("left_lower") };
    let message = load(&options).expect_err("it is on the other arm");
    assert!(message.contains("link \"left_lower\" is not below link \"right_upper\""), "{message}");
}

#[test]
fn a_floating_base_is_no_part_of_the_arm() {
    let text = robot().replace("<joint name=\"mount\" type=\"fixed\">", "<joint name=\"mount\" type=\"floating\">");
    let load = |options: &ChainOptions| Arm::from_urdf_chain(&text, "two.urdf", options);
    let message = load(&tip("left_lower")).expect_err("it floats").to_string();
    assert!(message.contains("joint \"mount\" is floating") && message.contains("--base column"), "{message}");
    let options = ChainOptions { base: Some("column".into()), ..tip("left_lower") };
    assert_eq!(load(&options).expect("it loads").dof(), 3);
}

#[test]
fn joints_that_mimic_the_arms_own_are_refused() {
    let mimics = |joint: &str, mimic: &str| {
        let at = format!("<joint name=\"{joint}\"");
        let (before, rest) = robot().split_once(&at).map(|(a, b)| (a.to_owned(), b.to_owned())).expect("it is there");
        format!("{before}{at}{}", rest.replacen("</joint>", &format!("{mimic}</joint>"), 1))
    };
    let left = ChainOptions { base: Some("carriage".into()), ..recorded(&["left_shoulder", "left_elbow"]) };
    let refused = |text: &str, options: &ChainOptions| {
        Arm::from_urdf_chain(text, "two.urdf", options).expect_err("it is refused").to_string()
    };
    // A recorded joint of the arm, the last one or the first one.
    for (joint, of) in [("left_elbow", "left_shoulder"), ("left_shoulder", "left_elbow")] {
        let message = refused(&mimics(joint, &format!("<mimic joint=\"{of}\"/>")), &left);
        let reason = format!(
            "joint \"{joint}\" is recorded, and mimics \"{of}\", a moving joint of the arm, and testbed models"
        );
        assert!(message.contains(&reason), "{message}");
        let remedy = format!("; delete its <mimic> if it has a drive of its own, or fix it with --lock {joint}=VALUE");
        assert!(message.contains(&remedy), "{message}");
    }
    // A gripper that opens with the elbow, directly or by way of another finger.
    let text = mimics("finger_1", "<mimic joint=\"left_elbow\" multiplier=\"2\" offset=\"0.1\"/>");
    let message = refused(&text, &left);
    assert!(message.contains("joint \"finger_1\" mimics \"left_elbow\", a moving joint"), "{message}");
    let locked = |name: &str| ChainOptions { locks: vec![(name.into(), 0.0)], ..left.clone() };
    let by_way = text.replacen("<mimic joint=\"left_elbow\"", "<mimic joint=\"finger_2\"", 1);
    let by_way = by_way.replace("<mimic joint=\"finger_1\"", "<mimic joint=\"left_elbow\"");
    let message = refused(&by_way, &left);
    assert!(
        message.contains("\"finger_1\" mimics \"finger_2\", which follows \"left_elbow\", a moving joint of the arm"),
        "{message}"
    );
    assert!(Arm::from_urdf_chain(&text, "two.urdf", &locked("finger_1")).is_ok());
    // A joint that does not exist.
    let text = mimics("finger_1", "<mimic joint=\"left_elbw\"/>");
    let message = refused(&text, &left);
    assert!(
        message
            .contains("mimics joint \"left_elbw\", which the file does not have (is \"left_elbow\" meant?); correct"),
        "{message}"
    );
    // Some hands name a joint that is missing; they are no part of an arm that ends before them.
    let options = ChainOptions { base: left.base.clone(), ..tip("left_lower") };
    assert!(Arm::from_urdf_chain(&text, "two.urdf", &options).is_ok());
}
