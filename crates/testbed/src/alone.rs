//! A lock on an output folder, because two programs that write into the same folder would replace each other's files.

use std::fs::{File, TryLockError};
use std::path::Path;

use anyhow::bail;

/// A lock on a folder: while it exists, no other testbed begins to write into the folder. It leaves no file there.
pub struct Alone {
    _folder: Option<File>,
}

impl Alone {
    /// Locks the folder at `path`, which must exist. On systems that cannot lock folders, it has no effect.
    ///
    /// # Errors
    /// If another testbed has locked it.
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
