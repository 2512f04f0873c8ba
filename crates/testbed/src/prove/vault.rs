//! The files of a proof on disk: the seal, the diagnoses under it, and records of finished steps.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use faults::{Program, Seal, SealedCase, sha256, sha256_of};
use serde::{Deserialize, Serialize};

use super::case_paths::{CasePaths, Files};
use super::cases::Cases;
use super::child::{self, Ended, Task};
use crate::alone::Alone;
use crate::output;

/// The record of a finished process: sufficient to decide whether it must run again, and to repeat it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    /// SHA-256 of the program.
    pub program: String,
    /// One hash for the recordings and the URDF ([`SealedCase::inputs`]).
    pub inputs: String,
    /// The effects that were fitted without a search; `None` for a diagnosis.
    pub only: Option<String>,
    /// SHA-256 of the JSON it wrote.
    pub answer: Option<String>,
    /// SHA-256 of the effects it wrote as TOML.
    pub model: Option<String>,
    /// SHA-256 of the scenario it proposed.
    #[serde(default)]
    pub next: Option<String>,
    /// The message of the program instead of a diagnosis.
    pub error: Option<String>,
}

/// The campaign of a folder: the cases that are already in it belong to this campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Begun {
    program: Program,
    /// The origin of the cases: a seed and the robots' names, or given cases.
    source: String,
    /// SHA-256 of the robots' URDFs.
    robots: Vec<String>,
}

/// One hash for the inputs of a step.
pub fn made_of(hashes: [&str; 4]) -> String {
    sha256(hashes.join("\n").as_bytes())
}

/// The folder of a proof.
pub struct Vault {
    /// The path.
    pub out: PathBuf,
    /// The path of this program, which also diagnoses.
    pub executable: PathBuf,
    /// Its version and hash.
    pub program: Program,
    _alone: Alone,
}

/// Makes a folder of the proof.
///
/// # Errors
/// If the system refuses.
pub(super) fn make_folder(folder: &Path) -> anyhow::Result<()> {
    let remedy = || format!("{}: the folder cannot be made; give another with --out DIR", folder.display());
    std::fs::create_dir_all(folder).with_context(remedy)
}

impl Vault {
    /// Opens or makes the folder.
    ///
    /// # Errors
    /// If it cannot be made, or the program cannot read itself.
    pub fn new(out: &Path) -> anyhow::Result<Self> {
        for folder in ["", "cases", "truth", "diagnoses", "controls", "next", "tracking"] {
            let folder = out.join(folder);
            make_folder(&folder)?;
        }
        let executable = std::env::current_exe().context("finding this program")?;
        let program = Program { version: env!("CARGO_PKG_VERSION").to_owned(), sha256: sha256_of(&executable)? };
        Ok(Self { _alone: Alone::in_folder(out)?, out: out.to_owned(), executable, program })
    }

    /// Records the campaign of the folder, or checks that it is this one.
    ///
    /// # Errors
    /// If the folder was begun for another campaign or by another program.
    pub fn begin(&self, source: &Cases) -> anyhow::Result<()> {
        let begun = Begun {
            program: self.program.clone(),
            source: source.describe(),
            robots: source.urdfs().map(|urdf| sha256(urdf.as_bytes())).collect(),
        };
        let path = self.out.join("campaign.json");
        if !path.is_file() {
            return output::write_json(&path, &begun);
        }
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let there: Begun = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        let what = |begun: &Begun| {
            let Program { version, sha256 } = &begun.program;
            let program = format!("testbed {version} ({}…)", sha256.get(..12).unwrap_or_default());
            format!("{}, by {program}", begun.source)
        };
        let (there_is, this_is) = (what(&there), what(&begun));
        ensure!(
            there == begun,
            "{}: was begun for {there_is}, and this is {}; give another --out",
            self.out.display(),
            if there_is == this_is { "the same with another URDF".to_owned() } else { this_is }
        );
        Ok(())
    }

    /// Seals `places`, or checks that they equal the existing seal.
    ///
    /// # Errors
    /// If a file cannot be read, or another program or other cases are sealed here.
    pub fn seal(&self, places: &[CasePaths], source: String) -> anyhow::Result<Seal> {
        let sealed: anyhow::Result<Vec<SealedCase>> = places
            .iter()
            .map(|place| {
                let hash = |name: &String| Ok((name.clone(), sha256_of(&place.folder.join(name))?));
                let files: anyhow::Result<_> = Files::of(&place.folder)?.all().map(hash).collect();
                Ok(SealedCase { case: place.name.clone(), truth: sha256_of(&place.truth)?, files: files? })
            })
            .collect();
        let seal = Seal::new(self.program.clone(), source, sealed?);
        let path = self.out.join("seal.json");
        if path.is_file() {
            let there = read_seal(&path)?;
            let folder = self.out.display();
            ensure!(
                there.program == seal.program,
                "{folder}: was sealed by testbed {} ({}…), and this is {} ({}…); give another --out",
                there.program.version,
                &there.program.sha256.get(..12).unwrap_or_default(),
                seal.program.version,
                &seal.program.sha256[..12],
            );
            ensure!(
                there == seal,
                "{folder}: other cases are sealed there, or a sealed file was changed; give another --out"
            );
        } else {
            output::write_json(&path, &seal)?;
            let lines = seal.lines();
            recording::write_whole(&self.out.join("SHA256SUMS"), |file| file.write_all(lines.as_bytes()))?;
        }
        Ok(seal)
    }

