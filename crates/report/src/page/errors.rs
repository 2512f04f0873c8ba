//! How well each joint's torque is predicted: chart and table of the errors, and the simulated motion.

use diagnosis::JointFit;
use effects::Quantity;
use maud::{PreEscaped, html};

use super::table::{number, table, words};
use super::{Page, Section, key};
use crate::chart::Svg;
use crate::numbers;

/// The height of a joint's two lines.
const ROW: f64 = 40.0;
/// The ends of the axis, in per cent of the width.
const LEFT: f64 = 3.0;
const RIGHT: f64 = 97.0;

impl Page<'_> {
    /// The joints with a fit, base to tip, with their numbers.
    fn fits(&self) -> Vec<(usize, &str, &JointFit)> {
        let joints = self.figures.arm.joints().iter().enumerate();
        joints.filter_map(|(i, joint)| Some((i, joint.name.as_str(), self.report.fit.get(&joint.name)?))).collect()
    }

    /// Errors by joint.
    pub(super) fn errors(&self) -> Option<Section> {
        let fits = self.fits();
        if fits.is_empty() {
            return None;
        }
        let optional = |value: Option<f64>| value.map_or("–".to_owned(), numbers::nrmse);
        let is_held_out = fits.iter().any(|(_, _, fit)| fit.held_out_nrmse_nominal.is_some());
        let columns = [
            words("joint"),
            number("torque, standard deviation"),
            number("nominal"),
            number("with effects"),
            number("learned"),
            number("at rest, nominal → with effects"),
            number("training, nominal → with effects"),
            number("autocorrelation at 0.1 s"),
        ];
        let rows = fits.iter().map(|(joint, name, fit)| {
            vec![
                self.link(Some(name)),
                html! { (numbers::quantity(fit.torque_std, self.figures.torque_unit(*joint))) },
                html! { (optional(fit.held_out_nrmse_nominal)) },
                html! { span class=[verdict_of(fit)] { (optional(fit.held_out_nrmse_augmented)) } },
                html! { (optional(fit.held_out_nrmse_learned)) },
                html! { (numbers::before_after(fit.held_out_nrmse_resting_nominal, fit.held_out_nrmse_resting)) },
                html! { (numbers::before_after(Some(fit.train_nrmse_nominal), Some(fit.train_nrmse_augmented))) },
                html! { (numbers::fixed(fit.residual_autocorrelation, 2)) },
            ]
        });
        let rows = rows.collect();
        let body = html! {
            @if !is_held_out {
                p { "No recording was held out. These are the errors on the training recordings, which underestimate the error on other motions." }
            }
            figure {
                (PreEscaped(dumbbells(&fits)))
                figcaption {
                    p { "RMS torque error over the torque's standard deviation (logarithmic)" }
                    (key("dot k-before", "nominal model")) (key("dot k-after", "with the effects found"))
                    @if is_held_out { (key("dot k-learned", "learned correction (Independent Joint Learning), for comparison")) }
                }
            }
            (table(&columns, rows))
            p.small.soft {
                "Errors are RMS torque errors over the standard deviation of the measured torque: a prediction by the mean torque \
                 has an error of 1. The columns nominal, with effects and learned are for the held-out recordings while the joint \
                 moves. At rest, dry friction can hold any torque up to its level, and the error is the excess over that level. The \
                 last column is the autocorrelation of the residual at a lag of 0.1 s: a value near 0 means that the residual is \
                 noise."
            }
        };
        Some(Section::new("errors", html! { "Torque error of each joint" }, body))
    }

    /// How closely the simulated arm follows the recording.
    pub(super) fn rollout(&self) -> Option<Section> {
        if self.report.rollout.is_empty() {
            return None;
        }
        let rows = self.figures.arm.joints().iter().filter_map(|joint| {
            let rollout = self.report.rollout.get(&joint.name)?;
            let unit = Quantity::Position.unit(joint.kind);
            let factor = rollout.nominal_rms_rad / rollout.augmented_rms_rad;
            Some(vec![
                self.link(Some(&joint.name)),
                html! { (numbers::quantity(rollout.nominal_rms_rad, unit)) },
                html! { (numbers::quantity(rollout.augmented_rms_rad, unit)) },
                html! { span class=[better(factor, 1.1)] { (numbers::fixed(factor, usize::from(factor < 10.0))) } },
            ])
        });
        let columns =
            [words("joint"), number("nominal, RMS position error"), number("with effects"), number("reduction factor")];
        let body = html! {
            p { "The simulated arm is driven by the recorded torques, first with the nominal model, then with the effects found." }
            (table(&columns, rows.collect()))
        };
        let title = html! { "Simulated motion compared with the recording" };
        Some(Section::new("simulation", title, body))
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

/// One row per joint: the nominal, augmented and learned error on a logarithmic axis. Places across are shares of the width, so
/// that the text keeps its size on any screen.
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
    let bottom = ROW * fits.len() as f64 + 6.0;
    let mut svg = Svg::stretched(bottom + 24.0, "torque error of every joint");
    let digits = if ends[1] - ends[0] > 2.2 { &[1.0][..] } else { &[1.0, 2.0, 5.0] };
    for power in -4..=4 {
        for digit in digits {
            let value = digit * 10_f64.powi(power);
            if (ends[0]..=ends[1]).contains(&value.log10()) {
                let (x, class) = (place(value), if value == 1.0 { "zero" } else { "grid" });
                svg.raw(format_args!(
                    "<line class=\"{class}\" x1=\"{x:.2}%\" x2=\"{x:.2}%\" y1=\"4\" y2=\"{bottom:.0}\"/>\
                     <text class=\"tick\" text-anchor=\"middle\" x=\"{x:.2}%\" y=\"{:.0}\">{}</text>",
                    bottom + 16.0,
                    numbers::nrmse(value)
                ));
            }
        }
    }
    for (row, (joint, name, fit)) in fits.iter().enumerate() {
        let y = ROW * (row as f64 + 1.0) - 10.0;
        svg.text([0.0, y - 14.0], "tick", "start", &format!("{} · {name}", joint + 1));
        let [nominal, augmented, learned] = values(fit);
        // If the two coincide, one is a ring around the other.
        let meet = matches!((nominal, augmented), (Some(a), Some(b)) if (place(a) - place(b)).abs() < 1.0);
        if let (Some(nominal), Some(augmented)) = (nominal, augmented) {
            svg.raw(format_args!(
                "<line class=\"span\" x1=\"{:.2}%\" x2=\"{:.2}%\" y1=\"{y:.0}\" y2=\"{y:.0}\"/>",
                place(nominal),
                place(augmented)
            ));
        }
        for (value, class, radius) in [
            (learned, "dot-learned", 5.0),
            (nominal, "dot-before", if meet { 8.0 } else { 6.0 }),
            (augmented, "dot-after", if meet { 4.5 } else { 6.0 }),
        ] {
            if let Some(value) = value {
                svg.raw(format_args!(
                    "<circle class=\"{class}\" cx=\"{:.2}%\" cy=\"{y:.0}\" r=\"{radius}\"/>",
                    place(value)
                ));
            }
        }
    }
    svg.finish()
}
