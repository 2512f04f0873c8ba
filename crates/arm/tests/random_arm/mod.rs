//! Arms at random: their URDF, and a state of motion.

use std::fmt::Write;

use arm::{Arm, Inertia, Vector3};
use nalgebra::{Matrix3, Rotation3};
use proptest::prelude::*;

#[path = "../../../../tests/properties.rs"]
mod properties;
pub use properties::config;

/// The position (m) and the orientation (roll, pitch, yaw, rad) of a frame in its parent.
type Origin = ([f64; 3], [f64; 3]);

/// A joint, the link that it carries, and how they move.
#[derive(Clone, Debug)]
pub struct Body {
    pub slides: bool,
    pub origin: Origin,
    pub axis: [f64; 3],
    pub mass: f64,
    pub com: [f64; 3],
    /// The radii of gyration along the principal axes (m), and the orientation of these axes (rad).
    pub spread: Origin,
    pub rotor: f64,
    /// Position, velocity and acceleration.
    pub motion: [f64; 3],
}

/// An arm that moves.
#[derive(Clone, Debug)]
pub struct Case {
    pub bodies: Vec<Body>,
    pub gravity: [f64; 3],
    /// A fixed joint between the base and the first joint.
    pub stand: Option<Origin>,
    /// A fixed joint in every link: the inertia is that of the link beyond it.
    pub cut: Option<Origin>,
}

impl Case {
    /// Positions, velocities and accelerations of all joints.
    pub fn state(&self) -> [Vec<f64>; 3] {
        [0, 1, 2].map(|k| self.bodies.iter().map(|body| body.motion[k]).collect())
    }
}

fn origins(reach: f64) -> impl Strategy<Value = Origin> {
    (prop::array::uniform3(-reach..reach), prop::array::uniform3(-3.0..3.0_f64))
}

fn bodies() -> impl Strategy<Value = Body> {
    let axis = prop::array::uniform3(-1.0..1.0_f64)
        .prop_filter("an axis has a length", |axis| Vector3::from(*axis).norm() > 0.1);
    (
        any::<bool>(),
        origins(0.6),
        axis,
        0.1..20.0_f64,
        prop::array::uniform3(-0.3..0.3_f64),
        (prop::array::uniform3(0.02..0.3_f64), prop::array::uniform3(-3.0..3.0_f64)),
        0.0..2.0_f64,
        [-3.0..3.0_f64, -2.0..2.0_f64, -5.0..5.0_f64],
    )
        .prop_map(|(slides, origin, axis, mass, com, spread, rotor, motion)| Body {
            slides,
            origin,
            axis,
            mass,
            com,
            spread,
            rotor,
            motion,
        })
}

/// Arms of 1 to 10 joints, with gravity in any direction.
pub fn cases() -> impl Strategy<Value = Case> {
    let arms = prop::collection::vec(bodies(), 1..=10);
    (arms, prop::array::uniform3(-10.0..10.0_f64)).prop_map(|(bodies, gravity)| Case {
        bodies,
        gravity,
        stand: None,
        cut: None,
    })
}

fn written(([x, y, z], [roll, pitch, yaw]): Origin) -> String {
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

/// The `<inertial>` of a body, in its own frame or in one that a fixed joint carries.
fn inertial(body: &Body, cut: Option<Origin>) -> String {
    let turn = |rpy: [f64; 3]| *Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]).matrix();
    let axes = turn(body.spread.1);
    let squares = Vector3::from(body.spread.0).map(|spread| spread * spread);
    let second = body.mass * axes * Matrix3::from_diagonal(&squares) * axes.transpose();
    let mut tensor = Matrix3::from_diagonal_element(second.trace()) - second;
    let mut com = Vector3::from(body.com);
    if let Some((xyz, rpy)) = cut {
        let inverse = turn(rpy).transpose();
        com = inverse * (com - Vector3::from(xyz));
        tensor = inverse * tensor * inverse.transpose();
    }
    let mass = body.mass;
    Inertia { mass, com, tensor }.to_urdf()
}

/// The arm as URDF.
pub fn urdf(case: &Case) -> String {
    let mut text = "<robot name=\"random\"><link name=\"base\"/>".to_owned();
    let mut parent = "base".to_owned();
    if let Some(stand) = case.stand {
        let place = written(stand);
        let _ = write!(
            text,
            "<link name=\"stand\"/><joint name=\"on\" type=\"fixed\">{place}<parent link=\"base\"/><child link=\"stand\"/></joint>"
        );
        parent = "stand".to_owned();
    }
    for (k, body) in case.bodies.iter().enumerate() {
        let kind = if body.slides { "prismatic" } else { "revolute" };
        let (place, [x, y, z]) = (written(body.origin), body.axis);
        let _ = write!(
            text,
            "<joint name=\"j{k}\" type=\"{kind}\">{place}<parent link=\"{parent}\"/><child link=\"l{k}\"/><axis xyz=\"{x} {y} {z}\"/>\
             <limit lower=\"-9\" upper=\"9\" effort=\"1e6\" velocity=\"100\"/></joint>"
        );
        parent = format!("l{k}");
        let inertial = inertial(body, case.cut);
        let _ = match case.cut {
            None => write!(text, "<link name=\"l{k}\">{inertial}</link>"),
            Some(cut) => write!(
                text,
                "<link name=\"l{k}\"/><link name=\"b{k}\">{inertial}</link><joint name=\"c{k}\" type=\"fixed\">{}\
                 <parent link=\"l{k}\"/><child link=\"b{k}\"/></joint>",
                written(cut)
            ),
        };
    }
    text + "</robot>"
}

/// The arm that the URDF describes, with the gravity and the rotors of `case`.
pub fn read(text: &str, case: &Case) -> Arm {
    let rotors: Vec<f64> = case.bodies.iter().map(|body| body.rotor).collect();
    Arm::from_urdf_text(text, "random.urdf")
        .unwrap_or_else(|error| panic!("{error}: {text}"))
        .with_gravity(Vector3::from(case.gravity))
        .with_rotor_inertias(&rotors)
}

/// The arm of `case`.
pub fn arm(case: &Case) -> Arm {
    read(&urdf(case), case)
}
