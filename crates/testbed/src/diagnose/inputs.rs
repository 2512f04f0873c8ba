//! The recordings of a diagnosis, checked before anything is fitted.

mod joints;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use arm::Arm;
use diagnosis::Wanted;
use effects::Effect;
use recording::{ColumnMap, FindingKind, Quality, Recording, RegularRecording};

use self::joints::{order, reordered};
use super::effect_file::EffectFile;
use super::next_file;
use super::notes::Notes;
use crate::cli::{DiagnoseArgs, Rerun};
use crate::inspect::{model_check, shortened};
use crate::progress::Progress;
use crate::{output, recordings};

/// A recording ready to be diagnosed.
pub struct Prepared {
    /// As the user named it.
    pub name: String,
    /// On its clock, joints in the arm's order.
    pub regular: RegularRecording,
    /// What it is for.
    pub role: Role,
    /// The column map that mends what does not fit the arm.
    pub column_map: Option<String>,
}

/// What a recording is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Fitted; made before something happened.
    Before,
    /// Fitted.
    Train,
    /// Not fitted: the proof.
    HeldOut,
}

impl Role {
    fn is_fitted(self) -> bool {
        self != Self::HeldOut
    }
}

/// Checks where `args` write to, before anything is read.
///
/// # Errors
/// If an output cannot be written, is an input, or is another output.
pub fn check_outputs(args: &DiagnoseArgs) -> anyhow::Result<()> {
    if cfg!(not(feature = "viewer")) && !matches!(args.rerun, None | Some(Rerun::Off)) {
        bail!("this testbed was built without the viewer; build it with `--features viewer`, or leave --rerun out");
    }
    let outputs = args.outputs();
    for path in &outputs {
        output::check_writable(path)?;
    }
    args.next.as_deref().map_or(Ok(()), next_file::check_replaceable)?;
    let robot = Path::new(&args.robot);
    for output in &outputs {
        // A model of effects may be read, added to and written in one go.
        let known = args.known.iter().filter(|_| args.model.as_deref() != Some(output));
        let recordings = args
            .train
            .iter()
            .chain(&args.before)
            .chain(&args.held_out)
            .chain(&args.map);
        let inputs = recordings.chain(known).map(PathBuf::as_path).chain([robot]);
        output::check_is_no_input(output, inputs)?;
    }
    for (k, path) in outputs.iter().enumerate() {
        if let Some(other) = outputs[..k].iter().find(|other| output::is_same(other, path)) {
            bail!(
                "{}: is given for two outputs; give each output its own file",
                other.display()
            );
        }
    }
    Ok(())
}

/// The effects that `args` say are known.
///
/// # Errors
/// If the file cannot be used.
pub fn known(args: &DiagnoseArgs, arm: &Arm) -> anyhow::Result<Vec<Effect>> {
    let Some(path) = &args.known else { return Ok(Vec::new()) };
    Ok(EffectFile::load(path, arm)?.effects)
}

/// The effects that `args` ask for, if they ask for some and no others.
///
/// # Errors
/// If the file cannot be used; whether the catalogue has the effects is seen when they are fitted.
pub fn only(args: &DiagnoseArgs, arm: &Arm) -> anyhow::Result<Option<Vec<Wanted>>> {
    let Some(only) = &args.only else { return Ok(None) };
    let path = Path::new(only);
    if path.extension().is_some_and(|extension| extension == "toml") {
        let effects = EffectFile::load(path, arm)?.effects;
        let wanted = effects.iter().map(|effect| Wanted {
            effect: effect.name().to_owned(),
            joint: effect.joint().map(str::to_owned),
            other: effect.other().map(str::to_owned),
            sets_in: Some(effect.onset().is_some()),
        });
        return Ok(Some(wanted.collect()));
    }
    let wanted = only.split(',').filter(|word| !word.is_empty()).map(|word| {
        let (effect, joint) = match word.split_once(':') {
            Some((effect, joint)) => (effect, Some(joint.to_owned())),
            None => (word, None),
        };
        Wanted {
            effect: effect.to_owned(),
            joint,
            ..Wanted::default()
        }
    });
    let wanted: Vec<Wanted> = wanted.collect();
    ensure!(
        !wanted.is_empty(),
        "--only {only:?}: names no effect; give effect:joint, or a file that --model wrote"
    );
    Ok(Some(wanted))
}

