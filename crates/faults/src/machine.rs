//! The true machine: the plant and its drives under a control law, with all injected faults.

use arm::{Arm, Matrix6xX, Workspace};
use plant::{Plant, PlantOptions};

use crate::error::FaultError;
use crate::motion::{Reference, TICK};
use crate::part::{At, DryAt, resistance};
use crate::robot::Robot;
use crate::truth::Injected;

mod control_law;
mod drive;
mod friction;
mod inverse;
mod parts;

pub(crate) use control_law::Begin;
pub use control_law::Measured;
use control_law::{ControlLaw, PositionLoop};
pub use drive::VelocityFilter;
use drive::{Drive, Rotor};
use friction::Friction;
pub use inverse::{Inverse, LinkMotion};
use parts::Parts;

/// The plain step of rapier. The simulation in the diagnosis uses another order, so that the two are independent.
const ORDER: usize = 1;
/// The largest allowed distance of a joint from its reference (rad or m).
pub(crate) const LARGEST_ERROR: f64 = 0.35;
/// Time constant of the low-pass filter of the drive torque on which friction depends (s).
const LOAD_FILTER: f64 = 0.02;

/// Signals of the drives at every tick of a run; `[tick × dof + joint]`.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    /// Encoder positions (rad or m).
    pub q: Vec<f64>,
    /// Filtered velocities (rad/s or m/s).
    pub qd: Vec<f64>,
    /// Torques as the drives report them: commanded (N m or N).
    pub tau: Vec<f64>,
}

/// A robot with its faults.
pub(crate) struct Machine<'a> {
    robot: &'a Robot,
    parts: Parts,
    /// Whether one of its effects is left out.
    is_without_one: bool,
}

impl<'a> Machine<'a> {
    /// `robot` with its drives' inertias and `effects`; of effect `without`, only the part that remains without it.
    pub(crate) fn new(robot: &'a Robot, effects: &[&Injected], without: Option<usize>) -> Result<Self, FaultError> {
        let arm = robot.driven();
        let mut parts = Vec::new();
        for (i, effect) in effects.iter().enumerate() {
            parts.extend(crate::fault::parts(effect, &arm, Some(i) != without)?);
        }
        Ok(Self { robot, parts: Parts::new(parts, arm.dof()), is_without_one: without.is_some() })
    }

    /// Runs the machine along `reference`; the encoders count steps of `quantum` (rad or m; 0 for none).
    ///
    /// # Errors
    /// [`FaultError::Lost`] if it cannot follow; [`FaultError::Plant`] if it cannot be simulated.
    pub(crate) fn run(&self, reference: &Reference, quantum: f64) -> Result<Run, FaultError> {
        let n = self.robot.arm().dof();
        let begin = Begin { time: reference.time(0), q: &reference.q[..n], holding: &reference.ff[..n] };
        let mut law = PositionLoop::new(reference, self.robot, &self.parts);
        let mut simulation = Simulation::new(self, &begin, quantum, reference.ticks())?;
        for tick in 0..reference.ticks() {
            simulation.tick(tick, reference.time(tick), &mut law)?;
        }
        let run = simulation.run;
        let names = self.robot.arm().joints();
        for (k, (q, wanted)) in run.q.iter().zip(&reference.q).enumerate() {
            let by = (q - wanted).abs();
            if by.is_nan() || by > LARGEST_ERROR {
                let joint = names[k % names.len()].name.clone();
                let most = LARGEST_ERROR;
                return Err(FaultError::Lost { joint, by, most });
            }
        }
        Ok(run)
    }

    /// Runs the machine under `law` for `ticks` ticks; returns the drives' signals and the links' positions at each.
    ///
    /// # Errors
    /// [`FaultError::Plant`] if it cannot be simulated, or exceeds all bounds.
    pub(crate) fn drive(
        &self,
        begin: &Begin<'_>,
        quantum: f64,
        ticks: usize,
        law: &mut dyn ControlLaw,
    ) -> Result<(Run, Vec<f64>), FaultError> {
        let mut simulation = Simulation::new(self, begin, quantum, ticks)?;
        let mut links = Vec::with_capacity(ticks * begin.q.len());
        for tick in 0..ticks {
            links.extend_from_slice(simulation.plant.q());
            simulation.tick(tick, begin.time + tick as f64 * TICK, law)?;
        }
        Ok((simulation.run, links))
    }
}

