//! Columns of the joint fit, evaluated on the ticks of a chunk.

use effects::{LinkSide, Scales, Term};

use crate::data::motion::Chunk;
use crate::data::rigid::Rigid;

/// The torque of `term` on `joint` at the ticks of `chunk` (N m or N); `None` if it has none there.
pub fn values(term: Term, joint: usize, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Option<Vec<f64>> {
    term.column(joint, &rigid.along(chunk, scales))
}

/// The link's motion behind a compliant joint along a chunk; `None` for other terms.
pub fn link_side(term: Term, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Option<LinkSide> {
    let simulate = term.law.link_side?;
    Some(simulate(&term, &rigid.along(chunk, scales)))
}

/// The torque (N m or N) that a link behind a compliant joint adds on `joint`.
pub fn link_side_torque(link: &LinkSide, joint: usize, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Vec<f64> {
    link.torque(joint, rigid.along(chunk, scales).rigid)
}
