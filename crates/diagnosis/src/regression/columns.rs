//! Columns of the joint fit, evaluated on the ticks of a chunk.

use crate::data::motion::Chunk;
use crate::data::rigid::Rigid;
use crate::regression::compliance::Behind;
use crate::regression::term::{Term, Times};

/// What is slow, joint by joint: below it the sign of a velocity means nothing.
#[derive(Clone, Debug)]
pub struct Scales {
    /// The largest speed but for the fastest per cent (rad/s or m/s).
    pub speed: Vec<f64>,
    /// Below it a joint rests (rad/s or m/s).
    pub rest: Vec<f64>,
    /// The middle of the positions (rad or m).
    pub middle: Vec<f64>,
    /// From the lowest position to the highest (rad or m).
    pub range: Vec<f64>,
    /// The standard deviation of the measured torque (N m or N).
    pub torque: Vec<f64>,
}

impl Scales {
    /// A sign that passes zero as fast as the noise of the velocity allows.
    fn sign(&self, joint: usize, qd: f64) -> f64 {
        let x = qd / (0.3 * self.rest[joint]);
        x / (1.0 + x * x).sqrt()
    }
}

/// The torque of `term` on `joint` at the ticks of `chunk`; `None` if it has none there.
pub fn values(term: Term, joint: usize, chunk: &Chunk, rigid: &Rigid, scales: &Scales) -> Option<Vec<f64>> {
    if term.joint().is_some_and(|only| only != joint) {
        return None;
    }
    let ticks = chunk.ticks();
    let (q, qd) = (&chunk.q[joint], &chunk.qd[joint]);
    let map = |f: &dyn Fn(usize) -> f64| Some((0..ticks).map(f).collect::<Vec<f64>>());
    let sign = |tick: usize| scales.sign(joint, qd[tick]);
    let centred = |of: usize, tick: usize| (chunk.q[of][tick] - scales.middle[of]) / (0.5 * scales.range[of]).max(1e-9);
    match term {
        Term::Velocity(_) => Some(qd.clone()),
        Term::Sign(_) => map(&|k| sign(k)),
        Term::AbsSign(_) => map(&|k| sign(k).abs()),
        Term::One(_) => Some(vec![1.0; ticks]),
        Term::Stribeck { velocity, exponent, .. } => {
            map(&|k| (-(qd[k] / velocity).abs().powf(exponent)).exp() * sign(k))
        }
        Term::LoadSign(_) => map(&|k| rigid.tau[joint][k].abs() * sign(k)),
        Term::Warm { time_constant, .. } => map(&|k| (-chunk.time(k) / time_constant).exp() * sign(k)),
        Term::Drag { exponent, .. } => map(&|k| qd[k].abs().powf(exponent).copysign(qd[k])),
        Term::Acceleration(_) => Some(chunk.qdd[joint].clone()),
        Term::Rigid(_) => Some(rigid.tau[joint].clone()),
        Term::Position(_, power) => map(&|k| q[k].powi(power)),
        Term::Ripple { periods, cosine, .. } => map(&|k| wave(periods * q[k], cosine)),
        Term::Excess { limit, .. } => map(&|k| {
            let tau = chunk.tau[joint][k];
            tau - tau.clamp(-limit, limit)
        }),
        Term::Late { delay, .. } => Some(late(&chunk.tau[joint], delay / chunk.period)),
        Term::Elastic { .. } | Term::Gap { .. } => {
            Behind::new(term, chunk, rigid).map(|behind| behind.torque(joint, rigid))
        }
        Term::PairVelocity(a, b) => partner(joint, a, b).map(|other| chunk.qd[other].clone()),
        Term::PairAcceleration(a, b) => partner(joint, a, b).map(|other| chunk.qdd[other].clone()),
        Term::PairSign {
            joint: a,
            other: b,
            sense,
        } => partner(joint, a, b).and_then(|_| {
            let turn = if joint == a { 1.0 } else { sense };
            map(&|k| turn * scales.sign(a, chunk.qd[a][k] + sense * chunk.qd[b][k]))
        }),
        Term::Payload(parameter) => Some(rigid.payload[joint][parameter].clone()),
        Term::Link(link) => (joint <= link).then(|| rigid.links[joint][link].clone()),
        Term::EncoderOffset(by) => Some(rigid.by_position[joint][by].clone()),
        Term::Tilt(axis) => Some(rigid.tilt[joint][axis].clone()),
        Term::Scale => map(&|k| rigid.links[joint].iter().map(|link| link[k]).sum()),
        Term::Force { axis, from, to, round } => map(&|k| {
            let time = chunk.time(k);
            if !(from..to).contains(&time) {
                0.0
            } else if round {
                -rigid.force[joint][axis][k] * (std::f64::consts::PI * (time - from) / (to - from)).sin()
            } else {
                -rigid.force[joint][axis][k]
            }
        }),
        Term::Tent {
            of,
            centre,
            width,
            times,
            ..
        } => map(&|k| {
            let height = tent(chunk.q[of][k], centre, width);
            match times {
                Times::One => height,
                Times::Velocity => height * qd[k],
                Times::Speed => height * qd[k].abs(),
            }
        }),
        Term::OtherSpeed(_, other, form) => map(&|k| {
            let speed = chunk.qd[other][k] / scales.speed[other].max(1e-9);
            match form {
                0 => speed.abs(),
                1 => speed * speed,
                2 => speed * speed.abs(),
                _ => speed * speed * speed,
            }
        }),
        Term::Memory(_, time, form) => {
            let source: Vec<f64> = if form == 0 {
                qd.clone()
            } else {
                (0..ticks).map(sign).collect()
            };
            Some(faded(&source, chunk.period / time))
        }
        Term::Play(_, width) => Some(play(q, width)),
        Term::Product(_, form) => map(&|k| {
            let place = centred(joint, k);
            match form {
                0 => place * qd[k],
                1 => place * sign(k),
                2 => place * place * sign(k),
                _ => place * place * qd[k],
            }
        }),
        Term::Since { what, from, .. } => {
            let mut always = values(what.always(joint), joint, chunk, rigid, scales)?;
            let before = |tick: &usize| chunk.time(*tick) < from;
            (0..ticks).take_while(before).for_each(|tick| always[tick] = 0.0);
            Some(always)
        }
        Term::Wave { omega, cosine, .. } => map(&|k| wave(omega * chunk.time(k), cosine)),
        Term::Moment { centre, width, .. } => map(&|k| tent(chunk.time(k), centre, width)),
    }
}