/// A run in progress.
struct Simulation<'a> {
    parts: &'a Parts,
    /// See [`Machine::is_without_one`].
    is_without_one: bool,
    holding: Vec<f64>,
    robot: &'a Robot,
    quantum: f64,
    /// The present arm, without the rotors that are integrated separately.
    arm: Arm,
    plant: Plant,
    workspace: Workspace,
    drives: Vec<Drive>,
    rotors: Vec<Option<Rotor>>,
    /// The time of the arm's next change (s, on the recordings' clock).
    next_change: f64,
    states: Vec<f64>,
    /// Accelerations and velocities at the last tick.
    qdd: Vec<f64>,
    qd_before: Vec<f64>,
    loads: Vec<[f64; 2]>,
    /// The torque on the link's side of each joint.
    net: Vec<f64>,
    levels: Vec<f64>,
    friction: Friction,
    rigid: Vec<f64>,
    contact: Matrix6xX<f64>,
    /// Positions and velocities as the drives measure them.
    sensed: [Vec<f64>; 2],
    commands: Vec<f64>,
    run: Run,
}

impl<'a> Simulation<'a> {
    fn new(machine: &'a Machine<'a>, begin: &Begin<'_>, quantum: f64, ticks: usize) -> Result<Self, FaultError> {
        let n = machine.robot.arm().dof();
        let start = begin.time;
        let parts = &machine.parts;
        let arm = machine.robot.driven();
        let plant = Plant::new(&arm, &options())?;
        let size = ticks * n;
        let mut simulation = Self {
            parts,
            is_without_one: machine.is_without_one,
            holding: begin.holding.to_vec(),
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
            sensed: [vec![0.0; n], vec![0.0; n]],
            commands: vec![0.0; n],
            run: Run { q: Vec::with_capacity(size), qd: Vec::with_capacity(size), tau: Vec::with_capacity(size) },
            arm,
            plant,
        };
        let mut q: Vec<f64> = begin.q.to_vec();
        for (j, q) in q.iter_mut().enumerate() {
            let bias = parts.encoder(j, start);
            *q -= bias;
            simulation.drives.push(Drive::new(*q + bias, begin.holding[j]));
            simulation.loads[j] = [begin.holding[j]; 2];
        }
        simulation.plant.set_state(&q, &vec![0.0; n])?;
        simulation.change(start, true)?;
        Ok(simulation)
    }

