//! What can be wrong with a recording's file.

use std::path::PathBuf;

/// Why a recording could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be opened or read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file or its folder cannot be written.
    #[error("{path}: cannot be written: {source}; choose a folder you may write to")]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The header lacks what a recording needs.
    #[error("{path}:1: {reason}")]
    Header {
        /// The file.
        path: PathBuf,
        /// What is missing or doubled, and the remedy.
        reason: String,
    },
    /// A row or a value is not what the header promises.
    #[error("{path}:{line}: {reason}")]
    Row {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What was found, and the remedy.
        reason: String,
    },
}
