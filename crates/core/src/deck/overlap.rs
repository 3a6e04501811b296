//! Bodies that overlap.
//!
//! Elements are treated as convex. Two of them are separate if their projections are separate along the normal of a
//! face of one of them, or along a vector normal to an edge of each (separating axes). Otherwise the least overlap
//! of the projections is the depth of their intersection.

use super::bodies::Bodies;
use super::schema::Deck;
use crate::element::hexahedron::{
    Corners, EDGES, Face, area_vector, cross, difference, dot, norm, range,
};
use crate::error::{ErrorKind, Errors, ModelError, Warning};
use crate::model::Mesh;
use wythe_contact::{Aabb, Bvh};

/// Depth over the shortest edge above which bodies overlap instead of touching.
const OVERLAPS: f64 = 1e-3;

/// Depth over the shortest edge above which an overlap is an error: contact would not separate the bodies.
const TOO_DEEP: f64 = 0.05;

/// Largest overlap of boxes of bodies that touch, caused by rounding [mm].
pub(super) const TOUCHING: f64 = 1e-6;

/// Largest number of pairs that are reported one by one, of warnings and of errors.
const MOST_TOLD: usize = 5;

/// An axis-parallel box. `[xyz][low, high]`
pub(super) type Box3 = [[f64; 2]; 3];

/// Bounding box of points [mm].
pub(super) fn around(points: impl Iterator<Item = [f64; 3]>) -> Box3 {
    points.fold([[f64::INFINITY, f64::NEG_INFINITY]; 3], |mut r, x| {
        for d in 0..3 {
            r[d] = [r[d][0].min(x[d]), r[d][1].max(x[d])];
        }
        r
    })
}

/// Bounding box of each body [mm]. `[body]`
pub(super) fn boxes(bodies: &Bodies<'_>) -> Vec<Box3> {
    let of = |nodes: std::ops::Range<u32>| nodes.map(|n| bodies.mesh.nodes[n as usize]);
    bodies
        .all
        .iter()
        .map(|body| around(of(body.nodes.clone())))
        .collect()
}

/// Largest mean number of neighbours of a body; more mean that bodies lie in one place.
const MOST_NEIGHBOURS: usize = 20;

/// Error: so many boxes overlap that pairs are not examined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Crowded {
    /// A body whose box overlaps very many others.
    pub(super) body: usize,
}

impl Crowded {
    /// Converts it to an error of the deck.
    pub(super) fn error(self, deck: &Deck, bodies: &Bodies<'_>) -> ModelError {
        let message = format!(
            "{} and very many other bodies are in one place",
            bodies.called(self.body)
        );
        let help = "two bodies cannot be in one place: see `at`, `pitch` and the unit of length";
        deck.error(&path_of(deck, bodies, self.body), message, help)
            .of_kind(ErrorKind::Geometry)
    }
}

/// Returns whether two boxes overlap by more than `least` along every axis; if `least` is negative, whether they
/// are closer than −`least`.
pub(super) fn beside(a: &Box3, b: &Box3, least: f64) -> bool {
    (0..3).all(|d| a[d][1].min(b[d][1]) - a[d][0].max(b[d][0]) > least)
}

/// A box enlarged by `margin` on all sides, in the form of the hierarchy.
pub(super) fn fat(own: &Box3, margin: f64) -> Aabb {
    let [low, high] = corners_of(own);
    Aabb {
        min: low,
        max: high,
    }
    .fattened(margin)
}

/// Pairs of boxes that are [`beside`] each other, in ascending order.
///
/// # Errors
/// Far more pairs than boxes.
pub(super) fn near(boxes: &[Box3], least: f64) -> Result<Vec<(usize, usize)>, Crowded> {
    let tight: Vec<Aabb> = boxes.iter().map(|own| fat(own, 0.0)).collect();
    let tree = Bvh::build(&tight);
    let most = MOST_NEIGHBOURS * boxes.len() + 1000;
    let (mut pairs, mut stack) = (Vec::new(), Vec::new());
    for (a, own) in boxes.iter().enumerate() {
        let query = fat(own, (-least).max(0.0));
        tree.query(&tight, &query, &mut stack, |b| {
            let b = b as usize;
            if b > a && beside(own, &boxes[b], least) {
                pairs.push((a, b));
            }
        });
        if pairs.len() > most {
            return Err(Crowded { body: a });
        }
    }
    pairs.sort_unstable();
    Ok(pairs)
}

