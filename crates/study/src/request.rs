//! The request for a diagnosis, and its execution up to the complete report.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use arm::{Arm, ChainOptions};
use diagnosis::{Diagnosis, Doubt, Input, Options, RecordingNames, Step, Wanted, WithoutLag};
use effects::Effect;
use effects::arm::PAYLOAD;
use torque::summed;

use crate::effect_file::EffectFile;
use crate::inputs::{self, Opened, Recordings, Role};
use crate::notes::Notes;
use crate::placeholders::{Replaced, replaced};
use crate::robot::{self, RobotFile};
use crate::urdf_file::may_count_twice;
use crate::urdf_friction::{UrdfFriction, known_friction};

/// Effects that the model is known to omit.
#[derive(Clone, Debug)]
pub enum Known {
    /// A file that a diagnosis wrote.
    File(PathBuf),
    /// The text of such a file.
    Text(String),
}

/// The inputs and options of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// The path of the robot's URDF, or the name of a robot that comes with testbed.
    pub robot: String,
    /// The arm among the robot's joints, as far as the user chooses it; `recorded` is filled in.
    pub chain: ChainOptions,
    /// The recordings.
    pub recordings: Recordings,
    /// Effects that are not to be reported again.
    pub known: Option<Known>,
    /// The hypothesis to fit in place of a search: `effect:joint,…`, or a file that a diagnosis wrote.
    pub only: Option<String>,
    /// Which friction in the URDF is known friction.
    pub urdf_friction: UrdfFriction,
    /// Half-power frequency of the low-pass filter (Hz); `None` derives it from the recordings.
    pub cutoff: Option<f64>,
    /// The lag of all recorded torques behind the positions (s); `None` estimates it from the recordings.
    pub torque_lag: Option<f64>,
    /// The relative error of the URDF's inertial parameters; `None` estimates it from the recordings.
    pub urdf_accuracy: Option<f64>,
    /// The relative standard deviation of the torque constants; `None` if it is unknown.
    pub torque_accuracy: Option<f64>,
    /// Whether to diagnose recordings whose units, signs, order or zeros seem wrong as they were read; what was doubted is a warning.
    pub as_read: bool,
    /// Whether to leave out the simulation and the learned correction.
    pub torques_only: bool,
    /// Whether to propose the next experiment.
    pub next: bool,
}

