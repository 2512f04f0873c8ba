//! Even or nonlinear in another joint's velocity.

use crate::{EffectKind, Form, Grounds, Law, Spec, Term, Turn};

/// Even or nonlinear in another joint's velocity.
#[derive(Debug)]
pub struct OtherSpeed;

static SPEC: Spec = Spec {
    name: "other_speed",
    depends_on: "other_joint",
    ..Spec::UNNAMED
};

/// |v|, v², v |v| and v³ of another joint's velocity over its largest.
static OTHER_SPEED: Law = Law {
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

impl EffectKind for OtherSpeed {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn has_other(&self) -> bool {
        true
    }

    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form> {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            for other in grounds.moving().filter(|&other| other != joint) {
                let term = |form| Term::on(&OTHER_SPEED, joint).of(other).form(form);
                let terms = (0..4).map(term).collect();
                forms.push(Form::on(Turn::Others, joint, terms).with(other));
            }
        }
        forms
    }
}
