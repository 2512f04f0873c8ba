//! One section per joint: its residual over time, then each finding with its figures and parameters.

use diagnosis::{Finding, Located, Parameter, TimeWindow, Unexplained};
use maud::{Markup, PreEscaped, html};

use super::against::Against;
use super::clouds::Cloud;
use super::place::regions;
use super::table::{name, number, table, words as text};
use super::zoom::zoomable;
use super::{Page, Section, key};
use crate::{alternatives, not_diagnosed, numbers, sizes, words};

/// The share of a joint's torque from which a whole-arm effect is shown in the joint's section.
const SHOWN_SHARE: f64 = 0.02;

impl Page<'_> {
    fn findings_on(&self, joint: Option<&str>) -> Vec<(usize, &Finding)> {
        let all = self.report.findings.iter().enumerate();
        all.filter(|(_, finding)| finding.joint.as_deref() == joint).collect()
    }

    fn located(&self, joint: &str) -> Option<&Located> {
        self.report.located.iter().find(|located| located.joint == joint)
    }

    /// Whether the joint has a finding or an unexplained residual that its section can show.
    pub(super) fn has_section(&self, joint: usize) -> bool {
        let name = self.figures.arm.joints()[joint].name.as_str();
        let touches = |finding: &Finding| {
            finding.joint.as_deref() == Some(name)
                || finding.share_by_joint.get(name).is_some_and(|share| *share >= SHOWN_SHARE)
        };
        self.report.findings.iter().any(touches)
            || self.report.unexplained.iter().any(|open| open.joint == name)
            || self.located(name).is_some()
    }

    /// The findings of the whole arm, each drawn on the joint where it shows most.
    pub(super) fn whole_arm(&self) -> Option<Section> {
        let findings = self.findings_on(None);
        let body = html! { @for (index, finding) in &findings { (self.finding(*index, finding)) } };
        (!findings.is_empty()).then(|| Section::new("whole-arm", html! { "Whole arm" }, body))
    }

    /// The section of one joint.
    pub(super) fn joint(&self, joint: usize) -> Option<Section> {
        if !self.has_section(joint) {
            return None;
        }
        let joint_name = self.figures.arm.joints()[joint].name.as_str();
        let located = self.located(joint_name);
        let windows = located.map_or(&[][..], |located| &located.time);
        let body = html! {
            (self.stats(joint, joint_name, located))
            (self.strip(joint, windows))
            @if let Some(located) = located { (regions(located, &self.figures.arm.joints()[joint])) }
            @for (index, finding) in self.findings_on(Some(joint_name)) { (self.finding(index, finding)) }
            @let others = self.shared(joint_name);
            @if !others.is_empty() {
                p { "Effects of the whole arm or of other joints also act on this joint: "
                    @for (number, (index, finding)) in others.iter().enumerate() {
                        @if number > 0 { ", " }
                        a href={ "#finding-" (index + 1) } { (words::effect(finding)) }
                        @if let Some(share) = finding.share_by_joint.get(joint_name) { " (" (numbers::share(*share)) " of the torque)" }
                    }
                    "."
                }
            }
            @for open in self.report.unexplained.iter().filter(|open| open.joint == joint_name) {
                div.finding.open {
                    h4 { "Unexplained residual" span.size { (numbers::of_torque_spread(open.share)) } }
                    p.sentence {
                        @if open.depends_on.is_empty() && self.report.is_requested {
                            "The residual has structure. Other effects were not searched."
                        } @else if open.depends_on.is_empty() {
                            "The residual has structure, but no regressor that was tried predicts it."
                        } @else {
                            @let on: Vec<String> = open.depends_on.iter().map(words::dependence).collect();
                            "The residual depends on " (words::list(&on)) ", in a way that no effect in the catalogue describes."
                        }
                    }
                    (self.residuals_against(joint, open))
                    @if !open.next.is_empty() { p { b { "Next experiment: " } (open.next) "." } }
                }
            }
        };
        let title = html! { "Joint " (joint + 1) " · " (name(joint_name)) };
        Some(Section::new(format!("joint-{}", joint + 1), title, body))
    }

    /// The residual against the quantities that it depends on, in at most two figures.
    fn residuals_against(&self, joint: usize, open: &Unexplained) -> Markup {
        let arm = self.figures.arm;
        let states = open.depends_on.iter().filter_map(|on| Against::of_dependence(on, arm));
        let clouds: Vec<Cloud> =
            states.filter_map(|against| self.figures.unexplained(joint, against)).take(2).collect();
        html! {
            @if !clouds.is_empty() {
                div.pair {
                    @for cloud in clouds {
                        (zoomable(Some(&cloud.data), html! {
                            figure {
                                div.plot { (PreEscaped(&cloud.after)) }
                                figcaption { (key("k-after", "residual with all effects found")) }
                            }
                        }))
                    }
                }
            }
        }
    }

    /// The residual of a joint over time.
    fn strip(&self, joint: usize, windows: &[TimeWindow]) -> Markup {
        let Some(strip) = self.figures.over_time(joint, windows) else {
            return html! {};
        };
        let data = self.figures.over_time_data(joint, windows);
        let figure = html! {
            figure {
                div.plot.strip { (PreEscaped(strip)) }
                figcaption { (self.residual_key(!windows.is_empty())) }
            }
        };
        zoomable(data.as_ref(), figure)
    }

    /// The residuals of the joints without a section, in a collapsed block.
    pub(super) fn quiet_joints(&self) -> Option<Section> {
        let is_quiet = |joint: &usize| {
            let name = &self.figures.arm.joints()[*joint].name;
            !self.has_section(*joint) && !not_diagnosed::has(self.report, name)
        };
        let quiet = (0..self.figures.arm.dof()).filter(is_quiet);
        let strips: Vec<_> =
            quiet.map(|joint| (joint, self.strip(joint, &[]))).filter(|(_, strip)| !strip.0.is_empty()).collect();
        let body = html! {
            details {
                summary { "Their residuals over time (" (strips.len()) ")" }
                @for (joint, strip) in &strips {
                    h3 { "Joint " (joint + 1) " · " (name(&self.figures.arm.joints()[*joint].name)) }
                    (strip)
                }
            }
        };
        (!strips.is_empty()).then(|| Section::new("quiet", html! { "Joints without findings" }, body))
    }

    /// Findings of other joints or of the whole arm that act on this joint.
    fn shared(&self, name: &str) -> Vec<(usize, &Finding)> {
        let all = self.report.findings.iter().enumerate();
        all.filter(|(_, finding)| {
            finding.joint.as_deref() != Some(name)
                && finding.share_by_joint.get(name).is_some_and(|share| *share >= SHOWN_SHARE)
        })
        .collect()
    }

    fn stats(&self, joint: usize, name: &str, located: Option<&Located>) -> Markup {
        let Some(fit) = self.report.fit.get(name) else {
            return html! {};
        };
        let unit = self.figures.torque_unit(joint);
        html! {
            ul.stats {
                @if fit.held_out_nrmse_nominal.is_some() {
                    li { b { (numbers::before_after(fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented)) }
                        "held-out error, nominal → with effects" }
                } @else {
                    li { b { (numbers::before_after(Some(fit.train_nrmse_nominal), Some(fit.train_nrmse_augmented))) }
                        "training error, nominal → with effects" }
                }
                li { b { (numbers::quantity(fit.torque_std, unit)) } "standard deviation of the measured torque" }
                li { b { (numbers::quantity(fit.noise, unit)) } "measured noise" }
                @if let Some(located) = located {
                    li { b { "× " (numbers::fixed(located.over_noise, usize::from(located.over_noise < 10.0))) }
                        "nominal residual over the noise after filtering" }
                    @if let Some(share) = located.repeatable {
                        li { b { (numbers::percent(share)) } "of the residual repeats with the motion" }
                    }
                }
            }
        }
    }

    /// A finding's card.
    fn finding(&self, index: usize, finding: &Finding) -> Markup {
        let joint = words::shows_on(finding).and_then(|name| self.index(name));
        let panels = joint.and_then(|joint| Some((joint, self.figures.against_state(finding, index, joint)?)));
        html! {
            div.finding id={ "finding-" (index + 1) } {
                h4 {
                    (words::capital(&words::effect(finding)))
                    @if let Some(other) = &finding.other { " by " (other) }
                    @for size in sizes::list(finding) { span.size { (size) } }
                    span.odds {
                        (odds(finding).join(" · "))
                    }
                }
                p.sentence { (words::capital(&words::described(finding))) "." }
                @if let Some((joint, cloud)) = panels {
                    (zoomable(Some(&cloud.data), html! { div.pair {
                        figure { div.plot { (PreEscaped(&cloud.before)) } figcaption {
                            (key("k-before", if self.figures.shares_joint(index, joint) {
                                "without it: residual with all other effects found"
                            } else {
                                "nominal: measured − nominal model"
                            }))
                            (key("k-effect", "the effect"))
                        } }
                        figure { div.plot { (PreEscaped(&cloud.after)) } figcaption {
                            (key("k-after", "corrected: residual with all effects found"))
                            @if finding.joint.is_none() { "(" (name(&self.figures.arm.joints()[joint].name)) ")" }
                        } }
                    } }))
                }
                div.facts { (parameters(finding)) (self.background(finding)) }
            }
        }
    }

    /// The effect's meaning, its alternatives, and where it acts.
    fn background(&self, finding: &Finding) -> Markup {
        let wording = words::wording(finding.effect);
        let other = alternatives::text(finding);
        let experiments = words::experiments(finding);
        html! {
            dl {
                @if !wording.meaning.is_empty() { dt { "What it is" } dd { (words::capital(wording.meaning)) "." } }
                @if !other.is_empty() {
                    dt { "It could also be" }
                    dd { (words::capital(&other)) ". These recordings do not distinguish them reliably. "
                        @if !experiments.is_empty() { "Experiment that distinguishes them: " (experiments) "." } }
                }
                @if finding.place.state.is_some() || !finding.place.time.is_empty() {
                    dt { "Where" }
                    dd {
                        @if let Some(state) = &finding.place.state { (words::capital(state)) ". " }
                        @for [from, to] in &finding.place.time {
                            (format!("{from:.1} to {to:.1} s"))
                            @if let Some(recording) = &finding.place.recording { " of " (recording) }
                        }
                    }
                }
                @if finding.joint.is_none() && finding.share_by_joint.len() > 1 {
                    dt { "Share of each joint's torque" }
                    dd {
                        @for (number, (joint, share)) in finding.share_by_joint.iter().enumerate() {
                            @if number > 0 { ", " }
                            (self.link(Some(joint))) " " (numbers::share(*share))
                        }
                    }
                }
            }
        }
    }
}

