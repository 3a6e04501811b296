//! Touches of crossed edges.

use nalgebra::Vector3;
use rayon::prelude::*;
use wythe_contact::edges::{between, crossing, crossing_along, point_on};
use wythe_contact::{Entry, Place, entry};

use super::live::{Live, Start};
use super::{General, NEAR};
use crate::model::boundary_facets::SharpEdge;
use crate::state::{Kind, Touch};

/// Tolerance for the common normal of two edges outside the angle between the faces of each (sine).
const SLACK: f64 = 0.02;
/// Part at each end of an edge that is left to its corner, because a corner lies on a face where ends meet ends. A
/// corner counts as on a face up to twice this part beyond the rim ([`General::rims`]).
pub(super) const END: f64 = 4e-6;
/// A face whose normal has at least this cosine to the common normal of two edges is flat to the other edge.
const FLAT: f64 = 0.9;
/// Tolerance for the common normal of edges that already touch (sine).
const HOLD: f64 = 0.3;

/// Kinematics of two edges in an iterate.
struct Seen {
    at: [f64; 2],
    normal: Vector3<f64>,
    gap: f64,
}

impl General {
    pub(super) fn sharp(&self, edge: u32) -> SharpEdge {
        // Edges come from the boundary itself.
        match &self.of {
            Some(of) => of.skin.edges[edge as usize],
            None => SharpEdge {
                nodes: [0; 2],
                facets: [0; 2],
            },
        }
    }

    pub(super) fn ends(&self, edge: u32, x: &[[f64; 3]]) -> [[f64; 3]; 2] {
        self.sharp(edge).nodes.map(|n| x[n as usize])
    }

    /// Sum of the normals of an edge's faces: a direction out of its body.
    pub(super) fn outwards(&self, edge: u32, x: &[[f64; 3]]) -> Vector3<f64> {
        let [p, q] = self.sharp(edge).facets.map(|f| self.normal(f, x));
        p + q
    }

    /// Kinematics of two edges if their bodies lie on opposite sides of their common normal. None if other parts of
    /// the bodies are nearer.
    fn seen(&self, [a, b]: [u32; 2], x: &[[f64; 3]], slack: f64) -> Option<Seen> {
        let (one, other) = (self.ends(a, x), self.ends(b, x));
        let crossed = crossing(&one, &other)?;
        // Far beyond their ends other parts are nearer.
        if crossed.at.iter().any(|s| !(-1.0..=2.0).contains(s)) {
            return None;
        }
        let faces = |e: u32| self.sharp(e).facets.map(|f| self.normal(f, x));
        let (first, second) = (faces(a), faces(b));
        let normal = if crossed.normal.dot(&(second[0] + second[1])) < 0.0 {
            -crossed.normal
        } else {
            crossed.normal
        };
        if !between(&normal, &second, slack) || !between(&-normal, &first, slack) {
            return None;
        }
        let gap = normal.dot(&(point_on(&one, crossed.at[0]) - point_on(&other, crossed.at[1])));
        Some(Seen {
            at: crossed.at,
            normal,
            gap,
        })
    }

    /// Continues a touch of the last commit.
    pub(super) fn follow_edges(&self, touch: &Touch, x: &[[f64; 3]]) -> Option<Live> {
        let seen = self.seen([touch.first, touch.second], x, HOLD)?;
        let inside = seen.at.iter().all(|s| (-END..=1.0 + END).contains(s));
        inside.then(|| Live::followed(touch, touch.second, seen.at))
    }

    /// Edges that have crossed on the way from `x0` to `x` [mm] `[node]`, or nearly.
    pub(super) fn new_edges(
        &self,
        followed: &[Live],
        before: &[Live],
        x0: &[[f64; 3]],
        x: &[[f64; 3]],
    ) -> Vec<Live> {
        let mut on: Vec<[u32; 2]> = (followed.iter())
            .filter(|one| one.touch.kind == Kind::Edges)
            .map(|one| [one.touch.first, one.touch.second])
            .collect();
        on.sort_unstable();
        (self.nearby.edges.par_iter())
            .with_min_len(64)
            .filter(|pair| on.binary_search(pair).is_err())
            .filter_map(|&pair| self.crossed(pair, before, x0, x))
            .collect()
    }

