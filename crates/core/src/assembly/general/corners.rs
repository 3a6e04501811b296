//! Corners on facets.

use nalgebra::Vector3;
use rayon::prelude::*;
use wythe_contact::{Entry, Place, entry, extend, surface};

use super::edges::END;
use super::live::{Live, Start};
use super::{General, LOST, NEAR, STAY};
use crate::state::{Kind, Touch};

/// A face is come upon by a corner of which a face looks at it by this much (cosine).
const FACING: f64 = -0.1;
/// Faces that look at each other by this much lie flat when they meet (cosine).
const FLAT: f64 = -0.9;
/// A facet takes its part of a corner's load if it looks at the face by this much (cosine).
const LOADED: f64 = -0.7;

/// How much deeper than a planned point of its facet a corner is at most while that point holds it: √3 in a joint
/// that is pressed and bent about its middle, and as much again.
const BESIDE: f64 = 3.0;

/// A corner that may come onto a facet in this increment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    node: u32,
    facet: u32,
    /// Facet of the corner that looks at the other, and the corner's place in it.
    slave: u32,
    corner: usize,
    /// Where it is when the increment begins.
    from: Place,
    /// Whether it is within the body then, nearest to this face.
    lost: bool,
}

impl General {
    /// Corners that may come onto facets, from positions `x0` [mm] `[node]`: those in front of them.
    pub(super) fn watch(&self, x0: &[[f64; 3]]) -> Vec<Watch> {
        let near = self.nearby.corners.par_iter();
        near.filter_map(|&[node, facet]| {
            let normal = self.normal(facet, x0);
            let (slave, cosine) = self.opposite(node, &normal, x0);
            if cosine > FACING {
                return None;
            }
            let corner = self.corner_of(slave, node)?;
            let point = self.corner_point(slave, corner, x0);
            let foot = extend(&point, &self.surface.corners(facet as usize, x0), [0.0; 2])?;
            let bodies = [self.body(slave), self.body(facet)];
            let size = self.pair_size(node, facet);
            let lost = foot.gap < -self.flush(size, bodies);
            if lost && !self.is_lost((node, &point), facet, foot.gap, LOST * size, x0) {
                return None;
            }
            Some(Watch {
                lost,
                node,
                facet,
                slave,
                corner,
                from: Place {
                    at: foot.xi,
                    gap: foot.gap,
                },
            })
        })
        .collect()
    }

    /// Whether a node, at `point`, lies in the element behind a facet, nearer to it than to all other faces of its skin
    /// that the node's faces look at, and no deeper than `most` [mm]. Through others it cannot have come: where bodies
    /// are flush those are the nearest, or it is outside by what they bulge.
    fn is_lost(
        &self,
        (node, point): (u32, &Vector3<f64>),
        facet: u32,
        gap: f64,
        most: f64,
        x: &[[f64; 3]],
    ) -> bool {
        let Some(of) = &self.of else { return false };
        if gap < -most {
            return false;
        }
        let element = of.skin.element[facet as usize];
        // Facets of one element stand together.
        let first = (facet as usize).saturating_sub(5);
        let last = (facet as usize + 6).min(of.skin.facets.len());
        (first..last)
            .filter(|&f| of.skin.element[f] == element)
            .all(|f| {
                let corners = self.surface.corners(f, x);
                let centre = corners
                    .iter()
                    .map(|c| Vector3::from(*c))
                    .sum::<Vector3<f64>>()
                    * 0.25;
                let depth = self.normal(f as u32, x).dot(&(point - centre));
                f == facet as usize
                    || depth <= gap
                    || self.opposite(node, &self.normal(f as u32, x), x).1 > FACING
            })
    }

    /// The facet at a node that looks most against a direction, and the cosine.
    fn opposite(&self, node: u32, n: &Vector3<f64>, x: &[[f64; 3]]) -> (u32, f64) {
        let mut best = (u32::MAX, f64::INFINITY);
        for &f in self.facets_at(node) {
            let cosine = self.normal(f, x).dot(n);
            if cosine < best.1 - 1e-9 {
                best = (f, cosine);
            }
        }
        best
    }

