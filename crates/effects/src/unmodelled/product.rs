//! Products of position and velocity.

use crate::laws::centred;
use crate::{Form, Law, Regressor, Spec, Term, Times, Turn};

/// A product of position and velocity.
pub static PRODUCT: Spec = Spec {
    name: "product",
    depends_on: Some(Regressor::OwnPositionTimesSpeed),
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            let terms = (0..4).map(|form| Term::on(&POSITION_TIMES_SPEED, joint).form(form)).collect();
            forms.push(Form::on(Turn::Past, joint, terms));
            for times in [Times::Velocity, Times::Speed] {
                forms.push(Form::on(Turn::Past, joint, grounds.tents(joint, joint, 6, times)));
            }
        }
        forms
    },
    ..Spec::UNMODELLED
};

/// q q̇, q sgn q̇, q² sgn q̇ and q² q̇, q being the position over its range.
static POSITION_TIMES_SPEED: Law = Law {
    name: "product",
    column: |term, joint, motion| {
        motion.map(|k| {
            let place = centred(motion, joint, k);
            match term.form {
                0 => place * motion.qd[joint][k],
                1 => place * motion.sign(joint, k),
                2 => place * place * motion.sign(joint, k),
                _ => place * place * motion.qd[joint][k],
            }
        })
    },
    ..Law::PLAIN
};
