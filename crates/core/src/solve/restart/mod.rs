//! Checkpoints: the data of a run between two increments, and resumed runs.

pub(in crate::solve) mod checkpoint;
pub(in crate::solve) mod fingerprint;
pub(in crate::solve) mod restart_data;
