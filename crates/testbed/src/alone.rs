//! One program per folder: two that write into the same one would replace each other's files.

use std::fs::{File, TryLockError};
use std::path::Path;

use anyhow::bail;

/// While it lives, no other testbed begins to write into the folder. It leaves no file there.
pub struct Alone {
    _folder: Option<File>,
}

impl Alone {
    /// Takes the folder at `path`, which exists. Where the system cannot lock folders, two programs are not told apart.
    ///
    /// # Errors
    /// If another testbed has it.
    pub fn in_folder(path: &Path) -> anyhow::Result<Self> {
        let Ok(folder) = File::open(path) else {
            return Ok(Self { _folder: None });
        };
        if let Err(TryLockError::WouldBlock) = folder.try_lock() {
            bail!(
                "{}: another testbed is writing into this folder; wait for it, or give another --out",
                path.display()
            );
        }
        Ok(Self { _folder: Some(folder) })
    }
}
