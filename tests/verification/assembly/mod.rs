//! Tests of the module `assembly`.

mod gather;
mod global_tangent;
mod rigid_bodies;
mod stiffness_reuse;