/// The receiver of progress and notes.
pub trait Listener {
    /// A description of the present step.
    fn doing(&self, step: Step<'_>);

    /// A note on the robot or the result.
    fn note(&self, text: &str);

    /// The notes on the recordings; also called before an error.
    fn recordings(&self, notes: &Notes);
}

/// A complete diagnosis.
pub struct Diagnosed {
    /// The robot.
    pub robot: RobotFile,
    /// Its arm.
    pub arm: Arm,
    /// The diagnosis, with the comparisons in its report.
    pub diagnosis: Diagnosis,
    /// The corrected model: the known effects and those found.
    pub effects: Vec<Effect>,
}

impl Request {
    /// Reads, checks, diagnoses and compares. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// If an input cannot be used, with place, reason and remedy; or if nothing can be fitted.
    pub fn run(&self, listener: &dyn Listener) -> anyhow::Result<Diagnosed> {
        let robot = robot::named_robot(&self.robot)?;
        let opened = Opened::new(&self.recordings)?;
        let arm = self.arm(&robot, opened.joints(), listener)?;
        let mut known = self.known(&arm)?;
        let twice = may_count_twice(&robot.text, &known);
        let (friction, remark) = known_friction(&robot, &arm, self.urdf_friction, &known)?;
        known.splice(0..0, friction);
        let mut remarks = vec![remark, twice];
        let mut checked = arm.clone();
        if self.urdf_accuracy != Some(0.0)
            && let Some(Replaced { arm, effects, remark }) = replaced(&arm, &known)
        {
            checked = arm;
            known.splice(0..0, effects);
            remarks.push(Some(remark));
        }
        for remark in remarks.into_iter().flatten() {
            listener.note(&format!("{}: {remark}", robot.path.display()));
        }
        self.check_units(&robot, &checked, listener)?;
        let mut only = self.only.as_deref().map(|only| wanted(only, &arm)).transpose()?;
        let has_before = !self.recordings.before.is_empty();
        if has_before {
            if let Some(note) = less_than_known(&known) {
                listener.note(&note);
            }
            // The model of today does not say whether an effect is new.
            let wanted = only.iter_mut().flatten();
            wanted.for_each(|wanted| wanted.sets_in = None);
        }
        listener.doing(Step::new(0.0, "reading"));
        let mut notes = Notes::default();
        let recordings =
            inputs::read(opened, (&checked, &known), &|doing| listener.doing(Step::new(0.0, doing)), &mut notes);
        listener.recordings(&notes);
        let recordings = recordings?;
        let warnings = recordings.iter().flat_map(|recording| recording.warnings.clone());
        let mut warnings = with_one_map(warnings.collect());
        let doubts = recordings.iter().flat_map(|recording| recording.doubts.clone());
        let mut doubts = with_one_map(doubts.collect());
        if self.as_read {
            if let Some(first) = doubts.first() {
                listener.note(&format!("{}: diagnosed as it was read, although {}", first.recording, first.text));
            }
            warnings.append(&mut doubts);
        }
        if !doubts.is_empty() {
            let names = |are: &[Role]| {
                let chosen = recordings.iter().filter(|recording| are.contains(&recording.role));
                chosen.map(|recording| recording.name.clone()).collect()
            };
            let names = RecordingNames {
                train: names(&[Role::Before, Role::Train]),
                before: names(&[Role::Before]),
                held_out: names(&[Role::HeldOut]),
                used_in_part: Vec::new(),
            };
            return Ok(Diagnosed {
                diagnosis: Diagnosis::units_first(arm.name(), names, doubts).with_warnings(warnings),
                robot,
                arm,
                effects: known,
            });
        }
        let list: Vec<Input<'_>> = recordings
            .iter()
            .map(|recording| Input {
                name: &recording.name,
                recording: &recording.regular,
                held_out: recording.role == Role::HeldOut,
                before: recording.role == Role::Before,
            })
            .collect();
        let options = Options {
            cutoff: self.cutoff,
            torque_lag: self.torque_lag,
            urdf_accuracy: self.urdf_accuracy,
            torque_accuracy: self.torque_accuracy,
            known,
            only,
            next: self.next,
            ..Options::default()
        };
        let mut diagnosis =
            diagnosis::diagnose(&arm, &list, &options, &|step| listener.doing(step))?.with_warnings(warnings);
        for remark in &diagnosis.remarks {
            listener.note(remark);
        }
        let without_lag = WithoutLag::of_report(&list, &diagnosis.report);
        let list = without_lag.of(&list);
        if !self.torques_only {
            let complete = validate::complete(&arm, &options.known, &diagnosis, &list, &|step| listener.doing(step))?;
            diagnosis.report = complete.report;
            for remark in complete.remarks {
                listener.note(&format!("simulation: {remark}"));
            }
        }
        // The known effects are part of the model that the findings correct.
        let effects = summed(&options.known, &diagnosis.effects);
        Ok(Diagnosed { robot, arm, diagnosis, effects })
    }

    fn arm(&self, robot: &RobotFile, recorded: &[String], listener: &dyn Listener) -> anyhow::Result<Arm> {
        let options = ChainOptions { recorded: recorded.to_vec(), ..self.chain.clone() };
        let arm = robot.arm(&options).context("--robot")?;
        for warning in arm.warnings() {
            listener.note(&format!("{}: {warning}", robot.path.display()));
        }
        Ok(arm)
    }

    /// Refuses a URDF whose own numbers say that they are in other units, unless the user says that it is right: with such a model, everything
    /// that would be said of the recordings is wrong.
    fn check_units(&self, robot: &RobotFile, arm: &Arm, listener: &dyn Listener) -> anyhow::Result<()> {
        let is_right = self.as_read || self.urdf_accuracy == Some(0.0);
        let path = robot.path.display();
        for doubt in arm.doubtful_units() {
            ensure!(is_right, "{path}: {doubt}; correct the URDF, or give --as-read if it is right");
            listener.note(&format!("{path}: taken as it is, although {doubt}"));
        }
        Ok(())
    }

