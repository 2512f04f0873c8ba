//! The figure of a proof on published recordings: the ratio of each estimated to the published value, with its interval.

use report::chart::{Scale, Svg};
use scoring::{Compared, Evidence};

use super::Tried;

const WIDTH: f64 = 760.0;
const LEFT: f64 = 330.0;
const RIGHT: f64 = 740.0;
const TOP: f64 = 26.0;
const STEP: f64 = 17.0;
/// The ticks of the ratio; the first and the last one are the ends of the axis.
const TICKS: [f64; 7] = [0.25, 0.5, 0.8, 1.0, 1.25, 2.0, 4.0];

/// The figure of all values that were estimated, with hollow circles for constants of models; `None` if there are none.
pub fn numbers(robots: &[Tried]) -> Option<String> {
    let mut rows: Vec<(String, Evidence, &Compared)> = Vec::new();
    for tried in robots {
        for outcome in &tried.score.said {
            let joint = outcome.said.joint.as_deref().unwrap_or("whole arm");
            let effect = outcome.said.effects.join(" or ").replace('_', " ");
            for number in outcome.numbers.iter().filter(|number| number.found.is_some()) {
                let label = format!("{} {joint}: {effect}, {}", tried.robot.name, number.parameter);
                rows.push((label, outcome.said.evidence, number));
            }
        }
    }
    if rows.is_empty() {
        return None;
    }
    let bottom = TOP + STEP * rows.len() as f64;
    let mut svg = Svg::new(WIDTH, bottom + 40.0, "Ratio of estimated to published values");
    let ends = [TICKS[0].ln(), TICKS[TICKS.len() - 1].ln()];
    let x = Scale::new(ends, [LEFT, RIGHT]);
    // A ratio that is off the axis, or negative, is drawn at its end.
    let place = |ratio: f64| x.place(ratio.max(TICKS[0]).ln().min(ends[1]));
    for tick in TICKS {
        let at = place(tick);
        svg.line([at, TOP], [at, bottom], if tick == 1.0 { "zero" } else { "grid" });
        svg.text([at, bottom + 16.0], "tick", "middle", &format!("{tick}"));
    }
    let middle = 0.5 * (LEFT + RIGHT);
    svg.text([middle, bottom + 34.0], "axis", "middle", "estimated over published value");
    for (k, (label, evidence, number)) in rows.iter().enumerate() {
        let y = TOP + STEP * (k as f64 + 0.5);
        svg.text([LEFT - 12.0, y + 4.0], "tick", "end", label);
        let over = |value: f64| value / number.published;
        if let [Some(low), Some(high)] = number.ci95 {
            svg.line([place(over(low)), y], [place(over(high)), y], "span");
        }
        let class = if *evidence == Evidence::Constant { "dot-learned" } else { "dot-after" };
        svg.circle([place(over(number.found.unwrap_or_default())), y], 4.0, class);
    }
    Some(svg.finish())
}
