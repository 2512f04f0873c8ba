//! The links behind a compliant joint or on a compliant base: the torques that their motion relative to the drive or the ground adds.

use crate::signals::{Rigid, Signals};

/// The place of a compliance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compliant {
    /// Between a joint's drive and its link.
    Joint(usize),
    /// Between the ground and the base, about the base's x axis (0) or y axis (1).
    Base(usize),
}

/// The motion δ (link minus drive, or base minus ground) of the links behind a compliance, tick by tick.
#[derive(Clone, Debug)]
pub struct LinkSide {
    at: Compliant,
    /// δ, δ̇, δ̈ (rad or m, and so on).
    ticks: Vec<[f64; 3]>,
}

impl LinkSide {
    /// The links behind the compliance `at` with a motion δ from `sprung`, `gap` or `swaying`.
    pub fn new(at: Compliant, ticks: Vec<[f64; 3]>) -> Self {
        Self { at, ticks }
    }

    /// The torque that it adds on `joint`: M δ̈ + ∂τ/∂q̇ δ̇ + ∂τ/∂q δ. The rotor is before the compliance and does not move
    /// with δ. The small torque of a base's velocity is left out.
    pub fn torque(&self, joint: usize, rigid: Rigid<'_>) -> Vec<f64> {
        let at = match self.at {
            Compliant::Joint(at) => at,
            Compliant::Base(axis) => {
                let (mass, slope) = (&rigid.base.coupling[joint][axis], &rigid.tilt[joint][axis]);
                let ticks = self.ticks.iter().enumerate();
                return ticks.map(|(k, [delta, _, acceleration])| mass[k] * acceleration + slope[k] * delta).collect();
            }
        };
        let (mass, drag, slope) =
            (&rigid.mass[joint][at], &rigid.by_velocity[joint][at], &rigid.by_position[joint][at]);
        let rotor = if joint == at { rigid.rotor(joint) } else { 0.0 };
        // Without indices, nothing has to be checked, and the loop runs in vectors.
        let torque = |(((mass, drag), slope), [delta, speed, acceleration]): (((&f64, &f64), &f64), &[f64; 3])| {
            (mass - rotor) * acceleration + drag * speed + slope * delta
        };
        let mut torque: Vec<f64> = mass.iter().zip(drag).zip(slope).zip(&self.ticks).map(torque).collect();
        rigid.on_links.add_change((joint, at), &self.ticks, &mut torque);
        torque
    }
}

/// What moves the links behind a compliance, at each tick.
struct Driven<M, T, D, S> {
    /// The time between ticks (s).
    period: f64,
    ticks: usize,
    /// M, without the rotor (kg m² or kg).
    mass: M,
    /// τ, without the torque of the rotor (N m or N).
    tau: T,
    /// ∂τ/∂q̇.
    drag: D,
    /// ∂τ/∂q.
    slope: S,
}

/// δ behind a spring at joint `at`, in a gap of ± `halfgap` (none: zero) in which the link moves freely:
/// M δ̈ + (D + ∂τ/∂q̇) δ̇ + ∂τ/∂q δ + K (δ ∓ halfgap) = −τ, driven by the drive's measured motion, with M and τ of the links
/// alone, without the rotor. `damping` gives D for M.
pub fn sprung(
    at: usize,
    halfgap: f64,
    stiffness: f64,
    damping: impl Fn(f64) -> f64,
    motion: &Signals<'_>,
) -> Vec<[f64; 3]> {
    let rigid = motion.rigid;
    let (drag, slope) = (&rigid.by_velocity[at][at], &rigid.by_position[at][at]);
    let on_links = |k: usize, order: usize| rigid.on_links.slopes(at, at, k)[order];
    let driven = Driven {
        period: motion.period,
        ticks: motion.ticks(),
        mass: |k: usize| rigid.mass[at][at][k] - rigid.rotor(at),
        tau: |k: usize| motion.through_gear(at, k),
        drag: |k: usize| drag[k] + on_links(k, 1),
        slope: |k: usize| slope[k] + on_links(k, 0),
    };
    driven.sprung(halfgap, stiffness, damping)
}

/// δ of a base on a spring and a damper about its x axis (0) or y axis (1): I δ̈ + D δ̇ + K δ = −τ, with the torque τ that holds the base.
pub fn swaying(axis: usize, stiffness: f64, damping: f64, motion: &Signals<'_>) -> Vec<[f64; 3]> {
    let base = motion.rigid.base;
    let driven = Driven {
        period: motion.period,
        ticks: motion.ticks(),
        mass: |k: usize| base.inertia[axis][k],
        tau: |k: usize| base.torque[axis][k],
        drag: |_| 0.0,
        slope: |_| 0.0,
    };
    driven.sprung(0.0, stiffness, |_| damping)
}

