//! Which URDFs load, which links are merged, and what is refused with which message.

use arm::{Arm, Geometry, JointKind};

const LINK: &str = r#"<inertial><origin xyz="0 0 .1"/><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial>"#;

fn joint(name: &str, kind: &str, parent: &str, child: &str) -> String {
    format!(
        r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/></joint>"#
    ) + "\n"
}

fn link(name: &str, inside: &str) -> String {
    format!("<link name=\"{name}\">{inside}</link>\n")
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\">\n{}</robot>", parts.concat())
}

fn refusal(text: &str) -> String {
    Arm::from_urdf_text(text, "robot.urdf").expect_err("this robot is refused").to_string()
}

/// Checks that the robot of `parts` is refused with a message that holds each of `said`.
fn refused(parts: &[String], said: &[&str]) {
    let message = refusal(&robot(parts));
    for text in said {
        assert!(message.contains(text), "{message}");
    }
}

#[test]
fn fixed_joints_are_merged() {
    let text = robot(&[
        link("base", ""),
        link("a", LINK),
        link("tool", &format!("{LINK}<visual><geometry><sphere radius=\"0.1\"/></geometry></visual>")),
        joint("j", "continuous", "base", "a"),
        r#"<joint name="f" type="fixed"><origin xyz="0 0 1" rpy="0 3.141592653589793 0"/><parent link="a"/><child link="tool"/></joint>"#.into(),
    ]);
    let arm = Arm::from_urdf_text(&text, "robot.urdf").expect("it loads");
    assert_eq!(arm.dof(), 1);
    let joint = &arm.joints()[0];
    assert_eq!(joint.kind, JointKind::Revolute);
    assert_eq!(joint.limits.upper, f64::INFINITY);
    assert_eq!(joint.limits.effort, f64::INFINITY);
    // 2 kg at 0.1 m and 2 kg at 1 − 0.1 m.
    assert!((joint.inertia.mass - 4.0).abs() < 1e-12);
    assert!((joint.inertia.com.z - 0.5).abs() < 1e-12);
    assert!((joint.inertia.tensor[(0, 0)] - (0.2 + 4.0 * 0.16)).abs() < 1e-12);
    assert_eq!(arm.tool_frame().name, "tool");
    assert_eq!(arm.visuals()[0].geometry, Geometry::Sphere { radius: 0.1 });
}

#[test]
fn what_is_no_serial_arm_is_refused_by_name() {
    let two = |kind: &str| robot(&[link("b", ""), link("a", LINK), joint("hinge", kind, "b", "a")]);
    for kind in ["floating", "planar", "spherical"] {
        let message = refusal(&two(kind));
        assert!(message.contains("robot.urdf:4: joint \"hinge\"") && message.contains(kind), "{message}");
    }
    let [b, a, c] = [link("b", ""), link("a", LINK), link("c", LINK)];
    let three = |joints: &[String]| [&[b.clone(), a.clone(), c.clone()], joints].concat();
    refused(
        &three(&[joint("left", "revolute", "b", "a"), joint("right", "revolute", "b", "c")]),
        &["with 2 ends", "--tip a", "--tip c"],
    );
    refused(
        &three(&[
            joint("j1", "revolute", "b", "a"),
            joint("j2", "revolute", "a", "c"),
            joint("j3", "revolute", "b", "c"),
        ]),
        &[
            "robot.urdf:7: joint \"j3\" closes a loop: link \"c\" is already the child of joint \"j2\"; testbed models serial arms: \
             delete joint \"j3\", or joint \"j2\" if that one is not driven",
        ],
    );
    refused(
        &three(&[joint("j", "revolute", "b", "a"), joint("j", "revolute", "a", "c")]),
        &["robot.urdf:6: joint \"j\" occurs twice; give each"],
    );
    refused(&three(&[joint("j", "revolute", "b", "a")]), &["link \"c\""]);
    refused(
        &[b.clone(), a.clone(), joint("j1", "revolute", "b", "a"), joint("j2", "revolute", "a", "b")],
        &["loop; delete the joint that closes it: \"j2\" if link \"b\" is the base"],
    );
    refused(&[b, joint("j", "revolute", "b", "nowhere")], &["\"nowhere\""]);

    // A robot in which every joint mimics another has no moving joint.
    let mimic = two("revolute").replace("</joint>", "<mimic joint=\"hinge\"/></joint>");
    assert!(refusal(&mimic).contains("has no joint that moves"), "{}", refusal(&mimic));

    assert!(refusal(&two("fixed")).contains("has no joint that moves"));
    assert!(refusal("not xml at all").contains("not a URDF"));
    assert!(refusal("<robot name=\"r\">\n  <link name=\"a\"/>\n").contains(":2: the file ends before </robot>"));
    assert!(refusal("<robot name=\"r\"></robot>").contains("no links"));
    let message = refusal(&robot(&["<xacro:include filename=\"a\"/>\n".into()]));
    assert!(message.contains("robot.urdf:2: is xacro"), "{message}");
    let message = refusal(&two("revolute").replace("value=\"2\"", "value=\"two\""));
    assert!(message.contains("robot.urdf:3: value=\"two\" is not a number"), "{message}");
}

