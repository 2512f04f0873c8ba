//! Misspelt names in a URDF are refused with the name that is meant, and links without mass are noted.

use arm::Arm;

/// A pendulum of two links, in which each element has a line of its own.
const PENDULUM: &str = r#"<robot name="r">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 -.2" rpy="0 0 0"/>
<mass value="0.5"/>
<inertia ixx=".01" ixy="0" ixz="0" iyy=".01" iyz="0" izz=".005"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="1" friction="1"/></joint>
<link name="lower"><inertial><mass value="0.5"/><inertia ixx=".01" ixy="0" ixz="0" iyy=".01" iyz="0" izz=".005"/></inertial></link>
<joint name="j2" type="continuous"><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/></joint>
<link name="flange"/>
<joint name="mount" type="fixed"><parent link="lower"/><child link="flange"/></joint>
</robot>"#;

fn load(text: &str) -> Result<Arm, String> {
    Arm::from_urdf_text(text, "r.urdf").map_err(|error| error.to_string())
}

fn refused(from: &str, to: &str) -> String {
    assert!(PENDULUM.contains(from), "{from}");
    let text = PENDULUM.replace("<robot", "<robot xmlns:drake=\"https://drake.mit.edu\"");
    load(&text.replacen(from, to, 1)).expect_err(to)
}

#[test]
fn a_misspelt_name_is_refused_with_the_one_that_is_meant() {
    let arm = load(PENDULUM).expect("it loads");
    assert!(arm.warnings().is_empty(), "{:?}", arm.warnings());
    for (from, to, message) in [
        (
            "<inertial><origin",
            "<intertial/><inertial><origin",
            "r.urdf:3: link \"upper\" has an unknown element <intertial>; did you mean <inertial>?",
        ),
        (
            "<mass value=\"0.5\"/>\n",
            "<Maas value=\"0.5\"/>\n",
            "r.urdf:4: <inertial> of link \"upper\" has an unknown element <Maas>; did you mean <mass>?",
        ),
        ("<axis xyz", "<axes xyz", "r.urdf:7: joint \"j1\" has an unknown element <axes>; did you mean <axis>?"),
        (
            "<link name=\"flange\"/>",
            "<lnik name=\"flange\"/>",
            "r.urdf:11: the robot has an unknown element <lnik>; did you mean <link>?",
        ),
        (
            "ixx=\".01\"",
            "ixxx=\".01\"",
            "r.urdf:5: <inertia> of link \"upper\" has an unknown attribute ixxx; did you mean ixx?",
        ),
        (
            "ixy=\"0\"",
            "ixxy=\"0\"",
            "r.urdf:5: <inertia> of link \"upper\" has an unknown attribute ixxy; did you mean ixy?",
        ),
        (
            "value=\"0.5\"/>\n",
            "vlaue=\"0.5\"/>\n",
            "r.urdf:4: <mass> of link \"upper\" has an unknown attribute vlaue; did you mean value?",
        ),
        (
            "<origin xyz=\"0 0 1\"",
            "<origin xzy=\"0 0 1\"",
            "r.urdf:7: <origin> of joint \"j1\" has an unknown attribute xzy; did you mean xyz?",
        ),
        (
            "upper=\"1\"",
            "uper=\"1\"",
            "r.urdf:8: <limit> of joint \"j1\" has an unknown attribute uper; did you mean upper?",
        ),
        (
            "type=\"revolute\"",
            "type=\"revolut\"",
            "r.urdf:6: type=\"revolut\" of joint \"j1\" is not a joint type; did you mean \"revolute\"?",
        ),
        (
            "type=\"revolute\"",
            "type=\"ball\"",
            "r.urdf:6: type=\"ball\" of joint \"j1\" is not a joint type; an arm has joints that are revolute, continuous, prismatic \
             or fixed",
        ),
    ] {
        assert_eq!(refused(from, to), message);
    }
}

