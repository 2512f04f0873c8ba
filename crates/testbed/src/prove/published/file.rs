//! The file of published values: robots, their recordings, their sources, and effects with values and references.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use arm::{Arm, JointKind};
use faults::{catalogue, sha256};
use recording::{nearest, toml_reason};
use scoring::{Denied, Evidence, Published, PublishedEffect, PublishedNumber, compared_parameters};
use serde::Deserialize;
use toml::Spanned;

use super::ensure_some;
use super::quantities::{is_on_the_arm, si};
use study::Source;

/// The value of the key `schema`.
const SCHEMA: &str = "testbed.published/1";

/// The file as it is read; [`File::published`] checks it against the robots' URDFs.
pub struct File {
    /// SHA-256 of its text.
    pub sha256: String,
    /// The robots, in the file's order.
    pub robots: Vec<Robot>,
    source: Source,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    schema: Spanned<String>,
    robots: Vec<Spanned<Robot>>,
}

/// A robot of the file.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// The name of the robot and of its folder.
    pub name: String,
    /// A description in one line.
    pub title: String,
    /// The URDF's file.
    pub urdf: String,
    /// The training recordings.
    pub train: Vec<String>,
    /// The held-out recordings.
    pub held_out: Vec<String>,
    /// The sources of the public data.
    pub source: Origin,
    says: Vec<Spanned<Says>>,
    #[serde(default)]
    denies: Vec<Spanned<Denies>>,
    /// Notes by the authors of this file.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The number of joints of its URDF; filled in with `published`.
    #[serde(skip)]
    pub dof: usize,
    /// The published effects in SI units, checked against the URDF; filled in by [`File::published`].
    #[serde(skip)]
    pub published: Option<Published>,
}

/// A source of public data.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// The authors.
    pub authors: String,
    /// The title.
    pub title: String,
    /// The year.
    pub year: Option<u16>,
    /// The address.
    pub url: String,
    /// The licence.
    pub licence: String,
    /// The files of the source that were used.
    pub files: String,
    /// The differences of the recordings and the URDF from these files.
    pub converted: String,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Says {
    effects: Vec<Spanned<String>>,
    #[serde(default)]
    joints: Vec<Spanned<String>>,
    #[serde(default)]
    parameters: BTreeMap<Spanned<String>, Numbers>,
    evidence: Evidence,
    #[serde(rename = "where")]
    place: String,
}

/// One number per joint.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    values: Spanned<Vec<f64>>,
    unit: Spanned<String>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Denies {
    effects: Vec<Spanned<String>>,
    #[serde(default)]
    joints: Vec<Spanned<String>>,
    #[serde(rename = "where")]
    place: String,
}

