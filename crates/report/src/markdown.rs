//! Blocks as Markdown.

use crate::block::Block;

/// The blocks and a last line; drawings are omitted, their tables are kept.
pub fn markdown(blocks: &[Block], made: &str) -> String {
    let mut text = String::new();
    for block in blocks {
        match block {
            Block::Title(title) => text.push_str(&format!("# {title}\n\n")),
            Block::Heading(heading) => text.push_str(&format!("## {heading}\n\n")),
            Block::Section(heading) => text.push_str(&format!("### {heading}\n\n")),
            Block::Text(paragraph) => text.push_str(&format!("{paragraph}\n\n")),
            Block::Code(code) => text.push_str(&format!("```sh\n{code}\n```\n\n")),
            Block::Figure { .. } => {}
            Block::Table { head, rows, words } => {
                if rows.is_empty() {
                    text.push_str("(none)\n\n");
                    continue;
                }
                text.push_str(&line(head));
                let rule: Vec<String> = (0..head.len())
                    .map(|column| if column < *words { "---" } else { "--:" }.to_owned())
                    .collect();
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
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}
