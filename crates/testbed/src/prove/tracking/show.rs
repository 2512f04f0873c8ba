//! The closed loop of a case in Rerun: the arm with the diagnosed effects beside its reference, and one line per model.
//!
//! Entities: `world/{actual,reference}/link_<i>`, and for every joint `joint/<name>/` with `error/<model>` and `torque/<model>`.

use std::path::Path;

use anyhow::Context as _;
use arm::{Arm, JointKind, Workspace};
use rerun::external::re_sdk_types::blueprint::archetypes::PlotLegend;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, PlayState};
use rerun::{
    AsComponents, Color, EntityPath, RecordingStream, RecordingStreamResult, SeriesLines, TextDocument, TimeColumn,
};

use super::Model;
use super::closed_loop::Run;
use super::course::Course;
use crate::viewer::batch::{ARMS, TIMELINE, link_entity, send_poses, send_scalars};
use crate::viewer::end::End;
use crate::viewer::layout::{self, Layout, Node};
use crate::viewer::{Sink, joint_entity, shapes};

/// Ticks between two rows of the plots, and between two poses.
const ROW: usize = 10;
const POSE: usize = 20;
/// Where the legend is logged to.
const KEY: &str = "key";
/// Lines by model: colour, and width; the first of a plot lies under the others.
const LINES: [([u8; 3], &str, f32); 5] = [
    ([170, 178, 188], "grey", 2.0),
    ([240, 140, 74], "orange", 2.5),
    ([96, 190, 120], "green", 1.5),
    ([176, 132, 224], "violet", 1.25),
    ([86, 156, 235], "blue", 1.0),
];
/// Tabs: title, entity under the joint's, units (revolute, prismatic).
const TABS: [(&str, &str, [&str; 2]); 2] =
    [("Tracking error", "error", ["mrad", "mm"]), ("Torque commanded", "torque", ["N m", "N"])];

/// Writes the runs, one per model, to `path`; meshes are searched from the folder of `urdf`.
///
/// # Errors
/// If the file cannot be written; it is then absent.
pub fn write(path: &Path, title: &str, arm: &Arm, urdf: &Path, course: &Course, runs: &[Run]) -> anyhow::Result<()> {
    let (end, _) = End::open(&Sink::Save(path.to_owned()))?;
    let recording = end.record(title, arm)?;
    let End::File(file) = end else {
        anyhow::bail!("{}: is no file", path.display());
    };
    let result = log(&recording, title, arm, urdf, course, runs)
        .and_then(|()| recording.flush_blocking().context("writing the recording"));
    drop(recording);
    let result = result.and_then(|()| file.finish());
    file.abandon();
    result
}