    /// The arm, its plant and its rotors from `time` (s) on.
    fn change(&mut self, time: f64, first: bool) -> Result<(), FaultError> {
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
            // Without its rotor's inertia, which is the effect that is left out, a drive cannot move apart from its link.
            if inertia <= 0.0 && self.is_without_one {
                continue;
            }
            if inertia <= 0.0 {
                return Err(FaultError::Effect {
                    effect: if connection.halfgap > 0.0 { "backlash" } else { "joint_elasticity" }.into(),
                    reason: "its rotor has no inertia; add rotor = … (kg m²), or a rotor_inertia on the joint".into(),
                });
            }
            let rotor = Rotor::new(connection, inertia, self.robot.link_inertia(j), q[j], qd[j]);
            if first {
                // The encoder starts on its reference, with the spring already deflected by its load.
                q[j] -= rotor.deflection(self.holding[j]);
            }
            self.rotors[j] = Some(rotor);
        }
        arm = arm.with_rotor_inertias(&inertias);
        self.plant = Plant::new(&arm, &options())?;
        self.plant.set_state(&q, &qd)?;
        self.arm = arm;
        self.friction.reset();
        self.next_change = self.parts.next_change(time);
        Ok(())
    }

    fn tick(&mut self, tick: usize, time: f64, law: &mut dyn ControlLaw) -> Result<(), FaultError> {
        let n = self.drives.len();
        if time >= self.next_change {
            self.change(time, false)?;
        }
        for j in 0..n {
            let position = self.rotors[j].as_ref().map_or(self.plant.q()[j], Rotor::encoder_position);
            let drive = &mut self.drives[j];
            drive.read_encoder(position + self.parts.encoder(j, time), self.quantum);
            (self.sensed[0][j], self.sensed[1][j]) = (drive.sensed.position, drive.sensed.velocity);
        }
        let [q, qd] = &self.sensed;
        law.command(&Measured { tick, q, qd }, &mut self.commands);
        for (drive, command) in self.drives.iter_mut().zip(&self.commands) {
            drive.take(*command);
        }
        self.run.q.extend_from_slice(q);
        self.run.qd.extend_from_slice(qd);
        self.run.tau.extend_from_slice(&self.commands);
        self.update_rigid_loads();
        for j in 0..n {
            self.net[j] = self.joint_torque(j, time);
        }
        self.add_link_side(time);
        self.add_contacts(time);
        self.add_coupled_inertia(time)?;
        self.add_dry_friction();
        self.plant.step(&self.net)?;
        for j in 0..n {
            self.qdd[j] = (self.plant.qd()[j] - self.qd_before[j]) / TICK;
        }
        self.qd_before.copy_from_slice(self.plant.qd());
        Ok(())
    }

    /// The rigid torques on which load-dependent friction depends.
    fn update_rigid_loads(&mut self) {
        if !self.parts.depends_on_rigid_load() {
            return;
        }
        self.arm.inverse_dynamics(&mut self.workspace, self.plant.q(), self.plant.qd(), &self.qdd, &mut self.rigid);
        for (j, loads) in self.loads.iter_mut().enumerate() {
            loads[0] = self.rigid[j] - self.arm.joints()[j].rotor_inertia * self.qdd[j];
        }
    }

    /// The torque of the drive of joint `j` on its link; dry friction that the plant handles is added to the levels.
    fn joint_torque(&mut self, j: usize, time: f64) -> f64 {
        let applied = self.drives[j].applied(&self.parts.drive_at(j, time));
        let (parts, loads) = (self.parts, self.loads[j]);
        let dry = |v: f64| resistance(parts.dry(j, time), &DryAt::new(v, time, loads)).times(parts.friction[j]);
        let smooth = |q: f64, v: f64| parts.smooth(j, time).map(|law| law.torque(q, v)).sum::<f64>();
        let (q, v) = (self.plant.q()[j], self.plant.qd()[j]);
        let inner = match &mut self.rotors[j] {
            Some(rotor) => {
                let friction = dry(rotor.velocity);
                self.levels[j] = 0.0;
                let net = applied - smooth(rotor.encoder_position(), rotor.velocity) - friction.bias;
                rotor.advance(net, friction.level, q, v)
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
        for (link, state) in self.parts.links.iter().zip(&mut self.states) {
            if time < link.onset {
                continue;
            }
            let at = At { time, joint: link.joint, q: self.plant.q(), qd: self.plant.qd() };
            self.net[link.joint] -= link.law.torque(at, state, TICK);
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
            self.arm.jacobian(&mut self.workspace, self.plant.q(), &tool, &mut self.contact);
            for (j, net) in self.net.iter_mut().enumerate() {
                *net += part * self.contact.fixed_view::<3, 1>(3, j).dot(&contact.force);
            }
        }
    }

    /// Drives that are moved by two joints: their inertia, with accelerations by iteration from those of the last tick.
    fn add_coupled_inertia(&mut self, time: f64) -> Result<(), FaultError> {
        let parts = self.parts;
        if !parts.couplings(time).any(|(_, _, inertia)| inertia != 0.0) {
            return Ok(());
        }
        let add_coupled_inertia = |net: &[f64], qdd: &[f64]| {
            let mut coupled = net.to_vec();
            for (j, o, inertia) in parts.couplings(time) {
                coupled[j] -= inertia * qdd[o];
                coupled[o] -= inertia * qdd[j];
            }
            coupled
        };
        let first = add_coupled_inertia(&self.net, &self.qdd);
        // With the dry friction of the last tick, because that of this tick is not known yet.
        let rubbed: Vec<f64> = first.iter().zip(&self.friction.torques).map(|(net, f)| net + f).collect();
        let mut qdd = self.qdd.clone();
        self.plant.accelerations(&rubbed, &mut qdd)?;
        self.net = add_coupled_inertia(&self.net, &qdd);
        Ok(())
    }
}

impl Simulation<'_> {
    /// Adds the dry friction of joints whose rotor is rigidly connected to the link.
    fn add_dry_friction(&mut self) {
        if self.levels.iter().all(|&level| level == 0.0) {
            return;
        }
        let state = [self.plant.q(), self.plant.qd()];
        self.friction.solve(&self.arm, &mut self.workspace, state, &self.net, &self.levels);
        for (net, torque) in self.net.iter_mut().zip(&self.friction.torques) {
            *net += torque;
        }
    }
}

fn options() -> PlantOptions {
    PlantOptions { step: TICK, order: ORDER, ..PlantOptions::default() }
}

#[cfg(test)]
mod tests;
