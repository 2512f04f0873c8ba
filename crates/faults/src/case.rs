//! A case's folder and its ground truth, written completely or not at all.

use std::path::{Path, PathBuf};

use recording::write_whole;

use crate::conceal::Concealment;
use crate::error::FaultError;

/// Writes `folder/<case>/robot.urdf`, `train_1.csv` …, `held_out.csv`, and the ground truth separately as
/// `truths/<case>.json`. Returns the case's folder.
///
/// # Errors
/// [`FaultError::Exists`] if the case or its truth exists; [`FaultError::Write`] or [`FaultError::Folder`] if
/// something cannot be written. Nothing remains of a case that fails.
pub fn write_case(concealment: &Concealment, folder: &Path, truths: &Path) -> Result<PathBuf, FaultError> {
    let name = &concealment.truth.case;
    let case = folder.join(name);
    let truth = truths.join(format!("{name}.json"));
    let is_there =
        |path: &Path| path.exists() && std::fs::read_dir(path).map_or(true, |mut inside| inside.next().is_some());
    for path in [&case, &truth] {
        if is_there(path) {
            return Err(FaultError::Exists { path: path.clone() });
        }
    }
    let fails = |path: &Path| {
        let path = path.to_owned();
        move |reason| FaultError::Folder { path, reason }
    };
    for path in [folder, truths] {
        std::fs::create_dir_all(path).map_err(fails(path))?;
    }
    // On the same file system, so that it can be moved to its place in one step.
    let partial = tempfile::Builder::new().prefix(".partial-").tempdir_in(folder).map_err(fails(folder))?;
    let urdf = concealment.urdf.as_bytes();
    write_whole(&partial.path().join("robot.urdf"), |file| file.write_all(urdf))?;
    for (k, recording) in concealment.train.iter().enumerate() {
        recording.write_csv(&partial.path().join(format!("train_{}.csv", k + 1)))?;
    }
    concealment.held_out.write_csv(&partial.path().join("held_out.csv"))?;
    write_whole(&truth, |file| {
        serde_json::to_writer_pretty(&mut *file, &concealment.truth)?;
        file.write_all(b"\n")
    })?;
    let moved = set_usual_permissions(partial.path()).and_then(|()| {
        if case.exists() {
            std::fs::remove_dir(&case)?;
        }
        std::fs::rename(partial.path(), &case)
    });
    if let Err(reason) = moved {
        let _ = std::fs::remove_file(&truth);
        return Err(FaultError::Folder { path: case, reason });
    }
    let _ = partial.keep();
    Ok(case)
}

/// A temporary folder is private to its owner; the finished one has the usual permissions.
#[cfg(unix)]
fn set_usual_permissions(folder: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(folder, std::fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
fn set_usual_permissions(_: &Path) -> std::io::Result<()> {
    Ok(())
}
