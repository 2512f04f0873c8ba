//! Figures of residuals against a state, without and with an effect, and of the torque of the effect.

use diagnosis::statistics::quantile;
use diagnosis::{Finding, Trace};

use super::against::Against;
use super::figures::{Figures, LEFT};
use super::zoom::{Axis, Cell, Data, Series, differences};
use crate::chart::{Scale, Svg, sampled};
use crate::numbers;

const PANEL: [f64; 2] = [530.0, 300.0];

/// Residuals against a state: the drawings before and after, and the data of both.
pub struct Cloud {
    pub before: String,
    pub after: String,
    pub data: Data,
}

/// One point of such a figure: the state, the residual before, the residual after, the torque of the effect. Torques count
/// along the motion if [`Against::is_along`].
type Point = [f64; 4];

impl Figures<'_> {
    /// The residuals before and after, against the state that shows finding number `index`, with its effect drawn through them.
    pub fn against_state(&self, finding: &Finding, index: usize, joint: usize) -> Option<Cloud> {
        let against = Against::of(finding, self.arm);
        let mut points = self.points_of(index, joint, against);
        if let (Against::Time, Some(first), Some(last)) =
            (against, finding.place.time.first(), finding.place.time.last())
        {
            // With data far from the event, the event would be too narrow in the figure.
            let around = 2.0 * (last[1] - first[0]).max(0.1);
            points.retain(|point| (first[0] - around..=last[1] + around).contains(&point[0]));
        }
        let bins = if finding.as_effect.spec().is_periodic || against == Against::Time { 300.0 } else { 90.0 };
        self.cloud(joint, against, &points, bins)
    }

    /// The residual of a joint with all effects found, against a state that it depends on.
    pub fn unexplained(&self, joint: usize, against: Against) -> Option<Cloud> {
        let mut points = Vec::new();
        for trace in &self.traces.recordings {
            for (row, residual) in trace.residual_augmented.get(joint).into_iter().flatten().enumerate() {
                let moves = trace.moving.get(joint).and_then(|moving| moving.get(row));
                let Some(state) = against.value(trace, joint, row).filter(|_| moves != Some(&false)) else {
                    continue;
                };
                if state.is_finite() && residual.is_finite() {
                    points.push([state, *residual, *residual, 0.0]);
                }
            }
        }
        let mut cloud = self.cloud(joint, against, &points, 1.0)?;
        // Only the residual with all effects is drawn.
        cloud.data.series.retain(|series| series.colour == "after");
        for series in &mut cloud.data.series {
            series.on = vec![0];
        }
        Some(cloud)
    }

    fn cloud(&self, joint: usize, against: Against, points: &[Point], bins: f64) -> Option<Cloud> {
        if points.len() < 8 {
            return None;
        }
        let column = |part: usize| points.iter().map(|point| point[part]).collect::<Vec<f64>>();
        let mut states = column(0);
        let state_ends = [0.001, 0.999].map(|share| quantile(&mut states, share));
        let mut torques = [column(1), column(2)].concat();
        let ends = [0.002, 0.998].map(|share| quantile(&mut torques, share));
        let effect = through(points, state_ends, bins);
        let reached = effect.iter().flat_map(|bin| [bin.low, bin.high]).chain([0.0]);
        let low = reached.clone().fold(ends[0], f64::min);
        let high = reached.fold(ends[1], f64::max);
        let margin = 0.06 * (high - low);
        let [width, height] = PANEL;
        let (top, bottom, right) = (10.0, height - 42.0, width - 12.0);
        let y = Scale::new([low - margin, high + margin], [bottom, top]);
        let x_margin = 0.02 * (state_ends[1] - state_ends[0]);
        let x = Scale::new([state_ends[0] - x_margin, state_ends[1] + x_margin], [LEFT, right]);
        let (title, x_unit) = against.title(self.arm, joint);
        let x_unit = numbers::scaled(state_ends[0].abs().max(state_ends[1].abs()), x_unit);
        let unit = numbers::scaled(high.max(-low), self.torque_unit(joint));
        let along = if against.is_along() { " along the motion" } else { "" };
        let few = sampled(points, self.points);
        let panel = |part: usize, class: &str| {
            let mut svg = Svg::new(width, height, &format!("residual against {title}, {class}"));
            let label = format!("residual{along} ({})", unit.unit);
            svg.vertical_axis(&y, [LEFT, right], unit.factor, &label);
            let shown = Scale::new(x.range().map(|value| value / x_unit.factor), [LEFT, right]);
            let (ticks, decimals) = shown.ticks(7);
            for tick in ticks {
                let place = shown.place(tick);
                svg.line([place, top], [place, bottom], if tick == 0.0 { "zero" } else { "grid" });
                svg.tick_below(place, bottom, tick, decimals);
            }
            svg.text([0.5 * (LEFT + right), height - 6.0], "axis", "middle", &format!("{title} ({})", x_unit.unit));
            let inside = |point: &&Point| {
                let [from, to] = x.range();
                let [low, high] = y.range();
                (from..=to).contains(&point[0]) && (low..=high).contains(&point[part])
            };
            let dots = few.iter().filter(inside).map(|point| [x.place(point[0]), y.place(point[part])]);
            svg.dots(&dots.collect::<Vec<_>>(), &format!("dots {class}-dots"));
            if part == 1 {
                draw_effect(&mut svg, &effect, &x, &y);
            }
            svg.finish()
        };
        let label = format!("residual{along} ({})", unit.unit);
        let largest = |[low, high]: [f64; 2]| high.abs().max(low.abs());
        let x_axis = Axis::new(format!("{title} ({})", x_unit.unit), largest(x.range()), x_unit.factor);
        let y_axis = Axis::new(label, largest(y.range()), unit.factor);
        let data = data(&few, &effect, [(x_axis, x_unit.factor), (y_axis, unit.factor)], [x.range(), y.range()]);
        Some(Cloud { before: panel(1, "before"), after: panel(2, "after"), data })
    }

    /// Whether other findings also act on the joint.
    pub fn shares_joint(&self, index: usize, joint: usize) -> bool {
        let acts = |trace: &Trace| {
            let effects = trace.effects.iter().enumerate().filter(|(other, _)| *other != index);
            effects.filter_map(|(_, joints)| joints.get(joint)).any(|effect| !effect.is_empty())
        };
        self.traces.recordings.iter().any(acts)
    }

    fn points_of(&self, index: usize, joint: usize, against: Against) -> Vec<Point> {
        let mut points = Vec::new();
        for trace in &self.traces.recordings {
            let effect = trace.effects.get(index).and_then(|joints| joints.get(joint));
            let after = trace.residual_augmented.get(joint);
            let (Some(effect), Some(after)) = (effect, after) else {
                continue;
            };
            for (row, (effect, after)) in effect.iter().zip(after).enumerate() {
                let moves = trace.moving.get(joint).and_then(|moving| moving.get(row));
                if moves == Some(&false) && against != Against::Time {
                    continue;
                }
                let state = match against {
                    Against::Predicted => Some(*effect),
                    _ => against.value(trace, joint, row),
                };
                let Some(state) = state else { continue };
                let turn = against.turn(trace, joint, row);
                let point = [state, turn * (after + effect), turn * after, turn * effect];
                if point.iter().all(|value| value.is_finite()) {
                    points.push(point);
                }
            }
        }
        points
    }
}

