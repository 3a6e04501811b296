//! Touches of corners and facets.

use nalgebra::Vector3;
use rayon::prelude::*;
use wythe_contact::{Entry, Place, entry, extend, surface};

use super::edges::END;
use super::live::{Live, Start};
use super::{General, LOST, NEAR, STAY};
use crate::state::{Kind, Touch};

/// A corner may reach a face if one of its own faces has a normal with at most this cosine to that of the face.
const FACING: f64 = -0.1;
/// Faces whose normals have at most this cosine lie flat when they meet.
const FLAT: f64 = -0.9;
/// A facet contributes to the area of a corner if its normal has at most this cosine to that of the face.
const LOADED: f64 = -0.7;

/// Largest depth of a corner over that of the planned points of its facet while these hold it. In a joint that is
/// pressed and bent about its middle the ratio is √3; the bound is nearly twice that.
const BESIDE: f64 = 3.0;

/// A corner that may reach a facet in this increment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    node: u32,
    facet: u32,
    /// Facet of the corner that faces the other facet, and the corner's position in it.
    slave: u32,
    corner: usize,
    /// Foot and gap when the increment begins.
    from: Place,
    /// Whether the corner is inside the body then, with this face as the nearest one.
    lost: bool,
}

impl General {
    /// Corners that may reach facets, starting in front of them at positions `x0` [mm] `[node]`.
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
            let foot = extend(
                &point,
                &self.faces.surface.corners(facet as usize, x0),
                [0.0; 2],
            )?;
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

    /// Whether a node at `point` lies inside the element behind a facet, no deeper than `most` [mm], and nearer to
    /// this facet than to the other boundary facets of the element that face the node's faces. The node cannot have
    /// come through the remaining ones. They may still be nearer where bodies are flush, or lie beyond the node by
    /// the amount that they bulge.
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
        // Facets of one element are consecutive.
        let first = (facet as usize).saturating_sub(5);
        let last = (facet as usize + 6).min(of.skin.facets.len());
        (first..last)
            .filter(|&f| of.skin.element[f] == element)
            .all(|f| {
                let corners = self.faces.surface.corners(f, x);
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

    /// Facet at a node whose normal has the smallest cosine to `n`, and that cosine.
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
        (self.faces.surface.facets[facet as usize].iter()).position(|&n| n == node)
    }

    pub(super) fn corner_point(&self, facet: u32, corner: usize, x: &[[f64; 3]]) -> Vector3<f64> {
        let corners = self.faces.surface.corners(facet as usize, x);
        let weights = &self.weights[corner];
        (0..4).fold(Vector3::zeros(), |sum, a| {
            sum + Vector3::from(corners[a]) * weights[a]
        })
    }

    fn pair_size(&self, node: u32, facet: u32) -> f64 {
        self.faces.node_size[node as usize].min(self.faces.size[facet as usize])
    }

    fn watched_of(&self, node: u32) -> &[Watch] {
        let from = self.watch.partition_point(|w| w.node < node);
        let to = from + self.watch[from..].partition_point(|w| w.node == node);
        &self.watch[from..to]
    }

    /// Continues a touch of the last commit: on its facet, or on the next facet of the same face.
    pub(super) fn follow_corner(&self, touch: &Touch, x: &[[f64; 3]]) -> Option<Live> {
        let [slave, facet] = touch.facets;
        let corner = self.corner_of(slave, touch.first)?;
        let point = self.corner_point(slave, corner, x);
        let foot_on = |f: u32, guess| {
            let foot = extend(&point, &self.faces.surface.corners(f as usize, x), guess)?;
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

    /// Corners that have reached facets on the way from `x0` to `x` [mm] `[node]`, or are close to them.
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

    /// Touches that one node has begun. `on`: pairs (node, facet) of its touches that continue.
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
        // If a corner has passed several faces of one body, only the shallowest touch counts, unless the faces form
        // an inner corner.
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

    /// Whether two facets of one body face each other. At such an inner corner both act.
    fn is_inner(&self, a: u32, b: u32, x: &[[f64; 3]]) -> bool {
        let centre = |f: u32| {
            let corners = self.faces.surface.corners(f as usize, x);
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

    /// Depth and touch of a corner that has reached a facet or is close to it.
    #[expect(
        clippy::too_many_lines,
        reason = "one decision over the place of a corner"
    )]
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
        let master = self.faces.surface.corners(facet as usize, x);
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
        // A touch found in an earlier iterate remains, so that iterates do not lose it at a rim. Its slip counts
        // from where it met the face in that iterate. The converged path ends where the gap closes.
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
            // The corner was inside the body when the increment began. It is held at this depth.
            (lost && over).then_some(Entry {
                time: 0.0,
                at: from.at,
                gap: from.gap,
            })
        });
        entry.map(|entry| (-foot.gap, make(entry, true)))
    }

    /// Range of the parameters of a facet with corners `master`, seen at `at`, in which a node lies on it.
    ///
    /// Touches of crossed edges leave the end of an edge to its corner. Where an edge leads from the node back over
    /// a rim, the range is extended by twice this end. Otherwise a corner that protrudes by less than this end
    /// would be held by neither.
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
            let nodes = self.faces.surface.facets[f as usize];
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

    /// Whether planned contact holds a corner on the body of a facet, or the facet on the corner's body. The corner
    /// was `depth` [mm] behind the facet when the increment began. Gauss points lie inwards of the corner, so a
    /// rotation about them moves the corner deeper than the points.
    fn is_planned(&self, node: u32, slave: u32, facet: u32, depth: f64) -> bool {
        let held = self.held_nodes.get(&(node, self.body(facet)));
        let flush = crate::assembly::general::FLUSH * self.pair_size(node, facet);
        held.is_some_and(|planned| depth <= flush + BESIDE * planned)
            || self.held.contains(&(facet, self.body(slave)))
    }

    /// Contact area of a corner: that of the facets which it loads, at most that of the face. It is halved where
    /// the face has corners on the slave facet as well, so that both together are as stiff as one joint
    /// (theory/contact.md, eq. 16).
    fn corner_area(&self, node: u32, slave: u32, facet: u32, x: &[[f64; 3]]) -> f64 {
        let normal = self.normal(facet, x);
        let area = |f: u32| {
            let [a, b, c, d] = self.faces.surface.corners(f as usize, x).map(Vector3::from);
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
        let corners = self.faces.surface.corners(slave as usize, x);
        let within = 1.0 + 20.0 * STAY;
        let both = self.faces.surface.facets[facet as usize].iter().any(|&n| {
            let foot = extend(&Vector3::from(x[n as usize]), &corners, [0.0; 2]);
            foot.is_some_and(|foot| foot.xi[0].abs() <= within && foot.xi[1].abs() <= within)
        });
        if both { 0.5 * whole } else { whole }
    }
}
