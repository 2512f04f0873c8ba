//! Proposals on a small arm.
