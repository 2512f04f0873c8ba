//! `testbed diagnose --next`: a scenario that the program runs as it is, whose recording can be diagnosed beside the others.

use serde_json::Value;

use crate::diagnose_made::{Case, ELBOW, Motion, SHOULDER, URDF, arguments, trio};

/// Friction that only a wider range of speeds distinguishes from drag.
fn friction(motion: &Motion, tau: &mut [f64]) {
    for (joint, level, coefficient) in [(SHOULDER, 0.8, 0.18), (ELBOW, 0.4, 0.084)] {
        let speed = motion.qd[joint];
        tau[joint] += level * speed.signum() + coefficient * speed;
    }
}

#[test]
fn the_proposed_motion_is_a_scenario_that_runs() {
    let case = Case::new(&trio(), &friction);
    let printed = case.diagnose(&["--json", "d.json", "--next", "next.toml", "--report", "page.html"]);
    assert!(printed.contains("written: next.toml"), "{printed}");
    let found = case.sandbox.json("d.json");
    let next = &found["next_experiment"];
    assert_eq!(next["duration"], 25.0);
    let distinguished = next["separates"].as_array().expect("a list");
    assert!(!distinguished.is_empty(), "{next:#}");
    assert!(printed.contains("- next experiment: a motion of 25 s"), "{printed}");
    let page = case.text("page.html");
    assert!(page.contains("What to do next") && page.contains("a motion of 25 s"));
    // As it is, and on the user's own robot.
    let ran = case.sandbox.succeed(&["--scenario", "next.toml", "--rerun", "off", "--out", "made"]);
    assert!(ran.contains("rigid-body"), "{ran}");
    let recording = case.text("made/recording.csv");
    let header = recording.lines().next().expect("a header");
    assert!(header.contains("reference_elbow"), "{header}");
    assert_eq!(recording.lines().count(), 25_001);
    // Without --next, no file is written.
    assert!(case.json(&[]).get("next_experiment").is_none());
}

/// Where nothing is proposed, the motion of an earlier diagnosis does not stay to be run; a file of the user's is never replaced.
#[test]
fn an_earlier_motion_does_not_stay_and_a_users_file_does() {
    let case = Case::new(&trio(), &friction);
    let weak = URDF.replace("effort=\"200\"", "effort=\"0.01\"");
    case.sandbox.write("robot.urdf", &weak);
    let earlier = "# The next experiment, proposed by testbed diagnose.\n#\nduration = 25.0\n";
    case.sandbox.write("next.toml", earlier);
    let printed = case.diagnose(&["--json", "d.json", "--next", "next.toml"]);
    assert_eq!(case.sandbox.json("d.json")["next_experiment"]["duration"], Value::Null);
    assert!(printed.contains("removed: next.toml of an earlier diagnosis"), "{printed}");
    assert!(!printed.contains("written: next.toml") && !case.sandbox.path("next.toml").exists());
    case.sandbox.write("task.toml", "title = \"mine\"\n");
    let refused = case.sandbox.refuse(&arguments(&["--next", "task.toml"]));
    assert!(refused.contains("task.toml: exists and is not a proposal"), "{refused}");
    assert_eq!(case.text("task.toml"), "title = \"mine\"\n");
}