/// The facts beside the title of a finding: its probability, its share of the torque, and the reduction of the held-out
/// error.
fn odds(finding: &Finding) -> Vec<String> {
    let probability = finding.probability.map(|_| format!("probability {}", numbers::probability(finding.probability)));
    let share = words::share(finding).map(|share| format!("{} of the torque", numbers::share(share)));
    let improved = if words::is_between_sensors(finding) {
        "held-out difference between the two sensors"
    } else {
        "held-out error"
    };
    let gain = finding.held_out_gain.map(|gain| format!("reduces the {improved} by {}", reduction(gain)));
    [probability, share, gain].into_iter().flatten().collect()
}

/// A reduction in per cent, which is never all of it.
fn reduction(gain: f64) -> String {
    if gain > 0.99 {
        return "more than 99 %".to_owned();
    }
    numbers::percent(gain)
}

fn parameters(finding: &Finding) -> Markup {
    let row = |(name, parameter): (&&'static str, &Parameter)| {
        let (value, interval) = numbers::value_and_interval(name, parameter);
        vec![
            html! { (words::parameter(name)) },
            html! {
                (value)
                @if parameter.unit == "rad" && parameter.value.abs() > 1e-3 {
                    " (" (numbers::short(parameter.value.to_degrees())) "°)"
                }
            },
            html! { (interval) },
        ]
    };
    let rows = finding.parameters.iter().map(row).collect();
    table(&[text("parameter"), number("value"), number("95 % interval")], rows)
}