    /// Diagnoses a sealed case according to `task`, unless that is done. Writes `name`.json, `name`.toml (unless effects
    /// are given) and the proposed motion `name`.next.toml.
    ///
    /// # Errors
    /// If the seal is broken, the process cannot be started, or the user interrupts.
    pub fn diagnose(&self, place: &CasePaths, sealed: &SealedCase, name: &str, task: Task<'_>) -> anyhow::Result<()> {
        let (answer, record) = self.paths(name);
        let proposed = self.proposed(name);
        let mut inputs = sealed.inputs();
        if let Some(more) = task.more {
            inputs = sha256(format!("{inputs} {}", sha256_of(more)?).as_bytes());
        }
        let is_same = |record: &Record| {
            record.program == self.program.sha256 && record.inputs == inputs && record.only.as_deref() == task.only
        };
        let is_there = |hash: &Option<String>, path: &Path| {
            hash.as_ref().is_none_or(|hash| sha256_of(path).is_ok_and(|is| is == *hash))
        };
        let model = self.model_path(name);
        if let Some(record) = read_record(&record).filter(is_same)
            && is_there(&record.answer, &answer)
            && is_there(&record.model, &model)
            && is_there(&record.next, &proposed)
        {
            return Ok(());
        }
        sealed.check_files(&place.folder)?;
        let files = Files::of(&place.folder)?;
        let (text, model_text, next, error) = match child::diagnose(&self.executable, &place.folder, &files, task)? {
            Ended::Answer { json, model, next } => (Some(json), model, next, None),
            Ended::Failed(reason) => (None, None, None, Some(reason)),
        };
        for (text, path) in [(&text, &answer), (&model_text, &model), (&next, &proposed)] {
            if let Some(text) = text {
                recording::write_whole(path, |file| file.write_all(text.as_bytes()))?;
            }
        }
        let hash = |text: Option<String>| text.map(|text| sha256(text.as_bytes()));
        let done = Record {
            program: self.program.sha256.clone(),
            inputs,
            only: task.only.map(str::to_owned),
            answer: hash(text),
            model: hash(model_text),
            next: hash(next),
            error,
        };
        output::write_json(&record, &done)
    }

    /// The scenario of the motion that a diagnosis proposed; there is none if its record has none.
    pub fn proposed(&self, name: &str) -> PathBuf {
        self.out.join(format!("{name}.next.toml"))
    }

    /// The results of a process: its record, and the JSON that it wrote.
    ///
    /// # Errors
    /// If that is not what its record says.
    pub fn answer(&self, name: &str) -> anyhow::Result<(Option<Record>, Option<String>)> {
        let (answer, record) = self.paths(name);
        let Some(record) = read_record(&record) else {
            return Ok((None, None));
        };
        let Some(hash) = &record.answer else {
            return Ok((Some(record), None));
        };
        let text = unchanged(&answer, hash)?;
        Ok((Some(record), Some(text)))
    }

    /// The SHA-256 of all diagnoses, by case; `None` without a diagnosis.
    ///
    /// # Errors
    /// If one is not what its record says.
    pub fn answers(&self, places: &[CasePaths]) -> anyhow::Result<BTreeMap<String, Option<String>>> {
        let answer = |place: &CasePaths| {
            let (_, text) = self.answer(&format!("diagnoses/{}", place.name))?;
            Ok((place.name.clone(), text.map(|text| sha256(text.as_bytes()))))
        };
        places.iter().map(answer).collect()
    }

    /// The effects that a diagnosis named, as TOML; `None` if it gave no answer.
    ///
    /// # Errors
    /// If that is not what its record says.
    pub fn model(&self, name: &str) -> anyhow::Result<Option<String>> {
        let Some(hash) = read_record(&self.paths(name).1).and_then(|record| record.model) else {
            return Ok(None);
        };
        unchanged(&self.model_path(name), &hash).map(Some)
    }

    fn model_path(&self, name: &str) -> PathBuf {
        self.out.join(format!("{name}.toml"))
    }

    fn paths(&self, name: &str) -> (PathBuf, PathBuf) {
        (self.out.join(format!("{name}.json")), self.out.join(format!("{name}.done.json")))
    }
}

/// The text of a file, which must have the recorded `hash`.
fn unchanged(path: &Path, hash: &str) -> anyhow::Result<String> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    ensure!(sha256(text.as_bytes()) == hash, "{}: was changed after it was written", path.display());
    Ok(text)
}

fn read_record(path: &Path) -> Option<Record> {
    serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
}

fn read_seal(path: &Path) -> anyhow::Result<Seal> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let seal: Seal = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    seal.check().with_context(|| path.display().to_string())?;
    Ok(seal)
}
