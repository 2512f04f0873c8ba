//! What a run says of its loop, its training data and its model, through the built program.

use crate::support::{Sandbox, words};

/// A short run of the PUMA 560, whose model has the factor `scale`, with `extra` lines.
fn scenario(scale: f64, extra: &str) -> String {
    format!(
        "robot = \"puma560\"\nduration = 0.5\n[model]\ninertia_scale = {scale}\n[reference]\namplitude = 0.5\n\
         frequency_1 = 0.4\nfrequency_2 = 0.7\n{extra}"
    )
}

/// The usual arguments of a run of `one.toml`.
fn run(more: &str) -> Vec<&str> {
    [words("--scenario one.toml --rerun off --out run"), words(more)].concat()
}

/// The torque error is that of the torque in the loop: of the rigid body where the learned torque fades.
#[test]
fn the_torque_error_is_that_of_the_torque_that_is_fed_forward() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &scenario(1.2, ""));
    sandbox.write("other.toml", &scenario(1.2, "").replace("amplitude = 0.5", "amplitude = 0.02"));
    let of = |more: &str| {
        sandbox.succeed(&run(more));
        sandbox.json("run/summary.json")["torque_mse"][1].as_f64().expect("a number")
    };
    let rigid = of("--model rigid-body");
    let full = of("--model gp --train other.toml --fade false");
    let faded = of("--model gp --train other.toml");
    assert!(full > 2.0 * rigid && faded < 1.2 * rigid, "{rigid} {full} {faded}");
}

#[test]
fn an_error_that_a_learned_torque_adds_to_an_exact_model_is_stated() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &scenario(1.0, ""));
    sandbox.write("other.toml", &scenario(1.0, "").replace("frequency_1 = 0.4", "frequency_1 = 3.0"));
    let printed = sandbox.succeed(&run("--model gp --train other.toml --fade false"));
    let sentence = "The rigid body has no torque error on joint1, joint2, joint3, joint4, joint5 and joint6; the learned torque adds one.";
    assert!(printed.contains(sentence), "{printed}");
    let printed = sandbox.succeed(&run("--model independent-joint --train one.toml"));
    assert!(!printed.contains("adds one"), "{printed}");
}

/// Gains in 1/s² are far too large in N m/rad for a wrist: the loop is bounded by the effort limits and does not follow.
#[test]
fn a_loop_that_does_not_follow_says_so() {
    let sandbox = Sandbox::new();
    let gains = "[controller]\nfeedback = \"gains\"\nkp = 100\nkd = 20\n";
    sandbox.write("one.toml", &scenario(1.2, gains).replace("duration = 0.5", "duration = 1"));
    let printed = sandbox.succeed(&run("--model rigid-body"));
    assert!(
        printed.contains("The loop does not follow its reference") && printed.contains("% saturated)"),
        "{printed}"
    );
    assert!(printed.contains("joint6 (") && printed.contains("controller.kp (N m/rad, or N/m)"), "{printed}");
    sandbox.write("one.toml", &scenario(1.2, ""));
    let printed = sandbox.succeed(&run("--model rigid-body"));
    assert!(!printed.contains("does not follow"), "{printed}");
}

#[test]
fn settings_of_training_scenarios_that_are_not_used_are_named() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &scenario(1.2, "[training]\nscenarios = [\"taskC\", \"own.toml\"]\n"));
    sandbox.write("own.toml", &scenario(1.3, "[plant]\ncoulomb_friction = 1\n[sensors]\ntorque_noise = 0.1\n"));
    let said = sandbox.noted(&run("--model hybrid"));
    let expected = "note: own.toml: only its reference is used; plant, sensors and model are those of one, which differ in \
                    plant.coulomb_friction, sensors.torque_noise and model.inertia_scale\n";
    assert!(said.contains(expected) && !said.contains("taskC: only"), "{said}");
}

