//! A body on the tool.

use ::arm::{Arm, Inertia, Matrix3, Vector3};

use super::tensor::{entries, second_moments, tensor};
use crate::fitted::moving_mass;
use crate::{
    Acts, Detectability, Effect, Estimate, Experiment, Form, InUrdf, Law, Parameter, Quantity, Range, Scope, SetsIn,
    Shape, Spec, Systematic, Term,
};

/// A body fixed to the tool.
pub static PAYLOAD: Spec = Spec {
    name: "payload",
    title: "payload",
    meaning: "a body at the tool that the model does not contain",
    distinguished_by: "the same motion with and without the load on the tool",
    formula: "a body on the tool",
    sentence: "a payload of {mass} at the tool",
    scope: Scope::Arm,
    parameters: &[
        Parameter::new("mass", Quantity::Mass),
        // Keys of the centre of mass.
        Parameter::new("com", Quantity::Length)
            .of(Shape::List(3, &["com_x", "com_y", "com_z"]))
            .remarked("m, in the tool's frame"),
        Parameter::new("inertia", Quantity::Inertia)
            .of(Shape::List(6, &[]))
            .or(0.0)
            .remarked("kg m²: Ixx Ixy Iyy Ixz Iyz Izz about the centre of mass, along the tool's axes"),
    ],
    main: &["mass"],
    may_end: true,
    // Both are a change of the last link's ten inertial parameters.
    excludes: &["link_inertial_error"],
    may_set_in: true,
    prior: 4.0,
    is_certain_in_form: true,
    may_be_inertial: true,
    is_wrong_mass: true,
    is_beyond_the_drive: true,
    detectability: Detectability::OfArm { columns: 1 },
    not_testable_turn: 13,
    in_urdf: InUrdf::Inertials,
    experiment: Some(Experiment {
        rank: 9,
        text: "record the same motion without the load, or with the tool mounted if it is missing: \
               an effect that remains is not a payload",
    }),
    // A form with moments of inertia, one without them for recordings that do not show them, and one for each body that the
    // URDF fixes to the last link and that may not be mounted: its inertia is known, so that it has one coefficient instead of ten.
    forms: |grounds| {
        let last = grounds.arm.joints().last().map_or(0.0, |joint| joint.inertia.mass);
        let bodies = grounds.arm.fixed_bodies().iter().enumerate();
        let drawn = bodies
            .filter(|(_, body)| body.inertia.mass >= LEAST_OF_LAST_LINK * last)
            .map(|(k, _)| Form::of_arm(vec![Term::about(&NOT_MOUNTED, k)]));
        let free = [with_moments(), without_moments()].map(Form::of_arm);
        free.into_iter().chain(drawn).collect()
    },
    sets_in: Some(SetsIn { turn: 4, forms: |_| vec![with_moments(), without_moments()], looked_for_with: 4 }),
    is_possible: |fitted| {
        let is_of_before = matches!(fitted.term(0).acts, Acts::Until(_));
        if std::ptr::eq(fitted.term(0).law, &NOT_MOUNTED) {
            return !is_of_before && NOT_MOUNTED_RANGE.contains(&fitted.value(0));
        }
        let mass = fitted.value(0);
        let reach = PAYLOAD_REACH * reach(fitted.arm());
        let first: f64 = (1..4).map(|k| fitted.value(k).powi(2)).sum::<f64>().sqrt();
        let last = fitted.arm().joints().last().map_or(0.0, |joint| joint.inertia.mass);
        // A tool that the URDF draws and that is not mounted has a negative mass; the last link must keep a positive one.
        let is_there = mass > 0.0 && mass < MOST_PAYLOAD * moving_mass(fitted.arm());
        // A tool that was mounted after the recordings from before is a payload since then.
        let is_large = fitted.term(0).is_always() || -mass > LEAST_REMOVED * last;
        let is_missing = !is_of_before && is_large && mass < 0.0 && -mass < last;
        (is_there || is_missing) && first < mass.abs() * reach
    },
    read: |effect, estimate| {
        let terms = estimate.terms();
        if let Some(term) = terms.first().filter(|term| std::ptr::eq(term.law, &NOT_MOUNTED)) {
            return read_not_mounted(effect, estimate, term.of[0]);
        }
        let places: [Option<usize>; 10] =
            std::array::from_fn(|parameter| estimate.place(terms.iter().position(|term| term.of[0] == parameter)?));
        let read = |draw: &[f64]| places.map(|place| place.map_or(0.0, |place| draw[place]));
        // Wrong masses of the links are the same before a payload is picked up.
        let always = terms.iter().all(Term::is_always);
        let systematic = if always { Systematic::OfLinks } else { Systematic::Usual };
        let mass = estimate.note_within(systematic, "mass", &|draw| read(draw)[0]);
        let mut com = [0.0; 3];
        for (k, key) in ["com_x", "com_y", "com_z"].into_iter().enumerate() {
            com[k] = estimate.note(key, |draw| {
                let parameters = read(draw);
                parameters[1 + k] / parameters[0]
            });
            // No torque depends on it, as on the height of a payload of an arm whose axes are all vertical.
            if com[k].abs() < UNSEEN {
                let reach = PAYLOAD_REACH * reach(estimate.arm());
                [-reach, reach].into_iter().for_each(|end| estimate.extend(key, end));
            }
        }
        let inertia = match places[4] {
            Some(_) => Some(body(&read(estimate.best())).tensor).filter(|tensor| exists(mass, tensor)),
            None => Some(estimate.load_tensor()),
        };
        let inertia = inertia.unwrap_or_else(Matrix3::zeros);
        let inertia = entries(&inertia);
        let effect = effect.with("mass", mass).with("com", com);
        Some(effect.with("inertia", inertia).since(estimate.onset()))
    },
    refuse: |effect| {
        // All moments of a missing body are negative.
        let sense = effect.number("mass").signum();
        let moments = sense * tensor(effect.list("inertia")).symmetric_eigenvalues();
        let wrong = moments.min() < -ROUNDING * moments.amax();
        wrong.then_some(("inertia's smallest principal moment", moments.min(), Range::NotNegative.requirement()))
    },
    // Payloads add up: a known one and one that was found in addition. Two equal payloads are an error of the user.
    is_twin: |a, b| a == b,
    own_title: |effect| (effect.number("mass") < 0.0).then_some("tool not mounted"),
    own_sentence: |effect| {
        let text = "the model has a body at the tool that is not mounted: {mass}";
        (effect.number("mass") < 0.0).then_some(text)
    },
    before_it: |effect| {
        if effect.number("mass") < 0.0 {
            "although it was in the recordings from before"
        } else {
            "absent in the recordings from before"
        }
    },
    apply: |effect, _, machine| machine.payloads.push((effect.onset(), payload_body(effect))),
    ..Spec::EMPTY
};

