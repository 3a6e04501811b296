//! Points that follow the rim of their master surface (theory/contact.md, eq. 9).
//!
//! The corners of the common area carry a slave facet that extends beyond the rim of its master. A contact point at
//! a corner of the facet would have no master there, and the facet would rotate about its other points. So a point
//! without bond that lies beyond the rim is moved along its facet to the rim when an increment begins. Its place
//! depends on the committed positions alone. It therefore returns with the facet, and a resumed run finds it again.

use wythe_contact::pairs::{STAY, rim_point, stays_on};
use wythe_contact::surface::{blend, weights_at};
use wythe_contact::{PointPair, extend, frame_at};

use super::{Contact, Distances};
use crate::assembly::Trial;
use crate::model::Model;
use crate::state::State;

/// Rounding of the parameters of a point at the edge of its part of a facet [-].
const ROUNDING: f64 = 1e-9;
/// Parameter of the master facet at which a moved point lies. It is slightly less than the one at which a point
/// leaves the facet ([`stays_on`]).
const FARTHEST: f64 = 1.0 + 0.9 * STAY;

/// Largest distance of a point from its place at rest that counts as zero, over the margin: 3e-5 of an edge.
const AT_REST: f64 = 1e-3;

impl Contact {
    /// Places the points for the increment that `trial` begins from `state`.
    pub fn follow_rims(&mut self, model: &Model, state: &State, trial: &mut Trial) {
        for p in std::mem::take(&mut self.moved) {
            self.points[p as usize].weights = self.at_rest[p as usize];
            trial.cells.held.forget_joint(p as usize / 4);
        }
        if model.contact.general.is_some() {
            // In general contact the edges carry facets beyond rims.
            return;
        }
        for p in 0..self.points.len() {
            let pair = state.pairs[p];
            let stays = state.interface[p].damage < 1.0 || self.is_image(p);
            if stays || self.is_over_its_facet(p, pair, &trial.x) {
                continue;
            }
            let Some((weights, pair)) = self.at_rim(model, p, pair, &trial.x) else {
                if !self.lies_at(p, pair, &trial.x) {
                    // It was moved before, and is back at its place at rest.
                    let found = self.pair_at_rest(p, pair, &trial.x);
                    trial.joints.pairs[p] = found;
                    trial.joints.anchors[p] = found;
                    trial.joints.free[p] = found.facet.is_none();
                }
                continue;
            };
            self.points[p].weights = weights;
            self.moved.push(p as u32);
            trial.cells.held.forget_joint(p / 4);
            trial.joints.pairs[p] = pair;
            trial.joints.anchors[p] = pair;
            trial.joints.free[p] = false;
        }
    }

    /// Whether a point at its place at rest lies above the facet of its pair, with the foot of that pair.
    fn is_over_its_facet(&self, p: usize, pair: PointPair, x: &[[f64; 3]]) -> bool {
        pair.facet.is_some() && stays_on(pair.xi) && self.lies_at(p, pair, x)
    }

    /// The pair that a point at its place at rest has by its position alone: the facet onto which it projects, no deeper
    /// behind it than behind that of the pair `before` and the step that points climb.
    fn pair_at_rest(&self, p: usize, before: PointPair, x: &[[f64; 3]]) -> PointPair {
        let found = self.pair(p / 4, p % 4, PointPair::default(), false, x);
        let found = found.map(|(facet, xi)| PointPair {
            facet: Some(facet),
            xi,
        });
        let deepest = self.distances.step + self.depth(p, before, x);
        found
            .filter(|pair| self.depth(p, *pair, x) <= deepest)
            .unwrap_or_default()
    }

    /// Whether a point at its place at rest has the foot of its pair. True without a pair.
    fn lies_at(&self, p: usize, pair: PointPair, x: &[[f64; 3]]) -> bool {
        let Some(facet) = pair.facet else {
            return true;
        };
        let corners = self.master.corners(facet as usize, x);
        let way = self.position(p / 4, p % 4, x) - blend(&weights_at(pair.xi), &corners);
        let [normal, _, _] = frame_at(&corners, pair.xi);
        let along = way - normal * normal.dot(&way);
        along.norm() <= AT_REST * self.distances.skin
    }

    /// Place on the rim of a point that lies beyond it: the weights of its slave facet's corners, and its foot.
    fn at_rim(
        &self,
        model: &Model,
        p: usize,
        before: PointPair,
        x: &[[f64; 3]],
    ) -> Option<([f64; 4], PointPair)> {
        let f = p / 4;
        let point = self.position(f, p % 4, x);
        let Distances { radius, step, .. } = self.distances;
        let deep = (step + self.depth(p, before, x)).min(radius);
        let candidates = self.candidates.of(f);
        let (facet, rim) = rim_point(&point, candidates, &self.master, x, [radius, deep])?;
        let master = self.master.corners(facet as usize, x);
        let foot = extend(&point, &master, rim.xi)?;
        if stays_on(foot.xi) {
            return None;
        }
        // Points at their corners stay up to the same parameter, so a point leaves its corner without a jump.
        let xi = foot.xi.map(|xi| xi.clamp(-FARTHEST, FARTHEST));
        let target = blend(&weights_at(xi), &master);
        let on_slave = extend(&target, &self.slave.corners(f, x), [0.0; 2])?;
        let part = model.contact.part(f);
        let beyond = |i: usize| (on_slave.xi[i] - part.middle[i]).abs() - part.half[i];
        let within = (0..2).all(|i| beyond(i) <= ROUNDING);
        // A point that comes from the side lies behind the facet.
        let gap = (on_slave.point - target).dot(&rim.normal);
        let above = before.facet.is_some() || gap >= -self.distances.behind;
        if !(within && above && gap.abs() <= self.distances.radius) {
            return None;
        }
        let pair = PointPair {
            facet: Some(facet),
            xi,
        };
        Some((weights_at(on_slave.xi), pair))
    }
}
