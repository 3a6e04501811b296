//! Sizes of a model.

/// Sizes of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Sizes {
    /// Units (bodies).
    pub units: usize,
    /// Hex8 elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Unknowns; of a run those that were solved.
    pub dofs: usize,
    /// Contact points.
    pub contact_points: usize,
}
