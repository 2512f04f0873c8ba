//! The files of a command, written one after the other. If one cannot be written, the others are still written and the
//! result is still printed.

use std::path::{Path, PathBuf};

/// The files that were written, and the errors of the others.
#[derive(Default)]
pub struct Written {
    /// Each file, and whether it replaces one that was there.
    files: Vec<(PathBuf, bool)>,
    failures: Vec<anyhow::Error>,
}

impl Written {
    /// Writes the file at `path` by `write`, which does so completely or not at all.
    pub fn add(&mut self, path: &Path, write: impl FnOnce() -> anyhow::Result<()>) {
        let replaces = path.is_file();
        match write() {
            Ok(()) if crate::output::is_stdout(Some(path)) => {}
            Ok(()) => self.note(path, replaces),
            Err(error) => self.failures.push(error),
        }
    }

    /// Notes a file that was written already.
    pub fn note(&mut self, path: &Path, replaces: bool) {
        self.files.push((path.to_owned(), replaces));
    }

    /// Does work that writes no file, and keeps its error.
    pub fn attempt(&mut self, what: impl FnOnce() -> anyhow::Result<()>) {
        self.failures.extend(what().err());
    }

    /// Whether the file was written.
    pub fn has(&self, path: &Path) -> bool {
        self.files.iter().any(|(written, _)| written == path)
    }

    /// A line that says so, if the file was written.
    pub fn line(&self, path: &Path) -> Option<String> {
        let (path, replaces) = self.files.iter().find(|(written, _)| written == path)?;
        let instead = if *replaces { " (in place of an earlier one)" } else { "" };
        Some(format!("written: {}{instead}\n", path.display()))
    }

    /// The lines of all files, in the order of their writing.
    pub fn lines(&self) -> String {
        self.files.iter().filter_map(|(path, _)| self.line(path)).collect()
    }

    /// Fails if a file was not written.
    ///
    /// # Errors
    /// The first failure, after the others were printed on standard error.
    pub fn finish(mut self) -> anyhow::Result<()> {
        if self.failures.is_empty() {
            return Ok(());
        }
        let first = self.failures.remove(0);
        for other in &self.failures {
            crate::output::say(format_args!("error: {}", study::sentence(other)));
        }
        Err(first)
    }
}
