//! The diagnosis as one self-contained HTML page: no network, no scripts, the same bytes for the same input.

mod against;
mod arm_view;
pub mod chart;
mod clouds;
mod errors;
mod figures;
mod findings;
mod overview;
mod place;
mod rest;

use std::path::Path;

use arm::Arm;
use diagnosis::{Report, Traces};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::words;
use figures::Figures;

/// Points that all figures of a page share, and the most that one line or cloud has.
const ALL_POINTS: usize = 80_000;
const MOST_POINTS: usize = 1500;

/// Everything that the parts of a page draw from.
struct Page<'a> {
    report: &'a Report,
    figures: Figures<'a>,
}

/// Writes the page to `path`, whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, report: &Report, traces: &Traces, arm: &Arm) -> anyhow::Result<()> {
    let page = Page::new(report, traces, arm).whole().into_string();
    recording::write_whole(path, |file| file.write_all(page.as_bytes()))?;
    Ok(())
}

impl<'a> Page<'a> {
    fn new(report: &'a Report, traces: &'a Traces, arm: &'a Arm) -> Self {
        let series = 2 * arm.dof() + 4 * report.findings.len();
        let points = (ALL_POINTS / series.max(1)).clamp(250, MOST_POINTS);
        let figures = Figures { traces, arm, points };
        Self { report, figures }
    }

    fn whole(&self) -> Markup {
        let arm_view = arm_view::draw(self.report, self.figures.traces, self.figures.arm);
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { "Diagnosis of " (self.report.robot) }
                    style { (PreEscaped(include_str!("page/style.css"))) }
                }
                body {
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
                }
            }
        }
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

/// A key's entry: a swatch and what it stands for.
fn key(class: &str, what: &str) -> Markup {
    html! { span.key { span class={ "swatch " (class) } {} (what) } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sample::{self, Plot};

    fn page(joints: usize, plot: Plot) -> String {
        let (report, traces, arm) = sample::diagnosis(joints, plot);
        Page::new(&report, &traces, &arm).whole().into_string()
    }

    #[test]
    fn the_page_needs_nothing_else_and_says_it_all() {
        let text = page(7, Plot::Rich);
        for foreign in ["http:", "https:", "src=", "url(", "@import", "<script", "<link"] {
            assert!(!text.contains(foreign), "the page has {foreign}");
        }
        for part in [
            "The model leaves out 8 effects",
            "shoulder_lift_joint",
            "62.0 ± 3.1 N m/rad",
            "could also be",
            "Sweep this joint alone",
            "What these recordings could not show",
            "c_held_out.csv",
            "six &amp; one",
            env!("CARGO_PKG_VERSION"),
        ] {
            assert!(text.contains(part), "{part} is not in the page");
        }
        assert!(text.len() < 2_000_000, "{} bytes", text.len());
        assert!(!text.contains("NaN") && !text.contains("inf "));
    }

    #[test]
    fn names_are_escaped() {
        let text = page(7, Plot::Rich);
        assert!(!text.contains("<b>tool") && text.contains("&lt;b&gt;tool &amp; swivel&lt;/b&gt;"));
    }

    #[test]
    fn the_same_diagnosis_gives_the_same_bytes() {
        assert_eq!(page(6, Plot::Rich), page(6, Plot::Rich));
    }

    #[test]
    fn any_arm_and_any_verdict_make_a_page() {
        for joints in 1..=7 {
            for plot in [Plot::Clean, Plot::Rich, Plot::TooShort] {
                assert!(page(joints, plot).ends_with("</html>"));
            }
        }
        let (report, _, arm) = sample::diagnosis(3, Plot::Rich);
        let text = Page::new(&report, &Traces::default(), &arm).whole().into_string();
        assert!(text.contains("elbow_joint"));
    }

    #[test]
    fn a_page_is_written_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("page.html");
        let (report, traces, arm) = sample::diagnosis(2, Plot::Rich);
        write(&path, &report, &traces, &arm).expect("a page");
        let text = std::fs::read_to_string(&path).expect("a page");
        assert!(text.starts_with("<!DOCTYPE html>"));
        assert!(write(&folder.path().join("no/page.html"), &report, &traces, &arm).is_err());
    }

    /// `TESTBED_PAGE_OUT=folder` leaves pages there to be looked at.
    #[test]
    fn pages_to_look_at() {
        let Some(folder) = std::env::var_os("TESTBED_PAGE_OUT") else {
            return;
        };
        let cases = [
            (7, Plot::Rich, "rich.html"),
            (1, Plot::Rich, "one.html"),
            (6, Plot::Clean, "clean.html"),
            (3, Plot::TooShort, "short.html"),
        ];
        for (joints, plot, name) in cases {
            let (report, traces, arm) = sample::diagnosis(joints, plot);
            write(&Path::new(&folder).join(name), &report, &traces, &arm).expect("a page");
        }
    }
}