/// The points before (figure 0) and after (figure 1), and the effect (figure 0), on axes with their units. Points outside the
/// axes are omitted, as in the drawing.
fn data(
    points: &[Point],
    effect: &[Bin],
    [(x, x_unit), (y, y_unit)]: [(Axis, f64); 2],
    [x_ends, y_ends]: [[f64; 2]; 2],
) -> Data {
    let is_in = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
    let place = |state: f64| (state / (x.step * x_unit)).round() as i64;
    let value = |torque: f64| {
        if is_in(torque, y_ends) { Cell::of(torque, y.step * y_unit) } else { Cell::MISSING }
    };
    // Before, after, the effect's ends.
    let mut rows: Vec<(i64, [Cell; 4])> = points
        .iter()
        .filter(|point| is_in(point[0], x_ends))
        .map(|&[state, before, after, _]| {
            let row = [value(before), value(after), Cell::MISSING, Cell::MISSING];
            (place(state), row)
        })
        .collect();
    for (k, bin) in effect.iter().enumerate() {
        if k > 0 && bin.is_start {
            let between = 0.5 * (effect[k - 1].state + bin.state);
            rows.push((place(between), [Cell::MISSING, Cell::MISSING, Cell::GAP, Cell::GAP]));
        }
        let row = [Cell::MISSING, Cell::MISSING, value(bin.low), value(bin.high)];
        rows.push((place(bin.state), row));
    }
    rows.sort_by_key(|row| row.0);
    let places: Vec<i64> = rows.iter().map(|row| row.0).collect();
    let series = |k: usize, name, colour, on: usize| Series {
        name,
        colour,
        dots: k < 2,
        on: vec![on],
        values: rows.iter().map(|row| row.1[k]).collect(),
    };
    let all = [
        series(0, "before", "before", 0),
        series(1, "after", "after", 1),
        series(2, "effect", "effect", 0),
        series(3, "effect", "effect", 0),
    ];
    Data { panels: Vec::new(), shades: Vec::new(), places: differences(&places), series: all.into(), x, y }
}

