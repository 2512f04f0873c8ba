//! The arm's shapes: its URDF's visuals, or capsules and cylinders along its kinematics.

use std::path::Path;

use anyhow::Context as _;
use arm::{Arm, Geometry, JointKind, Pose, Vector3, Visual};
use rerun::components::FillMode;
use rerun::{
    AsComponents, Asset3D, Boxes3D, Capsules3D, Color, Cylinders3D, Ellipsoids3D, RecordingStream, Transform3D,
};

use super::batch::{ARMS, link_entity, matrix, translation};
use super::mesh;

/// Colours of links in turn, of joints, and of the whole reference arm.
const LINKS: [[u8; 4]; 2] = [[92, 128, 168, 255], [186, 194, 204, 255]];
const JOINT: [u8; 4] = [58, 66, 78, 255];
const REFERENCE: [u8; 4] = [242, 165, 65, 34];
/// The factor by which the reference is drawn larger, so that it surrounds the arm when both coincide.
const SHELL: f64 = 1.3;
const VISUAL_SHELL: f64 = 1.02;

/// Logs everything in `world` that does not move, and the shapes of the links of `arms` (of [`ARMS`]).
pub fn log_scene(recording: &RecordingStream, arm: &Arm, urdf_path: &Path, arms: &[&str]) -> anyhow::Result<()> {
    recording.log_static("world", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for &name in arms {
        let artist = Artist { recording, arm, urdf_path, name, ghost: (name == "reference").then_some(REFERENCE) };
        artist.draw()?;
    }
    let tool = arm.tool_frame();
    let entity = link_entity(ARMS[0], tool.link).join(&"tool".into());
    let pose = transform(&tool.link_from_frame, [1.0; 3]);
    let axes = rerun::TransformAxes3D::new((0.12 * reach(arm)) as f32);
    recording.log_static(entity, &[&pose as &dyn AsComponents, &axes])?;
    Ok(())
}

/// The largest distance of the tool from the first joint (m).
pub fn reach(arm: &Arm) -> f64 {
    let between_joints = arm.joints().iter().skip(1).map(|joint| &joint.parent_from_joint);
    let tool = arm.tool_frame().link_from_frame;
    let lengths = between_joints.chain([&tool]).map(|pose| pose.translation.norm());
    let slides = arm.joints().iter().filter(|joint| joint.kind == JointKind::Prismatic);
    let travels = slides.map(|joint| joint.limits.lower.abs().max(joint.limits.upper.abs()));
    lengths.chain(travels.filter(|travel| travel.is_finite())).sum::<f64>().max(0.01)
}

/// Draws one of the two arms.
struct Artist<'a> {
    recording: &'a RecordingStream,
    arm: &'a Arm,
    urdf_path: &'a Path,
    name: &'a str,
    /// The colour of all shapes if the arm is the transparent reference.
    ghost: Option<[u8; 4]>,
}

