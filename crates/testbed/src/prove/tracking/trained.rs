//! Independent Joint Learning on the recordings that a diagnosis was fitted to, with the URDF alone and with the named
//! effects.

use std::path::Path;

use anyhow::Context;
use arm::Arm;
use diagnosis::{Input, Options, Trace};
use effects::Effect;
use effects::drive::{ACTUATION_DELAY, TORQUE_SATURATION};
use recording::{Recording, RegularRecording};
use torque::{Learned, Prediction, Workspace};
use validate::learned::{self, LearnedOptions, RecordedMotion};

use super::plan::correction;

/// The number of samples: twice that of a diagnosis, which needs them for a comparison only. The cost grows with the cube.
const SAMPLES: usize = 300;

/// The training recordings as a diagnosis filters and differentiates them.
pub struct Recorded {
    traces: Vec<Trace>,
}

impl Recorded {
    /// Reads `files` in `folder`, whose joints are those of `arm`.
    ///
    /// # Errors
    /// If one cannot be read, or nothing can be fitted to them.
    pub fn read(arm: &Arm, folder: &Path, files: &[String]) -> anyhow::Result<Self> {
        let regular = |name: &String| -> anyhow::Result<RegularRecording> {
            let path = folder.join(name);
            let recording = Recording::read(&path)?;
            Ok(recording.regular().with_context(|| path.display().to_string())?.0)
        };
        let recordings: Vec<RegularRecording> = files.iter().map(regular).collect::<anyhow::Result<_>>()?;
        let inputs: Vec<Input<'_>> = files
            .iter()
            .zip(&recordings)
            .map(|(name, recording)| Input { name, recording, held_out: false, before: false })
            .collect();
        // Nothing is fitted; only the filtered motion is needed.
        let options = Options { only: Some(Vec::new()), ..Options::default() };
        let diagnosis = diagnosis::diagnose(arm, &inputs, &options, &|_| ())?;
        Ok(Self { traces: diagnosis.traces.recordings })
    }

    /// Learns the residual of `arm` with `effects` on the recorded torques.
    ///
    /// # Errors
    /// If the effects do not fit the arm, or a regression fails.
    pub fn learn(&self, arm: &Arm, effects: &[Effect]) -> anyhow::Result<Learned> {
        let model = correction(arm, effects)?;
        let dof = arm.dof();
        let (mut workspace, mut prediction) = (Workspace::new(dof), Prediction::new(dof));
        let mut rows = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
        let mut changed: Vec<[Vec<Vec<f64>>; 2]> = Vec::new();
        for trace in &self.traces {
            // The applied torque must be explained, not the commanded one, which may be earlier or larger.
            let mut tau: Vec<Vec<f64>> = (0..dof).map(|j| applied(trace, j, effects, &arm.joints()[j].name)).collect();
            let mut q = trace.q.clone();
            for row in 0..trace.time.len() {
                for (into, signal) in rows.iter_mut().zip([&trace.q, &trace.qd, &trace.qdd]) {
                    into.iter_mut().zip(signal).for_each(|(value, joint)| *value = joint[row]);
                }
                let [said, qd, qdd] = &rows;
                model.predict_at(trace.time[row], &mut workspace, said, qd, qdd, &mut prediction);
                for j in 0..dof {
                    // Rigid torque and inputs are those of the true positions, without encoder offsets.
                    q[j][row] += model.encoder_offsets()[j];
                    tau[j][row] -= prediction.effects[j];
                }
            }
            changed.push([q, tau]);
        }
        let motions: Vec<RecordedMotion<'_>> = self
            .traces
            .iter()
            .zip(&changed)
            .map(|(trace, [q, tau])| RecordedMotion { q, qd: &trace.qd, qdd: &trace.qdd, tau, moving: &trace.moving })
            .collect();
        let options = LearnedOptions { samples: SAMPLES, ..LearnedOptions::default() };
        Ok(learned::learn(model.arm(), &motions, &options)?)
    }
}

/// The torque that the drive of joint `j`, named `joint`, applied according to the named effects: delayed and limited.
fn applied(trace: &Trace, j: usize, effects: &[Effect], joint: &str) -> Vec<f64> {
    let (mut late, mut most) = (0.0, f64::INFINITY);
    for effect in effects.iter().filter(|effect| effect.joint() == Some(joint)) {
        if effect.is(&ACTUATION_DELAY) {
            late += effect.number("delay");
        } else if effect.is(&TORQUE_SATURATION) {
            most = effect.number("limit").min(most);
        }
    }
    let mut tau = shifted(&trace.time, &trace.tau[j], late);
    for tau in &mut tau {
        *tau = tau.clamp(-most, most);
    }
    tau
}

/// A signal delayed by `late` (s): linear between rows, and equal to the first value before the first row.
fn shifted(time: &[f64], values: &[f64], late: f64) -> Vec<f64> {
    if late == 0.0 {
        return values.to_vec();
    }
    let at = |&now: &f64| {
        let wanted = now - late;
        let after = time.partition_point(|&stamp| stamp <= wanted);
        match (after.checked_sub(1), time.get(after)) {
            (Some(before), Some(next)) => {
                let part = (wanted - time[before]) / (next - time[before]);
                values[before] + part * (values[after] - values[before])
            }
            (Some(before), None) => values[before],
            (None, _) => values[0],
        }
    };
    time.iter().map(at).collect()
}