    fn corner_of(&self, facet: u32, node: u32) -> Option<usize> {
        (self.surface.facets[facet as usize].iter()).position(|&n| n == node)
    }

    pub(super) fn corner_point(&self, facet: u32, corner: usize, x: &[[f64; 3]]) -> Vector3<f64> {
        let corners = self.surface.corners(facet as usize, x);
        let weights = &self.weights[corner];
        (0..4).fold(Vector3::zeros(), |sum, a| {
            sum + Vector3::from(corners[a]) * weights[a]
        })
    }

    fn pair_size(&self, node: u32, facet: u32) -> f64 {
        self.node_size[node as usize].min(self.size[facet as usize])
    }

    fn watched_of(&self, node: u32) -> &[Watch] {
        let from = self.watch.partition_point(|w| w.node < node);
        let to = from + self.watch[from..].partition_point(|w| w.node == node);
        &self.watch[from..to]
    }

    /// A touch of the last commit where it is now: on its facet, or on the next of the same face.
    pub(super) fn follow_corner(&self, touch: &Touch, x: &[[f64; 3]]) -> Option<Live> {
        let [slave, facet] = touch.facets;
        let corner = self.corner_of(slave, touch.first)?;
        let point = self.corner_point(slave, corner, x);
        let foot_on = |f: u32, guess| {
            let foot = extend(&point, &self.surface.corners(f as usize, x), guess)?;
            let most = 1.0 + STAY;
            (foot.xi[0].abs() <= most && foot.xi[1].abs() <= most).then_some(foot)
        };
        if let Some(foot) = foot_on(facet, touch.at) {
            return Some(Live::followed(touch, facet, foot.xi));
        }
        let normal = self.normal(facet, x);
        let mut best: Option<(f64, u32, [f64; 2])> = None;
        for watch in self.watched_of(touch.first) {
            let f = watch.facet;
            let same = self.body(f) == self.body(facet) && f != facet;
            if !same || self.normal(f, x).dot(&normal) < 0.5 {
                continue;
            }
            if let Some(foot) = foot_on(f, [0.0; 2]) {
                let far = foot.gap.abs();
                if best.is_none_or(|(d, _, _)| far < d) {
                    best = Some((far, f, foot.xi));
                }
            }
        }
        best.map(|(_, f, xi)| Live::followed(touch, f, xi))
    }

    /// Corners that have come onto facets on the way from `x0` to `x` [mm] `[node]`, or are near them.
    pub(super) fn new_corners(
        &self,
        followed: &[Live],
        before: &[Live],
        x0: &[[f64; 3]],
        x: &[[f64; 3]],
    ) -> Vec<Live> {
        let mut on: Vec<(u32, u32)> = (followed.iter())
            .filter(|one| one.touch.kind == Kind::Corner)
            .map(|one| (one.touch.first, one.touch.second))
            .collect();
        on.sort_unstable();
        let groups: Vec<&[Watch]> = self.watch.chunk_by(|a, b| a.node == b.node).collect();
        (groups.par_iter())
            .with_min_len(16)
            .flat_map_iter(|group| {
                let node = group[0].node;
                let from = on.partition_point(|o| o.0 < node);
                let to = from + on[from..].partition_point(|o| o.0 == node);
                self.of_node(group, &on[from..to], before, x0, x)
            })
            .collect()
    }