/// Files of a scenario are beside it, whatever the current folder is; names of scenarios remain names.
#[test]
fn training_files_are_relative_to_the_scenario() {
    let sandbox = Sandbox::new();
    let training = "[training]\nscenarios = [\"taskC\", \"other.toml\", \"first/recording.csv\"]\n";
    std::fs::create_dir(sandbox.path("deep")).expect("it can be made");
    sandbox.write("deep/one.toml", &scenario(1.2, training));
    sandbox.write("deep/other.toml", &scenario(1.2, ""));
    sandbox.succeed(&words("--scenario deep/other.toml --model rigid-body --rerun off --out deep/first"));
    sandbox.succeed(&words("--scenario deep/one.toml --model hybrid --rerun off --out run"));
    let train = &sandbox.json("run/summary.json")["train"];
    assert_eq!(*train, serde_json::json!(["taskC", "deep/other.toml", "deep/first/recording.csv"]));
    // On the command line, they are relative to the current folder.
    let message = sandbox.refuse(&words("--scenario deep/one.toml --train other.toml --rerun off"));
    assert!(message.contains("other.toml: the scenario cannot be read"), "{message}");
}

#[test]
fn a_summary_describes_its_run() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &scenario(1.2, "[sensors]\ntorque_noise = 0.1\n"));
    sandbox.succeed(&run("--model hybrid --train one.toml --length-scales per-input --fade false"));
    let settings = sandbox.json("run/summary.json")["settings"].clone();
    assert_eq!(settings["path"], "one.toml");
    assert_eq!(settings["duration"], 0.5);
    let model =
        serde_json::json!({"kind": "hybrid", "inertia_scale": 1.2, "length_scales": "per-input", "fade": false});
    assert_eq!(settings["model"], model);
    let controller =
        serde_json::json!({"rate": 1000.0, "feedback": "mass-matrix", "kp": vec![100.0; 6], "kd": vec![20.0; 6]});
    assert_eq!(settings["controller"], controller);
    assert_eq!(settings["reference"]["sample_rate"], 80.0);
    assert_eq!(settings["training"]["samples"], 40);
    assert_eq!(settings["sensors"]["torque_noise"], serde_json::json!(vec![0.1; 6]));
    sandbox.succeed(&run("--model rigid-body"));
    let settings = sandbox.json("run/summary.json")["settings"].clone();
    assert_eq!(settings["model"], serde_json::json!({"kind": "rigid-body", "inertia_scale": 1.2}));
    assert_eq!(settings["training"]["samples"], 0);
}

#[test]
fn options_without_effect_are_noted() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &scenario(1.2, ""));
    let said = sandbox.noted(&run("--model rigid-body --inducing 30 --fade true --length-scales one --train taskA"));
    for option in ["--inducing", "--fade", "--length-scales", "--train"] {
        assert!(said.contains(&format!("{option} is ignored")), "{said}");
    }
}

#[test]
fn a_recording_without_accelerations_or_with_other_columns_is_refused_with_a_remedy() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &scenario(1.2, ""));
    let row = |prefix: &str| (1..=6).map(|joint| format!(",{prefix}_joint{joint}")).collect::<String>();
    let values = ",0".repeat(18);
    let csv = format!("t{}{}{}\n0{values}\n0.1{values}\n0.2{values}\n", row("q"), row("qd"), row("tau"));
    sandbox.write("robot.csv", &csv);
    let message = sandbox.refuse(&run("--model hybrid --train robot.csv"));
    assert!(message.contains("lacks the columns qdd_<joint> (rad/s²),"), "{message}");
    assert!(message.contains("central differences"), "{message}");
    sandbox.write("other.csv", "time,position_a,torque_a\n0,1,2\n1,1,2\n");
    let message = sandbox.refuse(&run("--model hybrid --train other.csv"));
    assert!(message.contains("other.csv:1: its columns") && !message.contains("map"), "{message}");
}
