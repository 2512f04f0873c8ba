//! A diagnosis from its inputs to its outputs, for programs that offer one: the command line and the Python package.
//!
//! A [`Request`] describes a diagnosis; [`Request::run`] reads the robot and the recordings, checks them against each other,
//! diagnoses and completes the report. [`effect_file`], [`urdf_file`] and [`mjcf_file`] write the corrected model in three
//! formats. The errors are sentences for users: place, reason and remedy.
//!
//! ```
//! use study::inputs::{Given, Recordings};
//! use study::notes::Notes;
//! use study::{Listener, Request, Step};
//!
//! struct Quiet;
//! impl Listener for Quiet {
//!     fn doing(&self, _: Step<'_>) {}
//!     fn note(&self, _: &str) {}
//!     fn recordings(&self, _: &Notes) {}
//! }
//!
//! let file = |name: &str| Given::File(format!("../../examples/double_pendulum/{name}.csv.gz").into());
//! let recordings = Recordings {
//!     train: vec![file("r143339"), file("r143524")],
//!     held_out: vec![file("r154220")],
//!     ..Recordings::default()
//! };
//! let robot = "../../examples/double_pendulum/robot.urdf".to_owned();
//! let request = Request { robot, recordings, torques_only: true, ..Request::default() };
//! let diagnosed = request.run(&Quiet)?;
//! let names: Vec<&str> = diagnosed.effects.iter().map(|effect| effect.name()).collect();
//! assert!(names.contains(&"coulomb_friction"), "{names:?}");
//! # Ok::<(), anyhow::Error>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

pub mod check;
pub mod effect_file;
pub mod held;
pub mod inputs;
pub mod mjcf_file;
pub mod named;
pub mod notes;
pub mod placeholders;
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
