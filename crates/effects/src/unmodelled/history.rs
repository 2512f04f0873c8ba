//! Functions of past motion.

use crate::{Form, Law, Regressor, Size, Spec, Term, Turn};

/// A function of past motion: creeping friction, hysteresis.
pub static HISTORY: Spec = Spec {
    name: "history",
    depends_on: Some(Regressor::History),
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            for time in [0.1, 0.3, 1.0, 3.0] {
                let term = |form| Term::on(&MEMORY, joint).form(form).sized([time]);
                forms.push(Form::on(Turn::Past, joint, vec![term(0), term(1)]));
            }
            for share in [0.02, 0.06, 0.15, 0.35] {
                let terms = vec![Term::on(&PLAY, joint).sized([share * grounds.scales.range[joint]])];
                forms.push(Form::on(Turn::Past, joint, terms));
            }
        }
        forms
    },
    ..Spec::UNMODELLED
};

/// The shortest time constant that is not attributed to friction (s). Source: `prove`, seeds 1, 2, 3, 7, 2026 and 2027.
const SHORTEST_MEMORY: f64 = 0.1;

/// q̇ (form 0) or sgn q̇ (form 1) after a first-order low-pass filter; the size is its time constant (s).
static MEMORY: Law = Law {
    name: "memory",
    column: |term, joint, motion| {
        let source: Vec<f64> = if term.form == 0 {
            motion.qd[joint].clone()
        } else {
            (0..motion.ticks()).map(|k| motion.sign(joint, k)).collect()
        };
        Some(low_passed(&source, motion.period / term.sizes[0]))
    },
    // With a shorter time constant, the filtered velocity is the velocity itself.
    varied: Some(|term, size, factor| match size {
        Size::Main => term.sized([(term.sizes[0] * factor).max(SHORTEST_MEMORY)]),
        _ => *term,
    }),
    ..Law::PLAIN
};

/// The position of a drag link within its play (the size, rad or m), −1 to 1.
static PLAY: Law =
    Law { name: "play", column: |term, joint, motion| Some(play(&motion.q[joint], term.sizes[0])), ..Law::PLAIN };

/// A first-order low-pass filter that starts at the first value; `share` is the period of the ticks over the time constant.
fn low_passed(signal: &[f64], share: f64) -> Vec<f64> {
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

/// The position of q within the play `width` of a drag link, −1 to 1: a hysteresis (Prandtl's play operator).
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

    /// The drag link moves only after its play is used up.
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
