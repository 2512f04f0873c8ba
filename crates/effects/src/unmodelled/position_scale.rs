//! A recorded position that is a multiple of the true one.

use crate::{Law, Regressor, Spec, Term, Turn};

/// A recorded position that is a multiple of the true one, as with a wrong ratio of a gear or a belt, with its velocity and acceleration.
pub static POSITION_SCALE: Spec = Spec {
    name: "position_scale",
    depends_on: Some(Regressor::PositionScale),
    // Over a small range, it resembles a wrong zero, which is more usual. Beside an elastic joint of the wrong size, it had up to 47 nats more than
    // an injected zero.
    prior: 40.0,
    forms: |grounds| grounds.on_moving(Turn::Zero, |joint| vec![Term::about(&STRETCH, joint)]),
    ..Spec::UNMODELLED
};

/// The torque on all joints for a position, velocity and acceleration of one joint that are larger by their own amounts.
static STRETCH: Law = Law {
    name: "stretch",
    column: |term, joint, motion| {
        let (of, rigid) = (term.of[0], &motion.rigid);
        let [by_position, by_velocity, mass] =
            [rigid.by_position, rigid.by_velocity, rigid.mass].map(|by| &by[joint][of]);
        motion
            .map(|k| by_position[k] * motion.q[of][k] + by_velocity[k] * motion.qd[of][k] + mass[k] * motion.qdd[of][k])
    },
    needs_model: true,
    needs_derivatives: true,
    ..Law::PLAIN
};
