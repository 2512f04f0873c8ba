//! Files that are written completely or not at all.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::error::RecordingError;

/// Writes the file at `path` through `write`. An earlier file is replaced only after everything has been written.
///
/// # Errors
/// [`RecordingError::Write`] if the folder or the file cannot be written.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), RecordingError> {
    let attempt = || {
        // A link is followed; a pipe or a device cannot be replaced and is written to.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if target.metadata().is_ok_and(|target| !target.is_file()) {
            let mut file = BufWriter::new(std::fs::File::options().write(true).open(&target)?);
            write(&mut file)?;
            return file.flush();
        }
        let path = target.as_path();
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

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_a_device() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (target, link) = (folder.path().join("a.txt"), folder.path().join("b.txt"));
        std::fs::write(&target, "old").expect("it writes");
        std::os::unix::fs::symlink(&target, &link).expect("it links");
        write_whole(&link, |w| w.write_all(b"new")).expect("the write succeeds");
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&target).expect("the file is there"), b"new");
        let device = folder.path().join("null");
        std::os::unix::fs::symlink("/dev/null", &device).expect("it links");
        write_whole(&device, |w| w.write_all(b"new")).expect("the write succeeds");
        assert!(!Path::new("/dev/null").is_file());
    }

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
