//! The proposed experiments: recorded on the machine with the injected faults, and diagnosed again.

use std::path::{Path, PathBuf};

use anyhow::Context;
use faults::{FaultError, SealedCase, record_again, sha256_of};
use scoring::Answer;
use serde::{Deserialize, Serialize};

use super::case_paths::CasePaths;
use super::cases::Cases;
use super::child::{MORE, NEXT, Task};
use super::rows;
use super::vault::{Vault, made_of};
use crate::output;
use crate::scenario::Scenario;

/// The number of cases that are examined for experiments. They are spread evenly over a campaign, because a second
/// diagnosis of all cases would take too long.
pub const LOOKED_AT: usize = 60;

/// The factors by which a motion is scaled about its centre until the position loop can follow it. The model with which it
/// was proposed may be wrong; a user whose drive trips would do the same.
const SIZES: [f64; 3] = [1.0, 0.7, 0.5];

/// The record of a motion that was made, from which it follows whether it must be made again.
#[derive(Serialize, Deserialize)]
struct Made {
    /// SHA-256 of the hashes of its inputs: program, recordings and URDF, ground truth, scenario.
    made_of: String,
    /// SHA-256 of the recording; `None` if there is none.
    recording: Option<String>,
    /// The reason if there is none.
    failed: Option<String>,
}

impl Made {
    /// Whether it was made from the inputs with the hash `made_of`, and the file `recording` is unchanged.
    fn is_of(&self, made_of: &str, recording: &Path) -> bool {
        let is_as_left = match &self.recording {
            Some(hash) => sha256_of(recording).is_ok_and(|is| is == *hash),
            None => !recording.exists(),
        };
        self.made_of == made_of && is_as_left
    }
}

/// The cases whose proposed experiment is made: of [`LOOKED_AT`] cases that are spread evenly, those whose diagnosis
/// proposes a motion for a confusion. Whether a case is examined depends only on its number, not on the part of the
/// campaign that it is in.
///
/// # Errors
/// If a diagnosis is not what its record says.
pub fn examined<'a>(
    source: &Cases,
    vault: &Vault,
    pairs: &[(&'a CasePaths, &'a SealedCase)],
) -> anyhow::Result<Vec<(&'a CasePaths, &'a SealedCase)>> {
    let Cases::Drawn { plans, .. } = source else {
        // The machine of a given case is not available.
        return Ok(Vec::new());
    };
    let turn = |number: usize| number * LOOKED_AT / plans.len().max(1);
    let mut list = Vec::new();
    for &(place, sealed) in pairs {
        let number = place.number;
        let is_first_of_its_turn = number == 0 || turn(number) != turn(number - 1);
        if number >= plans.len() || !is_first_of_its_turn {
            continue;
        }
        let (_, text) = vault.answer(&first(place))?;
        let Some(text) = text else { continue };
        let answer: Answer = serde_json::from_str(&text).with_context(|| place.name.clone())?;
        if answer.next_experiment.is_some_and(|next| !next.separates.is_empty()) {
            list.push((place, sealed));
        }
    }
    Ok(list)
}

