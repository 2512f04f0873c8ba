//! The inverse of the true machine: the torques that a motion of its links requires, as its drives report them, and
//! the readings of its encoders.

use arm::{Arm, Workspace};

use super::{LOAD_FILTER, Machine};
use crate::motion::TICK;
use crate::part::{At, Connection, DryAt, resistance};

/// A motion of the links at ticks of 1 ms; `[tick × dof + joint]`.
#[derive(Clone, Copy, Debug)]
pub struct LinkMotion<'a> {
    /// The time of the first tick (s, on the recordings' clock).
    pub start: f64,
    /// rad or m.
    pub q: &'a [f64],
    /// rad/s or m/s.
    pub qd: &'a [f64],
    /// rad/s² or m/s².
    pub qdd: &'a [f64],
}

/// The torques and encoder offsets that a motion of the links requires; `[tick × dof + joint]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Inverse {
    /// The required torques at each tick, as the drives report them (N m or N).
    pub tau: Vec<f64>,
    /// The difference between encoder readings and link positions: an offset, a spring's deflection (rad or m).
    pub beyond: Vec<f64>,
    /// The delay of each drive (s).
    pub delays: Vec<f64>,
}

/// The parts of the torque, for each tick and joint.
struct Links {
    /// The rigid torque, without the drives' inertias.
    rigid: Vec<f64>,
    /// The rigid torque and all torques on the link's side, without the drives' inertias.
    through: Vec<f64>,
    /// The drives' inertias (kg m² or kg).
    rotor: Vec<f64>,
    /// The deflections of the rotors against their links (rad or m).
    ahead: Vec<f64>,
}

impl Machine<'_> {
    /// The torques that `motion` requires. Dry friction has the sign of the velocity and is zero at rest. Omitted are
    /// contacts, which are events, gaps and limits, which no torque can compensate, and the damping of springs. States
    /// with memory start as in a run.
    pub(crate) fn inverse(&self, motion: &LinkMotion<'_>) -> Inverse {
        let n = self.robot.arm().dof();
        let ticks = motion.q.len() / n;
        let links = self.links(motion);
        let parts = &self.parts;
        let mut inverse = Inverse {
            tau: Vec::with_capacity(ticks * n),
            beyond: Vec::with_capacity(ticks * n),
            delays: (0..n).map(|j| parts.drive_at(j, motion.start).delay).collect(),
        };
        let mut drive_loads: Vec<f64> = links.through.iter().take(n).copied().collect();
        for tick in 0..ticks {
            let time = motion.start + tick as f64 * TICK;
            let (before, after) = (tick.saturating_sub(1), (tick + 1).min(ticks - 1));
            for (j, load) in drive_loads.iter_mut().enumerate() {
                let at = tick * n + j;
                let [a, b, c] = [before, tick, after].map(|tick| links.ahead[tick * n + j]);
                let apart = (after - before).max(1) as f64 * TICK;
                let (q, qd) = (motion.q[at] + b, motion.qd[at] + (c - a) / apart);
                let qdd = motion.qdd[at] + (c - 2.0 * b + a) / (TICK * TICK);
                let dry_at = DryAt::new(qd, time, [links.rigid[at], *load]);
                let friction = resistance(parts.dry(j, time), &dry_at);
                let direction = if qd == 0.0 { 0.0 } else { qd.signum() };
                let applied = links.through[at]
                    + links.rotor[at] * qdd
                    + parts.smooth(j, time).map(|law| law.torque(q, qd)).sum::<f64>()
                    + friction.bias
                    + direction * friction.level;
                *load += TICK / LOAD_FILTER * (applied - *load);
                inverse.tau.push(applied * parts.drive_at(j, time).factor);
                inverse.beyond.push(parts.encoder(j, time) + b);
            }
        }
        inverse
    }

    fn links(&self, motion: &LinkMotion<'_>) -> Links {
        let n = self.robot.arm().dof();
        let parts = &self.parts;
        let zeros = || vec![0.0; motion.q.len()];
        let mut links = Links { rigid: zeros(), through: zeros(), rotor: zeros(), ahead: zeros() };
        let mut states = vec![0.0; parts.links.len()];
        let mut next_change = f64::NEG_INFINITY;
        let mut arm: Arm = self.robot.driven();
        let mut workspace = Workspace::new(&arm);
        let mut connections: Vec<Option<Connection>> = vec![None; n];
        for (tick, row) in (0..motion.q.len()).step_by(n).enumerate() {
            let time = motion.start + tick as f64 * TICK;
            if time >= next_change {
                arm = parts.arm_at(self.robot.driven(), time);
                workspace = Workspace::new(&arm);
                connections = (0..n).map(|j| parts.connection_at(j, time)).collect();
                next_change = parts.next_change(time);
            }
            let all = row..row + n;
            let [q, qd, qdd] = [motion.q, motion.qd, motion.qdd].map(|values| &values[all.clone()]);
            arm.inverse_dynamics(&mut workspace, q, qd, qdd, &mut links.rigid[all]);
            for j in 0..n {
                let rotor = arm.joints()[j].rotor_inertia;
                links.rigid[row + j] -= rotor * qdd[j];
                links.rotor[row + j] = rotor;
                links.through[row + j] = links.rigid[row + j];
            }
            for (link, state) in parts.links.iter().zip(&mut states) {
                if time >= link.onset {
                    let at = At { time, joint: link.joint, q, qd };
                    links.through[row + link.joint] += link.law.torque(at, state, TICK);
                }
            }
            for (j, o, inertia) in parts.couplings(time) {
                links.through[row + j] += inertia * qdd[o];
                links.through[row + o] += inertia * qdd[j];
            }
            for (j, connection) in connections.iter().enumerate() {
                links.ahead[row + j] = connection.map_or(0.0, |spring| stretch(&spring, links.through[row + j]));
            }
        }
        links
    }
}

/// The deflection of a spring under `torque`: the root x of k x (1 + (k x / h)²) = torque, by Newton's method from the
/// deflection of a linear spring. The stiff ends of a gap do not deflect.
fn stretch(spring: &Connection, torque: f64) -> f64 {
    let Some(stiffness) = spring.stiffness.filter(|_| spring.halfgap == 0.0) else {
        return 0.0;
    };
    let mut straight = torque;
    if spring.hardening.is_finite() {
        for _ in 0..50 {
            let bent = (straight / spring.hardening).powi(2);
            straight -= (straight * (1.0 + bent) - torque) / (1.0 + 3.0 * bent);
        }
    }
    straight / stiffness
}
