//! Varies the most decisive thresholds by ±20 %, one at a time, and prints the macro F1 of the open cases at each value.
//!
//! ```sh
//! cargo run --release -p diagnosis --example thresholds -- case_003 truth/case_003.json case_011 truth/case_011.json
//! ```
//!
//! A case is a folder with `robot.urdf`, `train_*.csv` and `held_out.csv`, and the file with its ground truth.

use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

use arm::Arm;
use diagnosis::{Input, Options, Thresholds, diagnose};
use recording::RegularRecording;
use scoring::{Tried, Truth, score};

mod support;

/// A case that is diagnosed with varied thresholds.
struct Case {
    arm: Arm,
    recordings: Vec<(RegularRecording, bool)>,
    truth: Truth,
}

impl Case {
    fn read(folder: &Path, truth: &Path) -> Result<Self, Box<dyn Error>> {
        let arm = Arm::from_urdf(folder.join("robot.urdf"))?;
        let mut files: Vec<PathBuf> = std::fs::read_dir(folder)?
            .map(|entry| Ok(entry?.path()))
            .collect::<Result<_, std::io::Error>>()?;
        files.retain(|file| file.extension().is_some_and(|extension| extension == "csv"));
        files.sort();
        let recordings = files
            .iter()
            .map(|file| Ok((support::read(&arm, file)?, file.ends_with("held_out.csv"))))
            .collect::<Result<_, Box<dyn Error>>>()?;
        Ok(Self {
            arm,
            recordings,
            truth: serde_json::from_reader(File::open(truth)?)?,
        })
    }

    fn tried(&self, options: &Options) -> Result<Tried, Box<dyn Error>> {
        let inputs: Vec<Input<'_>> = self
            .recordings
            .iter()
            .map(|(recording, held_out)| Input {
                name: "recording",
                recording,
                held_out: *held_out,
                before: false,
            })
            .collect();
        let report = diagnose(&self.arm, &inputs, options, &|_| ())?.report;
        Ok(Tried {
            truth: self.truth.clone(),
            joints: self.arm.joints().iter().map(|joint| joint.name.clone()).collect(),
            answer: Some(serde_json::from_value(serde_json::to_value(report)?)?),
            true_terms: None,
            wrong_term: None,
            tracking_over_exact: None,
            tracking_over_exact_without_lag: None,
            again: None,
        })
    }
}

fn macro_f1(cases: &[Case], thresholds: &Thresholds) -> Result<(f64, usize), Box<dyn Error>> {
    let options = Options {
        thresholds: thresholds.clone(),
        ..Options::default()
    };
    let tried: Vec<Tried> = cases
        .iter()
        .map(|case| case.tried(&options))
        .collect::<Result<_, _>>()?;
    let count = score(&tried).plain;
    Ok((count.macro_f1, count.false_in_all()))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    let (pairs, rest) = arguments.as_chunks::<2>();
    if pairs.is_empty() || !rest.is_empty() {
        return Err("usage: CASE TRUTH.json [CASE TRUTH.json …]".into());
    }
    let cases: Vec<Case> = pairs
        .iter()
        .map(|[folder, truth]| Case::read(folder, truth))
        .collect::<Result<_, _>>()?;
    let (f1, false_names) = macro_f1(&cases, &Thresholds::default())?;
    println!(
        "{} cases; as they are: macro F1 {f1:.3}, {false_names} false names\n",
        cases.len()
    );
    println!("| threshold | value | macro F1 (false names) at 0.8 times | at 1.2 times |\n|---|---|---|---|");
    for name in Thresholds::NAMES {
        let mut cells = Vec::new();
        for factor in [0.8, 1.2] {
            let mut varied = Thresholds::default();
            *varied.named(name).ok_or("a threshold of that name")? *= factor;
            let (f1, false_names) = macro_f1(&cases, &varied)?;
            cells.push(format!("{f1:.3} ({false_names})"));
        }
        let value = *Thresholds::default().named(name).ok_or("a threshold of that name")?;
        println!("| `{name}` | {value} | {} |", cells.join(" | "));
    }
    Ok(())
}
