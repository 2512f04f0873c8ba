//! Shared by tests and benches of the diagnosis: arms, a known motion, and recordings of both with injected effects.

#![allow(dead_code, reason = "each test takes what it needs")]

use std::cell::Cell;
use std::f64::consts::TAU;

use arm::{Arm, Workspace};
use diagnosis::{Diagnosis, DiagnosisError, Input, Options, diagnose};
use effects::Effect;
use recording::{Recording, RegularRecording};

pub mod gap;

/// Three joints: a turning column, a shoulder and an elbow.
pub const TRIO: &str = include_str!("trio.urdf");

/// The index of the column in [`TRIO`].
pub const TURN: usize = 0;
/// The index of the shoulder in [`TRIO`].
pub const SHOULDER: usize = 1;
/// The index of the elbow in [`TRIO`].
pub const ELBOW: usize = 2;

/// The arm of [`TRIO`].
pub fn trio() -> Arm {
    Arm::from_urdf_text(TRIO, "trio.urdf").expect("it is an arm")
}

/// The motion at one time.
pub struct Motion {
    /// The time since the recording's start (s).
    pub time: f64,
    /// The time on the common clock of all recordings (s).
    pub clock: f64,
    /// Positions (rad).
    pub q: Vec<f64>,
    /// Velocities (rad/s).
    pub qd: Vec<f64>,
    /// Accelerations (rad/s²).
    pub qdd: Vec<f64>,
}

/// Four sines per joint about a bent arm; `variant` selects frequencies and phases.
pub fn motion(dof: usize, time: f64, variant: usize) -> Motion {
    let middle = |joint: usize| [0.0, -0.5, 0.7][joint % 3];
    let mut motion = Motion {
        time,
        clock: time + start(variant),
        q: (0..dof).map(middle).collect(),
        qd: vec![0.0; dof],
        qdd: vec![0.0; dof],
    };
    for joint in 0..dof {
        for (k, hertz) in [0.11, 0.23, 0.41, 0.67].into_iter().enumerate() {
            let turn = (7 * joint + 3 * k + 5 * variant) as f64;
            let omega = TAU * hertz * (1.0 + 0.08 * (2.4 * turn).sin());
            let amplitude = 0.34 / (1.0 + 0.6 * k as f64);
            let (sin, cos) = (omega * time + 1.9 * turn).sin_cos();
            motion.q[joint] += amplitude * sin;
            motion.qd[joint] += amplitude * omega * cos;
            motion.qdd[joint] -= amplitude * omega * omega * sin;
        }
    }
    motion
}

/// Injected effects, as a function that changes the recorded motion and its torques.
pub type Injected<'a> = &'a dyn Fn(&mut Motion, &mut [f64]);

/// The time of the first row of a recording on the common clock (s).
pub fn start(variant: usize) -> f64 {
    1e3 * variant as f64
}

/// A recording of `seconds` at 250 Hz of `arm` with the effects `injected` and noise of 0.02 N m.
pub fn recorded(arm: &Arm, variant: usize, seconds: f64, injected: Injected<'_>) -> Recording {
    let dof = arm.dof();
    let mut workspace = Workspace::new(arm);
    let mut recording = Recording {
        joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
        q: vec![Vec::new(); dof],
        tau: vec![Vec::new(); dof],
        ..Recording::default()
    };
    let mut random = 1 + variant as u64;
    let mut tau = vec![0.0; dof];
    for k in 0..(250.0 * seconds) as usize {
        let time = k as f64 / 250.0;
        let mut motion = motion(dof, time, variant);
        arm.inverse_dynamics(&mut workspace, &motion.q, &motion.qd, &motion.qdd, &mut tau);
        injected(&mut motion, &mut tau);
        recording.time.push(time + start(variant));
        for joint in 0..dof {
            recording.q[joint].push((motion.q[joint] * 1e6).round() / 1e6);
            recording.tau[joint].push(tau[joint] + 0.02 * normal(&mut random));
        }
    }
    recording
}

/// A nearly normal number: the sum of twelve uniform numbers (splitmix64) minus six.
fn normal(state: &mut u64) -> f64 {
    let uniform = |state: &mut u64| {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..12).map(|_| uniform(state)).sum::<f64>() - 6.0
}

/// Uniform noise between −0.5 and 0.5, of a multiplicative congruential generator (Lehmer).
pub fn uniform(state: &Cell<u64>) -> f64 {
    state.set(state.get() * 48_271 % 2_147_483_647);
    state.get() as f64 / 2_147_483_647.0 - 0.5
}

/// The recording on its clock.
pub fn regular(recording: &Recording) -> RegularRecording {
    recording.regular().expect("the clock is regular").0
}

