//! Input of a factorisation, and the ranges of its buffers that branches of the tree work on.

/// Matrix to factorise, and the fronts to eliminate.
#[derive(Clone, Copy)]
pub(super) struct Matrix<'a> {
    pub todo: &'a [bool],  // [supernode]
    pub kept: &'a [usize], // [supernode + 1] start of kept Schur complements
    pub values: &'a [f64], // [entry]
    /// Σ_j |a_ij|. `[equation]`
    pub sums: &'a [f64],
}

/// Ranges of all buffers that belong to a range of supernodes.
pub(super) struct Share<'a, T> {
    pub factors: &'a mut [T],
    pub pivots: &'a mut [u32],
    pub stacks: [&'a mut [T]; 2],
    pub kept: &'a mut [T],
}

/// Buffers of one front.
pub(super) struct Front<'a, T> {
    pub factors: &'a mut [T],
    pub pivots: &'a mut [u32],
    pub stacks: [&'a mut [T]; 2],
    /// Offset of its Schur complement on its stack.
    pub offset: usize,
    /// Kept Schur complements of its task.
    pub kept: &'a mut [T],
    /// Start of these among all kept ones.
    pub base: usize,
}

impl<'a, T> Share<'a, T> {
    /// Splits off the first numbers of each buffer.
    pub fn split(self, cut: &Cut) -> (Share<'a, T>, Share<'a, T>) {
        let (factors, factors_after) = self.factors.split_at_mut(cut.factors);
        let (pivots, pivots_after) = self.pivots.split_at_mut(cut.pivots);
        let [even, odd] = self.stacks;
        let (even, even_after) = even.split_at_mut(cut.stacks[0]);
        let (odd, odd_after) = odd.split_at_mut(cut.stacks[1]);
        let (kept, kept_after) = self.kept.split_at_mut(cut.kept);
        let first = Share {
            factors,
            pivots,
            stacks: [even, odd],
            kept,
        };
        let after = Share {
            factors: factors_after,
            pivots: pivots_after,
            stacks: [even_after, odd_after],
            kept: kept_after,
        };
        (first, after)
    }

    pub fn reborrow(&mut self) -> Share<'_, T> {
        let [even, odd] = &mut self.stacks;
        Share {
            factors: self.factors,
            pivots: self.pivots,
            stacks: [even, odd],
            kept: self.kept,
        }
    }
}

/// Count of numbers in each buffer.
pub(super) struct Cut {
    pub factors: usize,
    pub pivots: usize,
    pub stacks: [usize; 2],
    pub kept: usize,
}
