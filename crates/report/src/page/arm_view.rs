//! The arm in a posture of a recording, its joints coloured by the nominal model's torque error.

use arm::{Arm, Vector3, Workspace};
use diagnosis::{JointFit, Report, Traces};

use maud::{Markup, html};

use super::key;
use crate::chart::Svg;
use crate::{not_diagnosed, numbers, terminal, words};

const WIDTH: f64 = 800.0;
/// The part of the picture that shows the arm: its left and right end, and its upper end.
const SIDES: [f64; 2] = [270.0, 530.0];
const TOP: f64 = 34.0;
/// The largest height of this part, and the height of the picture below it.
const TALLEST: f64 = 338.0;
const BELOW: f64 = 24.0;
/// Height of the camera above the horizon (rad).
const ELEVATION: f64 = 0.42;
const RADIUS: f64 = 12.0;
/// The height of a label of two lines, and the largest number of its characters.
const LABEL: f64 = 46.0;
const LONGEST_LABEL: usize = 34;

/// Upper bounds of the colour classes: nominal error over the torque's standard deviation.
pub const CLASSES: [f64; 4] = [0.05, 0.15, 0.4, 0.8];

/// The colour class of an error.
pub fn class_of(error: f64) -> usize {
    CLASSES.iter().filter(|&&end| error >= end).count()
}

/// One label beside the arm, and the section that it leads to.
struct Label {
    at: [f64; 2],
    name: String,
    below: String,
    link: Option<String>,
}

/// A camera on a circle around the arm.
struct Camera {
    right: Vector3<f64>,
    up: Vector3<f64>,
}

impl Camera {
    fn new(azimuth: f64) -> Self {
        let (sin, cos) = azimuth.sin_cos();
        let (lift, level) = ELEVATION.sin_cos();
        Self { right: Vector3::new(-sin, cos, 0.0), up: Vector3::new(-cos * lift, -sin * lift, level) }
    }

    fn see(&self, point: &Vector3<f64>) -> [f64; 2] {
        [point.dot(&self.right), -point.dot(&self.up)]
    }
}

/// The picture; the label of a joint with a section leads to it.
pub fn draw(report: &Report, traces: &Traces, arm: &Arm, has_section: impl Fn(usize) -> bool) -> String {
    let (points, camera) = best_view(traces, arm);
    let seen: Vec<[f64; 2]> = points.iter().map(|point| camera.see(point)).collect();
    let reach = points.iter().map(Vector3::norm).fold(0.05, f64::max);
    let floor = 0.28 * reach;
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]| camera.see(&Vector3::new(floor * x, floor * y, 0.0)));
    let fit = fit_into_box(seen.iter().chain(&corners), arm.dof());
    let bottom = fit.bottom;
    let fit = |point: [f64; 2]| fit.place(point);
    let mut svg = Svg::new(WIDTH, bottom + BELOW, "the arm, its joints coloured by the nominal model's error");
    svg.area(&corners.map(&fit), "floor");
    for k in [-0.5, 0.0, 0.5] {
        let edge = |x: f64, y: f64| fit(camera.see(&Vector3::new(floor * x, floor * y, 0.0)));
        svg.line(edge(k, -1.0), edge(k, 1.0), "floor-line");
        svg.line(edge(-1.0, k), edge(1.0, k), "floor-line");
    }
    let placed: Vec<[f64; 2]> = seen.iter().map(|&point| fit(point)).collect();
    for (index, pair) in placed.windows(2).enumerate() {
        let thickness = 15.0 - 8.0 * index as f64 / placed.len() as f64;
        let ([x1, y1], [x2, y2]) = (pair[0], pair[1]);
        for (class, width) in [("bone-edge", thickness + 2.5), ("bone", thickness)] {
            svg.raw(format_args!(
                "<path class=\"{class}\" stroke-width=\"{width:.1}\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>"
            ));
        }
    }
    let joints = spread_out(&placed[1..=arm.dof()]);
    let tool = placed[arm.dof() + 1];
    svg.raw(format_args!("<g class=\"labels\">"));
    labels(&mut svg, report, arm, (&joints, tool), bottom, &has_section);
    svg.raw(format_args!("</g>"));
    for (i, [x, y]) in joints.iter().enumerate() {
        let [from_x, from_y] = placed[i + 1];
        if (x - from_x).hypot(y - from_y) > 2.0 {
            svg.line([from_x, from_y], [*x, *y], "leader");
        }
        let name = &arm.joints()[i].name;
        let error = report.fit.get(name).map(nominal_error);
        let class = error.map_or("m-none".to_owned(), |error| format!("m{}", class_of(error)));
        svg.circle([*x, *y], RADIUS, &format!("joint {class}"));
        svg.text([*x, y + 4.5], &format!("number {class}-ink"), "middle", &(i + 1).to_string());
    }
    svg.finish()
}

