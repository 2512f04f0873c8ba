//! The same blocks make a page and a Markdown file.

use report::block::{Block, table, text};

fn blocks() -> Vec<Block> {
    vec![
        Block::Title("A <title>".into()),
        text("Held by `seal.json`, **not** by trust."),
        table(&["case", "share"], 1, vec![vec!["a|b".into(), "12 %".into()]]),
        table(&["case"], 1, Vec::new()),
        Block::Figure { svg: "<svg></svg>".into(), caption: "What was found.".into() },
    ]
}

#[test]
fn markdown_omits_drawings() {
    let text = report::markdown(&blocks(), "The end.");
    assert_eq!(
        text,
        "# A &lt;title>\n\nHeld by `seal.json`, **not** by trust.\n\n| case | share |\n| --- | --: |\n| a\\|b | 12 % |\n\n(none)\n\nThe end.\n"
    );
}

#[test]
fn the_page_has_drawings_and_escapes_text() {
    let text = report::block_page("A <title>", "over it", &blocks(), "The end.");
    for part in [
        "<title>A &lt;title&gt;</title>",
        "<code>seal.json</code>",
        "<b>not</b>",
        "<svg></svg>",
        "(none)",
        "The end.</p></body></html>",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}
