//! The rigid model along the recorded motion: torques, and their derivatives with respect to possible errors.

use std::ops::Range;

use arm::{Arm, Inertia, PARAMETERS_PER_LINK, Workspace};
use effects::{Base, OnLinks, Scales, Signals};
use nalgebra::{Matrix6xX, Vector3};

use crate::data::motion::Chunk;
use crate::data::payload_frame::payload_to_link;
use crate::data::states::{Along, TOGETHER};
use crate::data::turning_base;

/// What is evaluated along a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needed {
    /// Everything.
    All,
    /// All but ∂τ/∂q and ∂τ/∂q̇, which stay zero.
    WithoutDerivatives,
    /// τ and the mass matrix; all other signals stay zero.
    Dynamics,
}

/// Signals on the ticks of one chunk. The first index is the joint, the last one the tick.
#[derive(Clone, Debug, Default)]
pub struct Rigid {
    /// τ (N m or N).
    pub tau: Vec<Vec<f64>>,
    /// The rotor inertias that τ and the mass matrix contain, which are known ones (kg m² or kg).
    pub rotors: Vec<f64>,
    /// The torque of each joint that τ does not contain, without gaps and springs, as an earlier fit found it (N m or N); empty
    /// without one.
    pub rest: Vec<Vec<f64>>,
    /// The torques on the links' side of the gears that τ does not contain, as an earlier fit found them.
    pub on_links: OnLinks,
    /// Each link's share of τ: `[joint][link]`.
    pub links: Vec<Vec<Vec<f64>>>,
    /// The last link's ten columns of the torque regressor, in the tool's frame: `[joint][parameter]`. Four more if the arm has a
    /// payload without moments.
    pub payload: Vec<Vec<Vec<f64>>>,
    /// The torque of each body that the URDF fixes to the last link: `[joint][body]`.
    pub fixed_bodies: Vec<Vec<Vec<f64>>>,
    /// ∂τ/∂q: `[joint of τ][joint of q]`.
    pub by_position: Vec<Vec<Vec<f64>>>,
    /// ∂τ/∂q̇: `[joint of τ][joint of q̇]`.
    pub by_velocity: Vec<Vec<Vec<f64>>>,
    /// The mass matrix: `[row][column]`.
    pub mass: Vec<Vec<Vec<f64>>>,
    /// The derivative of τ with respect to a turn of the base (rad) about its x and y axis: `[joint][axis]`.
    pub tilt: Vec<[Vec<f64>; 2]>,
    /// The torque of a gravity of 1 m/s² along x, y, z of the base: `[joint][axis]`.
    pub gravity: Vec<[Vec<f64>; 3]>,
    /// The generalised force Jᵀ F of a force of 1 N on the tool along x, y, z of the base: `[joint][axis]`.
    pub force: Vec<[Vec<f64>; 3]>,
    /// The tool's position in the base's frame (m): `[axis]`.
    pub tool: [Vec<f64>; 3],
    /// The arm on a base that could turn.
    pub base: Base,
    /// The part of τ that is due to inertial parameters other than the URDF's; empty if there are none.
    pub background: Vec<Vec<f64>>,
    /// The arms, each with the tick from which on it is evaluated and the true positions of the joints minus the encoders' (rad or m).
    arms: Vec<(usize, Arm, Vec<f64>)>,
}

impl Rigid {
    /// Evaluates `arm` along `chunk`, with joints that are `offset` (rad or m) beyond their encoders. The links' shares are
    /// those of links with the inertial parameters `nominal`.
    pub fn new(arm: &Arm, nominal: &[f64], offset: &[f64], chunk: &Chunk) -> Self {
        Self::with(arm, nominal, offset, chunk, Needed::All)
    }

