//! The frame of every page: one style, no network, and scripts only as an addition.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The style of all pages.
const STYLE: &str = concat!(include_str!("../uplot/uPlot.min.css"), "\n", include_str!("page/style.css"));

/// The content security policy: a browser loads and runs only what the page contains.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// A whole page, made by the command `generator`; `more_style` comes after [`STYLE`], `scripts` after `body`.
pub(crate) fn shell(title: &str, generator: &str, more_style: &str, body: Markup, scripts: &[&str]) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(generator);
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(more_style)) }
            }
            body { (body) @for script in scripts { script { (PreEscaped(script)) } } }
        }
    };
    page.into_string()
}
