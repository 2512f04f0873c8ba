//! Effects drawn at random: sizes and forms that a robot could have.

use std::f64::consts::TAU;

use rand::Rng;
use rand::seq::IndexedRandom;
use rand_distr::{Distribution, StandardNormal};
use serde_json::json;

use crate::physics::{EFFECTS, UNKNOWN};
use crate::robot::Robot;
use crate::truth::Injected;

mod outside;
mod size;

pub(crate) use size::{is_sized, resize};

/// The catalogue's families that are drawn: all but the first two, plain viscous and Coulomb friction, which are ordinary.
pub const FAMILIES: &[&str] = EFFECTS.split_at(2).1;

/// Effects that may set in at an onset when they are drawn.
const SETS_IN: [&str; 6] = [
    "payload",
    "torque_offset",
    "friction_asymmetry",
    "torque_scale",
    "spring",
    "quadratic_drag",
];
/// How often they do.
const ONSET: f64 = 0.12;

/// Effects that replace the ordinary dry friction of their joint.
const DRY: [&str; 4] = [
    "friction_asymmetry",
    "stribeck_friction",
    "load_dependent_friction",
    "thermal_drift",
];

/// Whether `effect` brings the dry friction of its joint with it.
pub(crate) fn is_dry(effect: &str) -> bool {
    DRY.contains(&effect)
}

/// Whether `effect` is on the whole arm.
fn is_global(effect: &str) -> bool {
    ["payload", "inertial_scale", "gravity_misalignment", "external_contact"].contains(&effect)
}

/// What sizes are drawn by.
pub(crate) struct Scales<'a> {
    pub robot: &'a Robot,
    pub hard: bool,
    /// Standard deviation of each joint's torque (N m or N), without effects.
    pub spreads: &'a [f64],
    /// Of each joint, the sizes of its torque in increasing order (N m or N).
    pub torques: &'a [Vec<f64>],
    /// Ordinary dry friction (N m or N), 0 where there is none.
    pub coulomb: &'a [f64],
    /// When the first training recording begins and the last ends (s).
    pub span: (f64, f64),
}

/// Ordinary friction of every joint: Coulomb level and viscous coefficient.
pub(crate) fn ordinary_friction(spreads: &[f64], random: &mut impl Rng) -> Vec<(f64, f64)> {
    let mut log = |least: f64, most: f64| random.random_range(least.ln()..most.ln()).exp();
    spreads
        .iter()
        .map(|s| (s * log(0.06, 0.35), s * log(0.1, 0.5)))
        .collect()
}

