//! Forces and stiffness of the cells of one increment: elements, then contact pairs.

use crate::assembly::stiffness_reuse::Held;

/// Forces and stiffness of all cells.
#[derive(Clone, Debug, Default)]
pub struct TrialCells {
    /// Nodal forces of each cell [N]. `[cell][node][xyz]`
    pub force: Vec<[[f64; 3]; 8]>,
    /// Stiffness of each cell [N/mm]. `[cell][CELL]`
    pub(in crate::assembly) stiffness: Vec<f64>,
    /// Positions at which the stiffness was written.
    pub(in crate::assembly) held: Held,
    /// Whether a cell contributes stiffness now. `[cell]`
    pub(in crate::assembly) active: Vec<bool>,
    /// Cells that changed since a matrix was last filled: their stiffness was written, or they began or ceased
    /// to contribute. `[cell]`
    pub(in crate::assembly) changed: Vec<bool>,
    /// Number of that filling.
    pub(in crate::assembly) filling: u64,
}

impl TrialCells {
    /// Takes over the stiffness of `other`. The forces stay.
    pub(super) fn take_stiffness(&mut self, other: Self) {
        *self = Self {
            force: std::mem::take(&mut self.force),
            ..other
        };
    }
}
