//! The first screen: what the numbers say in a line, and the findings as a table.

use maud::{Markup, html};

use super::{Page, key};
use crate::{numbers, terminal, words};

impl Page<'_> {
    /// `3 recordings to learn from, 1 held out`.
    pub(super) fn recordings_in_short(&self) -> String {
        let names = &self.report.recordings;
        let held_out = match names.held_out.len() {
            0 => "none held out".to_owned(),
            some => format!("{some} held out"),
        };
        format!(
            "{}, {held_out}",
            words::count(names.train.len() + names.held_out.len(), "recording")
        )
    }

    /// The held-out error in a sentence, and what stands in the way of saying more.
    pub(super) fn lead(&self) -> Markup {
        // Joints where the model misses: the others have nothing to gain.
        let missed = |name: &str| self.report.located.iter().any(|located| located.joint == name);
        let any = self.report.fit.keys().any(|name| missed(name));
        let fits = || {
            self.report
                .fit
                .iter()
                .filter(|(name, _)| !any || missed(name))
                .map(|(_, fit)| fit)
        };
        let median = |pick: fn(&diagnosis::JointFit) -> Option<f64>| {
            let mut errors: Vec<f64> = fits().filter_map(pick).filter(|error| error.is_finite()).collect();
            errors.sort_by(f64::total_cmp);
            errors.get(errors.len().saturating_sub(1) / 2).copied()
        };
        let before = median(|fit| fit.held_out_nrmse_nominal);
        let after = median(|fit| fit.held_out_nrmse_augmented);
        let of_joints = if self.report.fit.len() > 1 {
            " (median of the joints where the model misses)."
        } else {
            "."
        };
        html! {
            @if let (Some(before), Some(after)) = (before, after) {
                p.lead {
                    @if self.report.findings.is_empty() {
                        "On recordings that were held out, the model's torque error is " (numbers::nrmse(before))
                        " of the torque's spread" (of_joints)
                    } @else {
                        "On recordings that were held out, the torque error falls from " b { (numbers::nrmse(before)) }
                        " to " b { (numbers::nrmse(after)) } " of the torque's spread" (of_joints)
                    }
                }
            }
            @if !self.report.not_enough_data.is_empty() {
                div.finding.open {
                    h4 { "Not enough data" }
                    ul { @for reason in &self.report.not_enough_data { li { (reason) } } }
                }
            }
        }
    }

    /// All findings in a table.
    pub(super) fn overview(&self) -> Markup {
        if self.report.findings.is_empty() && self.report.unexplained.is_empty() {
            return html! {};
        }
        let mut last = None;
        html! {
            h2 { "What was found" }
            div.scroll { table {
                thead { tr {
                    th { "joint" } th { "cause" } th { "size, with its 95 % interval" } th { "share of the torque" }
                    th.n { "probability" } th.n { "held-out error" } th { "could also be" }
                } }
                tbody {
                    @for (index, finding) in self.report.findings.iter().enumerate() {
                        @let joint = finding.joint.as_deref();
                        @let is_continued = last.replace(joint) == Some(joint);
                        tr class=[is_continued.then_some("continued")] {
                            td.name { @if is_continued { (words::joint(joint)) } @else { (self.link(joint)) } }
                            td { a href={ "#finding-" (index + 1) } { (words::cause(finding)) } }
                            td.nowrap {
                                @if let Some((name, parameter)) = words::main_parameter(finding) {
                                    (numbers::with_interval(name, parameter))
                                }
                            }
                            td.nowrap { (bar(finding.share)) (numbers::percent(finding.share)) }
                            td.n { (numbers::probability(finding.probability)) }
                            td.n { (terminal::held_out(self.report, finding)) }
                            td.small { (terminal::alternatives(finding)) }
                        }
                    }
                    @for left in &self.report.unexplained {
                        tr {
                            td.name { (self.link(Some(&left.joint))) }
                            td { "unexplained" }
                            td { "–" }
                            td.nowrap { (bar(left.share)) (numbers::percent(left.share)) }
                            td.n { "–" }
                            td.n { (self.held_out_of(&left.joint)) }
                            td {}
                        }
                    }
                }
            } }
            p.small.soft {
                "Share: spread (standard deviation) of the effect's torque over that of the measured torque. Held-out error: RMS of \
                 what the model does not explain, over the spread of the measured torque, on recordings that nothing was fitted to; \
                 nominal model → with all effects named. It is the joint's, so it repeats where a joint has several findings."
            }
        }
    }

    fn held_out_of(&self, joint: &str) -> String {
        self.report.fit.get(joint).map_or("–".into(), |fit| {
            numbers::before_after(fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented)
        })
    }

    /// What the colours of a residual mean.
    pub(super) fn residual_key(&self, has_windows: bool) -> Markup {
        html! {
            (key("k-before", "before: measured − nominal model"))
            (key("k-after", "after: − named effects too"))
            (key("box k-rest", "at rest, not fitted"))
            @if has_windows { (key("box k-window", "where it is largest")) }
        }
    }
}

fn bar(share: f64) -> Markup {
    let width = 4.5 * share.clamp(0.0, 1.2);
    html! { span.bar style={ "width:" (format!("{width:.2}")) "rem" } {} }
}
