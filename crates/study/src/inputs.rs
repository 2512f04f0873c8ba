//! The recordings of a diagnosis, checked before anything is fitted.

mod epoch;
mod independent;
mod joints;
mod memory;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use arm::Arm;
use diagnosis::Doubt;
use recording::{Column, ColumnMap, FindingKind, Quality, Recording, RecordingError, RegularRecording};

use self::independent::Stretches;
use self::joints::{order, reordered};
use crate::check::{self, Change, Misfit};
use crate::named;
use crate::notes::{Notes, shortened};

/// A recording to be read for a diagnosis.
#[derive(Clone, Debug)]
pub enum Given {
    /// A file of any format that `recording` reads.
    File(PathBuf),
    /// Columns in memory, named as those of a file.
    Columns {
        /// Its name in messages and in the report.
        name: String,
        /// The columns with their headers.
        columns: Vec<(String, Column)>,
    },
}

impl Given {
    /// Its name in messages and in the report.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Columns { name, .. } => name.clone(),
        }
    }

    fn read(&self, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        match self {
            Self::File(path) => Recording::read_windows(path, map, diagnosis::WORTH_HOLDING),
            Self::Columns { name, columns } => Recording::of_columns(name, columns.clone(), map),
        }
    }

    /// Whether both are one file. Columns in memory are compared when they are read.
    fn is_same(&self, other: &Self) -> bool {
        matches!((self, other), (Self::File(a), Self::File(b)) if crate::is_same(a, b))
    }
}

/// The recordings of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Recordings {
    /// Recordings from before a change of the robot (`--before`).
    pub before: Vec<Given>,
    /// Training recordings.
    pub train: Vec<Given>,
    /// Held-out recordings.
    pub held_out: Vec<Given>,
    /// The column map of files and columns with other headers or units.
    pub map: Option<PathBuf>,
}

/// A recording ready to be diagnosed.
pub struct Prepared {
    /// The name that the user gave.
    pub name: String,
    /// The recording on its clock, with the joints in the arm's order.
    pub regular: RegularRecording,
    /// Its role.
    pub role: Role,
    /// Some of its stretches of samples, taken before parts of a long recording are dropped.
    stretches: Stretches,
    /// The calendar time (s since 1970) from which its time is counted; `None` for stamps without a date.
    epoch: Option<i64>,
    /// The column map that corrects its contradictions with the arm.
    column_map: Option<String>,
    /// What it supposes of the robot, until the other recordings confirm it.
    guess: Option<Guess>,
    /// Why it cannot be diagnosed as it was read; empty if it can.
    pub doubts: Vec<Doubt>,
}

/// What one recording supposes of the robot, such as another zero of a joint. The other recordings of the robot should suppose it, too.
struct Guess {
    joint: Option<String>,
    text: String,
    changes: Vec<Change>,
    /// The column map that corrects all contradictions of the recording, this one included.
    column_map: Option<String>,
}

impl Guess {
    fn is_same(&self, other: &Self) -> bool {
        self.joint == other.joint && self.changes == other.changes
    }
}

/// The role of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Training recording from before a change of the robot.
    Before,
    /// Training recording.
    Train,
    /// Held-out recording.
    HeldOut,
}

impl Role {
    fn is_fitted(self) -> bool {
        self != Self::HeldOut
    }
}

