//! Wrong input is refused with its file, its place, what was found and how to mend it, and nothing is left behind.

use crate::support::{Sandbox, says};

const GOOD: &str = r#"title = "t"
robot = "puma560"
duration = 0.2
[reference]
amplitude = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]
frequency_1 = 0.4
frequency_2 = 0.7
[controller]
kp = 100
"#;

/// The refusal of the scenario that comes from GOOD by replacing `from` with `to`.
fn refusal(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from));
    let sandbox = Sandbox::new();
    sandbox.write("bad.toml", &GOOD.replace(from, to));
    let message = sandbox.refuse(&["--scenario", "bad.toml", "--model", "true", "--rerun", "off"]);
    assert!(!sandbox.path("runs").exists(), "something was left behind");
    message
}

#[test]
fn an_unknown_scenario_is_refused_with_those_there_are() {
    let message = Sandbox::new().refuse(&["--scenario", "taskE"]);
    says(&message, &["\"taskE\"", "did you mean task", "taskA, taskB, taskC, taskD"]);
    let message = Sandbox::new().refuse(&["--scenario", "taskD", "--train", "taskA,taskX"]);
    says(&message, &["\"taskX\"", "taskA, taskB, taskC, taskD"]);
    says(&Sandbox::new().refuse(&["--scenario", "gone.toml"]), &["gone.toml", "cannot be read"]);
}

#[test]
fn an_unknown_key_is_refused_with_the_nearest() {
    says(&refusal("kp = 100", "pk = 100"), &["bad.toml:9", "`pk`", "did you mean `kp`?"]);
    says(&refusal("amplitude =", "amplitud ="), &["bad.toml:5", "`amplitud`", "did you mean `amplitude`?"]);
    says(&refusal("title", "titel"), &["bad.toml:1", "`titel`", "did you mean `title`?"]);
}

#[test]
fn wrong_values_are_refused_with_their_line() {
    says(&refusal("kp = 100", "kp = -1"), &["bad.toml:9", "controller.kp", "joint1", "-1", "must not be negative"]);
    says(&refusal("kp = 100", "kp = nan"), &["bad.toml:9", "controller.kp", "NaN"]);
    says(&refusal("kp = 100", "kp = \"high\""), &["bad.toml:9", "a number, or a list of numbers"]);
    says(&refusal("frequency_2 = 0.7", "frequency_2 = 40"), &["bad.toml:7", "Nyquist frequency 40 Hz"]);
    says(&refusal("frequency_2 = 0.7\n", ""), &["bad.toml:4", "go together"]);
    says(&refusal("duration = 0.2", "duration = 0"), &["bad.toml:3", "duration"]);
    says(&refusal("duration = 0.2", "duration = "), &["bad.toml:3"]);
    says(&refusal("kp = 100", "feedback = \"pid\""), &["bad.toml:9", "\"pid\"", "mass-matrix", "gains"]);
    says(&refusal("puma560", "puma650"), &["bad.toml:2", "puma650", "puma560"]);
    says(&refusal("0.5, 0.5]", "0.5]"), &["bad.toml:5", "5 values", "6 joints", "joint1"]);
}

#[test]
fn a_scenario_for_six_joints_and_a_robot_with_seven_is_refused() {
    let sandbox = Sandbox::new();
    let seven = crate::support::root().join("crates/arm/tests/robots/seven_axis.urdf");
    std::fs::copy(seven, sandbox.path("seven.urdf")).expect("it can be copied");
    sandbox.write("bad.toml", &GOOD.replace("puma560", "seven.urdf"));
    let message = sandbox.refuse(&["--scenario", "bad.toml", "--model", "true", "--rerun", "off"]);
    says(&message, &["bad.toml:5", "reference.amplitude has 6 values", "7 joints", "axis7"]);
    // A task for six joints cannot train a robot with seven either.
    sandbox.write("good.toml", &GOOD.replace("puma560", "seven.urdf").replace("[0.5, 0.5, 0.5, 0.5, 0.5, 0.5]", "0.5"));
    let message = sandbox.refuse(&["--scenario", "good.toml", "--train", "taskA", "--rerun", "off"]);
    says(&message, &["training on taskA", "6 joints", "has 7"]);
}

