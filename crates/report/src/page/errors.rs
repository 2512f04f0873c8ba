//! How well each joint's torque is predicted: chart and table of the errors, and the simulated motion.

use arm::JointKind;
use diagnosis::JointFit;
use maud::{Markup, PreEscaped, html};

use super::{Page, key};
use crate::chart::Svg;
use crate::numbers;

const WIDTH: f64 = 1080.0;
const ROW: f64 = 30.0;
const LEFT: f64 = 250.0;
const RIGHT: f64 = 1050.0;

impl Page<'_> {
    /// The joints with a fit, base to tip, with their numbers.
    fn fits(&self) -> Vec<(usize, &str, &JointFit)> {
        let joints = self.figures.arm.joints().iter().enumerate();
        joints
            .filter_map(|(i, joint)| Some((i, joint.name.as_str(), self.report.fit.get(&joint.name)?)))
            .collect()
    }

    /// Errors by joint.
    pub(super) fn errors(&self) -> Markup {
        let fits = self.fits();
        if fits.is_empty() {
            return html! {};
        }
        let optional = |value: Option<f64>| value.map_or("–".to_owned(), numbers::nrmse);
        let is_held_out = fits.iter().any(|(_, _, fit)| fit.held_out_nrmse_nominal.is_some());
        html! {
            h2 { "Torque error of each joint" }
            @if !is_held_out {
                p { "No recording was held out. These are the errors on the training recordings, which underestimate the error on other motions." }
            }
            figure {
                (PreEscaped(dumbbells(&fits)))
                figcaption {
                    (key("dot k-before", "nominal model")) (key("dot k-after", "with the effects found"))
                    @if is_held_out { (key("dot k-learned", "learned correction (Independent Joint Learning), for comparison")) }
                }
            }
            div.scroll { table {
                thead { tr {
                    th { "joint" } th.n { "torque, standard deviation" }
                    th.n { "nominal" } th.n { "with effects" } th.n { "learned" }
                    th.n { "at rest, nominal → with effects" } th.n { "training, nominal → with effects" } th.n { "autocorrelation at 0.1 s" }
                } }
                tbody {
                    @for (joint, name, fit) in &fits {
                        tr {
                            td.name { (self.link(Some(name))) }
                            td.n { (numbers::quantity(fit.torque_std, self.figures.torque_unit(*joint))) }
                            td.n { (optional(fit.held_out_nrmse_nominal)) }
                            td.n { span class=[verdict_of(fit)] { (optional(fit.held_out_nrmse_augmented)) } }
                            td.n { (optional(fit.held_out_nrmse_learned)) }
                            td.n { (numbers::before_after(fit.held_out_nrmse_resting_nominal, fit.held_out_nrmse_resting)) }
                            td.n { (numbers::before_after(Some(fit.train_nrmse_nominal), Some(fit.train_nrmse_augmented))) }
                            td.n { (numbers::fixed(fit.residual_autocorrelation, 2)) }
                        }
                    }
                }
            } }
            p.small.soft {
                "Errors are RMS torque errors over the standard deviation of the measured torque: a prediction by the mean torque \
                 has an error of 1. The columns nominal, with effects and learned are for the held-out recordings while the joint \
                 moves. At rest, dry friction can hold any torque up to its level, and the error is the excess over that level. The \
                 last column is the autocorrelation of the residual at a lag of 0.1 s: a value near 0 means that the residual is \
                 noise."
            }
        }
    }

    /// How closely the simulated arm follows the recording.
    pub(super) fn rollout(&self) -> Markup {
        if self.report.rollout.is_empty() {
            return html! {};
        }
        let joints = self.figures.arm.joints();
        html! {
            h2 { "Simulated motion compared with the recording" }
            p { "The simulated arm is driven by the recorded torques, first with the nominal model, then with the effects found." }
            div.scroll { table {
                thead { tr {
                    th { "joint" } th.n { "nominal, RMS position error" } th.n { "with effects" } th.n { "reduction factor" }
                } }
                tbody {
                    @for joint in joints {
                        @if let Some(rollout) = self.report.rollout.get(&joint.name) {
                            @let unit = if joint.kind == JointKind::Prismatic { "m" } else { "rad" };
                            @let factor = rollout.nominal_rms_rad / rollout.augmented_rms_rad;
                            tr {
                                td.name { (self.link(Some(&joint.name))) }
                                td.n { (numbers::quantity(rollout.nominal_rms_rad, unit)) }
                                td.n { (numbers::quantity(rollout.augmented_rms_rad, unit)) }
                                td.n { span class=[better(factor, 1.1)] { (numbers::fixed(factor, usize::from(factor < 10.0))) } }
                            }
                        }
                    }
                }
            } }
        }
    }
}

