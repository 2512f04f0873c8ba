//! What the algorithms write while they run, kept by the caller so that no call allocates.

use nalgebra::{Matrix3, Vector3};

use crate::derivatives::Tangent;
use crate::model::Arm;
use crate::pose::Pose;

/// Scratch of one link; vectors are in the link's own frame unless they say otherwise.
#[derive(Clone, Debug)]
pub(crate) struct LinkState {
    pub parent_from_link: Pose,
    pub base_from_link: Pose,
    /// ω, ω̇ (rad/s, rad/s²).
    pub angular_velocity: Vector3<f64>,
    pub angular_acceleration: Vector3<f64>,
    /// [ω̇]× + [ω]×²: the acceleration of a point beyond that of the origin, per metre (1/s²).
    pub field: Matrix3<f64>,
    /// v̇ of the frame's origin less gravity (m/s²).
    pub linear_acceleration: Vector3<f64>,
    /// f, τ that the parent exerts on the link, about the frame's origin (N, N m).
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
    /// Composite or articulated inertia in blocks: [n; f] = [I H; Hᵀ M] [ω̇; v̇].
    pub rotational: Matrix3<f64>,
    pub coupling: Matrix3<f64>,
    pub translational: Matrix3<f64>,
    /// Featherstone's U = I^A S, D = Sᵀ U, u = τ − Sᵀ p^A, and the velocity product c.
    pub u_moment: Vector3<f64>,
    pub u_force: Vector3<f64>,
    pub d: f64,
    pub u: f64,
    pub c_angular: Vector3<f64>,
    pub c_linear: Vector3<f64>,
}

/// Scratch for the algorithms on one [`Arm`]; make it once, pass it to every call.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(crate) links: Vec<LinkState>,
    /// The unit motions of the joints in one link's frame: angular and linear part.
    pub(crate) twists: Vec<(Vector3<f64>, Vector3<f64>)>,
    pub(crate) tangents: Vec<Tangent>,
    pub(crate) zeros: Vec<f64>,
}

impl Workspace {
    /// Scratch for `arm` and any other arm with as many joints.
    pub fn new(arm: &Arm) -> Self {
        let zero = Vector3::zeros();
        let link = LinkState {
            parent_from_link: Pose::identity(),
            base_from_link: Pose::identity(),
            angular_velocity: zero,
            angular_acceleration: zero,
            field: Matrix3::zeros(),
            linear_acceleration: zero,
            force: zero,
            moment: zero,
            rotational: Matrix3::zeros(),
            coupling: Matrix3::zeros(),
            translational: Matrix3::zeros(),
            u_moment: zero,
            u_force: zero,
            d: 0.0,
            u: 0.0,
            c_angular: zero,
            c_linear: zero,
        };
        Self {
            links: vec![link; arm.dof()],
            twists: vec![(zero, zero); arm.dof()],
            tangents: vec![Tangent::zero(); arm.dof()],
            zeros: vec![0.0; arm.dof()],
        }
    }

    /// Checks that this workspace and the joint vectors fit the arm.
    pub(crate) fn check(&self, arm: &Arm, vectors: &[&[f64]]) {
        let n = arm.dof();
        assert_eq!(self.links.len(), n, "the workspace was made for another arm");
        for vector in vectors {
            assert_eq!(vector.len(), n, "a joint vector has one entry a joint");
        }
    }
}
