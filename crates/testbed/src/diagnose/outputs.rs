//! Checks the outputs of a diagnosis before anything is read.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::next_file;
use super::residuals_file::Kind;
use crate::cli::{DiagnoseArgs, Rerun};
use crate::output::{self, OutputFile};

/// Checks the outputs of `args` before anything is read.
///
/// # Errors
/// If an output cannot be written, is an input, or is another output.
pub fn check(args: &DiagnoseArgs) -> anyhow::Result<()> {
    if cfg!(not(feature = "viewer")) && !matches!(args.rerun, None | Some(Rerun::Off)) {
        bail!("this testbed was built without the viewer; build it with `--features viewer`, or leave --rerun out");
    }
    let outputs = args.outputs();
    for output in &outputs {
        output::check_writable(output.path)?;
    }
    args.next.as_deref().map_or(Ok(()), next_file::check_replaceable)?;
    args.residuals.as_deref().map_or(Ok(()), |path| Kind::of(path).map(drop))?;
    let robot = Path::new(&args.robot);
    for output in &outputs {
        let path = output.path;
        // The corrected model may be the file of known effects, to which the findings are added.
        let known = args.known.iter().filter(|_| args.model.as_deref() != Some(path));
        let recordings = args.train.iter().chain(&args.before).chain(&args.held_out).chain(&args.map);
        let inputs = recordings.chain(known).map(PathBuf::as_path).chain([robot]);
        output::check_is_no_input(path, inputs)?;
    }
    output::check_distinct(&outputs)?;
    outputs.iter().try_for_each(OutputFile::check)
}
