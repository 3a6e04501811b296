//! Inertia: time integration, where bodies begin to move or come to rest, collapse.

pub(in crate::solve) mod collapse;
pub(in crate::solve) mod integration;
pub(in crate::solve) mod onset;