    /// `chunk`, to which this belongs, as regressors see it.
    pub fn along<'a>(&'a self, chunk: &'a Chunk, scales: &'a Scales) -> Signals<'a> {
        Signals {
            recording: chunk.group,
            start: chunk.start,
            period: chunk.period,
            q: &chunk.q,
            qd: &chunk.qd,
            qdd: &chunk.qdd,
            tau: &chunk.tau,
            known: &chunk.known,
            rigid: effects::Rigid {
                tau: &self.tau,
                rotors: &self.rotors,
                rest: &self.rest,
                on_links: &self.on_links,
                links: &self.links,
                payload: &self.payload,
                fixed_bodies: &self.fixed_bodies,
                by_position: &self.by_position,
                by_velocity: &self.by_velocity,
                mass: &self.mass,
                tilt: &self.tilt,
                gravity: &self.gravity,
                force: &self.force,
                tool: &self.tool,
                base: &self.base,
            },
            scales,
        }
    }

    /// The torque that the gear of `joint` transmits to the links at a tick of `chunk` (N m or N): τ without that of the rotor.
    pub fn load(&self, joint: usize, chunk: &Chunk, tick: usize) -> f64 {
        self.tau[joint][tick] - self.rotors[joint] * chunk.qdd[joint][tick]
    }

    /// The inertia that `joint` alone moves behind its gear, at each tick (kg m² or kg).
    pub fn link_mass(&self, joint: usize) -> impl Iterator<Item = f64> {
        self.coupled_mass(joint, joint)
    }

    /// The torque behind the gear of `joint` for an acceleration of one of joint `by`, at each tick (kg m², kg m or kg).
    pub fn coupled_mass(&self, joint: usize, by: usize) -> impl Iterator<Item = f64> {
        let rotor = if joint == by { self.rotors[joint] } else { 0.0 };
        self.mass[joint][by].iter().map(move |mass| mass - rotor)
    }

    /// Sets `background` to the difference of the torque from that of `arm` at the same positions of the joints, of an arm that is the
    /// same at all ticks.
    pub fn set_background(&mut self, arm: &Arm, chunk: &Chunk) {
        let offset = self.arms.first().map_or(&[][..], |(_, _, offset)| offset);
        let along = Along::new(chunk, offset, 0..chunk.ticks());
        let mut tau = vec![0.0; along.q.len()];
        arm.inverse_dynamics_batch(&along.q, &along.qd, &along.qdd, &mut tau);
        self.background = self.tau.clone();
        for (background, tau) in self.background.iter_mut().zip(tau.chunks_exact(chunk.ticks())) {
            background.iter_mut().zip(tau).for_each(|(sum, tau)| *sum -= tau);
        }
    }

    /// Adds four columns to those of a payload: of its mass and first moments, if its moments of inertia are not fitted but follow from
    /// them by these `derivatives` of each moment.
    pub fn add_payload_without_moments(&mut self, derivatives: &[[f64; 6]; 4]) {
        for columns in &mut self.payload {
            for (first, by) in derivatives.iter().enumerate() {
                let mut sum = columns[first].clone();
                for (column, by) in columns[derivatives.len()..].iter().zip(by) {
                    sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += by * value);
                }
                columns.push(sum);
            }
        }
    }

    /// Replaces everything from `tick` on by `later`, which is of another arm along the same chunk.
    pub fn replace_from(&mut self, tick: usize, mut later: Self) {
        for (own, later) in self.signals().zip(later.signals()) {
            own[tick..].copy_from_slice(&later[tick..]);
        }
        let arms = later.arms.into_iter();
        self.arms.extend(arms.map(|(from, arm, offset)| (from.max(tick), arm, offset)));
    }

    /// All signals.
    fn signals(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let plain = [&mut self.tau, &mut self.rest, &mut self.background];
        let by_joint = [
            &mut self.links,
            &mut self.payload,
            &mut self.fixed_bodies,
            &mut self.by_position,
            &mut self.by_velocity,
            &mut self.mass,
        ];
        let by_axis = [&mut self.gravity, &mut self.force];
        plain
            .into_iter()
            .flatten()
            .chain(by_joint.into_iter().flatten().flatten())
            .chain(self.tilt.iter_mut().flatten())
            .chain(&mut self.tool)
            .chain(self.base.torque.iter_mut().chain(&mut self.base.inertia))
            .chain(self.base.coupling.iter_mut().flatten())
            .chain(by_axis.into_iter().flatten().flatten())
    }

    /// Evaluates what is `needed` as [`Self::new`] does.
    pub fn with(arm: &Arm, nominal: &[f64], offset: &[f64], chunk: &Chunk, needed: Needed) -> Self {
        let n = arm.dof();
        let ticks = chunk.ticks();
        let zeros = || vec![0.0; ticks];
        let square = || (0..n).map(|_| (0..n).map(|_| zeros()).collect()).collect();
        let bodies: Vec<[f64; 10]> = arm.fixed_bodies().iter().map(|body| body.inertia.parameters()).collect();
        let mut rigid = Self {
            tau: (0..n).map(|_| zeros()).collect(),
            rotors: arm.joints().iter().map(|joint| joint.rotor_inertia).collect(),
            rest: Vec::new(),
            on_links: OnLinks::default(),
            links: square(),
            payload: (0..n).map(|_| (0..10).map(|_| zeros()).collect()).collect(),
            fixed_bodies: (0..n).map(|_| bodies.iter().map(|_| zeros()).collect()).collect(),
            by_position: square(),
            by_velocity: square(),
            mass: square(),
            tilt: (0..n).map(|_| [zeros(), zeros()]).collect(),
            gravity: (0..n).map(|_| [zeros(), zeros(), zeros()]).collect(),
            force: (0..n).map(|_| [zeros(), zeros(), zeros()]).collect(),
            tool: [zeros(), zeros(), zeros()],
            base: match needed {
                Needed::Dynamics => turning_base::zeros(n, ticks),
                Needed::All | Needed::WithoutDerivatives => turning_base::along(arm, offset, chunk),
            },
            background: Vec::new(),
            arms: vec![(0, arm.clone(), offset.to_vec())],
        };
        let gravity = *arm.gravity();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let along = axes.map(|axis| arm.clone().with_gravity(axis));
        // Turning the base by a small angle about x turns gravity by the opposite angle in the base's frame.
        let turned = [Vector3::x(), Vector3::y()].map(|axis| -axis.cross(&gravity));
        let to_link = payload_to_link(arm);
        for from in (0..ticks).step_by(TOGETHER) {
            let span = from..ticks.min(from + TOGETHER);
            let states = Along::new(chunk, offset, span.clone());
            let (count, len) = (span.len(), states.q.len());
            let [q, qd, qdd] = [&states.q, &states.qd, &states.qdd];
            let mut tau = vec![0.0; len];
            arm.inverse_dynamics_batch(q, qd, qdd, &mut tau);
            for joint in 0..n {
                rigid.tau[joint][span.clone()].copy_from_slice(&tau[joint * count..(joint + 1) * count]);
            }
            if needed != Needed::Dynamics {
                rigid.set_shares(arm, &states, (&span, nominal), &bodies, &to_link);
            }
            let store = |to: &mut [Vec<Vec<f64>>], values: &[f64]| {
                for joint in 0..n {
                    for by in 0..n {
                        let from = (by * n + joint) * count;
                        to[joint][by][span.clone()].copy_from_slice(&values[from..from + count]);
                    }
                }
            };
            let (mut first, mut second) = (vec![0.0; len * n], vec![0.0; len * n]);
            if needed == Needed::All {
                arm.inverse_dynamics_derivatives_batch(q, qd, qdd, &mut first, &mut second);
                store(&mut rigid.by_position, &first);
                store(&mut rigid.by_velocity, &second);
            }
            arm.mass_matrix_batch(q, &mut first);
            store(&mut rigid.mass, &first);
            if needed == Needed::Dynamics {
                continue;
            }
            let still = vec![0.0; len];
            for (axis, along) in along.iter().enumerate() {
                along.inverse_dynamics_batch(q, &still, &still, &mut tau);
                for joint in 0..n {
                    let pull = &tau[joint * count..(joint + 1) * count];
                    rigid.gravity[joint][axis][span.clone()].copy_from_slice(pull);
                }
            }
        }
        if needed == Needed::Dynamics {
            return rigid;
        }
        let mut workspace = Workspace::new(arm);
        let tool = arm.tool_frame();
        let mut q = vec![0.0; n];
        let mut jacobian = Matrix6xX::zeros(n);
        for tick in 0..ticks {
            // The torque is linear in gravity.
            for joint in 0..n {
                q[joint] = chunk.q[joint][tick] + offset[joint];
                let [x, y, z] = [0, 1, 2].map(|axis: usize| rigid.gravity[joint][axis][tick]);
                for (axis, turned) in turned.iter().enumerate() {
                    rigid.tilt[joint][axis][tick] = turned.x * x + turned.y * y + turned.z * z;
                }
            }
            arm.forward_kinematics(&mut workspace, &q);
            let position = workspace.base_from_frame(&tool).translation;
            for (signal, value) in rigid.tool.iter_mut().zip(position.iter()) {
                signal[tick] = *value;
            }
            arm.jacobian(&mut workspace, &q, &tool, &mut jacobian);
            for joint in 0..n {
                for axis in 0..3 {
                    // The Jacobian's linear rows come after its angular ones.
                    rigid.force[joint][axis][tick] = jacobian[(3 + axis, joint)];
                }
            }
        }
        rigid
    }

    /// Sets, on a `span` of ticks with these `states`, the torques of links with the inertial parameters `nominal`, of fixed `bodies` and
    /// of a payload, whose parameters `to_link` brings to the last link.
    fn set_shares(
        &mut self,
        arm: &Arm,
        states: &Along,
        (span, nominal): (&Range<usize>, &[f64]),
        bodies: &[[f64; 10]],
        to_link: &[[f64; 10]; 10],
    ) {
        let (n, count) = (self.tau.len(), span.len());
        let mut regressor = vec![0.0; states.q.len() * PARAMETERS_PER_LINK * n];
        arm.torque_regressor_batch(&states.q, &states.qd, &states.qdd, &mut regressor);
        // Column by column, so that the loops run along the ticks.
        let add = |to: &mut [f64], joint: usize, link: usize, parameters: &[f64]| {
            for (k, parameter) in parameters.iter().enumerate() {
                let from = ((link * PARAMETERS_PER_LINK + k) * n + joint) * count;
                let column = &regressor[from..from + count];
                to.iter_mut().zip(column).for_each(|(sum, value)| *sum += value * parameter);
            }
        };
        for joint in 0..n {
            for (link, parameters) in nominal.chunks_exact(PARAMETERS_PER_LINK).enumerate().skip(joint) {
                add(&mut self.links[joint][link][span.clone()], joint, link, parameters);
            }
            for (body, parameters) in bodies.iter().enumerate() {
                add(&mut self.fixed_bodies[joint][body][span.clone()], joint, n - 1, parameters);
            }
            for parameter in 0..PARAMETERS_PER_LINK {
                let parameters = to_link.map(|of_link| of_link[parameter]);
                add(&mut self.payload[joint][parameter][span.clone()], joint, n - 1, &parameters);
            }
        }
    }

    /// Whether the torques per unit of the links' inertial parameters are those of `other` along the same chunk: their arms differ in
    /// nothing but their links' bodies.
    pub fn has_regressor_of(&self, other: &Self) -> bool {
        let apart = |(_, arm, offset): &(usize, Arm, Vec<f64>)| {
            (arm.clone().with_inertias(&vec![Inertia::zero(); arm.dof()]), offset.clone())
        };
        let mut arms = self.arms.iter().chain(&other.arms).map(apart);
        arms.next().is_some_and(|first| arms.all(|arm| arm == first))
    }

    /// The torque on each joint per unit of each inertial parameter of each link, on the rows of `chunk`:
    /// `[joint][10 link + parameter]`, empty for links before the joint.
    pub fn inertial_columns(&self, chunk: &Chunk) -> Vec<Vec<Vec<f64>>> {
        let (n, ticks) = (self.tau.len(), chunk.ticks());
        let mut signals: Vec<Vec<Vec<f64>>> = (0..n)
            .map(|joint| {
                let acts = |k: usize| k / PARAMETERS_PER_LINK >= joint;
                (0..n * PARAMETERS_PER_LINK).map(|k| if acts(k) { vec![0.0; ticks] } else { Vec::new() }).collect()
            })
            .collect();
        let ends = self.arms.iter().skip(1).map(|(from, ..)| *from).chain([ticks]);
        let spans = self.arms.iter().zip(ends).flat_map(|((from, arm, offset), end)| {
            let starts = (*from..end).step_by(TOGETHER);
            starts.map(move |from| (arm, offset, from..end.min(from + TOGETHER)))
        });
        for (arm, offset, span) in spans {
            let states = Along::new(chunk, offset, span.clone());
            let count = span.len();
            let mut regressor = vec![0.0; states.q.len() * PARAMETERS_PER_LINK * n];
            arm.torque_regressor_batch(&states.q, &states.qd, &states.qdd, &mut regressor);
            for (joint, columns) in signals.iter_mut().enumerate() {
                for (k, column) in columns.iter_mut().enumerate().skip(joint * PARAMETERS_PER_LINK) {
                    let from = (k * n + joint) * count;
                    column[span.clone()].copy_from_slice(&regressor[from..from + count]);
                }
            }
        }
        for column in signals.iter_mut().flatten().filter(|column| !column.is_empty()) {
            *column = if column.iter().all(|&v| v == 0.0) { vec![0.0; chunk.rows()] } else { chunk.filter(column) };
        }
        signals
    }
}