/// Makes the proposed experiment of a case, whose truth is open, and diagnoses again with its recording, unless that is
/// done. A result whose inputs have changed is made again.
///
/// # Errors
/// If a file cannot be read or written, the process cannot be started, or the user interrupts.
pub fn make(source: &Cases, vault: &Vault, place: &CasePaths, sealed: &SealedCase, truth: &str) -> anyhow::Result<()> {
    let Cases::Drawn { robots, plans, .. } = source else {
        return Ok(());
    };
    let folder = folder(vault, place);
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    // The scenario refers to the URDF beside it.
    let (scenario, recording) = (folder.join(NEXT), folder.join(MORE));
    let copies = [
        (vault.proposed(&first(place)), scenario.clone()),
        (place.folder.join("robot.urdf"), folder.join("robot.urdf")),
    ];
    for (from, to) in copies {
        let bytes = std::fs::read(&from).with_context(|| from.display().to_string())?;
        if std::fs::read(&to).ok().as_ref() != Some(&bytes) {
            recording::write_whole(&to, |file| file.write_all(&bytes))?;
        }
    }
    let hashes = [&vault.program.sha256, &sealed.inputs(), &sealed.truth, &sha256_of(&scenario)?];
    let made_of = made_of(hashes.map(String::as_str));
    if !record(vault, place).is_some_and(|made| made.is_of(&made_of, &recording)) {
        if recording.is_file() {
            std::fs::remove_file(&recording).with_context(|| recording.display().to_string())?;
        }
        let mut failed = None;
        let truth = rows::truth(&place.name, truth)?;
        let scenario = Scenario::load(&scenario.display().to_string())?;
        let plan = plans.get(place.number).context("there is no such case")?;
        let mut motion = torque::Motion::new(scenario.arm.dof());
        for size in SIZES {
            let mut at = |time: f64, q: &mut [f64]| {
                scenario.reference.at(time, &mut motion);
                for ((q, wanted), centre) in q.iter_mut().zip(&motion.q).zip(&scenario.reference.centre) {
                    *q = centre + size * (wanted - centre);
                }
            };
            match record_again(plan.robot(robots), plan, &truth, scenario.duration, &mut at) {
                Ok(made) => {
                    made.write_csv(&recording)?;
                    break;
                }
                // That a motion cannot be recorded at any size is also a result.
                Err(error @ FaultError::Lost { .. }) if size == SIZES[SIZES.len() - 1] => {
                    failed = Some(error.to_string());
                }
                Err(FaultError::Lost { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        let made = Made { made_of, recording: failed.is_none().then(|| sha256_of(&recording)).transpose()?, failed };
        output::write_json(&record_path(vault, place), &made)?;
    }
    if !recording.is_file() {
        return Ok(());
    }
    let task = Task { more: Some(&recording), ..Task::default() };
    vault.diagnose(place, sealed, &second(place), task)
}

/// The outcome: the second diagnosis, or the reason why there is none; neither if no experiment was tried.
///
/// # Errors
/// If the diagnosis is not what its record says.
pub fn result(vault: &Vault, place: &CasePaths) -> anyhow::Result<(Option<String>, Option<String>)> {
    if let Some(reason) = record(vault, place).and_then(|made| made.failed) {
        return Ok((None, Some(reason)));
    }
    let (record, text) = vault.answer(&second(place))?;
    Ok((text, record.and_then(|record| record.error)))
}

fn record(vault: &Vault, place: &CasePaths) -> Option<Made> {
    serde_json::from_str(&std::fs::read_to_string(record_path(vault, place)).ok()?).ok()
}

fn record_path(vault: &Vault, place: &CasePaths) -> PathBuf {
    folder(vault, place).join("made.json")
}

fn folder(vault: &Vault, place: &CasePaths) -> PathBuf {
    vault.out.join("next").join(&place.name)
}

fn first(place: &CasePaths) -> String {
    format!("diagnoses/{}", place.name)
}

fn second(place: &CasePaths) -> String {
    format!("next/{}/diagnosis", place.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A recording is reused only if it and its inputs are unchanged.
    #[test]
    fn a_changed_recording_is_made_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let recording = folder.path().join(MORE);
        let made = |hash: Option<String>| Made {
            made_of: "all of it".into(),
            failed: hash.is_none().then(|| "lost".to_owned()),
            recording: hash,
        };
        let lost = made(None);
        assert!(lost.is_of("all of it", &recording), "there is none, as it was left");
        std::fs::write(&recording, "t,q_a\n0,0\n").expect("it writes");
        assert!(!lost.is_of("all of it", &recording), "both are left");
        let there = made(Some(sha256_of(&recording).expect("it is there")));
        assert!(there.is_of("all of it", &recording));
        assert!(!there.is_of("another truth", &recording));
        std::fs::write(&recording, "t,q_a\n0,1\n").expect("it writes");
        assert!(!there.is_of("all of it", &recording), "it was changed");
        std::fs::remove_file(&recording).expect("it is there");
        assert!(!there.is_of("all of it", &recording), "it is gone");
    }
}
