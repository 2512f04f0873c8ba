//! Reading an [`Arm`] from a URDF.

mod checks;
mod choose;
mod fixed;
mod inertial;
mod lines;
mod mimic;
mod spelling;
mod syntax;
mod why;

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use self::choose::Chain;
use self::fixed::{Attached, removable};
use crate::chain::{self, ChainOptions};
use crate::error::ArmError;
use crate::inertia::{Inertia, Moments};
use crate::joint::{Joint, JointKind, Limits};
use crate::model::{Arm, Frame, STANDARD_GRAVITY};
use crate::pose::{Pose, cross_matrix};
use crate::visual::{Geometry, Visual};

impl Arm {
    /// Reads a serial arm of revolute and prismatic joints from the URDF file at `path`, with the default
    /// [`ChainOptions`].
    ///
    /// Links beyond fixed joints are merged into the link that carries them. Gravity is 9.81 m/s² along −z of the root
    /// link.
    ///
    /// # Errors
    /// [`ArmError`] with the line and the element, if the file cannot be read, is not a URDF, has more than one chain
    /// of moving joints, contains loops, or floating or planar joints in the chain, or has inertias that are
    /// physically impossible.
    pub fn from_urdf(path: impl AsRef<Path>) -> Result<Self, ArmError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| ArmError::Read { path: path.to_owned(), source })?;
        Self::from_urdf_text(&text, path)
    }

    /// Reads an arm from text; `path` is its name in errors.
    ///
    /// # Errors
    /// Those of [`Self::from_urdf`].
    pub fn from_urdf_text(text: &str, path: impl AsRef<Path>) -> Result<Self, ArmError> {
        Self::from_urdf_chain(text, path, &ChainOptions::default())
    }

    /// [`Self::from_urdf_text`] with the joints that `options` choose. Links beyond joints that are fixed for that
    /// reason are merged like those beyond the URDF's fixed joints; a note in [`Self::warnings`] names the joints. If
    /// a base is chosen, gravity has its direction in that link's frame.
    ///
    /// # Errors
    /// Those of [`Self::from_urdf`], or if the URDF does not have what `options` name.
    pub fn from_urdf_chain(text: &str, path: impl AsRef<Path>, options: &ChainOptions) -> Result<Self, ArmError> {
        let path = path.as_ref();
        let text = syntax::Text::of(text, path)?;
        spelling::check(&text.blanked, path)?;
        let robot = urdf_rs::read_from_string(&text.blanked).map_err(|error| text.explain(path, &error))?;
        Reader { path, text: &text.blanked, robot: &robot }.read(options)
    }
}

struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    robot: &'a urdf_rs::Robot,
}

/// A link beyond fixed joints.
struct WeldedFrame {
    name: String,
    pose: Pose,
    /// Whether all joints up to it are fixed in the URDF itself.
    is_rigid: bool,
}

