//! The data of zoomable figures, as JSON beside the drawing of the same figure.

use maud::{Markup, PreEscaped, html};
use serde::Serialize;

/// The data of one figure, or of several side by side that share their horizontal axis.
#[derive(Serialize)]
pub struct Data {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The recordings along a time axis, one after the other; empty for other axes.
    pub panels: Vec<Panel>,
    /// Stretches of the horizontal axis with a background: from, to, class.
    pub shades: Vec<(f64, f64, &'static str)>,
    /// The horizontal positions as differences, in steps of [`Axis::step`].
    pub places: Vec<i64>,
    /// The lines and clouds.
    pub series: Vec<Series>,
}

/// An axis: its text with the unit, and the value of one step in the data.
#[derive(Serialize)]
pub struct Axis {
    pub title: String,
    pub step: f64,
}

/// A recording along the time axis.
#[derive(Serialize)]
pub struct Panel {
    pub name: String,
    /// The position of its first row on the common axis, and its length (s).
    pub at: f64,
    pub length: f64,
    /// The time of its first row on its own clock (s).
    pub from: f64,
}

/// One line or cloud of dots.
#[derive(Serialize)]
pub struct Series {
    pub name: &'static str,
    /// The style class: before, after, effect.
    pub colour: &'static str,
    pub dots: bool,
    /// The indices of the figures that show it.
    pub on: Vec<usize>,
    pub values: Vec<Cell>,
}

/// A value in steps, a missing value, or the end of a line.
#[derive(Clone, Copy, Serialize)]
#[serde(untagged)]
pub enum Cell {
    At(i64),
    Missing(()),
    Gap(&'static str),
}

impl Cell {
    /// A missing value: the line continues.
    pub const MISSING: Self = Self::Missing(());
    /// The end of a line.
    pub const GAP: Self = Self::Gap("-");

    /// `value` in steps; a gap where it is not finite.
    pub fn of(value: f64, step: f64) -> Self {
        let steps = (value / step).round();
        if steps.is_finite() { Self::At(steps as i64) } else { Self::GAP }
    }
}

impl Axis {
    /// An axis for values up to `largest` that are shown divided by `factor`: ten thousand steps, a tenth of a pixel each.
    pub fn new(title: String, largest: f64, factor: f64) -> Self {
        let largest = if largest.is_finite() && largest > 0.0 { largest } else { factor };
        // A round step is a short number in the page.
        let exact = largest / factor / 1e4;
        let power = 10_f64.powf(exact.log10().floor());
        Self { title, step: power }
    }
}

/// Positions as differences from the one before.
pub fn differences(places: &[i64]) -> Vec<i64> {
    let before = std::iter::once(0).chain(places.iter().copied());
    places.iter().zip(before).map(|(place, before)| place - before).collect()
}

/// The drawings of `data`, with the data for the viewer; without scripts, the drawings are shown.
pub fn zoomable(data: Option<&Data>, drawings: Markup) -> Markup {
    let text = data.and_then(|data| serde_json::to_string(data).ok());
    html! {
        @match text {
            // The text in a script element must not contain its end tag.
            Some(text) => div.zoomable {
                (drawings)
                script type="application/json" { (PreEscaped(text.replace('<', "\\u003c"))) }
            },
            None => (drawings),
        }
    }
}