#[test]
fn a_robot_without_body_is_refused() {
    let sandbox = Sandbox::new();
    let with = |inertial: &str| {
        let urdf = format!(
            "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">{inertial}</link>\n<joint name=\"j\" type=\"revolute\">\
             <parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 0 1\"/></joint>\n</robot>"
        );
        sandbox.write("r.urdf", &urdf);
        let scenario = GOOD.replace("puma560", "r.urdf").replace("[0.5, 0.5, 0.5, 0.5, 0.5, 0.5]", "0.5");
        sandbox.write("bad.toml", &scenario);
        sandbox.refuse(&["--scenario", "bad.toml", "--model", "true", "--rerun", "off"])
    };
    says(&with(""), &["bad.toml:2", "r.urdf:1", "no moving link with a mass or an inertia"]);
    let negative = "<inertial><mass value=\"-3\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
    says(&with(negative), &["r.urdf:3", "link \"arm\"", "-3 kg"]);
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let sandbox = Sandbox::new();
    sandbox.write("file", "");
    let run = ["--scenario", "taskD", "--model", "true", "--rerun", "off"];
    let message = sandbox.refuse(&[&run[..], &["--out", "file/below"]].concat());
    says(&message, &["file/below", "--out"]);
    let message = sandbox.refuse(&[&run[..], &["--json", "nowhere/s.json"]].concat());
    says(&message, &["nowhere/s.json", "cannot be written"]);
    let message = sandbox.refuse(&["tables", "--json", "nowhere/t.json"]);
    says(&message, &["nowhere/t.json", "cannot be written"]);
    assert!(!sandbox.path("runs").exists());
}

#[test]
fn a_recording_that_cannot_train_is_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("r.csv", "t,q_joint1,tau_joint1\n0,1,2\n1,1,2\n");
    let message = sandbox.refuse(&["--scenario", "taskD", "--train", "r.csv", "--rerun", "off"]);
    says(&message, &["training on r.csv", "q_joint2"]);
    sandbox.write("r.csv", "t,q_joint1,tau_joint1\n0,1,x\n");
    let message = sandbox.refuse(&["--scenario", "taskD", "--train", "r.csv", "--rerun", "off"]);
    says(&message, &["r.csv:2", "tau_joint1", "\"x\""]);
}

#[test]
fn a_loop_that_is_unstable_says_so() {
    let sandbox = Sandbox::new();
    // One torque a second cannot hold an arm.
    let slow = GOOD
        .replace("kp = 100", "rate = 1")
        .replace("duration = 0.2", "duration = 60")
        .replace("[0.5, 0.5, 0.5, 0.5, 0.5, 0.5]", "0.1")
        .replace("frequency_1 = 0.4", "frequency_1 = 0.2")
        .replace("frequency_2 = 0.7", "frequency_2 = 0.3");
    sandbox.write("slow.toml", &slow);
    let message = sandbox.refuse(&["--scenario", "slow.toml", "--model", "true", "--rerun", "off"]);
    says(&message, &["unstable", "lower the gains", "controller.rate"]);
    assert!(sandbox.list("runs").is_empty(), "something was left behind");
}