#[test]
fn comments_and_empty_textures_are_not_read() {
    let text = robot(&[
        "<!-- <xacro:include filename=\"${file}\"/> é\n -->".into(),
        link(
            "b",
            "<visual><geometry><sphere radius=\"1\"/></geometry><material name=\"m\"><texture /></material></visual>",
        ),
        link(
            "a",
            &format!(
                "{LINK}<visual><geometry><sphere radius=\"1\"/></geometry><material name=\"m\"><texture>\n<!-- a --></texture></material></visual>"
            ),
        ),
        joint("j", "revolute", "b", "a"),
    ]);
    let arm = Arm::from_urdf_text(&text, "robot.urdf").expect("it loads");
    assert_eq!((arm.dof(), arm.visuals().len()), (1, 2));
    // The lines of later elements are still right.
    let message = refusal(&text.replace("value=\"2\"", "value=\"-2\""));
    assert!(message.contains("robot.urdf:4: link \"a\""), "{message}");
}

#[test]
fn what_does_not_parse_has_its_line() {
    let text = robot(&[
        link("b", ""),
        link("a", LINK),
        joint("j", "revolute", "b", "a").replace("<parent link=\"b\"/>", "<parent/>"),
    ]);
    let message = refusal(&text);
    assert!(message == "robot.urdf:4: <parent> has no attribute link; add it", "{message}");
    let message = refusal(&text.replace("<parent/>", ""));
    assert_eq!(message, "robot.urdf:4: joint \"j\" has no element <parent>; add it");
    let message = refusal("<robot name=\"r\">\n<link name=\"a\">\n</robot>");
    assert!(message.starts_with("robot.urdf:3: is not well-formed XML"), "{message}");
    for (text, format) in [
        ("<mujoco model=\"a\"><worldbody/></mujoco>", "is MJCF"),
        ("<?xml version=\"1.0\"?>\n<sdf version=\"1.7\"/>", "robot.urdf:2: is SDF"),
        ("<html/>", "its first element is <html>"),
    ] {
        assert!(refusal(text).contains(format), "{}", refusal(text));
    }
}

#[test]
fn what_no_body_has_is_refused_by_name() {
    let with = |inertial: &str| robot(&[link("b", ""), link("arm", inertial), joint("j", "revolute", "b", "arm")]);
    let message = refusal(&with(""));
    assert!(message.contains("robot \"r\" has no moving link with a mass or an inertia"), "{message}");
    let message = refusal(&with(&LINK.replace("value=\"2\"", "value=\"-2\"")));
    assert!(message.contains("robot.urdf:3: link \"arm\" has the mass -2 kg"), "{message}");
    let message = refusal(&with(&LINK.replace("value=\"2\"", "value=\"nan\"")));
    assert!(message.contains("not finite"), "{message}");
    let message = refusal(&with(&LINK.replace("izz=\".1\"", "izz=\"-.1\"")));
    assert!(message.contains("negative"), "{message}");

    let bare_tip = robot(&[
        link("b", ""),
        link("a", LINK),
        link("tip", ""),
        joint("j1", "revolute", "b", "a"),
        joint("j2", "revolute", "a", "tip"),
    ]);
    let arm = Arm::from_urdf_text(&bare_tip, "robot.urdf").expect("inverse dynamics can live with it");
    assert_eq!(arm.massless_joint(), Some(1));
    assert_eq!(arm.with_rotor_inertias(&[0.0, 0.1]).massless_joint(), None);

    let no_axis = with(LINK).replace("0 0 1", "0 0 0");
    assert!(refusal(&no_axis).contains("axis"), "{}", refusal(&no_axis));
}

#[test]
fn names_with_control_characters_are_refused() {
    let good = robot(&[link("b", ""), link("a", LINK), joint("j", "revolute", "b", "a")]);
    for (from, place) in [("name=\"j\"", ":4: joint"), ("name=\"r\"", ":1: robot")] {
        let text = good.replace(from, "name=\"x&#10;error: &#27;[31m\"");
        let reason = format!(
            "{place} \"x&#10;error: &#27;[31m\" has a line break or another control character in its name; give"
        );
        assert!(refusal(&text).contains(&reason), "{}", refusal(&text));
    }
}