/// One of the ten inertial parameters at the tool.
pub static PARAMETER: Law = Law {
    name: "payload",
    column: |term, joint, motion| {
        let columns = &motion.rigid.payload[joint];
        Some(felt(columns, term.of[0], &columns[term.of[0]]))
    },
    needs_model: true,
    carry: Some(|term, value, carried| carried.payload[term.of[0]] += value),
    ..Law::PLAIN
};

/// The mass and the first moments at the tool of a body whose tensor about its centre of mass is not fitted. About the tool's origin, its
/// moments of inertia change with them, once an arm contains the body.
pub static WITHOUT_MOMENTS: Law = Law {
    name: "payload without moments",
    column: |term, joint, motion| {
        let columns = &motion.rigid.payload[joint];
        let of_body = columns.get(10 + term.of[0]);
        Some(felt(columns, term.of[0], of_body.unwrap_or(&columns[term.of[0]])))
    },
    needs_model: true,
    carry: PARAMETER.carry,
    ..Law::PLAIN
};

/// The `column` of a parameter of a body on a joint with these `columns`: zeros for a moment whose torque is negligible beside those of
/// the mass and of the other moments. With axes that are vertical to the digits of a URDF, the height of a body and most of its moments
/// of inertia would be fitted to noise, and no body would have them.
fn felt(columns: &[Vec<f64>], parameter: usize, column: &[f64]) -> Vec<f64> {
    let scale = || columns[..10].iter().map(|column| largest(column)).fold(0.0, f64::max);
    if parameter > 0 && largest(column) < LEAST_FELT * scale() { vec![0.0; column.len()] } else { column.to_vec() }
}

