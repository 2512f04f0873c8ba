//! The diagnosis as one self-contained HTML page: no network, complete without scripts, the same bytes for the same input.

mod against;
mod arm_view;
mod clouds;
mod errors;
mod figures;
mod findings;
mod last_sections;
mod overview;
mod place;
mod table;
mod zoom;

use arm::Arm;
use diagnosis::{Report, Traces};
use maud::{Markup, PreEscaped, html};

use crate::shell::shell;
use crate::{differences, words};
use figures::Figures;
use table::name;

/// The number of points in all figures of a page together, and the largest number in one line or cloud.
const ALL_POINTS: usize = 80_000;
const MOST_POINTS: usize = 1500;
/// The number of rows in all zoomable figures over time together, and the least number in one.
const ALL_ROWS: usize = 60_000;
const FEWEST_ROWS: usize = 2000;

/// A part of the page with a heading, which the contents list.
struct Section {
    id: String,
    title: Markup,
    body: Markup,
}

impl Section {
    fn new(id: impl Into<String>, title: Markup, body: Markup) -> Self {
        let id = id.into();
        Self { id, title, body }
    }
}

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
        let rows = (ALL_ROWS / arm.dof().max(1)).max(FEWEST_ROWS);
        let figures = Figures { traces, arm, points, rows };
        Self { report, figures }
    }

    fn whole(&self) -> String {
        let arm_view =
            arm_view::draw(self.report, self.figures.traces, self.figures.arm, |joint| self.has_section(joint));
        let joints = (0..self.figures.arm.dof()).map(|joint| self.joint(joint));
        let all = [
            self.doubts(),
            self.overview(),
            self.not_diagnosed(),
            self.warnings(),
            self.next_steps(),
            self.whole_arm(),
        ];
        let rest = [
            self.quiet_joints(),
            self.errors(),
            self.rollout(),
            self.not_observable(),
            self.all_parameters(),
            Some(self.provenance()),
        ];
        let sections: Vec<Section> = all.into_iter().chain(joints).chain(rest).flatten().collect();
        let body = html! {
            header {
                p.eyebrow { "testbed diagnosis · " (name(&self.report.robot)) " · " (self.recordings_in_short()) }
                @if let Some(changed) = words::changed(self.report) { p.lead { (changed) } }
                @if let Some(load) = differences::different_load(self.report) { p.lead { (load) } }
                @if let Some(friction) = differences::held_out_friction(self.report) { p.lead { (friction) } }
                @if let Some(lag) = differences::torque_lag(self.report) { p.lead { (lag) } }
                h1 { (words::verdict(self.report)) }
                (self.lead())
            }
            nav aria-label="Contents" {
                ol { @for section in &sections { li { a href={ "#" (section.id) } { (section.title) } } } }
            }
            main {
                @if self.report.doubts.is_empty() {
                    figure.hero { (PreEscaped(arm_view)) figcaption { (arm_view::legend(self.report)) } }
                }
                @for section in sections { section {
                    h2 id=(section.id) { (section.title) }
                    (section.body)
                } }
            }
        };
        shell(&format!("Diagnosis of {}", self.report.robot), "testbed diagnose", "", body, &[UPLOT, VIEWER])
    }

    /// The joint's number in the arm, by name.
    fn index(&self, name: &str) -> Option<usize> {
        self.figures.arm.joints().iter().position(|joint| joint.name == name)
    }

    /// A link to the joint's section, or its plain name where there is none.
    fn link(&self, joint: Option<&str>) -> Markup {
        match joint {
            None => html! { a href="#whole-arm" { "whole arm" } },
            Some(joint) => match self.index(joint) {
                Some(index) if self.has_section(index) => {
                    html! { a href={ "#joint-" (index + 1) } { (name(joint)) } }
                }
                _ => name(joint),
            },
        }
    }
}

/// The library that draws zoomable figures, with its licence, and the script that gives it the data.
const UPLOT: &str =
    concat!("/*\n", include_str!("../uplot/LICENSE"), "*/\n", include_str!("../uplot/uPlot.iife.min.js"));
const VIEWER: &str = include_str!("page/viewer.js");

/// A legend's entry: a swatch and its meaning.
fn key(class: &str, what: &str) -> Markup {
    html! { span.key { span class={ "swatch " (class) } {} (what) } }
}