/// Links that are fixed to each other, as one body in the frame of the first one.
struct Body<'a> {
    inertia: Inertia,
    /// Each link but the first one, after the link that carries it.
    attached: Vec<Attached>,
    frames: Vec<WeldedFrame>,
    visuals: Vec<(Pose, &'a urdf_rs::Visual)>,
    /// The moving joints that begin at these links, with the pose of their parent link.
    moving: Vec<(Pose, &'a urdf_rs::Joint)>,
}

impl<'a> Reader<'a> {
    fn read(&self, options: &ChainOptions) -> Result<Arm, ArmError> {
        let root = self.check_tree()?;
        let chain = self.choose(root, options)?;
        let mut arm = Arm {
            name: self.robot.name.clone(),
            base_link: chain.base.to_owned(),
            joints: Vec::new(),
            frames: Vec::new(),
            tool: None,
            fixed_bodies: Vec::new(),
            fixed_joints: Vec::new(),
            visuals: Vec::new(),
            gravity: self.gravity(root, &chain)?,
            warnings: chain::note(&chain.fixed).into_iter().chain(chain.warnings.clone()).collect(),
        };
        let mut body = self.weld(chain.base, &chain)?;
        loop {
            let link = arm.joints.len().checked_sub(1);
            arm.tool = None;
            for frame in body.frames.drain(..) {
                let is_tool = chain.tip.map_or(frame.is_rigid, |tip| frame.name == tip);
                if is_tool {
                    arm.tool = Some(arm.frames.len());
                }
                arm.frames.push(Frame { name: frame.name, link, link_from_frame: frame.pose });
            }
            for (pose, visual) in body.visuals.drain(..) {
                arm.visuals.push(visual_of(link, &pose, visual));
            }
            let Some((link_from_parent, urdf_joint)) = body.moving.pop() else {
                arm.fixed_bodies = removable(&body.attached, body.inertia.mass);
                break;
            };
            body = self.weld(&urdf_joint.child.link, &chain)?;
            arm.joints.push(self.joint(&link_from_parent, urdf_joint, body.inertia)?);
            self.check_tensor(&mut arm)?;
        }
        if arm.joints.is_empty() {
            return Err(self.robot_error(
                "has no joint that moves".into(),
                "an arm needs at least one revolute, continuous or prismatic joint",
            ));
        }
        self.check_masses(&mut arm)?;
        arm.fixed_joints = chain.fixed;
        Ok(arm)
    }

    /// Gravity in the frame of the chain's base: 9.81 m/s² along −z of the root.
    fn gravity(&self, root: &str, chain: &Chain<'_>) -> Result<Vector3<f64>, ArmError> {
        let mut root_from_base = Pose::identity();
        for joint in self.path(chain.base, root).unwrap_or_default() {
            let position = chain.position(&joint.name).unwrap_or(0.0);
            root_from_base = root_from_base.compose(&self.fixed_pose(joint, position)?);
        }
        let down = Vector3::new(0.0, 0.0, -STANDARD_GRAVITY);
        Ok(root_from_base.rotation.transpose() * down)
    }

    /// The body that `first` and all links beyond its fixed joints form, in `first`'s frame.
    fn weld(&self, first: &'a str, chain: &Chain<'_>) -> Result<Body<'a>, ArmError> {
        let mut body = Body {
            inertia: Inertia::zero(),
            attached: Vec::new(),
            frames: Vec::new(),
            visuals: Vec::new(),
            moving: Vec::new(),
        };
        let mut waiting = vec![(Pose::identity(), first, true, None)];
        while let Some((body_from_link, name, is_rigid, carried_by)) = waiting.pop() {
            let link = self.robot.links.iter().find(|link| link.name == name);
            let Some(link) = link else { continue };
            let inertia = self.inertia(link)?.transformed(&body_from_link);
            body.inertia = body.inertia.merged(&inertia);
            if name != first {
                body.attached.push(Attached { name: name.to_owned(), carried_by, inertia });
                body.frames.push(WeldedFrame { name: name.to_owned(), pose: body_from_link, is_rigid });
            }
            let place = body.attached.len().checked_sub(1);
            body.visuals.extend(link.visual.iter().map(|visual| (body_from_link, visual)));
            for joint in self.robot.joints.iter().filter(|joint| joint.parent.link == name) {
                match chain.position(&joint.name) {
                    None => body.moving.push((body_from_link, joint)),
                    Some(position) => {
                        let origin = self.fixed_pose(joint, position)?;
                        let is_rigid = is_rigid && joint.joint_type == urdf_rs::JointType::Fixed;
                        waiting.push((body_from_link.compose(&origin), &joint.child.link, is_rigid, place));
                    }
                }
            }
        }
        Ok(body)
    }

    /// The pose of a joint's child link in its parent with the joint at `position` (rad or m).
    fn fixed_pose(&self, joint: &urdf_rs::Joint, position: f64) -> Result<Pose, ArmError> {
        let origin = self.finite_pose(joint)?;
        if position == 0.0 {
            return Ok(origin);
        }
        let axis = self.axis(joint)?;
        Ok(origin.compose(&match choose::kind(joint) {
            JointKind::Revolute => Pose {
                rotation: *Rotation3::from_axis_angle(&Unit::new_unchecked(axis), position).matrix(),
                translation: Vector3::zeros(),
            },
            JointKind::Prismatic => Pose { rotation: Matrix3::identity(), translation: axis * position },
        }))
    }

    /// The unit vector along a joint's axis.
    fn axis(&self, joint: &urdf_rs::Joint) -> Result<Vector3<f64>, ArmError> {
        let axis = Vector3::from(*joint.axis.xyz);
        if axis.norm().is_finite() && axis.norm() > 1e-9 {
            return Ok(axis.normalize());
        }
        let reason = format!("has the axis {:?}", *joint.axis.xyz);
        Err(self.joint_error(joint, reason, "give it a direction"))
    }

    fn joint(&self, link_from_parent: &Pose, urdf: &urdf_rs::Joint, inertia: Inertia) -> Result<Joint, ArmError> {
        let parent_from_joint = link_from_parent.compose(&self.finite_pose(urdf)?);
        let axis = self.axis(urdf)?;
        let limit = &urdf.limit;
        for (what, value) in
            [("lower", limit.lower), ("upper", limit.upper), ("effort", limit.effort), ("velocity", limit.velocity)]
        {
            if value.is_nan() || (value < 0.0 && matches!(what, "effort" | "velocity")) {
                return Err(self.joint_error(
                    urdf,
                    format!("has the {what} limit {value}"),
                    "give a number that is not negative",
                ));
            }
        }
        // The parser returns 0 for a limit that is not given.
        let or_none = |limit: f64| if limit > 0.0 { limit } else { f64::INFINITY };
        let unbounded = urdf.joint_type == urdf_rs::JointType::Continuous || (limit.lower == 0.0 && limit.upper == 0.0);
        if limit.lower > limit.upper && !unbounded {
            return Err(self.joint_error(
                urdf,
                format!("has its lower limit {} above its upper one {}", limit.lower, limit.upper),
                "swap them",
            ));
        }
        let (damping, friction) = urdf.dynamics.as_ref().map_or((0.0, 0.0), |d| (d.damping, d.friction));
        let r0 = parent_from_joint.rotation;
        let a = cross_matrix(&axis);
        Ok(Joint {
            name: urdf.name.clone(),
            link_name: urdf.child.link.clone(),
            kind: choose::kind(urdf),
            parent_from_joint,
            axis,
            limits: Limits {
                lower: if unbounded { f64::NEG_INFINITY } else { limit.lower },
                upper: if unbounded { f64::INFINITY } else { limit.upper },
                velocity: or_none(limit.velocity),
                effort: or_none(limit.effort),
            },
            rotor_inertia: 0.0,
            damping,
            friction,
            moments: Moments::of(&inertia),
            inertia,
            rotation_terms: [r0, r0 * a, r0 * a * a],
            axis_in_parent: r0 * axis,
        })
    }

    fn inertia(&self, link: &urdf_rs::Link) -> Result<Inertia, ArmError> {
        let urdf = &link.inertial;
        let i = &urdf.inertia;
        let pose = Pose::from_xyz_rpy(*urdf.origin.xyz, *urdf.origin.rpy);
        let mass = urdf.mass.value;
        let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
        let finite = mass.is_finite()
            && tensor.iter().all(|x| x.is_finite())
            && pose.translation.iter().chain(pose.rotation.iter()).all(|x| x.is_finite());
        if !finite {
            return Err(self.link_error(
                &link.name,
                "has an inertial that is not finite".into(),
                "give finite numbers",
            ));
        }
        if mass < 0.0 {
            return Err(self.link_error(
                &link.name,
                format!("has the mass {mass} kg"),
                "a mass is positive: correct its sign or value",
            ));
        }
        let centred = Inertia { mass, com: Vector3::zeros(), tensor };
        Ok(centred.transformed(&pose))
    }

    fn finite_pose(&self, joint: &urdf_rs::Joint) -> Result<Pose, ArmError> {
        let origin = &joint.origin;
        if origin.xyz.iter().chain(origin.rpy.iter()).all(|x| x.is_finite()) {
            Ok(Pose::from_xyz_rpy(*origin.xyz, *origin.rpy))
        } else {
            Err(self.joint_error(joint, "has an origin that is not finite".into(), "give finite numbers"))
        }
    }

    fn joint_error(&self, joint: &urdf_rs::Joint, reason: String, remedy: &str) -> ArmError {
        self.error("joint", &joint.name, reason, remedy)
    }

    fn link_error(&self, link: &str, reason: String, remedy: &str) -> ArmError {
        self.error("link", link, reason, remedy)
    }

    fn robot_error(&self, reason: String, remedy: &str) -> ArmError {
        self.error("robot", &self.robot.name, reason, remedy)
    }

    fn error(&self, tag: &str, name: &str, reason: String, remedy: &str) -> ArmError {
        ArmError::Model {
            path: self.path.to_owned(),
            line: lines::line_of(self.text, tag, name),
            element: format!("{tag} \"{name}\""),
            reason,
            remedy: remedy.to_owned(),
        }
    }
}

fn visual_of(link: Option<usize>, link_from_parent: &Pose, visual: &urdf_rs::Visual) -> Visual {
    let origin = Pose::from_xyz_rpy(*visual.origin.xyz, *visual.origin.rpy);
    let geometry = match &visual.geometry {
        urdf_rs::Geometry::Box { size } => Geometry::Box(**size),
        &urdf_rs::Geometry::Cylinder { radius, length } | &urdf_rs::Geometry::Capsule { radius, length } => {
            Geometry::Cylinder { radius, length }
        }
        &urdf_rs::Geometry::Sphere { radius } => Geometry::Sphere { radius },
        urdf_rs::Geometry::Mesh { filename, scale } => {
            Geometry::Mesh { file: filename.clone(), scale: scale.map_or([1.0; 3], |scale| *scale) }
        }
    };
    let colour = visual.material.as_ref().and_then(|material| material.color.as_ref());
    Visual {
        link,
        link_from_visual: link_from_parent.compose(&origin),
        geometry,
        colour: colour.map(|colour| *colour.rgba),
    }
}