#[test]
fn a_tensor_that_breaks_the_triangle_inequality_is_warned_of() {
    let arm = Arm::from_urdf(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/puma560.urdf")).expect("it loads");
    let [warning] = arm.warnings() else { panic!("{:?}", arm.warnings()) };
    assert!(warning.contains("link3"), "{warning}");
    assert_eq!(arm.dof(), 6);
    assert_eq!(arm.joints()[1].limits.effort, 186.4);
}

/// A parser that recurses at each level would overflow the stack at 20 000 levels.
#[test]
fn elements_that_are_nested_without_end_are_refused() {
    let deep = |levels: usize| {
        let text = "<robot name=\"r\">\n".to_owned() + &"<a>".repeat(levels) + &"</a>".repeat(levels) + "</robot>";
        Arm::from_urdf_text(&text, "deep.urdf").expect_err("it is no arm").to_string()
    };
    assert!(deep(20_000).starts_with("deep.urdf:2: has elements in each other 64 deep"), "{}", deep(20_000));
    assert!(deep(20).contains("no links"), "{}", deep(20));
}

/// Entities that the file declares: each is ten of the previous one, or the content of another file.
#[test]
fn entities_are_not_expanded() {
    let entities = |definitions: &str| {
        let text = format!("<!DOCTYPE robot [{definitions}]>\n<robot name=\"r\"><link name=\"a\"/><x>&e9;</x></robot>");
        Arm::from_urdf_text(&text, "e.urdf").expect_err("it is no arm").to_string()
    };
    let definition = |k: usize| format!("<!ENTITY e{k} \"{}\">", format!("&e{};", k.saturating_sub(1)).repeat(10));
    let growing: String = (1..10).map(definition).collect();
    let message = entities(&format!("<!ENTITY e0 \"lol\">{growing}"));
    assert!(message.contains("e.urdf"), "{message}");
    let message = entities("<!ENTITY e9 SYSTEM \"file:///etc/hostname\">");
    assert!(message.contains("e.urdf"), "{message}");
}

/// An arm of two links of 0.2 kg with these three equal moments of inertia (kg m²).
fn two_links(upper: &str, fore: &str) -> String {
    let link = |name: &str, moment: &str| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0.1 0 0'/><mass value='0.2'/><inertia ixx='{moment}' ixy='0' ixz='0' \
             iyy='{moment}' iyz='0' izz='{moment}'/></inertial></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin xyz='0.3 0 0'/>\
             <axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='9' velocity='9'/></joint>"
        )
    };
    format!(
        "<robot name='two'>\n<link name='base'/>\n{}\n{}\n{}\n{}\n</robot>",
        link("upper", upper),
        link("fore", fore),
        joint("shoulder", "base", "upper"),
        joint("elbow", "upper", "fore")
    )
}

/// Placeholders of 1 kg m² on a link of 0.2 kg are those of a body that is larger than the arm.
#[test]
fn moments_of_inertia_larger_than_the_arm_are_doubted() {
    let warnings = |moment: &str| {
        let arm = Arm::from_urdf_text(&two_links("1e-3", moment), "two.urdf").expect("it is an arm");
        arm.warnings().join("; ")
    };
    assert_eq!(warnings("1e-3"), "");
    let doubted = warnings("1");
    assert!(
        doubted.contains("link \"fore\" (line 4)") && doubted.contains("2.24 m") && doubted.contains("0.80 m"),
        "{doubted}"
    );
    assert!(!doubted.contains("upper"), "{doubted}");
}

/// Bodies of the links' masses and lengths are taken in the place of 1 kg m² on both links of an arm. Other large moments may be those of drives.
#[test]
fn one_large_moment_on_several_links_is_a_placeholder() {
    let bodies = |upper: &str, fore: &str| {
        let arm = Arm::from_urdf_text(&two_links(upper, fore), "two.urdf").expect("it is an arm");
        arm.bodies_for_placeholders()
    };
    assert!(bodies("1e-3", "1e-3").is_empty() && bodies("0.9", "1").is_empty());
    for moment in ["0.02", "1"] {
        let bodies = bodies(moment, moment);
        let rods = [0.3_f64, 0.2].map(|length| 0.2 * length * length / 12.0);
        assert_eq!(bodies.len(), 2);
        for ((_, body), rod) in bodies.iter().zip(rods) {
            assert!(body.mass == 0.2 && (body.com.x - 0.1).abs() < 1e-12, "{body:?}");
            assert!((body.tensor - arm::Matrix3::<f64>::identity() * rod).amax() < 1e-12, "{body:?}");
        }
    }
}
