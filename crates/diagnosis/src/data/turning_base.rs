//! The arm on a base that could turn, along the recorded motion.

use arm::Arm;
use effects::Base;

use crate::data::motion::Chunk;
use crate::data::states::{Along, TOGETHER};

/// The number of axes about which the base could turn.
const AXES: usize = 2;

/// That of an arm of `dof` joints that is not evaluated.
pub fn zeros(dof: usize, ticks: usize) -> Base {
    let zeros = || [vec![0.0; ticks], vec![0.0; ticks]];
    Base { torque: zeros(), inertia: zeros(), coupling: (0..dof).map(|_| zeros()).collect() }
}

/// Evaluates `arm` on a base that could turn along `chunk`, with joints that are `offset` (rad or m) beyond their encoders.
pub fn along(arm: &Arm, offset: &[f64], chunk: &Chunk) -> Base {
    let (n, ticks) = (arm.dof(), chunk.ticks());
    let arm = arm.on_turning_base();
    let mut base = zeros(n, ticks);
    for from in (0..ticks).step_by(TOGETHER) {
        let span = from..ticks.min(from + TOGETHER);
        let states = Along::new(chunk, offset, span.clone());
        let count = span.len();
        let beside_rest = |signal: &[f64]| [&vec![0.0; AXES * count], signal].concat();
        let [q, qd, qdd] = [&states.q, &states.qd, &states.qdd].map(|signal| beside_rest(signal));
        let mut tau = vec![0.0; q.len()];
        arm.inverse_dynamics_batch(&q, &qd, &qdd, &mut tau);
        let mut mass = vec![0.0; q.len() * (n + AXES)];
        arm.mass_matrix_batch(&q, &mut mass);
        for axis in 0..AXES {
            let inertia = |joint: usize| &mass[(axis * (n + AXES) + joint) * count..][..count];
            base.torque[axis][span.clone()].copy_from_slice(&tau[axis * count..][..count]);
            base.inertia[axis][span.clone()].copy_from_slice(inertia(axis));
            for joint in 0..n {
                base.coupling[joint][axis][span.clone()].copy_from_slice(inertia(AXES + joint));
            }
        }
    }
    base
}
