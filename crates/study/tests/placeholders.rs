//! Diagnoses of a robot whose URDF has placeholders of moments of inertia.

mod support;

use std::path::Path;

use diagnosis::Verdict;
use study::inputs::{Given, Recordings};
use study::{Diagnosed, Request};

use support::Heard;

/// A diagnosis of the double pendulum with the robot in `folder`, and its notes.
fn diagnosed(folder: &Path, urdf_accuracy: Option<f64>) -> (Diagnosed, String) {
    let file = |name: &str| Given::File(format!("../../examples/double_pendulum/{name}.csv.gz").into());
    let recordings = Recordings { train: vec![file("r143339"), file("r143524")], ..Recordings::default() };
    let robot = folder.join("robot.urdf").display().to_string();
    let request = Request { robot, recordings, urdf_accuracy, torques_only: true, ..Request::default() };
    let heard = Heard::default();
    let diagnosed = request.run(&heard).expect("it is diagnosed");
    (diagnosed, heard.0.into_inner().join("\n"))
}

/// With 1 kg m² on both links, the recordings of a double pendulum of 0.5 kg a link are not called those of another unit, and the links get
/// moments that such bodies have. An exact URDF is taken as it is.
#[test]
fn recordings_are_not_checked_against_placeholders() {
    let text = std::fs::read_to_string("../../examples/double_pendulum/robot.urdf").expect("it is there");
    let urdf = with_placeholders(&text);
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("robot.urdf"), urdf).expect("it is written");
    let (found, notes) = diagnosed(folder.path(), None);
    assert!(notes.contains("link1, link2 are one number"), "{notes}");
    let report = &found.diagnosis.report;
    assert!(report.verdict != Verdict::UnitsFirst && report.doubts.is_empty(), "{:?}", report.doubts);
    let names: Vec<&str> = found.effects.iter().map(effects::Effect::name).collect();
    assert!(names.contains(&"inertial_parameters"), "{names:?}");
    let (exact, notes) = diagnosed(folder.path(), Some(0.0));
    assert!(!notes.contains("one number"), "{notes}");
    assert!(!exact.effects.iter().any(|effect| effect.name() == "inertial_parameters"));
}

/// The URDF with 1 kg m² for every moment of inertia.
fn with_placeholders(text: &str) -> String {
    let mut parts = text.split("<inertia ");
    let first = parts.next().unwrap_or_default().to_owned();
    let ones = r#"<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>"#;
    parts.fold(first, |text, part| text + ones + part.split_once("/>").map_or("", |(_, rest)| rest))
}
