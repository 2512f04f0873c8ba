//! The diagnosis as one self-contained HTML page: no network, no scripts, the same bytes for the same input.

mod against;
mod arm_view;
mod clouds;
mod errors;
mod figures;
mod findings;
mod overview;
mod place;
mod rest;

use arm::Arm;
use diagnosis::{Report, Traces};
use maud::{Markup, PreEscaped, html};

use crate::shell::shell;
use crate::words;
use figures::Figures;

/// Points that all figures of a page share, and the most that one line or cloud has.
const ALL_POINTS: usize = 80_000;
const MOST_POINTS: usize = 1500;

/// The data that the parts of a page are drawn from.
struct Page<'a> {
    report: &'a Report,
    figures: Figures<'a>,
}

/// The page of a diagnosis of `arm`, with its figures drawn from `traces`.
pub fn page(report: &Report, traces: &Traces, arm: &Arm) -> String {
    Page::new(report, traces, arm).whole()
}

impl<'a> Page<'a> {
    fn new(report: &'a Report, traces: &'a Traces, arm: &'a Arm) -> Self {
        let series = 2 * arm.dof() + 4 * report.findings.len();
        let points = (ALL_POINTS / series.max(1)).clamp(250, MOST_POINTS);
        let figures = Figures { traces, arm, points };
        Self { report, figures }
    }

    fn whole(&self) -> String {
        let arm_view = arm_view::draw(self.report, self.figures.traces, self.figures.arm);
        let body = html! {
            p.eyebrow { "testbed diagnosis · " (self.report.robot) " · " (self.recordings_in_short()) }
            h1 { (words::verdict(self.report)) }
            (self.lead())
            figure.hero { (PreEscaped(arm_view)) }
            (self.overview())
            (self.whole_arm())
            @for joint in 0..self.figures.arm.dof() { (self.joint(joint)) }
            (self.quiet_joints())
            (self.errors())
            (self.rollout())
            (self.not_observable())
            (self.next_experiment())
            (self.all_parameters())
            (self.provenance())
        };
        shell(&format!("Diagnosis of {}", self.report.robot), "", body)
    }

    /// The joint's number in the arm, by name.
    fn index(&self, name: &str) -> Option<usize> {
        self.figures.arm.joints().iter().position(|joint| joint.name == name)
    }

    /// A link to the joint's section, or its plain name where there is none.
    fn link(&self, joint: Option<&str>) -> Markup {
        match joint {
            None => html! { a href="#whole-arm" { "whole arm" } },
            Some(name) => match self.index(name) {
                Some(index) if self.has_section(index) => {
                    html! { a href={ "#joint-" (index + 1) } { (name) } }
                }
                _ => html! { (name) },
            },
        }
    }
}

/// A legend's entry: a swatch and its meaning.
fn key(class: &str, what: &str) -> Markup {
    html! { span.key { span class={ "swatch " (class) } {} (what) } }
}
