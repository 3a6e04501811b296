//! Pairing of each contact point with a master facet.

use nalgebra::Vector3;
use rayon::prelude::*;
use wythe_contact::pairs::stays_on;
use wythe_contact::surface::blend;
use wythe_contact::{JointLaw, PointPair, Reach, extend, pair_point};

use super::{Contact, Distances, ROUNDING, TOUCHES};
use crate::assembly::Trial;
use crate::model::Model;

/// Positions of a search [mm]. `[node]`
#[derive(Clone, Copy)]
struct Places<'a> {
    /// The present ones.
    x: &'a [[f64; 3]],
    /// Those at the start of the increment; empty at the first search.
    x_start: &'a [[f64; 3]],
    /// Whether forces were evaluated at the present ones.
    seen: bool,
}

impl Contact {
    /// Renews the candidates if surfaces have moved beyond the margin, then pairs every point.
    pub fn search(&mut self, trial: &mut Trial) {
        let x = &trial.x;
        // At the positions of the last force evaluation, feet and gaps of points that stay on their facets are
        // known.
        let seen = trial.joints.seen_at == *x;
        if self.has_moved(x) {
            let deep = self.depth_to_search(&trial.joints.pairs, &trial.joints.free, x);
            self.search_from(x, deep);
        }
        trial.joints.forget_unless(seen, self.points.len());
        let (free, x_start) = (&trial.joints.free, &trial.x_start);
        let places = Places { x, x_start, seen };
        trial
            .joints
            .pairs
            .par_chunks_mut(4)
            .zip(trial.joints.anchors.par_chunks_mut(4))
            .zip(trial.joints.gaps.par_chunks_exact(4))
            .enumerate()
            .with_min_len(16)
            .for_each(|(f, ((pairs, anchors), gaps))| {
                for (p, (pair, anchor)) in pairs.iter_mut().zip(anchors).enumerate() {
                    let at = 4 * f + p;
                    if self.is_image(at) {
                        (*pair, *anchor) = <_>::default();
                        continue;
                    }
                    *pair = self.renewed(at, [*pair, *anchor], gaps[p], free[at], places);
                    if anchor.facet.is_none() {
                        *anchor = *pair;
                    }
                }
            });
    }

    /// The pair of point `at`, from its last pair and its anchor, with its gap at the last evaluation [mm].
    fn renewed(
        &self,
        at: usize,
        [pair, anchor]: [PointPair; 2],
        gap: f64,
        is_free: bool,
        Places { x, x_start, seen }: Places<'_>,
    ) -> PointPair {
        let (f, p) = (at / 4, at % 4);
        let Distances {
            radius,
            behind,
            step,
            ..
        } = self.distances;
        // However deep a joint is pressed, it keeps its points.
        let held = !is_free && pair.facet.is_some();
        let near = gap <= radius && (held || gap >= -radius);
        let known = (pair.facet).filter(|_| seen && stays_on(pair.xi) && near);
        let depth = if is_free { behind } else { step };
        let above = known.is_some() && gap >= -depth;
        let found = known.map(|facet| (facet, pair.xi));
        let found = found.or_else(|| self.pair(f, p, pair, held, x));
        let comes = |&(facet, xi): &(u32, [f64; 2])| {
            if !is_free && anchor.facet == Some(facet) {
                return true;
            }
            let depth = if held {
                depth + self.depth(at, anchor, x)
            } else {
                depth
            };
            let is_behind =
                |x: &[[f64; 3]]| self.is_behind(depth, &self.position(f, p, x), facet, xi, x);
            above || x_start.is_empty() || !is_behind(x) || !is_behind(x_start)
        };
        let paired = |(facet, xi)| PointPair {
            facet: Some(facet),
            xi,
        };
        found.filter(comes).map(paired).unwrap_or_default()
    }