/// Base, joints and tool in the posture and from the side where they are best visible.
fn best_view(traces: &Traces, arm: &Arm) -> (Vec<Vector3<f64>>, Camera) {
    let mut best: Option<(f64, Vec<Vector3<f64>>, Camera)> = None;
    let mut workspace = Workspace::new(arm);
    let mut postures = postures(traces, arm.dof(), 40);
    if postures.is_empty() {
        postures.push(vec![0.0; arm.dof()]);
    }
    for q in postures {
        let points = skeleton(arm, &mut workspace, &q);
        for step in 0..8 {
            let camera = Camera::new(-0.9 + 0.785 * f64::from(step));
            let seen: Vec<[f64; 2]> = points.iter().map(|point| camera.see(point)).collect();
            // The distances between joints, each to its nearest neighbour.
            let apart = |i: usize| {
                let others = seen.iter().enumerate().filter(|(j, _)| *j != i);
                let distances = others.map(|(_, b)| (seen[i][0] - b[0]).hypot(seen[i][1] - b[1]));
                distances.fold(f64::INFINITY, f64::min)
            };
            let is_below_floor = points.iter().any(|point| point.z < -1e-3);
            let score = (0..seen.len()).map(apart).sum::<f64>() * if is_below_floor { 0.6 } else { 1.0 };
            if best.as_ref().is_none_or(|(highest, ..)| score > *highest + 1e-9) {
                best = Some((score, points.clone(), camera));
            }
        }
    }
    best.map_or_else(
        || (vec![Vector3::zeros(); arm.dof() + 2], Camera::new(-0.9)),
        |(_, points, camera)| (points, camera),
    )
}

/// Some rows of the first recording.
fn postures(traces: &Traces, dof: usize, most: usize) -> Vec<Vec<f64>> {
    let Some(trace) = traces.recordings.first() else {
        return Vec::new();
    };
    let rows = trace.q.iter().map(Vec::len).min().unwrap_or(0);
    if trace.q.len() != dof || rows == 0 {
        return Vec::new();
    }
    let row = |k: usize| (0..dof).map(|joint| trace.q[joint][k]).collect::<Vec<f64>>();
    let rows = (0..most.min(rows)).map(|k| row(k * rows / most.min(rows)));
    rows.filter(|q| q.iter().all(|value| value.is_finite())).collect()
}

/// Base, joint origins, tool.
fn skeleton(arm: &Arm, workspace: &mut Workspace, q: &[f64]) -> Vec<Vector3<f64>> {
    arm.forward_kinematics(workspace, q);
    let joints = (0..arm.dof()).map(|link| workspace.base_from_link(link).translation);
    let tool = workspace.base_from_frame(&arm.tool_frame()).translation;
    std::iter::once(Vector3::zeros()).chain(joints).chain([tool]).collect()
}

/// The map from camera coordinates to the picture.
struct InBox {
    /// The middle of the points, in camera coordinates.
    middle: [f64; 2],
    zoom: f64,
    /// The lower end of the arm's part of the picture.
    bottom: f64,
}

impl InBox {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            0.5 * (SIDES[0] + SIDES[1]) + self.zoom * (x - self.middle[0]),
            0.5 * (TOP + self.bottom) + self.zoom * (y - self.middle[1]),
        ]
    }
}

/// The map that puts the points into the middle of the arm's part of the picture, which is as high as the points and the
/// labels of `dof` joints require.
fn fit_into_box<'a>(points: impl Iterator<Item = &'a [f64; 2]>, dof: usize) -> InBox {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for point in points {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let size = |axis: usize| (high[axis] - low[axis]).max(1e-3);
    let zoom = ((SIDES[1] - SIDES[0]) / size(0)).min(TALLEST / size(1));
    // The labels are on two sides, with one more for the whole arm.
    let of_labels = LABEL * (dof + 1).div_ceil(2) as f64;
    InBox {
        middle: [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])],
        zoom,
        bottom: TOP + (zoom * size(1)).max(of_labels).min(TALLEST),
    }
}

/// Moves circles apart that would cover each other.
fn spread_out(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut points = points.to_vec();
    let nearest = 2.0 * RADIUS + 3.0;
    for _ in 0..60 {
        for i in 0..points.len() {
            for j in 0..i {
                let [dx, dy] = [points[i][0] - points[j][0], points[i][1] - points[j][1]];
                let distance = dx.hypot(dy);
                if distance >= nearest {
                    continue;
                }
                let [ux, uy] = if distance > 1e-6 { [dx / distance, dy / distance] } else { [0.8, -0.6] };
                let push = 0.5 * (nearest - distance);
                for (point, sign) in [(i, 1.0), (j, -1.0)] {
                    points[point][0] += sign * push * ux;
                    points[point][1] += sign * push * uy;
                }
            }
        }
    }
    points
}

