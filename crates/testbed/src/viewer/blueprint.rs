//! The initial layout of a run: the arm on the left, one plot per joint on the right.

use arm::{Arm, JointKind};
use rerun::external::re_sdk_types::blueprint::archetypes::PlotLegend;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, PlayState};
use rerun::{EntityPath, RecordingStream, RecordingStreamResult, SeriesLines, TextDocument};

use super::joint_entity;
use super::layout::{self, Layout, Node};

const GREY: [u8; 3] = [170, 178, 188];
const BLUE: [u8; 3] = [86, 156, 235];
const AMBER: [u8; 3] = [242, 165, 65];
const GREEN: [u8; 3] = [96, 190, 120];
const RED: [u8; 3] = [232, 98, 88];
const VIOLET: [u8; 3] = [176, 132, 224];

/// One tab: a quantity's title, its units (revolute, prismatic), and its entity under the joint's.
struct Quantity {
    title: &'static str,
    units: [&'static str; 2],
    entity: &'static str,
}

const QUANTITIES: [Quantity; 4] = [
    Quantity { title: "Tracking error", units: ["mrad", "mm"], entity: "error" },
    Quantity { title: "Torque", units: ["N m", "N"], entity: "torque" },
    Quantity { title: "Position", units: ["rad", "m"], entity: "position" },
    Quantity { title: "Variance", units: ["N² m²", "N²"], entity: "variance" },
];

/// Every line: its entity under the joint's, its name in the legend, its colour and its width (points).
/// Rerun draws them by the order of their names: the first of a plot lies under the others, hence its width.
const LINES: [(&str, &str, [u8; 3], f32); 8] = [
    ("error", "reference − actual", RED, 1.25),
    ("torque/applied", "applied", GREY, 3.0),
    ("torque/feedback", "feedback", AMBER, 1.25),
    ("torque/learned", "learned", GREEN, 1.25),
    ("torque/model", "model", BLUE, 1.25),
    ("position/actual", "actual", BLUE, 4.0),
    ("position/reference", "reference", AMBER, 1.25),
    ("variance", "variance", VIOLET, 1.25),
];

/// The legend of the colours, and the entity to which it is logged.
const KEY: &str = "\
**position**: actual blue, reference amber  
**error**: reference − actual  
**torque**: applied grey; its parts: model blue, learned green, feedback amber";
const KEY_ENTITY: &str = "key";

/// Logs the key, and the lines' names, colours and widths.
pub fn log_styles(recording: &RecordingStream, arm: &Arm, title: &str) -> RecordingStreamResult<()> {
    let key = TextDocument::from_markdown(format!("{title}\n\n{KEY}"));
    recording.log_static(KEY_ENTITY, &key)?;
    for joint in arm.joints() {
        for (entity, name, [r, g, b], width) in LINES {
            let style = SeriesLines::new()
                .with_names([name])
                .with_colors([rerun::Color::from_rgb(r, g, b)])
                .with_widths([width]);
            recording.log_static(joint_entity(&joint.name).join(&EntityPath::from(entity)), &style)?;
        }
    }
    Ok(())
}

/// Sends the layout; the tab of the variance is omitted if there is none.
pub fn send(
    recording: &RecordingStream,
    arm: &Arm,
    has_variance: bool,
    play_state: PlayState,
) -> RecordingStreamResult<()> {
    layout::send(recording, play_state, |layout| write(layout, arm, has_variance))
}

fn write(layout: &mut Layout<'_>, arm: &Arm, has_variance: bool) -> RecordingStreamResult<Node> {
    let scene = layout.scene(arm, &format!("{}: actual (solid), reference (amber)", arm.name()), 1.0)?;
    let key = layout.view("TextDocument", "Legend", KEY_ENTITY, &[])?;
    let left = layout.container(ContainerKind::Vertical, &[scene, key], |c| c.with_row_shares([0.84, 0.16]))?;
    let mut tabs = Vec::new();
    for quantity in QUANTITIES.iter().filter(|q| has_variance || q.entity != "variance") {
        tabs.push(grid(layout, arm, quantity)?);
    }
    let first = tabs.first().map_or("", |tab| tab.path.as_str());
    let tabs = layout.container(ContainerKind::Tabs, &tabs, |c| c.with_active_tab(first))?;
    layout.container(ContainerKind::Horizontal, &[left, tabs], |c| c.with_col_shares([0.42, 0.58]))
}

/// The tab of a quantity: one plot per joint.
fn grid(layout: &mut Layout<'_>, arm: &Arm, quantity: &Quantity) -> RecordingStreamResult<Node> {
    let mut plots = Vec::new();
    for joint in arm.joints() {
        let unit = quantity.units[usize::from(joint.kind == JointKind::Prismatic)];
        // In such small plots, a legend would cover the data; the legend below the arm applies to all plots.
        let legend = PlotLegend::new().with_visible(false);
        let origin = joint_entity(&joint.name).join(&EntityPath::from(quantity.entity));
        let title = format!("{} ({unit})", joint.name);
        plots.push(layout.view("TimeSeries", &title, &origin.to_string(), &[("PlotLegend", &legend)])?);
    }
    layout.container(ContainerKind::Grid, &plots, |c| c.with_grid_columns(2).with_display_name(quantity.title))
}