/// The largest magnitude of a column: several maxima side by side, so that none waits for the one before it.
fn largest(column: &[f64]) -> f64 {
    let larger = |largest: f64, torque: f64| if torque.abs() > largest { torque.abs() } else { largest };
    let mut all = [0.0; 16];
    let groups = column.chunks_exact(all.len());
    let rest = groups.remainder().iter().fold(0.0, |most, &torque| larger(most, torque));
    for group in groups {
        for (most, &torque) in all.iter_mut().zip(group) {
            *most = larger(*most, torque);
        }
    }
    all.into_iter().fold(rest, larger)
}

/// A body that the URDF fixes to the last link and that is not mounted.
pub static NOT_MOUNTED: Law = Law {
    name: "body that is not mounted",
    column: |term, joint, motion| {
        let torque = &motion.rigid.fixed_bodies[joint][term.of[0]];
        Some(torque.iter().map(|value| -value).collect())
    },
    needs_model: true,
    carry: Some(|term, value, carried| {
        let drawn = at_tool(&carried.arm, term.of[0]).parameters();
        for (sum, drawn) in carried.payload.iter_mut().zip(drawn) {
            *sum -= value * drawn;
        }
    }),
    ..Law::PLAIN
};

/// The coefficient of a body that is not mounted. It is one if the body is as the URDF says, and URDFs are wrong.
/// Source: `prove`, seeds 7001 and 7101, in which trying such bodies adds one true name to 120 cases and changes
/// nothing else.
const NOT_MOUNTED_RANGE: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// A body of less than this part of the last link's mass with all that is fixed to it is a part of that link: a cover,
/// a camera. Source: as for [`NOT_MOUNTED_RANGE`].
const LEAST_OF_LAST_LINK: f64 = 0.1;
/// A body that is missing since the recordings from before, and was a part of the last link in the URDF, has at least this part of its
/// mass. A smaller one was a load that only those recordings have. Source: loads of 0.02 and 0.05 kg that were taken off a simulated arm.
const LEAST_REMOVED: f64 = 0.3;
/// The largest mass of a payload as a multiple of the mass of the moving links. Source: first diagnosis.
const MOST_PAYLOAD: f64 = 1.5;
/// The largest distance of a payload's centre of mass from the tool (m), as a share of the arm's reach. Source: first
/// diagnosis.
const PAYLOAD_REACH: f64 = 0.5;
/// A moment has no torque on a joint if 1 kg m or 1 kg m² of it has less than this part of the torque of 1 kg at the tool, or of as much of
/// another moment. Source: π / 2 written as 1.5708 in a URDF turns an axis by 3.7e-6 rad.
const LEAST_FELT: f64 = 1e-4;
/// A coordinate of the centre of mass that is closer to zero has no torque on any joint, so that the fit leaves it at zero (m). No
/// measurement is as close. Source: rounding.
const UNSEEN: f64 = 1e-12;
/// The share of the largest moment of inertia by which another may be negative, for rounding. Source: rounding.
const ROUNDING: f64 = 1e-6;

