//! A base that is not level.

use ::arm::{Arm, Vector3};

use crate::{
    Detectability, Effect, Estimate, Experiment, Form, Law, Parameter, Quantity, Range, Scope, Shape, Spec, Term,
};

/// The base is turned by `angle` about `axis` (unit vector in the base's frame), which changes the direction of gravity.
pub static GRAVITY_MISALIGNMENT: Spec = Spec {
    name: "gravity_misalignment",
    title: "tilted base",
    meaning: "the base is not level, so that the direction of gravity differs from the model's",
    distinguished_by: "a spirit level on the base, or static poses all around the base",
    formula: "the base turned by the angle about the axis, which changes the direction of gravity: \
              a base that is not level, on a wall or on a ceiling",
    sentence: "a base tilted by {angle}",
    scope: Scope::Arm,
    parameters: &[
        Parameter::new("angle", Quantity::Angle),
        Parameter::new("axis", Quantity::Ratio)
            .of(Shape::List(3, &["axis_x", "axis_y"]))
            .remarked("in the base's frame"),
    ],
    main: &["angle"],
    is_certain_in_form: true,
    may_be_inertial: true,
    // Shifted centres of mass resemble a tilt. In simulated cases with wrong URDFs, injected tilts had 175 nats and more.
    least_beside_inertials: Some(60.0),
    is_beyond_the_drive: true,
    detectability: Detectability::OfArm { columns: 2 },
    not_testable_turn: 15,
    experiment: Some(Experiment {
        rank: 7,
        text: "level the base with a spirit level and record again: an effect that remains is not a tilt",
    }),
    // Small turns by linearisation, and gravity in any other direction.
    forms: |_| {
        let of = |law: &'static Law, count: usize| Form::of_arm((0..count).map(|k| Term::about(law, k)).collect());
        vec![of(&TILT, 2), of(&GRAVITY, 3)]
    },
    is_possible: |fitted| {
        if fitted.len() == 2 {
            return fitted.value(0).hypot(fitted.value(1)) < MOST_TURNED;
        }
        let usual = fitted.arm().gravity();
        let seen = seen(fitted.arm(), [0, 1, 2].map(|axis| fitted.value(axis)));
        let factor = seen.norm() / usual.norm().max(f64::MIN_POSITIVE);
        (1.0 / AS_LARGE..AS_LARGE).contains(&factor) && turn(usual, &seen).0 > LEAST_TURNED
    },
    read: |effect, estimate| {
        if estimate.terms().len() == 3 {
            return read_gravity(estimate);
        }
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        let angle = estimate.note("angle", |draw| draw[a].hypot(draw[b]));
        let x = estimate.note("axis_x", |draw| draw[a] / draw[a].hypot(draw[b]));
        let y = estimate.note("axis_y", |draw| draw[b] / draw[a].hypot(draw[b]));
        Some(effect.with("angle", angle).with("axis", [x, y, 0.0]))
    },
    refuse: |effect| {
        let axis: [f64; 3] = effect.list("axis");
        let length = axis.iter().map(|value| value * value).sum::<f64>().sqrt();
        let range = Range::Positive;
        (!range.contains(length)).then_some(("axis' length", length, range.requirement()))
    },
    // Two of them add up, such as one of a file of known effects and one that is found in addition to it.
    is_twin: |a, b| a == b,
    apply: |effect, _, machine| {
        machine.change_arm(|arm| arm.with_turned_base(effect.vector("axis"), effect.number("angle")));
    },
    ..Spec::EMPTY
};

/// ∂τ/∂(turn of the base about x or y).
pub static TILT: Law = Law {
    name: "tilt",
    column: |term, joint, motion| Some(motion.rigid.tilt[joint][term.of[0]].clone()),
    needs_model: true,
    carry: Some(|term, value, carried| carried.tilt[term.of[0]] += value),
    ..Law::PLAIN
};

/// The torque of gravity along an axis of the base. The torque is linear in gravity, so that these three columns can represent
/// a base on a wall or a ceiling, which no linearisation about the upright base reaches.
pub static GRAVITY: Law = Law {
    name: "gravity",
    column: |term, joint, motion| Some(motion.rigid.gravity[joint][term.of[0]].clone()),
    needs_model: true,
    carry: Some(|term, value, carried| carried.gravity[term.of[0]] += value),
    ..Law::PLAIN
};

