//! The residual of a joint in time, before and after.

use arm::{Arm, JointKind};
use diagnosis::{TimeWindow, Trace, Traces};

use crate::chart::{Scale, Svg, thinned};
use crate::numbers;

/// The data that all figures of a page are drawn from.
pub struct Figures<'a> {
    pub traces: &'a Traces,
    pub arm: &'a Arm,
    /// Points a line or a cloud may have.
    pub points: usize,
}

const STRIP: [f64; 2] = [1080.0, 250.0];
/// Room for the vertical axis.
pub const LEFT: f64 = 66.0;

impl Figures<'_> {
    /// The unit of the joint's torque.
    pub fn torque_unit(&self, joint: usize) -> &'static str {
        match self.arm.joints()[joint].kind {
            JointKind::Revolute => "N m",
            JointKind::Prismatic => "N",
        }
    }

    /// The residual over time, before and after, the recordings side by side; `windows` (s) are shaded.
    pub fn over_time(&self, joint: usize, windows: &[TimeWindow]) -> Option<String> {
        let moves = |trace: &&Trace| trace.moving.get(joint).is_some_and(|moving| moving.contains(&true));
        let mut shown: Vec<&Trace> = self.traces.recordings.iter().filter(moves).collect();
        if shown.is_empty() {
            shown = self.traces.recordings.iter().collect();
        }
        shown.retain(|trace| trace.time.len() > 1 && trace.residual.get(joint).is_some_and(|r| r.len() > 1));
        let span = |trace: &Trace| trace.time[trace.time.len() - 1] - trace.time[0];
        let total: f64 = shown.iter().map(|trace| span(trace)).sum();
        if shown.is_empty() || total <= 0.0 {
            return None;
        }
        let [width, height] = STRIP;
        let (top, bottom, right) = (26.0, height - 40.0, width - 6.0);
        let gap = 8.0;
        let room = right - LEFT - gap * (shown.len() - 1) as f64;
        let mut low = 0.0_f64;
        let mut high = 0.0_f64;
        for trace in &shown {
            for series in [&trace.residual, &trace.residual_augmented] {
                for value in series
                    .get(joint)
                    .into_iter()
                    .flatten()
                    .filter(|value| value.is_finite())
                {
                    low = low.min(*value);
                    high = high.max(*value);
                }
            }
        }
        let margin = 0.05 * (high - low);
        let y = Scale::new([low - margin, high + margin], [bottom, top]);
        let unit = numbers::scaled(high.max(-low), self.torque_unit(joint));
        let name = &self.arm.joints()[joint].name;
        let mut svg = Svg::new(width, height, &format!("residual of {name} over time"));
        svg.vertical_axis(&y, [LEFT, right], unit.factor, &format!("residual ({})", unit.unit));
        let mut x = LEFT;
        for (number, trace) in shown.iter().enumerate() {
            let panel = room * span(trace) / total;
            let ends = [trace.time[0], trace.time[trace.time.len() - 1]];
            let scale = Scale::new(ends, [x, x + panel]);
            for [from, to] in rests(trace, joint) {
                svg.rect(
                    [scale.place(from), top],
                    [scale.place(to) - scale.place(from), bottom - top],
                    "rest",
                );
            }
            for window in windows.iter().filter(|window| window.recording == trace.name) {
                let [from, to] = [window.start.max(ends[0]), window.end.min(ends[1])].map(|t| scale.place(t));
                svg.rect([from, top], [(to - from).max(1.5), bottom - top], "window");
            }
            svg.rect([x, top], [panel, bottom - top], "frame");
            let columns = ((self.points as f64 * panel / room) as usize / 2).max(8);
            for (series, class) in [(&trace.residual, "before"), (&trace.residual_augmented, "after")] {
                let Some(values) = series.get(joint) else { continue };
                let rows: Vec<[f64; 2]> = trace.time.iter().zip(values).map(|(t, v)| [*t, *v]).collect();
                let mut runs = thinned(&rows, columns);
                for point in runs.iter_mut().flatten() {
                    *point = [scale.place(point[0]), y.place(point[1])];
                }
                svg.lines(&runs, class);
            }
            let most = (panel / 70.0) as usize;
            if most > 0 {
                let (ticks, decimals) = scale.ticks(most);
                for tick in ticks {
                    let place = scale.place(tick);
                    svg.line([place, bottom], [place, bottom + 4.0], "mark");
                    if place > x + 8.0 && place < x + panel - 8.0 {
                        svg.text(
                            [place, bottom + 17.0],
                            "tick",
                            "middle",
                            &numbers::fixed(tick, decimals),
                        );
                    }
                }
            }
            svg.text(
                [x + 2.0, top - 8.0],
                "panel",
                "start",
                &heading(trace, number + 1, panel),
            );
            x += panel + gap;
        }
        svg.text([0.5 * (LEFT + right), height - 5.0], "axis", "middle", "time (s)");
        Some(svg.finish())
    }
}

/// The recording's number and, where there is room, its name.
fn heading(trace: &Trace, number: usize, room: f64) -> String {
    let name = trace.name.rsplit(['/', '\\']).next().unwrap_or_default();
    let held_out = if trace.held_out { " · held out" } else { "" };
    let fits = |text: &str| text.chars().count() as f64 * 6.8 < room;
    [
        format!("{number} · {name}{held_out}"),
        format!("{number}{held_out}"),
        number.to_string(),
    ]
    .into_iter()
    .find(|text| fits(text))
    .unwrap_or_default()
}

/// Intervals of time in which the joint is at rest.
fn rests(trace: &Trace, joint: usize) -> Vec<[f64; 2]> {
    let Some(moving) = trace.moving.get(joint) else {
        return Vec::new();
    };
    let shortest = 0.004 * (trace.time[trace.time.len() - 1] - trace.time[0]);
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    let mut row = 0;
    for part in moving.chunk_by(|a, b| a == b) {
        let last = (row + part.len()).min(trace.time.len()) - 1;
        if !part[0] && row < trace.time.len() && trace.time[last] - trace.time[row] >= shortest {
            stretches.push([trace.time[row], trace.time[last]]);
        }
        row += part.len();
    }
    stretches
}
