//! `testbed diagnose --next`: a scenario that the program runs as it is, whose recording can be diagnosed beside the others.

use crate::diagnose_made::{Case, ELBOW, Motion, SHOULDER, trio};

/// Friction that is told from drag by nothing but a wider range of speeds.
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
    let told = next["separates"].as_array().expect("a list");
    assert!(!told.is_empty(), "{next:#}");
    assert!(printed.contains("- next: a motion of 25 s"), "{printed}");
    assert!(case.text("page.html").contains("The next experiment"));
    // As it is, and on the user's own robot.
    let ran = case
        .sandbox
        .succeed(&["--scenario", "next.toml", "--rerun", "off", "--out", "made"]);
    assert!(ran.contains("rigid-body"), "{ran}");
    let recording = case.text("made/recording.csv");
    let header = recording.lines().next().expect("a header");
    assert!(header.contains("reference_elbow"), "{header}");
    assert_eq!(recording.lines().count(), 25_001);
    // Not asked for, not there.
    assert!(case.json(&[]).get("next_experiment").is_none());
}
