//! A spring on a lever: the counterbalance of a heavy joint.

use std::f64::consts::PI;

use ::arm::{Arm, JointKind, Workspace};

use crate::laws::wave;
use crate::{Against, Experiment, Form, Law, Parameter, Quantity, Range, Spec, State, Term, Turn};

/// τ = amplitude sin(q − angle).
///
/// A spring of stiffness K without free length, between a point at the distance a from the joint's axis and the end of a lever
/// r, gives the torque K a r sin(q − angle). At `angle`, lever and anchor are in line, and the spring pulls back on either
/// side. Recordings determine `amplitude`, the product K a r, and `angle`; K, a and r do not appear separately in the torque. A
/// free length L₀ would multiply the law by 1 − L₀/L(q); this part remains in the residuals, or becomes the curve of a
/// `spring`.
pub static GRAVITY_COMPENSATOR: Spec = Spec {
    name: "gravity_compensator",
    title: "gravity compensator",
    meaning: "a spring on a lever that carries a part of the arm's weight (counterbalance)",
    distinguished_by: "slow sweeps over a large range, with the joints beyond it stretched and folded",
    formula: "A sin(q − q₀), A = K · anchor · lever",
    sentence: "a spring on a lever with a torque of at most {amplitude}, which is zero at {angle}",
    parameters: &[
        Parameter::new("amplitude", Quantity::Torque).within(Range::NotNegative),
        Parameter::new("angle", Quantity::Position),
    ],
    main: &["amplitude"],
    may_end: true,
    excludes: &["spring", "own_position"],
    is_beyond_the_drive: true,
    against: Against::Position,
    experiment: Some(Experiment {
        rank: 1,
        text: "sweep the joint slowly over more of its range: \
               a straight spring goes on rising where a lever's torque turns back",
    }),
    may_be_inertial: true,
    // Few joints have a gravity compensator. Of five that were named in simulated cases of two engines, none was right: three
    // were springs, and two wrong links.
    prior: 10.0,
    least_beside_inertials: Some(25.0),
    // Neither of two in the cases of `torque_scale` was right; they were up to 4.2 times as large.
    least_beside_residual: Some(6.0),
    forms: |grounds| {
        let far = |&joint: &usize| grounds.scales.range[joint] > SMALLEST_RANGE;
        let form = |joint| Form::on(Turn::Position, joint, columns(joint));
        grounds.moving().filter(far).map(form).collect()
    },
    // The joint must be revolute and carry weight; the torque must act against that weight, and must not be much larger.
    is_possible: |fitted| {
        let Some(joint) = fitted.term(0).joint else {
            return false;
        };
        let [sin, cos] = weight(fitted.arm(), joint);
        let [a, b] = [fitted.value(0), fitted.value(1)];
        let turns = fitted.arm().joints()[joint].kind == JointKind::Revolute;
        turns && a * sin + b * cos < 0.0 && a.hypot(b) < MOST_CARRIED * sin.hypot(cos)
    },
    read: |effect, estimate| {
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        let about = (-estimate.best()[b]).atan2(estimate.best()[a]);
        let amplitude = estimate.note("amplitude", |draw| draw[a].hypot(draw[b]));
        // Draws of the angle stay within half a turn of the estimate.
        let angle = estimate.note("angle", |draw| {
            let by = (-draw[b]).atan2(draw[a]) - about;
            about + by.sin().atan2(by.cos())
        });
        Some(effect.with("amplitude", amplitude).with("angle", angle))
    },
    // Two of them add up, such as one of a file of known effects and one that is found in addition to it.
    is_twin: |a, b| a == b,
    apply: |effect, at, machine| {
        let [amplitude, angle] = ["amplitude", "angle"].map(|key| effect.number(key));
        let torque = move |joint: usize, state: State<'_>| amplitude * wave(state.q[joint] - angle, false);
        machine.add_torque(at.joint, effect.onset(), torque);
    },
    ..Spec::EMPTY
};

/// The smallest range (rad) on which it is tried. Source: on a smaller one, a sine differs from a straight line by less
/// than 0.3 % of its rise, which no recording shows.
const SMALLEST_RANGE: f64 = 0.75;
/// The largest weight that a counterbalance carries, as a multiple of the weight on the joint by the model. It is above one,
/// because the model may lack a load at the tool.
const MOST_CARRIED: f64 = 3.0;
/// The number of joint angles at which the weight is evaluated.
const ANGLES: usize = 8;

/// sin (form 0) or cos (form 1) of the joint's angle.
static LEVER: Law = Law {
    name: "lever",
    column: |term, joint, motion| motion.map(|k| wave(motion.q[joint][k], term.form == 1)),
    ..Law::PLAIN
};

fn columns(joint: usize) -> Vec<Term> {
    [0, 1].map(|form| Term::on(&LEVER, joint).form(form)).to_vec()
}

/// The coefficients of sin and cos of the joint's angle in the weight on the joint (N m), with all other joints at zero.
fn weight(arm: &Arm, joint: usize) -> [f64; 2] {
    let (mut workspace, zero) = (Workspace::new(arm), vec![0.0; arm.dof()]);
    let (mut q, mut tau) = (zero.clone(), zero.clone());
    let mut sums = [0.0; 2];
    for k in 0..ANGLES {
        let angle = 2.0 * PI * k as f64 / ANGLES as f64;
        q[joint] = angle;
        arm.inverse_dynamics(&mut workspace, &q, &zero, &zero, &mut tau);
        for (form, sum) in sums.iter_mut().enumerate() {
            *sum += 2.0 / ANGLES as f64 * tau[joint] * wave(angle, form == 1);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&GRAVITY_COMPENSATOR).on("a").with("amplitude", 8.0);
        let effect = effect.with("angle", 0.4);
        let columns = columns(0);
        agree(&effect, &[(columns[0], 8.0 * 0.4_f64.cos()), (columns[1], -8.0 * 0.4_f64.sin())]);
    }
}
