//! A force on the tool that depends on the tool's position.

use crate::{Form, Law, Regressor, Signals, Spec, Term};

/// A force on the tool that depends on the tool's position, as of a hose, a balancer or an elastic cord.
pub static TOOL_POSITION: Spec = Spec {
    name: "tool_position",
    depends_on: Some(Regressor::ToolPosition),
    forms: |_| {
        let form = |columns| Form::of_arm((0..columns).map(|k| Term::about(&TOOL_FORCE, k)).collect());
        vec![form(CONSTANT), form(CONSTANT + LINEAR)]
    },
    ..Spec::UNMODELLED
};

/// The number of columns of a constant force.
const CONSTANT: usize = 3;
/// The number of columns of a force that is a symmetric matrix times the position, as of every force with a potential.
const LINEAR: usize = 6;

/// Jᵀ F, where J is the Jacobian of the tool's position x in the base's frame: F is a unit vector (`of[0]` from 0 to 2) or x times
/// a symmetric matrix with one or two unit elements.
static TOOL_FORCE: Law = Law {
    name: "force by tool position",
    column: |term, joint, motion| {
        let force = &motion.rigid.force[joint];
        let along =
            |motion: &Signals<'_>, [row, column]: [usize; 2], k: usize| force[row][k] * motion.rigid.tool[column][k];
        motion.map(|k| match term.of[0] {
            axis @ 0..CONSTANT => force[axis][k],
            element => {
                let [row, column] = ELEMENTS[element - CONSTANT];
                let sum = along(motion, [row, column], k);
                if row == column { sum } else { sum + along(motion, [column, row], k) }
            }
        })
    },
    needs_model: true,
    ..Law::PLAIN
};

/// The elements of a symmetric matrix.
const ELEMENTS: [[usize; 2]; LINEAR] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];
