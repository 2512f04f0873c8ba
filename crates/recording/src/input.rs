//! The file that a format reads: its first bytes, and its contents without compression.

use std::cell::Cell;
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::RecordingError;

/// The number of first bytes by which a format is recognised.
const HEAD: u64 = 1 << 16;
/// A compressed file may expand to this many bytes plus this many times its size.
const EXPANDED: u64 = 64 << 20;
const EXPANSION: u64 = 100;

/// A recording's file, or folder, before its format is known.
pub struct Input {
    /// Its path.
    pub path: PathBuf,
    /// Its first bytes, without compression; none of a folder.
    pub head: Vec<u8>,
    /// The contents without compression, with the position at the end of `head`; none for a folder.
    file: Option<File>,
    /// Whether the contents are the unchanged bytes of the file at `path`.
    unchanged: bool,
}

/// The number of bytes to which a file of `size` bytes may expand.
pub fn most_expanded(size: u64) -> u64 {
    EXPANDED.saturating_add(size.saturating_mul(EXPANSION))
}

impl Input {
    /// Opens the file or folder at `path`, and expands it if it is compressed.
    ///
    /// # Errors
    /// [`RecordingError::Read`], or [`RecordingError::Format`] if the compressed file is not whole or expands too far.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let unreadable = |reason| RecordingError::Read { path: path.to_owned(), reason };
        let mut file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Ok(Self { path: path.to_owned(), head: Vec::new(), file: None, unchanged: true });
        }
        let mut unchanged = file.metadata().map_err(unreadable)?.is_file();
        let mut head = read_head(&mut file).map_err(unreadable)?;
        if let Some(name) = compression(&head) {
            file = expand(path, name, head, file)?;
            head = read_head(&mut file).map_err(unreadable)?;
            unchanged = false;
        }
        Ok(Self { path: path.to_owned(), head, file: Some(file), unchanged })
    }

    /// Whether it is a folder.
    pub fn is_folder(&self) -> bool {
        self.file.is_none()
    }

    /// Whether the contents are the bytes of the file at the path: neither expanded nor from a pipe.
    pub fn is_unchanged(&self) -> bool {
        self.unchanged
    }

    /// An error that a format's reader has with this file.
    pub fn error(&self, format: &'static str, reason: impl ToString) -> RecordingError {
        RecordingError::Format { path: self.path.clone(), format, reason: reason.to_string() }
    }

    /// The contents from the first byte on, and whether they end with a newline (true for a pipe, where this is not
    /// known).
    pub fn into_stream(self) -> Result<(Box<dyn Read>, bool), RecordingError> {
        let Some(mut file) = self.file else {
            return Err(RecordingError::Read { path: self.path, reason: std::io::Error::other("it is a folder") });
        };
        let ends_whole = ends_with_newline(&mut file, self.head.len() as u64)
            .map_err(|reason| RecordingError::Read { path: self.path, reason })?;
        Ok((Box::new(Cursor::new(self.head).chain(file)), ends_whole))
    }

    /// The contents as a file that can be read at any place, from its start; a pipe is copied into a temporary file.
    pub fn to_file(&self) -> Result<File, RecordingError> {
        let read = || -> std::io::Result<File> {
            let file = self.file.as_ref().ok_or_else(|| std::io::Error::other("it is a folder"))?;
            let mut file = file.try_clone()?;
            if file.metadata()?.is_file() {
                file.rewind()?;
                return Ok(file);
            }
            let mut copy = tempfile::tempfile()?;
            copy.write_all(&self.head)?;
            std::io::copy(&mut file, &mut copy)?;
            copy.rewind()?;
            Ok(copy)
        };
        read().map_err(|reason| RecordingError::Read { path: self.path.clone(), reason })
    }
}

impl Input {
    /// All contents.
    pub fn to_bytes(&self) -> Result<Vec<u8>, RecordingError> {
        let mut bytes = Vec::new();
        let read = self.to_file()?.read_to_end(&mut bytes);
        read.map_err(|reason| RecordingError::Read { path: self.path.clone(), reason })?;
        Ok(bytes)
    }
}

fn read_head(file: &mut File) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head)?;
    Ok(head)
}

/// Whether the file ends with a newline; its position does not change.
fn ends_with_newline(file: &mut File, place: u64) -> std::io::Result<bool> {
    if file.seek(SeekFrom::End(-1)).is_err() {
        return Ok(true);
    }
    let mut last = [0];
    file.read_exact(&mut last)?;
    file.seek(SeekFrom::Start(place))?;
    Ok(last[0] == b'\n')
}

/// The compression of a file with these first bytes.
fn compression(head: &[u8]) -> Option<&'static str> {
    match head {
        [0x1F, 0x8B, ..] => Some("gzip"),
        [0x28, 0xB5, 0x2F, 0xFD, ..] => Some("zstd"),
        _ => None,
    }
}

/// Counts the bytes that are read.
struct Counted<R> {
    inner: R,
    count: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.inner.read(buffer)?;
        self.count.set(self.count.get() + read as u64);
        Ok(read)
    }
}

/// The expanded contents of a compressed file, in a temporary file without a name.
fn expand(path: &Path, name: &'static str, head: Vec<u8>, rest: File) -> Result<File, RecordingError> {
    let error = |reason: String| RecordingError::Format { path: path.to_owned(), format: name, reason };
    let broken = |reason: std::io::Error| {
        error(format!("the compressed file is damaged or cut ({reason}); copy or compress it again"))
    };
    let count = Rc::new(Cell::new(0));
    let source = Counted { inner: Cursor::new(head).chain(rest), count: Rc::clone(&count) };
    let mut source: Box<dyn Read> = match name {
        "gzip" => Box::new(flate2::read::MultiGzDecoder::new(source)),
        _ => Box::new(zstd::stream::read::Decoder::new(source).map_err(broken)?),
    };
    let folder = std::env::temp_dir();
    let no_room = |reason: std::io::Error| {
        error(format!("there is no room to expand it in {} ({reason}); free some space there", folder.display()))
    };
    let no_folder = |reason: std::io::Error| {
        error(format!(
            "it cannot be expanded in the folder of temporary files, {} ({reason}); set TMPDIR to a folder that you may write to",
            folder.display()
        ))
    };
    let mut expanded = tempfile::tempfile().map_err(|reason| match reason.kind() {
        std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded => no_room(reason),
        _ => no_folder(reason),
    })?;
    let mut buffer = vec![0; 1 << 18];
    let mut total: u64 = 0;
    loop {
        let read = source.read(&mut buffer).map_err(broken)?;
        if read == 0 {
            break;
        }
        total += read as u64;
        let most = most_expanded(count.get());
        if total > most {
            return Err(error(format!(
                "it expands to more than {} MB, over {EXPANSION} times its size, which no recording does; if it is one, \
                 expand it before",
                most / 1_000_000
            )));
        }
        expanded.write_all(&buffer[..read]).map_err(no_room)?;
    }
    expanded.rewind().map_err(no_room)?;
    Ok(expanded)
}

#[cfg(test)]
#[path = "input_tests.rs"]
mod tests;