/// The effect's torque over a narrow range of state.
struct Bin {
    state: f64,
    low: f64,
    middle: f64,
    high: f64,
    /// Whether the effect may jump between the bin before and this one (through zero).
    is_start: bool,
}

fn through(points: &[Point], [from, to]: [f64; 2], bins: f64) -> Vec<Bin> {
    // Zero is a border of bins, so that a jump there remains a jump.
    let width = ((to - from) / bins).max(f64::MIN_POSITIVE);
    let mut sorted: Vec<[f64; 2]> =
        points.iter().filter(|point| (from..=to).contains(&point[0])).map(|point| [point[0], point[3]]).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let bin = |point: &[f64; 2]| (point[0] / width).floor() as i64;
    let mut bins: Vec<Bin> = Vec::new();
    let mut last = None;
    for group in sorted.chunk_by(|a, b| bin(a) == bin(b)) {
        let number = bin(&group[0]);
        let mut torques: Vec<f64> = group.iter().map(|point| point[1]).collect();
        let [low, middle, high] = [0.05, 0.5, 0.95].map(|share| quantile(&mut torques, share));
        bins.push(Bin {
            state: group.iter().map(|point| point[0]).sum::<f64>() / group.len() as f64,
            low,
            middle,
            high,
            is_start: last.is_none_or(|last| number - last > 6 || (last < 0 && number >= 0)),
        });
        last = Some(number);
    }
    bins
}

/// A line where the effect is a function of the state, a band where it has many values.
fn draw_effect(svg: &mut Svg, bins: &[Bin], x: &Scale, y: &Scale) {
    let starts = bins.iter().enumerate().filter(|(_, bin)| bin.is_start).map(|(index, _)| index);
    let ends: Vec<usize> = starts.skip(1).chain([bins.len()]).collect();
    let mut first = 0;
    let mut lines = Vec::new();
    for end in ends {
        let run = &bins[first..end];
        let at = |pick: fn(&Bin) -> f64| run.iter().map(move |bin| [x.place(bin.state), y.place(pick(bin))]);
        // The effect has more different torques in one bin than the slope of a line explains.
        let height = |low: f64, high: f64| (y.place(low) - y.place(high)).abs();
        let is_wide = |index: usize| {
            let [before, after] = [index.saturating_sub(1), (index + 1).min(run.len() - 1)];
            height(run[index].low, run[index].high) > 6.0 + height(run[before].middle, run[after].middle)
        };
        let is_wide = (0..run.len()).filter(|&index| is_wide(index)).count() > run.len() / 5;
        if is_wide {
            // There is no line, because the effect has many torques at one state.
            let outline: Vec<[f64; 2]> = at(|bin| bin.low).chain(at(|bin| bin.high).rev()).collect();
            svg.area(&outline, "effect-band");
        } else {
            lines.push(at(|bin| bin.middle).collect());
        }
        first = end;
    }
    svg.lines(&lines, "effect-edge");
    svg.lines(&lines, "effect");
}
