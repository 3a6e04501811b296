//! Checkpoints: a run between two increments, and how it continues.

pub(in crate::solve) mod checkpoint;
pub(in crate::solve) mod fingerprint;
pub(in crate::solve) mod restart_data;