/// Up to this angle (rad), a turn is found by linearisation about the upright base. Source: first diagnosis, which
/// found bases turned by 10 and 20 degrees and none from 30 degrees on.
const MOST_TURNED: f64 = 0.4;
/// From this angle on (rad), the direction of gravity is found by its three columns. Source: eight simulated bases
/// turned by 30 to 180 degrees, all of which are found.
const LEAST_TURNED: f64 = 0.3;
/// The factor by which the magnitude of gravity that the columns give may differ from the true one, because masses may
/// differ from the URDF's. Source: as for [`LEAST_TURNED`].
const AS_LARGE: f64 = 1.3;

/// The turn of the base after which gravity in the base's frame is `seen` instead of `usual` (m/s²): its angle (rad, from 0
/// to π) and its axis, a unit vector in the base's frame.
fn turn(usual: &Vector3<f64>, seen: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let axis = seen.cross(usual);
    let angle = axis.norm().atan2(seen.dot(usual));
    // On a ceiling, any horizontal axis gives the turn.
    let least = 1e-9 * usual.norm_squared();
    let axis = if axis.norm() > least { axis } else { usual.cross(&Vector3::x()) };
    let axis = if axis.norm() > least { axis } else { usual.cross(&Vector3::y()) };
    (angle, axis / axis.norm().max(f64::MIN_POSITIVE))
}

/// The angle of this turn about a given unit `axis` (rad, from 0 to 2 π).
fn angle_about(axis: &Vector3<f64>, usual: &Vector3<f64>, seen: &Vector3<f64>) -> f64 {
    let angle = axis.dot(&seen.cross(usual)).atan2(seen.dot(usual));
    angle.rem_euclid(std::f64::consts::TAU)
}

/// Gravity in the base's frame: the model's plus the difference `beyond` (m/s²).
fn seen(arm: &Arm, beyond: [f64; 3]) -> Vector3<f64> {
    arm.gravity() + Vector3::from(beyond)
}

/// The effect of three coefficients of [`GRAVITY`].
fn read_gravity(estimate: &mut dyn Estimate) -> Option<Effect> {
    let places = [estimate.place(0)?, estimate.place(1)?, estimate.place(2)?];
    let arm = estimate.arm().clone();
    let gravity = |draw: &[f64]| seen(&arm, places.map(|place| draw[place]));
    let usual = *arm.gravity();
    let (_, about) = turn(&usual, &gravity(estimate.best()));
    let angle = estimate.note("angle", |draw| angle_about(&about, &usual, &gravity(draw)));
    let axis = |draw: &[f64]| {
        let (_, axis) = turn(&usual, &gravity(draw));
        // Near the ceiling, the axis of a draw may have the opposite sign.
        axis * axis.dot(&about).signum()
    };
    let x = estimate.note("axis_x", |draw| axis(draw).x);
    let y = estimate.note("axis_y", |draw| axis(draw).y);
    Some(Effect::of(&GRAVITY_MISALIGNMENT).with("angle", angle).with("axis", [x, y, about.z]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::agree;

    /// A small turn agrees with the machine to first order.
    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&GRAVITY_MISALIGNMENT).with("angle", 1e-6);
        let effect = effect.with("axis", [0.6, 0.8, 0.0]);
        agree(&effect, &[(Term::about(&TILT, 0), 0.6e-6), (Term::about(&TILT, 1), 0.8e-6)]);
    }

    /// Large turns agree with the machine: on a slope, on a wall, on the ceiling.
    #[test]
    fn its_columns_of_gravity_are_its_torque() {
        for angle in [0.5, std::f64::consts::FRAC_PI_2, std::f64::consts::PI] {
            let axis = Vector3::new(0.6, 0.8, 0.0);
            let usual = Vector3::new(0.0, 0.0, -9.81);
            let effect = Effect::of(&GRAVITY_MISALIGNMENT).with("angle", angle);
            let effect = effect.with("axis", [axis.x, axis.y, axis.z]);
            let turned = nalgebra::Rotation3::from_scaled_axis(-angle * axis) * usual;
            let beyond = turned - usual;
            let columns = [0, 1, 2].map(|k| (Term::about(&GRAVITY, k), beyond[k]));
            agree(&effect, &columns);
            let (found, about) = turn(&usual, &turned);
            assert!((found - angle).abs() < 1e-6, "{found}");
            assert!(angle > 3.0 || (about - axis).norm() < 1e-9, "{about}");
        }
    }
}
