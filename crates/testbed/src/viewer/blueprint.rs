//! The layout that a run opens with: the arm at the left, a plot a joint at the right.
//!
//! Written out component by component, since the SDK's own builder sets neither the camera nor the
//! legends, and draws its identifiers at random.

use arm::{Arm, JointKind};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend, TimePanelBlueprint,
    ViewBlueprint, ViewContents, ViewportBlueprint,
};
use rerun::external::re_sdk_types::blueprint::components::{
    BackgroundKind, ContainerKind, Eye3DKind, PanelState, PlayState, RootContainer,
};
use rerun::{
    AsComponents, EntityPath, RecordingStream, RecordingStreamBuilder, RecordingStreamResult, SeriesLines, TextDocument,
};

use super::batch::TIMELINE;
use super::joint_entity;
use super::shapes::reach;

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
    Quantity {
        title: "Tracking error",
        units: ["mrad", "mm"],
        entity: "error",
    },
    Quantity {
        title: "Torque",
        units: ["N m", "N"],
        entity: "torque",
    },
    Quantity {
        title: "Position",
        units: ["rad", "m"],
        entity: "position",
    },
    Quantity {
        title: "Variance",
        units: ["N² m²", "N²"],
        entity: "variance",
    },
];

/// Every line: its entity under the joint's, its name in the legend, its colour and its width (points).
/// Rerun draws them by the order of their names: the first of a plot lies under the others, hence its width.
const LINES: [(&str, &str, [u8; 3], f32); 8] = [
    ("error", "reference - actual", RED, 1.25),
    ("torque/applied", "applied", GREY, 3.0),
    ("torque/feedback", "feedback", AMBER, 1.25),
    ("torque/learned", "learned", GREEN, 1.25),
    ("torque/model", "model", BLUE, 1.25),
    ("position/actual", "actual", BLUE, 4.0),
    ("position/reference", "reference", AMBER, 1.25),
    ("variance", "variance", VIOLET, 1.25),
];

/// What the colours mean, for the eye; the entity it is logged to.
const KEY: &str = "\
**position** actual blue, reference amber  
**error** reference - actual  
**torque** applied grey; of it model blue, learned green, feedback amber";
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

/// Sends the layout; the tab of the variance is left out where there is none.
pub fn send(
    recording: &RecordingStream,
    arm: &Arm,
    has_variance: bool,
    play_state: PlayState,
) -> RecordingStreamResult<()> {
    let Some(info) = recording.store_info() else {
        return Ok(());
    };
    let (blueprint, storage) = RecordingStreamBuilder::new(info.store_id.application_id().clone())
        .recording_id(info.store_id.recording_id().as_str())
        .enabled(true)
        .send_properties(false)
        .blueprint()
        .memory()?;
    blueprint.set_log_time_enabled(false);
    blueprint.set_time_sequence("blueprint", 0);
    let mut layout = Layout {
        blueprint: &blueprint,
        used: 0,
    };
    layout.write(arm, has_variance, play_state)?;
    let messages = storage.take();
    if let Some(first) = messages.first() {
        let activation = BlueprintActivationCommand {
            blueprint_id: first.store_id().clone(),
            make_active: true,
            make_default: true,
        };
        recording.send_blueprint(messages, activation);
    }
    Ok(())
}

/// A blueprint under way; views and containers are numbered in the order they are written.
struct Layout<'a> {
    blueprint: &'a RecordingStream,
    used: u8,
}

/// A view or a container: its number as a UUID, and its path.
struct Node {
    uuid: [u8; 16],
    path: String,
}

