//! Inertia: time integration, onset and end of motion, collapse.

mod buckling;
pub(in crate::solve) mod collapse;
pub(in crate::solve) mod integration;
pub(in crate::solve) mod onset;
