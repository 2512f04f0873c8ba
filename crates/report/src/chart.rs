//! Axes, ticks and paths of a figure, as SVG text.

use std::fmt::Write;

use diagnosis::statistics::quantile;
use maud::Escaper;

use crate::numbers;

/// A linear map from values to positions in the figure.
#[derive(Clone, Copy)]
pub struct Scale {
    from: [f64; 2],
    to: [f64; 2],
}

impl Scale {
    /// The map of the values `from` to the positions `to`; an empty range is widened.
    pub fn new(from: [f64; 2], to: [f64; 2]) -> Self {
        let [low, high] = from;
        let from = if high - low > 1e-12 * (low.abs() + high.abs()) && high > low {
            from
        } else {
            let margin = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            [low - margin, high + margin]
        };
        Self { from, to }
    }

    /// The position of `value`.
    pub fn place(&self, value: f64) -> f64 {
        let share = (value - self.from[0]) / (self.from[1] - self.from[0]);
        self.to[0] + share * (self.to[1] - self.to[0])
    }

    /// The values at its ends.
    pub fn range(&self) -> [f64; 2] {
        self.from
    }

    /// Round values, at most the given number, with the decimals that distinguish them.
    pub fn ticks(&self, most: usize) -> (Vec<f64>, usize) {
        let [low, high] = self.from;
        let rough = (high - low) / most.max(1) as f64;
        let power = 10_f64.powf(rough.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0];
        let step = power * steps.iter().find(|&&s| s * power >= rough * 0.999).unwrap_or(&10.0);
        let decimals = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
        let first = (low / step - 1e-6).ceil() as i64;
        let last = (high / step + 1e-6).floor() as i64;
        let ticks = (first..=last).take(2 * most + 2).map(|k| k as f64 * step).collect();
        (ticks, decimals)
    }
}

/// An SVG that is being written: `width` × `height` in units of its view box.
pub struct Svg {
    text: String,
}

impl Svg {
    /// An empty drawing; `label` describes it for screen readers.
    pub fn new(width: f64, height: f64, label: &str) -> Self {
        let mut text = format!("<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"");
        let _ = Escaper::new(&mut text).write_str(label);
        text.push_str("\">");
        Self { text }
    }

    /// An empty drawing as wide as the page and of a fixed height, whose horizontal positions are percentages.
    pub fn stretched(height: f64, label: &str) -> Self {
        let mut text =
            format!("<svg class=\"stretched\" width=\"100%\" height=\"{height}\" role=\"img\" aria-label=\"");
        let _ = Escaper::new(&mut text).write_str(label);
        text.push_str("\">");
        Self { text }
    }

    /// The finished element.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>");
        self.text
    }

    /// Adds an element as it is.
    pub fn raw(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = self.text.write_fmt(element);
    }

    /// A text at a position; `anchor` is start, middle or end.
    pub fn text(&mut self, [x, y]: [f64; 2], class: &str, anchor: &str, words: &str) {
        self.raw(format_args!("<text x=\"{x:.1}\" y=\"{y:.1}\" class=\"{class}\" text-anchor=\"{anchor}\">"));
        let _ = Escaper::new(&mut self.text).write_str(words);
        self.text.push_str("</text>");
    }

    /// A text that reads upwards, centred on a position.
    pub fn upwards(&mut self, [x, y]: [f64; 2], class: &str, words: &str) {
        self.raw(format_args!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" class=\"{class}\" text-anchor=\"middle\">"
        ));
        let _ = Escaper::new(&mut self.text).write_str(words);
        self.text.push_str("</text>");
    }

    /// A straight line.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], class: &str) {
        self.raw(format_args!("<path class=\"{class}\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>"));
    }

    /// A box.
    pub fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], class: &str) {
        self.raw(format_args!(
            "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>"
        ));
    }

    /// A circle.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, class: &str) {
        self.raw(format_args!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>"));
    }

    /// Runs of points, each a line of its own.
    pub fn lines(&mut self, runs: &[Vec<[f64; 2]>], class: &str) {
        self.raw(format_args!("<path class=\"{class}\" d=\""));
        for run in runs {
            for (index, [x, y]) in run.iter().enumerate() {
                let letter = if index == 0 { 'M' } else { 'L' };
                self.raw(format_args!("{letter}{x:.1} {y:.1}"));
            }
        }
        self.text.push_str("\"/>");
    }

    /// Points as dots, as large as the stroke width of `class`.
    pub fn dots(&mut self, points: &[[f64; 2]], class: &str) {
        self.raw(format_args!("<path class=\"{class}\" d=\""));
        for [x, y] in points {
            self.raw(format_args!("M{x:.1} {y:.1}h0"));
        }
        self.text.push_str("\"/>");
    }

    /// A closed area.
    pub fn area(&mut self, outline: &[[f64; 2]], class: &str) {
        self.raw(format_args!("<path class=\"{class}\" d=\""));
        for (index, [x, y]) in outline.iter().enumerate() {
            let letter = if index == 0 { 'M' } else { 'L' };
            self.raw(format_args!("{letter}{x:.1} {y:.1}"));
        }
        self.text.push_str("Z\"/>");
    }

    /// The number of a tick at `place` below the horizontal axis at `bottom`.
    pub fn tick_below(&mut self, place: f64, bottom: f64, tick: f64, decimals: usize) {
        self.text([place, bottom + 17.0], "tick", "middle", &numbers::fixed(tick, decimals));
    }

    /// The horizontal lines of a vertical axis, with their numbers and the unit.
    pub fn vertical_axis(&mut self, scale: &Scale, [left, right]: [f64; 2], factor: f64, title: &str) {
        let shown = Scale::new(scale.range().map(|value| value / factor), [0.0, 1.0]);
        let (ticks, decimals) = shown.ticks(6);
        for tick in ticks {
            let y = scale.place(tick * factor);
            let class = if tick == 0.0 { "zero" } else { "grid" };
            self.line([left, y], [right, y], class);
            self.text([left - 6.0, y + 4.0], "tick", "end", &numbers::fixed(tick, decimals));
        }
        let middle = 0.5 * (scale.place(scale.range()[0]) + scale.place(scale.range()[1]));
        self.upwards([left - 46.0, middle], "axis", title);
    }
}

