//! Pairs of slave points and master facets.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::aabb::Aabb;
use crate::bvh::Bvh;
use crate::projection::{Projection, extend, project};
use crate::surface::{Surface, frame_at};

/// The facet that a contact point faces, and the foot of the perpendicular at the last accepted increment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointPair {
    /// Master facet; `None` without contact.
    pub facet: Option<u32>,
    /// Parameters of the foot at the last accepted increment, the anchor of the slip.
    pub xi: [f64; 2],
}

/// Two facets face each other if the cosine between their normals is below this value.
const FACING: f64 = -0.2;
/// A point leaves its facet only at this distance beyond the edge (relative to half the facet), so that it does not
/// alternate between two facets that share an edge.
pub const STAY: f64 = 1e-3;
/// A point changes to a facet if it projects onto it within this tolerance (rounding). A facet beyond whose edge it
/// lies by up to [`STAY`] or [`RIM`] is taken only if there is no other.
const ENTER: f64 = 1e-9;
/// A point stays on the rim of a surface up to this distance beyond it (relative to half the facet). Flush faces
/// bulge and slide by some hundredths of a facet within an increment.
pub const RIM: f64 = 0.1;

/// For each slave facet the master facets that its points may meet while the surfaces move less than the search
/// margin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    start: Vec<u32>,
    facets: Vec<u32>,
}

/// Search for candidates. The hierarchy over the master facets is built once and refitted as they move. Scratch
/// memory is reused.
#[derive(Clone, Debug, Default)]
pub struct Search {
    bvh: Bvh,
    /// `[master facet]`
    boxes: Vec<Aabb>,
    /// `[master facet]`
    normals: Vec<Vector3<f64>>,
    stack: Vec<u32>,
    found: Vec<u32>,
}

impl Search {
    /// All pairs of facets of different bodies that face each other, for which the box of the slave facet's points
    /// `[facet]` lies within `radius` [mm] of the master facet's box.
    ///
    /// The result depends only on the positions, not on earlier searches.
    pub fn candidates(
        &mut self,
        slave: &Surface,
        points: &[Aabb],
        master: &Surface,
        x: &[[f64; 3]],
        radius: f64,
    ) -> Candidates {
        self.boxes.clear();
        self.normals.clear();
        for f in 0..master.facets.len() {
            let corners = master.corners(f, x);
            self.boxes.push(Aabb::of(&corners));
            self.normals.push(frame_at(&corners, [0.0; 2])[0]);
        }
        if self.bvh.len() == self.boxes.len() {
            self.bvh.refit(&self.boxes);
        } else {
            self.bvh = Bvh::build(&self.boxes);
        }
        let Self {
            bvh,
            boxes,
            normals,
            stack,
            found,
        } = self;
        let mut result = Candidates {
            start: vec![0],
            facets: Vec::new(),
        };
        for f in 0..slave.facets.len() {
            let normal = frame_at(&slave.corners(f, x), [0.0; 2])[0];
            found.clear();
            bvh.query(boxes, &points[f].fattened(radius), stack, |m| {
                let other = slave.body[f] != master.body[m as usize];
                if other && normal.dot(&normals[m as usize]) < FACING {
                    found.push(m);
                }
            });
            found.sort_unstable();
            result.facets.extend_from_slice(found);
            result.start.push(result.facets.len() as u32);
        }
        result
    }
}

impl Candidates {
    /// [`Search::candidates`] for a single search.
    pub fn find(
        slave: &Surface,
        points: &[Aabb],
        master: &Surface,
        x: &[[f64; 3]],
        radius: f64,
    ) -> Self {
        Search::default().candidates(slave, points, master, x, radius)
    }

    /// Candidates of a slave facet in ascending order.
    #[inline]
    pub fn of(&self, slave: usize) -> &[u32] {
        &self.facets[self.range(slave)]
    }

    /// Index range of a slave facet's candidates in the list of all candidates.
    #[inline]
    pub fn range(&self, slave: usize) -> std::ops::Range<usize> {
        self.start[slave] as usize..self.start[slave + 1] as usize
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.facets.len()
    }

    /// True if there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.facets.is_empty()
    }
}

/// How far a point may be from the facet that it faces.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Distance in front of the facet, and behind it [mm].
    pub radius: f64,
    /// Distance beyond the rim of the surface, over half the facet [-].
    pub rim: f64,
    /// Largest difference of the heights of flush facets [mm]: a point keeps to the rim of its facet beside a step.
    pub flush: f64,
    /// Whether the point is held by its facet: it keeps it however deep it is pressed, and other facets take it at up
    /// to twice that depth.
    pub held: bool,
}

/// Part of its present depth by which that behind the next facet may differ where a point changes to it.
const DEEPER: f64 = 0.5;

