//! Effects that the user knows.

use arm::Arm;
use effects::{Effect, Scales, Term};
use torque::{Corrected, Prediction, Workspace};

use crate::data::motion::Motions;
use crate::data::rigid::Rigid;
use crate::error::DiagnosisError;

/// The model with the known effects.
pub struct Known {
    /// The arm, with known payloads, link errors, drives and gravity.
    pub arm: Arm,
    model: Option<Corrected>,
    /// Known effects that are functions of the commanded torque.
    of_command: Vec<Effect>,
}

/// What was subtracted, each `[chunk][joint][tick]`.
#[derive(Default)]
pub struct Subtracted {
    /// The torques as they were recorded (N m or N); empty if no effect is known.
    pub recorded: Vec<Vec<Vec<f64>>>,
    /// Known dry friction, if there is any: what was subtracted beyond the torque that is the same in both directions, and the
    /// largest torque that it holds at rest (N m or N).
    pub dry: Option<[Vec<Vec<Vec<f64>>>; 2]>,
}

impl Known {
    /// `arm` with `effects`.
    ///
    /// # Errors
    /// [`DiagnosisError`], if an effect does not fit the arm.
    pub fn new(arm: &Arm, effects: &[Effect]) -> Result<Self, DiagnosisError> {
        if effects.is_empty() {
            return Ok(Self { arm: arm.clone(), model: None, of_command: Vec::new() });
        }
        let (simulated, now): (Vec<Effect>, Vec<Effect>) = effects.iter().cloned().partition(is_simulated);
        let model = Corrected::new(arm, &now)?;
        let of_command = simulated.into_iter().filter(|effect| effect.of_command(0).is_some());
        Ok(Self { arm: model.arm().clone(), model: Some(model), of_command: of_command.collect() })
    }

    /// Subtracts known effects from the torques, and corrects the positions for known encoder offsets.
    pub fn subtract(&self, motions: &mut Motions) -> Subtracted {
        let Some(model) = &self.model else {
            return Subtracted::default();
        };
        let recorded = motions.chunks.iter().map(|chunk| chunk.tau.clone()).collect();
        let has_dry = !model.machine().dry.is_empty();
        let mut dry: [Vec<Vec<Vec<f64>>>; 2] = Default::default();
        let dof = self.arm.dof();
        let mut workspace = Workspace::new(dof);
        let mut prediction = Prediction::new(dof);
        let mut scratch = arm::Workspace::new(&self.arm);
        let mut rigid = vec![0.0; dof];
        for chunk in &mut motions.chunks {
            for list in dry.iter_mut().filter(|_| has_dry) {
                list.push(vec![Vec::with_capacity(chunk.ticks()); dof]);
            }
            for tick in 0..chunk.ticks() {
                let at = |signal: &[Vec<f64>]| -> Vec<f64> { signal.iter().map(|joint| joint[tick]).collect() };
                let (q, qd, qdd) = (at(&chunk.q), at(&chunk.qd), at(&chunk.qdd));
                model.predict_at(chunk.time(tick), &mut workspace, &q, &qd, &qdd, &mut prediction);
                let standing: Vec<f64> = q.iter().zip(model.encoder_offsets()).map(|(q, o)| q + o).collect();
                self.arm.inverse_dynamics(&mut scratch, &standing, &qd, &qdd, &mut rigid);
                if has_dry {
                    let friction = model.dry_friction(chunk.time(tick), &qd, &qdd, &prediction);
                    for (joint, both) in friction.into_iter().enumerate() {
                        for (list, value) in dry.iter_mut().zip(both) {
                            if let Some(of_chunk) = list.last_mut() {
                                of_chunk[joint].push(value);
                            }
                        }
                    }
                }
                for joint in 0..dof {
                    chunk.q[joint][tick] = standing[joint];
                    chunk.tau[joint][tick] -= prediction.torque(joint) - rigid[joint];
                }
            }
        }
        Subtracted { recorded, dry: has_dry.then_some(dry) }
    }

    /// Subtracts the known effects that are functions of the commanded torque, which is `recorded` (`[chunk][joint][tick]`) where any
    /// effect is known. Each acts on what the one before it leaves of the commanded torque. `rigid` is the arm along `motions`.
    pub fn subtract_commanded(
        &self,
        motions: &mut Motions,
        recorded: &[Vec<Vec<f64>>],
        rigid: &[Rigid],
        scales: &Scales,
    ) {
        let joints = self.arm.joints().iter().enumerate();
        let terms: Vec<(usize, Term)> = joints
            .flat_map(|(joint, described)| {
                let is_here = |effect: &&Effect| effect.joint() == Some(&*described.name);
                let here = self.of_command.iter().filter(is_here);
                here.filter_map(move |effect| Some((joint, effect.of_command(joint)?)))
            })
            .collect();
        if terms.is_empty() {
            return;
        }
        for ((chunk, recorded), rigid) in motions.chunks.iter_mut().zip(recorded).zip(rigid) {
            let mut left = std::mem::replace(&mut chunk.tau, recorded.clone());
            for (joint, term) in &terms {
                let removed = term.column(*joint, &rigid.along(chunk, scales)).unwrap_or_default();
                for (k, removed) in removed.into_iter().enumerate() {
                    chunk.tau[*joint][k] -= removed;
                    left[*joint][k] -= removed;
                }
            }
            chunk.tau = left;
        }
    }
}

/// Whether an effect depends on the past of the motion or on the commanded torque.
fn is_simulated(effect: &Effect) -> bool {
    effect.spec().is_simulated
}
