//! The torque of a neighbouring joint.

use crate::{Form, Law, Regressor, Spec, Term, Turn};

/// The least number of joints of an arm with crosstalk.
const LEAST_JOINTS: usize = 3;

/// A part of the torque of a neighbouring joint, as of a torque sensor that senses the load of the next one, of two current channels that
/// are not separated, or of a differential whose torques are recorded at the motors. On an arm of two joints, the dynamics of the other joint
/// resemble it.
pub static OTHER_TORQUE: Spec = Spec {
    name: "other_torque",
    depends_on: Some(Regressor::OtherTorque),
    has_other: true,
    forms: |grounds| {
        let are_neighbours = |(joint, other): &(usize, usize)| joint.abs_diff(*other) == 1;
        let form = |(joint, other)| {
            Form::on(Turn::Others, joint, vec![Term::on(&TORQUE_OF_OTHER, joint).of(other)]).with(other)
        };
        let on_arm = |_: &(usize, usize)| grounds.arm.dof() >= LEAST_JOINTS;
        grounds.pairs().filter(on_arm).filter(are_neighbours).map(form).collect()
    },
    ..Spec::UNMODELLED
};

/// The rigid model's torque of another joint.
static TORQUE_OF_OTHER: Law = Law {
    name: "torque of another joint",
    column: |term, _, motion| {
        let torque = &motion.rigid.tau[term.of[1]];
        motion.map(|k| torque[k])
    },
    needs_model: true,
    ..Law::PLAIN
};
