//! Points of ties in the elements that hold them.

use super::TiePoint;
use crate::element::hex8::FACES;
use crate::element::hexahedron::{area_vector, difference, dot, mean, norm, range};
use crate::element::inside;
use crate::model::Mesh;

/// Distance outside a body within which a point counts as on its face [mm]: coordinates in decks are rounded to 0.01 mm.
const BESIDE: f64 = 0.01;

/// Why points of a tie cannot be tied to a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TieFault {
    /// A point that no solid holds.
    #[error("the point ({:.6}, {:.6}, {:.6}) lies in no solid", .at[0], .at[1], .at[2])]
    Outside {
        /// The point [mm].
        at: [f64; 3],
    },
    /// Two points at one place.
    #[error("two points of the tie lie at ({:.6}, {:.6}, {:.6}): it has no length", .at[0], .at[1], .at[2])]
    NoLength {
        /// The point [mm].
        at: [f64; 3],
    },
    /// All points in one element.
    #[error("the whole tie lies within one element of {body}, and ties nothing together")]
    OneElement {
        /// Name of the body.
        body: String,
    },
    /// A bonded tie that lies in the common face of two bodies.
    #[error("from ({:.4}, {:.4}, {:.4}) on the tie lies in {first} and in {second} at once", .at[0], .at[1], .at[2])]
    InJoint {
        /// Where this begins [mm].
        at: [f64; 3],
        /// Names of the bodies.
        first: String,
        /// The other.
        second: String,
    },
}

/// Settings of a bonded tie.
pub struct Bonded<'a> {
    /// Length over which the tie is free at each joint, half of it on either side [mm].
    pub unbonded: f64,
    /// Bodies to which it may be bound, by number; none: all.
    pub only: Option<&'a dyn Fn(u32) -> bool>,
}

/// Points of a tie that is held at its two ends only.
///
/// # Errors
/// [`TieFault`]: points outside, no length, both ends in one element.
pub fn anchored(mesh: &Mesh, ends: [[f64; 3]; 2]) -> Result<Vec<TiePoint>, TieFault> {
    if norm(difference(ends[1], ends[0])) <= BESIDE {
        return Err(TieFault::NoLength { at: ends[0] });
    }
    let all = || 0..mesh.elements.len();
    let points = ends.map(|end| held(mesh, all(), end));
    let [Some(first), Some(second)] = points else {
        let at = ends[usize::from(points[0].is_some())];
        return Err(TieFault::Outside { at });
    };
    apart(mesh, vec![first, second])
}

/// Points of a tie along a line of points that is bound to all bodies which it crosses.
///
/// # Errors
/// [`TieFault`]: ends outside, no length, all in one element, a line in the common face of two bodies.
pub fn bonded(mesh: &Mesh, line: &[[f64; 3]], of: &Bonded<'_>) -> Result<Vec<TiePoint>, TieFault> {
    let mut start = 0.0;
    let mut chords = Vec::new();
    for (leg, ends) in line.windows(2).enumerate() {
        let length = norm(difference(ends[1], ends[0]));
        if length <= BESIDE {
            return Err(TieFault::NoLength { at: ends[0] });
        }
        for e in 0..mesh.elements.len() {
            if of.only.is_some_and(|only| !only(mesh.unit[e])) {
                continue;
            }
            if let Some([a, b]) = chord(&mesh.corners(e), [ends[0], ends[1]], length) {
                chords.push(Chord {
                    unit: mesh.unit[e],
                    element: e,
                    leg,
                    from: start + a,
                    to: start + b,
                });
            }
        }
        start += length;
    }
    let line = Line { points: line };
    let spans = spans(mesh, &line, chords)?;
    for (end, s) in [(0, 0.0), (line.points.len() - 1, start)] {
        let holds = |span: &Span| span.from <= s + BESIDE && s <= span.to + BESIDE;
        if !spans.iter().any(holds) {
            return Err(TieFault::Outside {
                at: line.points[end],
            });
        }
    }
    let mut points = Vec::new();
    for (i, span) in spans.iter().enumerate() {
        let is_end = [i == 0, i + 1 == spans.len()];
        for s in stations(span, is_end, of.unbonded) {
            let at = line.at(s);
            let near = span.chords.iter().filter(|c| c.holds(s)).map(|c| c.element);
            let held = held(mesh, near, at).ok_or(TieFault::Outside { at })?;
            points.push(held);
        }
    }
    apart(mesh, points)
}

/// The points, if they do not all lie in one element.
fn apart(mesh: &Mesh, points: Vec<TiePoint>) -> Result<Vec<TiePoint>, TieFault> {
    let first = points.first().map(|point| point.element);
    if points.iter().all(|point| Some(point.element) == first) {
        let body = first.map_or_else(String::new, |e| mesh.body_of(e as usize));
        return Err(TieFault::OneElement { body });
    }
    Ok(points)
}

