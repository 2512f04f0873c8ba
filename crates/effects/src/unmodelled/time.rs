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
                moments.extend((0..count).map(|k| Term::on(&MOMENT, joint).sized([from + width * k as f64, width])));
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
