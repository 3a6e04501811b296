//! Division of a slave facet into four quads, one around each contact point.

/// Weights of the corners of a facet at the nine points of its quarters: the corners, the midpoints of the edges from
/// corner k to the next, and the centre.
pub const WEIGHTS: [[f64; 4]; 9] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
    [0.5, 0.5, 0.0, 0.0],
    [0.0, 0.5, 0.5, 0.0],
    [0.0, 0.0, 0.5, 0.5],
    [0.5, 0.0, 0.0, 0.5],
    [0.25, 0.25, 0.25, 0.25],
];

/// Points of the quarter around each contact point: its corner, the midpoint of the next edge, the centre and the
/// midpoint of the previous edge.
pub const QUARTERS: [[i64; 4]; 4] = [[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]];
