//! Robots as their files come: with grippers and branches, and with friction that a diagnosis wrote.

use crate::diagnose_made::{Case, SHOULDER, URDF, arguments, recording, trio};
use crate::support::{says, words};

/// The robot of [`URDF`] with a hand of two weightless fingers, one of which mimics the other.
fn with_gripper() -> String {
    let finger = |name: &str, mimic: &str| {
        format!(
            "<link name=\"{name}_link\"/><joint name=\"{name}\" type=\"prismatic\"><parent link=\"fore\"/><child \
             link=\"{name}_link\"/><axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"0.04\" effort=\"9\" \
             velocity=\"1\"/>{mimic}</joint>\n"
        )
    };
    let fingers = finger("finger_1", "") + &finger("finger_2", "<mimic joint=\"finger_1\"/>");
    URDF.replace("</robot>", &(fingers + "</robot>"))
}

/// That robot with a second, bare arm on the column.
fn with_branch() -> String {
    let branch = "<link name=\"pole\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" \
                  izz=\"0.1\"/></inertial></link><joint name=\"swing\" type=\"continuous\"><parent link=\"column\"/><child \
                  link=\"pole\"/><axis xyz=\"0 0 1\"/></joint>\n</robot>";
    with_gripper().replace("</robot>", branch)
}

fn case(urdf: &str, friction: f64) -> Case {
    let sandbox = crate::support::Sandbox::new();
    sandbox.write("robot.urdf", urdf);
    for (variant, name) in ["a.csv", "b.csv", "c.csv"].into_iter().enumerate() {
        let text = recording(&trio(), variant, 12.0, &|motion, tau| {
            tau[SHOULDER] += friction * motion.qd[SHOULDER].signum();
        });
        sandbox.write(name, &text);
    }
    Case { sandbox }
}

#[test]
fn a_gripper_is_fixed_and_said() {
    let case = case(&with_gripper(), 2.0);
    let output = case.sandbox.run(&arguments(&["--torques-only", "--json", "o.json", "--mjcf", "o.xml"]));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    says(&said, &["robot.urdf", "finger_1 at 0 m (gripper), finger_2 at 0 m (mimics finger_1)"]);
    let printed = String::from_utf8_lossy(&output.stdout);
    says(&printed, &["not in o.xml:", "shapes and meshes of the links"]);
    let mjcf = case.text("o.xml");
    says(&mjcf, &["<mujoco model=\"trio\">", "frictionloss=\"", "site name=\"finger_1_link\""]);
    assert_eq!(case.sandbox.json("o.json")["findings"][0]["effect"], "coulomb_friction");
    // A recording of the gripper, too, is a recording of the arm.
    let mut is_header = true;
    let mut more = String::new();
    for line in case.text("a.csv").lines() {
        more += &format!("{line}{}\n", if is_header { ",q_finger_1,tau_finger_1" } else { ",0.01,0.2" });
        is_header = false;
    }
    case.sandbox.write("d.csv", &more);
    let printed = case.sandbox.succeed(&["inspect", "d.csv", "--robot", "robot.urdf", "--lock", "finger_1=0.01"]);
    assert!(!printed.contains("no such joint"), "{printed}");
    let refused = case.sandbox.refuse(&["inspect", "d.csv", "--robot", "robot.urdf", "--lock", "finger_1=1"]);
    says(&refused, &["robot.urdf:", "finger_1", "0 … 0.04"]);
}

