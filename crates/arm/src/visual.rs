//! The visual shapes of a URDF.

use crate::pose::Pose;

/// A shape; lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A box with its full side lengths.
    Box([f64; 3]),
    /// A cylinder along z, centred.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Full length (m).
        length: f64,
    },
    /// A sphere, centred.
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// A mesh file, as the URDF names it (`package://…`, or relative to the URDF).
    Mesh {
        /// The name in the URDF.
        file: String,
        /// Scale along each axis.
        scale: [f64; 3],
    },
}

/// One `<visual>` of a URDF.
#[derive(Clone, Debug, PartialEq)]
pub struct Visual {
    /// The moving link that it is fixed to, as an index into [`crate::Arm::joints`]; `None` is the base.
    pub link: Option<usize>,
    /// Its pose in that link's frame.
    pub link_from_visual: Pose,
    /// Its shape.
    pub geometry: Geometry,
    /// Red, green, blue and opacity, 0 to 1, where the URDF gives them.
    pub colour: Option<[f64; 4]>,
}
