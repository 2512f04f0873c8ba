//! Files that are written whole or not at all.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::error::RecordingError;

/// Writes the file at `path` through `write`: what was there before stays until all is written.
///
/// # Errors
/// [`RecordingError::Write`] if the folder or the file cannot be written.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), RecordingError> {
    let attempt = || {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut file = tempfile::Builder::new().prefix(".partial-").tempfile_in(folder)?;
        let mut buffered = BufWriter::new(&mut file);
        write(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        // A temporary file is private to its owner; the finished one is an ordinary file.
        set_ordinary_permissions(file.as_file())?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    attempt().map_err(|reason| RecordingError::Write {
        path: path.to_owned(),
        reason,
    })
}

#[cfg(unix)]
fn set_ordinary_permissions(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_ordinary_permissions(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.txt");
        write_whole(&path, |w| w.write_all(b"old")).expect("the first write succeeds");
        let failed = write_whole(&path, |w| {
            w.write_all(b"new")?;
            Err(std::io::Error::other("the disk is full"))
        });
        assert!(
            failed
                .expect_err("the second fails")
                .to_string()
                .contains("the disk is full")
        );
        assert_eq!(std::fs::read(&path).expect("the file is there"), b"old");
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("the folder is there").count(),
            1
        );
    }
}
