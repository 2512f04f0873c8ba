//! A joint's drive: its encoder, its torque, and a rotor that is integrated separately.

use super::parts::DriveNow;
use crate::motion::TICK;
use crate::part::{Connection, STORED_COMMANDS};

/// The drives' velocity filter (Hz).
const VELOCITY_FILTER: f64 = 40.0;
/// The number of integration steps of a rotor per tick.
const ROTOR_STEPS: usize = 10;
/// The natural frequency of the lighter side against the ends of a gap (rad/s): high, but resolved by the plant's
/// step.
const GAP_FREQUENCY: f64 = 160.0;

/// The velocity that a drive computes from its encoder: differences over each tick, through a first-order low-pass
/// filter at 40 Hz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityFilter {
    /// The last position of the encoder (rad or m).
    pub position: f64,
    /// The velocity (rad/s or m/s), which is about 4 ms late.
    pub velocity: f64,
}

impl VelocityFilter {
    /// At rest at `position`.
    pub fn new(position: f64) -> Self {
        Self { position, velocity: 0.0 }
    }

    /// Updates the filter with the encoder's position one tick of 1 ms later.
    pub fn take(&mut self, read: f64) {
        let weight = 1.0 - (-std::f64::consts::TAU * VELOCITY_FILTER * TICK).exp();
        self.velocity += weight * ((read - self.position) / TICK - self.velocity);
        self.position = read;
    }
}

/// Encoder and command of a joint.
pub(super) struct Drive {
    /// The encoder's position and its filtered velocity.
    pub(super) sensed: VelocityFilter,
    commands: [f64; STORED_COMMANDS],
    /// The index of the next command.
    next: usize,
    lagging: f64,
}

impl Drive {
    /// At rest at `position` under the torque `holding`.
    pub(super) fn new(position: f64, holding: f64) -> Self {
        Self { sensed: VelocityFilter::new(position), commands: [holding; STORED_COMMANDS], next: 0, lagging: holding }
    }

    pub(super) fn read_encoder(&mut self, position: f64, quantum: f64) {
        let read = if quantum > 0.0 { (position / quantum).round() * quantum } else { position };
        self.sensed.take(read);
    }

    /// Stores the command of this tick (N m or N).
    pub(super) fn take(&mut self, command: f64) {
        self.commands[self.next] = command;
        self.next = (self.next + 1) % STORED_COMMANDS;
    }

    /// The true mean torque that the drive applies over the coming tick (N m or N), with its delay, limit and factor.
    pub(super) fn applied(&mut self, now: &DriveNow) -> f64 {
        let ago = |ticks: usize| {
            self.commands[(self.next + STORED_COMMANDS - 1 - ticks.min(STORED_COMMANDS - 1)) % STORED_COMMANDS]
        };
        let command = if now.delay == 0.0 {
            self.lagging = ago(0);
            self.lagging
        } else if now.lags {
            self.lagging += (1.0 - (-TICK / now.delay).exp()) * (ago(0) - self.lagging);
            self.lagging
        } else {
            // Commands are constant for a tick: with a delay between two ticks, each of two commands acts for a part
            // of the tick.
            let ticks = now.delay / TICK;
            let (whole, part) = (ticks.floor(), ticks.fract());
            (1.0 - part) * ago(whole as usize) + part * ago(whole as usize + 1)
        };
        let limit = now.limit;
        let limited = if now.soft && command.abs() > 0.9 * limit {
            command.signum() * limit * (0.9 + 0.1 * ((command.abs() / limit - 0.9) / 0.1).tanh())
        } else {
            command.clamp(-limit, limit)
        };
        limited / now.factor
    }
}

/// A rotor that is connected to its link by a spring, a gap or both; the encoder is on the rotor.
pub(super) struct Rotor {
    /// The position half a tick before the time of the link's position, which is the time of the link's velocity.
    position: f64,
    pub(super) velocity: f64,
    inertia: f64,
    stiffness: f64,
    damping: f64,
    connection: Connection,
}

impl Rotor {
    /// A rotor of `inertia` that moves with its link, whose inertia is `link` (kg m²), at `position` and `velocity`.
    pub(super) fn new(connection: Connection, inertia: f64, link: f64, position: f64, velocity: f64) -> Self {
        let stiffness = connection.stiffness.unwrap_or_else(|| inertia.min(link) * GAP_FREQUENCY * GAP_FREQUENCY);
        let damping = connection.damping.unwrap_or_else(|| 0.5 * (stiffness * inertia).sqrt());
        Self { position: position - 0.5 * TICK * velocity, velocity, inertia, stiffness, damping, connection }
    }

