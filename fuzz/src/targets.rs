//! One function a kind of file: what testbed does with it before anything is computed. None may panic, whatever the bytes.

use std::io::Write;
use std::path::Path;

use arm::{Arm, Workspace};
use recording::{ColumnMap, Quality, Recording};
use study::Source;
use study::effect_file::EffectFile;

/// The shape of a scenario, as the program reads it; the keys are not looked at here.
#[allow(dead_code, reason = "the program's own module, of which only the reading is used here")]
#[path = "../../crates/testbed/src/scenario/raw.rs"]
mod raw;

/// The robot of the targets that need one.
const ROBOT: &str = include_str!("../../tests/cases/arm.urdf");

/// A small file for column maps.
const TABLE: &[u8] =
    b"t,sec,nsec,run,name,a,b,c,d\n0,0,0,1,x,1,2,3,4\n0.1,0,100000000,1,x,2,3,4,5\n0.2,0,200000000,1,x,3,4,5,6\n";

fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}

/// Reads a robot, and moves it.
pub fn urdf(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let Ok(arm) = Arm::from_urdf_text(text, "robot.urdf") else {
        return;
    };
    let n = arm.dof();
    let (at, mut tau) = (vec![0.1; n], vec![0.0; n]);
    arm.inverse_dynamics(&mut Workspace::new(&arm), &at, &at, &at, &mut tau);
    assert!(arm.joints().iter().all(|joint| joint.inertia.mass >= 0.0));
    let _ = study::urdf_file::corrected_urdf(text, &arm, &[]);
    let _ = study::mjcf_file::mjcf(&arm, &[]);
}

fn recorded(bytes: &[u8], map: Option<&ColumnMap>) {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file can be made");
    file.write_all(bytes).expect("it can be written");
    let Ok(recording) = Recording::read_with(file.path(), map) else {
        return;
    };
    for warning in &recording.warnings {
        let _ = warning.to_string();
    }
    let Ok((regular, _)) = recording.regular() else { return };
    assert!(regular.q.iter().chain(&regular.tau).flatten().all(|value| value.is_finite()));
    let _ = Quality::of(&recording, &regular);
}

/// Reads a recording of any format, and puts it on its clock.
pub fn recording(bytes: &[u8]) {
    recorded(bytes, None);
}

/// Reads a column map, and a table by it.
pub fn column_map(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    if let Ok(map) = ColumnMap::parse(text, Path::new("map.toml")) {
        recorded(TABLE, Some(&map));
    }
}

/// Reads a scenario.
pub fn scenario(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let source = Source { name: "scenario".to_owned(), path: "scenario.toml".into(), text: text.to_owned() };
    let _ = raw::parse(&source);
}

/// Reads a corrected model, and writes it in every form.
pub fn model(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let arm = Arm::from_urdf_text(ROBOT, "arm.urdf").expect("the robot is good");
    let Ok(file) = EffectFile::parse(text.to_owned(), Path::new("model.toml"), &arm) else {
        return;
    };
    let again = file.to_text().expect("what was read can be written");
    let again = EffectFile::parse(again, Path::new("again.toml"), &arm).expect("what was written can be read");
    assert_eq!(again.effects.len(), file.effects.len());
    let _ = study::urdf_file::corrected_urdf(ROBOT, &arm, &file.effects);
    let _ = study::mjcf_file::mjcf(&arm, &file.effects);
}

/// Reads a ground truth, as the injection and as the scoring do.
pub fn truth(bytes: &[u8]) {
    let arm = Arm::from_urdf_text(ROBOT, "arm.urdf").expect("the robot is good");
    if let Ok(truth) = serde_json::from_slice::<faults::Truth>(bytes) {
        for injected in &truth.injected {
            let _ = injected.check(&arm);
        }
    }
    if let Ok(truth) = serde_json::from_slice::<scoring::Truth>(bytes) {
        let _ = truth.of_note().map(|injected| injected.name().len()).sum::<usize>();
        let _ = truth.torque_unit(Some("turn"));
    }
}
