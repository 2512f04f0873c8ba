//! Bodies of links that are placeholders in a URDF.

use nalgebra::{Matrix3, Vector3};

use crate::inertia::Inertia;
use crate::joint::{Joint, JointKind};
use crate::model::Arm;

/// The length of an arm below which its links are not compared with it (m).
pub(crate) const LEAST_REACH: f64 = 0.05;
/// The radius of gyration, over the arm's length, beyond which three equal moments of inertia are a placeholder. Source: simulated arms
/// with 1 kg m² on every link of 0.1 to 2.4 kg, where it is 0.39 and more.
const LARGE: f64 = 0.25;
/// The relative difference of moments up to which they are the same number. Source: rounding.
const SAME: f64 = 1e-6;
/// The least radius of gyration of a body that is taken in the place of a placeholder (m). Source: links of the wrists of a UR5 and a Panda.
const LEAST_RADIUS: f64 = 0.04;

/// A link of whose body the URDF has a placeholder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placeholder {
    /// The link, as an index into [`Arm::joints`].
    pub link: usize,
    /// Its mass (kg): the URDF's, or the median link's if the URDF has none.
    pub mass: f64,
    /// Its length from its frame to the next joint or the tool (m).
    pub length: f64,
}

impl Arm {
    /// The links of whose body the URDF has a placeholder: those whose centre of mass is exactly at the origin of their own frame, if they
    /// are longer than `length` (m), because the true one is somewhere along the link, and those with less than `part` of the median
    /// link's mass, because their body is missing. A first link about a vertical axis, of which only the moment of inertia counts, is left
    /// out.
    pub fn placeholders(&self, length: f64, part: f64) -> Vec<Placeholder> {
        let mut masses: Vec<f64> =
            self.joints.iter().map(|joint| joint.inertia.mass).filter(|&mass| mass > 0.0).collect();
        masses.sort_by(f64::total_cmp);
        let usual = masses.get(masses.len() / 2).copied().unwrap_or(0.0);
        let lengths = self.lengths().into_iter().enumerate();
        let first = &self.joints[0];
        let axis = first.parent_from_joint.rotation * first.axis;
        let is_upright = axis.cross(&self.gravity).norm() < 1e-3 * self.gravity.norm();
        let counts = |link: usize| link > 0 || !(is_upright && first.kind == JointKind::Revolute);
        let placeholder = |(link, of_link): (usize, f64)| {
            let body = &self.joints[link].inertia;
            let is_missing = body.mass < part * usual;
            let has_no_centre = body.mass > 0.0 && body.com == Vector3::zeros() && of_link > length;
            let mass = if is_missing { usual } else { body.mass };
            (counts(link) && (is_missing || has_no_centre)).then_some(Placeholder { link, mass, length: of_link })
        };
        lengths.filter_map(placeholder).collect()
    }

    /// The bodies for links whose moments of inertia are a placeholder, with the links as indices into [`Self::joints`]: all three have one
    /// number that another link has, too, such as 1 kg m², and one of these links has a radius of gyration that is large for the arm. Large
    /// moments that differ may be those of drives. A body has the URDF's mass and centre of mass, and the radius of gyration of a rod as long as the link.
    pub fn bodies_for_placeholders(&self) -> Vec<(usize, Inertia)> {
        let reach = self.reach();
        let is_same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
        let extremes = |joint: &Joint| {
            let moments = joint.inertia.tensor.symmetric_eigenvalues();
            (moments.min(), moments.max())
        };
        let is_large = |joint: &Joint| gyration(&joint.inertia).is_some_and(|radius| radius > LARGE * reach);
        // The number: all moments of two links at least, one of which is too large for the arm.
        let equal = |joint: &&Joint| matches!(extremes(joint), (least, most) if most > 0.0 && is_same(least, most));
        let numbers: Vec<(f64, bool)> =
            self.joints.iter().filter(equal).map(|joint| (extremes(joint).1, is_large(joint))).collect();
        let is_placeholder = |&(number, is_large): &(f64, bool)| {
            is_large && numbers.iter().filter(|(other, _)| is_same(number, *other)).count() > 1
        };
        let Some(&(number, _)) = numbers.iter().find(|this| is_placeholder(this)).filter(|_| reach > LEAST_REACH)
        else {
            return Vec::new();
        };
        let links = self.joints.iter().zip(self.lengths()).enumerate();
        let body = |(link, (joint, length)): (usize, (&Joint, f64))| {
            let body = joint.inertia;
            let (least, most) = extremes(joint);
            // Bodies that are fixed to a link add theirs to its moments.
            let has_it = is_same(least, number) && is_same(most, number) || least >= number && is_large(joint);
            let radius = (length.max(2.0 * body.com.norm()) / 12f64.sqrt()).max(LEAST_RADIUS);
            let tensor = Matrix3::identity() * (body.mass * radius * radius);
            has_it.then_some((link, Inertia { tensor, ..body }))
        };
        links.filter_map(body).collect()
    }

    /// The length of each link from its frame to the next joint or the tool (m).
    fn lengths(&self) -> Vec<f64> {
        let tool = self.tool_frame().link_from_frame;
        let ends = self.joints[1..].iter().map(|next| &next.parent_from_joint);
        ends.chain(std::iter::once(&tool)).map(|end| end.translation.norm()).collect()
    }

    /// The length of the arm with all its links' centres of mass and travels in one line (m).
    pub(crate) fn reach(&self) -> f64 {
        let length = |joint: &Joint| {
            let travel = joint.limits.upper - joint.limits.lower;
            let is_finite = joint.kind == JointKind::Prismatic && travel.is_finite();
            let slides = if is_finite { travel } else { 0.0 };
            joint.parent_from_joint.translation.norm() + joint.inertia.com.norm() + slides
        };
        self.tool_frame().link_from_frame.translation.norm() + self.joints.iter().map(length).sum::<f64>()
    }

    /// The largest radius of gyration of a link, and the length of the arm (m), if the link is larger than the arm.
    pub(crate) fn larger_than_the_arm(&self, joint: &Joint) -> Option<(f64, f64)> {
        let reach = self.reach();
        gyration(&joint.inertia).filter(|&radius| reach > LEAST_REACH && radius > reach).map(|radius| (radius, reach))
    }
}

/// The largest radius of gyration of a body about its centre of mass (m); `None` without mass.
pub(crate) fn gyration(body: &Inertia) -> Option<f64> {
    (body.mass > 0.0).then(|| (body.tensor.symmetric_eigenvalues().max().max(0.0) / body.mass).sqrt())
}