/// The nominal model's error on the held-out recordings, or on the training recordings where no held-out one has it.
fn nominal_error(fit: &JointFit) -> f64 {
    fit.held_out_nrmse_nominal.unwrap_or(fit.train_nrmse_nominal)
}

/// Labels with names and findings on both sides of the arm, with lines to the joints.
fn labels(
    svg: &mut Svg,
    report: &Report,
    arm: &Arm,
    (joints, tool): (&[[f64; 2]], [f64; 2]),
    bottom: f64,
    has_section: &impl Fn(usize) -> bool,
) {
    let mut all: Vec<Label> = Vec::new();
    let effects = |joint: Option<&str>| {
        let own = report.findings.iter().filter(|finding| finding.joint.as_deref() == joint);
        let names: Vec<String> = own.map(words::effect).collect();
        names.join(", ")
    };
    for (i, joint) in arm.joints().iter().enumerate() {
        let error = report.fit.get(&joint.name).map(nominal_error);
        let mut below = effects(Some(&joint.name));
        if report.unexplained.iter().any(|open| open.joint == joint.name) {
            below =
                if below.is_empty() { "unexplained residual".into() } else { format!("{below}, unexplained residual") };
        }
        if not_diagnosed::has(report, &joint.name) {
            // A second encoder may show an effect where the torque shows none.
            below = if below.is_empty() { "not diagnosed".into() } else { format!("not diagnosed, {below}") };
        }
        let name = match error {
            Some(error) => format!("{} · {}", clipped(&joint.name, LONGEST_LABEL - 7), numbers::share(error)),
            None => clipped(&joint.name, LONGEST_LABEL),
        };
        all.push(Label { at: joints[i], name, below, link: has_section(i).then(|| format!("joint-{}", i + 1)) });
    }
    let whole = effects(None);
    if !whole.is_empty() {
        all.push(Label { at: tool, name: "whole arm".into(), below: whole, link: Some("whole-arm".into()) });
    }
    all.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    let right = all.split_off(all.len() / 2);
    for (mut side, x, anchor, sign) in [(all, SIDES[0] - 30.0, "end", 1.0), (right, SIDES[1] + 30.0, "start", -1.0)] {
        side.sort_by(|a, b| a.at[1].total_cmp(&b.at[1]));
        let wanted: Vec<f64> = side.iter().map(|label| label.at[1]).collect();
        for (label, y) in side.iter().zip(stacked(&wanted, bottom)) {
            svg.raw(format_args!(
                "<path class=\"leader\" d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}\"/>",
                x + 6.0 * sign,
                y - 4.0,
                x + 20.0 * sign,
                y - 4.0,
                label.at[0],
                label.at[1]
            ));
            let is_quiet = label.below.is_empty();
            if let Some(link) = &label.link {
                svg.raw(format_args!("<a href=\"#{link}\">"));
            }
            svg.text([x, y], if is_quiet { "label quiet" } else { "label" }, anchor, &label.name);
            svg.text([x, y + 16.0], "label-below", anchor, &clipped(&label.below, LONGEST_LABEL + 6));
            if label.link.is_some() {
                svg.raw(format_args!("</a>"));
            }
        }
    }
}

/// Heights of labels near the `wanted` ones, which are in ascending order, such that no two labels overlap.
fn stacked(wanted: &[f64], bottom: f64) -> Vec<f64> {
    let (top, bottom) = (TOP, bottom - 10.0);
    let mut placed: Vec<f64> = Vec::new();
    for &y in wanted {
        let free = placed.last().map_or(top, |last| last + LABEL);
        placed.push(y.max(free));
    }
    let mut limit = bottom;
    for y in placed.iter_mut().rev() {
        *y = y.min(limit);
        limit = *y - LABEL;
    }
    placed
}

fn clipped(text: &str, longest: usize) -> String {
    if text.chars().count() <= longest {
        return text.to_owned();
    }
    text.chars().take(longest - 1).collect::<String>() + "…"
}

/// The legend of the joints' colours.
pub fn legend(report: &Report) -> Markup {
    let words = |class: usize| match (class.checked_sub(1).map(|k| CLASSES[k]), CLASSES.get(class)) {
        (None, Some(end)) => format!("below {:.0} %", 100.0 * end),
        (Some(from), Some(end)) => format!("{:.0} to {:.0} %", 100.0 * from, 100.0 * end),
        (from, None) => format!("over {:.0} %", 100.0 * from.unwrap_or_default()),
    };
    html! {
        "RMS torque error of the nominal model on the " (terminal::recordings(report)) " recordings, relative to the torque's standard deviation: "
        @for class in 0..=CLASSES.len() { (key(&format!("dot b{class}"), &words(class))) }
    }
}