    /// The position of the encoder at the time of the link's position.
    pub(super) fn encoder_position(&self) -> f64 {
        self.position + 0.5 * TICK * self.velocity
    }

    /// The deflection of rotor against link under `torque`, with linear characteristics of spring and gap.
    pub(super) fn deflection(&self, torque: f64) -> f64 {
        let gap = if torque == 0.0 { 0.0 } else { self.connection.halfgap.copysign(torque) };
        gap + torque / self.stiffness
    }

    /// The torque on the link at a deflection and its rate of change.
    fn torque(&self, deflection: f64, rate: f64) -> f64 {
        let gap = self.connection.halfgap;
        let (stretched, touching) = if gap == 0.0 {
            (deflection, 1.0)
        } else if self.connection.round {
            // log(1 + e^x) without overflow.
            let soft = |x: f64| x.max(0.0) + (-x.abs()).exp().ln_1p();
            let width = 0.25 * gap;
            let stretched = width * (soft((deflection - gap) / width) - soft((-deflection - gap) / width));
            (stretched, 1.0 - (-stretched.abs() / (0.2 * gap)).exp())
        } else {
            let stretched = deflection - deflection.clamp(-gap, gap);
            (stretched, if stretched == 0.0 { 0.0 } else { 1.0 })
        };
        let straight = self.stiffness * stretched;
        straight * (1.0 + (straight / self.connection.hardening).powi(2)) + touching * self.damping * rate
    }

    /// Advances by one tick under the torque `net` and dry friction of `level` while the link is at `q` with velocity
    /// `v`; returns the mean torque on the link.
    ///
    /// In the plant's plain step, velocities are half a step behind positions (leapfrog), so that the force must be
    /// the mean over the tick that is centred on the time of `q`. The mean over the tick after `q` would add a damping
    /// of stiffness × tick / 2.
    pub(super) fn advance(&mut self, net: f64, level: f64, q: f64, v: f64) -> f64 {
        let step = TICK / ROTOR_STEPS as f64;
        let mut sum = 0.0;
        for k in 0..ROTOR_STEPS {
            let link = q + v * (step * k as f64 - 0.5 * TICK);
            let through = self.torque(self.position - link, self.velocity - v);
            let free = self.velocity + step / self.inertia * (net - through);
            // Friction takes the torque that stops the rotor, up to its level.
            let most = step / self.inertia * level;
            self.velocity = if free.abs() <= most { 0.0 } else { free - most.copysign(free) };
            self.position += step * self.velocity;
            sum += through;
        }
        sum / ROTOR_STEPS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rotor and a link on a spring are released: their oscillation decays according to the damping.
    #[test]
    fn a_spring_has_its_damping() {
        let (rotor, link, stiffness, damping): (f64, f64, f64, f64) = (0.8, 2.0, 900.0, 2.0);
        let connection = Connection {
            stiffness: Some(stiffness),
            damping: Some(damping),
            halfgap: 0.0,
            more_rotor: 0.0,
            hardening: f64::INFINITY,
            round: false,
        };
        let mut rotor_side = Rotor::new(connection, rotor, link, 0.01, 0.0);
        let (mut q, mut v) = (0.0, 0.0);
        let reduced = rotor * link / (rotor + link);
        let mut energies = Vec::new();
        for tick in 0..1500 {
            v += TICK / link * rotor_side.advance(0.0, 0.0, q, v);
            q += TICK * v;
            if tick % 500 == 0 {
                let (stretch, rate) = (rotor_side.position - q + 0.5 * TICK * v, rotor_side.velocity - v);
                energies.push(0.5 * stiffness * stretch * stretch + 0.5 * reduced * rate * rate);
            }
        }
        for pair in energies.windows(2) {
            let expected = (-damping / reduced * 500.0 * TICK).exp();
            assert!((pair[1] / pair[0] / expected - 1.0).abs() < 0.1, "{} {expected}", pair[1] / pair[0]);
        }
    }

    /// Without a connection, rotor and link move on together: the encoder reports the present position of the link,
    /// not an earlier one.
    #[test]
    fn an_encoder_without_connection_reports_the_present_position() {
        let connection = Connection {
            stiffness: Some(900.0),
            damping: Some(2.0),
            halfgap: 0.0,
            more_rotor: 0.0,
            hardening: f64::INFINITY,
            round: false,
        };
        let (speed, mut q) = (1.0, 0.3);
        let mut rotor = Rotor::new(connection, 0.8, 2.0, q, speed);
        for _ in 0..1000 {
            assert!((rotor.encoder_position() - q).abs() < 1e-9, "{} {q}", rotor.encoder_position());
            assert!(rotor.advance(0.0, 0.0, q, speed).abs() < 1e-6);
            q += TICK * speed;
        }
    }
}