/// The style class of an error that fell or rose; none where it hardly changed.
fn verdict_of(fit: &JointFit) -> Option<&'static str> {
    let factor = fit.held_out_nrmse_nominal? / fit.held_out_nrmse_augmented?;
    better(factor, 1.02)
}

fn better(factor: f64, from: f64) -> Option<&'static str> {
    if factor > from {
        Some("better")
    } else if factor < 1.0 / from {
        Some("worse")
    } else {
        None
    }
}

/// One row per joint: the nominal, augmented and learned error on a logarithmic axis.
fn dumbbells(fits: &[(usize, &str, &JointFit)]) -> String {
    let values = |fit: &JointFit| match (fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented) {
        (None, None) => [Some(fit.train_nrmse_nominal), Some(fit.train_nrmse_augmented), None],
        (nominal, augmented) => [nominal, augmented, fit.held_out_nrmse_learned],
    };
    let all = fits.iter().flat_map(|(_, _, fit)| values(fit)).flatten();
    let (mut low, mut high) = (0.1_f64, 1.0_f64);
    for value in all.filter(|value| value.is_finite() && *value > 0.0) {
        low = low.min(value.max(1e-4));
        high = high.max(value.min(1e4));
    }
    let ends = [(0.85 * low).log10(), (1.15 * high).log10()];
    let place = |value: f64| {
        let share = (value.max(1e-4).log10() - ends[0]) / (ends[1] - ends[0]);
        LEFT + share.clamp(0.0, 1.0) * (RIGHT - LEFT)
    };
    let bottom = 10.0 + ROW * fits.len() as f64;
    let mut svg = Svg::new(WIDTH, bottom + 40.0, "torque error of every joint");
    for power in -4..=4 {
        for digit in [1.0, 2.0, 5.0] {
            let value = digit * 10_f64.powi(power);
            if (ends[0]..=ends[1]).contains(&value.log10()) {
                let x = place(value);
                svg.line([x, 4.0], [x, bottom], if value == 1.0 { "zero" } else { "grid" });
                svg.text([x, bottom + 16.0], "tick", "middle", &numbers::nrmse(value));
            }
        }
    }
    let title = "RMS torque error over the torque's standard deviation (logarithmic)";
    svg.text([0.5 * (LEFT + RIGHT), bottom + 35.0], "axis", "middle", title);
    for (row, (joint, name, fit)) in fits.iter().enumerate() {
        let y = 10.0 + ROW * (row as f64 + 0.5);
        let name: String = name.chars().take(32).collect();
        svg.text(
            [LEFT - 16.0, y + 4.0],
            "tick",
            "end",
            &format!("{} · {name}", joint + 1),
        );
        let [nominal, augmented, learned] = values(fit);
        // Where the two meet, one is a ring about the other.
        let meet = matches!((nominal, augmented), (Some(a), Some(b)) if (place(a) - place(b)).abs() < 8.0);
        if let (Some(nominal), Some(augmented)) = (nominal, augmented) {
            svg.line([place(nominal), y], [place(augmented), y], "span");
        }
        for (value, class, radius) in [
            (learned, "dot-learned", 5.0),
            (nominal, "dot-before", if meet { 8.0 } else { 6.0 }),
            (augmented, "dot-after", if meet { 4.5 } else { 6.0 }),
        ] {
            if let Some(value) = value {
                svg.circle([place(value), y], radius, class);
            }
        }
    }
    svg.finish()
}
