//! Compressed files, whole and damaged.
