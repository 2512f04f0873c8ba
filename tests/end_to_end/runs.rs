//! Runs of scenarios, through the built program: what they print, leave behind and repeat.

use crate::support::{Sandbox, words};

/// A short run of the PUMA 560 with `extra` lines.
fn short_scenario(extra: &str) -> String {
    format!(
        "robot = \"puma560\"\nduration = 0.5\n[model]\ninertia_scale = 1.2\n[reference]\namplitude = 0.5\n\
         frequency_1 = 0.4\nfrequency_2 = 0.7\n{extra}"
    )
}

const SLIDER: &str = r#"<robot name="slider"><link name="rail"/>
<link name="carriage"><inertial><mass value="95"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="x" type="prismatic"><parent link="rail"/><child link="carriage"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="500" velocity="2"/></joint></robot>"#;

#[test]
fn the_main_job_leaves_a_recording_and_a_summary() {
    let sandbox = Sandbox::new();
    let printed = sandbox.succeed(&["--scenario", "taskD", "--model", "rigid-body", "--rerun", "off"]);
    assert!(printed.contains("joint6") && printed.contains("real-time factor"), "{printed}");
    assert_eq!(sandbox.list("runs"), ["001-taskD-rigid-body"]);
    assert_eq!(sandbox.list("runs/001-taskD-rigid-body"), ["recording.csv", "summary.json"]);
    let summary = sandbox.json("runs/001-taskD-rigid-body/summary.json");
    assert_eq!(summary["tracking"][0]["model"], "rigid_body");
    assert_eq!(summary["tracking"][0]["rms_error_rad"].as_array().map(Vec::len), Some(6));
    assert!(summary["real_time_factor"].as_f64().is_some_and(|factor| factor > 0.0));
    assert!(summary["control_step_us"]["p99"].as_f64() >= summary["control_step_us"]["median"].as_f64());
    let error = summary["torque_mse"][1].as_f64().expect("a number");
    assert!((error - 46.5).abs() < 0.1, "{error}");
    let recording =
        std::fs::read_to_string(sandbox.path("runs/001-taskD-rigid-body/recording.csv")).expect("it is there");
    assert_eq!(recording.lines().count(), 10_001);
    assert!(recording.starts_with("t,q_joint1,"));
}

#[test]
fn joints_that_hardly_learn_are_named_and_length_scales_are_chosen() {
    let sandbox = Sandbox::new();
    let scenario = |model: &str| short_scenario("").replace("[model]\n", &format!("[model]\n{model}"));
    // Half a second of another motion teaches nothing about this one.
    sandbox.write("other.toml", &short_scenario("").replace("frequency_1 = 0.4", "frequency_1 = 3.0"));
    sandbox.write("one.toml", &scenario("kind = \"gp\"\n"));
    let run = |file: &str, more: &[&str]| {
        let usual = ["--scenario", file, "--rerun", "off", "--json", "s.json"];
        sandbox.succeed(&[&usual[..], more].concat())
    };
    let printed = run("one.toml", &["--train", "other.toml", "--fade", "false"]);
    assert!(
        printed.contains("With the learned torque, the RMS torque error is larger than the rigid body's on joint1 ("),
        "{printed}"
    );
    assert!(printed.contains("--length-scales per-input"), "{printed}");
    let scales = || {
        let summary = sandbox.json("s.json");
        summary["regressions"][0]["length_scales"].as_array().map(Vec::len)
    };
    assert_eq!(scales(), Some(1));
    sandbox.write("each.toml", &scenario("kind = \"gp\"\nlength_scales = \"per-input\"\n"));
    run("each.toml", &["--train", "other.toml"]);
    assert_eq!(scales(), Some(18));
    run("each.toml", &["--train", "other.toml", "--length-scales", "one"]);
    assert_eq!(scales(), Some(1));
    let printed = run("one.toml", &["--train", "one.toml"]);
    assert!(!printed.contains("torque error on") && !printed.contains("--length-scales"), "{printed}");
    sandbox.write("wrong.toml", &scenario("length_scales = \"two\"\n"));
    let message = sandbox.refuse(&["--scenario", "wrong.toml"]);
    assert!(message.contains("known: one, per-input"), "{message}");
}

