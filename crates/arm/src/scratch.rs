//! Intermediate results of the recursions, one entry per joint.

mod articulated;
mod link_motion;
mod link_pose;
mod tangent;

pub(crate) use articulated::Articulated;
pub(crate) use link_motion::LinkMotion;
pub(crate) use link_pose::LinkPose;
pub(crate) use tangent::{Body, Spatial, Tangent};

use crate::real::Real;
use crate::small::Vec3;

/// Intermediate results of the recursions, one entry per joint.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<T> {
    pub places: Vec<LinkPose<T>>,
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
            places: vec![LinkPose::zeros(context); dof],
            motions: vec![LinkMotion::zeros(context); dof],
            articulated: vec![Articulated::zeros(context); dof],
            twists: vec![(zero, zero); dof],
            tangents: vec![Tangent::zeros(context); dof],
        }
    }
}
