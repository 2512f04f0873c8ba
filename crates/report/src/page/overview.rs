//! The first screen: the held-out error in one sentence, and the findings as a table.

use maud::{Markup, html};

use super::{Page, key};
use crate::{numbers, terminal, words};

impl Page<'_> {
    /// `4 recordings, 1 held out`.
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

    /// The held-out error in a sentence, and why the data are not enough where they are not.
    pub(super) fn lead(&self) -> Markup {
        // Joints with a model error; the effects cannot improve the others.
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
            " times the torque's standard deviation (median over the joints with a model error)."
        } else {
            " times the torque's standard deviation."
        };
        html! {
            @if let (Some(before), Some(after)) = (before, after) {
                p.lead {
                    @if self.report.findings.is_empty() {
                        "On the held-out recordings, the model's RMS torque error is " (numbers::nrmse(before)) (of_joints)
                    } @else {
                        "On the held-out recordings, the RMS torque error " (changes(before, after)) " from "
                        b { (numbers::nrmse(before)) } " to " b { (numbers::nrmse(after)) } (of_joints)
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
                    th { "joint" } th { "effect" } th { "size with its 95 % interval" } th { "share of the torque" }
                    th.n { "probability" } th.n { (terminal::error_title(self.report)) } th { "could also be" }
                } }
                tbody {
                    @for (index, finding) in self.report.findings.iter().enumerate() {
                        @let joint = finding.joint.as_deref();
                        @let is_continued = last.replace(joint) == Some(joint);
                        tr class=[is_continued.then_some("continued")] {
                            td.name { @if is_continued { (words::joint(joint)) } @else { (self.link(joint)) } }
                            td { a href={ "#finding-" (index + 1) } { (words::effect(finding)) } }
                            td.nowrap {
                                @if let Some((name, parameter)) = words::main_parameter(finding) {
                                    (numbers::with_interval(name, parameter))
                                }
                            }
                            td.nowrap { (bar(finding.share)) (numbers::share(finding.share)) }
                            td.n { (numbers::probability(finding.probability)) }
                            td.n { (terminal::error(self.report, finding)) }
                            td.small { (terminal::alternatives(finding)) }
                        }
                    }
                    @for open in &self.report.unexplained {
                        tr {
                            td.name { (self.link(Some(&open.joint))) }
                            td { "unexplained residual" }
                            td { "–" }
                            td.nowrap { (bar(open.share)) (numbers::share(open.share)) }
                            td.n { "–" }
                            td.n { (terminal::error_of(self.report, &open.joint)) }
                            td {}
                        }
                    }
                }
            } }
            p.small.soft {
                "Share: standard deviation of the effect's torque over the standard deviation of the measured torque. The error is \
                 the RMS torque error over the standard deviation of the measured torque, with the nominal model → with all effects \
                 found; held-out recordings are not used in any fit. The error belongs to the joint and is repeated for each of its \
                 findings."
            }
        }
    }

    /// The legend of a residual's colours.
    pub(super) fn residual_key(&self, has_windows: bool) -> Markup {
        html! {
            (key("k-before", "before: measured − nominal model"))
            (key("k-after", "after: measured − nominal model − effects found"))
            (key("box k-rest", "at rest, not fitted"))
            @if has_windows { (key("box k-window", "largest residual")) }
        }
    }
}

fn changes(before: f64, after: f64) -> &'static str {
    if after < before { "falls" } else { "rises" }
}

fn bar(share: f64) -> Markup {
    let width = 4.5 * share.clamp(0.0, 1.2);
    html! { span.bar style={ "width:" (format!("{width:.2}")) "rem" } {} }
}