#[test]
fn an_approximation_says_how_far_off_it_is() {
    let sandbox = Sandbox::new();
    sandbox.write("one.toml", &short_scenario("[training]\nscenarios = [\"taskC\"]\n[sensors]\ntorque_noise = 0.5\n"));
    let run = |more: &[&str]| {
        let usual = ["--scenario", "one.toml", "--rerun", "off", "--json", "s.json"];
        let printed = sandbox.succeed(&[&usual[..], more].concat());
        let summary = sandbox.json("s.json");
        let conditioning = summary["regressions"][1]["conditioning"].as_str().expect("a sentence");
        (printed, conditioning.to_owned())
    };
    let (printed, conditioning) = run(&["--inducing", "30"]);
    assert!(printed.contains("approximated by 30 inducing points"), "{printed}");
    assert!(conditioning.starts_with("30 inducing points"), "{conditioning}");
    let (printed, conditioning) = run(&[]);
    assert!(!printed.contains("inducing"), "{printed}");
    assert!(!conditioning.contains("inducing"), "{conditioning}");
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_threads() {
    let sandbox = Sandbox::new();
    let noisy = short_scenario("[sensors]\nposition_noise = 1e-4\nvelocity_noise = 1e-3\ntorque_noise = 0.1\n");
    sandbox.write("noisy.toml", &noisy);
    let record = |seed: &str, out: &str, threads: &str| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_testbed"))
            .args(words("--scenario noisy.toml --model independent-joint-13 --train noisy.toml"))
            .args(["--rerun", "off", "--seed", seed, "--out", out])
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(sandbox.path(""))
            .output()
            .expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(sandbox.path(out).join("recording.csv")).expect("it is there")
    };
    let first = record("1", "a", "1");
    assert!(first == record("1", "b", "2"), "two runs with one seed differ");
    assert!(first != record("2", "c", "2"), "two seeds give the same noise");
}

#[test]
fn a_model_learns_from_the_recording_of_a_run() {
    let sandbox = Sandbox::new();
    sandbox.write("short.toml", &short_scenario(""));
    sandbox.succeed(&words("--scenario short.toml --model rigid-body --rerun off --out first"));
    let train = ["--train", "first/recording.csv"];
    let learn = words("--scenario short.toml --model independent-joint-13 --rerun off --json s.json");
    sandbox.succeed(&[&learn[..], &train].concat());
    let before = sandbox.json("first/summary.json");
    let after = sandbox.json("s.json");
    let error = |summary: &serde_json::Value| summary["tracking"][0]["rms_error_rad"][1].as_f64().expect("a number");
    assert!(error(&after) < 0.1 * error(&before), "{} after {}", error(&after), error(&before));
}

#[test]
fn any_arm_runs_with_drives_and_friction() {
    let sandbox = Sandbox::new();
    sandbox.write("slider.urdf", SLIDER);
    let text = "robot = \"slider.urdf\"\nduration = 2\n[reference]\ncentre = 0.1\n[[reference.sines]]\namplitude = 0.1\n\
                frequency = 0.5\nphase = 1.0\n[controller]\nfeedback = \"gains\"\nkp = 20000\nkd = 2000\n\
                [plant]\nrotor_inertia = 5\nviscous_friction = 203.5\ncoulomb_friction = 20.39\n";
    sandbox.write("slider.toml", text);
    let printed = sandbox.succeed(&words("--scenario slider.toml --model true --rerun off --json s.json"));
    assert!(printed.contains("mm"), "{printed}");
    // Friction is all that the exact rigid-body model leaves to the feedback: about (20.4 + 203.5 × .22) / 20000 m.
    let error = sandbox.json("s.json")["tracking"][0]["rms_error_rad"][0].as_f64().expect("a number");
    assert!((1e-3..5e-3).contains(&error), "{error}");
}

