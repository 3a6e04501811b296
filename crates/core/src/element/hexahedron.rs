//! A hexahedron with its eight corners and six faces.

/// Corners in VTK's order [mm]: (−,−,−) (+,−,−) (+,+,−) (−,+,−), then the same four at +z. `[corner][xyz]`
pub type Corners = [[f64; 3]; 8];

/// A face of a block, named by its outward normal before the block is rotated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// −x.
    Left,
    /// +x.
    Right,
    /// −y.
    Front,
    /// +y.
    Back,
    /// −z.
    Bottom,
    /// +z.
    Top,
}

impl Face {
    /// All faces with their names in a deck.
    pub const ALL: [(&'static str, Self); 6] = [
        ("left", Self::Left),
        ("right", Self::Right),
        ("front", Self::Front),
        ("back", Self::Back),
        ("bottom", Self::Bottom),
        ("top", Self::Top),
    ];

    /// Axis of the normal, and whether the normal points in the positive direction of the axis.
    pub fn side(self) -> (usize, bool) {
        let index = self as usize;
        (index / 2, index % 2 == 1)
    }

    /// Local coordinates (0 or 1) of the face's corners along ξ, η, ζ, counter-clockwise seen from outside.
    fn round(self) -> [[usize; 3]; 4] {
        let (axis, high) = self.side();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut round = [(0, 0), (1, 0), (1, 1), (0, 1)];
        if !high {
            round.swap(1, 3);
        }
        round.map(|(a, b)| {
            let mut at = [0; 3];
            (at[axis], at[u], at[v]) = (usize::from(high), a, b);
            at
        })
    }

    /// Indices of the face's corners among those of a hexahedron, counter-clockwise seen from outside.
    pub fn corners(self) -> [usize; 4] {
        self.round()
            .map(|place| PLACES.iter().position(|p| *p == place).unwrap_or_default())
    }

    /// Positions of the face's corners on a hexahedron [mm], counter-clockwise seen from outside.
    pub fn outline(self, corners: &Corners) -> [[f64; 3]; 4] {
        self.corners().map(|c| corners[c])
    }
}

/// Local coordinates (0 or 1) of the corners along ξ, η, ζ, in VTK's order. `[corner][ξηζ]`
pub(crate) const PLACES: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// Pairs of corners that form edges.
pub(crate) const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// Smallest and largest of the numbers; [∞, −∞] if there are none.
pub(crate) fn range(of: impl IntoIterator<Item = f64>) -> [f64; 2] {
    of.into_iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
}

/// Whether the trilinear map of these corners has a positive Jacobian at every corner. There the determinant is the
/// triple product of the three edges.
pub(crate) fn is_upright(corners: &Corners) -> bool {
    let at = |place: [usize; 3]| {
        let corner = PLACES.iter().position(|p| *p == place).unwrap_or_default();
        corners[corner]
    };
    PLACES.iter().all(|&place| {
        let edge = |d: usize| {
            let (mut from, mut to) = (place, place);
            (from[d], to[d]) = (0, 1);
            difference(at(to), at(from))
        };
        dot(cross(edge(0), edge(1)), edge(2)) > 0.0
    })
}

/// Point at the fractions `[r, s, t]` (0 to 1) along the edges [mm]. a + t (b − a) is exact at both ends.
pub(crate) fn point(corners: &Corners, [r, s, t]: [f64; 3]) -> [f64; 3] {
    let between = |a: f64, b: f64, t: f64| if t == 1.0 { b } else { a + t * (b - a) };
    [0, 1, 2].map(|d| {
        let c = |n: usize| corners[n][d];
        let low = between(between(c(0), c(1), r), between(c(3), c(2), r), s);
        let high = between(between(c(4), c(5), r), between(c(7), c(6), r), s);
        between(low, high, t)
    })
}

/// Area vector of a quadrilateral, half the cross product of its diagonals [mm²].
pub(crate) fn area_vector(q: &[[f64; 3]; 4]) -> [f64; 3] {
    cross(difference(q[2], q[0]), difference(q[3], q[1])).map(|x| 0.5 * x)
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn mean(points: &[[f64; 3]; 4]) -> [f64; 3] {
    [0, 1, 2].map(|d| points.iter().map(|x| x[d]).sum::<f64>() / 4.0)
}
