//! The residual of a joint in time, before and after.

use arm::Arm;
use diagnosis::statistics::quantile;
use diagnosis::{TimeWindow, Trace, Traces};
use effects::Quantity;

use super::zoom::{Axis, Cell, Data, Panel, Series, differences};
use crate::chart::{Scale, Svg, thinned};
use crate::numbers;

/// The data that all figures of a page are drawn from.
pub struct Figures<'a> {
    pub traces: &'a Traces,
    pub arm: &'a Arm,
    /// Points a line or a cloud may have.
    pub points: usize,
    /// Rows that a figure in time may have where it can be zoomed.
    pub rows: usize,
}

/// The time between two recordings along the axis of a zoomable figure, relative to the duration of all recordings.
const PAUSE: f64 = 0.01;
/// A step of the time axis in such a figure (s).
const TIME_STEP: f64 = 1e-3;

const STRIP: [f64; 2] = [1080.0, 250.0];
/// The width of the vertical axis.
pub const LEFT: f64 = 66.0;

impl Figures<'_> {
    /// The unit of the joint's torque.
    pub fn torque_unit(&self, joint: usize) -> &'static str {
        Quantity::Torque.unit(self.arm.joints()[joint].kind)
    }

    /// The residual over time, before and after, the recordings side by side; `windows` (s) are shaded.
    pub fn over_time(&self, joint: usize, windows: &[TimeWindow]) -> Option<String> {
        let shown = self.shown(joint);
        let total: f64 = shown.iter().map(|trace| span(trace)).sum();
        if shown.is_empty() || total <= 0.0 {
            return None;
        }
        let [width, height] = STRIP;
        let (top, bottom, right) = (26.0, height - 40.0, width - 6.0);
        let gap = 8.0;
        let room = right - LEFT - gap * (shown.len() - 1) as f64;
        let [low, high] = reached(&shown, joint);
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
                svg.rect([scale.place(from), top], [scale.place(to) - scale.place(from), bottom - top], "rest");
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
                        svg.tick_below(place, bottom, tick, decimals);
                    }
                }
            }
            svg.text([x + 2.0, top - 8.0], "panel", "start", &heading(trace, number + 1, panel));
            x += panel + gap;
        }
        svg.text([0.5 * (LEFT + right), height - 5.0], "axis", "middle", "time (s)");
        Some(svg.finish())
    }

    /// The data of [`Self::over_time`], for zooming.
    pub fn over_time_data(&self, joint: usize, windows: &[TimeWindow]) -> Option<Data> {
        let shown = self.shown(joint);
        let total: f64 = shown.iter().map(|trace| span(trace)).sum();
        if shown.is_empty() || total <= 0.0 {
            return None;
        }
        let [low, high] = reached(&shown, joint);
        let unit = numbers::scaled(high.max(-low), self.torque_unit(joint));
        let title = format!("residual ({})", unit.unit);
        let y = Axis::new(title, high.max(-low), unit.factor);
        let mut data = Data {
            x: Axis { title: "time (s)".into(), step: TIME_STEP },
            panels: Vec::new(),
            shades: Vec::new(),
            places: Vec::new(),
            series: [("before", "before"), ("after", "after")]
                .map(|(name, colour)| Series { name, colour, dots: false, on: vec![0], values: Vec::new() })
                .into(),
            y,
        };
        let mut at = 0.0;
        for (number, trace) in shown.iter().enumerate() {
            let (first, last) = (trace.time[0], trace.time[trace.time.len() - 1]);
            let place = |time: f64| at + time.clamp(first, last) - first;
            let rests = rests(trace, joint).into_iter().map(|ends| (ends, "rest"));
            let own = windows.iter().filter(|window| window.recording == trace.name);
            let worst = own.map(|window| ([window.start, window.end], "window"));
            data.shades.extend(
                rests.chain(worst).map(|([from, to], class)| (rounded(place(from)), rounded(place(to)), class)),
            );
            let most = (self.rows as f64 * span(trace) / total) as usize;
            let mut steps: Vec<f64> = trace.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let gap = quantile(&mut steps, 0.5) * 5.0;
            let series = [&trace.residual, &trace.residual_augmented].map(|of| of.get(joint).map(Vec::as_slice));
            let mut before = f64::NEG_INFINITY;
            for row in thinned_rows(series, trace.time.len(), most) {
                let time = trace.time[row];
                if before.is_finite() && time - before > gap.max(2.0 * span(trace) / most.max(1) as f64) {
                    data.end_lines(place(0.5 * (before + time)));
                }
                before = time;
                data.places.push((place(time) / TIME_STEP).round() as i64);
                let step = data.y.step * unit.factor;
                for (of, values) in series.iter().zip(&mut data.series) {
                    let value = of.and_then(|of| of.get(row));
                    values.values.push(value.map_or(Cell::GAP, |value| Cell::of(*value, step)));
                }
            }
            data.panels.push(Panel {
                name: heading(trace, number + 1, f64::INFINITY),
                at: rounded(at),
                length: rounded(span(trace)),
                from: rounded(first),
            });
            at += span(trace);
            data.end_lines(at + 0.5 * PAUSE * total);
            at += PAUSE * total;
        }
        data.places = differences(&data.places);
        Some(data)
    }

    /// The recordings in which the joint moves, or all if there are none.
    fn shown(&self, joint: usize) -> Vec<&Trace> {
        let moves = |trace: &&Trace| trace.moving.get(joint).is_some_and(|moving| moving.contains(&true));
        let mut shown: Vec<&Trace> = self.traces.recordings.iter().filter(moves).collect();
        if shown.is_empty() {
            shown = self.traces.recordings.iter().collect();
        }
        shown.retain(|trace| trace.time.len() > 1 && trace.residual.get(joint).is_some_and(|r| r.len() > 1));
        shown
    }
}