    /// What one node has come onto. `on`: what it is on already.
    fn of_node(
        &self,
        group: &[Watch],
        on: &[(u32, u32)],
        before: &[Live],
        x0: &[[f64; 3]],
        x: &[[f64; 3]],
    ) -> Vec<Live> {
        let mut found: Vec<(f64, Live)> = Vec::new();
        for watch in group {
            let taken = |f: u32| self.body(f) == self.body(watch.facet);
            let rivals = on.iter().filter(|o| taken(o.1));
            let free = |o: &(u32, u32)| self.is_inner(o.1, watch.facet, x);
            if !rivals.into_iter().all(free) {
                continue;
            }
            if let Some(one) = self.met(watch, before, x0, x) {
                found.push(one);
            }
        }
        // Of the faces of one body that a corner has come through the least deep one counts, unless they
        // form an inner corner.
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut kept: Vec<Live> = Vec::new();
        for (depth, one) in found {
            let facet = one.touch.second;
            let rival = |other: &Live| {
                let of = other.touch.second;
                other.claims && self.body(of) == self.body(facet) && !self.is_inner(of, facet, x)
            };
            if depth == 0.0 || !kept.iter().any(rival) {
                kept.push(one);
            }
        }
        kept
    }

    /// Whether two facets of one body look at each other: an inner corner, whose sides both hold.
    fn is_inner(&self, a: u32, b: u32, x: &[[f64; 3]]) -> bool {
        let centre = |f: u32| {
            let corners = self.surface.corners(f as usize, x);
            corners
                .iter()
                .map(|c| Vector3::from(*c))
                .sum::<Vector3<f64>>()
                * 0.25
        };
        let way = centre(b) - centre(a);
        let least = crate::assembly::general::FLUSH * way.norm();
        self.normal(a, x).dot(&way) > least && self.normal(b, x).dot(&way) < -least
    }

    /// Whether a corner has come onto a facet, with its depth.
    fn met(
        &self,
        watch: &Watch,
        before: &[Live],
        x0: &[[f64; 3]],
        x: &[[f64; 3]],
    ) -> Option<(f64, Live)> {
        let Watch {
            node,
            facet,
            slave,
            corner,
            from,
            lost,
        } = *watch;
        let size = self.pair_size(node, facet);
        let master = self.surface.corners(facet as usize, x);
        let foot = extend(&self.corner_point(slave, corner, x), &master, from.at)?;
        if foot.gap > NEAR * size || self.is_planned(node, slave, facet, -from.gap) {
            return None;
        }
        let over = foot.xi[0].abs() <= 1.0 + STAY && foot.xi[1].abs() <= 1.0 + STAY;
        let key = (Kind::Corner, node, facet);
        let make = |entry: Entry, claims: bool| Live {
            claims,
            ..Live::met(
                key,
                [slave, facet],
                foot.xi,
                Start {
                    gap: from.gap,
                    entry,
                },
                self.corner_area(node, slave, facet, x0),
            )
        };
        let idle = Entry {
            time: 1.0,
            at: foot.xi,
            gap: 0.0,
        };
        let to = Place {
            at: foot.xi,
            gap: foot.gap,
        };
        let flush = self.flush(size, [self.body(slave), self.body(facet)]);
        let entry = entry(&from, &to, &[[-1.0, 1.0]; 2], flush).or_else(|| {
            let may = foot.gap < 0.0 && from.gap >= -flush;
            may.then(|| entry(&from, &to, &self.rims(node, &master, foot.xi, x), flush))?
        });
        // What was found in an earlier iterate stays, so that iterates do not lose it on a rim, and slips
        // from where it met the face then: the converged way ends where the gap closes.
        let known = before.binary_search_by_key(&key, Live::key).ok();
        if let Some(known) = known.map(|k| &before[k]).filter(|k| k.claims)
            && (over || entry.is_some())
        {
            let mut same = make(idle, true);
            same.keep_start(known);
            return Some(((-foot.gap).max(0.0), same));
        }
        if foot.gap >= 0.0 {
            return over.then(|| (0.0, make(idle, false)));
        }
        let entry = entry.or_else(|| {
            // It was within the body when the increment began: it goes no further.
            (lost && over).then_some(Entry {
                time: 0.0,
                at: from.at,
                gap: from.gap,
            })
        });
        entry.map(|entry| (-foot.gap, make(entry, true)))
    }

