//! Recordings that the tests of the diagnosis make themselves: a known motion, the rigid torque, and what is injected.

use std::fmt::Write;
use std::path::PathBuf;

use arm::{Arm, Workspace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use serde_json::Value;

use crate::support::Sandbox;

#[path = "../../crates/diagnosis/tests/support/mod.rs"]
mod made;
pub use made::{ELBOW, Motion, SHOULDER, TRIO as URDF, TURN, trio};

/// A recording of `seconds` at 250 Hz of the robot that is `arm` with the torques `injected`.
pub fn recording(arm: &Arm, variant: usize, seconds: f64, injected: &dyn Fn(&Motion, &mut [f64])) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(variant as u64);
    let noise = Normal::new(0.0, 0.02).expect("a spread");
    let mut workspace = Workspace::new(arm);
    let mut text = "t,q_turn,q_shoulder,q_elbow,tau_turn,tau_shoulder,tau_elbow\n".to_owned();
    let mut tau = [0.0; 3];
    for k in 0..(250.0 * seconds) as usize {
        let time = k as f64 / 250.0;
        let motion = made::motion(3, time, variant);
        arm.inverse_dynamics(&mut workspace, &motion.q, &motion.qd, &motion.qdd, &mut tau);
        injected(&motion, &mut tau);
        let _ = write!(text, "{:.4}", time + 40.0 * variant as f64);
        for q in &motion.q {
            let _ = write!(text, ",{q:.6}");
        }
        for tau in tau {
            let _ = write!(text, ",{:.5}", tau + noise.sample(&mut random));
        }
        text.push('\n');
    }
    text
}

/// A robot of which there are recordings, and its diagnosis.
pub struct Case {
    /// Where its files are: `robot.urdf`, `a.csv` and `b.csv` to train, `c.csv` held out.
    pub sandbox: Sandbox,
}

impl Case {
    /// Recordings of `arm` with the torques `injected`, beside the URDF that its user believes.
    pub fn new(arm: &Arm, injected: &dyn Fn(&Motion, &mut [f64])) -> Self {
        let sandbox = Sandbox::new();
        sandbox.write("robot.urdf", URDF);
        for (variant, name, seconds) in [(0, "a.csv", 16.0), (1, "b.csv", 16.0), (2, "c.csv", 10.0)] {
            sandbox.write(name, &recording(arm, variant, seconds, injected));
        }
        Self { sandbox }
    }

    /// What `testbed diagnose` prints, with further arguments.
    pub fn diagnose(&self, further: &[&str]) -> String {
        self.sandbox.succeed(&arguments(further))
    }

    /// The diagnosis as JSON, with further arguments.
    pub fn json(&self, further: &[&str]) -> Value {
        let mut list = vec!["--json", "diagnosis.json"];
        list.extend(further);
        self.diagnose(&list);
        self.sandbox.json("diagnosis.json")
    }

    /// A file's path.
    pub fn path(&self, name: &str) -> PathBuf {
        self.sandbox.path(name)
    }

    /// A file's text.
    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect("the file is there")
    }
}

/// The command on a [`Case`]'s files.
pub fn arguments<'a>(further: &[&'a str]) -> Vec<&'a str> {
    let mut list = vec!["diagnose", "--robot", "robot.urdf", "--train", "a.csv", "b.csv"];
    list.extend(["--held-out", "c.csv"]);
    list.extend(further);
    list
}

/// What was found: effect and joint, sorted.
pub fn names(diagnosis: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap_or("whole arm").to_owned();
    let findings = diagnosis["findings"].as_array().expect("a list");
    let mut names: Vec<_> =
        findings.iter().map(|finding| (text(&finding["effect"]), text(&finding["joint"]))).collect();
    names.sort();
    names
}

/// The finding of `effect` on `joint`.
pub fn finding<'a>(diagnosis: &'a Value, effect: &str, joint: &str) -> &'a Value {
    let findings = diagnosis["findings"].as_array().expect("a list");
    findings
        .iter()
        .find(|finding| finding["effect"] == effect && finding["joint"] == joint)
        .unwrap_or_else(|| panic!("no {effect} on {joint} in {:?}", names(diagnosis)))
}

/// Checks that a parameter is within `tolerance` (a part of it) of `truth`, and its interval contains it.
pub fn is_found(finding: &Value, parameter: &str, truth: f64, tolerance: f64) {
    let found = &finding["parameters"][parameter];
    let number = |value: &Value| value.as_f64().expect("a number");
    let value = number(&found["value"]);
    assert!((value / truth - 1.0).abs() <= tolerance, "{parameter} is {value} instead of {truth}");
    let (low, high) = (number(&found["ci95"][0]), number(&found["ci95"][1]));
    assert!(low < truth && truth < high, "{truth} is not in {low} … {high}");
    assert!(found["unit"].is_string());
}
