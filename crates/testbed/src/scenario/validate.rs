//! Validates a scenario.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, anyhow, bail, ensure};
use arm::Arm;
use clap::ValueEnum;
use study::{Source, robot, urdf_file};
use toml::Spanned;
use torque::{Fade, Feedback, Reference, Sine, Trajectory};

use super::Scenario;
use super::raw::{PerJoint, RawReference, RawScenario};
use super::recorded::trajectory;
use crate::cli::{ChainArgs, LengthScalesArg};
use crate::library;
use crate::models::ModelKind;
use crate::sensors::SensorNoise;

/// Defaults of the optional keys, which docs/scenarios.md documents.
const SAMPLE_RATE: f64 = 80.0;
const REFERENCE_CUTOFF: f64 = 10.0;
const CONTROL_RATE: f64 = 1000.0;
const KP: f64 = 100.0;
const KD: f64 = 20.0;

/// The longest run (s), the most control steps and the most samples; larger values are taken for errors of units.
const MAX_DURATION: f64 = 36_000.0;
const MAX_STEPS: f64 = 1e7;
const MAX_SAMPLES: f64 = 1e6;

/// The largest absolute value of a gain, an amplitude and the like, in any of their units.
const MAX_VALUE: f64 = 1e9;

/// Checks `raw`, which was parsed from `source`. The joints of the arm that `flags` select take the place of its
/// `[chain]`.
///
/// # Errors
/// In one line: file, line, key, reason and remedy.
pub fn scenario(source: &Source, raw: RawScenario, flags: &ChainArgs) -> anyhow::Result<Scenario> {
    let of_robot = || {
        let place = source.place(raw.robot.span());
        format!("{place}: robot")
    };
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let robot = robot::find_robot(raw.robot.get_ref(), folder).with_context(of_robot)?;
    let written = ChainArgs { base: raw.chain.base, tip: raw.chain.tip, lock: raw.chain.lock.into_iter().collect() };
    let chain = if flags.is_given() { flags } else { &written };
    let arm = robot.arm(&chain.options(&[])).with_context(of_robot)?;
    let stated = urdf_file::stated_rotor_inertias(&robot.text, &arm).with_context(of_robot)?;
    let urdf = robot.path;
    let check = Check { source, folder, arm: &arm };

    let duration = check.number("duration", Some(&raw.duration), 0.0)?;
    check.ensure(duration > 0.0 && duration <= MAX_DURATION, &raw.duration, || {
        format!("duration is {duration:?} s; give more than 0 and at most {MAX_DURATION}")
    })?;
    let control_rate = check.rate("controller.rate", raw.controller.rate.as_ref(), CONTROL_RATE)?;
    let reference_table = raw.reference.get_ref();
    let sample_rate = check.rate("reference.sample_rate", reference_table.sample_rate.as_ref(), SAMPLE_RATE)?;
    for (what, rate, most) in
        [("controller.rate", control_rate, MAX_STEPS), ("reference.sample_rate", sample_rate, MAX_SAMPLES)]
    {
        let count = (duration * rate).round();
        check.ensure((1.0..=most).contains(&count), &raw.duration, || {
            format!("duration of {duration:?} s at a {what} of {rate} Hz makes {count} steps; 1 to {most} are possible")
        })?;
    }
    let model = match &raw.model.kind {
        None => ModelKind::IndependentJoint,
        Some(written) => check.model(written)?,
    };
    let length_scales = match &raw.model.length_scales {
        None => LengthScalesArg::One,
        Some(written) => check.length_scales(written)?,
    };
    let inertia_scale = check.number("model.inertia_scale", raw.model.inertia_scale.as_ref(), 1.0)?;
    if let Some(written) = &raw.model.inertia_scale {
        check.ensure(inertia_scale > 0.0, written, || {
            format!("model.inertia_scale is {inertia_scale}; give a positive factor, 1 for no error")
        })?;
    }
    let (reference, doubts) = check.reference(&raw.reference, sample_rate.min(control_rate), duration)?;
    let kp = check.not_negative("controller.kp", raw.controller.kp.as_ref(), KP)?;
    let kd = check.not_negative("controller.kd", raw.controller.kd.as_ref(), KD)?;
    let feedback = match raw.controller.feedback.as_ref().map(|f| (f, f.get_ref().as_str())) {
        None | Some((_, "mass-matrix")) => Feedback::MassMatrix { kp, kd },
        Some((_, "gains")) => Feedback::Gains { kp, kd },
        Some((written, other)) => bail!(
            "{}: controller.feedback is \"{other}\"; known: \"mass-matrix\" (kp in 1/s², kd in 1/s) and \"gains\" \
             (kp in N m/rad, kd in N m s/rad)",
            source.place(written.span())
        ),
    };
    let mut rotor_inertia = check.not_negative("plant.rotor_inertia", raw.plant.rotor_inertia.as_ref(), 0.0)?;
    if raw.plant.rotor_inertia.is_none() {
        rotor_inertia = stated;
    }
    let mut viscous_friction =
        check.not_negative("plant.viscous_friction", raw.plant.viscous_friction.as_ref(), 0.0)?;
    if raw.plant.viscous_friction.is_none() {
        viscous_friction = arm.joints().iter().map(|joint| joint.damping).collect();
    }
    let mut coulomb_friction =
        check.not_negative("plant.coulomb_friction", raw.plant.coulomb_friction.as_ref(), 0.0)?;
    if raw.plant.coulomb_friction.is_none() {
        coulomb_friction = arm.joints().iter().map(|joint| joint.friction).collect();
    }
    let built_in = robot::is_built_in(raw.robot.get_ref());
    let notes = if built_in { Vec::new() } else { arm.warnings().to_vec() };
    let notes = notes.iter().map(|note| format!("{}: {note}", urdf.display())).chain(doubts).collect();
    let true_arm = arm.clone().with_rotor_inertias(&rotor_inertia);
    if let Some(joint) = true_arm.massless_joint() {
        let joint = &arm.joints()[joint];
        bail!(
            "{}: {}: link \"{}\" and those beyond it have no inertia about joint \"{}\", so the arm cannot be simulated; \
             give the link an <inertial>, or the joint a plant.rotor_inertia",
            source.place(raw.robot.span()),
            urdf.display(),
            joint.link_name,
            joint.name
        );
    }
    let sensor_noise = SensorNoise {
        position: check.not_negative("sensors.position_noise", raw.sensors.position_noise.as_ref(), 0.0)?,
        velocity: check.not_negative("sensors.velocity_noise", raw.sensors.velocity_noise.as_ref(), 0.0)?,
        torque: check.not_negative("sensors.torque_noise", raw.sensors.torque_noise.as_ref(), 0.0)?,
    };
    Ok(Scenario {
        name: source.name.clone(),
        title: raw.title.unwrap_or_else(|| source.name.clone()),
        path: source.path.clone(),
        arm: true_arm,
        urdf,
        duration,
        model,
        length_scales,
        fade: raw.model.fade.unwrap_or(true),
        inertia_scale,
        reference,
        sample_rate,
        control_rate,
        feedback,
        training: raw.training.scenarios.iter().map(|written| training_source(written, folder)).collect(),
        viscous_friction,
        coulomb_friction,
        notes,
        sensor_noise,
    })
}

