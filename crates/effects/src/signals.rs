//! A section of motion, as regressors see it.

/// Typical and largest values of each joint.
#[derive(Clone, Debug)]
pub struct Scales {
    /// The largest speed without the fastest 1 % (rad/s or m/s).
    pub speed: Vec<f64>,
    /// The velocity deadband: below it a joint rests, and the sign of its velocity is undetermined (rad/s or m/s).
    pub rest: Vec<f64>,
    /// The speed within which the smooth sign changes (rad/s or m/s).
    pub turning: Vec<f64>,
    /// The middle of the positions (rad or m).
    pub middle: Vec<f64>,
    /// The difference of the highest and the lowest position (rad or m).
    pub range: Vec<f64>,
    /// The same of the training recordings alone, while the joint moves (rad or m).
    pub swept: Vec<f64>,
    /// The standard deviation of the measured torque (N m or N).
    pub torque: Vec<f64>,
}

impl Scales {
    /// A smooth sign, which does not change with the noise of the velocity.
    pub fn sign(&self, joint: usize, qd: f64) -> f64 {
        let x = qd / self.turning[joint];
        x / (1.0 + x * x).sqrt()
    }

    /// Whether a joint moves.
    pub fn moves(&self, joint: usize) -> bool {
        self.speed[joint] > self.rest[joint]
    }
}

/// The rigid model of the arm on a base that could turn about its x and y axes ([`arm::Arm::on_turning_base`]), along the motion of the arm.
#[derive(Clone, Debug, Default)]
pub struct Base {
    /// The torque that holds the base (N m): `[axis]`.
    pub torque: [Vec<f64>; 2],
    /// The moment of inertia of the arm about the axis (kg m²): `[axis]`.
    pub inertia: [Vec<f64>; 2],
    /// The torque on each joint for an acceleration of the base (kg m² or kg m): `[joint][axis]`.
    pub coupling: Vec<[Vec<f64>; 2]>,
}

/// The torques on the links' side of the gears along a motion, and how they change with it.
#[derive(Clone, Debug, Default)]
pub struct OnLinks {
    /// The torque that each joint's gear must hold (N m or N): `[joint][tick]`; none where empty.
    pub torque: Vec<Vec<f64>>,
    pub(crate) slopes: Vec<Slope>,
}

/// The derivatives of the torque on one joint with respect to the position, velocity and acceleration of another one, or of itself.
#[derive(Clone, Debug)]
pub(crate) struct Slope {
    pub on: usize,
    pub of: usize,
    pub by: [Vec<f64>; 3],
}

impl OnLinks {
    /// The derivatives of the torque on joint `on` with respect to the position, velocity and acceleration of joint `of` at `tick`.
    pub(crate) fn slopes(&self, on: usize, of: usize, tick: usize) -> [f64; 3] {
        let found = self.slopes.iter().find(|slope| (slope.on, slope.of) == (on, of));
        found.map_or([0.0; 3], |slope| [0, 1, 2].map(|order| slope.by[order][tick]))
    }

    /// Adds to the torque on joint `on` what a motion δ, δ̇, δ̈ of the links of joint `of` relative to its drive changes.
    pub(crate) fn add_change(&self, (on, of): (usize, usize), ticks: &[[f64; 3]], torque: &mut [f64]) {
        let Some(Slope { by: [q, qd, qdd], .. }) = self.slopes.iter().find(|slope| (slope.on, slope.of) == (on, of))
        else {
            return;
        };
        for (tick, ([delta, speed, acceleration], torque)) in ticks.iter().zip(torque).enumerate() {
            *torque += q[tick] * delta + qd[tick] * speed + qdd[tick] * acceleration;
        }
    }
}

