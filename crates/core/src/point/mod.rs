//! One material or interface point along a path: strains given, or found for given stresses. Pure: a law,
//! rows of targets in, states and tangents out; nothing is kept between calls.
//!
//! [`material_path`] and [`interface_path`] take a virgin point along a whole path, [`follow_material`] and
//! [`follow_interface`] hand over row by row, from any state on. [`checks`] are for tests of laws.

pub mod checks;
mod follow;
mod layout;
mod search;

pub use follow::{
    Record, RowFailure, Walk, follow, follow_interface, follow_material, interface_outputs,
    interface_path, interface_state, material_outputs, material_path, material_state,
};
pub use layout::{INTERFACE, Layout, MATERIAL, interface_layout, material_layout};
pub use search::{Answer, Limit, PointFailure, State, advance};

/// What one component is told to do in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Take this strain [-] or gap [mm].
    Strain(f64),
    /// Take the strain that gives this stress [MPa].
    Stress(f64),
}

/// One row of a path. Targets and time grow linearly from where the point is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const N: usize> {
    /// Time at its end [s].
    pub time: f64,
    /// What the components do.
    pub targets: [Target; N],
}