    /// Range of the parameters of a facet with corners `master`, seen at `at`, in which a node is on it. Where an edge
    /// leads from the node back over a rim, the end that crossed edges leave to the corner is on the facet, and as
    /// much again: otherwise what reaches beyond the rim by less than that end is held by neither.
    fn rims(
        &self,
        node: u32,
        master: &[[f64; 3]; 4],
        at: [f64; 2],
        x: &[[f64; 3]],
    ) -> [[f64; 2]; 2] {
        let mut range = [[-1.0, 1.0]; 2];
        let [s, t] = at;
        let place = |s: f64, t: f64| surface::point_at(master, [s, t]);
        let by_s = 0.5 * (place(s + 1.0, t) - place(s - 1.0, t));
        let by_t = 0.5 * (place(s, t + 1.0) - place(s, t - 1.0));
        let (g11, g12, g22) = (by_s.dot(&by_s), by_s.dot(&by_t), by_t.dot(&by_t));
        let det = g11 * g22 - g12 * g12;
        if det <= 0.0 {
            return range;
        }
        for &f in self.facets_at(node) {
            let nodes = self.surface.facets[f as usize];
            let Some(k) = self.corner_of(f, node) else {
                continue;
            };
            for other in [nodes[(k + 1) % 4], nodes[(k + 3) % 4]] {
                let [from, to] = [node, other].map(|n| Vector3::from(x[n as usize]));
                let (b1, b2) = ((to - from).dot(&by_s), (to - from).dot(&by_t));
                let way = [(g22 * b1 - g12 * b2) / det, (g11 * b2 - g12 * b1) / det];
                for (range, way) in range.iter_mut().zip(way) {
                    let end = (2.0 * END * way.abs()).min(STAY);
                    if way < 0.0 {
                        range[1] = range[1].max(1.0 + end);
                    } else {
                        range[0] = range[0].min(-1.0 - end);
                    }
                }
            }
        }
        range
    }

    /// Whether planned contact holds a corner, `depth` [mm] behind a facet when the increment began, on the body of
    /// that facet, or the facet on the corner's body. Gauss points lie inwards of the corner: what turns about them has
    /// it go deeper than they are.
    fn is_planned(&self, node: u32, slave: u32, facet: u32, depth: f64) -> bool {
        let held = self.held_nodes.get(&(node, self.body(facet)));
        let flush = crate::assembly::general::FLUSH * self.pair_size(node, facet);
        held.is_some_and(|planned| depth <= flush + BESIDE * planned)
            || self.held.contains(&(facet, self.body(slave)))
    }

    /// Area of the facets at a corner that load it, no more than that of the face; half of it where the face
    /// has corners on them as well, so that together they are one joint.
    fn corner_area(&self, node: u32, slave: u32, facet: u32, x: &[[f64; 3]]) -> f64 {
        let normal = self.normal(facet, x);
        let area = |f: u32| {
            let [a, b, c, d] = self.surface.corners(f as usize, x).map(Vector3::from);
            0.5 * (c - a).cross(&(d - b)).norm()
        };
        let loaded: f64 = (self.facets_at(node).iter())
            .filter(|&&f| f == slave || self.normal(f, x).dot(&normal) < LOADED)
            .map(|&f| 0.25 * area(f))
            .sum();
        let whole = loaded.min(area(facet));
        if self.normal(slave, x).dot(&normal) > FLAT {
            return whole;
        }
        let corners = self.surface.corners(slave as usize, x);
        let within = 1.0 + 20.0 * STAY;
        let both = self.surface.facets[facet as usize].iter().any(|&n| {
            let foot = extend(&Vector3::from(x[n as usize]), &corners, [0.0; 2]);
            foot.is_some_and(|foot| foot.xi[0].abs() <= within && foot.xi[1].abs() <= within)
        });
        if both { 0.5 * whole } else { whole }
    }
}