/// An arm that moves next to no inertia: no gains make up for it.
#[test]
fn a_loop_that_is_unstable_for_want_of_inertia_says_so() {
    let sandbox = Sandbox::new();
    let urdf = r#"<robot name="r"><link name="b"/>
<link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="tip"><inertial><origin xyz="0 0 0.1"/><mass value="1e-9"/><inertia ixx="1e-10" ixy="0" ixz="0" iyy="1e-10" iyz="0" izz="1e-10"/></inertial></link>
<joint name="j1" type="continuous"><parent link="b"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="j2" type="continuous"><parent link="a"/><child link="tip"/><axis xyz="1 0 0"/></joint></robot>"#;
    sandbox.write("r.urdf", urdf);
    let scenario = GOOD
        .replace("puma560", "r.urdf")
        .replace("[0.5, 0.5, 0.5, 0.5, 0.5, 0.5]", "0.5")
        .replace("kp = 100", "feedback = \"gains\"\nkp = 100\nkd = 20");
    sandbox.write("r.toml", &scenario);
    let message = sandbox.refuse(&["--scenario", "r.toml", "--model", "true", "--rerun", "off"]);
    says(&message, &["unstable", "joint \"j2\" moves no more than", "<inertial>", "plant.rotor_inertia"]);
    assert!(!message.contains("lower the gains"), "{message}");
}

#[test]
fn a_scenario_that_lacks_a_key_says_what_to_add() {
    let message = refusal("duration = 0.2\n", "");
    says(&message, &["bad.toml", "duration", "duration = 10.0"]);
    let sandbox = Sandbox::new();
    sandbox.write("bad.toml", GOOD);
    let message = sandbox.refuse(&["--scenario", "bad.toml", "--rerun", "off"]);
    says(&message, &["--train", "--model rigid-body"]);
}

#[test]
fn a_run_of_no_or_endless_steps_is_refused() {
    says(&refusal("duration = 0.2", "duration = 0.0001"), &["bad.toml:3", "makes 0 steps"]);
    let endless = "duration = 36000\n[controller]\nrate = 100000";
    let sandbox = Sandbox::new();
    sandbox.write(
        "bad.toml",
        &GOOD
            .replace("[controller]\n", "")
            .replace("kp = 100\n", "")
            .replace("duration = 0.2\n", "")
            .replace("[reference]", &format!("{endless}\n[reference]")),
    );
    let message = sandbox.refuse(&["--scenario", "bad.toml", "--model", "true"]);
    says(&message, &["bad.toml:3", "controller.rate", "3600000000 steps"]);
}

#[test]
fn outputs_in_each_others_way_are_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("good.toml", GOOD);
    let run = ["--scenario", "good.toml", "--model", "true", "--rerun", "off"];
    let message = sandbox.refuse(&[&run[..], &["--json", "good.toml"]].concat());
    says(&message, &["good.toml", "the --json file", "the scenario"]);
    let message = sandbox.refuse(&[&run[..], &["--out", "o", "--json", "o/summary.json"]].concat());
    says(&message, &["o/summary.json", "the run's summary", "the --json file"]);
    // A file beside the others in a folder that the run makes is welcome.
    sandbox.succeed(&[&run[..], &["--out", "o", "--json", "o/mine.json"]].concat());
    assert_eq!(sandbox.list("o"), ["mine.json", "recording.csv", "summary.json"]);
}

#[test]
fn an_arm_that_cannot_be_simulated_is_refused_before_the_work() {
    let sandbox = Sandbox::new();
    let urdf = r#"<robot name="r"><link name="b"/>
<link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><link name="tip"/>
<joint name="j1" type="continuous"><parent link="b"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="j2" type="continuous"><parent link="a"/><child link="tip"/><axis xyz="1 0 0"/></joint></robot>"#;
    sandbox.write("r.urdf", urdf);
    let scenario = GOOD.replace("puma560", "r.urdf").replace("[0.5, 0.5, 0.5, 0.5, 0.5, 0.5]", "0.5");
    sandbox.write("r.toml", &scenario);
    let message = sandbox.refuse(&["--scenario", "r.toml", "--model", "true", "--rerun", "off"]);
    says(&message, &["r.toml:2", "r.urdf", "link \"tip\"", "joint \"j2\"", "plant.rotor_inertia"]);
    sandbox.write("r.toml", &format!("{scenario}[plant]\nrotor_inertia = 0.1\n"));
    sandbox.succeed(&["--scenario", "r.toml", "--model", "true", "--rerun", "off"]);
}
