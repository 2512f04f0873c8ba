//! The cut-off of the filter, from the speed of the motion and the noise of the positions.

use arm::Arm;

use crate::data::input::Input;
use crate::data::measure::noise_share;
use crate::data::motion::Motions;
use crate::data::noise::WhiteNoise;
use crate::thresholds::{
    CUTOFF, CUTOFF_PERIODS, HIGHEST_CUTOFF, LEAST_CUTOFF, LEAST_CUTOFF_PERIODS, MOST_NOISE, WORTH_RAISING,
};

/// The noise of the acceleration grows with this power of the cut-off, because white noise of the positions has the power 5 in the
/// variance of their second derivative.
const NOISE_GROWTH: f64 = 2.5;

/// Filters `inputs` with the second filter at `cutoff` (Hz), or at the highest frequency that the slowest recording
/// allows. Without a `cutoff`, it follows from the data: it is higher than usual if the motion is quick, and lower if
/// the noise of the positions would be a large part of the torques of `arm`.
pub fn filtered(inputs: &[Input<'_>], cutoff: Option<f64>, arm: &Arm) -> Motions {
    let wanted = cutoff.unwrap_or(CUTOFF);
    let white: Vec<WhiteNoise> = inputs.iter().map(|input| WhiteNoise::of(input.recording)).collect();
    let at = |cutoff: f64| Motions::at(inputs, &white, cutoff);
    let mut motions = at(wanted);
    if motions.cutoff < wanted {
        motions.remarks.push(format!(
            "the lowest sampling rate limits the filter to {:.1} Hz instead of {wanted:.0} Hz; faster effects are not detectable",
            motions.cutoff
        ));
    }
    if cutoff.is_some() {
        return motions;
    }
    let mut tempo = motions.usual_tempo();
    let quick = (CUTOFF_PERIODS * tempo).min(HIGHEST_CUTOFF);
    if quick > WORTH_RAISING * motions.cutoff {
        motions = at(quick);
    }
    // Noise may hide that a joint moves.
    let mut moves: Vec<bool> = motions.tempo.iter().map(|&tempo| tempo > 0.0).collect();
    if moves.contains(&false) && motions.cutoff > LEAST_CUTOFF {
        let quiet = at(LEAST_CUTOFF);
        let hidden: Vec<bool> = moves.iter().zip(&quiet.tempo).map(|(moves, &tempo)| !moves && tempo > 0.0).collect();
        if hidden.contains(&true) {
            tempo = quiet.usual_tempo();
            moves.iter_mut().zip(hidden).for_each(|(moves, hidden)| *moves |= hidden);
        }
    }
    let (share, joint) = noise_share(&motions, arm, &moves);
    if share > MOST_NOISE {
        let quiet = motions.cutoff * (MOST_NOISE / share).powf(1.0 / NOISE_GROWTH);
        let least = LEAST_CUTOFF.max(LEAST_CUTOFF_PERIODS * tempo).min(motions.cutoff);
        let before = motions.cutoff;
        motions = at(quiet.max(least));
        let joint = &arm.joints()[joint].name;
        let [before, now] = [before, motions.cutoff].map(|cutoff| format!("{cutoff:.1} Hz"));
        motions.remarks.push(if now == before {
            format!(
                "the noise of the positions alone is {share:.2} times the torque of {joint}, and the motion is too quick for a filter \
                 below {now}"
            )
        } else {
            format!(
                "the filter's cut-off was lowered from {before} to {now}: with {before}, the noise of the positions would be \
                 {share:.2} times the torque of {joint}"
            )
        });
    }
    motions
}
