//! The link behind a joint that gives: what its motion relative to the drive adds to the torques.

use crate::motion::Chunk;
use crate::rigid::Rigid;

/// What the link's motion δ (link less drive) behind joint `at` adds to the torque of `joint`:
/// M δ̈ + ∂τ/∂q̇ δ̇ + ∂τ/∂q δ, where δ follows
/// M δ̈ + (D + ∂τ/∂q̇) δ̇ + (K + ∂τ/∂q) δ = −τ, driven by the drive's measured motion.
///
/// Integrated by the trapezoidal rule (Newmark, β = 1/4), from the quasi-static δ = −τ/K.
pub fn elastic(at: usize, joint: usize, stiffness: f64, damping: f64, chunk: &Chunk, rigid: &Rigid) -> Vec<f64> {
    let h = chunk.period;
    let (mass, drag, slope) = (
        &rigid.mass[at][at],
        &rigid.by_velocity[at][at],
        &rigid.by_position[at][at],
    );
    let tau = &rigid.tau[at];
    let ticks = chunk.ticks();
    let mut out = Vec::with_capacity(ticks);
    let mut delta = -tau[0] / (stiffness + slope[0]);
    let (mut speed, mut acceleration) = (0.0, 0.0);
    for k in 0..ticks {
        let (m, d, s) = (mass[k], damping + drag[k], stiffness + slope[k]);
        if k > 0 {
            let place = delta + h * speed + 0.25 * h * h * acceleration;
            let pace = speed + 0.5 * h * acceleration;
            acceleration = (-tau[k] - d * pace - s * place) / (m + 0.5 * h * d + 0.25 * h * h * s);
            delta = place + 0.25 * h * h * acceleration;
            speed = pace + 0.5 * h * acceleration;
        }
        out.push(
            rigid.mass[joint][at][k] * acceleration
                + rigid.by_velocity[joint][at][k] * speed
                + rigid.by_position[joint][at][k] * delta,
        );
    }
    out
}

/// The same behind a gap of ± `halfgap`: the link lies against one side while its torque presses it there, and
/// moves freely from one to the other when the torque turns; impacts are inelastic.
pub fn gap(at: usize, joint: usize, halfgap: f64, chunk: &Chunk, rigid: &Rigid) -> Vec<f64> {
    let h = chunk.period;
    let tau = &rigid.tau[at];
    let ticks = chunk.ticks();
    let mut out = Vec::with_capacity(ticks);
    // Positive torque: the drive pushes the link in the positive direction, so the link lags behind, δ = −halfgap.
    let mut delta = if tau[0] >= 0.0 { -halfgap } else { halfgap };
    let mut speed = 0.0;
    let mut free = false;
    for k in 0..ticks {
        let needed = tau[k] + rigid.by_position[at][at][k] * delta;
        let mut acceleration = 0.0;
        if !free && needed * delta > 0.0 {
            free = true;
        }
        if free {
            acceleration = -(needed + rigid.by_velocity[at][at][k] * speed) / rigid.mass[at][at][k].max(1e-9);
            let before = speed;
            speed += h * acceleration;
            delta += h * speed;
            if delta.abs() >= halfgap {
                delta = delta.clamp(-halfgap, halfgap);
                free = false;
                speed = 0.0;
                // The impact stops the link within this tick.
                acceleration = -before / h;
            }
        }
        out.push(
            rigid.mass[joint][at][k] * acceleration
                + rigid.by_velocity[joint][at][k] * speed
                + rigid.by_position[joint][at][k] * delta,
        );
    }
    out
}
