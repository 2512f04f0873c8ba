//! The next experiment as a scenario file, which `testbed --scenario` runs and `docs/scenarios.md` describes.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, ensure};
use arm::Arm;
use diagnosis::NextExperiment;
use report::next_words::name;
use report::{numbers, words};
use torque::Reference;

use crate::scenario::writer;

/// The first line of a proposal, by which a file is recognised that may be replaced and removed.
const FIRST_LINE: &str = "# The next experiment, proposed by testbed diagnose.\n";

/// Refuses a `path` with a file that is not an earlier proposal.
///
/// # Errors
/// If the file exists and begins otherwise, or cannot be read.
pub fn check_replaceable(path: &Path) -> anyhow::Result<()> {
    ensure!(
        !path.is_file() || std::fs::metadata(path)?.len() == 0 || is_earlier(path)?,
        "--next {}: exists and is not a proposal of an earlier diagnosis; give another file",
        path.display()
    );
    Ok(())
}

/// Removes the proposal of an earlier diagnosis from `path` if this diagnosis proposes none, because the old motion would
/// be useless. Returns whether there was one.
///
/// # Errors
/// If it cannot be read or removed.
pub fn remove_earlier(path: &Path) -> anyhow::Result<bool> {
    if !path.is_file() || !is_earlier(path)? {
        return Ok(false);
    }
    std::fs::remove_file(path).with_context(|| path.display().to_string())?;
    Ok(true)
}

fn is_earlier(path: &Path) -> anyhow::Result<bool> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    Ok(bytes.starts_with(FIRST_LINE.as_bytes()))
}

/// Writes `motion` of `arm` to `path`, completely or not at all, with its purpose in comments. `robot` is the name or path
/// as the user gave it.
///
/// # Errors
/// If it cannot be written.
pub fn write(
    path: &Path,
    robot: &str,
    urdf: &Path,
    arm: &Arm,
    next: &NextExperiment,
    motion: &Reference,
) -> anyhow::Result<()> {
    let robot = writer::robot_from(path, robot, urdf)?;
    let text = text(&robot, arm, next, motion);
    recording::write_whole(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

fn text(robot: &str, arm: &Arm, next: &NextExperiment, motion: &Reference) -> String {
    let mut text = format!("{FIRST_LINE}#\n");
    let mut line = |words: &str| {
        let _ = writeln!(text, "# {words}");
    };
    if !next.separates.is_empty() {
        line(
            "It should distinguish (evidence against the second effect before and with this motion; evidence needed):",
        );
    }
    for pair in &next.separates {
        let [before, after, needed] = [pair.before, pair.after, pair.needed].map(numbers::short);
        let (finding, rival) = (name(&pair.finding), name(&pair.rival));
        line(&format!("  {finding} and {rival}: {before} -> {after} nats ({needed})"));
    }
    if !next.not_separated.is_empty() {
        line("It does not distinguish:");
    }
    for pair in &next.not_separated {
        let (finding, rival) = (name(&pair.finding), name(&pair.rival));
        line(&format!("  {finding} and {rival}: {}; {}", pair.because, pair.instead));
    }
    if !next.shows.is_empty() {
        line("It makes these effects testable, or testable at a smaller size (a torque limit: at a higher one):");
    }
    for shows in &next.shows {
        let before = shows.before.map_or_else(|| "not testable".to_owned(), numbers::short);
        let (effect, after) = (words::wording(shows.effect).name, numbers::short(shows.after));
        let joint = words::joint(shows.joint.as_deref());
        line(&format!("  {effect} on {joint}, {}: {before} -> {after}", shows.parameter));
    }
    line(
        "Required position, velocity and torque of each joint, and what is allowed (the URDF's limits with a margin, near the recorded range):",
    );
    for joint in &next.limits {
        let [low, high] = joint.position.map(numbers::short);
        let [least, most] = joint.position_allowed.map(numbers::short);
        let [speed, fastest] = [joint.velocity, joint.velocity_allowed].map(numbers::short);
        let [torque, strongest] = [joint.torque, joint.torque_allowed].map(numbers::short);
        line(&format!(
            "  {}: {low} to {high} of {least} to {most} rad or m; {speed} of {fastest} rad/s or m/s; {torque} of {strongest} N m or N",
            joint.joint
        ));
    }
    line("Collisions with the environment are not checked: run the motion slowly first.");
    line("On a robot, follow the columns reference_<joint> of the recording that this scenario writes.");
    let duration = next.duration.unwrap_or_default();
    text + &writer::scenario("The next experiment", robot, arm, duration, motion)
}

#[cfg(test)]
mod tests {
    use torque::{Fade, Sine};

    use super::*;
    use crate::scenario::Scenario;

    /// A proposal of an earlier diagnosis is replaced or removed; a file of the user is not.
    #[test]
    fn only_a_proposal_is_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).expect("it writes");
            path
        };
        let earlier = at("next.toml", &format!("{FIRST_LINE}#\nduration = 25.0\n"));
        assert!(check_replaceable(&earlier).is_ok());
        assert!(remove_earlier(&earlier).expect("it can be removed") && !earlier.exists());
        assert!(check_replaceable(&earlier).is_ok() && !remove_earlier(&earlier).expect("it is gone"));
        let own = at("task.toml", "title = \"mine\"\n");
        let refusal = check_replaceable(&own).expect_err("it is the user's").to_string();
        assert!(refusal.contains("task.toml") && refusal.contains("another file"), "{refusal}");
        assert!(!remove_earlier(&own).expect("it can be read") && own.exists());
    }

    /// A scenario that is loaded from the written file equals the motion bit for bit, whether the file is beside its URDF
    /// or elsewhere.
    #[test]
    fn a_proposal_is_loaded_as_written() {
        let next = NextExperiment {
            duration: Some(25.0),
            separates: Vec::new(),
            not_separated: Vec::new(),
            shows: Vec::new(),
            limits: Vec::new(),
        };
        let motion = Reference {
            centre: vec![0.1, -0.2, 0.3, 0.0, 0.5, 0.0],
            recorded: None,
            sines: vec![Sine {
                amplitude: vec![0.5, 0.25, 0.125, 0.1, 0.2, 1.0 / 3.0],
                frequency: vec![0.3, 0.4, 0.5, 0.6, 0.7, 1e-3],
                phase: vec![0.0, 1.0, -2.0, 3.0, 4.0, 6.2],
            }],
            fade: Some(Fade { seconds: 3.0, end: 25.0 }),
        };
        let folder = tempfile::tempdir().expect("a folder");
        let urdf = folder.path().join("my \"arm\".urdf");
        std::fs::write(&urdf, include_str!("../../../../assets/puma560.urdf")).expect("it writes");
        let arm = Arm::from_urdf(&urdf).expect("it loads");
        let elsewhere = tempfile::tempdir().expect("a folder");
        let robot = urdf.display().to_string();
        for (path, robot) in [
            (folder.path().join("next.toml"), robot.as_str()),
            (elsewhere.path().join("next.toml"), robot.as_str()),
            (folder.path().join("built_in.toml"), "puma560"),
        ] {
            write(&path, robot, &urdf, &arm, &next, &motion).expect("it writes");
            let scenario = Scenario::load(&path.display().to_string()).expect("it loads");
            assert_eq!(scenario.reference, motion);
            assert_eq!((scenario.duration, scenario.arm.dof()), (25.0, 6));
            assert!(!scenario.model.learns(), "it runs without training");
        }
    }
}
