//! How a Schur complement lies in memory.

/// A square matrix by columns, or its lower triangle cut into panels of columns: each panel is a
/// rectangle from its first diagonal entry down, stored by columns, so that products can write it whole
/// and little beyond the triangle is stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panels {
    /// Rows of the matrix.
    pub order: usize,
    /// Columns of a panel.
    pub wide: usize,
}

impl Panels {
    /// Numbers stored.
    pub fn len(self) -> usize {
        self.start(self.order)
    }

    /// Start of the panel that begins with column c, a multiple of the panels' width or the order.
    fn start(self, c: usize) -> usize {
        let (full, rest) = (c / self.wide, c % self.wide);
        let before =
            self.wide * (self.order * full - self.wide * (full * full.saturating_sub(1) / 2));
        before + rest * (self.order - full * self.wide)
    }

    /// Start of column c, and the row it starts with.
    #[inline]
    pub fn column(self, c: usize) -> (usize, usize) {
        let first = c - c % self.wide;
        (
            self.start(first) + (c - first) * (self.order - first),
            first,
        )
    }

    /// First column of each panel, with its numbers.
    pub fn split<T>(self, mut numbers: &mut [T]) -> impl Iterator<Item = (usize, &mut [T])> {
        (0..self.order).step_by(self.wide).map(move |first| {
            let columns = self.wide.min(self.order - first);
            let (panel, rest) =
                std::mem::take(&mut numbers).split_at_mut(columns * (self.order - first));
            numbers = rest;
            (first, panel)
        })
    }
}
