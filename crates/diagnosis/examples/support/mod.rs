//! Recordings for the examples.

use std::error::Error;
use std::path::Path;

use arm::Arm;
use recording::{Recording, RegularRecording};

/// The recording in `file` on its regular clock, with its joints in the arm's order.
pub fn read(arm: &Arm, file: &Path) -> Result<RegularRecording, Box<dyn Error>> {
    let (mut recording, _) = Recording::read_windows(file, None, diagnosis::WORTH_HOLDING)?.regular()?;
    let names = arm.joints().iter().map(|joint| joint.name.clone());
    let places: Vec<usize> = names
        .map(|name| {
            let place = recording.joints.iter().position(|known| *known == name);
            place.ok_or_else(|| format!("{}: the recording has no joint {name}", file.display()))
        })
        .collect::<Result<_, _>>()?;
    let pick = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> { places.iter().map(|&place| signals[place].clone()).collect() };
    recording.q = pick(&recording.q);
    recording.tau = pick(&recording.tau);
    recording.joints = places.iter().map(|&place| recording.joints[place].clone()).collect();
    Ok(recording)
}