/// The recordings to be read. The first one has been read, because its joints select the arm.
pub struct Opened<'a> {
    map: Option<(&'a Path, ColumnMap)>,
    list: Vec<(&'a Given, Role)>,
    first: Option<Recording>,
}

impl<'a> Opened<'a> {
    /// Opens `recordings`: first those from before a change, then the other training recordings.
    ///
    /// # Errors
    /// If one is given twice, or the map or the first recording cannot be read.
    pub fn new(recordings: &'a Recordings) -> anyhow::Result<Self> {
        let load = |path: &'a PathBuf| anyhow::Ok((path.as_path(), ColumnMap::load(path)?));
        let map = recordings.map.as_ref().map(load).transpose()?;
        let roles = [
            (&recordings.before, Role::Before),
            (&recordings.train, Role::Train),
            (&recordings.held_out, Role::HeldOut),
        ];
        let list: Vec<(&Given, Role)> = roles
            .into_iter()
            .flat_map(|(given, role)| given.iter().map(move |given| (given, role)))
            .collect();
        refuse_twice(&list)?;
        let first = list
            .first()
            .map(|(given, _)| given.read(map.as_ref().map(|(_, map)| map)));
        let first = first.transpose()?;
        Ok(Self { map, list, first })
    }

    /// The joints of the first recording; none if they only have numbers.
    pub fn joints(&self) -> &[String] {
        self.first.as_ref().map_or(&[], named::named_joints)
    }
}

/// Reads and checks the recordings of `opened`; doubts are added to `notes`, also before an error.
///
/// # Errors
/// If one cannot be read, does not fit the arm, holds no motion or no torque, or is both fitted and held out.
pub fn read(
    opened: Opened<'_>,
    arm: &Arm,
    progress: &dyn Fn(&str),
    notes: &mut Notes,
) -> anyhow::Result<Vec<Prepared>> {
    let Opened {
        map,
        list: given,
        mut first,
    } = opened;
    let choosing = given.first().map_or_else(String::new, |(given, _)| given.name());
    let mut list: Vec<Prepared> = Vec::new();
    for (given, role) in given {
        let name = given.name();
        progress(&format!("reading {name}"));
        let mut recording = match first.take() {
            Some(first) => first,
            None => given.read(map.as_ref().map(|(_, map)| map))?,
        };
        named::name_joints(&mut recording, arm);
        let map = map.as_ref().map(|(path, _)| *path);
        let order = order(&recording, arm, &name, &choosing, map)?;
        let prepared = prepare(recording, name, &order, role, arm, notes)?;
        // The same samples under another name.
        let twin = list.iter().find(|known| {
            let (a, b) = (&known.regular, &prepared.regular);
            prepared.stretches.are_all_of(&known.stretches) || a.q == b.q && a.tau == b.tau
        });
        if let Some(twin) = twin {
            bail!(
                "{}: contains the same samples as {}; use a recording once, for training or held out",
                prepared.name,
                twin.name
            );
        }
        let source = list.iter().find(|known| {
            known.role.is_fitted() != prepared.role.is_fitted() && prepared.stretches.are_in(&known.stretches)
        });
        if let Some(source) = source {
            bail!(
                "{}: contains a part of {}, sample for sample; a held-out recording must be independent of the training recordings",
                prepared.name,
                source.name
            );
        }
        list.push(prepared);
        memory::bound(&mut list);
    }
    confirm(&mut list, notes);
    epoch::share(&mut list);
    let training = || list.iter().filter(|recording| recording.role == Role::Train);
    // Stamps in microseconds leave next to no rows of what is worth holding.
    if training().all(|recording| recording.doubts.is_empty() && is_still(&recording.regular)) {
        bail!(
            "{}: no joint moves by more than 0.001 rad or m in the {:.2} s of the training recordings; record a longer motion, or \
             check the position columns",
            list[0].name,
            training()
                .map(|recording| recording.regular.len() as f64 * recording.regular.period)
                .sum::<f64>()
        );
    }
    Ok(list)
}

/// Whether most of the recordings with these guesses suppose the same as each.
fn confirmed(guesses: &[Option<Guess>]) -> Vec<bool> {
    let alike = |guess: &Guess| guesses.iter().flatten().filter(|other| guess.is_same(other)).count();
    let is_confirmed = |guess: &Option<Guess>| guess.as_ref().is_some_and(|guess| 2 * alike(guess) > guesses.len());
    guesses.iter().map(is_confirmed).collect()
}

/// Adds what most recordings suppose of the robot to `notes`, and the column maps that correct the recordings.
fn confirm(list: &mut [Prepared], notes: &mut Notes) {
    let guesses: Vec<Option<Guess>> = list.iter_mut().map(|one| one.guess.take()).collect();
    let is_confirmed = confirmed(&guesses);
    let mut told: Vec<String> = Vec::new();
    for ((one, guess), is_confirmed) in list.iter_mut().zip(guesses).zip(is_confirmed) {
        if let Some(guess) = guess.filter(|_| is_confirmed) {
            notes.add("warning", &one.name, guess.text);
            one.column_map = guess.column_map;
        }
        if let Some(map) = &one.column_map
            && one.doubts.is_empty()
            && !told.contains(map)
        {
            let text = format!("a column map that corrects it; save it as map.toml, and add --map map.toml:\n{map}");
            notes.add("note", &one.name, text);
            told.push(map.clone());
        }
    }
}

fn refuse_twice(list: &[(&Given, Role)]) -> anyhow::Result<()> {
    for (k, (given, role)) in list.iter().enumerate() {
        let same = |other: &&(&Given, Role)| given.is_same(other.0);
        if let Some((_, other)) = list[..k].iter().find(same) {
            match (other.is_fitted(), role.is_fitted()) {
                (false, true) | (true, false) => bail!(
                    "{}: is given as a training and as a held-out recording; a held-out recording must be independent",
                    given.name()
                ),
                _ if other == role => bail!("{}: is given twice; give each recording once", given.name()),
                _ => bail!(
                    "{}: is given with --before and with --train; a recording is either from before or from after the change",
                    given.name()
                ),
            }
        }
    }
    Ok(())
}

fn prepare(
    recording: Recording,
    name: String,
    order: &[usize],
    role: Role,
    arm: &Arm,
    notes: &mut Notes,
) -> anyhow::Result<Prepared> {
    let (regular, warnings) = recording.regular().with_context(|| name.clone())?;
    let quality = Quality::of(&recording, &regular);
    let all = check::check(arm, &regular, &quality);
    let map_of_all = check::column_map(arm, &all, &recording);
    let (mut of_robot, misfits): (Vec<Misfit>, Vec<Misfit>) = all.into_iter().partition(|misfit| misfit.is_of_robot);
    let column_map = if of_robot.is_empty() {
        map_of_all.clone()
    } else {
        check::column_map(arm, &misfits, &recording)
    };
    let (told, gaps) = shortened(recording.warnings.iter().chain(&warnings), |warning| warning);
    for warning in told {
        notes.add("note", &name, warning.to_string());
    }
    if gaps > 0 {
        notes.add(
            "note",
            &name,
            format!("further gaps: {gaps} (testbed inspect --json lists them)"),
        );
    }
    let about = |joint: &Option<String>, text: &str| match joint {
        Some(joint) => format!("{joint}: {text}"),
        None => text.to_owned(),
    };
    for finding in &quality.findings {
        let weight = match finding.kind {
            // The diagnosis differentiates the positions itself.
            FindingKind::VelocityLate | FindingKind::VelocityUnrelated => continue,
            FindingKind::Saturation | FindingKind::JointAtRest | FindingKind::CoarseEncoder => "note",
            _ => "warning",
        };
        notes.add(weight, &name, about(&finding.joint, &finding.text));
    }
    for misfit in misfits.iter().filter(|misfit| !misfit.prevents_diagnosis) {
        notes.add("warning", &name, about(&misfit.joint, &misfit.text));
    }
    let guess = of_robot.pop().map(|misfit| Guess {
        text: about(&misfit.joint, &misfit.text),
        joint: misfit.joint,
        changes: misfit.changes,
        column_map: map_of_all,
    });
    let prevents_diagnosis = misfits.into_iter().filter(|misfit| misfit.prevents_diagnosis);
    let doubts = prevents_diagnosis
        .map(|misfit| Doubt {
            recording: name.clone(),
            joint: misfit.joint,
            text: misfit.text,
            column_map: column_map.clone(),
        })
        .collect();
    let regular = memory::without_unused(reordered(regular, order));
    if let Some(reason) = unusable(&regular) {
        bail!("{name}: {reason}");
    }
    Ok(Prepared {
        name,
        stretches: Stretches::of(&regular),
        regular,
        role,
        epoch: recording.epoch,
        column_map,
        guess,
        doubts,
    })
}

/// Why a recording cannot be diagnosed for any arm, and the remedy.
fn unusable(regular: &RegularRecording) -> Option<String> {
    if regular.tau.iter().all(|tau| tau.iter().all(|value| *value == tau[0])) {
        let what = if regular.tau.iter().flatten().all(|&tau| tau == 0.0) {
            "zero"
        } else {
            "constant"
        };
        return Some(format!(
            "all torques are {what}; check the torque columns (tau_<joint>), or name them in a column map (--map)"
        ));
    }
    None
}

/// Whether no joint moves: less than a thousandth of a radian or metre.
fn is_still(recording: &RegularRecording) -> bool {
    recording.q.iter().all(|q| {
        let (low, high) = q
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        high - low < 1e-3
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A zero is a property of the robot, so that most of its recordings show a wrong one; a centre of mass that lies elsewhere than
    /// in the URDF looks like a wrong zero in some motions only.
    #[test]
    fn what_few_recordings_suppose_of_the_robot_is_not_told() {
        let guess = |joint: &str| {
            Some(Guess {
                joint: Some(joint.to_owned()),
                text: String::new(),
                changes: Vec::new(),
                column_map: None,
            })
        };
        assert_eq!(confirmed(&[guess("a")]), [true]);
        assert_eq!(confirmed(&[guess("a"), None]), [false, false]);
        assert_eq!(confirmed(&[guess("a"), guess("b"), guess("a")]), [true, false, true]);
        assert_eq!(confirmed(&[guess("a"), guess("b"), guess("a"), None]), [false; 4]);
    }
}
