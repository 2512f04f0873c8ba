//! The states along a motion that are evaluated together.

use std::ops::Range;

use crate::data::motion::Chunk;

/// The number of ticks that are evaluated together: as many regressors as stay in the processor's caches.
pub const TOGETHER: usize = 64;

/// The states at some ticks of a chunk, joint after joint.
pub struct Along {
    /// Positions (rad or m).
    pub q: Vec<f64>,
    /// Velocities (rad/s or m/s).
    pub qd: Vec<f64>,
    /// Accelerations (rad/s² or m/s²).
    pub qdd: Vec<f64>,
}

impl Along {
    /// Those of joints that are `offset` (rad or m) beyond their encoders.
    pub fn new(chunk: &Chunk, offset: &[f64], ticks: Range<usize>) -> Self {
        let all = |signal: &[Vec<f64>]| -> Vec<f64> {
            signal.iter().flat_map(|joint| &joint[ticks.clone()]).copied().collect()
        };
        let mut q = all(&chunk.q);
        for (q, offset) in q.chunks_exact_mut(ticks.len()).zip(offset) {
            q.iter_mut().for_each(|q| *q += offset);
        }
        Self { q, qd: all(&chunk.qd), qdd: all(&chunk.qdd) }
    }
}
