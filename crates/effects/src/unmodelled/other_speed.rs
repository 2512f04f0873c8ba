//! Even or nonlinear functions of another joint's velocity.

use crate::{Form, Law, Regressor, Spec, Term, Turn};

/// An even or nonlinear function of another joint's velocity.
pub static OTHER_SPEED: Spec = Spec {
    name: "other_speed",
    depends_on: Some(Regressor::OtherJoint),
    has_other: true,
    forms: |grounds| {
        let form = |(joint, other)| {
            let term = |form| Term::on(&SPEED_OF_OTHER, joint).of(other).form(form);
            Form::on(Turn::Others, joint, (0..4).map(term).collect()).with(other)
        };
        grounds.pairs().map(form).collect()
    },
    ..Spec::UNMODELLED
};

/// |v|, v², v |v| and v³, v being another joint's velocity over its largest.
static SPEED_OF_OTHER: Law = Law {
    name: "other_speed",
    column: |term, _, motion| {
        let other = term.of[1];
        motion.map(|k| {
            let speed = motion.qd[other][k] / motion.scales.speed[other].max(1e-9);
            match term.form {
                0 => speed.abs(),
                1 => speed * speed,
                2 => speed * speed.abs(),
                _ => speed * speed * speed,
            }
        })
    },
    ..Law::PLAIN
};
