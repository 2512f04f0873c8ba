//! Diagnoses recordings of a robot and prints the report as JSON.
//!
//! ```sh
//! cargo run --release -p diagnosis --example diagnose -- robot.urdf train_1.csv train_2.csv -- held_out.csv
//! ```

use std::path::Path;

use arm::Arm;
use diagnosis::{Input, Options, diagnose};
use recording::{Recording, RegularRecording};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (robot, files) = arguments.split_first().ok_or("usage: ROBOT.urdf TRAIN… -- HELD_OUT…")?;
    let arm = Arm::from_urdf(robot)?;
    let mut recordings: Vec<(&str, RegularRecording, bool)> = Vec::new();
    let mut held_out = false;
    for file in files {
        if file == "--" {
            held_out = true;
            continue;
        }
        let (regular, _) = Recording::read(Path::new(file))?.regular()?;
        recordings.push((file, in_order(regular, &arm)?, held_out));
    }
    let inputs: Vec<Input<'_>> = recordings
        .iter()
        .map(|(name, recording, held_out)| Input {
            name,
            recording,
            held_out: *held_out,
            before: false,
        })
        .collect();
    let diagnosis = diagnose(&arm, &inputs, &Options::default(), &|_| ())?;
    for remark in &diagnosis.remarks {
        eprintln!("note: {remark}");
    }
    println!("{}", serde_json::to_string_pretty(&diagnosis.report)?);
    Ok(())
}

/// The recording with its joints in the arm's order.
fn in_order(mut recording: RegularRecording, arm: &Arm) -> Result<RegularRecording, String> {
    let names = arm.joints().iter().map(|joint| joint.name.clone());
    let places: Vec<usize> = names
        .map(|name| {
            let place = recording.joints.iter().position(|known| *known == name);
            place.ok_or_else(|| format!("the recording has no joint {name}"))
        })
        .collect::<Result<_, _>>()?;
    let pick = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> { places.iter().map(|&place| signals[place].clone()).collect() };
    recording.q = pick(&recording.q);
    recording.tau = pick(&recording.tau);
    recording.joints = places.iter().map(|&place| recording.joints[place].clone()).collect();
    Ok(recording)
}
