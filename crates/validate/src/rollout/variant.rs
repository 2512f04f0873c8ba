//! One arm in the plant, with its effects, over a window.

use arm::{Arm, DMatrix};
use effects::Effect;
use plant::{Plant, PlantError, PlantOptions};
use torque::{Corrected, Workspace};

use super::drive::{Connection, Drives};
use super::start::{Start, guiding_torque};
use super::{Course, Path};
use crate::error::ValidateError;
use crate::nearest_body::nearest_body;

/// The distance (rad or m) from which a simulated joint counts as lost.
const LOST: f64 = std::f64::consts::TAU;

/// The inertia of guided joints, as a multiple of the largest of the arm's own.
const GUIDE: f64 = 1e5;

/// The plant of an arm with effects, and its drives.
pub(super) struct Variant {
    model: Corrected,
    plant: Plant,
    drives: Drives,
    workspace: Workspace,
    is_loaded: bool,
    /// The inertia that guided joints have, so that no other torque moves them (kg m² or kg).
    guide: f64,
    /// Effects that are only partly simulated.
    pub(super) remarks: Vec<String>,
    qdd: Vec<f64>,
    encoder: Vec<f64>,
    encoder_rate: Vec<f64>,
    dry: Vec<f64>,
    opposing: Vec<f64>,
    tau: Vec<f64>,
    before: Vec<f64>,
}

impl Variant {
    /// The plant of `arm` with `effects` along `course`; `which` is its name in errors.
    pub(super) fn new(
        which: &'static str,
        arm: &Arm,
        effects: &[Effect],
        course: &Course<'_>,
    ) -> Result<Self, ValidateError> {
        let model = Corrected::new(arm, effects).map_err(|source| ValidateError::Effects { which, source })?;
        let dof = arm.dof();
        let names: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
        let mut rotors: Vec<f64> = model.arm().joints().iter().map(|joint| joint.rotor_inertia).collect();
        let (robot, replaced) =
            if effects.is_empty() { (model.arm().clone(), Vec::new()) } else { with_possible_bodies(model.arm()) };
        let links = link_inertias(&robot, &rotors);
        let mut drives = Drives::new(model.machine(), &names, &rotors, &links, course.step);
        let guide = GUIDE * links.iter().chain(&rotors).fold(0.0, |most: f64, &inertia| most.max(inertia));
        for (j, rotor) in rotors.iter_mut().enumerate() {
            if course.is_guided(j) {
                drives.connections[j] = None;
                *rotor = guide;
            } else if drives.is_separate(j) {
                *rotor = 0.0;
            }
        }
        let options =
            PlantOptions { step: course.step, order: course.order, viscous: model.viscous(), coulomb: Vec::new() };
        let mut remarks = drives.remarks.clone();
        if !replaced.is_empty() {
            remarks.push(format!(
                "the effects leave bodies that cannot exist beyond {}; the nearest possible ones are simulated",
                replaced.join(", ")
            ));
        }
        let plant = Plant::new(&robot.with_rotor_inertias(&rotors), &options).map_err(|source| match source {
            PlantError::Massless { joint } if !effects.is_empty() => ValidateError::Emptied { which, joint },
            source => ValidateError::Plant { which, source },
        })?;
        let zeros = || vec![0.0; dof];
        Ok(Self {
            guide,
            is_loaded: !effects.is_empty(),
            remarks,
            model,
            plant,
            drives,
            workspace: Workspace::new(dof),
            qdd: zeros(),
            encoder: zeros(),
            encoder_rate: zeros(),
            dry: zeros(),
            opposing: zeros(),
            tau: zeros(),
            before: zeros(),
        })
    }

    /// Runs a window from the measured state; returns the positions that the encoders would report.
    pub(super) fn run(&mut self, course: &Course<'_>, start: &Start, instants: usize) -> Path {
        let dof = start.q.len();
        let mut q = vec![Vec::with_capacity(instants + 1); dof];
        for (j, path) in q.iter_mut().enumerate() {
            path.push(start.q[j]);
        }
        let mut ran_away = self.begin(course, start).is_err();
        for k in 1..=instants {
            let tick = start.tick + (k - 1) * course.stride;
            if ran_away || self.advance(course, tick).is_err() {
                ran_away = true;
                break;
            }
            for (j, path) in q.iter_mut().enumerate() {
                path.push(self.encoder(j));
            }
            ran_away = self.is_lost(course, tick + course.stride);
        }
        Path { q, ran_away }
    }

    fn is_lost(&self, course: &Course<'_>, tick: usize) -> bool {
        (0..self.tau.len()).any(|j| (self.encoder(j) - course.recording.q[course.columns[j]][tick]).abs() > LOST)
    }

    /// The encoder's reading of joint `j`.
    fn encoder(&self, j: usize) -> f64 {
        let standing = self.drives.connections[j].as_ref().map_or(self.plant.q()[j], Connection::encoder);
        standing - self.model.encoder_offsets()[j]
    }