impl<M, T, D, S> Driven<M, T, D, S>
where
    M: Fn(usize) -> f64,
    T: Fn(usize) -> f64,
    D: Fn(usize) -> f64,
    S: Fn(usize) -> f64,
{
    /// See [`sprung`]. Integrated by the trapezoidal rule (Newmark, β = 1/4), from the quasi-static deflection.
    fn sprung(&self, halfgap: f64, stiffness: f64, damping: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
        let Self { period: h, ticks, mass, tau, drag, slope } = self;
        let mut out = Vec::with_capacity(*ticks);
        // Positive torque: the drive pushes the link in the positive direction, so the link lags behind.
        let mut delta = -halfgap.copysign(tau(0)) - tau(0) / (stiffness + slope(0));
        let (mut speed, mut acceleration) = (0.0, 0.0);
        for k in 0..*ticks {
            if k > 0 {
                let place: f64 = delta + h * speed + 0.25 * h * h * acceleration;
                let pace = speed + 0.5 * h * acceleration;
                let solve = |damping: f64, spring: f64, rest: f64| {
                    let (d, s) = (drag(k) + damping, slope(k) + spring);
                    -(tau(k) + d * pace + s * place - spring * rest)
                        / (mass(k) + 0.5 * h * d + 0.25 * h * h * s).max(1e-9)
                };
                let against = |end: f64| solve(damping(mass(k)), stiffness, end);
                // The contact force acts on the side of the gap where the link is.
                acceleration = if halfgap == 0.0 {
                    against(0.0)
                } else {
                    let free = solve(0.0, 0.0, 0.0);
                    let end = (place + 0.25 * h * h * free).clamp(-halfgap, halfgap);
                    if end.abs() < halfgap { free } else { against(end) }
                };
                delta = place + 0.25 * h * h * acceleration;
                speed = pace + 0.5 * h * acceleration;
            }
            out.push([delta, speed, acceleration]);
        }
        out
    }
}

/// δ behind a gap of ± `halfgap` with rigid ends. The link lies against one side while its torque presses it there, and moves
/// freely to the other side when the torque changes its sign; impacts are inelastic.
pub fn gap(at: usize, halfgap: f64, motion: &Signals<'_>) -> Vec<[f64; 3]> {
    let (h, rigid) = (motion.period, motion.rigid);
    let tau = |k: usize| motion.through_gear(at, k);
    let ticks = motion.ticks();
    let mut out = Vec::with_capacity(ticks);
    // Positive torque: the drive pushes the link in the positive direction, so the link lags behind, δ = −halfgap.
    let mut delta = if tau(0) >= 0.0 { -halfgap } else { halfgap };
    let mut speed = 0.0;
    let mut free = false;
    for k in 0..ticks {
        let [by_position, by_velocity, _] = rigid.on_links.slopes(at, at, k);
        let needed = tau(k) + (rigid.by_position[at][at][k] + by_position) * delta;
        let mut acceleration = 0.0;
        if !free && needed * delta > 0.0 {
            free = true;
        }
        if free {
            acceleration = -(needed + (rigid.by_velocity[at][at][k] + by_velocity) * speed)
                / (rigid.mass[at][at][k] - rigid.rotor(at)).max(1e-9);
            let before = speed;
            speed += h * acceleration;
            delta += h * speed;
            if delta.abs() >= halfgap {
                delta = delta.clamp(-halfgap, halfgap);
                free = false;
                speed = 0.0;
                // The impact stops the link within this tick.
                acceleration = -before / h;
            }
        }
        out.push([delta, speed, acceleration]);
    }
    out
}

/// The highest frequency at which noise is summed, in cut-offs. Source: the filter leaves 0.2 % of the power there.
const NOISE_CUTOFFS: f64 = 3.0;
/// The number of frequencies at which noise is summed. Source: the steps are narrow beside a resonance of a damping ratio of 0.01.
const NOISE_STEPS: usize = 2000;

/// The power of white noise of the positions in the torque of a link of inertia `mass` (kg m² or kg) behind a spring, relative to that of the
/// link without it, after a filter of half power at `cutoff` (Hz).
///
/// The link is driven by the recorded motion. Its torque is M ω² / (K − M ω² + i D ω) times that of the rigid link, so that a lightly
/// damped spring amplifies the noise at its resonance.
pub fn noise_behind(stiffness: f64, damping: f64, mass: f64, cutoff: f64) -> f64 {
    let (mut rigid, mut elastic) = (0.0, 0.0);
    for step in 1..=NOISE_STEPS {
        let hertz = step as f64 / NOISE_STEPS as f64 * NOISE_CUTOFFS * cutoff;
        let omega = std::f64::consts::TAU * hertz;
        // White positions have accelerations that grow with the square of the frequency; the filter is Gaussian.
        let power = omega.powi(4) * (-std::f64::consts::LN_2 * (hertz / cutoff).powi(2)).exp();
        let inertial = mass * omega * omega;
        rigid += power;
        elastic += power * inertial * inertial / ((stiffness - inertial).powi(2) + (damping * omega).powi(2));
    }
    elastic / rigid
}
