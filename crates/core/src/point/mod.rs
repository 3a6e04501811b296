//! One material or interface point driven along a path of prescribed strains or stresses. The functions are pure:
//! they map a law and rows of targets to states and tangents.
//!
//! [`material_path`] and [`interface_path`] drive a point along a whole path from its initial state.
//! [`follow_material`] and [`follow_interface`] start from any state and return row by row. [`checks`] supports tests
//! of laws.
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

/// Prescribed value of one component in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// This strain [-] or gap [mm].
    Strain(f64),
    /// The strain that gives this stress [MPa].
    Stress(f64),
}

/// One row of a path. Targets and time change linearly from the state of the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const N: usize> {
    /// Time at its end [s].
    pub time: f64,
    /// Targets of the components.
    pub targets: [Target; N],
}
