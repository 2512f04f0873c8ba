//! Blocks as Markdown.

use crate::block::Block;

/// The blocks as Markdown, with `made` as the last line. Drawings are omitted; the tables of the same data are kept.
pub fn markdown(blocks: &[Block], made: &str) -> String {
    let mut text = String::new();
    for block in blocks {
        match block {
            Block::Title(title) => text.push_str(&format!("# {}\n\n", without_tags(title))),
            Block::Heading(heading) => text.push_str(&format!("## {}\n\n", without_tags(heading))),
            Block::Section(heading) => text.push_str(&format!("### {}\n\n", without_tags(heading))),
            Block::Text(paragraph) => text.push_str(&format!("{}\n\n", without_tags(paragraph))),
            Block::Code { language, code } => text.push_str(&format!("```{language}\n{}\n```\n\n", code.trim_end())),
            Block::Figure { .. } => {}
            Block::Table { head, rows, words } => {
                if rows.is_empty() {
                    text.push_str("(none)\n\n");
                    continue;
                }
                text.push_str(&line(head));
                let rule: Vec<String> =
                    (0..head.len()).map(|column| if column < *words { "---" } else { "--:" }.to_owned()).collect();
                text.push_str(&line(&rule));
                for row in rows {
                    text.push_str(&line(row));
                }
                text.push('\n');
            }
        }
    }
    text.push_str(&format!("{made}\n"));
    text
}

fn line(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| without_tags(cell).replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// The text with HTML tags escaped, except in code spans. Markdown would pass tags on, and names from files must not become
/// markup of a page.
fn without_tags(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for (index, span) in text.split('`').enumerate() {
        if index > 0 {
            safe.push('`');
        }
        let is_code = index % 2 == 1 && text.matches('`').count().is_multiple_of(2);
        let mut rest = span;
        while let Some(at) = rest.find('<') {
            let (before, tag) = rest.split_at(at);
            safe.push_str(before);
            let begins = |c: char| c.is_ascii_alphabetic() || matches!(c, '/' | '!' | '?');
            let is_tag = !is_code && tag[1..].starts_with(begins);
            safe.push_str(if is_tag { "&lt;" } else { "<" });
            rest = &tag[1..];
        }
        safe.push_str(rest);
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_escaped() {
        assert_eq!(without_tags("p < 0.05, `a<b>` <b>x</b>"), "p < 0.05, `a<b>` &lt;b>x&lt;/b>");
        // A single backtick does not begin a code span.
        assert_eq!(without_tags("a`<i>"), "a`&lt;i>");
    }
}