/// Diagnoses the model `believed` with the `known` effects on recordings of `robot` with the effects `injected`: two of 16
/// s for training and one of 10 s held out.
pub fn diagnosed(believed: &Arm, robot: &Arm, injected: Injected<'_>, known: Vec<Effect>) -> Diagnosis {
    let options = Options { known, ..Options::default() };
    diagnosed_with(believed, robot, injected, &options).expect("it can be diagnosed")
}

/// The diagnosis with the given options.
pub fn diagnosed_with(
    believed: &Arm,
    robot: &Arm,
    injected: Injected<'_>,
    options: &Options,
) -> Result<Diagnosis, DiagnosisError> {
    let recordings = [16.0, 16.0, 10.0];
    let recordings: Vec<RegularRecording> = recordings
        .into_iter()
        .enumerate()
        .map(|(variant, seconds)| regular(&recorded(robot, variant, seconds, injected)))
        .collect();
    let diagnosis = diagnose(believed, &inputs(&recordings), options, &|_| {})?;
    for open in diagnosis.report.unexplained.iter().filter(|open| open.time.is_empty()) {
        let fit = &diagnosis.report.fit[&open.joint];
        let error = fit.held_out_nrmse_augmented.unwrap_or(0.0).max(fit.train_nrmse_augmented);
        // Rows within a contact count in one of the two alone.
        assert!(open.share <= 1.1 * error, "a part is larger than the whole: {open:?}, {fit:?}");
    }
    Ok(diagnosis)
}

/// Recordings a, b, c, d, of which c is held out.
pub fn inputs(recordings: &[RegularRecording]) -> Vec<Input<'_>> {
    ["a", "b", "c", "d"]
        .into_iter()
        .zip(recordings)
        .map(|(name, recording)| Input { name, recording, held_out: name == "c", before: false })
        .collect()
}

/// The torques of a joint, whose drive has a reflected inertia of `rotor` (kg m²), as they are commanded, `delay` (s) before they act.
pub fn delayed_on(joint: usize, delay: f64, rotor: f64) -> impl Fn(&mut Motion, &mut [f64]) {
    let arm = trio();
    move |now: &mut Motion, tau: &mut [f64]| {
        baseline_friction(now, tau);
        let is_this = |&variant: &usize| motion(3, now.time, variant).q == now.q;
        let variant = (0..3).find(is_this).expect("it is one of the three");
        let ahead = motion(3, now.time + delay, variant);
        let mut later = [0.0; 3];
        let mut workspace = Workspace::new(&arm);
        arm.inverse_dynamics(&mut workspace, &ahead.q, &ahead.qd, &ahead.qdd, &mut later);
        baseline_friction(&ahead, &mut later);
        tau[joint] = later[joint] + rotor * ahead.qdd[joint];
    }
}

/// Baseline friction on every joint.
pub fn baseline_friction(motion: &Motion, tau: &mut [f64]) {
    for joint in 0..3 {
        let speed = motion.qd[joint];
        tau[joint] += 0.6 * speed.signum() + 0.4 * speed;
    }
}

/// The findings beside plain friction: effects and joints.
pub fn named(diagnosis: &Diagnosis) -> Vec<(&str, Option<&str>)> {
    let plain = ["viscous_friction", "coulomb_friction"];
    let findings = diagnosis.report.findings.iter();
    let special = findings.filter(|finding| !plain.contains(&finding.effect));
    special.map(|finding| (finding.effect, finding.joint.as_deref())).collect()
}

/// The effects of the findings on a joint.
pub fn effects_on<'a>(diagnosis: &'a Diagnosis, joint: &str) -> Vec<&'a str> {
    let findings = diagnosis.report.findings.iter();
    let on_joint = findings.filter(|finding| finding.joint.as_deref() == Some(joint));
    on_joint.map(|finding| finding.effect).collect()
}

/// The sentences of the findings.
pub fn sentences(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.report.findings.iter().map(|finding| finding.sentence.as_str()).collect()
}

/// Two errors (NRMSE) count as equal if they differ by less, because the fit takes the sign of a velocity near a reversal
/// from the filtered motion, and the exported law from each sample.
const SAME_ERROR: f64 = 0.002;

/// Checks that the error with the exported effects as known effects (`again`) is the reported one to within a `part` of it, because
/// exported laws are the fitted ones. Known gaps and springs between drive and link are found again instead of subtracted.
pub fn exports_what_it_reports(diagnosis: &Diagnosis, again: &Diagnosis, part: f64) {
    let is_found_again = |effect: &Effect| effect.spec().is_simulated && effect.of_command(0).is_none();
    if diagnosis.effects.iter().any(is_found_again) {
        return;
    }
    for (joint, fit) in &diagnosis.report.fit {
        let exported = again.report.fit[joint].held_out_nrmse_nominal.expect("it is moved");
        let reported = fit.held_out_nrmse_exported.expect("it is moved");
        assert!(
            (exported - reported).abs() < SAME_ERROR.max(part * reported),
            "{joint}: {exported} with the exported effects, {reported} reported"
        );
    }
}
