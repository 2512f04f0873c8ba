//! Laws that several effects share: the motion itself, its sign, constants and curves over a position.

use crate::signals::Signals;
use crate::term::{Cone, Law, Term};

/// Sine (form 0) and cosine (form 1) of a periodic law on a joint, at one size.
pub fn sine_and_cosine(law: &'static Law, joint: usize, size: f64) -> Vec<Term> {
    let wave = |form| Term::on(law, joint).form(form).sized([size]);
    vec![wave(0), wave(1)]
}

/// Whether two such columns have nearly the same size: they differ by less than `share` of the smaller one.
pub fn is_same_wave(a: &Term, b: &Term, share: f64) -> bool {
    let (a, b) = (a.sizes[0], b.sizes[0]);
    (a - b).abs() < share * a.min(b)
}

/// q̇.
pub static VELOCITY: Law =
    Law { name: "velocity", column: |_, joint, motion| Some(motion.qd[joint].clone()), ..Law::PLAIN };

/// sgn q̇.
pub static SIGN: Law = Law {
    name: "sign",
    column: |_, joint, motion| motion.map(|k| motion.sign(joint, k)),
    cone: Cone::Level(|_, _, _| 1.0),
    ..Law::PLAIN
};

/// |sgn q̇|: one in motion, zero at a reversal.
pub static ABS_SIGN: Law = Law {
    name: "abs_sign",
    column: |_, joint, motion| motion.map(|k| motion.sign(joint, k).abs()),
    cone: Cone::Middle,
    ..Law::PLAIN
};

/// 1.
pub static ONE: Law = Law { name: "one", column: |_, _, motion| Some(vec![1.0; motion.ticks()]), ..Law::PLAIN };

/// q̈.
pub static ACCELERATION: Law =
    Law { name: "acceleration", column: |_, joint, motion| Some(motion.qdd[joint].clone()), ..Law::PLAIN };

/// The rigid torque of the joint. With an onset, it contains the friction and the rotor's torque of an earlier fit as well: a torque
/// constant that changes multiplies them, too, and they are known from the time before.
pub static RIGID: Law = Law {
    name: "rigid",
    column: |term, joint, motion| {
        let mut torque = motion.of_model(joint);
        if let (Some(_), Some(rest)) = (term.onset(), motion.rigid.rest.get(joint)) {
            torque.iter_mut().zip(rest).for_each(|(sum, rest)| *sum += rest);
        }
        Some(torque)
    },
    needs_model: true,
    ..Law::PLAIN
};

/// q to the power that is the term's form.
pub static POSITION: Law = Law {
    name: "position",
    column: |term, joint, motion| {
        let (q, power) = (&motion.q[joint], power(term));
        motion.map(|k| q[k].powi(power))
    },
    ..Law::PLAIN
};

/// The power of a [`POSITION`].
pub fn power(term: &Term) -> i32 {
    term.form as i32
}

/// The factor of a function of position, from the joint that it acts on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Times {
    /// One.
    One,
    /// q̇.
    Velocity,
    /// |q̇|.
    Speed,
}

/// A tent function of the position of joint `of[1]`. Sizes are its centre and half its width (rad or m); the form is its factor
/// ([`Times`]).
pub static TENT: Law = Law {
    name: "tent",
    column: |term, joint, motion| {
        let (of, [centre, width, ..], qd) = (term.of[1], term.sizes, &motion.qd[joint]);
        motion.map(|k| {
            let height = tent(motion.q[of][k], centre, width);
            match term.form {
                form if form == Times::Velocity as usize => height * qd[k],
                form if form == Times::Speed as usize => height * qd[k].abs(),
                _ => height,
            }
        })
    },
    ..Law::PLAIN
};

/// A tent function: one at `centre`, zero at a distance of `width` and more.
pub fn tent(x: f64, centre: f64, width: f64) -> f64 {
    (1.0 - ((x - centre) / width).abs()).max(0.0)
}

/// sin or cos of a phase (rad).
pub fn wave(phase: f64, cosine: bool) -> f64 {
    if cosine { phase.cos() } else { phase.sin() }
}

/// The position of joint `of`, scaled to −1 to 1 over its range.
pub fn centred(motion: &Signals<'_>, of: usize, tick: usize) -> f64 {
    (motion.q[of][tick] - motion.scales.middle[of]) / (0.5 * motion.scales.range[of]).max(1e-9)
}