    /// Sets the plant to the measured state.
    fn begin(&mut self, course: &Course<'_>, start: &Start) -> Result<(), PlantError> {
        let time = course.recording.time(start.tick);
        let mut q = start.q.clone();
        for (j, q) in q.iter_mut().enumerate() {
            *q += self.model.encoder_offsets()[j];
            if let Some(connection) = &mut self.drives.connections[j] {
                let rotor = self.model.arm().joints()[j].rotor_inertia;
                let carried = start.tau[j] / self.model.torque_factor(j, Some(time)) - rotor * start.qdd[j];
                *q = connection.start(*q, start.qd[j], carried);
            }
        }
        self.qdd.copy_from_slice(&start.qdd);
        self.plant.set_state(&q, &start.qd)?;
        Ok(())
    }

    /// Moves on from `tick` to the next compared instant.
    fn advance(&mut self, course: &Course<'_>, tick: usize) -> Result<(), PlantError> {
        let step = course.step;
        for substep in 0..course.substeps {
            // All effects are evaluated at the middle of the step.
            let into = (substep as f64 + 0.5) * step;
            let time = course.recording.time(tick) + into;
            for j in 0..self.tau.len() {
                let commanded = commanded(course, j, tick, into - self.drives.delays[j]);
                let limit = self.model.torque_limits()[j];
                self.tau[j] = commanded.clamp(-limit, limit) / self.model.torque_factor(j, Some(time));
                self.encoder_rate[j] = self.plant.qd()[j] + 0.5 * step * self.qdd[j];
                self.encoder[j] = self.plant.q()[j] + 0.5 * step * self.plant.qd()[j] - self.model.encoder_offsets()[j];
            }
            if self.is_loaded {
                self.model.joint_loads(
                    time,
                    &mut self.workspace,
                    &self.encoder,
                    &self.encoder_rate,
                    &self.qdd,
                    &mut self.dry,
                    &mut self.opposing,
                );
                self.plant.set_dry_friction(&self.dry)?;
            }
            for j in 0..self.tau.len() {
                if let Some(connection) = &mut self.drives.connections[j] {
                    let (q, qd) = (self.plant.q()[j], self.plant.qd()[j]);
                    self.tau[j] = connection.advance(self.tau[j], q, qd, self.qdd[j], step);
                }
                self.tau[j] -= self.opposing[j];
                if course.is_guided(j) {
                    let state = (self.plant.q()[j], self.plant.qd()[j]);
                    self.tau[j] = guiding_torque(course, j, tick, into, state, self.guide);
                }
            }
            self.before.copy_from_slice(self.plant.qd());
            self.plant.step(&self.tau)?;
            for ((qdd, after), before) in self.qdd.iter_mut().zip(self.plant.qd()).zip(&self.before) {
                *qdd = (after - before) / step;
            }
        }
        Ok(())
    }
}

/// `arm` with the nearest possible body in place of each that no mass or tensor can have, and the joints of those. Recordings
/// determine the moments of a body that is not mounted less well than its mass.
fn with_possible_bodies(arm: &Arm) -> (Arm, Vec<String>) {
    let mut possible = arm.clone();
    let mut replaced = Vec::new();
    for (link, joint) in arm.joints().iter().enumerate() {
        if let (body, true) = nearest_body(&joint.inertia) {
            possible = possible.with_link_inertia(link, body);
            replaced.push(joint.name.clone());
        }
    }
    (possible, replaced)
}

/// The recorded torque of joint `j` (N m or N) at `into` seconds after `tick`: linear between ticks, or the mean over the step
/// if it contains several.
fn commanded(course: &Course<'_>, j: usize, tick: usize, into: f64) -> f64 {
    let recording = course.recording;
    let tau = &recording.tau[course.columns[j]];
    let at = |place: f64| {
        // Only a delay can lead to times before the segment.
        let place = place.clamp(0.0, (tau.len() - 1) as f64);
        let before = place.floor() as usize;
        let share = place - before as f64;
        let after = (before + 1).min(tau.len() - 1);
        tau[before] + share * (tau[after] - tau[before])
    };
    let middle = tick as f64 + into / recording.period;
    let half = (course.stride / 2) as f64;
    if course.stride == 1 {
        return at(middle);
    }
    let points = 2 * (course.stride / 2) + 1;
    (0..points).map(|k| at(middle - half + k as f64)).sum::<f64>() / points as f64
}

/// The inertia that each joint alone moves at q = 0, without its rotor (kg m² or kg).
fn link_inertias(arm: &Arm, rotors: &[f64]) -> Vec<f64> {
    let dof = arm.dof();
    let mut mass_matrix = DMatrix::zeros(dof, dof);
    arm.mass_matrix(&mut arm::Workspace::new(arm), &vec![0.0; dof], &mut mass_matrix);
    (0..dof).map(|j| mass_matrix[(j, j)] - rotors[j]).collect()
}