impl Artist<'_> {
    fn draw(&self) -> anyhow::Result<()> {
        let links = || std::iter::once(None).chain((0..self.arm.dof()).map(Some));
        let visuals = |link| self.arm.visuals().iter().filter(move |visual| visual.link == link);
        let can_show = |visual: &Visual| match &visual.geometry {
            Geometry::Mesh { file, .. } => mesh::resolve(file, self.urdf_path).is_some(),
            _ => true,
        };
        let shows_nothing = !self.arm.visuals().iter().any(can_show);
        // The base of the reference would only cover the other's.
        for link in links().filter(|link| link.is_some() || self.ghost.is_none()) {
            let mut shown = 0;
            for visual in visuals(link).filter(|visual| can_show(visual)) {
                self.draw_visual(visual, shown)?;
                shown += 1;
            }
            let is_missing = shown == 0 && visuals(link).next().is_some();
            if shows_nothing || is_missing {
                self.draw_bones(link)?;
            }
        }
        Ok(())
    }

    fn draw_visual(&self, visual: &Visual, number: usize) -> anyhow::Result<()> {
        let entity = link_entity(self.name, visual.link).join(&format!("visual_{number}").into());
        let own = visual.colour.map(|rgba| rgba.map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8));
        let colour = self.colour(own.unwrap_or(link_colour(visual.link)));
        let mut scale = [if self.ghost.is_some() { VISUAL_SHELL } else { 1.0 }; 3];
        let shape: Box<dyn AsComponents> = match &visual.geometry {
            Geometry::Box(sizes) => {
                let shape = Boxes3D::from_sizes([sizes.map(|size| size as f32)]);
                Box::new(shape.with_colors([colour]).with_fill_mode(FillMode::Solid))
            }
            Geometry::Cylinder { radius, length } => {
                let shape = Cylinders3D::from_lengths_and_radii([*length as f32], [*radius as f32]);
                Box::new(shape.with_colors([colour]).with_fill_mode(FillMode::Solid))
            }
            Geometry::Sphere { radius } => {
                let shape = Ellipsoids3D::from_radii([*radius as f32]);
                Box::new(shape.with_colors([colour]).with_fill_mode(FillMode::Solid))
            }
            Geometry::Mesh { file, scale: of_mesh } => {
                scale = [0, 1, 2].map(|axis| scale[axis] * of_mesh[axis]);
                let Some(path) = mesh::resolve(file, self.urdf_path) else {
                    return Ok(());
                };
                // An STL has no colour of its own; the other formats do.
                let is_plain = path.extension().is_some_and(|format| format.eq_ignore_ascii_case("stl"));
                let asset = Asset3D::from_file_path(&path).with_context(|| format!("reading {}", path.display()))?;
                Box::new(if is_plain || own.is_some() || self.ghost.is_some() {
                    asset.with_albedo_factor(colour.0)
                } else {
                    asset
                })
            }
        };
        let pose = transform(&visual.link_from_visual, scale);
        self.recording.log_static(entity, &[&pose as &dyn AsComponents, &*shape])?;
        Ok(())
    }

    /// A capsule to the next joint (or the tool), and a cylinder along the link's own joint axis.
    fn draw_bones(&self, link: Option<usize>) -> anyhow::Result<()> {
        let entity = link_entity(self.name, link);
        let joints = self.arm.joints();
        let next = link.map_or(0, |i| i + 1);
        let end = joints.get(next).map_or_else(
            || self.arm.tool_frame().link_from_frame.translation,
            |joint| joint.parent_from_joint.translation,
        );
        let taper = 1.0 - 0.55 * next as f64 / joints.len() as f64;
        let shell = if self.ghost.is_some() { SHELL } else { 1.0 };
        let radius = 0.052 * reach(self.arm) * taper * shell;
        let length = end.norm();
        if length > 1e-6 {
            let bone = Capsules3D::from_lengths_and_radii([length as f32], [(0.8 * radius) as f32])
                .with_quaternions([rotation_from_z(&end)])
                .with_colors([self.colour(link_colour(link))])
                .with_fill_mode(FillMode::Solid);
            self.recording.log_static(entity.join(&"bone".into()), &bone)?;
        }
        let (axis, thickness, width) = link.map_or((Vector3::z(), 0.4, 1.9), |i| (joints[i].axis, 2.8, 1.15));
        let hub = Cylinders3D::from_lengths_and_radii([(thickness * radius) as f32], [(width * radius) as f32])
            .with_quaternions([rotation_from_z(&axis)])
            .with_colors([self.colour(JOINT)])
            .with_fill_mode(FillMode::Solid);
        self.recording.log_static(entity.join(&"joint".into()), &hub)?;
        Ok(())
    }

    fn colour(&self, own: [u8; 4]) -> Color {
        let [r, g, b, a] = self.ghost.unwrap_or(own);
        Color::from_unmultiplied_rgba(r, g, b, a)
    }
}

fn link_colour(link: Option<usize>) -> [u8; 4] {
    link.map_or(LINKS[1], |i| LINKS[i % 2])
}

fn transform(pose: &Pose, scale: [f64; 3]) -> Transform3D {
    Transform3D::from_translation_mat3x3(translation(pose), matrix(pose, scale))
}

/// The shortest rotation of the z axis onto `direction`.
fn rotation_from_z(direction: &Vector3<f64>) -> rerun::Quaternion {
    let d = direction.normalize();
    let [x, y, z, w] = if d.z < -0.999_999 { [1.0, 0.0, 0.0, 0.0] } else { [-d.y, d.x, 0.0, 1.0 + d.z] };
    let norm = (x * x + y * y + z * z + w * w).sqrt();
    rerun::Quaternion::from_xyzw([x, y, z, w].map(|part| (part / norm) as f32))
}
