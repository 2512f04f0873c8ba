//! A layout for the viewer, written out component by component: views, containers, panels.
//!
//! The builder of the SDK sets neither the camera nor the legends, and its identifiers are random.

use arm::Arm;
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, TimePanelBlueprint, ViewBlueprint,
    ViewContents, ViewportBlueprint,
};
use rerun::external::re_sdk_types::blueprint::components::{
    BackgroundKind, ContainerKind, Eye3DKind, PanelState, PlayState, RootContainer,
};
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};

use super::batch::TIMELINE;
use super::shapes::reach;

/// Sends the layout that `write` makes; `write` returns the root.
pub fn send(
    recording: &RecordingStream,
    play_state: PlayState,
    write: impl FnOnce(&mut Layout<'_>) -> RecordingStreamResult<Node>,
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
    let mut layout = Layout { blueprint: &blueprint, used: 0 };
    let root = write(&mut layout)?;
    layout.finish(&root, play_state)?;
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

/// A blueprint that is being written; views and containers are numbered in the order in which they are written.
pub struct Layout<'a> {
    blueprint: &'a RecordingStream,
    used: u8,
}

/// A view or a container: its number as a UUID, and its path.
pub struct Node {
    uuid: [u8; 16],
    /// Its path in the layout.
    pub path: String,
}

impl Layout<'_> {
    fn finish(&mut self, root: &Node, play_state: PlayState) -> RecordingStreamResult<()> {
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

    /// The 3D view; at a `distance` of one, it shows the whole reach.
    pub fn scene(&mut self, arm: &Arm, title: &str, distance: f64) -> RecordingStreamResult<Node> {
        let reach = reach(arm);
        let base = arm.joints().first().map(|joint| joint.parent_from_joint.translation);
        let [x, y, z] = base.map_or([0.0; 3], |base| [base.x, base.y, base.z]);
        let target = [x, y, z + 0.2 * reach];
        let offset = [1.5, -1.5, 0.9].map(|part| part * reach * distance);
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
        let properties: [(&str, &dyn AsComponents); 3] =
            [("EyeControls3D", &camera), ("LineGrid3D", &grid), ("Background", &background)];
        self.view("3D", title, "world", &properties)
    }

    /// A view of everything under `origin`.
    pub fn view(
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
        let view = ViewBlueprint::new(class).with_display_name(title).with_space_origin(origin);
        self.blueprint.log(node.path.as_str(), &view)?;
        Ok(node)
    }

    /// A container of nodes that were written before.
    pub fn container(
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

/// The distance between grid lines (m): a round number from a tenth to half of the reach.
fn grid_spacing(reach: f64) -> f32 {
    10.0_f64.powf((0.5 * reach).log10().floor()) as f32
}
