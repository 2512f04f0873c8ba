//! A text file whose errors name the line.

use std::ops::Range;
use std::path::PathBuf;

/// The text of a file and its origin.
#[derive(Clone, Debug)]
pub struct Source {
    /// The name of what it describes.
    pub name: String,
    /// Its path; for a text that comes with the program, the path that it has in the repository.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Source {
    /// `file:line` of a range of bytes of the text.
    pub fn place(&self, span: Range<usize>) -> String {
        let before = &self.text.as_bytes()[..span.start.min(self.text.len())];
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        format!("{}:{line}", self.path.display())
    }

    /// The line of the text that contains byte `position`, without its comment.
    pub fn line(&self, position: usize) -> &str {
        let position = self.text.floor_char_boundary(position.min(self.text.len()));
        let start = self.text[..position].rfind('\n').map_or(0, |newline| newline + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        line.split('#').next().unwrap_or_default().trim()
    }
}