/// The body with ten inertial parameters about a frame's origin. It need not be physically possible.
pub fn body(parameters: &[f64; 10]) -> Inertia {
    let [mass, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *parameters;
    let com = Vector3::new(hx, hy, hz) / mass;
    let about_origin = tensor([xx, xy, yy, xz, yz, zz]);
    Inertia {
        mass,
        com,
        tensor: about_origin - mass * (Matrix3::identity() * com.norm_squared() - com * com.transpose()),
    }
}

/// The derivatives of the moments of inertia about the origin (xx, xy, yy, xz, yz, zz) of a body with this mass and these first moments,
/// and a fixed tensor about its centre of mass, with respect to the mass and to each first moment (m² and m); zero without a mass.
/// By the parallel axes, the moments are those about the centre of mass plus (|h|² 1 − h hᵀ) / m.
pub fn moments_by_first(mass: f64, first: Vector3<f64>) -> [[f64; 6]; 4] {
    if mass == 0.0 {
        return [[0.0; 6]; 4];
    }
    let com = first / mass;
    let along = |k: usize| {
        let axis = Vector3::ith(k, 1.0);
        Matrix3::identity() * (2.0 * com[k]) - axis * com.transpose() - com * axis.transpose()
    };
    let of_mass = com * com.transpose() - Matrix3::identity() * com.norm_squared();
    [of_mass, along(0), along(1), along(2)].map(|by| entries(&by))
}

/// Whether a body may have this tensor. A missing body has a negative mass and the negative of a tensor.
pub fn exists(mass: f64, tensor: &Matrix3<f64>) -> bool {
    second_moments(&(tensor * mass.signum())).symmetric_eigenvalues().min() >= 0.0
}

/// The payload that the absence of the `k`-th fixed body is: negative, with the URDF's centre of mass.
fn read_not_mounted(effect: Effect, estimate: &mut dyn Estimate, k: usize) -> Option<Effect> {
    let drawn = at_tool(estimate.arm(), k);
    let place = estimate.place(0)?;
    let mass = estimate.note("mass", |draw| -draw[place] * drawn.mass);
    for (axis, key) in ["com_x", "com_y", "com_z"].into_iter().enumerate() {
        estimate.note(key, |_| drawn.com[axis]);
    }
    let tensor = drawn.tensor * (mass / drawn.mass);
    let inertia = entries(&tensor);
    let com: [f64; 3] = drawn.com.into();
    let effect = effect.with("mass", mass).with("com", com);
    Some(effect.with("inertia", inertia).since(estimate.onset()))
}

/// The body of a payload.
pub fn payload_body(effect: &Effect) -> Inertia {
    Inertia { mass: effect.number("mass"), com: effect.vector("com"), tensor: tensor(effect.list("inertia")) }
}

/// The `k`-th body that the URDF fixes to the last link, in the tool's frame.
fn at_tool(arm: &Arm, k: usize) -> Inertia {
    let tool_from_link = arm.tool_frame().link_from_frame.inverse();
    arm.fixed_bodies()[k].inertia.transformed(&tool_from_link)
}

fn columns(law: &'static Law, count: usize) -> Vec<Term> {
    (0..count).map(|parameter| Term::about(law, parameter)).collect()
}

fn with_moments() -> Vec<Term> {
    columns(&PARAMETER, 10)
}

fn without_moments() -> Vec<Term> {
    columns(&WITHOUT_MOMENTS, 4)
}

/// The least reach of an arm (m), which limits the distance of a payload.
const LEAST_REACH: f64 = 0.2;

/// The sum of the distances from joint to joint (m).
fn reach(arm: &Arm) -> f64 {
    let links: f64 = arm.joints().iter().map(|joint| joint.parent_from_joint.translation.norm()).sum();
    (links + arm.tool_frame().link_from_frame.translation.norm()).max(LEAST_REACH)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::agree;

    /// The axis of the joint is vertical to the digits of a URDF.
    #[test]
    fn a_first_moment_without_torque_has_no_column() {
        let tilt = 3.7e-6;
        let mut columns = vec![vec![0.3, -0.2], vec![0.5, -0.4], vec![0.1, 0.2], vec![9.81 * tilt, -9.81 * tilt]];
        columns.extend(vec![vec![0.0; 2]; 6]);
        let column = |parameter: usize| felt(&columns, parameter, &columns[parameter]);
        assert_eq!(column(3), [0.0, 0.0]);
        (0..3).for_each(|parameter| assert_eq!(column(parameter), columns[parameter]));
    }

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&PAYLOAD).with("mass", 1.5).with("com", [0.1, 0.2, 0.0]);
        let first = [1.5, 0.15, 0.3];
        let com = [0.1, 0.2];
        // About the tool's origin, by the parallel axes.
        let second = [
            (4, 1.5 * com[1] * com[1]),
            (5, -1.5 * com[0] * com[1]),
            (6, 1.5 * com[0] * com[0]),
            (9, 1.5 * (com[0] * com[0] + com[1] * com[1])),
        ];
        let first = first.into_iter().enumerate();
        let columns: Vec<_> =
            first.chain(second).map(|(parameter, value)| (Term::about(&PARAMETER, parameter), value)).collect();
        agree(&effect, &columns);
    }
}