fn log(
    recording: &RecordingStream,
    title: &str,
    arm: &Arm,
    urdf: &Path,
    course: &Course,
    runs: &[Run],
) -> anyhow::Result<()> {
    recording.send_recording_name(title)?;
    shapes::log_scene(recording, arm, urdf, &ARMS)?;
    let lines = Model::ALL.iter().zip(LINES);
    let key: Vec<String> = lines.map(|(model, (_, colour, _))| format!("- {}: {colour}", model.title())).collect();
    let key = format!("{title}\n\nThe arm is the one {}. Lines:\n\n{}", Model::Diagnosed.title(), key.join("\n"));
    recording.log_static(KEY, &TextDocument::from_markdown(key))?;
    layout::send(recording, PlayState::Playing, |layout| write_layout(layout, arm))?;
    let ticks: Vec<usize> = (course.run_in..course.ticks).step_by(ROW).collect();
    let time = TimeColumn::new_duration_secs(TIMELINE, ticks.iter().map(|&tick| course.time(tick)));
    for (j, joint) in arm.joints().iter().enumerate() {
        for (model, (run, ([r, g, b], _, width))) in Model::ALL.iter().zip(runs.iter().zip(LINES)) {
            if run.links.is_empty() {
                continue;
            }
            let at = |tick: &usize| tick * course.dof + j;
            let errors: Vec<f64> =
                ticks.iter().map(|tick| 1e3 * (course.at.q[at(tick)] - run.links[at(tick)])).collect();
            let torques: Vec<f64> = ticks.iter().map(|tick| run.tau[at(tick)]).collect();
            let style = SeriesLines::new()
                .with_names([model.title()])
                .with_colors([Color::from_rgb(r, g, b)])
                .with_widths([width]);
            for ((_, part, _), values) in TABS.iter().zip([errors, torques]) {
                let entity = joint_entity(&joint.name).join(&EntityPath::from(format!("{part}/{}", word(*model))));
                recording.log_static(entity.clone(), &style)?;
                send_scalars(recording, entity, &time, &values)?;
            }
        }
    }
    let diagnosed = Model::ALL.iter().zip(runs).find(|(model, _)| **model == Model::Diagnosed);
    let shown = diagnosed.map(|(_, run)| &run.links).filter(|links| !links.is_empty());
    let mut workspace = Workspace::new(arm);
    let ticks: Vec<usize> = (course.run_in..course.ticks).step_by(POSE).collect();
    let time = TimeColumn::new_duration_secs(TIMELINE, ticks.iter().map(|&tick| course.time(tick)));
    for (name, positions) in ARMS.iter().zip([shown, Some(&course.at.q)]) {
        let Some(positions) = positions else { continue };
        let mut poses = vec![Vec::with_capacity(ticks.len()); course.dof];
        for tick in &ticks {
            arm.forward_kinematics(&mut workspace, &positions[tick * course.dof..(tick + 1) * course.dof]);
            for (link, poses) in poses.iter_mut().enumerate() {
                poses.push(*workspace.base_from_link(link));
            }
        }
        for (link, poses) in poses.iter().enumerate() {
            send_poses(recording, link_entity(name, Some(link)), &time, poses)?;
        }
    }
    Ok(())
}

/// A model's entity; Rerun draws lines by the order of their names.
fn word(model: Model) -> &'static str {
    match model {
        Model::Nominal => "1_nominal",
        Model::Diagnosed => "2_diagnosed",
        Model::Learned => "3_learned",
        Model::Both => "4_both",
        Model::Exact => "5_exact",
    }
}

fn write_layout(layout: &mut Layout<'_>, arm: &Arm) -> RecordingStreamResult<Node> {
    let title = format!("{}: with the diagnosed effects (solid), reference (amber)", arm.name());
    let scene = layout.scene(arm, &title, 1.0)?;
    let key = layout.view("TextDocument", "Legend", KEY, &[])?;
    let left = layout.container(ContainerKind::Vertical, &[scene, key], |c| c.with_row_shares([0.72, 0.28]))?;
    let mut tabs = Vec::new();
    for (title, part, units) in TABS {
        let mut plots = Vec::new();
        for joint in arm.joints() {
            let unit = units[usize::from(joint.kind == JointKind::Prismatic)];
            let legend = PlotLegend::new().with_visible(false);
            let origin = joint_entity(&joint.name).join(&EntityPath::from(part));
            let properties: [(&str, &dyn AsComponents); 1] = [("PlotLegend", &legend)];
            plots.push(layout.view(
                "TimeSeries",
                &format!("{} ({unit})", joint.name),
                &origin.to_string(),
                &properties,
            )?);
        }
        tabs.push(layout.container(ContainerKind::Grid, &plots, |c| c.with_grid_columns(2).with_display_name(title))?);
    }
    let first = tabs.first().map_or("", |tab| tab.path.as_str());
    let tabs = layout.container(ContainerKind::Tabs, &tabs, |c| c.with_active_tab(first))?;
    layout.container(ContainerKind::Horizontal, &[left, tabs], |c| c.with_col_shares([0.4, 0.6]))
}