/// Finds overlapping bodies: an error where the overlap is deep, else a warning.
///
/// # Errors
/// The first pairs, with names and positions.
pub(super) fn overlaps(deck: &Deck, bodies: &Bodies<'_>) -> Result<Vec<Warning>, ModelError> {
    let mesh = &bodies.mesh;
    let mut elements: Vec<Vec<usize>> = vec![Vec::new(); bodies.all.len()];
    for (e, unit) in mesh.unit.iter().enumerate() {
        elements[*unit as usize].push(e);
    }
    let (mut warnings, mut errors) = (Vec::new(), Errors::default());
    let mut told = [0; 2];
    let pairs = near(&boxes(bodies), TOUCHING).map_err(|crowded| crowded.error(deck, bodies))?;
    for (a, b) in pairs {
        let Some((depth, edge, at)) = deepest(mesh, &elements[a], &elements[b]) else {
            continue;
        };
        if depth <= TOUCHING.max(OVERLAPS * edge) {
            continue;
        }
        // Errors and warnings are counted separately, so that earlier shallow overlaps do not hide a deep one.
        let too_deep = depth > TOO_DEEP * edge;
        let told = &mut told[usize::from(too_deep)];
        if *told == MOST_TOLD {
            if too_deep {
                break; // enough errors are reported
            }
            continue;
        }
        *told += 1;
        let [x, y, z] = at;
        let message = format!(
            "{} and {} overlap by {depth:.3} mm near ({x:.1}, {y:.1}, {z:.1}) mm",
            bodies.called(a),
            bodies.called(b)
        );
        let path = path_of(deck, bodies, b);
        if too_deep {
            errors.push(
                deck.error(
                    &path,
                    message,
                    "two bodies cannot be in one place: move one, or make it smaller",
                )
                .of_kind(ErrorKind::Geometry),
            );
        } else {
            warnings.push(deck.warning(&path, message));
        }
    }
    errors.end(warnings)
}

/// Key that defines the position of a body.
fn path_of(deck: &Deck, bodies: &Bodies<'_>, body: usize) -> String {
    let table = table_of(deck, bodies, body);
    let index = table.strip_prefix("blocks.").and_then(|i| i.parse().ok());
    let block = index.and_then(|i: usize| deck.blocks.get(i));
    match block {
        Some(block) if block.corners.is_some() => format!("{table}.corners"),
        Some(block) if block.file.is_some() => format!("{table}.file"),
        _ if table == "arch" => table,
        _ => format!("{table}.at"),
    }
}

/// Table of the deck that defines a body.
pub(super) fn table_of(deck: &Deck, bodies: &Bodies<'_>, body: usize) -> String {
    if let Some(wall) = bodies.wall_of(body) {
        return wall.path.clone();
    }
    let name = &bodies.all[body].name;
    let is = |of: &str| {
        let rest = name.strip_prefix(of);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['-', '.']))
    };
    if let Some(i) = deck.blocks.iter().position(|block| is(&block.name)) {
        return format!("blocks.{i}");
    }
    match deck.imports.iter().position(|import| is(&import.name)) {
        Some(i) => format!("imports.{i}"),
        None => "arch".to_owned(),
    }
}

/// Largest depth between elements of two bodies, the shortest edge of these two elements, and the position [mm];
/// none if the bodies are separate.
fn deepest(mesh: &Mesh, a: &[usize], b: &[usize]) -> Option<(f64, f64, [f64; 3])> {
    let boxed = |of: &[usize]| -> Vec<(usize, Box3)> {
        of.iter()
            .map(|e| (*e, around(mesh.corners(*e).into_iter())))
            .collect()
    };
    let (a, b) = (boxed(a), boxed(b));
    // Only elements that reach into the box of the other body can intersect it.
    let of_all = |of: &[(usize, Box3)]| around(of.iter().flat_map(|(_, own)| corners_of(own)));
    let (of_a, of_b) = (of_all(&a), of_all(&b));
    let reaches = |own: &Box3, other: &Box3| common(own, other).is_some();
    let inner: Vec<&(usize, Box3)> = b.iter().filter(|(_, own)| reaches(own, &of_a)).collect();
    let boxes: Vec<Aabb> = inner.iter().map(|(_, own)| fat(own, 0.0)).collect();
    let tree = Bvh::build(&boxes);
    let (mut stack, mut met, mut tried) = (Vec::new(), Vec::new(), 0);
    let mut deepest: Option<(f64, f64, [f64; 3])> = None;
    for (e, own) in a.iter().filter(|(_, own)| reaches(own, &of_b)) {
        met.clear();
        tree.query(&boxes, &fat(own, 0.0), &mut stack, |i| met.push(i as usize));
        met.sort_unstable();
        let one = mesh.corners(*e);
        for &i in &met {
            let Some(common) = common(own, &inner[i].1) else {
                continue;
            };
            let other = mesh.corners(inner[i].0);
            tried += 1;
            let Some(depth) = depth(&one, &other) else {
                continue;
            };
            if deepest.is_none_or(|(most, ..)| depth > most) {
                let edge = shortest_edge(&one).min(shortest_edge(&other));
                deepest = Some((depth, edge, common.map(|[low, high]| 0.5 * (low + high))));
            }
        }
        let too_deep = deepest.is_some_and(|(depth, edge, _)| depth > TOO_DEEP * edge);
        if too_deep && tried > ENOUGH_TRIED {
            break;
        }
    }
    deepest
}

