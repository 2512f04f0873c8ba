//! The initial layout of the viewer: the arm and the summary at the left, residuals, torques and effects at the right.

use arm::Arm;
use diagnosis::Report;
use effects::Quantity;
use report::words;
use rerun::datatypes::{TimeInt, TimeRange, TimeRangeBoundary};
use rerun::external::re_sdk_types::blueprint::archetypes::{PlotLegend, TimeAxis};
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, Corner2D, PlayState};
use rerun::{AsComponents, Color, EntityPath, RecordingStream, RecordingStreamResult, SeriesLines};

use super::SUMMARY;
use crate::viewer::joint_entity;
use crate::viewer::layout::{self, Layout, Node};

const ORANGE: [u8; 3] = [240, 140, 74];
const BLUE: [u8; 3] = [88, 170, 240];
const GREY: [u8; 3] = [170, 178, 188];
/// Effects of one joint in turn.
const EFFECTS: [[u8; 3]; 6] =
    [[242, 196, 65], [96, 190, 120], [176, 132, 224], [232, 98, 88], [90, 200, 200], [230, 150, 190]];

/// Entities under a joint's, their names in the legend, colours and widths; the first of a plot lies under the others.
const LINES: [(&str, &str, [u8; 3], f32); 5] = [
    ("residual/before", "before", ORANGE, 1.5),
    ("residual/after", "after", BLUE, 1.5),
    ("torque/measured", "measured", GREY, 3.5),
    ("torque/model", "model", ORANGE, 1.25),
    ("torque/named", "model + effects", BLUE, 1.25),
];

/// Where a finding's torque is, under the joint's entity.
pub fn effect_entity(number: usize) -> String {
    format!("effect/{}", number + 1)
}

/// Whether finding `number` may have a line on the joint.
fn acts(report: &Report, number: usize, joint: &str) -> bool {
    let finding = &report.findings[number];
    finding.joint.as_deref().is_none_or(|own| own == joint) || finding.share_by_joint.contains_key(joint)
}

/// Logs names, colours and widths of all lines.
pub fn log_styles(recording: &RecordingStream, arm: &Arm, report: &Report) -> RecordingStreamResult<()> {
    let style = |name: &str, [r, g, b]: [u8; 3], width: f32| {
        SeriesLines::new().with_names([name]).with_colors([Color::from_rgb(r, g, b)]).with_widths([width])
    };
    for joint in arm.joints() {
        let entity = |part: &str| joint_entity(&joint.name).join(&EntityPath::from(part));
        for (part, name, colour, width) in LINES {
            recording.log_static(entity(part), &style(name, colour, width))?;
        }
        let findings = (0..report.findings.len()).filter(|&number| acts(report, number, &joint.name));
        for (nth, number) in findings.enumerate() {
            let name = words::effect(&report.findings[number]);
            let style = style(&name, EFFECTS[nth % EFFECTS.len()], 1.5);
            recording.log_static(entity(&effect_entity(number)), &style)?;
        }
    }
    Ok(())
}

/// Sends the layout; the plots show the `span` of time (s).
pub fn send(recording: &RecordingStream, arm: &Arm, report: &Report, span: [f64; 2]) -> RecordingStreamResult<()> {
    // A plot that follows the time would move; the plots show the whole time from the beginning.
    layout::send(recording, PlayState::Paused, |layout| write(layout, arm, report, span))
}

fn write(layout: &mut Layout<'_>, arm: &Arm, report: &Report, span: [f64; 2]) -> RecordingStreamResult<Node> {
    let title = format!("{}: recorded motion, coloured by the residual", arm.name());
    let scene = layout.scene(arm, &title, 0.7)?;
    let summary = layout.view("TextDocument", "Diagnosis", SUMMARY, &[])?;
    let left = layout.container(ContainerKind::Vertical, &[scene, summary], |c| c.with_row_shares([0.5, 0.5]))?;
    let has_effects = |joint: &str| (0..report.findings.len()).any(|number| acts(report, number, joint));
    let mut tabs = vec![
        grid(layout, arm, &Tab { title: "Residual", part: "residual", span }, &|_| true)?,
        grid(layout, arm, &Tab { title: "Torque", part: "torque", span }, &|_| true)?,
    ];
    if !report.findings.is_empty() {
        tabs.push(grid(layout, arm, &Tab { title: "Effects", part: "effect", span }, &has_effects)?);
    }
    let first = tabs[0].path.clone();
    let tabs = layout.container(ContainerKind::Tabs, &tabs, |c| c.with_active_tab(first.as_str()))?;
    layout.container(ContainerKind::Horizontal, &[left, tabs], |c| c.with_col_shares([0.4, 0.6]))
}

/// A tab: its title, the entity under the joint's, the time it shows.
struct Tab {
    title: &'static str,
    part: &'static str,
    span: [f64; 2],
}

/// One plot per joint.
fn grid(layout: &mut Layout<'_>, arm: &Arm, tab: &Tab, is_shown: &dyn Fn(&str) -> bool) -> RecordingStreamResult<Node> {
    let [start, end] = tab.span.map(|time| TimeRangeBoundary::Absolute(TimeInt((1e9 * time) as i64)));
    let axis = TimeAxis::new().with_view_range(TimeRange { start, end });
    let mut plots = Vec::new();
    for joint in arm.joints().iter().filter(|joint| is_shown(&joint.name)) {
        let unit = Quantity::Torque.unit(joint.kind);
        let legend = PlotLegend::new().with_corner(Corner2D::RightTop);
        let origin = joint_entity(&joint.name).join(&EntityPath::from(tab.part));
        let name = format!("{} ({unit})", joint.name);
        let properties: [(&str, &dyn AsComponents); 2] = [("PlotLegend", &legend), ("TimeAxis", &axis)];
        plots.push(layout.view("TimeSeries", &name, &origin.to_string(), &properties)?);
    }
    let columns = if plots.len() > 1 { 2 } else { 1 };
    layout.container(ContainerKind::Grid, &plots, |c| c.with_grid_columns(columns).with_display_name(tab.title))
}
