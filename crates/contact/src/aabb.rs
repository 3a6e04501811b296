//! Axis-aligned bounding boxes.

/// An axis-aligned box [mm].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: [f64; 3],
    /// Highest corner.
    pub max: [f64; 3],
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Self = Self {
        min: [f64::INFINITY; 3],
        max: [f64::NEG_INFINITY; 3],
    };

    /// Smallest box that contains the points.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Self {
        let mut result = Self::EMPTY;
        for p in points {
            for i in 0..3 {
                result.min[i] = result.min[i].min(p[i]);
                result.max[i] = result.max[i].max(p[i]);
            }
        }
        result
    }

    /// Smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let mut result = *self;
        for i in 0..3 {
            result.min[i] = result.min[i].min(other.min[i]);
            result.max[i] = result.max[i].max(other.max[i]);
        }
        result
    }

    /// The box enlarged by `margin` on all sides [mm].
    #[must_use]
    pub fn fattened(&self, margin: f64) -> Self {
        Self {
            min: self.min.map(|v| v - margin),
            max: self.max.map(|v| v + margin),
        }
    }

    /// True if the two boxes share at least one point.
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "without branches queries measure faster"
    )]
    pub fn touches(&self, other: &Self) -> bool {
        let along = |i: usize| (self.min[i] <= other.max[i]) & (other.min[i] <= self.max[i]);
        along(0) & along(1) & along(2)
    }

    /// Centre [mm].
    pub fn centre(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| 0.5 * (self.min[i] + self.max[i]))
    }

    /// Square of the distance to a point [mm²].
    pub fn distance_squared(&self, p: &[f64; 3]) -> f64 {
        (0..3)
            .map(|i| (self.min[i] - p[i]).max(p[i] - self.max[i]).max(0.0))
            .map(|d| d * d)
            .sum()
    }
}
