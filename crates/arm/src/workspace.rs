//! Memory that the algorithms write to, kept by the caller so that no call allocates.

use crate::derivatives::Tangent;
use crate::forward_dynamics::Articulated;
use crate::inverse_dynamics::LinkMotion;
use crate::model::Arm;
use crate::place::Place;
use crate::pose::Pose;
use crate::real::Real;
use crate::small::Vec3;

/// Intermediate results of the recursions, one entry per joint.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<T> {
    /// q and its sine and cosine.
    pub turns: Vec<(T, T, T)>,
    pub places: Vec<Place<T>>,
    pub motions: Vec<LinkMotion<T>>,
    pub articulated: Vec<Articulated<T>>,
    /// The unit motions of the joints in one link's frame: angular and linear part.
    pub twists: Vec<(Vec3<T>, Vec3<T>)>,
    pub tangents: Vec<Tangent<T>>,
}

impl<T: Real> Scratch<T> {
    pub fn new(context: T::Context, dof: usize) -> Self {
        let zero = Vec3::zeros(context);
        Self {
            turns: vec![(zero.x, zero.x, zero.x); dof],
            places: vec![Place::zeros(context); dof],
            motions: vec![LinkMotion::zeros(context); dof],
            articulated: vec![Articulated::zeros(context); dof],
            twists: vec![(zero, zero); dof],
            tangents: vec![Tangent::zeros(context); dof],
        }
    }
}

/// Scratch for the algorithms on one [`Arm`]; make it once and pass it to every call.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(crate) scratch: Scratch<f64>,
    pub(crate) base_from_link: Vec<Pose>,
    pub(crate) zeros: Vec<f64>,
}

impl Workspace {
    /// Scratch for `arm`, or for any other arm with the same number of joints.
    pub fn new(arm: &Arm) -> Self {
        Self {
            scratch: Scratch::new((), arm.dof()),
            base_from_link: vec![Pose::identity(); arm.dof()],
            zeros: vec![0.0; arm.dof()],
        }
    }

    /// Checks that this workspace and the joint vectors have the arm's number of joints.
    pub(crate) fn check(&self, arm: &Arm, vectors: &[&[f64]]) {
        let n = arm.dof();
        assert_eq!(self.base_from_link.len(), n, "the workspace was made for another arm");
        for vector in vectors {
            assert_eq!(vector.len(), n, "a joint vector has one entry per joint");
        }
    }
}
