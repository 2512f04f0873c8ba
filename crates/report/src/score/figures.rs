//! The drawings of a proof: shares with their intervals.

use scoring::{Calibration, Counted, Curve, Measure};

use crate::chart::{Scale, Svg};
use crate::numbers::percent_to_a_tenth as percent;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 250.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 740.0;
const TOP: f64 = 16.0;
const BOTTOM: f64 = 200.0;

fn frame(label: &str, title: &str) -> (Svg, Scale) {
    let mut svg = Svg::new(WIDTH, HEIGHT, label);
    let y = Scale::new([0.0, 1.0], [BOTTOM, TOP]);
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let at = y.place(share);
        svg.line([LEFT, at], [RIGHT, at], if share == 0.0 { "zero" } else { "grid" });
        svg.text([LEFT - 8.0, at + 4.0], "tick", "end", &percent(share));
    }
    svg.upwards([14.0, 0.5 * (TOP + BOTTOM)], "axis", title);
    (svg, y)
}

/// A share with its interval.
fn point(svg: &mut Svg, y: &Scale, x: f64, counted: &Counted) {
    let Some(share) = counted.share() else { return };
    let [low, high] = counted.wilson.map(|bound| y.place(bound));
    svg.line([x, low], [x, high], "span");
    svg.circle([x, y.place(share)], 5.0, "dot-after");
}

/// Detection against size, bin by bin.
pub fn detection(curve: &Curve) -> String {
    let is_share = curve.measure == Measure::ExpressedShare;
    let (mut svg, y) = frame("Detection against size", "found");
    let step = (RIGHT - LEFT) / curve.bins.len().max(1) as f64;
    for (k, bin) in curve.bins.iter().enumerate() {
        let x = LEFT + (k as f64 + 0.5) * step;
        if let Some(covered) = bin.covered.share() {
            svg.circle([x, y.place(covered)], 7.5, "dot-learned");
        }
        point(&mut svg, &y, x, &bin.found);
        let show = |value: f64| if is_share { percent(value) } else { format!("{value}×") };
        let label = match bin.to {
            Some(to) => format!("{} – {}", show(bin.from), show(to)),
            None => format!("≥ {}", show(bin.from)),
        };
        svg.text([x, BOTTOM + 18.0], "tick", "middle", &label);
        let count = format!("{} of {}", bin.found.hits, bin.found.of);
        svg.text([x, BOTTOM + 34.0], "tick", "middle", &count);
    }
    svg.finish()
}

/// Outcome against probability.
pub fn calibration(calibration: &Calibration) -> String {
    let (mut svg, y) = frame("Calibration of the probabilities", "correct");
    let x = Scale::new([0.4, 1.0], [LEFT, RIGHT]);
    svg.line([x.place(0.4), y.place(0.4)], [x.place(1.0), y.place(1.0)], "mark");
    for share in [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0] {
        svg.text([x.place(share), BOTTOM + 18.0], "tick", "middle", &percent(share));
    }
    svg.text([0.5 * (LEFT + RIGHT), BOTTOM + 38.0], "axis", "middle", "stated probability");
    for bin in &calibration.bins {
        point(&mut svg, &y, x.place(bin.said.max(0.4)), &bin.right);
    }
    svg.finish()
}
