//! A diagnosis from its inputs to its outputs, for programs that offer one: the command line and the Python package.
//!
//! A [`Request`] describes a diagnosis; [`Request::run`] reads the robot and the recordings, checks them against each other,
//! diagnoses and completes the report. [`effect_file`], [`urdf_file`] and [`mjcf_file`] write the corrected model in three
//! formats. The errors are sentences for users: place, reason and remedy.

pub mod check;
pub mod effect_file;
pub mod held;
pub mod inputs;
pub mod mjcf_file;
pub mod named;
pub mod notes;
mod request;
pub mod robot;
mod source;
pub mod urdf_file;
pub mod urdf_friction;

use std::path::Path;

pub use diagnosis::Step;
pub use request::{Diagnosed, Known, Listener, Request, wanted};
pub use source::Source;

/// Whether two paths are the same file, which need not exist.
pub fn is_same(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        path.canonicalize().or_else(|_| {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let folder = folder.unwrap_or_else(|| Path::new(".")).canonicalize()?;
            std::io::Result::Ok(folder.join(path.file_name().unwrap_or_default()))
        })
    };
    matches!((place(a), place(b)), (Ok(a), Ok(b)) if a == b)
}

/// The error and its causes in one line, without causes that the error already contains.
pub fn sentence(error: &anyhow::Error) -> String {
    let mut line = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !line.contains(&cause) {
            line = format!("{line}: {cause}");
        }
    }
    line
}
