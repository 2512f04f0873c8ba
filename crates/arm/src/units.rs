//! Units of a URDF that its own numbers put into doubt.

use crate::joint::{Joint, JointKind};
use crate::model::Arm;
use crate::placeholder::{LEAST_REACH, gyration};

/// The length of an arm with all joints in one line that is in millimetres (m). Source: the longest arm, on a space station, has 17 m.
const LONGEST: f64 = 100.0;
/// The distance of a centre of mass from its joint that is in millimetres, over the arm's length without centres of mass, and in metres:
/// both must be exceeded. Source: a crane's boom, which is one link of 10 m.
const FAR_COM: (f64, f64) = (10.0, 10.0);
/// The mass of an arm over the cube of its length with all links in one line, beyond which the masses are in grams (kg/m³). Source: the
/// robots of example-robot-data and of ten published recordings have at most 28.
const DENSEST: f64 = 1000.0;
/// The number of joints, all revolute, from which an arm is slender enough to be judged by its mass, and its least length (m). Source: a
/// carriage may be as heavy as it is short, and so may a turntable.
const SLENDER: (usize, f64) = (3, 0.2);
/// The radius of gyration over the arm's length, beyond which moments of inertia are in another unit if most links have such. Source: a
/// placeholder of 1 kg m² on a link of 0.15 kg has 2.6 m, and kg mm² give a thousand times the true radius.
const LARGE_BODY: f64 = 3.0;
/// The largest radius of gyration over the arm's length, below which moments of inertia are in another unit, or those of points.
/// Source: the robots of example-robot-data, with all their limbs in one line, have 0.011 and more.
const SMALL_BODY: f64 = 0.005;

impl Arm {
    /// What no arm of this size has: lengths, centres of mass, masses and moments of inertia that are probably not in m, kg and kg m².
    /// Each is a sentence with the numbers. Dynamics with such a model are meaningless.
    pub fn doubtful_units(&self) -> Vec<String> {
        // Where the base stands does not matter.
        let between: f64 = self.joints[1..].iter().map(|joint| joint.parent_from_joint.translation.norm()).sum();
        let line = between + self.tool_frame().link_from_frame.translation.norm();
        if line > LONGEST {
            return vec![format!(
                "its lengths seem to be in mm: the joints are {line:.0} m apart in one line. A URDF has m, kg and kg m²"
            )];
        }
        let distance = |joint: &&Joint| joint.inertia.com.norm();
        let farthest = self.joints.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)));
        let (times, metres) = FAR_COM;
        let is_far = |joint: &&Joint| distance(joint) > metres.max(times * line);
        if let Some(joint) = farthest.filter(is_far) {
            return vec![format!(
                "its centres of mass seem to be in mm: that of {} is {:.0} m from its frame, and the arm's joints are {line:.2} m apart in \
                 one line. A URDF has m",
                joint.link_name,
                distance(&joint)
            )];
        }
        [self.heavy(), self.large_bodies()].into_iter().flatten().collect()
    }

    /// The sentence on masses that are too large for the arm.
    fn heavy(&self) -> Option<String> {
        let (least_joints, least_length) = SLENDER;
        let (mass, reach) = (self.joints.iter().map(|joint| joint.inertia.mass).sum::<f64>(), self.reach());
        let is_slender = self.dof() >= least_joints
            && reach > least_length
            && self.joints.iter().all(|joint| joint.kind == JointKind::Revolute);
        (is_slender && mass > DENSEST * reach.powi(3)).then(|| {
            format!(
                "its masses seem to be in g: the links weigh {mass:.0} kg together, and the arm with all its links in one line is \
                 {reach:.2} m long. A URDF has kg"
            )
        })
    }

    /// The sentence on moments of inertia that are too large for the arm on most links.
    fn large_bodies(&self) -> Option<String> {
        let (radii, largest, reach) = self.radii()?;
        let large = radii.iter().filter(|&&radius| radius > LARGE_BODY * reach).count();
        (large > 1 && 2 * large > radii.len()).then(|| {
            format!(
                "its moments of inertia seem to be in kg mm² or g m²: the links would be bodies with radii of gyration of up to \
                 {largest:.0} m, and the arm with all its links in one line is {reach:.2} m long. A URDF has kg m²"
            )
        })
    }

    /// The warning that all moments of inertia are those of bodies that are much smaller than the arm.
    pub(crate) fn small_bodies(&self) -> Option<String> {
        let (radii, largest, reach) = self.radii()?;
        (radii.len() > 1 && largest > 0.0 && largest < SMALL_BODY * reach).then(|| {
            format!(
                "the moments of inertia of all links are those of bodies with radii of gyration of at most {:.2} mm, and the arm with all its \
                 links in one line is {reach:.2} m long: are they in another unit than kg m²? correct <inertia>, unless the masses stand \
                 for points",
                1e3 * largest
            )
        })
    }

    /// The radii of gyration of the links with a mass, the largest one, and the length of the arm (m); `None` for an arm without a length.
    fn radii(&self) -> Option<(Vec<f64>, f64, f64)> {
        let reach = self.reach();
        let radii: Vec<f64> = self.joints.iter().filter_map(|joint| gyration(&joint.inertia)).collect();
        let largest = radii.iter().copied().fold(0.0, f64::max);
        (reach > LEAST_REACH).then_some((radii, largest, reach))
    }
}