/// The rigid model along the motion. The first index is the joint, the last one the tick. A list that is not needed may be
/// empty.
#[derive(Clone, Copy, Debug)]
pub struct Rigid<'a> {
    /// τ (N m or N).
    pub tau: &'a [Vec<f64>],
    /// The rotor inertias that τ and the mass matrix contain (kg m² or kg); none where empty.
    pub rotors: &'a [f64],
    /// The torque of the joint that τ does not contain, such as friction and the rotor's, without that of gaps and springs, as an
    /// earlier fit found it; none where empty (N m or N).
    pub rest: &'a [Vec<f64>],
    /// The torques on the links' side of the gears that τ does not contain, as an earlier fit found them.
    pub on_links: &'a OnLinks,
    /// Each link's share of τ: `[joint][link]`.
    pub links: &'a [Vec<Vec<f64>>],
    /// The ten columns of the torque regressor of a body on the tool, in the tool's frame: `[joint][parameter]`. If the model has a body
    /// whose tensor about its centre of mass is fixed, four more follow: its mass and first moments, with which its moments change.
    pub payload: &'a [Vec<Vec<f64>>],
    /// The torque of each body that the URDF fixes to the last link ([`::arm::Arm::fixed_bodies`]): `[joint][body]`.
    pub fixed_bodies: &'a [Vec<Vec<f64>>],
    /// ∂τ/∂q: `[joint of τ][joint of q]`.
    pub by_position: &'a [Vec<Vec<f64>>],
    /// ∂τ/∂q̇: `[joint of τ][joint of q̇]`.
    pub by_velocity: &'a [Vec<Vec<f64>>],
    /// The mass matrix: `[row][column]`.
    pub mass: &'a [Vec<Vec<f64>>],
    /// The derivative of τ with respect to a turn of the base (rad) about its x and y axis: `[joint][axis]`.
    pub tilt: &'a [[Vec<f64>; 2]],
    /// The torque of a gravity of 1 m/s² along x, y, z of the base: `[joint][axis]`.
    pub gravity: &'a [[Vec<f64>; 3]],
    /// The generalised force Jᵀ F of a force of 1 N on the tool along x, y, z of the base: `[joint][axis]`.
    pub force: &'a [[Vec<f64>; 3]],
    /// The tool's position in the base's frame (m): `[axis]`.
    pub tool: &'a [Vec<f64>; 3],
    /// The arm on a base that could turn.
    pub base: &'a Base,
}

/// A section of motion on equidistant ticks, joint by joint, with the rigid model along it.
#[derive(Clone, Copy, Debug)]
pub struct Signals<'a> {
    /// The index of its recording.
    pub recording: usize,
    /// The time of the first tick (s).
    pub start: f64,
    /// The time between ticks (s).
    pub period: f64,
    /// Positions (rad or m).
    pub q: &'a [Vec<f64>],
    /// Velocities (rad/s or m/s).
    pub qd: &'a [Vec<f64>],
    /// Accelerations (rad/s² or m/s²).
    pub qdd: &'a [Vec<f64>],
    /// Measured torques without those of known effects (N m or N).
    pub tau: &'a [Vec<f64>],
    /// The torques of known effects, which a torque constant multiplies, too; none where empty (N m or N).
    pub known: &'a [Vec<f64>],
    /// The rigid model.
    pub rigid: Rigid<'a>,
    /// Typical and largest values of each joint.
    pub scales: &'a Scales,
}

impl Rigid<'_> {
    /// The inertia of the rotor of `joint` that τ and the mass matrix contain (kg m² or kg).
    pub fn rotor(&self, joint: usize) -> f64 {
        self.rotors.get(joint).copied().unwrap_or(0.0)
    }
}

impl Signals<'_> {
    /// The number of ticks.
    pub fn ticks(&self) -> usize {
        self.q[0].len()
    }

    /// The time of a tick (s).
    pub fn time(&self, tick: usize) -> f64 {
        self.start + tick as f64 * self.period
    }

    /// The torque of the model on a joint: τ and that of the known effects (N m or N).
    pub fn of_model(&self, joint: usize) -> Vec<f64> {
        let mut torque = self.rigid.tau[joint].clone();
        if let Some(known) = self.known.get(joint) {
            torque.iter_mut().zip(known).for_each(|(sum, known)| *sum += known);
        }
        torque
    }

    /// A signal on the ticks.
    pub fn map(&self, f: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        Some((0..self.ticks()).map(f).collect())
    }

    /// The torque that the gear of a joint transmits to the links of the arm (N m or N): τ without that of the rotor.
    pub fn load(&self, joint: usize, tick: usize) -> f64 {
        self.rigid.tau[joint][tick] - self.rigid.rotor(joint) * self.qdd[joint][tick]
    }

    /// The torque that the gear of a joint transmits (N m or N): that to the links of the arm, and that of springs and couplings on them.
    pub fn through_gear(&self, joint: usize, tick: usize) -> f64 {
        let more = self.rigid.on_links.torque.get(joint).map_or(0.0, |torque| torque[tick]);
        self.load(joint, tick) + more
    }

    /// The smooth sign of a joint's velocity.
    pub fn sign(&self, joint: usize, tick: usize) -> f64 {
        self.scales.sign(joint, self.qd[joint][tick])
    }
}
