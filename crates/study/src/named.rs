//! Recordings with the names that the robot gives to numbered joints, in any format.

use std::path::Path;

use arm::Arm;
use recording::{ColumnMap, Recording, RecordingError};

/// Reads the recording at `path`, with the names of the joints of `arm`.
///
/// # Errors
/// Those of [`Recording::read_with`].
pub fn read(path: &Path, map: Option<&ColumnMap>, arm: Option<&Arm>) -> Result<Recording, RecordingError> {
    let mut recording = Recording::read_with(path, map)?;
    if let Some(arm) = arm {
        name_joints(&mut recording, arm);
    }
    Ok(recording)
}

/// Gives joints that have numbers and no names those of `arm`, from base to tip, if there are as many.
pub fn name_joints(recording: &mut Recording, arm: &Arm) {
    let names: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
    if let Some(named) = named(&recording.joints, &names) {
        recording.joints = named;
    }
}

/// The joints of `recording`, by which an arm is chosen among a robot's joints; none if they only have numbers.
pub fn named_joints(recording: &Recording) -> &[String] {
    if recording.joints.iter().all(|joint| joint.parse::<usize>().is_ok()) {
        return &[];
    }
    &recording.joints
}

/// The names of numbered joints, in order; none if they are not numbered, or if there are not as many.
fn named(joints: &[String], names: &[&str]) -> Option<Vec<String>> {
    let numbers: Vec<usize> = joints.iter().map(|joint| joint.parse().ok()).collect::<Option<_>>()?;
    // A robot may have joints with such names.
    if joints.len() != names.len() || names.iter().any(|name| joints.iter().any(|joint| joint == name)) {
        return None;
    }
    let rank = |number: &usize| numbers.iter().filter(|other| *other < number).count();
    Some(numbers.iter().map(|number| names[rank(number)].to_owned()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbered_joints_get_the_arms_names_from_base_to_tip() {
        let joints = |text: &str| -> Vec<String> { text.split(' ').map(str::to_owned).collect() };
        let named = |text: &str, names: &[&str]| named(&joints(text), names);
        assert_eq!(named("0 1 2", &["a", "b", "c"]), Some(joints("a b c")));
        assert_eq!(named("10 9 1", &["a", "b", "c"]), Some(joints("c b a")));
        assert_eq!(named("0 1", &["a", "b", "c"]), None);
        assert_eq!(named("0 elbow", &["a", "b"]), None);
        assert_eq!(named("0 1", &["1", "0"]), None);
    }
}
