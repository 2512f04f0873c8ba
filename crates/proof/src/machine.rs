//! The true machine: the plant in its position loop, with all that its URDF leaves out.

use arm::{Arm, Matrix6xX, Workspace};
use plant::{Plant, PlantOptions};

use crate::error::ProofError;
use crate::law::{At, resistance};
use crate::motion::Reference;
use crate::robot::Robot;
use crate::truth::Concealed;

mod drive;
mod friction;
mod parts;

pub(crate) use drive::LONGEST_DELAY;
use drive::{Drive, Rotor};
use friction::Friction;
use parts::Parts;

/// The loop's period, and the plant's step (s).
pub(crate) const TICK: f64 = 1e-3;
/// rapier's plain step: another than the diagnosis' own simulation takes.
const ORDER: usize = 1;
/// The drives' velocity filter (Hz).
const VELOCITY_FILTER: f64 = 40.0;
/// Damping ratio of the position loop, and its natural frequency (rad/s) at least and at most.
const DAMPING: f64 = 0.8;
const FREQUENCIES: (f64, f64) = (20.7, 30.0);
/// How far a joint would hang from its loop under a torque as large as its own gravity's (rad or m).
const SAG: f64 = 0.05;
/// The furthest a joint may be from its reference (rad or m).
pub(crate) const FURTHEST: f64 = 0.35;
/// Time constant of the drive load that friction feels (s).
const LOAD_FILTER: f64 = 0.02;

/// What the drives saw at every tick of a run; `[tick × dof + joint]`.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    /// Encoder positions (rad or m).
    pub q: Vec<f64>,
    /// Filtered velocities.
    pub qd: Vec<f64>,
    /// Torques as the drives report them: commanded (N m or N).
    pub tau: Vec<f64>,
}

/// A robot with what it really has.
pub(crate) struct Machine<'a> {
    robot: &'a Robot,
    parts: Parts,
}

impl<'a> Machine<'a> {
    /// `robot`, its drives' inertias, and `effects`; of effect `without` only what stays when it is taken away.
    pub(crate) fn new(robot: &'a Robot, effects: &[&Concealed], without: Option<usize>) -> Result<Self, ProofError> {
        let arm = robot.driven();
        let mut parts = Vec::new();
        for (i, effect) in effects.iter().enumerate() {
            parts.extend(crate::physics::parts(effect, &arm, Some(i) != without)?);
        }
        Ok(Self {
            robot,
            parts: Parts::new(parts, arm.dof()),
        })
    }

    /// Drives the machine along `reference`; the encoders count steps of `quantum` (rad or m; 0: none).
    ///
    /// # Errors
    /// [`ProofError::Lost`] if it cannot follow; [`ProofError::Plant`] if it cannot be simulated.
    pub(crate) fn run(&self, reference: &Reference, quantum: f64) -> Result<Run, ProofError> {
        let mut simulation = Simulation::new(self, reference, quantum)?;
        let ticks = reference.ticks();
        for tick in 0..ticks {
            simulation.tick(tick)?;
        }
        let run = simulation.run;
        let names = self.robot.arm().joints();
        for (k, (q, wanted)) in run.q.iter().zip(&reference.q).enumerate() {
            let by = (q - wanted).abs();
            if by.is_nan() || by > FURTHEST {
                let joint = names[k % names.len()].name.clone();
                let most = FURTHEST;
                return Err(ProofError::Lost { joint, by, most });
            }
        }
        Ok(run)
    }
}

/// A run under way.
struct Simulation<'a> {
    parts: &'a Parts,
    reference: &'a Reference,
    robot: &'a Robot,
    quantum: f64,
    /// The arm as it is now, without the rotors that move by themselves.
    arm: Arm,
    plant: Plant,
    workspace: Workspace,
    drives: Vec<Drive>,
    rotors: Vec<Option<Rotor>>,
    /// When the arm changes next (s, on the recordings' clock).
    next_change: f64,
    states: Vec<f64>,
    /// Accelerations and velocities of the last tick.
    qdd: Vec<f64>,
    qd_before: Vec<f64>,
    loads: Vec<[f64; 2]>,
    /// Torque on each link's side.
    net: Vec<f64>,
    levels: Vec<f64>,
    friction: Friction,
    rigid: Vec<f64>,
    contact: Matrix6xX<f64>,
    run: Run,
}