    /// Touch of two edges that have crossed or are close to it.
    #[expect(
        clippy::too_many_lines,
        reason = "one decision over the place of a crossing"
    )]
    fn crossed(
        &self,
        [a, b]: [u32; 2],
        before: &[Live],
        x0: &[[f64; 3]],
        x: &[[f64; 3]],
    ) -> Option<Live> {
        let (one, other) = (self.ends(a, x), self.ends(b, x));
        let seen = self.seen([a, b], x, SLACK)?;
        let (first, second) = (self.sharp(a), self.sharp(b));
        let most = |facets: [u32; 2], n: &Vector3<f64>| {
            let [p, q] = facets.map(|f| self.normal(f, x).dot(n));
            if q > p + 1e-9 { facets[1] } else { facets[0] }
        };
        let facets = [
            most(first.facets, &-seen.normal),
            most(second.facets, &seen.normal),
        ];
        let sizes = first.facets.into_iter().chain(second.facets);
        let size = sizes
            .map(|f| self.faces.size[f as usize])
            .fold(f64::INFINITY, f64::min);
        if seen.gap > NEAR * size || self.is_planned_edge(&first, &second) {
            return None;
        }
        let bodies = facets.map(|f| self.body(f));
        let flush = self.flush(size, bodies);
        let length = |ends: &[[f64; 3]; 2]| (point_on(ends, 1.0) - point_on(ends, 0.0)).norm();
        // If the end of an edge reaches over a face of the other body by at most the flush depth, its corner lies
        // on that face.
        let rim = (flush / length(&one).min(length(&other))).min(0.1);
        let tips = [
            self.tip_is_over(seen.at[0], &one, &second, &seen.normal, x),
            self.tip_is_over(seen.at[1], &other, &first, &-seen.normal, x),
        ];
        let inset = |over: bool| if over { rim } else { END };
        let range = tips.map(|over| [inset(over), 1.0 - inset(over)]);
        let over = (0..2).all(|i| (range[i][0]..=range[i][1]).contains(&seen.at[i]));
        let side = self.faces.size[facets[0] as usize].min(self.faces.size[facets[1] as usize]);
        let (from_one, from_other) = (self.ends(a, x0), self.ends(b, x0));
        let from = Place {
            at: crossing_along(&from_one, &from_other, &seen.normal).unwrap_or(seen.at),
            gap: seen
                .normal
                .dot(&(point_on(&from_one, seen.at[0]) - point_on(&from_other, seen.at[1]))),
        };
        let key = (Kind::Edges, a, b);
        let make = |entry: Entry, claims: bool| Live {
            claims,
            ..Live::met(
                key,
                facets,
                seen.at,
                Start {
                    gap: from.gap,
                    entry,
                },
                0.25 * side * side,
            )
        };
        let idle = Entry {
            time: 1.0,
            at: seen.at,
            gap: 0.0,
        };
        let to = Place {
            at: seen.at,
            gap: seen.gap,
        };
        // Near the rim the depth of an edge is its protrusion times its slope.
        let entry = entry(&from, &to, &range, 3.0 * flush);
        let known = before.binary_search_by_key(&key, Live::key).ok();
        let lost = over
            && entry.is_none()
            && from.gap < 0.0
            && from.gap >= -crate::assembly::general::LOST * size;
        if let Some(known) = known.map(|k| &before[k]).filter(|k| k.claims)
            && (over || entry.is_some())
        {
            let mut same = make(idle, true);
            same.keep_start(known);
            return Some(same);
        }
        if seen.gap >= 0.0 {
            return over.then(|| make(idle, false));
        }
        let entry = entry.or_else(|| {
            // The edges overlapped when the increment began. They are held at this depth.
            lost.then_some(Entry {
                time: 0.0,
                at: from.at,
                gap: from.gap,
            })
        });
        entry.map(|entry| make(entry, true))
    }

    /// Whether the nearer end of an edge that crosses `other` lies over the face whose normal is closest to `n`.
    /// The face must be flat to the edge and lie on that side.
    fn tip_is_over(
        &self,
        s: f64,
        ends: &[[f64; 3]; 2],
        other: &SharpEdge,
        n: &Vector3<f64>,
        x: &[[f64; 3]],
    ) -> bool {
        let [p, q] = other.facets;
        let cosines = [p, q].map(|f| self.normal(f, x).dot(n));
        let (facet, cosine) = if cosines[1] > cosines[0] {
            (q, cosines[1])
        } else {
            (p, cosines[0])
        };
        if cosine < FLAT {
            return false;
        }
        let corners = self.faces.surface.corners(facet as usize, x);
        let centre = corners
            .iter()
            .map(|c| Vector3::from(*c))
            .sum::<Vector3<f64>>()
            * 0.25;
        let [b0, b1] = other.nodes.map(|n| Vector3::from(x[n as usize]));
        let along = (b1 - b0).normalize();
        let inwards = centre - b0;
        let inwards = inwards - along * along.dot(&inwards);
        let tip = point_on(ends, 1.0) - point_on(ends, 0.0);
        let tip = if s < 0.5 { -tip } else { tip };
        tip.dot(&inwards) > 0.0
    }

    /// Whether planned contact holds a face of one edge on the body of the other.
    fn is_planned_edge(&self, a: &SharpEdge, b: &SharpEdge) -> bool {
        let holds = |e: &SharpEdge, other: &SharpEdge| {
            let body = self.body(other.facets[0]);
            e.facets.iter().any(|&f| self.held.contains(&(f, body)))
        };
        holds(a, b) || holds(b, a)
    }
}