    fn known(&self, arm: &Arm) -> anyhow::Result<Vec<Effect>> {
        let file = match &self.known {
            None => return Ok(Vec::new()),
            Some(Known::File(path)) => EffectFile::load(path, arm)?,
            Some(Known::Text(text)) => EffectFile::parse(text.clone(), Path::new("known"), arm)?,
        };
        Ok(file.effects)
    }
}

/// `doubts` with one column map where maps differ only in the factors of torques: each recording gives another estimate of
/// them, and one map serves for all recordings. The first one is kept.
fn with_one_map(mut doubts: Vec<Doubt>) -> Vec<Doubt> {
    let without_factors = |map: &str| -> Vec<String> {
        let lines = map.lines().map(|line| match line.split_once("tau_scale = ") {
            Some(("", _)) => "tau_scale",
            _ => line,
        });
        lines.map(str::to_owned).collect()
    };
    let Some(first) = doubts.iter().find_map(|doubt| doubt.column_map.clone()) else {
        return doubts;
    };
    for map in doubts.iter_mut().filter_map(|doubt| doubt.column_map.as_mut()) {
        if without_factors(map) == without_factors(&first) {
            map.clone_from(&first);
        }
    }
    doubts
}

/// A note on known effects of which a smaller size since the recordings from before is not found; `None` if there are none.
fn less_than_known(known: &[Effect]) -> Option<String> {
    let may_be_less = known.iter().filter(|effect| effect.spec().may_end && !effect.is(&PAYLOAD));
    let names: BTreeSet<&str> = may_be_less.map(Effect::name).collect();
    (!names.is_empty()).then(|| {
        let names: Vec<&str> = names.into_iter().collect();
        format!(
            "what is known and became less since the recordings from before is not found, except a payload: {}; leave it out of the known \
             effects (--known, or --urdf-friction ignored) to look for that",
            names.join(", ")
        )
    })
}

/// The effects that `only` asks for: `effect:joint,…`, or a file that a diagnosis wrote.
///
/// # Errors
/// If the file cannot be used. Effects that are not in the catalogue are refused when they are fitted.
pub fn wanted(only: &str, arm: &Arm) -> anyhow::Result<Vec<Wanted>> {
    let path = Path::new(only);
    if path.extension().is_some_and(|extension| extension == "toml") {
        let effects = EffectFile::load(path, arm)?.effects;
        let wanted = effects.iter().map(|effect| Wanted {
            effect: effect.name().to_owned(),
            joint: effect.joint().map(str::to_owned),
            other: effect.other().map(str::to_owned),
            sets_in: Some(effect.onset().is_some()),
        });
        return Ok(wanted.collect());
    }
    let words = only.split(',').map(str::trim).filter(|word| !word.is_empty());
    let wanted = words.map(|word| {
        let (effect, joint) = match word.split_once(':') {
            Some((effect, joint)) => (effect.trim_end(), Some(joint.trim_start().to_owned())),
            None => (word, None),
        };
        Wanted { effect: effect.to_owned(), joint, ..Wanted::default() }
    });
    let wanted: Vec<Wanted> = wanted.collect();
    ensure!(!wanted.is_empty(), "--only {only:?}: names no effect; give effect:joint, or a file that --model wrote");
    Ok(wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spaces_about_the_names_of_effects_and_joints_do_not_count() {
        let robot = robot::named_robot("puma560").expect("it comes with testbed");
        let arm = robot.arm(&ChainOptions::default()).expect("an arm");
        let of = |only: &str| -> Vec<(String, Option<String>)> {
            let wanted = wanted(only, &arm).expect("effects");
            wanted.into_iter().map(|one| (one.effect, one.joint)).collect()
        };
        let expected = [("coulomb_friction".to_owned(), Some("joint1".to_owned())), ("tilted_base".to_owned(), None)];
        assert_eq!(of("coulomb_friction:joint1,tilted_base"), expected);
        assert_eq!(of(" coulomb_friction : joint1 , tilted_base ,"), expected);
    }

    #[test]
    fn maps_that_differ_only_in_factors_of_torques_are_merged() {
        let doubt = |map: Option<&str>| Doubt {
            recording: "a.csv".to_owned(),
            joint: None,
            text: String::new(),
            column_map: map.map(str::to_owned),
        };
        let maps = [
            None,
            Some("q = \"q_a\"\ntau_scale = 5.3"),
            Some("q = \"q_a\"\ntau_scale = 5.4 # a guess"),
            Some("q = \"q_a\"\nq_offset = 1.5"),
        ];
        let found: Vec<Option<String>> =
            with_one_map(maps.map(doubt).into()).into_iter().map(|doubt| doubt.column_map).collect();
        let expected = [maps[0], maps[1], maps[1], maps[3]].map(|map| map.map(str::to_owned));
        assert_eq!(found, expected);
    }
}