impl Scales<'_> {
    /// Whether `effect` can be on this robot at all.
    pub(crate) fn can_have(&self, effect: &str) -> bool {
        let needs_another = [
            "transmission_coupling",
            "cross_coupling_unknown",
            "other_velocity_unknown",
        ];
        let plain_rotors = effect == "rotor_inertia" && self.robot.has_rotors();
        !plain_rotors && (self.robot.arm().dof() > 1 || !needs_another.contains(&effect))
    }

    /// `effect` on a joint that is not `used`, of a size and form drawn.
    pub(crate) fn draw(&self, effect: &str, used: &[usize], random: &mut impl Rng) -> Injected {
        let n = self.robot.arm().dof();
        let free = |j: &usize| !used.contains(j);
        let mut joints: Vec<usize> = (0..n).filter(free).collect();
        let inner = match effect {
            // The base may carry no load, and the last link may be next to nothing.
            "load_dependent_friction" | "encoder_offset" | "torque_saturation" => 1..n.saturating_sub(1),
            "link_inertial_error" | "transmission_coupling" => 1..n,
            _ => 0..n,
        };
        if joints.iter().any(|j| inner.contains(j)) {
            joints.retain(|j| inner.contains(j));
        }
        let j = joints
            .choose(random)
            .copied()
            .unwrap_or_else(|| random.random_range(0..n));
        let name = self.robot.arm().joints()[j].name.as_str();
        let bare = Injected::new(effect, if is_global(effect) { None } else { Some(name) });
        let mut drawn = if UNKNOWN.contains(&effect) {
            self.outside(bare, j, random)
        } else if is_dry(effect) {
            self.dry(bare, j, random)
        } else if is_global(effect) {
            self.whole_arm(bare, random)
        } else {
            self.on_joint(bare, j, random)
        };
        let sets_in = random.random_bool(ONSET);
        if sets_in && SETS_IN.contains(&effect) {
            let (from, to) = self.span;
            drawn.onset = Some(from + (to - from) * random.random_range(0.3..0.7));
        }
        drawn
    }

    /// Another joint than `j`.
    fn other(&self, j: usize, random: &mut impl Rng) -> &str {
        let n = self.robot.arm().dof();
        let others: Vec<usize> = (0..n).filter(|&o| o != j).collect();
        let o = others.choose(random).copied().unwrap_or(j);
        &self.robot.arm().joints()[o].name
    }

    fn dry(&self, bare: Injected, j: usize, random: &mut impl Rng) -> Injected {
        let (s, hard) = (self.spreads[j], self.hard);
        let drawn = s * random.random_range(0.08..0.25);
        let mut coulomb = if self.coulomb[j] > 0.0 { self.coulomb[j] } else { drawn };
        let form = if hard { random.random_range(0..3) } else { 0 };
        match bare.effect.as_str() {
            "friction_asymmetry" => {
                coulomb = coulomb.max(s * random.random_range(0.1..0.3));
                let half = coulomb * random.random_range(0.15..0.5) * sign(random);
                bare.with("positive", coulomb + half).with("negative", coulomb - half)
            }
            "stribeck_friction" => {
                let exponent = if hard {
                    *[0.7, 1.0, 1.5, 3.0].choose(random).unwrap_or(&1.0)
                } else {
                    2.0
                };
                let bare = if hard { bare.formed("another exponent") } else { bare };
                bare.with("coulomb", coulomb)
                    .with("breakaway", coulomb * random.random_range(1.4..2.4))
                    .with("velocity", random.random_range(0.06..0.28))
                    .with("exponent", exponent)
            }
            "load_dependent_friction" => {
                let bare = if form == 1 { bare.formed("drive load") } else { bare };
                bare.with("coulomb", coulomb)
                    .with("gain", random.random_range(0.06..0.2))
            }
            _ => {
                let bare = match form {
                    0 => bare,
                    1 => bare.formed("hyperbolic"),
                    _ => bare.formed("stretched"),
                };
                bare.with("coulomb", coulomb)
                    .with("amplitude", random.random_range(0.3..1.2))
                    .with("time_constant", random.random_range(20.0..60.0))
            }
        }
    }

    fn whole_arm(&self, bare: Injected, random: &mut impl Rng) -> Injected {
        let hard = self.hard;
        let load = 0.07 * self.robot.mass();
        match bare.effect.as_str() {
            "payload" => {
                let mass = load * random.random_range(0.25..if hard { 0.8 } else { 1.6 });
                let mut across = || random.random_range(-0.03..0.03);
                let com = [across(), across(), random.random_range(0.03..0.16)];
                let moment = 0.4 * mass * 0.04 * 0.04;
                bare.with("mass", mass)
                    .with("com", json!(com))
                    .with("inertia", json!([moment, 0.0, moment, 0.0, 0.0, moment]))
            }
            "inertial_scale" => {
                let part = random.random_range(if hard { 0.03..0.1 } else { 0.06..0.2 });
                bare.with("factor", 1.0 + part * sign(random))
            }
            "gravity_misalignment" => {
                let (sin, cos) = random.random_range(0.0..TAU).sin_cos();
                bare.with("angle", random.random_range(if hard { 0.01..0.05 } else { 0.02..0.12 }))
                    .with("axis", json!([cos, sin, 0.0]))
            }
            _ => {
                let mut direction: [f64; 3] = [0.0; 3].map(|_: f64| StandardNormal.sample(random));
                let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
                let size = load * random.random_range(8.0..27.0);
                direction = direction.map(|x| x / length * size);
                // A recording is 25 s of every 30; the contact is within one.
                let recordings = ((self.span.1 - self.span.0) / 30.0).round().max(1.0) as usize;
                let start = self.span.0 + 30.0 * random.random_range(0..recordings) as f64;
                let bare = match if hard { random.random_range(1..3) } else { 0 } {
                    0 => bare,
                    1 => bare.formed("half-sine"),
                    _ => bare.formed("decaying"),
                };
                bare.with("start", start + random.random_range(5.0..21.0))
                    .with("duration", random.random_range(0.4..1.5))
                    .with("force", json!(direction))
            }
        }
    }

    fn on_joint(&self, bare: Injected, j: usize, random: &mut impl Rng) -> Injected {
        let (s, hard) = (self.spreads[j], self.hard);
        let link = self.robot.link_inertia(j);
        let own = self.robot.rotor_inertias()[j];
        match bare.effect.as_str() {
            "quadratic_drag" => {
                let coefficient = s * random.random_range(0.1..0.6);
                let exponent = *[1.7, 2.3, 2.7].choose(random).unwrap_or(&1.7);
                let drag = bare.with("coefficient", coefficient);
                if hard {
                    drag.formed("power").with("exponent", exponent)
                } else {
                    drag
                }
            }
            "rotor_inertia" => bare.with("inertia", link * random.random_range(0.15..0.8)),
            "torque_scale" => {
                let part = random.random_range(if hard { 0.04..0.12 } else { 0.08..0.25 });
                bare.with("factor", 1.0 + part * sign(random))
            }
            "torque_offset" => bare.with("offset", s * random.random_range(0.1..0.5) * sign(random)),
            "torque_ripple" => {
                let second = random.random_range(0.3..0.6);
                let ripple = bare
                    .with("amplitude", s * random.random_range(0.05..0.3))
                    .with("periods", f64::from(random.random_range(14_u8..41)))
                    .with("phase", random.random_range(0.0..TAU));
                if hard {
                    ripple.formed("second harmonic").with("second", second)
                } else {
                    ripple
                }
            }
            "torque_saturation" => {
                let reached = random.random_range(if hard { 0.9..0.98 } else { 0.8..0.95 });
                let soft = hard && random.random_bool(0.5);
                let torques = &self.torques[j];
                let place = (reached * torques.len() as f64) as usize;
                let limit = torques
                    .get(place.min(torques.len().saturating_sub(1)))
                    .copied()
                    .unwrap_or(s);
                let bare = if soft { bare.formed("soft") } else { bare };
                bare.with("limit", limit)
            }
            "actuation_delay" => {
                let lags = hard && random.random_bool(0.3);
                let bare = if lags { bare.formed("first-order lag") } else { bare };
                bare.with(
                    "delay",
                    random.random_range(if hard { 0.004..0.009 } else { 0.005..0.015 }),
                )
            }
            "joint_elasticity" => {
                let rotor = if own > 0.0 {
                    own
                } else {
                    link * random.random_range(0.5..1.2)
                };
                let frequency: f64 = random.random_range(18.0..45.0);
                let stiffness = rotor.max(if own > 0.0 { link } else { 0.0 }) * frequency * frequency;
                let hardens = hard && random.random_bool(0.5);
                let elastic = bare
                    .with("stiffness", stiffness)
                    .with("damping", 0.08 * (stiffness * rotor).sqrt())
                    .with("rotor", rotor);
                if hardens {
                    elastic.formed("hardening").with("hardening_torque", 6.0 * s)
                } else {
                    elastic
                }
            }
            "backlash" => {
                let rotor = if own > 0.0 {
                    own
                } else {
                    link * random.random_range(0.4..1.0)
                };
                let round = hard && random.random_bool(0.6);
                let bare = if round { bare.formed("rounded") } else { bare };
                bare.with(
                    "halfgap",
                    random.random_range(if hard { 0.002..0.008 } else { 0.004..0.014 }),
                )
                .with("rotor", rotor)
            }
            "transmission_coupling" => {
                // The law is the same for both joints; it is told of the outer one, as the catalogue does.
                let o = j.saturating_sub(1);
                let both = (self.robot.inertia(j) * self.robot.inertia(o)).sqrt();
                bare.with("other", self.robot.arm().joints()[o].name.as_str())
                    .with("viscous", s * random.random_range(0.05..0.35))
                    .with("inertia", both * random.random_range(0.15..0.55))
            }
            "link_inertial_error" => {
                let part = random.random_range(if hard { 0.08..0.4 } else { 0.12..0.4 });
                bare.with("relative", part * sign(random))
            }
            "encoder_offset" => {
                let size = random.random_range(if hard { 0.008..0.05 } else { 0.015..0.06 });
                bare.with("offset", size * sign(random))
            }
            _ => {
                let bend = *["gas spring", "hardening", "knee"].choose(random).unwrap_or(&"knee");
                let spring = bare
                    .with("stiffness", s * random.random_range(0.3..1.5))
                    .with("rest", self.robot.home()[j] + random.random_range(-0.4..0.4));
                if hard { spring.formed(bend) } else { spring }
            }
        }
    }
}

fn sign(random: &mut impl Rng) -> f64 {
    if random.random_bool(0.5) { 1.0 } else { -1.0 }
}
