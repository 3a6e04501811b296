//! What the stiffness of a cell was written with, so that it need not be written again.

use nalgebra::Matrix3;
use wythe_contact::Symmetric;

use super::sight::Sight;

/// Turning of the frame, and sliding over half a facet, that the stiffness of an iterate need not know of: the
/// forces know of all (docs/decisions.md).
const NEAR: f64 = 1e-4;

/// A point's part in the stiffness of its cell (shifted penalty).
#[derive(Clone, Copy, Debug, Default)]
pub struct Written {
    /// The cell among those of its facet, and one; 0 = none.
    cell: u32,
    /// Normal stiffness, and the unique ones of shear 11, 12, 22 [N/mm³].
    tangent: [f64; 4],
    frame: [[f64; 3]; 3],
    xi: [f64; 2],
}

impl Written {
    /// Of a tangent whose shear part is symmetric and knows nothing of the normal one.
    #[inline(always)]
    pub(super) fn new(sight: &Sight, tangent: &Matrix3<f64>) -> Self {
        Self {
            cell: sight.cell as u32 + 1,
            tangent: [
                tangent[(0, 0)],
                tangent[(1, 1)],
                tangent[(1, 2)],
                tangent[(2, 2)],
            ],
            frame: sight.frame,
            xi: sight.xi,
        }
    }

    /// Whether it is in the cell of this number among those of its facet.
    #[inline(always)]
    pub(super) fn is_in(&self, cell: usize) -> bool {
        self.cell as usize == cell + 1
    }

    /// Whether the stiffness is the same but for a little turning and sliding.
    #[inline(always)]
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let mut near = self.tangent == other.tangent;
        for i in 0..2 {
            near &= (self.xi[i] - other.xi[i]).abs() <= NEAR;
        }
        for axis in 0..2 {
            for i in 0..3 {
                near &= (self.frame[axis][i] - other.frame[axis][i]).abs() <= NEAR;
            }
        }
        near
    }

    /// Its part in the stiffness of the cell, of its weights; area in mm².
    #[inline(always)]
    pub(super) fn stiffness(&self, weights: [f64; 8], area: f64) -> Symmetric {
        Symmetric::new(weights, &self.frame, self.tangent, area)
    }
}