/// Whether a moving stretch of `b` is in `a`, sample for sample: a part of a recording under another name.
fn overlap(a: &RegularRecording, b: &RegularRecording) -> bool {
    const STRETCH: usize = 50;
    let (Some(last), Some(first)) = (a.len().checked_sub(STRETCH), b.len().checked_sub(STRETCH)) else {
        return false;
    };
    [1, 2, 3].into_iter().any(|quarter| {
        let from = first * quarter / 4;
        let moves = b.q.iter().any(|q| q[from] != q[from + STRETCH - 1]);
        let same = |a: &[f64], b: &[f64], at: usize| a[at..at + STRETCH] == b[from..from + STRETCH];
        moves
            && (0..=last).any(|at| {
                let mut pairs = a.q.iter().chain(&a.tau).zip(b.q.iter().chain(&b.tau));
                pairs.all(|(a, b)| same(a, b, at))
            })
    })
}

/// The recordings that a diagnosis is to read, of which the first was read already: its joints choose the arm.
pub struct Files<'a> {
    map: Option<(&'a Path, ColumnMap)>,
    files: Vec<(&'a PathBuf, Role)>,
    first: Option<Recording>,
}

impl<'a> Files<'a> {
    /// Opens the recordings that `args` name, those for training first.
    ///
    /// # Errors
    /// If one is named twice, or the map or the first recording cannot be read.
    pub fn open(args: &'a DiagnoseArgs) -> anyhow::Result<Self> {
        let load = |path: &'a PathBuf| anyhow::Ok((path.as_path(), ColumnMap::load(path)?));
        let map = args.map.as_ref().map(load).transpose()?;
        let roles = [
            (&args.before, Role::Before),
            (&args.train, Role::Train),
            (&args.held_out, Role::HeldOut),
        ];
        let files: Vec<(&PathBuf, Role)> = roles
            .into_iter()
            .flat_map(|(paths, role)| paths.iter().map(move |path| (path, role)))
            .collect();
        refuse_twice(&files)?;
        let first = files
            .first()
            .map(|(path, _)| Recording::read_with(path, map.as_ref().map(|(_, map)| map)));
        let first = first.transpose()?;
        Ok(Self { map, files, first })
    }

    /// The joints of the first recording; none if it only numbers them.
    pub fn joints(&self) -> &[String] {
        self.first.as_ref().map_or(&[], recordings::named_joints)
    }
}

/// Reads and checks the recordings of `files`; what is doubtful is added to `notes`, also before an error.
///
/// # Errors
/// If one cannot be read, does not fit the arm, holds no motion or no torque, or is both fitted and held out.
pub fn read(files: Files<'_>, arm: &Arm, progress: &Progress, notes: &mut Notes) -> anyhow::Result<Vec<Prepared>> {
    let Files { map, files, mut first } = files;
    let choosing = files
        .first()
        .map_or_else(String::new, |(path, _)| path.display().to_string());
    let mut list: Vec<Prepared> = Vec::new();
    for (path, role) in files {
        progress.doing(format!("reading {}", path.display()));
        let mut recording = match first.take() {
            Some(first) => first,
            None => Recording::read_with(path, map.as_ref().map(|(_, map)| map))?,
        };
        recordings::name_joints(&mut recording, arm);
        let name = path.display().to_string();
        let map = map.as_ref().map(|(path, _)| *path);
        let order = order(&recording, arm, &name, &choosing, map)?;
        let prepared = prepare(recording, name, &order, role, arm, map.is_some(), notes)?;
        if let Some(map) = &prepared.column_map
            && list.iter().all(|other| other.column_map.as_ref() != Some(map))
        {
            let text = format!("a column map that mends it (--map):\n{map}");
            notes.add("note", &prepared.name, text);
        }
        // The same samples under another name.
        let twin = list.iter().find(|known| {
            let (a, b) = (&known.regular, &prepared.regular);
            a.q == b.q && a.tau == b.tau
        });
        if let Some(twin) = twin {
            bail!(
                "{}: contains the same samples as {}; use a recording once, for training or held out",
                prepared.name,
                twin.name
            );
        }
        let source = list.iter().find(|known| {
            known.role.is_fitted() != prepared.role.is_fitted() && overlap(&known.regular, &prepared.regular)
        });
        if let Some(source) = source {
            bail!(
                "{}: contains a part of {}, sample for sample; a held-out recording must be independent of the training recordings",
                prepared.name,
                source.name
            );
        }
        list.push(prepared);
    }
    if list
        .iter()
        .filter(|recording| recording.role == Role::Train)
        .all(|recording| is_still(&recording.regular))
    {
        bail!(
            "{}: no joint moves in the training recordings; record a motion, or check the position columns",
            list[0].name
        );
    }
    Ok(list)
}

fn refuse_twice(files: &[(&PathBuf, Role)]) -> anyhow::Result<()> {
    for (k, (path, role)) in files.iter().enumerate() {
        let same = |other: &&(&PathBuf, Role)| output::is_same(path, other.0);
        if let Some((_, other)) = files[..k].iter().find(same) {
            match (other.is_fitted(), role.is_fitted()) {
                (false, true) | (true, false) => bail!(
                    "{}: is given as a training and as a held-out recording; a held-out recording must be independent",
                    path.display()
                ),
                _ => bail!("{}: is given twice", path.display()),
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
    mapped: bool,
    notes: &mut Notes,
) -> anyhow::Result<Prepared> {
    let (regular, warnings) = recording.regular().with_context(|| name.clone())?;
    let quality = Quality::of(&recording, &regular);
    let misfits = model_check::check(arm, &regular, &quality);
    let column_map = model_check::column_map(&misfits, &recording, mapped);
    let (told, gaps) = shortened(recording.warnings.iter().chain(&warnings), |warning| warning);
    for warning in told {
        notes.add("note", &name, warning.to_string());
    }
    if gaps > 0 {
        notes.add(
            "note",
            &name,
            format!("{gaps} more gaps (testbed inspect --json has them)"),
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
    for misfit in misfits.iter().filter(|misfit| !misfit.spoils) {
        notes.add("warning", &name, about(&misfit.joint, &misfit.text));
    }
    if let Some(misfit) = misfits.iter().find(|misfit| misfit.spoils) {
        let joint = misfit
            .joint
            .as_ref()
            .map_or_else(String::new, |joint| format!("{joint}: "));
        let map = column_map.map_or_else(String::new, |map| format!(" A column map that mends it:\n{map}"));
        bail!(
            "{name}: {joint}{}. Units, signs, order or zeros first: no effect is searched before.{map}",
            misfit.text
        );
    }
    let regular = reordered(regular, order);
    if let Some(reason) = unusable(&regular, &quality) {
        bail!("{name}: {reason}");
    }
    Ok(Prepared {
        name,
        regular,
        role,
        column_map,
    })
}

/// A drive is not sampled more slowly (Hz).
const SLOWEST: f64 = 10.0;

/// Why a recording cannot be diagnosed for any arm, and the remedy.
fn unusable(regular: &RegularRecording, quality: &Quality) -> Option<String> {
    if quality.rate < SLOWEST {
        return Some(format!(
            "its rows are {:.3} s apart; are its stamps in ms? Give the unit in a column map (--map: unit = \"ms\" under \
             [time]), or record at 100 Hz or more",
            regular.period
        ));
    }
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
    let mut moving = quality.joints.iter().filter(|joint| joint.moves).peekable();
    let degrees = |ratio: f64| (ratio.to_degrees() - 1.0).abs() < 0.04;
    if moving.peek().is_some() && moving.all(|joint| joint.velocity_ratio.is_some_and(|ratio| degrees(ratio.abs()))) {
        return Some(
            "the positions of all joints that move are in degrees (their slopes are 57.3 times the recorded velocities); \
             say so for each joint in a column map (--map): q_unit = \"deg\""
                .to_owned(),
        );
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
