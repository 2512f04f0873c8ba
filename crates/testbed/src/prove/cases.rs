//! The cases of a proof: drawn from a seed, or from given folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use faults::{Campaign, CasePlan, FaultError, Robot, conceal_case, write_case};

use super::case_paths::CasePaths;
use super::{disturbance, given, tracking};
use crate::cli::{ChainArgs, ProveArgs};
use crate::conceal;

/// The number of seeds that are tried for a case.
const SEEDS: usize = 4;

/// The origin of the cases of a proof.
pub enum Cases {
    /// A number of cases, drawn from a seed.
    Drawn {
        /// The seed.
        seed: u64,
        /// Robots, in turn.
        robots: Vec<Robot>,
        /// The robots as the user named them; empty for the robots that come with testbed.
        named: Vec<String>,
        /// Which of their joints are the arm.
        chain: ChainArgs,
        /// Whether half of them resemble real robots.
        lifelike: bool,
        /// The relative error of their URDFs; `None` for the four errors in turns.
        urdf_error: Option<f64>,
        /// The plans of the cases.
        plans: Vec<CasePlan>,
    },
    /// Folders of cases, and the folder of their truths.
    Given {
        /// Has `case_*`.
        cases: PathBuf,
        /// Has `case_*.json`; a case without one is omitted.
        truth: PathBuf,
    },
}

impl Cases {
    /// The cases of `args`.
    ///
    /// # Errors
    /// If a robot cannot be used.
    pub fn new(args: &ProveArgs) -> anyhow::Result<Self> {
        Ok(match (&args.cases_from, &args.truth) {
            (Some(cases), truth) => {
                let truth = truth.clone().unwrap_or_else(|| cases.join("truth"));
                for folder in [cases, &truth] {
                    ensure!(
                        folder.is_dir(),
                        "{}: is not a folder; --cases-from takes a folder of folders case_*, --truth a folder of case_*.json",
                        folder.display()
                    );
                }
                Self::Given { cases: cases.clone(), truth }
            }
            (None, _) => Self::Drawn {
                seed: args.seed,
                lifelike: args.lifelike,
                urdf_error: args.urdf_error,
                robots: conceal::robots(&args.robot, &args.chain)?,
                named: args.robot.clone(),
                chain: args.chain.clone(),
                plans: Campaign {
                    seed: args.seed,
                    cases: args.cases as usize,
                    lifelike: args.lifelike,
                    urdf_error: args.urdf_error,
                }
                .plans(),
            },
        })
    }

    /// The origin in words, without paths, because it is a part of the seal.
    pub fn describe(&self) -> String {
        match self {
            Self::Drawn { seed, robots, plans, lifelike, urdf_error, .. } => {
                let names: Vec<&str> = robots.iter().map(Robot::name).collect();
                let urdfs = urdf_error.map_or_else(
                    || "URDFs wrong by 0, 3, 10 and 30 %".to_owned(),
                    |sigma| format!("URDFs wrong by {} %", 100.0 * sigma),
                );
                let real = if *lifelike { "half of them lifelike" } else { "none lifelike" };
                let (count, names) = (plans.len(), names.join(", "));
                let cases = if count == 1 { "case" } else { "cases" };
                format!("{count} {cases} drawn from seed {seed} on {names}, {real}, {urdfs}")
            }
            Self::Given { .. } => "cases that were given".to_owned(),
        }
    }

    /// The URDFs of the robots that cases are drawn on.
    pub fn urdfs(&self) -> impl Iterator<Item = &str> {
        let robots = match self {
            Self::Drawn { robots, .. } => robots.as_slice(),
            Self::Given { .. } => &[],
        };
        robots.iter().map(Robot::urdf)
    }

    /// The command that makes the proof again, without the cases' paths.
    pub fn command(&self) -> String {
        match self {
            Self::Drawn { seed, plans, named, chain, lifelike, urdf_error, .. } => {
                let robots: String = named.iter().map(|robot| format!(" --robot {robot}")).collect();
                let plain = if *lifelike { "" } else { " --lifelike false" };
                let error = urdf_error.map_or_else(String::new, |sigma| format!(" --urdf-error {sigma}"));
                format!("testbed prove --cases {} --seed {seed}{robots}{chain}{plain}{error} --out proof/", plans.len())
            }
            Self::Given { .. } => "testbed prove --cases-from CASES --truth TRUTHS --out proof/".to_owned(),
        }
    }

    /// The places of all cases. Drawn cases are under `out`, followed by the paper's disturbance.
    ///
    /// # Errors
    /// If a folder cannot be read, or has no case.
    pub fn places(&self, out: &Path) -> anyhow::Result<Vec<CasePaths>> {
        match self {
            Self::Drawn { plans, .. } => {
                let place = |number: usize, name: &str| CasePaths {
                    number,
                    name: name.to_owned(),
                    folder: out.join("cases").join(name),
                    truth: out.join("truth").join(format!("{name}.json")),
                };
                let drawn = plans.iter().map(|plan| place(plan.index, &plan.name));
                Ok(drawn.chain([place(plans.len(), disturbance::CASE)]).collect())
            }
            Self::Given { cases, truth } => given::places(cases, truth),
        }
    }

    /// The numbers of the cases in which a task is tracked. They follow from the plan, so that each part of a campaign
    /// knows its own. Empty for given cases, whose ground truths may be insufficient to rebuild their machines.
    ///
    /// # Errors
    /// If the task's scenario cannot be read.
    pub fn tracked(&self) -> anyhow::Result<BTreeSet<usize>> {
        match self {
            Self::Drawn { robots, plans, .. } => tracking::chosen(plans, robots),
            Self::Given { .. } => Ok(BTreeSet::new()),
        }
    }

    /// The robot that a case is drawn on.
    pub fn robot(&self, place: &CasePaths) -> Option<&Robot> {
        match self {
            Self::Drawn { robots, plans, .. } => plans.get(place.number).map(|plan| plan.robot(robots)),
            Self::Given { .. } => None,
        }
    }

    /// Makes a case that does not exist yet. Its folder is written completely or not at all, and its ground truth after it.
    ///
    /// # Errors
    /// If it cannot be made, or a given case is missing.
    pub fn make(&self, place: &CasePaths) -> anyhow::Result<()> {
        if place.truth.is_file() && place.folder.is_dir() {
            return Ok(());
        }
        let Self::Drawn { robots, plans, .. } = self else {
            bail!("{}: does not exist", place.truth.display());
        };
        // An incomplete case was left by an interruption.
        if place.truth.exists() {
            std::fs::remove_file(&place.truth).with_context(|| place.truth.display().to_string())?;
        }
        if place.folder.exists() {
            std::fs::remove_dir_all(&place.folder).with_context(|| place.folder.display().to_string())?;
        }
        let parent = |path: &Path| path.parent().unwrap_or(Path::new(".")).to_owned();
        let (folder, truths) = (parent(&place.folder), parent(&place.truth));
        let Some(mut plan) = plans.get(place.number).cloned() else {
            // The last case is the paper's, which is not drawn.
            return disturbance::write(&folder, &truths);
        };
        for attempt in 1.. {
            match conceal_case(plan.robot(robots), &plan) {
                Ok(concealment) => {
                    write_case(&concealment, &folder, &truths)?;
                    break;
                }
                // Effects that are not detectable with one seed may be detectable with another.
                Err(FaultError::NotExpressed { .. }) if attempt < SEEDS => plan.seed = plan.seed.wrapping_add(1),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}