/// The point in the element, of these, in which it lies deepest; the first of several.
fn held(mesh: &Mesh, elements: impl Iterator<Item = usize>, at: [f64; 3]) -> Option<TiePoint> {
    let mut best: Option<(f64, usize, [f64; 3])> = None;
    for e in elements {
        let corners = mesh.corners(e);
        let mut smallest = f64::INFINITY;
        let near = (0..3).all(|d| {
            let [low, high] = range(corners.map(|x| x[d]));
            smallest = smallest.min(high - low);
            low - BESIDE <= at[d] && at[d] <= high + BESIDE
        });
        if !near {
            continue;
        }
        let Some(xi) = inside::natural(&corners, at) else {
            continue;
        };
        let depth = xi.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        // ξ has 2 over the size of the element.
        let deeper = best.is_none_or(|(found, ..)| depth < found - 1e-9);
        if depth <= 1.0 + 2.0 * BESIDE / smallest && deeper {
            best = Some((depth, e, xi));
        }
    }
    let (_, element, xi) = best?;
    let weights = inside::weights(xi);
    let nodes = mesh.elements[element].into_iter().zip(weights);
    Some(TiePoint {
        at,
        element: element as u32,
        // Weights of nodes off a face on which the point lies are roundings.
        nodes: nodes.filter(|(_, n)| n.abs() > 1e-9).collect(),
    })
}

/// A part of the line in one element, by the length along the line [mm].
struct Chord {
    unit: u32,
    element: usize,
    leg: usize,
    from: f64,
    to: f64,
}

impl Chord {
    fn holds(&self, s: f64) -> bool {
        self.from - BESIDE <= s && s <= self.to + BESIDE
    }
}

/// A part of the line in one body.
struct Span {
    unit: u32,
    from: f64,
    to: f64,
    chords: Vec<Chord>,
}

struct Line<'a> {
    points: &'a [[f64; 3]],
}

impl Line<'_> {
    /// Point at a length along the line [mm].
    fn at(&self, s: f64) -> [f64; 3] {
        let mut rest = s;
        let legs = self.points.len().saturating_sub(1);
        for (leg, ends) in self.points.windows(2).enumerate() {
            let way = difference(ends[1], ends[0]);
            let length = norm(way);
            if rest <= length || leg + 1 == legs {
                return [0, 1, 2].map(|d| ends[0][d] + rest / length * way[d]);
            }
            rest -= length;
        }
        self.points[0]
    }
}

/// Parts of the line in the bodies, in order.
fn spans(mesh: &Mesh, line: &Line<'_>, mut chords: Vec<Chord>) -> Result<Vec<Span>, TieFault> {
    chords.sort_by(|a, b| {
        (a.unit, a.leg)
            .cmp(&(b.unit, b.leg))
            .then(a.from.total_cmp(&b.from))
    });
    let mut spans: Vec<Span> = Vec::new();
    for chord in chords {
        match spans.last_mut() {
            Some(last) if last.unit == chord.unit && chord.from <= last.to + BESIDE => {
                last.to = last.to.max(chord.to);
                last.chords.push(chord);
            }
            _ => spans.push(Span {
                unit: chord.unit,
                from: chord.from,
                to: chord.to,
                chords: vec![chord],
            }),
        }
    }
    spans.sort_by(|a, b| a.from.total_cmp(&b.from));
    for pair in spans.windows(2) {
        if pair[1].from < pair[0].to.min(pair[1].to) - 2.0 * BESIDE {
            return Err(TieFault::InJoint {
                at: line.at(pair[1].from),
                first: mesh.called(pair[0].unit),
                second: mesh.called(pair[1].unit),
            });
        }
    }
    Ok(spans)
}

/// Points at which the tie is bound to a body: about one for each element, from half the unbonded length behind a
/// joint to half of it before the next one; one in the middle of a body that is shorter than that. `is_end`: whether
/// the tie begins or ends in this body.
fn stations(span: &Span, is_end: [bool; 2], unbonded: f64) -> Vec<f64> {
    let from = span.from + if is_end[0] { 0.0 } else { 0.5 * unbonded };
    let to = span.to - if is_end[1] { 0.0 } else { 0.5 * unbonded };
    if to - from <= BESIDE {
        return vec![match is_end {
            [true, false] => span.from,
            [false, true] => span.to,
            _ => 0.5 * (span.from + span.to),
        }];
    }
    let longest = span
        .chords
        .iter()
        .map(|c| c.to - c.from)
        .fold(0.0, f64::max);
    let parts = ((to - from) / longest.max(BESIDE)).ceil().max(1.0) as usize;
    (0..=parts)
        .map(|i| from + (to - from) * i as f64 / parts as f64)
        .collect()
}

/// Part of a straight leg in an element, by the length from its start [mm]. Faces count as planes; none where the leg
/// does not pass through the element or its faces.
fn chord(corners: &[[f64; 3]; 8], ends: [[f64; 3]; 2], length: f64) -> Option<[f64; 2]> {
    let near = (0..3).all(|d| {
        let [low, high] = range(corners.map(|x| x[d]));
        let [from, to] = range(ends.map(|x| x[d]));
        low - BESIDE <= to && from <= high + BESIDE
    });
    if !near {
        return None;
    }
    let way = difference(ends[1], ends[0]).map(|x| x / length);
    let [mut from, mut to] = [0.0_f64, length];
    for face in FACES {
        let face = face.map(|n| corners[n]);
        let area = area_vector(&face);
        let normal = area.map(|x| x / norm(area));
        let outside = dot(normal, difference(ends[0], mean(&face)));
        let speed = dot(normal, way);
        if speed.abs() < 1e-12 {
            if outside > BESIDE {
                return None;
            }
            continue;
        }
        let at = -outside / speed;
        if speed > 0.0 {
            to = to.min(at);
        } else {
            from = from.max(at);
        }
    }
    (to - from > BESIDE).then_some([from, to])
}
