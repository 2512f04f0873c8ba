//! The blocks of a report, from which the page and the Markdown file are made.

/// A piece of a report. Text may hold `code` between backticks.
pub enum Block {
    /// A title.
    Title(String),
    /// A heading.
    Heading(&'static str),
    /// A heading one level below [`Self::Heading`].
    Section(String),
    /// A paragraph.
    Text(String),
    /// A table; the columns after the first `words` contain numbers.
    Table {
        /// The titles of the columns.
        head: Vec<String>,
        /// The rows.
        rows: Vec<Vec<String>>,
        /// The number of columns with words.
        words: usize,
    },
    /// A drawing with its caption. Only the page has it, not the Markdown file.
    Figure {
        /// SVG.
        svg: String,
        /// The caption.
        caption: String,
    },
    /// Code in a language.
    Code {
        /// `sh`, `toml`.
        language: &'static str,
        /// The code.
        code: String,
    },
}

/// A table.
pub fn table(head: &[&str], words: usize, rows: Vec<Vec<String>>) -> Block {
    Block::Table { head: head.iter().map(|&word| word.to_owned()).collect(), rows, words }
}

/// A paragraph.
pub fn text(text: impl Into<String>) -> Block {
    Block::Text(text.into())
}