impl<'a> Simulation<'a> {
    fn new(machine: &'a Machine<'a>, reference: &'a Reference, quantum: f64) -> Result<Self, ProofError> {
        let n = machine.robot.arm().dof();
        let start = reference.time(0);
        let parts = &machine.parts;
        let arm = machine.robot.driven();
        let plant = Plant::new(&arm, &options())?;
        let size = reference.ticks() * n;
        let mut simulation = Self {
            parts,
            reference,
            robot: machine.robot,
            quantum,
            workspace: Workspace::new(&arm),
            drives: Vec::new(),
            rotors: (0..n).map(|_| None).collect(),
            next_change: start,
            states: vec![0.0; parts.links.len()],
            qdd: vec![0.0; n],
            qd_before: vec![0.0; n],
            loads: vec![[0.0; 2]; n],
            net: vec![0.0; n],
            levels: vec![0.0; n],
            friction: Friction::new(n),
            rigid: vec![0.0; n],
            contact: Matrix6xX::zeros(n),
            run: Run {
                q: Vec::with_capacity(size),
                qd: Vec::with_capacity(size),
                tau: Vec::with_capacity(size),
            },
            arm,
            plant,
        };
        let mut q: Vec<f64> = reference.q[..n].to_vec();
        for (j, q) in q.iter_mut().enumerate() {
            let bias = parts.encoder(j, start);
            *q -= bias;
            let gains = gains(machine.robot, j, parts.more_rotor(j));
            simulation.drives.push(Drive::new(*q + bias, reference.ff[j], gains));
            simulation.loads[j] = [reference.ff[j]; 2];
        }
        simulation.plant.set_state(&q, &vec![0.0; n])?;
        simulation.change(start, true)?;
        Ok(simulation)
    }

    /// The arm, its plant and its rotors as they are from `time` on.
    fn change(&mut self, time: f64, first: bool) -> Result<(), ProofError> {
        let n = self.drives.len();
        let mut arm = self.parts.arm_at(self.robot.driven(), time);
        let mut inertias: Vec<f64> = arm.joints().iter().map(|joint| joint.rotor_inertia).collect();
        let mut q = self.plant.q().to_vec();
        let qd = self.plant.qd().to_vec();
        for j in 0..n {
            let Some(connection) = self.parts.connection_at(j, time) else {
                continue;
            };
            let inertia = std::mem::take(&mut inertias[j]);
            if self.rotors[j].is_some() {
                continue;
            }
            if inertia <= 0.0 {
                return Err(ProofError::Effect {
                    effect: if connection.halfgap > 0.0 {
                        "backlash"
                    } else {
                        "joint_elasticity"
                    }
                    .into(),
                    reason: "its rotor has no inertia; add rotor = … (kg m²), or a rotor_inertia on the joint".into(),
                });
            }
            let rotor = Rotor::new(connection, inertia, self.robot.link_inertia(j), q[j], qd[j]);
            if first {
                // The encoder's side starts on its reference, the spring already under its load.
                q[j] -= rotor.deflection(self.reference.ff[j]);
            }
            self.rotors[j] = Some(rotor);
        }
        arm = arm.with_rotor_inertias(&inertias);
        self.plant = Plant::new(&arm, &options())?;
        self.plant.set_state(&q, &qd)?;
        self.arm = arm;
        self.friction.forget();
        self.next_change = self.parts.next_change(time);
        Ok(())
    }

    fn tick(&mut self, tick: usize) -> Result<(), ProofError> {
        let n = self.drives.len();
        let time = self.reference.time(tick);
        if time >= self.next_change {
            self.change(time, false)?;
        }
        let row = tick * n;
        for j in 0..n {
            let position = self.rotors[j]
                .as_ref()
                .map_or(self.plant.q()[j], |rotor| rotor.position);
            let drive = &mut self.drives[j];
            drive.sense(position + self.parts.encoder(j, time), self.quantum);
            let at = row + j;
            let wanted = (self.reference.q[at], self.reference.qd[at], self.reference.ff[at]);
            let command = drive.command(wanted);
            self.run.q.push(drive.position);
            self.run.qd.push(drive.velocity);
            self.run.tau.push(command);
        }
        self.feel_loads();
        for j in 0..n {
            self.net[j] = self.joint_torque(j, time);
        }
        self.add_link_side(time);
        self.add_contacts(time);
        self.couple(time)?;
        self.rub();
        self.plant.step(&self.net)?;
        for j in 0..n {
            self.qdd[j] = (self.plant.qd()[j] - self.qd_before[j]) / TICK;
        }
        self.qd_before.copy_from_slice(self.plant.qd());
        Ok(())
    }

    /// The rigid torques that load-dependent friction feels.
    fn feel_loads(&mut self) {
        if !self.parts.feels_rigid_load() {
            return;
        }
        self.arm.inverse_dynamics(
            &mut self.workspace,
            self.plant.q(),
            self.plant.qd(),
            &self.qdd,
            &mut self.rigid,
        );
        for (j, loads) in self.loads.iter_mut().enumerate() {
            loads[0] = self.rigid[j] - self.arm.joints()[j].rotor_inertia * self.qdd[j];
        }
    }