    /// Notes the small distances of bonded faces that are paired at rest (docs/theory/contact.md, eq. 4).
    pub fn close(&mut self, model: &Model, pairs: &[PointPair]) {
        let (edge, x) = (self.edge(), &model.mesh.nodes);
        let distance = |(p, pair): (usize, &PointPair)| {
            let bonded = !self.law(model, p).is_dry() && !self.is_image(p);
            let facet = pair.facet.filter(|_| bonded)?;
            let point = self.position(p / 4, p % 4, x);
            let foot = extend(&point, &self.master.corners(facet as usize, x), pair.xi)?;
            let small = ROUNDING * edge..=TOUCHES * edge;
            small.contains(&foot.gap.abs()).then_some(foot.gap)
        };
        let closed: Vec<f64> = (pairs.iter().enumerate())
            .map(|pair| distance(pair).unwrap_or(0.0))
            .collect();
        self.closed = if closed.iter().any(|gap| *gap != 0.0) {
            closed
        } else {
            Vec::new()
        };
    }

    /// Opening of a point at a distance of the faces [mm]: bonded faces that nearly touch at rest are closed there.
    #[inline(always)]
    pub(in crate::assembly) fn opening(&self, point: usize, gap: f64) -> f64 {
        match self.closed.get(point) {
            Some(closed) => gap - closed,
            None => gap,
        }
    }

    /// Whether nodes have moved beyond the margin since candidates were searched.
    fn has_moved(&self, x: &[[f64; 3]]) -> bool {
        self.searched_at.len() != x.len()
            || self.searched_at.iter().zip(x).any(|(a, b)| {
                let d: f64 = (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum();
                // Both surfaces move, so each may use half of the margin.
                d > 0.25 * self.distances.skin * self.distances.skin
            })
    }

    /// Master facet of a point and the parameters of its foot, starting from its pair `before`.
    pub(super) fn pair(
        &self,
        f: usize,
        p: usize,
        before: PointPair,
        held: bool,
        x: &[[f64; 3]],
    ) -> Option<(u32, [f64; 2])> {
        let present = before.facet.map(|facet| (facet, before.xi));
        let point = self.position(f, p, x);
        let candidates = self.candidates.of(f);
        pair_point(
            &point,
            present,
            candidates,
            &self.master,
            x,
            Reach {
                radius: self.distances.radius,
                rim: self.distances.rim,
                flush: self.distances.flush,
                held,
            },
        )
    }

    /// How deep behind facets to search for candidates [mm]: nothing if no point is pressed deeper than half the search
    /// radius, else the next power of two times this radius above twice the depth.
    fn depth_to_search(&self, pairs: &[PointPair], free: &[bool], x: &[[f64; 3]]) -> f64 {
        let held = pairs.iter().zip(free).enumerate();
        let held = held.filter(|(p, (_, is_free))| !**is_free && !self.is_image(*p));
        let depth = held.map(|(p, (pair, _))| self.depth(p, *pair, x));
        let depth = depth.fold(0.0, f64::max);
        let radius = self.distances.radius;
        if depth <= 0.5 * radius {
            return 0.0;
        }
        let times = (2.0 * depth / radius).log2().ceil().exp2();
        if times.is_finite() {
            radius * times
        } else {
            radius
        }
    }

    /// Depth of a point behind the facet of its pair [mm]; 0 without one, and in front of it.
    pub(super) fn depth(&self, p: usize, pair: PointPair, x: &[[f64; 3]]) -> f64 {
        let Some(facet) = pair.facet else { return 0.0 };
        let point = self.position(p / 4, p % 4, x);
        let foot = extend(&point, &self.master.corners(facet as usize, x), pair.xi);
        foot.map_or(0.0, |foot| (-foot.gap).max(0.0))
    }

    /// Position of a point of a facet [mm].
    pub(super) fn position(&self, facet: usize, p: usize, x: &[[f64; 3]]) -> Vector3<f64> {
        let weights = &self.points[4 * facet + p].weights;
        blend(weights, &self.slave.corners(facet, x))
    }

    /// Whether a point [mm] lies more than `depth` [mm] behind a facet.
    fn is_behind(
        &self,
        depth: f64,
        point: &Vector3<f64>,
        facet: u32,
        xi: [f64; 2],
        x: &[[f64; 3]],
    ) -> bool {
        let foot = extend(point, &self.master.corners(facet as usize, x), xi);
        foot.is_some_and(|foot| foot.gap < -depth)
    }
}
