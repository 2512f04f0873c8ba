//! Diagnoses recordings of a robot and prints the report as JSON.
//!
//! ```sh
//! cargo run --release -p diagnosis --example diagnose -- robot.urdf train_1.csv train_2.csv -- held_out.csv
//! ```

use std::path::Path;

use arm::Arm;
use diagnosis::{Input, Options, diagnose};
use recording::RegularRecording;

mod support;

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
        recordings.push((file, support::read(&arm, Path::new(file))?, held_out));
    }
    let inputs: Vec<Input<'_>> = recordings
        .iter()
        .map(|(name, recording, held_out)| Input { name, recording, held_out: *held_out, before: false })
        .collect();
    let diagnosis = diagnose(&arm, &inputs, &Options::default(), &|_| ())?;
    for remark in &diagnosis.remarks {
        eprintln!("note: {remark}");
    }
    println!("{}", serde_json::to_string_pretty(&diagnosis.report)?);
    Ok(())
}
