//! The end of the page: effects that are not testable, the next experiment, all parameters in SI units, provenance.

use std::collections::BTreeMap;

use arm::JointKind;
use diagnosis::{NotObservable, Trace};
use maud::{Markup, html};

use super::Page;
use crate::statistics::quantile;
use crate::{next_words, numbers, words};

impl Page<'_> {
    /// Effects that may be present although they were not found.
    pub(super) fn not_observable(&self) -> Markup {
        let mut groups: BTreeMap<(&str, &str), Vec<&NotObservable>> = BTreeMap::new();
        for entry in &self.report.not_observable {
            groups.entry((entry.effect, &entry.because)).or_default().push(entry);
        }
        html! {
            @if !groups.is_empty() {
                h2 { "Not testable with these recordings" }
                p { "These effects may be present: the recordings only reveal them at the sizes given." }
                div.scroll { table {
                    thead { tr { th { "effect" } th { "reason" } th { "detectable size" } } }
                    tbody {
                        @for entries in groups.values() {
                            tr {
                                td.nowrap { (words::wording(entries[0].effect).name) }
                                td { (entries[0].because) }
                                td { @for (number, entry) in entries.iter().enumerate() {
                                    @if number > 0 { ", " }
                                    span { (words::joint(entry.joint.as_deref())) " " b { (self.sizes(entry)) } }
                                } }
                            }
                        }
                    }
                } }
            }
        }
    }

    /// The next experiment, where one was requested.
    pub(super) fn next_experiment(&self) -> Markup {
        html! {
            @if let Some(next) = &self.report.next_experiment {
                h2 { "The next experiment" }
                ul { @for sentence in next_words::sentences(next) { li { (words::capital(&sentence)) "." } } }
                @if !next.separates.is_empty() {
                    div.scroll { table {
                        thead { tr { th { "finding" } th { "alternative" } th.n { "evidence now (nats)" } th.n { "with the motion" } th.n { "needed" } } }
                        tbody { @for pair in &next.separates { tr {
                            td { (next_words::name(&pair.finding)) }
                            td { (next_words::name(&pair.rival)) }
                            td.n { (numbers::short(pair.before)) }
                            td.n { (numbers::short(pair.after)) }
                            td.n { (numbers::short(pair.needed)) }
                        } } }
                    } }
                }
            }
        }
    }

    /// All parameters in SI units, for use in programs.
    pub(super) fn all_parameters(&self) -> Markup {
        html! {
            @if !self.report.findings.is_empty() {
                h2 { "All parameters, in SI units at the joint" }
                div.scroll { table {
                    thead { tr {
                        th { "joint" } th { "effect" } th { "parameter" } th.n { "value" } th.n { "from" } th.n { "to (95 %)" } th { "unit" }
                    } }
                    tbody {
                        @for finding in &self.report.findings {
                            @for (name, parameter) in &finding.parameters {
                                tr {
                                    td.name { (words::joint(finding.joint.as_deref())) }
                                    td { code { (finding.effect) } }
                                    td { code { (name) } }
                                    td.n { (numbers::for_programs(parameter.value)) }
                                    td.n { (numbers::for_programs(parameter.ci95[0])) }
                                    td.n { (numbers::for_programs(parameter.ci95[1])) }
                                    td.nowrap { (parameter.unit) }
                                }
                            }
                        }
                    }
                } }
            }
        }
    }

    /// The recordings and the program.
    pub(super) fn provenance(&self) -> Markup {
        let names = &self.report.recordings;
        let all = names.train.iter().map(|name| (name, "training"));
        let all = all.chain(names.held_out.iter().map(|name| (name, "held out")));
        let find = |name: &str| self.figures.traces.recordings.iter().find(|trace| trace.name == name);
        html! {
            h2 { "Recordings and provenance" }
            div.scroll { table {
                thead { tr { th { "recording" } th { "use" } th.n { "duration" } th.n { "sampling rate of the diagnosis" } th { "joints that move" } } }
                tbody {
                    @for (name, used) in all {
                        @let facts = find(name).map(|trace| self.facts(trace));
                        tr {
                            td.name { code { (name) } }
                            td { (used) }
                            @if let Some((length, rate, moving)) = facts {
                                td.n { (length) } td.n { (rate) } td { (moving) }
                            } @else {
                                td.n { "–" } td.n { "–" } td { "–" }
                            }
                        }
                    }
                }
            } }
            p.small.soft {
                "Made by testbed " (env!("CARGO_PKG_VERSION")) " (" code { "testbed diagnose" } "), schema " code { (self.report.schema) }
                ". Torques and motion are filtered with the same zero-phase filter. The residual is the measured torque minus the torque of the \
                 rigid model. A share is a ratio of standard deviations, so that shares do not add up to one. The probability that \
                 a name is right rises with the evidence against its best alternative; it is missing where it was not calibrated. The same recordings give the same page, byte for byte."
            }
        }
    }

    fn facts(&self, trace: &Trace) -> (String, String, String) {
        let (Some(first), Some(last)) = (trace.time.first(), trace.time.last()) else {
            return ("–".into(), "–".into(), "–".into());
        };
        let mut steps: Vec<f64> = trace.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let step = quantile(&mut steps, 0.5);
        let moving = trace.moving.iter().enumerate();
        let moving = moving.filter(|(_, rows)| rows.contains(&true));
        let moving: Vec<String> = moving.map(|(joint, _)| (joint + 1).to_string()).collect();
        let rate = if step > 0.0 {
            format!("{:.0} Hz", 1.0 / step)
        } else {
            "–".into()
        };
        let moving = if moving.is_empty() {
            "none".into()
        } else {
            words::list(&moving)
        };
        (format!("{:.1} s", last - first), rate, moving)
    }

    /// The sizes from which an effect is detectable, with the units of its parameters.
    fn sizes(&self, entry: &NotObservable) -> String {
        let joint = entry.joint.as_deref().and_then(|name| self.index(name));
        let kind = joint.map_or(JointKind::Revolute, |joint| self.figures.arm.joints()[joint].kind);
        words::detectable_sizes(entry, kind)
    }
}