/// The other of two joints; `None` to a third.
fn partner(joint: usize, a: usize, b: usize) -> Option<usize> {
    match joint {
        _ if joint == a => Some(b),
        _ if joint == b => Some(a),
        _ => None,
    }
}

fn wave(phase: f64, cosine: bool) -> f64 {
    if cosine { phase.cos() } else { phase.sin() }
}

fn tent(x: f64, centre: f64, width: f64) -> f64 {
    (1.0 - ((x - centre) / width).abs()).max(0.0)
}

/// The signal less itself `ticks` earlier, by cubic interpolation; nothing before it began.
fn late(signal: &[f64], ticks: f64) -> Vec<f64> {
    let whole = ticks.floor();
    let part = ticks - whole;
    let back = whole as usize;
    // Catmull-Rom weights at `part` beyond the tick, towards the past.
    let weights = [
        -0.5 * part + part * part - 0.5 * part.powi(3),
        1.0 - 2.5 * part * part + 1.5 * part.powi(3),
        0.5 * part + 2.0 * part * part - 1.5 * part.powi(3),
        -0.5 * part * part + 0.5 * part.powi(3),
    ];
    let at = |place: i64| signal[place.clamp(0, signal.len() as i64 - 1) as usize];
    (0..signal.len())
        .map(|k| {
            let base = k as i64 - back as i64;
            let before: f64 = (0..4).map(|w| weights[w] * at(base + 1 - w as i64)).sum();
            signal[k] - before
        })
        .collect()
}

/// A first-order low-pass with the given share of its time constant a tick, from rest at the first value.
fn faded(signal: &[f64], share: f64) -> Vec<f64> {
    let keep = (-share).exp();
    let mut state = signal.first().copied().unwrap_or(0.0);
    signal
        .iter()
        .map(|value| {
            state = keep * state + (1.0 - keep) * value;
            state
        })
        .collect()
}

/// Where q stands in the play of a drag link (−1 to 1): a position hysteresis (Prandtl's play operator).
fn play(q: &[f64], width: f64) -> Vec<f64> {
    let mut link = q.first().copied().unwrap_or(0.0);
    q.iter()
        .map(|&q| {
            link = link.clamp(q - width, q + width);
            (q - link) / width
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola is delayed exactly by fractions of a tick.
    #[test]
    fn delays_are_exact_on_parabolas() {
        let signal: Vec<f64> = (0..40).map(|k| 0.3 * f64::from(k) - 0.02 * f64::from(k * k)).collect();
        for ticks in [0.3, 1.0, 2.7] {
            let late = late(&signal, ticks);
            for k in 6..34 {
                let before = k as f64 - ticks;
                let expected = signal[k] - (0.3 * before - 0.02 * before * before);
                assert!((late[k] - expected).abs() < 1e-12, "{ticks} {k}");
            }
        }
    }

    /// The drag link moves only once its play is used up.
    #[test]
    fn the_play_remembers_the_direction() {
        let q = [0.0, 0.05, 0.1, 0.2, 0.15, 0.1, 0.0, -0.1];
        let place = play(&q, 0.1);
        let expected = [0.0, 0.5, 1.0, 1.0, 0.5, 0.0, -1.0, -1.0];
        for (a, b) in place.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{place:?}");
        }
    }
}