#[test]
fn numbers_that_are_missing_are_counted() {
    for (from, to, message) in [
        (
            "xyz=\"0 0 1\"",
            "xyz=\"1 0\"",
            "r.urdf:7: xyz needs three numbers, and has two (1 0); give three in SI units",
        ),
        ("value=\"0.5\"/>\n", "value=\"\"/>\n", "r.urdf:4: value needs one number, and has none; give one in SI units"),
        ("xyz=\"0 0 1\"", "xyz=\"0, 0 1\"", "r.urdf:7: 0, in xyz=\"0, 0 1\" is not a number; give one in SI units"),
        (
            " izz=\".005\"/></inertial></link>\n<joint",
            "/></inertial></link>\n<joint",
            "r.urdf:5: <inertia> has no attribute izz; add it",
        ),
        ("<mass value=\"0.5\"/>\n", "\n", "r.urdf:3: <inertial> has no element <mass>; add it"),
    ] {
        assert_eq!(refused(from, to), message);
    }
}

/// What simulators, planners and drivers add to a URDF, and attributes that some robots have.
#[test]
fn extensions_are_no_misspellings() {
    let text = PENDULUM.replace("<robot", "<robot xmlns:drake=\"https://drake.mit.edu\"");
    let inside = |place: &str, what: &str| text.replacen(place, &format!("{what}{place}"), 1);
    for text in [
        inside(
            "</robot>",
            "<gazebo reference=\"upper\"><intertial/><joints/></gazebo><sensor name=\"s\"/><material name=\"m\"/><transmission \
             name=\"t\"><joint name=\"j1\" tpye=\"a\"><hardwareInterface>a</hardwareInterface></joint><actuator name=\"a\"/></transmission>\
             <ros2_control name=\"r\"><joint name=\"j1\"><command_interface name=\"position\"><param name=\"min\">1</param></command_interface>\
             </joint></ros2_control><mujoco><compiler/></mujoco><loop_joint name=\"l\"/>",
        ),
        inside(
            "</link>\n<joint",
            "<contact><lateral_friction value=\"1\"/></contact><self_collision_checking><origin xzy=\"0 0 0\"/></self_collision_checking>\
             <visual><geometry><sphere radius=\"1\"/></geometry></visual><kinematic/><gravity/><drake:intertial/>",
        ),
        inside(
            "</joint>",
            "<calibration rising=\"0\"/><safety_controller k_velocity=\"1\"/><drake:rotor_inertia value=\"1\"/>",
        ),
        PENDULUM
            .replace("effort=\"1\"", "effort=\"1\" acceleration=\"1\" jerk=\"1\" gear_velocity=\"1\" current=\"1\""),
        PENDULUM
            .replace("friction=\"1\"", "friction=\"1\" K=\"1\" D=\"1\" mu_coulomb=\"1\" mu_viscous=\"1\" source=\"a\""),
        PENDULUM.replace("name=\"lower\"", "name=\"lower\" type=\"a\" iyx=\"0\""),
        // A full matrix has all names that iyx could mean.
        PENDULUM.replace("iyy=", "iyx=\"0\" iyy="),
    ] {
        let arm = load(&text).unwrap_or_else(|error| panic!("{error}"));
        assert!(arm.warnings().is_empty(), "{:?}", arm.warnings());
    }
}

#[test]
fn a_moving_link_without_mass_is_noted() {
    let bare = |from: &str, to: &str| {
        let arm = load(&PENDULUM.replacen(from, to, 1)).expect("it loads");
        arm.warnings().join("\n")
    };
    let (head, _) = PENDULUM.split_once("<link name=\"lower\">").expect("it is there");
    let line = PENDULUM[head.len()..].lines().next().expect("it is there");
    let note = bare(line, "<link name=\"lower\"/>");
    assert_eq!(
        note,
        "link \"lower\" (line 9), which j2 moves, has no mass and no inertia; add its <inertial>, unless it stands for no body"
    );
    let mass = line.split("<mass").nth(1).and_then(|rest| rest.split("/>").next()).expect("it is there");
    let note = bare(line, &line.replace(mass, " value=\"0\""));
    let rest = "has an inertia but no mass, which no body has; correct its <mass>, unless it stands for a rotor";
    assert_eq!(note, format!("link \"lower\" (line 9), which j2 moves, {rest}"));
    // What a fixed joint attaches to it is a part of it.
    let moved = line.replace("\"lower\"", "\"flange\"");
    let text = PENDULUM.replacen("<link name=\"flange\"/>", &moved, 1).replacen(line, "<link name=\"lower\"/>", 1);
    let arm = load(&text).expect("it loads");
    assert!(arm.warnings().is_empty(), "{:?}", arm.warnings());
}