#[test]
fn every_model_runs_on_arms_of_one_and_of_four_joints() {
    let sandbox = Sandbox::new();
    sandbox.write("slider.urdf", SLIDER);
    let four = crate::support::root().join("crates/arm/tests/robots/prismatic.urdf");
    std::fs::copy(four, sandbox.path("prismatic.urdf")).expect("it can be copied");
    for robot in ["slider", "prismatic"] {
        let scenario =
            short_scenario("").replace("puma560", &format!("{robot}.urdf")).replace("= 0.5\nfreq", "= 0.1\nfreq");
        sandbox.write("r.toml", &scenario);
        for model in [
            "true",
            "rigid-body",
            "gp",
            "hybrid",
            "independent-joint",
            "independent-joint-own-frame",
            "independent-joint-13",
            "lagrangian",
            "lagrangian-only",
        ] {
            sandbox.succeed(&words(&format!(
                "--scenario r.toml --model {model} --train r.toml --rerun off --json s.json"
            )));
            let error = sandbox.json("s.json")["torque_mse"][0].as_f64().expect("a number");
            // The twelve inputs do not show a carriage's acceleration: on a slider they are all zero.
            let limit = if matches!(model, "rigid-body" | "independent-joint" | "independent-joint-own-frame") {
                1e4
            } else {
                1e-2
            };
            assert!(error <= limit, "{robot} under {model}: {error}");
        }
    }
}

#[test]
fn a_gap_in_a_recording_does_not_multiply_its_samples() {
    let sandbox = Sandbox::new();
    sandbox.write("slider.urdf", SLIDER);
    sandbox.write("r.toml", &short_scenario("").replace("puma560", "slider.urdf"));
    let mut csv = "t,q_x,qd_x,qdd_x,tau_x\n".to_owned();
    for k in 0..500 {
        // 1 kHz, with a gap of five seconds in the middle.
        let t = f64::from(k) * 1e-3 + if k >= 250 { 5.0 } else { 0.0 };
        csv += &format!("{t},{},{},{},{}\n", t.sin(), t.cos(), -t.sin(), -95.0 * t.sin());
    }
    sandbox.write("r.csv", &csv);
    sandbox.succeed(&words("--scenario r.toml --model gp --train r.csv --rerun off --json s.json"));
    let summary = sandbox.json("s.json");
    let text = summary["regressions"][0]["conditioning"].as_str().expect("a text");
    // 80 Hz of half a second: 20 samples before the gap and 20 after it.
    assert!(text.contains("of 40 samples"), "{text}");
}

#[test]
fn a_reader_that_stops_reading_is_no_error() {
    let sandbox = Sandbox::new();
    sandbox.write("short.toml", &short_scenario(""));
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_testbed"))
        .args(["--scenario", "short.toml", "--model", "true", "--rerun", "off"])
        .current_dir(sandbox.path(""))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[cfg(feature = "viewer")]
#[test]
fn the_run_is_saved_for_the_viewer() {
    let sandbox = Sandbox::new();
    sandbox.write("short.toml", &short_scenario(""));
    sandbox.succeed(&["--scenario", "short.toml", "--model", "true", "--out", "a"]);
    assert_eq!(sandbox.list("a"), ["recording.csv", "run.rrd", "summary.json"]);
    sandbox.succeed(&words("--scenario short.toml --model true --out b --rerun save=here.rrd"));
    assert_eq!(sandbox.list("b"), ["recording.csv", "summary.json"]);
    let bytes = std::fs::read(sandbox.path("here.rrd")).expect("it is there");
    assert!(bytes.starts_with(b"RRF") && bytes.len() > 10_000);
    // What cannot be saved for the viewer does not cost the run.
    let message = sandbox.refuse(&["--scenario", "short.toml", "--model", "true", "--rerun", "save=b"]);
    assert!(message.contains("is a folder"), "{message}");
    // Nothing listens at this port: the run goes on without a viewer.
    let url = "connect=rerun+http://127.0.0.1:9/proxy";
    sandbox.succeed(&words(&format!("--scenario short.toml --model true --out c --rerun {url}")));
}