/// Number of pairs after which the search stops if the depth is already an error.
const ENOUGH_TRIED: usize = 10_000;

/// Intersection of two boxes, if it is larger than that of touching bodies.
fn common(a: &Box3, b: &Box3) -> Option<Box3> {
    let common = [0, 1, 2].map(|d| [a[d][0].max(b[d][0]), a[d][1].min(b[d][1])]);
    let part = |[low, high]: &[f64; 2]| high - low > TOUCHING;
    common.iter().all(part).then_some(common)
}

/// Lower and upper corner of a box [mm].
fn corners_of(own: &Box3) -> [[f64; 3]; 2] {
    [0, 1].map(|side| own.map(|r| r[side]))
}

fn edges(x: &Corners) -> impl Iterator<Item = [f64; 3]> + '_ {
    EDGES.iter().map(|[a, b]| difference(x[*b], x[*a]))
}

fn shortest_edge(x: &Corners) -> f64 {
    edges(x).map(norm).fold(f64::INFINITY, f64::min)
}

/// Least overlap of the projections of two hexahedra on any separating axis [mm]; none if an axis separates them.
fn depth(a: &Corners, b: &Corners) -> Option<f64> {
    let normals = |x: &Corners| Face::ALL.map(|(_, face)| area_vector(&face.outline(x)));
    let across = edges(a).flat_map(|u| edges(b).map(move |v| cross(u, v)));
    let axes = normals(a).into_iter().chain(normals(b)).chain(across);
    let scale = shortest_edge(a).min(shortest_edge(b));
    let mut least = f64::INFINITY;
    for axis in axes {
        let length = norm(axis);
        if length <= 1e-9 * scale * scale {
            continue; // parallel edges
        }
        let along = |x: &Corners| range(x.map(|x| dot(x, axis) / length));
        let (p, q) = (along(a), along(b));
        // The direction in which the shorter motion separates them.
        let common = (p[1] - q[0]).min(q[1] - p[0]);
        if common <= 0.0 {
            return None;
        }
        least = least.min(common);
    }
    Some(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(at: [f64; 3], turn: f64) -> Corners {
        let (sin, cos) = turn.sin_cos();
        let corner = |x: f64, y: f64, z: f64| {
            [
                at[0] + x * cos - y * sin,
                at[1] + x * sin + y * cos,
                at[2] + z,
            ]
        };
        [
            corner(0.0, 0.0, 0.0),
            corner(1.0, 0.0, 0.0),
            corner(1.0, 1.0, 0.0),
            corner(0.0, 1.0, 0.0),
            corner(0.0, 0.0, 1.0),
            corner(1.0, 0.0, 1.0),
            corner(1.0, 1.0, 1.0),
            corner(0.0, 1.0, 1.0),
        ]
    }

    #[test]
    fn depths_are_the_smallest_separating_distances() {
        let base = cube([0.0; 3], 0.0);
        assert_eq!(depth(&base, &cube([0.75, 0.5, 0.5], 0.0)), Some(0.25));
        assert_eq!(depth(&base, &cube([1.0, 0.0, 0.0], 0.0)), None);
        // A corner points at the face: half a diagonal from its middle.
        let turned = std::f64::consts::FRAC_PI_4;
        assert_eq!(depth(&base, &cube([1.8, 0.0, 0.0], turned)), None);
        let inside = depth(&base, &cube([1.6, 0.0, 0.0], turned)).unwrap();
        assert!(
            (inside - (1.0 - 1.6 + 0.5_f64.sqrt())).abs() < 1e-12,
            "{inside}"
        );
    }

    #[test]
    fn boxes_near_each_other_are_found_once() {
        let boxes = [[0.0, 1.0], [1.5, 2.0], [0.5, 1.6]].map(|x| [x, [0.0, 1.0], [0.0, 1.0]]);
        assert_eq!(near(&boxes, 0.0).unwrap(), [(0, 2), (1, 2)]);
        assert_eq!(near(&boxes, -0.6).unwrap(), [(0, 1), (0, 2), (1, 2)]);
    }

    #[test]
    fn very_many_coincident_boxes_are_reported_without_testing_each_pair() {
        // One by one, 5e9 pairs would take minutes.
        let boxes = vec![[[0.0, 1.0]; 3]; 100_000];
        assert!(near(&boxes, 0.0).is_err());
    }
}