impl Layout<'_> {
    fn write(&mut self, arm: &Arm, has_variance: bool, play_state: PlayState) -> RecordingStreamResult<()> {
        let scene = self.scene(arm)?;
        let key = self.view("TextDocument", "Key", KEY_ENTITY, &[])?;
        let left = self.container(ContainerKind::Vertical, &[scene, key], |c| {
            c.with_row_shares([0.84, 0.16])
        })?;
        let mut tabs = Vec::new();
        for quantity in QUANTITIES.iter().filter(|q| has_variance || q.entity != "variance") {
            tabs.push(self.grid(arm, quantity)?);
        }
        let first = tabs.first().map_or("", |tab| tab.path.as_str());
        let tabs = self.container(ContainerKind::Tabs, &tabs, |c| c.with_active_tab(first))?;
        let root = self.container(ContainerKind::Horizontal, &[left, tabs], |c| {
            c.with_col_shares([0.42, 0.58])
        })?;
        let viewport = ViewportBlueprint::new()
            .with_root_container(RootContainer(root.uuid.into()))
            .with_auto_layout(false)
            .with_auto_views(false);
        self.blueprint.log("viewport", &viewport)?;
        for panel in ["blueprint_panel", "selection_panel"] {
            let collapsed = PanelBlueprint::new().with_state(PanelState::Collapsed);
            self.blueprint.log(panel, &collapsed)?;
        }
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(TIMELINE)
            .with_play_state(play_state);
        self.blueprint.log("time_panel", &time)
    }

    /// The 3D view, from a point that sees the whole reach.
    fn scene(&mut self, arm: &Arm) -> RecordingStreamResult<Node> {
        let reach = reach(arm);
        let base = arm.joints().first().map(|joint| joint.parent_from_joint.translation);
        let [x, y, z] = base.map_or([0.0; 3], |base| [base.x, base.y, base.z]);
        let target = [x, y, z + 0.2 * reach];
        let offset = [1.5, -1.5, 0.9].map(|part| part * reach);
        let position = [target[0] + offset[0], target[1] + offset[1], target[2] + offset[2]];
        let to_f32 = |point: [f64; 3]| point.map(|part| part as f32);
        let camera = EyeControls3D::new()
            .with_kind(Eye3DKind::Orbital)
            .with_position(to_f32(position))
            .with_look_target(to_f32(target))
            .with_eye_up([0.0, 0.0, 1.0]);
        let grid = LineGrid3D::new()
            .with_visible(true)
            .with_spacing(grid_spacing(reach))
            .with_color(rerun::Color::from_rgb(52, 57, 64));
        let background = Background::new(BackgroundKind::SolidColor).with_color(rerun::Color::from_rgb(21, 24, 28));
        let title = format!("{}: actual (solid), reference (amber)", arm.name());
        let properties: [(&str, &dyn AsComponents); 3] = [
            ("EyeControls3D", &camera),
            ("LineGrid3D", &grid),
            ("Background", &background),
        ];
        self.view("3D", &title, "world", &properties)
    }

    /// A quantity's tab: one plot a joint.
    fn grid(&mut self, arm: &Arm, quantity: &Quantity) -> RecordingStreamResult<Node> {
        let mut plots = Vec::new();
        for joint in arm.joints() {
            let unit = quantity.units[usize::from(joint.kind == JointKind::Prismatic)];
            // In plots this small it would cover the data; the key below the arm serves all.
            let legend = PlotLegend::new().with_visible(false);
            let origin = joint_entity(&joint.name).join(&EntityPath::from(quantity.entity));
            let title = format!("{} ({unit})", joint.name);
            plots.push(self.view("TimeSeries", &title, &origin.to_string(), &[("PlotLegend", &legend)])?);
        }
        self.container(ContainerKind::Grid, &plots, |c| {
            c.with_grid_columns(2).with_display_name(quantity.title)
        })
    }

    fn view(
        &mut self,
        class: &str,
        title: &str,
        origin: &str,
        properties: &[(&str, &dyn AsComponents)],
    ) -> RecordingStreamResult<Node> {
        let node = self.node("view");
        let contents = ViewContents::new(["$origin/**"]);
        self.blueprint.log(format!("{}/ViewContents", node.path), &contents)?;
        for (name, property) in properties {
            self.blueprint.log(format!("{}/{name}", node.path), *property)?;
        }
        let view = ViewBlueprint::new(class)
            .with_display_name(title)
            .with_space_origin(origin);
        self.blueprint.log(node.path.as_str(), &view)?;
        Ok(node)
    }

    fn container(
        &mut self,
        kind: ContainerKind,
        contents: &[Node],
        finish: impl FnOnce(ContainerBlueprint) -> ContainerBlueprint,
    ) -> RecordingStreamResult<Node> {
        let node = self.node("container");
        let contents = contents.iter().map(|child| child.path.as_str());
        let container = finish(ContainerBlueprint::new(kind).with_contents(contents));
        self.blueprint.log(node.path.as_str(), &container)?;
        Ok(node)
    }

    fn node(&mut self, kind: &str) -> Node {
        self.used += 1;
        let mut uuid = [0; 16];
        uuid[15] = self.used;
        let path = format!("{kind}/00000000-0000-0000-0000-{:012x}", self.used);
        Node { uuid, path }
    }
}

/// Lines a round tenth to half of the reach apart (m).
fn grid_spacing(reach: f64) -> f32 {
    10.0_f64.powf((0.5 * reach).log10().floor()) as f32
}
