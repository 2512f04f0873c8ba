//! A drive in a position loop that moves its link through a gap.

use std::cell::RefCell;

use arm::{Arm, Workspace};

use super::{Motion, TURN, baseline_friction};

/// The inertia of the rotor (kg m²), and the stiffness (N m/rad) and the damping (N m s/rad) of the ends, on which it swings at 25 Hz.
const ROTOR: f64 = 0.2;
const STIFFNESS: f64 = 5000.0;
const DAMPING: f64 = 16.0;
/// The position loop (N m/rad, N m s/rad).
const GAINS: [f64; 2] = [600.0, 40.0];
/// The integration steps between two rows.
const STEPS: u32 = 40;

/// Position and velocity of rotor and link.
#[derive(Clone, Copy)]
struct State {
    time: f64,
    rotor: [f64; 2],
    link: [f64; 2],
}

/// The drive of [`TURN`], whose load changes its sign with the acceleration, follows the motion in a position loop, and moves its link
/// through a gap of ± `halfgap` (rad).
pub fn with_gap(arm: Arm, halfgap: f64) -> impl Fn(&mut Motion, &mut [f64]) {
    with_ends(arm, halfgap, Ends::Sharp)
}

/// The ends of a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends {
    /// They become stiff at once.
    Sharp,
    /// They become stiff within this part of half the gap, and the link bounces between them for long.
    Rounded(f64),
}

impl Ends {
    /// The torque (N m) on the link at a twist (rad) with a rate of change (rad/s).
    fn torque(self, halfgap: f64, twist: f64, rate: f64) -> f64 {
        match self {
            Self::Sharp => {
                let stretched = twist - twist.clamp(-halfgap, halfgap);
                STIFFNESS * stretched + if stretched == 0.0 { 0.0 } else { DAMPING * rate }
            }
            Self::Rounded(part) => {
                let width = part * halfgap;
                let soft = |depth: f64| (depth / width).max(0.0) + (-(depth / width).abs()).exp().ln_1p();
                STIFFNESS * width * (soft(twist - halfgap) - soft(-twist - halfgap))
            }
        }
    }
}

/// [`with_gap`] with other ends.
pub fn with_ends(arm: Arm, halfgap: f64, ends: Ends) -> impl Fn(&mut Motion, &mut [f64]) {
    let state: RefCell<Option<State>> = RefCell::new(None);
    move |motion, tau| {
        let (wanted, speed) = (motion.q[TURN], motion.qd[TURN]);
        let mut state = state.borrow_mut();
        let mut now = state.filter(|state| motion.time > state.time).unwrap_or(State {
            time: motion.time,
            rotor: [wanted, speed],
            link: [wanted + halfgap, speed],
        });
        let load = |acceleration: f64| {
            let (mut q, mut qd, mut qdd) = (motion.q.clone(), motion.qd.clone(), motion.qdd.clone());
            (q[TURN], qd[TURN], qdd[TURN]) = (now.link[0], now.link[1], acceleration);
            let mut torque = vec![0.0; q.len()];
            arm.inverse_dynamics(&mut Workspace::new(&arm), &q, &qd, &qdd, &mut torque);
            torque[TURN]
        };
        let rest = load(0.0);
        let mass = load(1.0) - rest;
        let error = GAINS[0] * (wanted - now.rotor[0]) + GAINS[1] * (speed - now.rotor[1]);
        let torque = rest + (mass + ROTOR) * motion.qdd[TURN] + error;
        let step = (motion.time - now.time) / f64::from(STEPS);
        for _ in 0..STEPS {
            let twist = now.rotor[0] - now.link[0];
            let rate = now.rotor[1] - now.link[1];
            let through = ends.torque(halfgap, twist, rate);
            let accelerations = [(torque - through) / ROTOR, (through - rest) / mass];
            for (side, acceleration) in [&mut now.rotor, &mut now.link].into_iter().zip(accelerations) {
                side[1] += step * acceleration;
                side[0] += step * side[1];
            }
        }
        now.time = motion.time;
        *state = Some(now);
        [motion.q[TURN], motion.qd[TURN]] = now.rotor;
        tau[TURN] = torque;
        baseline_friction(motion, tau);
    }
}