impl Data {
    /// Ends all lines at a time (s) between two rows.
    fn end_lines(&mut self, at: f64) {
        self.places.push((at / TIME_STEP).round() as i64);
        for series in &mut self.series {
            series.values.push(Cell::GAP);
        }
    }
}

fn span(trace: &Trace) -> f64 {
    trace.time[trace.time.len() - 1] - trace.time[0]
}

/// Rounds to a millisecond.
fn rounded(time: f64) -> f64 {
    (time * 1e3).round() / 1e3
}

/// The smallest and the largest residual of a joint, before and after.
fn reached(shown: &[&Trace], joint: usize) -> [f64; 2] {
    let all = shown.iter().flat_map(|trace| [&trace.residual, &trace.residual_augmented]);
    let values = all.filter_map(|series| series.get(joint)).flatten();
    let finite = values.filter(|value| value.is_finite());
    finite.fold([0.0, 0.0], |[low, high]: [f64; 2], value| [low.min(*value), high.max(*value)])
}

/// About `most` of `count` rows in order: in each bin, those where a series is smallest or largest.
fn thinned_rows(series: [Option<&[f64]>; 2], count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let bins = (most / 4).max(1);
    let mut rows = Vec::new();
    for bin in 0..bins {
        let range = count * bin / bins..count * (bin + 1) / bins;
        let mut picked: Vec<usize> = Vec::new();
        for values in series.into_iter().flatten() {
            let order = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
            let inside = || range.clone().filter(|&row| row < values.len());
            picked.extend(inside().min_by(order));
            picked.extend(inside().max_by(order));
        }
        picked.sort_unstable();
        picked.dedup();
        rows.extend(picked);
    }
    rows
}

/// The recording's number, and its name if the width `room` allows it.
fn heading(trace: &Trace, number: usize, room: f64) -> String {
    let name = trace.name.rsplit(['/', '\\']).next().unwrap_or_default();
    let held_out = if trace.held_out { " · held out" } else { "" };
    let fits = |text: &str| text.chars().count() as f64 * 6.8 < room;
    [format!("{number} · {name}{held_out}"), format!("{number}{held_out}"), number.to_string()]
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
