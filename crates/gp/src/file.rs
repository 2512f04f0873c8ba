//! JSON files of models: written completely or not at all, read with their version.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::GpError;

#[derive(Deserialize)]
struct Tag {
    format: String,
}

/// Writes `value` to a JSON file, completely or not at all: first to a temporary file in the same folder, which is then renamed.
pub(crate) fn save(value: &impl Serialize, path: &Path) -> Result<(), GpError> {
    let failed = |source| GpError::File { path: path.to_owned(), source };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    let mut writer = BufWriter::new(file);
    serde_json::to_writer(&mut writer, value).map_err(|error| failed(error.into()))?;
    writer.flush().map_err(failed)?;
    let file = writer.into_inner().map_err(|error| failed(error.into_error()))?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Reads a file of [`save`], of the version `expected`.
pub(crate) fn load<T: DeserializeOwned>(path: &Path, expected: &str) -> Result<T, GpError> {
    let text = fs::read_to_string(path).map_err(|source| GpError::File { path: path.to_owned(), source })?;
    let malformed = |reason: String| GpError::Format { path: path.to_owned(), reason };
    // The version is checked first, so that a file of another version is not refused for a missing field.
    let tag: Tag = serde_json::from_str(&text).map_err(|error| malformed(error.to_string()))?;
    if tag.format != expected {
        let given = tag.format;
        return Err(malformed(format!("format is \"{given}\", expected \"{expected}\"")));
    }
    serde_json::from_str(&text).map_err(|error| malformed(error.to_string()))
}

pub(crate) fn check_finite(name: &str, values: &[f64]) -> Result<(), String> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(format!("{name}[{at}] is {}", values[at])),
        None => Ok(()),
    }
}
