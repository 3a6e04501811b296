//! Parts of a facet with sampling points of their own, where four points per facet are too few.

use crate::surface::weights_at;

/// A rectangle in a facet's parameters ξ, η ∈ [−1, 1] that is sampled by four points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Centre (ξ, η).
    pub middle: [f64; 2],
    /// Half of the side lengths along ξ and η.
    pub half: [f64; 2],
}

impl Part {
    /// The whole facet.
    pub const WHOLE: Self = Self {
        middle: [0.0; 2],
        half: [1.0; 2],
    };

    /// The parts of a facet that is divided into `along_xi` × `along_eta` rectangles, row by row.
    pub fn grid([along_xi, along_eta]: [u32; 2]) -> impl Iterator<Item = Self> {
        let half = [along_xi, along_eta].map(|count| 1.0 / f64::from(count));
        (0..along_eta).flat_map(move |j| {
            (0..along_xi).map(move |i| Self {
                middle: [
                    f64::from(2 * i + 1) * half[0] - 1.0,
                    f64::from(2 * j + 1) * half[1] - 1.0,
                ],
                half,
            })
        })
    }

    /// Facet parameters of a point given in parameters of the part.
    pub fn at(&self, xi: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| self.middle[d] + self.half[d] * xi[d])
    }

    /// Weights of the facet's corners at the corners of the part. `[part corner][facet corner]`
    pub fn corners(&self) -> [[f64; 4]; 4] {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|xi| weights_at(self.at(xi)))
    }

    /// Interpolates values at the facet's corners to the corners of the part.
    pub fn of(&self, values: &[[f64; 3]; 4]) -> [[f64; 3]; 4] {
        if *self == Self::WHOLE {
            return *values;
        }
        self.corners()
            .map(|weights| [0, 1, 2].map(|i| (0..4).map(|a| weights[a] * values[a][i]).sum()))
    }

    /// Whether the corner `corner` of the part is also a corner of the facet.
    pub fn reaches(&self, corner: usize) -> bool {
        self.corners()[corner][corner] > 1.0 - 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_their_facet() {
        let corners = [
            [0.0, 0.0, 0.0],
            [6.0, 0.0, 0.0],
            [6.0, 4.0, 0.0],
            [0.0, 4.0, 0.0],
        ];
        let parts: Vec<Part> = Part::grid([3, 2]).collect();
        assert_eq!(parts.len(), 6);
        // The second part of the lower row and the last part of the upper row.
        let close = |found: [[f64; 3]; 4], low: [f64; 2], high: [f64; 2]| {
            let exact = [
                [low[0], low[1]],
                [high[0], low[1]],
                [high[0], high[1]],
                [low[0], high[1]],
            ];
            for (found, exact) in found.iter().zip(exact) {
                for d in 0..2 {
                    assert!((found[d] - exact[d]).abs() < 1e-14, "{found:?}"); // rounding
                }
            }
        };
        close(parts[1].of(&corners), [2.0, 0.0], [4.0, 2.0]);
        close(parts[5].of(&corners), [4.0, 2.0], [6.0, 4.0]);
        let reaching = |k: usize| parts.iter().position(|part| part.reaches(k));
        assert_eq!([0, 1, 2, 3].map(reaching), [0, 2, 5, 3].map(Some));
        assert_eq!(Part::grid([1, 1]).collect::<Vec<_>>(), [Part::WHOLE]);
        assert_eq!(Part::WHOLE.of(&corners), corners);
    }
}
