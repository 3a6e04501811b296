//! Joints between rigid bodies: the polygons in which their faces touch at rest.

use nalgebra::{Vector2, Vector3};
use std::collections::BTreeMap;
use wythe_contact::{Aabb, Candidates, InterfaceLaw, Surface};

use super::bodies::Bodies;
use crate::model::Model;
use crate::model::boundary_facets::BoundaryFacets;

/// Strengths of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Friction of the bond, or of the dry joint [-].
    pub friction: f64,
    /// Cohesion [MPa].
    pub cohesion: f64,
    /// Tensile strength [MPa].
    pub tension: f64,
}

/// A plane joint between two bodies.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Bodies; the normal points from the first to the second one.
    pub bodies: [usize; 2],
    /// Normal and two tangents, of length 1.
    pub frame: [Vector3<f64>; 3],
    /// Corners of the convex polygon [mm].
    pub corners: Vec<Vector3<f64>>,
    /// Area [mm²].
    pub area: f64,
    /// Index of its law; `None` for general contact.
    pub law: Option<u16>,
    /// Strengths.
    pub strength: Strength,
}

/// Gap of facets that touch, over the mean size of the facet. Decks round lengths.
const TOUCHING: f64 = 1e-3;
/// Cosine of the largest angle between facets that touch.
const PARALLEL: f64 = 0.999;
/// Part of its area by which a polygon may grow when it is merged with others into one that is convex.
const CONVEX: f64 = 1e-6;
/// Smallest area of a joint over that of its facet.
const SLIVER: f64 = 1e-6;
/// Part of its area by which the box along the first side of a rectangle may be larger. Decks round lengths.
const RECTANGLE: f64 = 1e-3;

impl Joint {
    /// Middle of the corners [mm].
    pub fn middle(&self) -> Vector3<f64> {
        let sum: Vector3<f64> = self.corners.iter().sum();
        sum / self.corners.len() as f64
    }

    /// Corners in the plane of the joint, counter-clockwise, from the first one [mm].
    pub fn flat(&self) -> Vec<Vector2<f64>> {
        let [_, first, second] = self.frame;
        let ways = self.corners.iter().map(|x| x - self.corners[0]);
        ways.map(|x| Vector2::new(x.dot(&first), x.dot(&second)))
            .collect()
    }

    /// Whether the polygon is a rectangle.
    pub fn is_rectangle(&self) -> bool {
        let [first, _, second, _] = self.edges();
        let extent = |along: &Vector3<f64>| {
            let [low, high] = self.reach(along);
            high - low
        };
        extent(&first) * extent(&second) <= (1.0 + RECTANGLE) * self.area
    }

    /// Areas for which the corners stand [mm²]: forces in these parts act at the centroid, as an even stress does.
    pub fn shares(&self) -> Vec<f64> {
        let count = self.corners.len();
        if count == 4 && self.is_rectangle() {
            return vec![self.area / 4.0; 4];
        }
        // Thirds of the triangles between the centroid and the sides; that of the centroid goes to the corners in the
        // parts in which they have it.
        let polygon = self.flat();
        let middle = centroid(&polygon);
        let triangle = |k: usize| {
            let [a, b] = [
                polygon[k % count] - middle,
                polygon[(k + 1) % count] - middle,
            ];
            0.5 * a.perp(&b)
        };
        let part = self.area / area(&polygon);
        let share = |k: usize| 0.5 * part * (triangle(k + count - 1) + triangle(k));
        (0..count).map(share).collect()
    }

    /// Directions towards four edges: those of a rectangle along the first side of the polygon.
    pub fn edges(&self) -> [Vector3<f64>; 4] {
        let side = self.corners[1] - self.corners[0];
        let first = side.try_normalize(0.0).unwrap_or(self.frame[1]);
        let second = self.frame[0].cross(&first);
        [first, -first, second, -second]
    }

    /// Distances of the corners from the middle of the joint towards an edge, over half of its depth there: 1 at the
    /// edge. `[corner]`
    pub fn arms(&self, edge: &Vector3<f64>) -> Vec<f64> {
        let [low, high] = self.reach(edge);
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let places = self.corners.iter().map(|x| x.dot(edge));
        places.map(|place| (place - middle) / half).collect()
    }

