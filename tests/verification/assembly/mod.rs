//! Tests of the module `assembly`.

mod gather;
mod global_tangent;
mod rigid_bodies;
mod similar_elements;
mod stiffness_reuse;
