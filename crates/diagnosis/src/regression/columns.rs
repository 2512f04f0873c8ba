//! Columns of the joint fit, evaluated on the ticks of a chunk.

use effects::{LinkSide, Scales, Signals, Term};

use crate::data::motion::Chunk;
use crate::data::rigid::Rigid;

/// A chunk as regressors see it.
fn along<'a>(chunk: &'a Chunk, rigid: &'a Rigid, scales: &'a Scales) -> Signals<'a> {
    Signals {
        recording: chunk.recording,
        start: chunk.start,
        period: chunk.period,
        q: &chunk.q,
        qd: &chunk.qd,
        qdd: &chunk.qdd,
        tau: &chunk.tau,
        rigid: effects::Rigid {
            tau: &rigid.tau,
            rotors: &rigid.rotors,
            links: &rigid.links,
            payload: &rigid.payload,
            fixed_bodies: &rigid.fixed_bodies,
            by_position: &rigid.by_position,
            by_velocity: &rigid.by_velocity,
            mass: &rigid.mass,
            tilt: &rigid.tilt,
            gravity: &rigid.gravity,
            force: &rigid.force,
        },
        scales,
    }
}

/// The torque of `term` on `joint` at the ticks of `chunk` (N m or N); `None` if it has none there.
pub fn values(term: Term, joint: usize, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Option<Vec<f64>> {
    term.column(joint, &along(chunk, rigid, scales))
}

/// The link's motion behind a compliant joint along a chunk; `None` for other terms.
pub fn link_side(term: Term, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Option<LinkSide> {
    let simulate = term.law.link_side?;
    Some(simulate(&term, &along(chunk, rigid, scales)))
}

/// The torque (N m or N) that a link behind a compliant joint adds on `joint`.
pub fn link_side_torque(link: &LinkSide, joint: usize, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Vec<f64> {
    link.torque(joint, along(chunk, rigid, scales).rigid)
}
