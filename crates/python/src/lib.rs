//! The extension module of the Python package `jointwise`; the package's Python files give it its types.
//!
//! Arrays come in as C-contiguous copies of `float64` with the shapes that `_core.pyi` says. Computations run without the
//! interpreter's lock.

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod diagnose;
mod dynamics;
mod error;
mod learning;
mod rows;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::diagnose::{Outcome, diagnose};
    #[pymodule_export]
    use crate::dynamics::Dynamics;
    #[pymodule_export]
    use crate::error::JointwiseError;
    #[pymodule_export]
    use crate::learning::Learned;
}
