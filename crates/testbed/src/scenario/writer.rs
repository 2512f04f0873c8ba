//! Scenarios as testbed writes them: a motion, tracked with the rigid-body model by a stiff controller.

use std::fmt::Write;
use std::path::Path;

use anyhow::Context;
use arm::{Arm, FixedBecause, FixedJoint};
use torque::Reference;

use study::robot;

/// The name of the robot in a scenario at `path`: `robot` if it comes with testbed, otherwise the path of `urdf` relative
/// to the scenario.
///
/// # Errors
/// If the URDF or the scenario's folder does not exist.
pub fn robot_from(path: &Path, robot: &str, urdf: &Path) -> anyhow::Result<String> {
    if robot::is_built_in(robot) { Ok(robot.to_owned()) } else { beside(path, urdf) }
}

/// The path of `urdf` for a file at `path`: its name if both are in the same folder, otherwise its absolute path.
fn beside(path: &Path, urdf: &Path) -> anyhow::Result<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let absolute = |path: &Path| path.canonicalize().with_context(|| path.display().to_string());
    let (folder, urdf) = (absolute(folder.unwrap_or(Path::new(".")))?, absolute(urdf)?);
    let place = urdf.strip_prefix(&folder).unwrap_or(&urdf);
    Ok(place.display().to_string())
}

/// The text of the scenario after its comments; it begins with an empty line. Numbers are read back bit for bit.
pub fn scenario(title: &str, robot: &str, arm: &Arm, duration: f64, motion: &Reference) -> String {
    let mut text = String::new();
    let list = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        format!("[{}]", words.join(", "))
    };
    let _ = writeln!(
        text,
        "\ntitle = \"{title}\"\nrobot = {}\nduration = {duration:?}\n{}\n[model]\nkind = \"rigid-body\"\n\n[controller]\nkp = 10000.0\nkd = 200.0\n\n[reference]\ncentre = {}",
        toml::Value::String(robot.to_owned()),
        chain(arm),
        list(&motion.centre)
    );
    if let Some(fade) = &motion.fade {
        let _ = writeln!(text, "fade = {:?}", fade.seconds);
    }
    for sine in &motion.sines {
        let [amplitude, frequency, phase] = [&sine.amplitude, &sine.frequency, &sine.phase].map(|values| list(values));
        let _ =
            writeln!(text, "\n[[reference.sines]]\namplitude = {amplitude}\nfrequency = {frequency}\nphase = {phase}");
    }
    text
}

/// The table that selects the arm among the robot's joints; empty if all joints belong to the arm.
fn chain(arm: &Arm) -> String {
    if arm.fixed_joints().is_empty() {
        return String::new();
    }
    let word = |text: &str| toml::Value::String(text.to_owned()).to_string();
    // The others are fixed there by default, beside the tip.
    let is_asked = |joint: &&FixedJoint| matches!(joint.reason, FixedBecause::Locked | FixedBecause::NotRecorded);
    let locks: Vec<String> = arm
        .fixed_joints()
        .iter()
        .filter(is_asked)
        .map(|joint| format!("{} = {:?}", word(&joint.name), joint.position))
        .collect();
    format!(
        "\n[chain]\nbase = {}\ntip = {}\nlock = {{ {} }}\n",
        word(arm.base_link()),
        word(&arm.tool_frame().name),
        locks.join(", ")
    )
}
