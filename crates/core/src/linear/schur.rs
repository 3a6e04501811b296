//! Memory layout of a Schur complement.

/// A square matrix stored by columns, or its lower triangle divided into panels of columns.
///
/// Each panel is a rectangle from its first diagonal entry downwards, stored by columns. So products can write a
/// whole panel, and little beyond the triangle is stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panels {
    /// Rows of the matrix.
    pub order: usize,
    /// Columns of a panel.
    pub wide: usize,
}

impl Panels {
    /// Count of stored numbers.
    pub fn len(self) -> usize {
        self.start(self.order)
    }

    /// Start of the panel that begins with column c. c is a multiple of the panel width, or the order.
    fn start(self, c: usize) -> usize {
        let (full, rest) = (c / self.wide, c % self.wide);
        let before =
            self.wide * (self.order * full - self.wide * (full * full.saturating_sub(1) / 2));
        before + rest * (self.order - full * self.wide)
    }

    /// Start of column c, and its first row.
    #[inline]
    pub fn column(self, c: usize) -> (usize, usize) {
        let first = c - c % self.wide;
        (
            self.start(first) + (c - first) * (self.order - first),
            first,
        )
    }

    /// First column of each panel, and its numbers.
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
