//! A force on the tool for a limited time.

use ::arm::STANDARD_GRAVITY;

use crate::fitted::moving_mass;
use crate::{
    Against, Contact, Experiment, Law, Parameter, Quantity, Range, Scope, Shape, Size, Spec, Systematic, Term,
};

/// A force F on the tool for a limited time. The drives must add τ = −Jᵀ F, where J is the Jacobian of the tool's position
/// in the base's frame.
pub static EXTERNAL_CONTACT: Spec = Spec {
    name: "external_contact",
    title: "external contact",
    meaning: "a temporary external force on the arm (contact with a person or an object, a collision)",
    distinguished_by: "the same motion repeated without contact",
    formula: "a force on the tool for a limited time",
    sentence: "a force of {force} on the tool for {duration}, from {start} on",
    scope: Scope::Arm,
    parameters: &[
        Parameter::new("start", Quantity::Time).remarked("s, on the clock of its recording"),
        Parameter::new("duration", Quantity::Time).within(Range::Positive),
        Parameter::new("force", Quantity::Force)
            .of(Shape::List(3, &["force_x", "force_y", "force_z"]))
            .remarked("N, in the base's frame"),
    ],
    main: &["force"],
    may_repeat: true,
    // In about 700 simulated cases, the 17 contacts that were not there had 0.3 to 0.75, and the 45 that were had 0.77 and more. Those that
    // were not stood for a flexible or rolling base, liquid in the tool, drag on it, and a lag of one recording.
    least_over_error: Some(0.76),
    prior: 8.0,
    may_be_in_one_recording: true,
    is_suggested: true,
    against: Against::Time,
    experiment: Some(Experiment { rank: 2, text: "repeat the motion with the arm free of contact" }),
    // None: the residuals suggest the windows of contacts.
    forms: |_| Vec::new(),
    // Two windows that are close to each other are one contact.
    is_same: |a, b| {
        let ([a, b, ..], [c, d, ..]) = (a.sizes, b.sizes);
        a < d + SAME_CONTACT && c < b + SAME_CONTACT
    },
    is_possible: |fitted| {
        let force = (0..3).map(|k| fitted.value(k).powi(2)).sum::<f64>().sqrt();
        force < MOST_CONTACT * (STANDARD_GRAVITY * moving_mass(fitted.arm()))
    },
    read: |effect, estimate| {
        let [from, to] = window(estimate.terms().first()?)?;
        let (x, y, z) = (estimate.place(0)?, estimate.place(1)?, estimate.place(2)?);
        estimate.note_within(Systematic::OfForm, "force", &|draw| {
            (draw[x].powi(2) + draw[y].powi(2) + draw[z].powi(2)).sqrt()
        });
        estimate.start(from, to - from);
        let duration = estimate.size(Systematic::OfForm, "duration", Size::Duration, to - from);
        let force =
            [("force_x", x), ("force_y", y), ("force_z", z)].map(|(key, at)| estimate.coefficient(key, Some(at), 1.0));
        let effect = effect.with("start", from);
        Some(effect.with("duration", duration).with("force", force))
    },
    // Contacts with any different value are different contacts.
    is_twin: |a, b| a == b,
    apply: |effect, _, machine| {
        let start = effect.number("start");
        machine.contacts.push(Contact { start, end: start + effect.number("duration"), force: effect.vector("force") });
    },
    ..Spec::EMPTY
};

/// The torque of a force of 1 N on the tool along an axis of the base (`of[0]`), between two times (the sizes, s). The
/// force is constant in form 0 and half a period of a sine in form 1.
pub static FORCE: Law = Law {
    name: "force",
    column: |term, joint, motion| {
        let ([from, to, ..], force) = (term.sizes, &motion.rigid.force[joint][term.of[0]]);
        motion.map(|k| {
            let time = motion.time(k);
            if !(from..to).contains(&time) {
                0.0
            } else if term.form == 1 {
                -force[k] * (std::f64::consts::PI * (time - from) / (to - from)).sin()
            } else {
                -force[k]
            }
        })
    },
    needs_model: true,
    varied: Some(|term, size, factor| {
        let [from, to, ..] = term.sizes;
        match size {
            Size::Duration => term.sized([from, from + factor * (to - from)]),
            _ => *term,
        }
    }),
    other_form: Some(|term, factor| (about_middle(&term.form(1 - term.form), factor), true)),
    nudges: &[
        |term, step| term.sized([term.sizes[0] + 0.25 * step * (term.sizes[1] - term.sizes[0]).max(0.3)]),
        |term, step| {
            let [from, to, ..] = term.sizes;
            term.sized([from, to + 0.25 * step * (to - from).max(0.3)])
        },
        |term, step| {
            let [from, to, ..] = term.sizes;
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from) * (0.4 * step).exp());
            term.sized([middle - half, middle + half])
        },
    ],
    is_sound: |term| term.sizes[1] - term.sizes[0] > SHORTEST_CONTACT,
    ..Law::PLAIN
};

/// The term with its window scaled by a factor about the window's middle.
fn about_middle(term: &Term, factor: f64) -> Term {
    let [from, to, ..] = term.sizes;
    let (middle, half) = (0.5 * (from + to), 0.5 * factor * (to - from));
    term.sized([middle - half, middle + half])
}

/// The columns of a force on the tool between two times (s), constant or (`round`) half a sine.
pub fn columns(from: f64, to: f64, round: bool) -> Vec<Term> {
    (0..3).map(|axis| Term::about(&FORCE, axis).form(usize::from(round)).sized([from, to])).collect()
}

/// The start and the end of a contact's column (s); `None` for a column of another law.
pub fn window(term: &Term) -> Option<[f64; 2]> {
    term.is(&FORCE).then_some([term.sizes[0], term.sizes[1]])
}

/// The largest force of a contact as a multiple of the arm's weight under standard gravity, so that an arm without weight may have
/// contacts. The drives could not hold a larger one. Source: first diagnosis.
const MOST_CONTACT: f64 = 4.0;

/// The shortest contact (s).
const SHORTEST_CONTACT: f64 = 0.05;
/// Contacts that are less than this apart are one contact (s). Source: first diagnosis.
const SAME_CONTACT: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::{column, machine};

    #[test]
    fn it_lasts_as_long_as_its_columns() {
        let effect = Effect::of(&EXTERNAL_CONTACT).with("start", 0.2);
        let effect = effect.with("duration", 0.3).with("force", [5.0, 2.0, 7.0]);
        let contact = &machine(&effect).contacts[0];
        assert_eq!((contact.start, contact.end), (0.2, 0.5));
        let (torque, _) = column(&columns(0.2, 0.5, false)[0], 0);
        let acting = torque.iter().filter(|torque| **torque != 0.0).count();
        assert_eq!(acting, 30);
    }
}
