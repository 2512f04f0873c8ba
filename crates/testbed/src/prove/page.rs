//! The report as one HTML page that needs nothing beside it.

use std::path::Path;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::command::Proof;
use super::report::{Block, blocks};

const STYLE: &str = concat!(
    include_str!("../diagnose/page/style.css"),
    "pre { background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: .7rem 1rem; overflow-x: auto; }\n",
    "figure { max-width: 800px; }\n",
    ".wide table { font-size: .8rem; } .wide th { max-width: 6.5rem; } .wide td, .wide th { padding-right: .45rem; }\n",
);

/// Writes the page, whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, proof: &Proof) -> anyhow::Result<()> {
    let eyebrow = format!(
        "testbed proof · {} · sealed as `{}`",
        proof.seal.source, proof.seal.whole
    );
    let made = format!(
        "Made by testbed {} (`testbed prove`). The same seed and program give the same page, byte for byte.",
        proof.seal.program.version
    );
    write_blocks(path, "Concealed physics: a proof", &eyebrow, &blocks(proof), &made)
}

/// Writes any report, whole or not at all: its title, what stands over it, and its last line.
///
/// # Errors
/// If it cannot be written.
pub fn write_blocks(path: &Path, title: &str, eyebrow: &str, blocks: &[Block], made: &str) -> anyhow::Result<()> {
    let page = whole(title, eyebrow, blocks, made).into_string();
    recording::write_whole(path, |file| file.write_all(page.as_bytes()))?;
    Ok(())
}

fn whole(title: &str, eyebrow: &str, blocks: &[Block], made: &str) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                p.eyebrow { (inline(eyebrow)) }
                @for block in blocks { (markup(block)) }
                p.small.soft { (inline(made)) }
            }
        }
    }
}

fn markup(block: &Block) -> Markup {
    match block {
        Block::Title(title) => html! { h1 { (title) } },
        Block::Heading(heading) => html! { h2 { (heading) } },
        Block::Section(heading) => html! { h3 { (heading) } },
        Block::Text(text) => html! { p { (inline(text)) } },
        Block::Code(code) => html! { pre { code { (code) } } },
        Block::Figure { svg, caption } => html! { figure { (PreEscaped(svg)) figcaption { (caption) } } },
        Block::Table { head, rows, words } => {
            let is_wide = head.len() > 8;
            html! {
                @if rows.is_empty() { p.soft { "(none)" } } @else {
                    div class=(if is_wide { "scroll wide" } else { "scroll" }) { table {
                        thead { tr { @for (k, cell) in head.iter().enumerate() {
                            @if k < *words { th { (cell) } } @else { th.n style="white-space: normal" { (cell) } }
                        } } }
                        tbody { @for row in rows { tr { @for (k, cell) in row.iter().enumerate() {
                            @if k < *words { td { (inline(cell)) } } @else { td.n { (inline(cell)) } }
                        } } } }
                    } }
                }
            }
        }
    }
}

/// Text with `code` and **weight**.
fn inline(text: &str) -> Markup {
    html! {
        @for (k, part) in text.split('`').enumerate() {
            @if k % 2 == 1 { code { (part) } } @else {
                @for (k, part) in part.split("**").enumerate() {
                    @if k % 2 == 1 { b { (part) } } @else { (part) }
                }
            }
        }
    }
}