#[test]
fn the_arm_of_a_branching_robot_is_the_recorded_one_or_chosen() {
    let case = case(&with_branch(), 0.0);
    let run = |list: &[&str]| case.sandbox.run(list);
    let inspect = run(&["inspect", "a.csv", "--robot", "robot.urdf"]);
    let (printed, said) = (String::from_utf8_lossy(&inspect.stdout), String::from_utf8_lossy(&inspect.stderr));
    assert!(inspect.status.success() && !printed.contains("no such joint"), "{printed}{said}");
    says(&said, &["swing at 0 rad (not recorded)"]);
    // Without a recording it has to be chosen.
    let effects =
        "schema = \"testbed.model/1\"\n[[effects]]\neffect = \"coulomb_friction\"\njoint = \"elbow\"\nlevel = 3.0\n";
    case.sandbox.write("e.toml", effects);
    let conceal = words("conceal --robot robot.urdf --effects e.toml --out made --training 1");
    let flags =
        "--base column --tip fore (2 joints: shoulder … elbow) or --base floor --tip fore (3 joints: turn … elbow)";
    says(&case.sandbox.refuse(&conceal), &["--robot: robot.urdf:1: ", "with 2 ends", flags]);
    let chosen = [&conceal[..], &["--tip", "fore", "--lock", "swing=0.5"]].concat();
    case.sandbox.succeed(&chosen);
    // The case needs no flags.
    let made = arm::Arm::from_urdf(case.path("made/case_000/robot.urdf")).expect("it loads");
    assert_eq!((made.dof(), made.fixed_joints().len()), (3, 0));
    let scenario = "robot = \"robot.urdf\"\nduration = 0.1\n[model]\nkind = \"true\"\n[reference]\namplitude = 0.1\n\
                    frequency_1 = 0.5\nfrequency_2 = 0.7\n";
    case.sandbox.write("s.toml", scenario);
    let task = ["--scenario", "s.toml", "--rerun", "off"];
    says(&case.sandbox.refuse(&task), &["s.toml:1", "with 2 ends"]);
    case.sandbox.succeed(&[&task[..], &["--base", "column", "--tip", "fore", "--out", "two"]].concat());
    assert_eq!(case.sandbox.json("two/summary.json")["joints"], serde_json::json!(["shoulder", "elbow"]));
    let table = "[chain]\ntip = \"pole\"\nlock = { turn = 0.2 }\n[model]";
    case.sandbox.write("s.toml", &scenario.replace("[model]", table));
    case.sandbox.succeed(&[&task[..], &["--out", "one"]].concat());
    assert_eq!(case.sandbox.json("one/summary.json")["joints"], serde_json::json!(["swing"]));
    // One choice is of one robot.
    let two = ["prove", "--robot", "puma560", "robot.urdf", "--tip", "fore"];
    says(&case.sandbox.refuse(&two), &["--tip fore", "one robot"]);
}

#[test]
fn a_corrected_urdf_diagnosed_again_leaves_nothing_to_find() {
    // Friction that was in the file before is a placeholder, and no known friction.
    let placeholder = URDF.replace("<joint name=\"elbow\"", "<joint name=\"elbow\" x=\"\"");
    let axis = "<axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"200\" velocity=\"5\"/></joint>\n</robot>";
    assert!(placeholder.contains(axis));
    let placeholder = placeholder.replace(axis, &axis.replace("</joint>", "<dynamics damping=\"10\"/></joint>"));
    let case = case(&placeholder, 2.0);
    let output = case.sandbox.run(&arguments(&words("--torques-only --json o.json --urdf corrected.urdf")));
    let said = String::from_utf8_lossy(&output.stderr);
    says(&said, &["the friction in <dynamics> of elbow is not used", "--urdf-friction known"]);
    let found = case.sandbox.json("o.json");
    let names = |found: &serde_json::Value| -> Vec<String> {
        let findings = found["findings"].as_array().expect("a list").iter();
        findings.map(|finding| format!("{}:{}", finding["effect"], finding["joint"])).collect()
    };
    assert_eq!(names(&found), ["\"coulomb_friction\":\"shoulder\""]);
    let mut again = arguments(&["--torques-only", "--json", "again.json", "--urdf", "again.urdf"]);
    again[2] = "corrected.urdf";
    case.sandbox.succeed(&again);
    assert_eq!(names(&case.sandbox.json("again.json")), [] as [String; 0]);
    // What was known stays in the file.
    let friction = |name: &str| arm::Arm::from_urdf(case.path(name)).expect("it loads").joints()[SHOULDER].friction;
    assert!((friction("corrected.urdf") - 2.0).abs() < 0.1);
    assert_eq!(friction("corrected.urdf"), friction("again.urdf"));
    // Unless it is to be found again.
    again.extend(["--urdf-friction", "ignored"]);
    case.sandbox.succeed(&again);
    assert_eq!(names(&case.sandbox.json("again.json")), ["\"coulomb_friction\":\"shoulder\""]);
}

#[test]
fn another_robots_format_is_named() {
    let case = case(URDF, 0.0);
    case.sandbox.write("robot.urdf", "<mujoco model=\"trio\"><worldbody/></mujoco>");
    says(&case.sandbox.refuse(&arguments(&[])), &["robot.urdf:1: is MJCF", "give the URDF"]);
    case.sandbox.write("robot.urdf", "<?xml version=\"1.0\"?>\n<sdf version=\"1.7\"></sdf>");
    says(&case.sandbox.refuse(&arguments(&[])), &["robot.urdf:2: is SDF", "give the URDF"]);
}
