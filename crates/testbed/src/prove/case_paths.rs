//! Where a case is, and the names of its files.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

/// A case: the paths of its files and of its ground truth.
#[derive(Clone, Debug)]
pub struct CasePaths {
    /// Its number, from 0.
    pub number: usize,
    /// Its name.
    pub name: String,
    /// The folder with the URDF and the recordings.
    pub folder: PathBuf,
    /// The truth's file.
    pub truth: PathBuf,
}

/// The files of a case by their names in its folder: URDF, training recordings, held-out recordings.
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
    /// The files in `folder`. Other files there are not given to a diagnosis.
    ///
    /// # Errors
    /// If one is missing.
    pub fn of(folder: &Path) -> anyhow::Result<Self> {
        let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
        let mut names: Vec<String> =
            entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
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

    /// The names of all files.
    pub fn all(&self) -> impl Iterator<Item = &String> {
        [&self.robot].into_iter().chain(&self.train).chain(&self.held_out)
    }
}
