//! Where cases come from: drawn from a seed, or anybody's folders.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use proof::Truth;

use crate::cli::ProveArgs;

/// A case: where it is, and where its truth is.
#[derive(Clone, Debug)]
pub struct Place {
    /// Its number, from 0.
    pub number: usize,
    /// Its name.
    pub name: String,
    /// The folder with the URDF and the recordings.
    pub folder: PathBuf,
    /// The truth's file.
    pub truth: PathBuf,
}

/// Where the cases of a proof come from.
#[derive(Clone, Debug)]
pub enum Source {
    /// So many, drawn from a seed.
    Drawn {
        /// The seed.
        seed: u64,
        /// How many.
        count: usize,
    },
    /// Folders of cases, and the folder of their truths.
    Given {
        /// Has `case_*`.
        cases: PathBuf,
        /// Has `case_*.json`; a case without one is left out.
        truth: PathBuf,
    },
}

impl Source {
    /// What `args` ask for.
    ///
    /// # Errors
    /// If folders of cases are given without a truth.
    pub fn new(args: &ProveArgs) -> anyhow::Result<Self> {
        Ok(match (&args.cases_from, &args.truth) {
            (Some(cases), truth) => Self::Given {
                cases: cases.clone(),
                truth: truth.clone().unwrap_or_else(|| cases.join("truth")),
            },
            (None, _) => Self::Drawn {
                seed: args.seed,
                count: args.cases,
            },
        })
    }

    /// In words, without paths: it is sealed.
    pub fn describe(&self) -> String {
        match self {
            Self::Drawn { seed, count } => format!("{count} cases drawn from seed {seed}"),
            Self::Given { .. } => "cases that were given".to_owned(),
        }
    }

    /// The command that makes the proof again, without paths.
    pub fn command(&self) -> String {
        match self {
            Self::Drawn { seed, count } => format!("testbed prove --cases {count} --seed {seed} --out proof/"),
            Self::Given { .. } => "testbed prove --cases-from CASES --truth TRUTHS --out proof/".to_owned(),
        }
    }

    /// The places of all cases; those drawn are under `out`.
    ///
    /// # Errors
    /// If a folder cannot be read, or has no case.
    pub fn places(&self, out: &Path) -> anyhow::Result<Vec<Place>> {
        match self {
            Self::Drawn { count, .. } => Ok((0..*count)
                .map(|number| {
                    let name = format!("case_{number:03}");
                    Place {
                        number,
                        folder: out.join("cases").join(&name),
                        truth: out.join("truth").join(format!("{name}.json")),
                        name,
                    }
                })
                .collect()),
            Self::Given { cases, truth } => given(cases, truth),
        }
    }

    /// Makes a case that is not there yet: its folder is there whole or not at all, its truth after it.
    ///
    /// # Errors
    /// If it cannot be made, or a case that should be there is not.
    pub fn make(&self, place: &Place) -> anyhow::Result<()> {
        if place.truth.is_file() && place.folder.is_dir() {
            return Ok(());
        }
        let Self::Drawn { seed, .. } = self else {
            bail!("{}: is not there", place.truth.display());
        };
        let parent = place.folder.parent().unwrap_or(Path::new("."));
        let partial = tempfile::Builder::new().prefix(".partial-").tempdir_in(parent)?;
        let truth = conceal(*seed, place.number, &place.name, partial.path())?;
        if place.folder.exists() {
            std::fs::remove_dir_all(&place.folder)?;
        }
        std::fs::rename(partial.keep(), &place.folder).with_context(|| place.folder.display().to_string())?;
        crate::output::write_json(&place.truth, &truth)
    }
}

/// Draws case `number` of `seed`, writes `robot.urdf`, `train_1.csv` … and `held_out.csv` into `folder`, and returns what is
/// concealed in them. The bytes depend on seed and number alone.
///
/// # Errors
/// If it cannot be simulated or written.
fn conceal(_seed: u64, _number: usize, _name: &str, _folder: &Path) -> anyhow::Result<Truth> {
    bail!("this testbed has no generator of cases; give some with --cases-from DIR --truth DIR")
}

fn given(cases: &Path, truth: &Path) -> anyhow::Result<Vec<Place>> {
    let entries = std::fs::read_dir(cases).with_context(|| format!("--cases-from {}", cases.display()))?;
    let mut names: Vec<String> = entries
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("case_"))
        .collect();
    names.sort();
    let all = names.len();
    names.retain(|name| truth.join(format!("{name}.json")).is_file());
    ensure!(
        !names.is_empty(),
        "{}: has no folder case_* whose truth is in {}; give the truths\u{2019} folder with --truth",
        cases.display(),
        truth.display()
    );
    if names.len() < all {
        let (left_out, truth) = (all - names.len(), truth.display());
        eprintln!("note: {left_out} of {all} cases have no truth in {truth}; they are left out");
    }
    let place = |(number, name): (usize, String)| Place {
        number,
        folder: cases.join(&name),
        truth: truth.join(format!("{name}.json")),
        name,
    };
    Ok(names.into_iter().enumerate().map(place).collect())
}

/// The files of a case: its URDF, recordings to fit, recordings held out; each by its name in the folder.
#[derive(Clone, Debug)]
pub struct Files {
    /// The URDF.
    pub robot: String,
    /// `train*.csv`
    pub train: Vec<String>,
    /// `held_out*.csv`
    pub held_out: Vec<String>,
}

impl Files {
    /// Those in `folder`; what else is there is not given to a diagnosis.
    ///
    /// # Errors
    /// If one is missing.
    pub fn of(folder: &Path) -> anyhow::Result<Self> {
        let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
        let mut names: Vec<String> = entries
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        let pick = |start: &str, end: &str| -> Vec<String> {
            let fits = |name: &&String| name.starts_with(start) && name.ends_with(end);
            names.iter().filter(fits).cloned().collect()
        };
        let (train, held_out) = (pick("train", ".csv"), pick("held_out", ".csv"));
        let folder = folder.display();
        ensure!(!train.is_empty(), "{folder}: has no train*.csv");
        ensure!(!held_out.is_empty(), "{folder}: has no held_out*.csv");
        let robot = pick("", ".urdf").into_iter().next();
        let robot = robot.with_context(|| format!("{folder}: has no .urdf"))?;
        Ok(Self { robot, train, held_out })
    }

    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &String> {
        [&self.robot].into_iter().chain(&self.train).chain(&self.held_out)
    }
}
