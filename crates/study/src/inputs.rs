//! The recordings of a diagnosis, checked before anything is fitted.

mod epoch;
mod independent;
mod joints;
mod memory;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use arm::Arm;
use diagnosis::Doubt;
use effects::Effect;
use recording::{Column, ColumnMap, FindingKind, Quality, Recording, RecordingError, RegularRecording};

use self::independent::Stretches;
pub use self::joints::in_order_of;
use self::joints::{moving_grippers, order, reordered};
use crate::check::turns;
use crate::check::{self, Layout, MisfitKind};
use crate::named;
use crate::notes::{Kind, Notes, shortened};

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
    /// Its columns.
    layout: Layout,
    /// Whether its signs, zeros and order can be judged.
    has_model_units: bool,
    /// What contradicts the URDF and does not prevent the diagnosis.
    pub warnings: Vec<Doubt>,
    /// Why it cannot be diagnosed as it was read; empty if it can.
    pub doubts: Vec<Doubt>,
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
        let list: Vec<(&Given, Role)> =
            roles.into_iter().flat_map(|(given, role)| given.iter().map(move |given| (given, role))).collect();
        refuse_twice(&list)?;
        let first = list.first().map(|(given, _)| given.read(map.as_ref().map(|(_, map)| map)));
        let first = first.transpose()?;
        Ok(Self { map, list, first })
    }

    /// The joints of the first recording; none if they only have numbers.
    pub fn joints(&self) -> &[String] {
        self.first.as_ref().map_or(&[], named::named_joints)
    }
}

/// Reads and checks the recordings of `opened`, of an arm with the effects `known`; doubts are added to `notes`, also before an error.
///
/// # Errors
/// If one cannot be read, does not fit the arm, holds no motion or no torque, or is both fitted and held out.
pub fn read(
    opened: Opened<'_>,
    (arm, known): (&Arm, &[Effect]),
    progress: &dyn Fn(&str),
    notes: &mut Notes,
) -> anyhow::Result<Vec<Prepared>> {
    let Opened { map, list: given, mut first } = opened;
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
        for (joint, text) in moving_grippers(&recording, arm) {
            notes.add("warning", Kind::Misfit(MisfitKind::Columns), &name, about(Some(&joint), &text));
        }
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
    progress("checking signs, zeros and order");
    propose(&mut list, arm, known, notes);
    note_maps(&list, notes);
    epoch::share(&mut list);
    let training = || list.iter().filter(|recording| recording.role == Role::Train);
    // Stamps in microseconds leave next to no rows of what is worth holding.
    if training().all(|recording| recording.doubts.is_empty() && is_still(&recording.regular)) {
        bail!(
            "{}: no joint moves by more than 0.001 rad or m in the {:.2} s of the training recordings; record a longer motion, or \
             check the position columns",
            list[0].name,
            training().map(|recording| recording.regular.len() as f64 * recording.regular.period).sum::<f64>()
        );
    }
    Ok(list)
}

/// Adds the correction of signs, zeros and order that the torques of all recordings show.
fn propose(list: &mut [Prepared], arm: &Arm, known: &[Effect], notes: &mut Notes) {
    let judged: Vec<usize> = (0..list.len()).filter(|&at| list[at].has_model_units).collect();
    let recordings: Vec<&RegularRecording> = judged.iter().map(|&at| &list[at].regular).collect();
    let Some(proposed) = check::proposal(arm, known, &recordings) else {
        return;
    };
    for at in proposed.recordings.iter().map(|&at| judged[at]) {
        let one = &mut list[at];
        let doubt = Doubt {
            recording: one.name.clone(),
            joint: proposed.joint.clone(),
            text: proposed.text.clone(),
            column_map: one.layout.map(&proposed.changes),
        };
        if proposed.is_certain {
            one.doubts.push(doubt);
        } else {
            notes.add(
                "warning",
                Kind::Misfit(MisfitKind::Columns),
                &one.name,
                about(doubt.joint.as_deref(), &doubt.text),
            );
            one.warnings.push(doubt);
        }
    }
}