/// The uninterrupted parts of a series of (x, y), each thinned to the points with the smallest and the largest y in each of
/// `columns` columns.
pub fn thinned(rows: &[[f64; 2]], columns: usize) -> Vec<Vec<[f64; 2]>> {
    let mut steps: Vec<f64> = rows.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    let gap = quantile(&mut steps, 0.5) * 5.0;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Vec::new();
    };
    let width = (last[0] - first[0]).max(f64::MIN_POSITIVE) / columns.max(1) as f64;
    let mut runs = Vec::new();
    for run in rows.chunk_by(|a, b| b[0] - a[0] <= gap) {
        let mut points: Vec<[f64; 2]> = Vec::new();
        let column = |row: &[f64; 2]| ((row[0] - first[0]) / width) as i64;
        for bin in run.chunk_by(|a, b| column(a) == column(b)) {
            let finite = || bin.iter().filter(|row| row[1].is_finite());
            let low = finite().min_by(|a, b| a[1].total_cmp(&b[1]));
            let high = finite().max_by(|a, b| a[1].total_cmp(&b[1]));
            let (Some(&low), Some(&high)) = (low, high) else {
                continue;
            };
            let pair = if low[0] <= high[0] { [low, high] } else { [high, low] };
            points.push(pair[0]);
            if pair[1] != pair[0] {
                points.push(pair[1]);
            }
        }
        if !points.is_empty() {
            runs.push(points);
        }
    }
    runs
}

/// At most `most` of the points, spread evenly, but at irregular distances, so that they do not keep step with a periodic
/// motion.
pub fn sampled<T: Copy>(points: &[T], most: usize) -> Vec<T> {
    if points.len() <= most {
        return points.to_vec();
    }
    let step = points.len() as f64 / most as f64;
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..most)
        .map(|k| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let random = (state >> 11) as f64 / (1_u64 << 53) as f64;
            points[(((k as f64 + random) * step) as usize).min(points.len() - 1)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let (ticks, decimals) = Scale::new([-0.31, 0.74], [0.0, 1.0]).ticks(5);
        assert_eq!((ticks.len(), decimals), (2, 1), "{ticks:?}");
        let (ticks, decimals) = Scale::new([-0.31, 0.74], [0.0, 1.0]).ticks(6);
        assert!((ticks[0] + 0.2).abs() < 1e-9 && ticks.len() == 5 && decimals == 1, "{ticks:?}");
        let (ticks, decimals) = Scale::new([0.0, 0.0], [0.0, 1.0]).ticks(4);
        assert!(ticks.len() > 2 && decimals <= 1, "{ticks:?}");
    }

    #[test]
    fn thinning_keeps_spikes_and_gaps() {
        let mut rows: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k) * 0.01, 0.0]).collect();
        rows[5003][1] = 7.0;
        rows.drain(8000..9000);
        let runs = thinned(&rows, 200);
        assert_eq!(runs.len(), 2);
        assert!(runs.iter().flatten().count() <= 402);
        assert!(runs.iter().flatten().any(|point| point[1] == 7.0));
    }

    #[test]
    fn sampling_is_even_and_repeats() {
        let points: Vec<usize> = (0..10_000).collect();
        let some = sampled(&points, 100);
        assert_eq!(some, sampled(&points, 100));
        assert!(some.windows(2).all(|pair| pair[0] < pair[1]) && some[99] > 9_800);
    }
}
