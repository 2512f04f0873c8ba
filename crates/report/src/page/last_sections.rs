//! The last sections of the page: effects that are not testable, the next experiment, all parameters in SI units, provenance.

use std::collections::BTreeMap;

use arm::JointKind;
use diagnosis::statistics::quantile;
use diagnosis::{NotObservable, Trace};
use maud::{Markup, html};

use super::table::{name, number, table, words as words_column};
use super::{Page, Section};
use crate::{next_words, numbers, terminal, words};

impl Page<'_> {
    /// Effects that may be present although they were not found.
    pub(super) fn not_observable(&self) -> Option<Section> {
        let mut groups: BTreeMap<(&str, &str), Vec<&NotObservable>> = BTreeMap::new();
        for entry in &self.report.not_observable {
            groups.entry((entry.effect, &entry.because)).or_default().push(entry);
        }
        let rows: Vec<Vec<Markup>> = groups
            .values()
            .map(|entries| {
                vec![
                    html! { (words::wording(entries[0].effect).name) },
                    html! { (entries[0].because) },
                    html! {
                        @let (sized, hidden): (Vec<_>, Vec<_>) = entries.iter().map(|entry| (entry, self.sizes(entry))).partition(|(_, sizes)| !sizes.is_empty());
                        @for (number, (entry, sizes)) in sized.iter().enumerate() {
                            @if number > 0 { ", " }
                            (name(words::joint(entry.joint.as_deref()))) " " b { (sizes) }
                        }
                        @if !sized.is_empty() && !hidden.is_empty() { "; " }
                        @for (number, (entry, _)) in hidden.iter().enumerate() {
                            @if number > 0 { ", " }
                            (name(words::joint(entry.joint.as_deref())))
                        }
                        @if !hidden.is_empty() { " " b { "at no size" } }
                    },
                ]
            })
            .collect();
        if rows.is_empty() {
            return None;
        }
        let columns = [words_column("effect"), words_column("reason"), words_column("detectable size")];
        let body = html! {
            p { "These effects may be present: the recordings only reveal them at the sizes given." }
            (table(&columns, rows))
        };
        let title = html! { "Not testable with these recordings" };
        Some(Section::new("not-testable", title, body))
    }

    /// What to do next, and what the proposed motion distinguishes.
    pub(super) fn next_steps(&self) -> Option<Section> {
        let steps = terminal::steps::of(self.report);
        let pairs = self.report.next_experiment.iter().flat_map(|next| &next.separates);
        let rows: Vec<Vec<Markup>> = pairs
            .map(|pair| {
                vec![
                    html! { (next_words::name(&pair.finding)) },
                    html! { (next_words::name(&pair.rival)) },
                    html! { (numbers::short(pair.before)) },
                    html! { (numbers::short(pair.after)) },
                    html! { (numbers::short(pair.needed)) },
                ]
            })
            .collect();
        let columns = [
            words_column("finding"),
            words_column("alternative"),
            number("evidence now (nats)"),
            number("with the motion"),
            number("needed"),
        ];
        if steps.is_empty() {
            return None;
        }
        let body = html! {
            ul.steps { @for step in steps { li { (step) "." } } }
            @if !rows.is_empty() {
                details {
                    summary { "What the proposed motion distinguishes, in numbers" }
                    (table(&columns, rows))
                }
            }
        };
        Some(Section::new("next", html! { "What to do next" }, body))
    }

    /// All parameters in SI units, for use in programs.
    pub(super) fn all_parameters(&self) -> Option<Section> {
        let rows: Vec<Vec<Markup>> = self
            .report
            .findings
            .iter()
            .flat_map(|finding| {
                finding.parameters.iter().map(move |(key, parameter)| {
                    vec![
                        html! { (name(words::joint(finding.joint.as_deref()))) },
                        html! { code { (name(finding.effect)) } },
                        html! { code { (name(key)) } },
                        html! { (numbers::for_programs(parameter.value)) },
                        html! { (numbers::for_programs(parameter.ci95[0])) },
                        html! { (numbers::for_programs(parameter.ci95[1])) },
                        html! { (parameter.unit) },
                    ]
                })
            })
            .collect();
        let columns = [
            words_column("joint"),
            words_column("effect"),
            words_column("parameter"),
            number("value"),
            number("from"),
            number("to (95 %)"),
            words_column("unit"),
        ];
        let title = html! { "All parameters, in SI units at the joint" };
        let body =
            html! { details { summary { "For programs; --json and --model have them, too" } (table(&columns, rows)) } };
        (!self.report.findings.is_empty()).then(|| Section::new("parameters", title, body))
    }

    /// The recordings and the program.
    pub(super) fn provenance(&self) -> Section {
        let names = &self.report.recordings;
        let used = |name: &String| {
            if names.before.contains(name) { "training, before" } else { "training" }
        };
        let all = names.train.iter().map(|name| (name, used(name)));
        let all = all.chain(names.held_out.iter().map(|name| (name, "held out")));
        let find = |name: &str| self.figures.traces.recordings.iter().find(|trace| trace.name == name);
        let rows = all
            .map(|(recording, used)| {
                let (time, rate, moving) = find(recording).map_or_else(none, |trace| self.facts(trace));
                vec![
                    html! { code { (name(recording)) } },
                    html! { (used) },
                    html! { (time) },
                    html! { (rate) },
                    html! { (moving) },
                ]
            })
            .collect();
        let columns = [
            words_column("recording"),
            words_column("use"),
            number("time"),
            number("sampling rate of the diagnosis"),
            words_column("joints that move"),
        ];
        let body = html! {
            (table(&columns, rows))
            p.small.soft {
                "Made by testbed " (env!("CARGO_PKG_VERSION")) " (" code { "testbed diagnose" } "), schema " code { (self.report.schema) }
                ". Torques and motion are filtered with the same zero-phase filter, which needs a little of the recording at either end. The \
                 residual is the measured torque minus the torque of the rigid model. A share is a ratio of standard deviations, so that \
                 shares do not add up to one. The probability is the probability that the name is right: it increases with the evidence \
                 against the best alternative, from 0.5 for an equally good one, and is at most 0.985, because the true effect may be \
                 outside the catalogue; it is missing where it was not calibrated. The same recordings give the same page, byte for byte."
            }
        };
        Section::new("recordings", html! { "Recordings and provenance" }, body)
    }

    fn facts(&self, trace: &Trace) -> (String, String, String) {
        let (Some(first), Some(last)) = (trace.time.first(), trace.time.last()) else {
            return none();
        };
        let mut steps: Vec<f64> = trace.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let step = quantile(&mut steps, 0.5);
        let moving = trace.moving.iter().enumerate();
        let moving = moving.filter(|(_, rows)| rows.contains(&true));
        let moving: Vec<String> = moving.map(|(joint, _)| (joint + 1).to_string()).collect();
        let rate = if step > 0.0 { format!("{:.0} Hz", 1.0 / step) } else { "–".into() };
        let moving = if moving.is_empty() { "none".into() } else { words::list(&moving) };
        (format!("{first:.1} to {last:.1} s"), rate, moving)
    }

    /// The sizes from which an effect is detectable, with the units of its parameters; empty where there are none.
    fn sizes(&self, entry: &NotObservable) -> String {
        let joint = entry.joint.as_deref().and_then(|name| self.index(name));
        let kind = joint.map_or(JointKind::Revolute, |joint| self.figures.arm.joints()[joint].kind);
        words::detectable_sizes(entry, kind)
    }
}

/// The facts of a recording without a trace.
fn none() -> (String, String, String) {
    ("–".into(), "–".into(), "–".into())
}
