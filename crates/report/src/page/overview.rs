//! The first screen: the held-out error in one sentence, and the findings as a table.

use diagnosis::Doubt;
use maud::{Markup, html};

use super::table::{brief_table, number, words as text};
use super::{Page, Section, key};
use crate::doubts::Certainty;
use crate::{alternatives, doubts, not_diagnosed, numbers, sizes, terminal, words};

impl Page<'_> {
    /// `4 recordings, 1 held out`.
    pub(super) fn recordings_in_short(&self) -> String {
        let names = &self.report.recordings;
        let held_out = match names.held_out.len() {
            0 => "none held out".to_owned(),
            some => format!("{some} held out"),
        };
        format!("{}, {held_out}", words::count(names.train.len() + names.held_out.len(), "recording"))
    }

    /// The held-out error in a sentence.
    pub(super) fn lead(&self) -> Markup {
        // Joints with a model error; the effects cannot improve the others.
        let missed = |name: &str| self.report.located.iter().any(|located| located.joint == name);
        let any = self.report.fit.keys().any(|name| missed(name));
        let errors: Vec<(&str, [f64; 2])> = self
            .report
            .fit
            .iter()
            .filter(|(name, _)| !any || missed(name))
            .filter_map(|(name, fit)| {
                let errors = [fit.held_out_nrmse_nominal?, fit.held_out_nrmse_augmented?];
                let is_finite = errors.iter().all(|error| error.is_finite());
                is_finite.then_some((name.as_str(), errors))
            })
            .collect();
        if errors.is_empty() {
            return html! {};
        }
        let [before, after] = [0, 1].map(|which: usize| median(errors.iter().map(|(_, errors)| errors[which])));
        let is_found = !self.report.findings.is_empty();
        let is_same = |[before, after]: [f64; 2]| numbers::nrmse(before) == numbers::nrmse(after);
        let fallen = errors.iter().filter(|(_, errors)| errors[1] < errors[0] && !is_same(*errors));
        let most = fallen.max_by(|(_, a), (_, b)| (a[0] - a[1]).total_cmp(&(b[0] - b[1])));
        let middle = numbers::nrmse(after);
        let several = errors.len() > 1;
        let over = if several { " (median over the joints with a model error)" } else { "" };
        let torque = " times the torque's standard deviation";
        html! {
            p.lead {
                @if !is_found {
                    "On the held-out recordings, the model's RMS torque error is " (numbers::nrmse(before)) (torque) (over) "."
                } @else if !is_same([before, after]) {
                    "On the held-out recordings, the RMS torque error " (changes(before, after)) " from "
                    b { (numbers::nrmse(before)) } " to " b { (numbers::nrmse(after)) } (torque) (over) "."
                } @else if let (true, Some((name, [before, after]))) = (several, most) {
                    "On the held-out recordings, the RMS torque error of " (name) " falls from "
                    b { (numbers::nrmse(*before)) } " to " b { (numbers::nrmse(*after)) } (torque)
                    ", more than that of any other joint; the median over the joints with a model error remains "
                    (middle) "."
                } @else {
                    "On the held-out recordings, the RMS torque error remains " b { (numbers::nrmse(after)) } (torque) (over) "."
                }
            }
        }
    }

    /// Doubts about units, signs, order or zeros, with the column maps that correct them.
    pub(super) fn doubts(&self) -> Option<Section> {
        let title = html! { "Units, signs, order or zeros first" };
        self.doubted(&self.report.doubts, Certainty::Certain, "units", title)
    }

    /// The joints that are not diagnosed, with the reasons.
    pub(super) fn not_diagnosed(&self) -> Option<Section> {
        let reasons = not_diagnosed::reasons(self.report, str::to_owned);
        let body = html! { ul.steps { @for reason in &reasons { li { (reason) } } } };
        (!reasons.is_empty()).then(|| Section::new("not-diagnosed", html! { "Not diagnosed" }, body))
    }

    /// What contradicts the URDF and does not prevent the diagnosis.
    pub(super) fn warnings(&self) -> Option<Section> {
        let title = html! { "Recordings that contradict the URDF" };
        self.doubted(&self.report.warnings, Certainty::Possible, "contradictions", title)
    }

    fn doubted(&self, doubts: &[Doubt], certainty: Certainty, id: &'static str, title: Markup) -> Option<Section> {
        if doubts.is_empty() {
            return None;
        }
        let body = html! {
            @for group in doubts::groups(doubts, certainty, self.report) {
                ul.steps { @for sentence in &group.texts { li { (sentence) "." } } }
                @if let Some(map) = group.map {
                    p { (coded(&group.usage)) }
                    pre { code { (map) } }
                }
            }
        };
        Some(Section::new(id, title, body))
    }

    /// All findings in a table.
    pub(super) fn overview(&self) -> Option<Section> {
        if self.report.findings.is_empty() && self.report.unexplained.is_empty() {
            return None;
        }
        let columns = [
            text("joint"),
            text("effect"),
            text("size with its 95 % interval"),
            text("share of the torque"),
            number("probability"),
            number(terminal::error_title(self.report)),
            text("could also be"),
        ];
        let found = self.report.findings.iter().enumerate().map(|(index, finding)| {
            vec![
                self.link(finding.joint.as_deref()),
                html! { a href={ "#finding-" (index + 1) } { (words::effect(finding)) } },
                html! {
                    @for (index, size) in sizes::list(finding).into_iter().enumerate() {
                        @if index > 0 { br; }
                        span.nowrap { (size) }
                    }
                },
                html! { span.nowrap {
                    @match words::share(finding) { Some(share) => { (bar(share)) (numbers::share(share)) }, None => "–" }
                } },
                html! { (numbers::probability(finding.probability)) },
                html! { (terminal::error(self.report, finding)) },
                html! { (alternatives::text(finding)) },
            ]
        });
        let open = self.report.unexplained.iter().map(|open| {
            vec![
                self.link(Some(&open.joint)),
                html! { "unexplained residual" },
                html! {},
                html! { span.nowrap { (bar(open.share)) (numbers::share(open.share)) } },
                html! {},
                html! { (terminal::error_of(self.report, &open.joint)) },
                html! {},
            ]
        });
        let body = html! {
            (brief_table(&columns, found.chain(open).collect()))
            p.small.soft {
                "Share: standard deviation of the effect's torque over the standard deviation of the measured torque. The error is \
                 the RMS torque error over the standard deviation of the measured torque, with the nominal model → with all effects \
                 found. Held-out recordings are used in no fit, with the three exceptions in docs/diagnosis.md. The error belongs to the joint and is repeated for each of its \
                 findings."
            }
        };
        Some(Section::new("found", html! { "What was found" }, body))
    }

    /// The legend of a residual's colours.
    pub(super) fn residual_key(&self, has_windows: bool) -> Markup {
        html! {
            (key("k-before", "nominal: measured − nominal model"))
            (key("k-after", "corrected: measured − nominal model − effects found"))
            (key("box k-rest", "at rest, not fitted"))
            @if has_windows { (key("box k-window", "largest residual")) }
        }
    }
}

/// `text` with code between backticks.
fn coded(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

/// The median of at least one value.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len() - 1;
    0.5 * (values[last / 2] + values[values.len() / 2])
}

fn changes(before: f64, after: f64) -> &'static str {
    if after < before { "falls" } else { "rises" }
}

fn bar(share: f64) -> Markup {
    let width = 4.5 * share.clamp(0.0, 1.2);
    html! { span.bar style={ "width:" (format!("{width:.2}")) "rem" } {} }
}