/// The facet that a point faces. The point keeps its present facet while it stays on it. Otherwise it takes the
/// nearest candidate onto which it projects. Otherwise it takes the nearest candidate beyond whose edge it lies by no
/// more than [`STAY`] of the half facet, or by `rim` if it faced a facet before. Ties go to the lowest number. `None`
/// without such a facet within reach. Where the next facet is of another body and lies higher or lower than the present
/// one, so that the traction would jump, the point stays with the present one up to `rim` beyond its edge.
pub fn pair_point(
    point: &Vector3<f64>,
    present: Option<(u32, [f64; 2])>,
    candidates: &[u32],
    master: &Surface,
    x: &[[f64; 3]],
    Reach {
        radius,
        rim,
        flush,
        held,
    }: Reach,
) -> Option<(u32, [f64; 2])> {
    let mut deep = radius;
    let near =
        |foot: &Projection, deep: f64| foot.distance <= if foot.gap < 0.0 { deep } else { radius };
    let mut at_rim: Option<(u32, Projection)> = None;
    if let Some((facet, xi)) = present
        && let Some(foot) = extend(point, &master.corners(facet as usize, x), xi)
    {
        if held {
            deep = deep.max(-2.0 * foot.gap);
        }
        if within(foot.xi, STAY) && near(&foot, deep) {
            return Some((facet, foot.xi));
        }
        at_rim = (within(foot.xi, rim) && near(&foot, deep)).then_some((facet, foot));
    }
    let most = if present.is_some() { rim } else { STAY };
    let mut best: Option<(bool, f64, u32, Projection)> = None;
    for &facet in candidates {
        let Some(foot) = extend(point, &master.corners(facet as usize, x), [0.0; 2]) else {
            continue;
        };
        if !(within(foot.xi, most) && near(&foot, deep)) {
            continue;
        }
        let over = !within(foot.xi, ENTER);
        let distance = if over {
            project(point, &master.corners(facet as usize, x)).distance
        } else {
            foot.distance
        };
        if best.is_none_or(|(o, d, _, _)| (over, distance) < (o, d)) {
            best = Some((over, distance, facet, foot));
        }
    }
    let (over, _, facet, foot) = best?;
    match at_rim {
        Some((present, rim)) if !over => {
            let [pressed, next] = [rim.gap, foot.gap].map(|gap| gap.min(0.0));
            let other = master.body[facet as usize] != master.body[present as usize];
            let is_step = other && (next - pressed).abs() > flush + DEEPER * pressed.abs();
            let (facet, foot) = if is_step {
                (present, rim)
            } else {
                (facet, foot)
            };
            Some((facet, foot.xi))
        }
        _ => Some((facet, foot.xi)),
    }
}

/// The nearest point on the rim of a surface for a point beyond it, with the facet. `None` if the point projects onto
/// a candidate, or is farther than `radius` [mm] from the planes of all candidates, or more than `deep` [mm] behind them:
/// it lies beside those.
pub fn rim_point(
    point: &Vector3<f64>,
    candidates: &[u32],
    master: &Surface,
    x: &[[f64; 3]],
    [radius, deep]: [f64; 2],
) -> Option<(u32, Projection)> {
    let mut best: Option<(u32, Projection)> = None;
    for &facet in candidates {
        let foot = project(point, &master.corners(facet as usize, x));
        if foot.gap > radius || foot.gap < -deep {
            continue;
        }
        if foot.inside {
            return None;
        }
        if best.is_none_or(|(_, b)| foot.distance < b.distance) {
            best = Some((facet, foot));
        }
    }
    best
}

/// Whether a point whose foot has these parameters stays on its facet.
pub fn stays_on(xi: [f64; 2]) -> bool {
    within(xi, STAY)
}

fn within(xi: [f64; 2], beyond: f64) -> bool {
    xi[0].abs() <= 1.0 + beyond && xi[1].abs() <= 1.0 + beyond
}

/// Components of a tangential vector in another frame (theory/contact.md, eq. 8). The vector is rotated by the
/// smallest rotation that takes one normal into the other. This preserves its length, and differences of vectors
/// (elastic slip) transform in the same way.
pub fn to_frame(v: [f64; 2], from: &[Vector3<f64>; 3], to: &[Vector3<f64>; 3]) -> [f64; 2] {
    let vector = from[1] * v[0] + from[2] * v[1];
    // Rodrigues: v + w × v + w × (w × v)/(1 + cos), w = n × n'.
    let (w, cos) = (from[0].cross(&to[0]), from[0].dot(&to[0]));
    let turned = if cos > -1.0 + 1e-12 {
        let once = w.cross(&vector);
        vector + once + w.cross(&once) / (1.0 + cos)
    } else {
        // Opposite normals: the smallest rotation is not unique. Rotate by π about t₁.
        from[1] * v[0] - from[2] * v[1]
    };
    [to[1].dot(&turned), to[2].dot(&turned)]
}
