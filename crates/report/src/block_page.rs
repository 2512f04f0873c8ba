//! Blocks as one self-contained HTML page.

use maud::{Markup, PreEscaped, html};

use crate::block::Block;
use crate::shell::shell;

/// The additional style of these pages.
const STYLE: &str = concat!(
    "pre { background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: .7rem 1rem; overflow-x: auto; }\n",
    "figure { max-width: 800px; }\n",
    ".wide table { font-size: .8rem; } .wide th { max-width: 6.5rem; } .wide td, .wide th { padding-right: .45rem; }\n",
);

/// The page of `blocks`; `eyebrow` is the line above its first heading, `made` its last line.
pub fn block_page(title: &str, eyebrow: &str, blocks: &[Block], made: &str) -> String {
    let body = html! {
        p.eyebrow { (inline(eyebrow)) }
        @for block in blocks { (markup(block)) }
        p.small.soft { (inline(made)) }
    };
    shell(title, "testbed", STYLE, body, &[])
}

fn markup(block: &Block) -> Markup {
    match block {
        Block::Title(title) => html! { h1 { (title) } },
        Block::Heading(heading) => html! { h2 { (heading) } },
        Block::Section(heading) => html! { h3 { (heading) } },
        Block::Text(text) => html! { p { (inline(text)) } },
        Block::Code { code, .. } => html! { pre { code { (code) } } },
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