/// Notes where the column maps are that correct what does not prevent the diagnosis.
fn note_maps(list: &[Prepared], notes: &mut Notes) {
    for one in list.iter().filter(|one| one.doubts.is_empty()) {
        if one.warnings.iter().any(|warning| warning.column_map.is_some()) {
            let text = "a column map that would correct it, if that is the cause, is in the report (--json, --markdown or --report); \
                        save it as map.toml, and add --map map.toml";
            notes.add("note", Kind::ColumnMap, &one.name, text.to_owned());
        }
    }
}

/// `text` on a joint, if it concerns one.
fn about(joint: Option<&str>, text: &str) -> String {
    match joint {
        Some(joint) => format!("{joint}: {text}"),
        None => text.to_owned(),
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
    mut recording: Recording,
    name: String,
    order: &[usize],
    role: Role,
    arm: &Arm,
    notes: &mut Notes,
) -> anyhow::Result<Prepared> {
    for (joint, text) in turns::into_limits(&mut recording, arm) {
        notes.add("note", Kind::Misfit(MisfitKind::Turns), &name, about(Some(&joint), &text));
    }
    let (regular, warnings) = recording.regular().with_context(|| name.clone())?;
    let quality = Quality::of(&recording, &regular);
    let checked = check::check(arm, &regular, &quality);
    let column_map = check::column_map(arm, &checked.misfits, &recording);
    let (shown, gaps) = shortened(recording.warnings.iter().chain(&warnings), |warning| warning);
    for warning in shown {
        notes.add("note", warning.into(), &name, warning.to_string());
    }
    if gaps > 0 {
        notes.add(
            "note",
            Kind::FurtherGaps,
            &name,
            format!("further gaps: {gaps} (testbed inspect --json lists them)"),
        );
    }
    for finding in &quality.findings {
        let weight = match finding.kind {
            // The diagnosis differentiates the positions itself.
            FindingKind::VelocityLate | FindingKind::VelocityUnrelated => continue,
            FindingKind::Saturation
            | FindingKind::JointAtRest
            | FindingKind::CoarseEncoder
            | FindingKind::CoarseTorque => "note",
            _ => "warning",
        };
        notes.add(weight, Kind::Finding(finding.kind), &name, about(finding.joint.as_deref(), &finding.text));
    }
    let has_model_units = checked.has_model_units;
    let (mut doubts, mut warnings) = (Vec::new(), Vec::new());
    for misfit in checked.misfits {
        let list = if misfit.prevents_diagnosis {
            &mut doubts
        } else {
            notes.add("warning", Kind::Misfit(misfit.kind), &name, about(misfit.joint.as_deref(), &misfit.text));
            &mut warnings
        };
        list.push(Doubt {
            recording: name.clone(),
            joint: misfit.joint,
            text: misfit.text,
            column_map: column_map.clone(),
        });
    }
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
        layout: Layout::of(&recording),
        has_model_units,
        warnings,
        doubts,
    })
}

/// Why a recording cannot be diagnosed for any arm, and the remedy.
fn unusable(regular: &RegularRecording) -> Option<String> {
    if regular.tau.iter().all(|tau| tau.iter().all(|value| *value == tau[0])) {
        let what = if regular.tau.iter().flatten().all(|&tau| tau == 0.0) { "zero" } else { "constant" };
        return Some(format!(
            "all torques are {what}; check the torque columns (tau_<joint>), or name them in a column map (--map)"
        ));
    }
    None
}

/// Whether no joint moves: less than a thousandth of a radian or metre.
fn is_still(recording: &RegularRecording) -> bool {
    recording.q.iter().all(|q| {
        let (low, high) = turns::range(q);
        high - low < 1e-3
    })
}
