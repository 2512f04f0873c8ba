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
    attempt().map_err(|reason| RecordingError::Write { path: path.to_owned(), reason: of_system(reason) })
}

/// The system's error, from which the remedy is known, without those of libraries around it (of a CSV, of a temporary file, whose name
/// says nothing).
fn of_system(error: std::io::Error) -> std::io::Error {
    use std::io::ErrorKind::{FileTooLarge, PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull};
    // A temporary file's error does not give its source.
    let says_all = |error: &std::io::Error| {
        let known = [FileTooLarge, PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull];
        (error.raw_os_error().is_none() && known.contains(&error.kind())).then(|| error.kind().into())
    };
    if let Some(plain) = says_all(&error) {
        return plain;
    }
    let mut next: Option<&(dyn std::error::Error + 'static)> = error.get_ref().map(|inner| inner as _);
    while let Some(inner) = next {
        // A CSV's error does not give its source.
        let of_csv = inner.downcast_ref().map(csv::Error::kind);
        let own = match of_csv {
            Some(csv::ErrorKind::Io(own)) => Some(own),
            _ => inner.downcast_ref(),
        };
        if let Some(code) = own.and_then(std::io::Error::raw_os_error) {
            return std::io::Error::from_raw_os_error(code);
        }
        if let Some(plain) = own.and_then(says_all) {
            return plain;
        }
        next = own.map_or_else(|| inner.source(), std::error::Error::source);
    }
    error
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

    /// As of a CSV that is written to a temporary file on a full disk.
    #[test]
    fn what_the_system_says_is_found_below_the_libraries() {
        let kind = std::io::ErrorKind::StorageFull;
        let of_temporary_file = || std::io::Error::new(kind, "no space at path .partial-abc");
        let of_csv = std::io::Error::from(csv::Error::from(of_temporary_file()));
        for error in [of_temporary_file(), of_csv] {
            let found = of_system(error);
            assert_eq!(found.kind(), kind);
            assert!(!found.to_string().contains(".partial"), "{found}");
        }
        assert_eq!(of_system(std::io::Error::other("another")).to_string(), "another");
    }

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

    /// Every write to this device fails because it is full.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_said_of_a_csv_too() {
        let recording = crate::Recording { time: vec![0.0; 10_000], ..Default::default() };
        let error = recording.write_csv(Path::new("/dev/full")).expect_err("it is full");
        let said = "/dev/full: cannot be written: No space left on device (os error 28); the disk is full: free some space, \
                    or choose another disk";
        assert_eq!(error.to_string(), said);
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
        assert!(failed.expect_err("the second fails").to_string().contains("the disk is full"));
        assert_eq!(std::fs::read(&path).expect("the file is there"), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder is there").count(), 1);
    }
}