impl File {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// With file, line, reason and remedy, if the file is unreadable or not such a TOML file, if two robots have the same
    /// name, or if an effect is not in the catalogue.
    pub fn load(path: &Path) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| {
            let path = path.display();
            format!("--published {path}: cannot be read; give a file with schema = \"{SCHEMA}\"")
        })?;
        let source = Source { name: String::new(), path: path.to_owned(), text };
        let raw: Raw = toml::from_str(&source.text).map_err(|error| {
            let place = source.place(error.span().unwrap_or(0..0));
            anyhow!("{place}: {}", toml_reason(error.message()))
        })?;
        let schema = raw.schema.get_ref();
        ensure!(
            schema == SCHEMA,
            "{}: the schema is \"{schema}\"; this program reads \"{SCHEMA}\"",
            source.place(raw.schema.span())
        );
        let mut robots: Vec<Robot> = Vec::new();
        for robot in raw.robots {
            let place = source.place(robot.span());
            let robot = robot.into_inner();
            let is_name = !robot.name.is_empty() && !robot.name.contains(['/', '\\']) && !robot.name.starts_with('.');
            ensure!(is_name, "{place}: \"{}\" is not the name of a folder", robot.name);
            ensure!(
                !robots.iter().any(|other| other.name == robot.name),
                "{place}: robot \"{}\" is given twice; keep one of the two",
                robot.name
            );
            ensure_some(&robot.train, &place, "train")?;
            ensure_some(&robot.held_out, &place, "held_out")?;
            let files: Vec<&String> = robot.files().collect();
            for (k, file) in files.iter().enumerate() {
                ensure!(
                    !file.is_empty() && !file.contains(['/', '\\']) && !files[..k].contains(file),
                    "{place}: \"{file}\" is given twice, or is not a file of the robot's folder"
                );
            }
            for file in robot.train.iter().chain(&robot.held_out) {
                ensure!(
                    file.ends_with(".csv"),
                    "{place}: recording \"{file}\" does not end in .csv, and would be neither sealed nor fitted; rename it"
                );
            }
            robots.push(robot);
        }
        let place = source.path.display().to_string();
        ensure_some(&robots, &place, "the list of robots")?;
        let file = Self { sha256: sha256(source.text.as_bytes()), robots, source };
        for robot in &file.robots {
            let said = robot.says.iter().map(|says| (says.span(), &says.get_ref().effects));
            let denied = robot.denies.iter().map(|denies| (denies.span(), &denies.get_ref().effects));
            for (span, effects) in said.chain(denied) {
                ensure_some(effects, &file.source.place(span), "effects")?;
                effects.iter().try_for_each(|effect| file.check_effect(effect))?;
            }
        }
        Ok(file)
    }

    /// The published effects of `robot`, whose arm is `arm`, in SI units.
    ///
    /// # Errors
    /// With file, line, reason and remedy, if the URDF lacks a joint, the effect lacks a parameter, a unit does not fit, or
    /// there is not one number per joint.
    pub fn published(&self, robot: &Robot, arm: &Arm) -> anyhow::Result<Published> {
        let mut said = Vec::new();
        for says in &robot.says {
            let place = self.source.place(says.span());
            let says = says.get_ref();
            let whole = says.effects.iter().any(|effect| is_on_the_arm(effect.get_ref()));
            ensure!(
                whole == says.joints.is_empty(),
                "{place}: {} {}",
                says.effects[0].get_ref(),
                if whole { "is on the whole arm; leave joints out" } else { "is on a joint; add joints" }
            );
            let joints: Vec<Option<(String, JointKind)>> = if whole {
                vec![None]
            } else {
                let joints = says.joints.iter().map(|joint| self.joint(joint, arm).map(Some));
                joints.collect::<anyhow::Result<_>>()?
            };
            for (k, joint) in joints.iter().enumerate() {
                said.push(PublishedEffect {
                    effects: says.effects.iter().map(|effect| effect.get_ref().clone()).collect(),
                    joint: joint.as_ref().map(|(name, _)| name.clone()),
                    parameters: self.numbers(says, k, joints.len(), joint.as_ref().map(|(_, kind)| *kind))?,
                    evidence: says.evidence,
                    place: says.place.clone(),
                });
            }
        }
        let mut denied = Vec::new();
        for denies in &robot.denies {
            let denies = denies.get_ref();
            let joints = denies.joints.iter().map(|joint| Ok(self.joint(joint, arm)?.0));
            denied.push(Denied {
                effects: denies.effects.iter().map(|effect| effect.get_ref().clone()).collect(),
                joints: joints.collect::<anyhow::Result<_>>()?,
                place: denies.place.clone(),
            });
        }
        Ok(Published { robot: robot.name.clone(), said, denied })
    }

    fn fail(&self, span: Range<usize>, reason: &str) -> anyhow::Error {
        anyhow!("{}: {reason}", self.source.place(span))
    }

    fn check_effect(&self, effect: &Spanned<String>) -> anyhow::Result<()> {
        let name = effect.get_ref();
        if catalogue().contains(&name.as_str()) {
            return Ok(());
        }
        let known: Vec<String> = catalogue().into_iter().map(str::to_owned).collect();
        let hint = nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
        let known = known.join(", ");
        Err(self.fail(effect.span(), &format!("there is no effect \"{name}\"; {hint}there are {known}")))
    }

    fn joint(&self, joint: &Spanned<String>, arm: &Arm) -> anyhow::Result<(String, JointKind)> {
        let name = joint.get_ref();
        if let Some(found) = arm.joints().iter().find(|other| other.name == *name) {
            return Ok((name.clone(), found.kind));
        }
        let known: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
        let hint = nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
        let reason = format!("the URDF has no joint \"{name}\"; {hint}it has {}", known.join(", "));
        Err(self.fail(joint.span(), &reason))
    }

    /// The numbers of the `k`-th of `count` joints.
    fn numbers(
        &self,
        says: &Says,
        k: usize,
        count: usize,
        kind: Option<JointKind>,
    ) -> anyhow::Result<BTreeMap<String, PublishedNumber>> {
        let mut list = BTreeMap::new();
        for (key, numbers) in &says.parameters {
            let name = key.get_ref();
            let [effect] = says.effects.as_slice() else {
                let reason = "several effects are given, to which no value can belong; name one effect";
                return Err(self.fail(key.span(), reason));
            };
            let effect = effect.get_ref();
            let known = compared_parameters(effect);
            if !known.contains(&name.as_str()) {
                let reason = format!("{effect} has no \"{name}\" to compare; it has {}", known.join(", "));
                return Err(self.fail(key.span(), &reason));
            }
            let values = numbers.values.get_ref();
            if values.len() != count || !values.iter().all(|value| value.is_finite()) {
                let reason = format!("there are {} values; give {count}, one per joint", values.len());
                return Err(self.fail(numbers.values.span(), &reason));
            }
            let unit = numbers.unit.get_ref();
            let (factor, unit) = match si(effect, name, kind, unit) {
                Ok(found) => found,
                Err(reason) => bail!(self.fail(numbers.unit.span(), &reason)),
            };
            let value = factor * values[k];
            list.insert(name.clone(), PublishedNumber { value, unit: unit.to_owned() });
        }
        Ok(list)
    }
}

impl Robot {
    /// The number of names (an effect on a joint or on the arm) that the publication excludes.
    pub fn deniable(&self) -> usize {
        let mut pairs: BTreeSet<(&str, Option<&str>, usize)> = BTreeSet::new();
        for denies in &self.denies {
            let denies = denies.get_ref();
            for effect in denies.effects.iter().map(|effect| effect.get_ref().as_str()) {
                if is_on_the_arm(effect) {
                    pairs.insert((effect, None, 0));
                } else if denies.joints.is_empty() {
                    pairs.extend((0..self.dof).map(|joint| (effect, None, joint)));
                } else {
                    let joints = denies.joints.iter().map(|joint| (effect, Some(joint.get_ref().as_str()), 0));
                    pairs.extend(joints);
                }
            }
        }
        pairs.len()
    }

    /// All its files.
    pub fn files(&self) -> impl Iterator<Item = &String> {
        [&self.urdf].into_iter().chain(&self.train).chain(&self.held_out)
    }
}