/// Training data as they are found from the current folder. Files are relative to the scenario's `folder`, as the robot is; the name of
/// a scenario remains a name.
fn training_source(written: &str, folder: &Path) -> String {
    let path = Path::new(written);
    let beside = folder.join(path);
    let is_name = path.components().count() == 1 && path.extension().is_none();
    let is_file = !is_name || (library::built_in_scenario(written).is_none() && beside.exists());
    if is_file { beside.display().to_string() } else { written.to_owned() }
}

struct Check<'a> {
    source: &'a Source,
    /// The scenario's folder.
    folder: &'a Path,
    arm: &'a Arm,
}

impl Check<'_> {
    fn ensure<T>(&self, holds: bool, written: &Spanned<T>, reason: impl FnOnce() -> String) -> anyhow::Result<()> {
        ensure!(holds, "{}: {}", self.source.place(written.span()), reason());
        Ok(())
    }

    fn number(&self, key: &str, written: Option<&Spanned<f64>>, default: f64) -> anyhow::Result<f64> {
        let Some(written) = written else { return Ok(default) };
        let value = *written.get_ref();
        self.ensure(value.is_finite(), written, || format!("{key} is {value:?}; give a finite number"))?;
        Ok(value)
    }

    fn model(&self, written: &Spanned<String>) -> anyhow::Result<ModelKind> {
        let known = ModelKind::ALL.map(ModelKind::flag);
        match known.iter().position(|flag| flag == written.get_ref()) {
            Some(at) => Ok(ModelKind::ALL[at]),
            None => bail!(
                "{}: model.kind is \"{}\"; known: {}",
                self.source.place(written.span()),
                written.get_ref(),
                known.join(", ")
            ),
        }
    }

    fn length_scales(&self, written: &Spanned<String>) -> anyhow::Result<LengthScalesArg> {
        LengthScalesArg::from_str(written.get_ref(), false).map_err(|_| {
            anyhow!(
                "{}: model.length_scales is \"{}\"; known: one, per-input",
                self.source.place(written.span()),
                written.get_ref()
            )
        })
    }

    fn rate(&self, key: &str, written: Option<&Spanned<f64>>, default: f64) -> anyhow::Result<f64> {
        let Some(written) = written else { return Ok(default) };
        let value = self.number(key, Some(written), default)?;
        self.ensure((1.0..=100_000.0).contains(&value), written, || {
            format!("{key} is {value:?} Hz; give 1 to 100000")
        })?;
        Ok(value)
    }

    /// One finite value per joint.
    fn joints(&self, key: &str, written: Option<&Spanned<PerJoint>>, default: f64) -> anyhow::Result<Vec<f64>> {
        let dof = self.arm.dof();
        let Some(written) = written else {
            return Ok(vec![default; dof]);
        };
        let values = match written.get_ref() {
            PerJoint::All(value) => vec![*value; dof],
            PerJoint::Each(values) => values.clone(),
        };
        self.ensure(values.len() == dof, written, || {
            let names: Vec<&str> = self.arm.joints().iter().map(|joint| joint.name.as_str()).collect();
            format!(
                "{key} has {} values, but robot \"{}\" has {dof} joints ({}); give one value per joint, or one for all",
                values.len(),
                self.arm.name(),
                names.join(", ")
            )
        })?;
        if let Some(joint) = values.iter().position(|value| value.is_nan() || value.abs() > MAX_VALUE) {
            let name = &self.arm.joints()[joint].name;
            bail!(
                "{}: {key} of \"{name}\" is {:?}; give a number within ±{MAX_VALUE:e}",
                self.source.place(written.span()),
                values[joint]
            );
        }
        Ok(values)
    }

    fn not_negative(&self, key: &str, written: Option<&Spanned<PerJoint>>, default: f64) -> anyhow::Result<Vec<f64>> {
        let values = self.joints(key, written, default)?;
        match (values.iter().position(|value| *value < 0.0), written) {
            (Some(joint), Some(written)) => bail!(
                "{}: {key} of \"{}\" is {}; it must not be negative",
                self.source.place(written.span()),
                self.arm.joints()[joint].name,
                values[joint]
            ),
            _ => Ok(values),
        }
    }

    /// Frequencies from 0 to below half of `rate` (Hz).
    fn frequencies(&self, key: &str, written: &Spanned<PerJoint>, rate: f64) -> anyhow::Result<Vec<f64>> {
        let values = self.not_negative(key, Some(written), 0.0)?;
        if let Some(joint) = values.iter().position(|value| *value >= rate / 2.0) {
            bail!(
                "{}: {key} of \"{}\" is {} Hz, beyond the Nyquist frequency {} Hz of the slower of controller.rate and \
                 reference.sample_rate; lower it, or raise the rate",
                self.source.place(written.span()),
                self.arm.joints()[joint].name,
                values[joint],
                rate / 2.0
            );
        }
        Ok(values)
    }

    fn reference(
        &self,
        table: &Spanned<RawReference>,
        rate: f64,
        duration: f64,
    ) -> anyhow::Result<(Reference, Vec<String>)> {
        let raw = table.get_ref();
        let here = || self.source.place(table.span());
        let (recorded, doubts) = self.recorded(raw, duration)?.unzip();
        let centre = match &recorded {
            Some(recorded) if raw.centre.is_none() => recorded.start().to_vec(),
            _ => self.joints("reference.centre", raw.centre.as_ref(), 0.0)?,
        };
        let mut sines = Vec::new();
        let paper = [&raw.amplitude, &raw.frequency_1, &raw.frequency_2];
        match paper {
            [Some(amplitude), Some(frequency_1), Some(frequency_2)] => {
                let amplitude = self.joints("reference.amplitude", Some(amplitude), 0.0)?;
                let third = amplitude.iter().map(|a| a / 3.0).collect();
                for (key, frequency, amplitude) in
                    [("frequency_1", frequency_1, amplitude), ("frequency_2", frequency_2, third)]
                {
                    sines.push(Sine {
                        amplitude,
                        frequency: self.frequencies(&format!("reference.{key}"), frequency, rate)?,
                        phase: vec![0.0; self.arm.dof()],
                    });
                }
            }
            [None, None, None] => {}
            _ => bail!(
                "{}: amplitude, frequency_1 and frequency_2 go together (equation 20 of the paper); give all three, or \
                 [[reference.sines]] with amplitude, frequency and phase",
                here()
            ),
        }
        for sine in &raw.sines {
            sines.push(Sine {
                amplitude: self.joints("reference.sines.amplitude", Some(&sine.amplitude), 0.0)?,
                frequency: self.frequencies("reference.sines.frequency", &sine.frequency, rate)?,
                phase: self.joints("reference.sines.phase", sine.phase.as_ref(), 0.0)?,
            });
        }
        if sines.is_empty() && recorded.is_none() {
            return Err(anyhow!(
                "{}: no motion; give amplitude, frequency_1 and frequency_2, [[reference.sines]], or the file of a recording",
                here()
            ));
        }
        let seconds = self.number("reference.fade", raw.fade.as_ref(), 0.0)?;
        if let Some(written) = &raw.fade {
            self.ensure((0.0..=0.5 * duration).contains(&seconds), written, || {
                format!("reference.fade is {seconds:?} s; give 0 to {}, half of the duration", 0.5 * duration)
            })?;
        }
        let end = duration;
        let fade = (seconds > 0.0).then_some(Fade { seconds, end });
        Ok((Reference { centre, recorded, sines, fade }, doubts.unwrap_or_default()))
    }

    /// The recorded motion that the reference follows for the whole `duration` (s), and what is doubtful about it; `None` without a file.
    fn recorded(&self, raw: &RawReference, duration: f64) -> anyhow::Result<Option<(Arc<Trajectory>, Vec<String>)>> {
        let cutoff = self.number("reference.cutoff", raw.cutoff.as_ref(), REFERENCE_CUTOFF)?;
        let Some(file) = &raw.file else {
            let Some(written) = &raw.cutoff else { return Ok(None) };
            bail!(
                "{}: reference.cutoff filters the positions of reference.file, which is not given; give both, or neither",
                self.source.place(written.span())
            );
        };
        if let Some(written) = &raw.cutoff {
            self.ensure(cutoff > 0.0, written, || format!("reference.cutoff is {cutoff:?} Hz; give more than 0"))?;
        }
        let of_file = || format!("{}: reference.file", self.source.place(file.span()));
        let (recorded, doubts) =
            trajectory(&self.folder.join(file.get_ref()), self.arm, cutoff).with_context(of_file)?;
        let most = (1e3 * recorded.duration() + 1e-6).floor() / 1e3;
        self.ensure(duration <= most, file, || {
            format!(
                "reference.file \"{}\" has {most:.3} s of motion, without what its filter needs at both ends; give a duration of at most that",
                file.get_ref().display()
            )
        })?;
        Ok(Some((Arc::new(recorded), doubts)))
    }
}
