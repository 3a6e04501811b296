//! Tests of the room `assembly`.

mod gather;
mod global_tangent;
mod stiffness_reuse;
