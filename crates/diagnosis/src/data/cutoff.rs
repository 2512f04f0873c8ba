//! The cut-off of the filter, from the speed of the motion and the noise of the positions.

use arm::Arm;

use crate::data::input::Input;
use crate::data::measure::noise_share;
use crate::data::motion::Motions;
use crate::data::noise::WhiteNoise;
use crate::data::statistics::quantile;
use crate::thresholds::{
    CUTOFF, CUTOFF_PERIODS, HIGHEST_CUTOFF, LARGEST_CUTOFF, LEAST_CUTOFF, LEAST_CUTOFF_PERIODS, LEAST_WIDER,
    MOST_DEADBAND, MOST_NOISE, REST_NOISE, SPEED_QUANTILE, STANDS_OUT, WIDER, WORTH_RAISING,
};

/// The noise of the acceleration grows with this power of the cut-off, because white noise of the positions has the power 5 in the
/// variance of their second derivative.
const NOISE_GROWTH: f64 = 2.5;

/// Filters `inputs` with the second filter at `cutoff` (Hz), or at the highest frequency that the slowest recording
/// allows. Without a `cutoff`, it follows from the data: it is higher than usual if the motion is quick, and lower if
/// the noise of the positions would be a large part of the torques of `arm`.
///
/// The first filter is narrower than usual if otherwise the noise of a velocity would hide slow motion.
pub fn filtered(inputs: &[Input<'_>], cutoff: Option<f64>, arm: &Arm) -> Motions {
    let white: Vec<WhiteNoise> = inputs.iter().map(|input| WhiteNoise::of(input.recording)).collect();
    let at = |cutoff: f64, wider: f64| Motions::at(inputs, &white, cutoff, wider);
    let fastest = inputs.iter().map(|input| 1.0 / input.recording.period).fold(0.0, f64::max);
    with_quieter_speeds(with_cutoff(&|cutoff| at(cutoff, WIDER), cutoff, arm), fastest, &at)
}

/// `motions`, again through a narrower first filter if the velocity deadband of a joint that moves would be large. `fastest` is the highest
/// sampling rate (Hz).
fn with_quieter_speeds(motions: Motions, fastest: f64, at: &dyn Fn(f64, f64) -> Motions) -> Motions {
    // The rate may limit the first filter already.
    let widest = WIDER.min(LARGEST_CUTOFF * fastest / motions.cutoff);
    if widest <= LEAST_WIDER {
        return motions;
    }
    // The deadband over the joint's largest speed.
    let deadband = |joint: usize| {
        let noise = motions.sources.iter().map(|source| source.velocity_noise[joint]).fold(0.0, f64::max);
        let speeds = motions.chunks.iter().flat_map(|chunk| &chunk.qd[joint]).map(|speed| speed.abs());
        let speed = quantile(&mut speeds.collect::<Vec<f64>>(), SPEED_QUANTILE);
        if speed > STANDS_OUT * noise { REST_NOISE * noise / speed } else { 0.0 }
    };
    let deadbands: Vec<f64> = (0..motions.dof).map(deadband).collect();
    let is_large = |deadband: f64| deadband > MOST_DEADBAND;
    if !deadbands.iter().any(|&deadband| is_large(deadband)) {
        return motions;
    }
    let quiet = at(motions.cutoff, LEAST_WIDER);
    let moving = deadbands.iter().zip(&quiet.tempo).filter(|(_, tempo)| **tempo > 0.0);
    let largest = moving.map(|(deadband, _)| *deadband).fold(0.0, f64::max);
    if !is_large(largest) {
        return motions;
    }
    // The variance of a derivative of white noise grows with the third power of the cut-off.
    let wider = widest * (MOST_DEADBAND / largest).powf(2.0 / 3.0);
    let next = if wider > LEAST_WIDER { at(motions.cutoff, wider) } else { quiet };
    // A narrower filter reaches farther, and a short stretch may be shorter than its reach.
    if next.chunks.len() < motions.chunks.len() { motions } else { Motions { remarks: motions.remarks, ..next } }
}

/// The motions with the cut-off of the second filter that is given or follows from the data.
fn with_cutoff(at: &dyn Fn(f64) -> Motions, cutoff: Option<f64>, arm: &Arm) -> Motions {
    let wanted = cutoff.unwrap_or(CUTOFF);
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

#[cfg(test)]
mod tests {
    use recording::{RegularRecording, Segment};

    use super::*;
    use crate::data::statistics::deviation;

    /// A joint that swings by 0.5 rad at 0.3 Hz, and one that rests, at `rate` (Hz) with encoders of `steps` a turn.
    fn motions(rate: f64, steps: f64, seconds: f64) -> Motions {
        let ticks = (rate * seconds) as usize;
        let step = std::f64::consts::TAU / steps;
        let swing = |tick: usize| 0.5 * (std::f64::consts::TAU * 0.3 * tick as f64 / rate).sin();
        let rounded = (0..ticks).map(|tick| step * (swing(tick) / step).round()).collect();
        let recording = RegularRecording {
            joints: vec!["swings".into(), "rests".into()],
            period: rate.recip(),
            q: vec![rounded, vec![0.0; ticks]],
            tau: vec![vec![0.0; ticks]; 2],
            segments: vec![Segment { ticks: 0..ticks, start: 0.0 }],
            present: vec![true; ticks],
            ..RegularRecording::default()
        };
        let input = Input { name: "", recording: &recording, held_out: false, before: false };
        let white = [WhiteNoise::of(&recording)];
        let at = |cutoff: f64, wider: f64| Motions::at(&[input], &white, cutoff, wider);
        with_quieter_speeds(at(CUTOFF, WIDER), rate, &at)
    }

    /// The velocity deadband of the joint that swings, over its speed.
    fn deadband(motions: &Motions) -> f64 {
        let speed = std::f64::consts::SQRT_2 * deviation(motions.chunks[0].qd[0].iter());
        REST_NOISE * motions.sources[0].velocity_noise[0] / speed
    }

    /// 4096 steps a turn at 200 Hz, through a first filter of 36 Hz: 0.3 rad/s of 0.94.
    #[test]
    fn coarse_encoders_get_a_narrower_first_filter() {
        for rate in [100.0, 200.0, 1000.0] {
            let deadband = deadband(&motions(rate, 4096.0, 20.0));
            assert!(deadband < 2.0 * MOST_DEADBAND, "{rate}: {deadband}");
        }
    }

    #[test]
    fn fine_encoders_and_short_recordings_keep_the_usual_one() {
        let noise = |motions: &Motions| motions.sources[0].velocity_noise[0];
        let fine = motions(200.0, 1e6, 20.0);
        let coarse = motions(200.0, 4096.0, 20.0);
        // In proportion to the steps, the usual filter passes more than the narrow one.
        assert!(noise(&fine) * 1e6 > 2.0 * noise(&coarse) * 4096.0, "{} {}", noise(&fine), noise(&coarse));
        // 16 widths, as the least recording.
        let short = motions(200.0, 4096.0, 0.33);
        assert!(!short.chunks.is_empty());
    }
}