    /// What the drive of joint `j` puts on its link; its dry friction, where it is the plant's, goes to the levels.
    fn joint_torque(&mut self, j: usize, time: f64) -> f64 {
        let applied = self.drives[j].applied(&self.parts.drive_at(j, time));
        let (parts, loads) = (self.parts, self.loads[j]);
        let dry = |v: f64| resistance(parts.dry(j, time), v, time, loads);
        let smooth = |q: f64, v: f64| parts.smooth(j, time).map(|law| law.torque(q, v)).sum::<f64>();
        let (q, v) = (self.plant.q()[j], self.plant.qd()[j]);
        let inner = match &mut self.rotors[j] {
            Some(rotor) => {
                let friction = dry(rotor.velocity);
                self.levels[j] = 0.0;
                let net = applied - smooth(rotor.position, rotor.velocity) - friction.bias;
                rotor.advance(net, friction.level, q, v, TICK)
            }
            None => {
                let friction = dry(v);
                self.levels[j] = friction.level;
                applied - smooth(q, v) - friction.bias
            }
        };
        self.loads[j][1] += TICK / LOAD_FILTER * (applied - self.loads[j][1]);
        inner
    }

    fn add_link_side(&mut self, time: f64) {
        for ((link, onset), state) in self.parts.links.iter().zip(&mut self.states) {
            if time < *onset {
                continue;
            }
            let at = At {
                time,
                joint: link.0,
                q: self.plant.q(),
                qd: self.plant.qd(),
            };
            self.net[link.0] -= link.1.torque(at, state, TICK);
        }
    }

    fn add_contacts(&mut self, time: f64) {
        let parts = self.parts;
        for contact in &parts.contacts {
            let part = contact.at(time);
            if part == 0.0 {
                continue;
            }
            let tool = self.arm.tool_frame();
            self.arm
                .jacobian(&mut self.workspace, self.plant.q(), &tool, &mut self.contact);
            for (j, net) in self.net.iter_mut().enumerate() {
                *net += part * self.contact.fixed_view::<3, 1>(3, j).dot(&contact.force);
            }
        }
    }

    /// Drives that two joints turn: their inertia acts through accelerations, found by iteration from those of the last tick.
    fn couple(&mut self, time: f64) -> Result<(), ProofError> {
        let parts = self.parts;
        if !parts.couplings(time).any(|(_, _, inertia)| inertia != 0.0) {
            return Ok(());
        }
        let couple = |net: &[f64], qdd: &[f64]| {
            let mut coupled = net.to_vec();
            for (j, o, inertia) in parts.couplings(time) {
                coupled[j] -= inertia * qdd[o];
                coupled[o] -= inertia * qdd[j];
            }
            coupled
        };
        let first = couple(&self.net, &self.qdd);
        // With the dry friction of the last tick, that of this one is not known yet.
        let rubbed: Vec<f64> = first
            .iter()
            .zip(&self.friction.torques)
            .map(|(net, f)| net + f)
            .collect();
        let mut qdd = self.qdd.clone();
        self.plant.accelerations(&rubbed, &mut qdd)?;
        self.net = couple(&self.net, &qdd);
        Ok(())
    }
}

impl Simulation<'_> {
    /// Adds the dry friction of joints whose rotor turns with their link.
    fn rub(&mut self) {
        if self.levels.iter().all(|&level| level == 0.0) {
            return;
        }
        let state = [self.plant.q(), self.plant.qd()];
        self.friction
            .find(&self.arm, &mut self.workspace, state, &self.net, &self.levels);
        for (net, torque) in self.net.iter_mut().zip(&self.friction.torques) {
            *net += torque;
        }
    }
}

fn options() -> PlantOptions {
    PlantOptions {
        step: TICK,
        order: ORDER,
        ..PlantOptions::default()
    }
}

/// Proportional and derivative gain of the position loop of joint `j`, whose rotor has `more` inertia than is known of its drive.
fn gains(robot: &Robot, j: usize, more: f64) -> (f64, f64) {
    let inertia = robot.inertia(j) + more;
    // A light wrist without rotors needs a stiffer loop, or it would hang from it.
    let holds = (robot.holding(j) / SAG / inertia).sqrt();
    let frequency = holds.clamp(FREQUENCIES.0, FREQUENCIES.1);
    (inertia * frequency * frequency, 2.0 * DAMPING * frequency * inertia)
}
#[cfg(test)]
mod tests;
