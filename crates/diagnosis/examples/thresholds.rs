//! Varies the most decisive thresholds by ±20 %, one at a time, and prints the macro F1 of the open cases at each value.
//!
//! ```sh
//! cargo run --release -p diagnosis --example thresholds -- case_003 truth/case_003.json case_011 truth/case_011.json
//! ```
//!
//! A case is a folder with `robot.urdf`, `train_*.csv` and `held_out.csv`, and the file with its ground truth. With
//! `--page docs/thresholds.md` in front of the cases, the result takes the place of the one on that page.

use std::error::Error;
use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};

use arm::Arm;
use diagnosis::{Input, Options, Thresholds, diagnose};
use rayon::prelude::*;
use recording::RegularRecording;
use scoring::{Tried, Truth, score};

mod support;

/// What stands before and after the result on the page.
const BEGIN: &str = "<!-- variation -->";
const END: &str = "<!-- end of the variation -->";

/// The smallest difference of a macro F1 that its three decimals show.
const VISIBLE: f64 = 5e-4;

/// A case that is diagnosed with varied thresholds.
struct Case {
    arm: Arm,
    recordings: Vec<(RegularRecording, bool)>,
    truth: Truth,
}

impl Case {
    fn read(folder: &Path, truth: &Path) -> Result<Self, Box<dyn Error>> {
        let arm = Arm::from_urdf(folder.join("robot.urdf"))?;
        let mut files: Vec<PathBuf> =
            std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<_, std::io::Error>>()?;
        files.retain(|file| file.extension().is_some_and(|extension| extension == "csv"));
        files.sort();
        let recordings = files
            .iter()
            .map(|file| Ok((support::read(&arm, file)?, file.ends_with("held_out.csv"))))
            .collect::<Result<_, Box<dyn Error>>>()?;
        Ok(Self { arm, recordings, truth: serde_json::from_reader(File::open(truth)?)? })
    }

    fn tried(&self, options: &Options) -> Result<Tried, Box<dyn Error>> {
        let inputs: Vec<Input<'_>> = self
            .recordings
            .iter()
            .map(|(recording, held_out)| Input { name: "recording", recording, held_out: *held_out, before: false })
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

/// How well the injected effects are found.
#[derive(Clone, Copy)]
struct Outcome {
    macro_f1: f64,
    false_names: usize,
}

impl Outcome {
    fn of(cases: &[Case], thresholds: &Thresholds) -> Result<Self, Box<dyn Error>> {
        let options = Options { thresholds: thresholds.clone(), ..Options::default() };
        let tried = cases
            .par_iter()
            .map(|case| case.tried(&options).map_err(|error| error.to_string()))
            .collect::<Result<Vec<Tried>, String>>()?;
        let count = score(&tried).plain;
        Ok(Self { macro_f1: count.macro_f1, false_names: count.false_in_all() })
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} ({})", self.macro_f1, self.false_names)
    }
}

/// The result as the page has it; each row is also printed when it is known.
fn variation(cases: &[Case]) -> Result<String, Box<dyn Error>> {
    let nominal = Outcome::of(cases, &Thresholds::default())?;
    let head = format!(
        "With all as they are, the macro F1 of these {} cases is {:.3}, with {} false names.\n\n\
         | threshold | value | macro F1 (false names) at 0.8 times | at 1.2 times |\n|---|---|---|---|\n",
        cases.len(),
        nominal.macro_f1,
        nominal.false_names
    );
    print!("{head}");
    let mut page = head;
    let mut all = Vec::new();
    for name in Thresholds::NAMES {
        let mut varied = [nominal; 2];
        for (outcome, factor) in varied.iter_mut().zip([0.8, 1.2]) {
            let mut thresholds = Thresholds::default();
            *thresholds.named(name).ok_or("a threshold of that name")? *= factor;
            *outcome = Outcome::of(cases, &thresholds)?;
        }
        let value = *Thresholds::default().named(name).ok_or("a threshold of that name")?;
        let row = format!("| `{name}` | {value} | {} | {} |\n", varied[0], varied[1]);
        print!("{row}");
        page += &row;
        all.extend(varied);
    }
    let count = |is: fn(&Outcome, &Outcome) -> bool| all.iter().filter(|varied| is(varied, &nominal)).count();
    let last = format!(
        "\nChanges that lower the macro F1: {} of {}; that raise it: {}; that add a false name: {}.\n",
        count(|varied, nominal| varied.macro_f1 < nominal.macro_f1 - VISIBLE),
        all.len(),
        count(|varied, nominal| varied.macro_f1 > nominal.macro_f1 + VISIBLE),
        count(|varied, nominal| varied.false_names > nominal.false_names),
    );
    print!("{last}");
    Ok(page + &last)
}

/// Replaces what stands between [`BEGIN`] and [`END`] on the page at `path`.
fn write_into(path: &Path, variation: &str) -> Result<(), Box<dyn Error>> {
    let page = std::fs::read_to_string(path)?;
    let place = page.split_once(BEGIN).zip(page.split_once(END));
    let ((head, _), (_, tail)) = place.ok_or_else(|| format!("{}: it lacks {BEGIN} or {END}", path.display()))?;
    std::fs::write(path, format!("{head}{BEGIN}\n{variation}{END}{tail}"))?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    let page = match arguments.first() {
        Some(flag) if flag.as_os_str() == "--page" && arguments.len() > 1 => arguments.drain(..2).nth(1),
        _ => None,
    };
    let (pairs, rest) = arguments.as_chunks::<2>();
    if pairs.is_empty() || !rest.is_empty() {
        return Err("usage: [--page PAGE.md] CASE TRUTH.json [CASE TRUTH.json …]".into());
    }
    let cases: Vec<Case> = pairs.iter().map(|[folder, truth]| Case::read(folder, truth)).collect::<Result<_, _>>()?;
    let variation = variation(&cases)?;
    if let Some(page) = page {
        write_into(&page, &variation)?;
    }
    Ok(())
}