    /// Least and largest place of the corners along a direction [mm].
    fn reach(&self, along: &Vector3<f64>) -> [f64; 2] {
        let places = || self.corners.iter().map(|x| x.dot(along));
        let low = places().fold(f64::INFINITY, f64::min);
        [low, places().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// All joints of a model at rest. `bonded`: with tensile strength and cohesion; otherwise the joints are dry, with
    /// the friction that is left without bond. Faces that the deck pairs are not paired again by general contact.
    pub fn all(model: &Model, bodies: &Bodies, bonded: bool) -> Vec<Self> {
        let contact = &model.contact;
        let skin = BoundaryFacets::of(&model.mesh);
        let mut patches: BTreeMap<[usize; 2], Vec<Self>> = BTreeMap::new();
        let whole: Vec<(usize, [u32; 4])> = contact.whole_slaves().map(|(f, n)| (f, *n)).collect();
        let facets: Vec<[u32; 4]> = whole.iter().map(|(_, nodes)| *nodes).collect();
        let [slave, master] =
            [&facets, &contact.master_facets].map(|facets| Side::of(facets, &skin, bodies));
        touching(
            &model.mesh.nodes,
            &slave,
            &master,
            &mut |f, pair, polygon| {
                let law = contact.slave_law[whole[f].0];
                let strength = strength(&contact.laws[usize::from(law)], bonded);
                let joint = polygon.joint(pair, Some(law), strength);
                patches.entry(ordered(pair)).or_default().push(joint);
            },
        );
        if let Some(general) = &contact.general {
            let strength = Strength {
                friction: general.mu,
                cohesion: 0.0,
                tension: 0.0,
            };
            let mut loose: BTreeMap<[usize; 2], Vec<Self>> = BTreeMap::new();
            let all = Side::of(&skin.facets, &skin, bodies);
            touching(&model.mesh.nodes, &all, &all, &mut |_, pair, polygon| {
                // Each pair of bodies is found from both sides.
                if pair[0] < pair[1] && !patches.contains_key(&pair) {
                    let joint = polygon.joint(pair, None, strength);
                    loose.entry(pair).or_default().push(joint);
                }
            });
            patches.append(&mut loose);
        }
        patches.into_values().flat_map(merged).collect()
    }
}

/// The smaller number first.
fn ordered([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// Strengths of a law.
fn strength(law: &InterfaceLaw, bonded: bool) -> Strength {
    let (f_t, c, tan_phi, mu) = match law {
        InterfaceLaw::CohesiveFrictional(law) => (law.f_t, law.c, law.tan_phi, law.mu),
        InterfaceLaw::Cap(law) => (law.f_t, law.c, law.tan_phi, law.mu),
        // Slopes of a law that is not known: its friction is what it bounds a large pressure to.
        InterfaceLaw::Custom(law) => {
            let pressed = wythe_contact::InterfaceHistory::default();
            let bounded = law.within_bounds([-1.0, 1e3, 0.0], &pressed);
            let mu = bounded[1].abs();
            (0.0, 0.0, mu, mu)
        }
    };
    if bonded && c > 0.0 {
        Strength {
            friction: tan_phi,
            cohesion: c,
            tension: f_t,
        }
    } else {
        Strength {
            friction: mu,
            cohesion: 0.0,
            tension: 0.0,
        }
    }
}

/// Facets, and the body behind each.
struct Side {
    surface: Surface,
    body: Vec<Option<usize>>,
}

impl Side {
    fn of(facets: &[[u32; 4]], skin: &BoundaryFacets, bodies: &Bodies) -> Self {
        let behind = skin.behind(facets).into_iter();
        let body = behind.map(|element| element.map(|e| bodies.of_element[e as usize]));
        let body: Vec<Option<usize>> = body.collect();
        let number = |body: &Option<usize>| body.map_or(u32::MAX, |b| b as u32);
        Self {
            surface: Surface {
                facets: facets.to_vec(),
                body: body.iter().map(number).collect(),
            },
            body,
        }
    }
}

/// A convex polygon in space.
struct Polygon {
    frame: [Vector3<f64>; 3],
    corners: Vec<Vector3<f64>>,
    area: f64,
}

impl Polygon {
    fn joint(self, bodies: [usize; 2], law: Option<u16>, strength: Strength) -> Joint {
        Joint {
            bodies,
            frame: self.frame,
            corners: self.corners,
            area: self.area,
            law,
            strength,
        }
    }
}

/// Calls `found` with the slave facet, the bodies and the polygon of each pair of facets of two bodies that touch, for
/// nodes at `x` [mm].
fn touching(
    x: &[[f64; 3]],
    slave: &Side,
    master: &Side,
    found: &mut dyn FnMut(usize, [usize; 2], Polygon),
) {
    let corners = |facet: &[u32; 4]| facet.map(|n| x[n as usize]);
    let facets = &slave.surface.facets;
    let boxes: Vec<Aabb> = facets.iter().map(|f| Aabb::of(&corners(f))).collect();
    let sizes = facets.iter().map(|f| size(&corners(f)));
    let mean = sizes.sum::<f64>() / facets.len().max(1) as f64;
    let near = Candidates::find(&slave.surface, &boxes, &master.surface, x, TOUCHING * mean);
    for (f, facet) in facets.iter().enumerate() {
        for m in near.of(f) {
            let m = *m as usize;
            let (Some(a), Some(b)) = (slave.body[f], master.body[m]) else {
                continue;
            };
            if a == b {
                continue;
            }
            if let Some(polygon) = overlap(&corners(facet), &corners(&master.surface.facets[m])) {
                found(f, [a, b], polygon);
            }
        }
    }
}

/// Square root of the area of a facet [mm].
fn size(corners: &[[f64; 3]; 4]) -> f64 {
    area_vector(corners).norm().sqrt()
}

fn area_vector(corners: &[[f64; 3]; 4]) -> Vector3<f64> {
    let x = corners.map(Vector3::from);
    0.5 * (x[2] - x[0]).cross(&(x[3] - x[1]))
}

/// Common part of two facets that face each other and touch; none if there is none.
fn overlap(slave: &[[f64; 3]; 4], master: &[[f64; 3]; 4]) -> Option<Polygon> {
    let own = area_vector(slave);
    let normal = own.try_normalize(0.0)?;
    let other = area_vector(master).try_normalize(0.0)?;
    if normal.dot(&other) > -PARALLEL {
        return None;
    }
    let x = slave.map(Vector3::from);
    let origin = x.iter().sum::<Vector3<f64>>() / 4.0;
    let first = (x[1] - x[0]).try_normalize(0.0)?;
    let first = (first - normal * normal.dot(&first)).normalize();
    let second = normal.cross(&first);
    let gap = |x: &[f64; 3]| (Vector3::from(*x) - origin).dot(&normal).abs();
    let reach = TOUCHING * own.norm().sqrt();
    if master.iter().map(gap).fold(f64::INFINITY, f64::min) > reach {
        return None;
    }
    let flat = |x: &[f64; 3]| {
        let x = Vector3::from(*x) - origin;
        Vector2::new(x.dot(&first), x.dot(&second))
    };
    let clip: Vec<Vector2<f64>> = slave.iter().map(flat).collect();
    // The master runs the other way round, seen along the normal of the slave.
    let mut polygon: Vec<Vector2<f64>> = master.iter().rev().map(flat).collect();
    for k in 0..4 {
        polygon = clipped(&polygon, clip[k], clip[(k + 1) % 4]);
    }
    let area = area(&polygon);
    let corners = polygon.iter().map(|p| origin + first * p.x + second * p.y);
    (area > SLIVER * own.norm()).then(|| Polygon {
        frame: [normal, first, second],
        corners: corners.collect(),
        area,
    })
}

/// Part of a polygon to the left of a line (Sutherland and Hodgman 1974).
pub fn clipped(
    polygon: &[Vector2<f64>],
    from: Vector2<f64>,
    to: Vector2<f64>,
) -> Vec<Vector2<f64>> {
    let way = to - from;
    let side = |p: &Vector2<f64>| way.x * (p.y - from.y) - way.y * (p.x - from.x);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, p) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        let (here, there) = (side(p), side(next));
        if here >= 0.0 {
            kept.push(*p);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(p + (next - p) * (here / (here - there)));
        }
    }
    kept
}

/// Area of a polygon that runs counter-clockwise.
pub fn area(polygon: &[Vector2<f64>]) -> f64 {
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
    0.5 * edges.map(|(a, b)| a.x * b.y - a.y * b.x).sum::<f64>()
}

/// Centroid of a polygon; its first corner if it has no area.
pub fn centroid(polygon: &[Vector2<f64>]) -> Vector2<f64> {
    let Some(first) = polygon.first() else {
        return Vector2::zeros();
    };
    let (mut twice, mut moment) = (0.0, Vector2::zeros());
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (a, b) = (a - first, b - first);
        twice += a.perp(&b);
        moment += a.perp(&b) * (a + b);
    }
    if twice > 0.0 {
        first + moment / (3.0 * twice)
    } else {
        *first
    }
}

/// Joints of two bodies, with those of one plane merged where their union is convex.
fn merged(patches: Vec<Joint>) -> Vec<Joint> {
    let mut planes: Vec<Vec<Joint>> = Vec::new();
    for patch in patches {
        let belongs = |of: &&mut Vec<Joint>| {
            let own = &of[0];
            let gap = (patch.corners[0] - own.corners[0]).dot(&own.frame[0]).abs();
            own.bodies == patch.bodies
                && own.law == patch.law
                && own.frame[0].dot(&patch.frame[0]) > 1.0 - CONVEX
                && gap <= TOUCHING * own.area.sqrt()
        };
        match planes.iter_mut().find(belongs) {
            Some(plane) => plane.push(patch),
            None => planes.push(vec![patch]),
        }
    }
    planes.into_iter().flat_map(hull_of).collect()
}

/// The convex hull of joints in one plane, or the joints themselves if it is larger than they are.
fn hull_of(plane: Vec<Joint>) -> Vec<Joint> {
    let [_, first, second] = plane[0].frame;
    let origin = plane[0].corners[0];
    let flat = |x: &Vector3<f64>| Vector2::new((x - origin).dot(&first), (x - origin).dot(&second));
    let points = plane
        .iter()
        .flat_map(|joint| joint.corners.iter().map(flat));
    let hull = hull(points.collect());
    let (whole, parts) = (
        area(&hull),
        plane.iter().map(|joint| joint.area).sum::<f64>(),
    );
    if hull.len() < 3 || whole > (1.0 + CONVEX) * parts {
        return plane;
    }
    let corners = hull.iter().map(|p| origin + first * p.x + second * p.y);
    vec![Joint {
        corners: corners.collect(),
        area: whole,
        ..plane[0].clone()
    }]
}

/// Convex outline of points in a plane, counter-clockwise.
pub fn convex_outline(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let points = points.into_iter().map(Vector2::from).collect();
    hull(points).into_iter().map(Into::into).collect()
}

/// Convex hull, counter-clockwise (Jarvis 1973). Points on its edges are left out, whatever the rounding of the points:
/// of points on one line from a corner the farthest is the next corner.
fn hull(points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    let middle = points.iter().sum::<Vector2<f64>>() / points.len().max(1) as f64;
    let far = |a: &&Vector2<f64>, b: &&Vector2<f64>| {
        (*a - middle).norm().total_cmp(&(*b - middle).norm())
    };
    // The point that is farthest from any place is a corner.
    let Some(start) = points.iter().max_by(far) else {
        return points;
    };
    let reach = (start - middle).norm();
    let (same, straight) = (1e-9 * reach, 1e-9 * reach * reach);
    let mut corners = vec![*start];
    while corners.len() <= points.len() {
        let from = corners[corners.len() - 1];
        let others = points.iter().filter(|p| (*p - from).norm() > same);
        let next = others.copied().reduce(|next, p| {
            let (a, b) = (next - from, p - from);
            let turn = a.x * b.y - a.y * b.x;
            let beyond = turn.abs() <= straight && b.norm() > a.norm();
            if turn < -straight || beyond { p } else { next }
        });
        match next {
            Some(next) if (next - start).norm() > same => corners.push(next),
            _ => break,
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [[f64; 3]; 4] = [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.]];

    #[test]
    fn facets_that_face_each_other_overlap() {
        let shifted = |dx: f64, dy: f64, dz: f64| {
            // Seen from above, so that its normal points down.
            [0, 3, 2, 1].map(|k: usize| [UNIT[k][0] + dx, UNIT[k][1] + dy, UNIT[k][2] + dz])
        };
        let found = overlap(&UNIT, &shifted(1.0, 0.5, 0.0)).unwrap();
        // Rounding of a few products.
        assert!((found.area - 1.5).abs() < 1e-12);
        assert!((found.frame[0] - Vector3::z()).norm() < 1e-15);
        assert!(
            overlap(&UNIT, &shifted(2.0, 0.0, 0.0)).is_none(),
            "an edge is no joint"
        );
        assert!(overlap(&UNIT, &shifted(0.0, 0.0, 0.1)).is_none(), "a gap");
        assert!(overlap(&UNIT, &UNIT).is_none(), "they look the same way");
    }

    #[test]
    fn a_hull_leaves_out_points_on_its_edges() {
        let points = [
            [0., 0.],
            [1., 0.],
            [2., 0.],
            [2., 1.],
            [1., 1.],
            [0., 1.],
            [0., 0.5],
        ];
        let hull = hull(points.map(|[x, y]| Vector2::new(x, y)).to_vec());
        assert_eq!(hull.len(), 4);
        assert_eq!(area(&hull), 2.0);
    }

    /// Rounding of points on one edge, in any order, loses no corner.
    #[test]
    fn a_hull_is_the_same_at_any_angle() {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for i in 0..4 {
            for j in 0..3 {
                // Corners of facets, each once for every facet.
                points.extend([[100.0 * f64::from(i), 50.0 * f64::from(j)]; 2]);
            }
        }
        for degrees in 0..180 {
            let (s, c) = f64::from(degrees).to_radians().sin_cos();
            for first in 0..points.len() {
                let turned = (0..points.len()).map(|k| {
                    let [x, y] = points[(first + 7 * k) % points.len()];
                    Vector2::new(c * x - s * y, s * x + c * y)
                });
                let hull = hull(turned.collect());
                assert_eq!(hull.len(), 4, "{degrees}");
                // Rounding of the rotation.
                assert!((area(&hull) - 3e4).abs() < 1e-9 * 3e4, "{degrees}");
            }
        }
    }
}
