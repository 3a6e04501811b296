//! Directions in plan of level faces that may be turned about the vertical axis.

/// Width of the classes in which edges are sorted by their angle, and largest angle between sides that count as
/// parallel [degrees].
pub(super) const PARALLEL: f64 = 1.0;
/// Angle below which a face lies along x and y [degrees].
const LEVEL: f64 = 1e-6;

/// Angle between two directions that count as one if they are at right angles, between -45 and 45 degrees.
pub(super) fn away(a: f64, b: f64) -> f64 {
    (a - b) - 90.0 * ((a - b) / 90.0).round()
}

/// Angle from x to the edges of facets in plan, between -46 and 46 degrees: of the class with the longest edges, the
/// mean. Corners of each facet [mm].
pub(super) fn angle(facets: impl Iterator<Item = [[f64; 3]; 4]>) -> f64 {
    let edges = facets.flat_map(|x| {
        [0, 1, 2, 3].map(|k| {
            let [a, b] = [0, 1].map(|i| x[(k + 1) % 4][i] - x[k][i]);
            (away(b.atan2(a).to_degrees(), 0.0), a.hypot(b))
        })
    });
    let edges: Vec<(f64, f64)> = edges.filter(|(_, length)| *length > 0.0).collect();
    let near = |middle: f64| {
        let own = edges
            .iter()
            .map(move |(a, length)| (away(*a, middle), *length));
        own.filter(|(a, _)| a.abs() <= PARALLEL)
    };
    let length = |middle: f64| near(middle).map(|(_, length)| length).sum::<f64>();
    let classes = (-45..45).map(f64::from);
    // Of equal classes that about the angle is the nearest.
    let size = |middle: f64| {
        (
            length(middle),
            -near(middle).map(|(a, l)| a.abs() * l).sum::<f64>(),
        )
    };
    let most = classes.max_by(|a, b| {
        let (a, b) = (size(*a), size(*b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let most = most.unwrap_or(0.0);
    let turned = near(most).map(|(a, length)| a * length).sum::<f64>();
    let angle = most + turned / length(most).max(f64::MIN_POSITIVE);
    if angle.abs() <= LEVEL { 0.0 } else { angle }
}

/// Directions in plan: u at an angle from x, v across.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanFrame {
    /// Cosine and sine of the angle.
    u: [f64; 2],
}

impl PlanFrame {
    /// Directions at an angle [degrees].
    pub fn of(angle: f64) -> Self {
        let (sine, cosine) = angle.to_radians().sin_cos();
        Self { u: [cosine, sine] }
    }

    /// The directions turned by whole quarters, without rounding.
    pub fn turned(self, quarters: usize) -> Self {
        let turn = |[c, s]: [f64; 2], _| [-s, c];
        Self {
            u: (0..quarters).fold(self.u, turn),
        }
    }

    /// Coordinates along u and v [mm].
    pub fn plan(&self, x: [f64; 3]) -> [f64; 2] {
        let [c, s] = self.u;
        [c * x[0] + s * x[1], c * x[1] - s * x[0]]
    }

    /// The place with coordinates along u and v [mm].
    pub fn place(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        let [c, s] = self.u;
        [c * u - s * v, s * u + c * v, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a rectangle turned about the origin.
    fn rectangle(length: f64, width: f64, degrees: f64) -> [[f64; 3]; 4] {
        let frame = PlanFrame::of(degrees);
        [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]].map(|p| frame.place(p, 0.0))
    }

    #[test]
    fn edges_give_the_angle() {
        for degrees in [0.0, 0.5, 10.0, 30.0, -44.5] {
            let found = angle([rectangle(900.0, 100.0, degrees)].into_iter());
            // Rounding of the angle.
            assert!((found - degrees).abs() < 1e-9, "{degrees}: {found}");
        }
        // A few skewed ends change nothing.
        let mixed = [rectangle(900.0, 100.0, 20.0), rectangle(50.0, 100.0, 55.0)];
        assert!((angle(mixed.into_iter()) - 20.0).abs() < 1e-9);
        assert!(away(angle([rectangle(9.0, 1.0, 45.0)].into_iter()), 45.0).abs() < 1e-9);
        assert_eq!(angle([rectangle(9.0, 1.0, 90.0)].into_iter()), 0.0);
        let frame = PlanFrame::of(30.0).turned(3);
        let along = frame.place([1.0, 0.0], 0.0);
        assert!((along[0] - 0.5).abs() < 1e-14 && along[1] < 0.0);
        let back = frame.plan(frame.place([3.0, 4.0], 0.0));
        assert!((back[0] - 3.0).abs() < 1e-14 && (back[1] - 4.0).abs() < 1e-14);
    }
}
