//! Any slow function of time.

use crate::laws::tent;
use crate::{Form, Law, Regressor, Spec, Term, Turn};

/// Any slow function of time.
pub static TIME: Spec = Spec {
    name: "time",
    may_be_in_one_recording: true,
    depends_on: Some(Regressor::Time),
    forms: |grounds| {
        let form = |joint| {
            let mut moments = Vec::new();
            for &(from, to) in grounds.times {
                let count = ((to - from) / 4.0).ceil().clamp(2.0, 12.0) as usize;
                let width = (to - from) / (count - 1) as f64;
                let centre = |k: usize| from + width * k as f64;
                // A constant torque of the recordings after a change is a torque offset, and no slow function of time. Without its mean in each
                // recording, the function cannot step between them.
                if grounds.has_change {
                    let within = |k: usize| Term::on(&MOMENT_WITHIN, joint).sized([centre(k), width, from, to]);
                    moments.extend((1..count).map(within));
                } else {
                    moments.extend((0..count).map(|k| Term::on(&MOMENT, joint).sized([centre(k), width])));
                }
            }
            Form::on(Turn::Past, joint, moments)
        };
        grounds.moving().map(form).collect()
    },
    ..Spec::UNMODELLED
};

/// A tent function of time; sizes are its centre and half its width (s).
static MOMENT: Law = Law {
    name: "moment",
    column: |term, _, motion| {
        let [centre, width, ..] = term.sizes;
        // Most tents are zero throughout this section of motion.
        if motion.time(0) >= centre + width || motion.time(motion.ticks()) <= centre - width {
            return Some(vec![0.0; motion.ticks()]);
        }
        motion.map(|k| tent(motion.time(k), centre, width))
    },
    ..Law::PLAIN
};

/// A tent function of time in one recording, less its mean over the time of the recording; sizes are its centre, half its width, and when
/// the recording begins and ends (s).
static MOMENT_WITHIN: Law = Law {
    name: "moment within a recording",
    column: |term, _, motion| {
        let [centre, width, from, to] = term.sizes;
        if to <= from || motion.time(0) > to || motion.time(motion.ticks()) < from {
            return Some(vec![0.0; motion.ticks()]);
        }
        // The tent is whole, or half of it is beyond the end.
        let area = if centre + 0.5 * width > to { 0.5 * width } else { width };
        let mean = area / (to - from);
        let is_within = |time: f64| (from..=to).contains(&time);
        motion.map(|k| if is_within(motion.time(k)) { tent(motion.time(k), centre, width) - mean } else { 0.0 })
    },
    ..Law::PLAIN
};
