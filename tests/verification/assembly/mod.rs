//! Tests of the module `assembly`.

mod gather;
mod global_tangent;
mod stiffness_reuse;
