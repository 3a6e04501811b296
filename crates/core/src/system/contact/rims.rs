//! Points that follow the rim of the surface they face.
//!
//! A slave facet that hangs over the rim of its master rests on what lies above the master, up to the rim: the corners of
//! the overlap carry it. A sampling point that stays at its corner of the facet would face nothing, and the
//! facet would turn about the points that are left. So a point without bond that is over the rim is
//! moved along its facet to the rim when an increment begins, and goes back with the facet. Where it is follows
//! from the committed positions alone.

use nalgebra::Vector3;
use wythe_contact::pairs::{is_on, rim_point};
use wythe_contact::surface::weights_at;
use wythe_contact::{PointPair, extend, frame_at};

use super::Contact;
use crate::model::Model;
use crate::solve::State;
use crate::system::Trial;

/// How far beyond what it samples a point may come to lie by rounding (of the half).
const ROUNDING: f64 = 1e-9;

/// A point is where it is at rest if it is within this of it (of the skin): less than a ten-thousandth of an edge.
const AT_REST: f64 = 1e-3;

impl Contact {
    /// Places the points for the increment that `trial` begins from `state`.
    pub fn follow_rims(&mut self, model: &Model, state: &State, trial: &mut Trial) {
        for p in std::mem::take(&mut self.off_corner) {
            self.points[p as usize].weights = self.at_rest[p as usize];
            trial.held.forget_joint(p as usize / 4);
        }
        if model.contact.general.is_some() {
            // Its edges carry what hangs over.
            return;
        }
        for p in 0..self.points.len() {
            let pair = state.pairs[p];
            let stays = state.interface[p].damage < 1.0 || self.is_image(p);
            if stays || self.is_over_its_facet(p, pair, &trial.x) {
                continue;
            }
            let Some((weights, pair)) = self.at_rim(model, p, pair, &trial.x) else {
                continue;
            };
            self.points[p].weights = weights;
            self.off_corner.push(p as u32);
            trial.held.forget_joint(p / 4);
            trial.pairs[p] = pair;
            trial.anchors[p] = pair;
            trial.free[p] = false;
        }
    }

    /// Whether a point, where it is at rest on its facet, is over the facet of its pair: its foot is that of the pair.
    fn is_over_its_facet(&self, p: usize, pair: PointPair, x: &[[f64; 3]]) -> bool {
        let Some(facet) = pair.facet.filter(|_| is_on(pair.xi)) else {
            return false;
        };
        let corners = self.master.corners(facet as usize, x);
        let weights = weights_at(pair.xi);
        let foot = [0, 1, 2].map(|i| (0..4).map(|a| weights[a] * corners[a][i]).sum());
        let way = self.position(p / 4, p % 4, x) - Vector3::from(foot);
        let [normal, _, _] = frame_at(&corners, pair.xi);
        let along = way - normal * normal.dot(&way);
        along.norm() <= AT_REST * self.skin
    }

    /// Where a point has to be to lie on the rim that it is over: weights of the corners of its facet, and its foot.
    fn at_rim(
        &self,
        model: &Model,
        p: usize,
        before: PointPair,
        x: &[[f64; 3]],
    ) -> Option<([f64; 4], PointPair)> {
        let f = p / 4;
        let point = self.position(f, p % 4, x);
        let (facet, rim) = rim_point(&point, self.candidates.of(f), &self.master, x, self.radius)?;
        let corners = self.slave.corners(f, x);
        let place = extend(&rim.point, &corners, [0.0; 2])?;
        let part = model.contact.part(f);
        let within =
            (0..2).all(|i| (place.xi[i] - part.middle[i]).abs() <= part.half[i] * (1.0 + ROUNDING));
        // What has come from the side lies behind the facet.
        let gap = (place.point - rim.point).dot(&rim.normal);
        let above = before.facet.is_some() || gap >= -self.behind;
        if !(within && above && gap.abs() <= self.radius) {
            return None;
        }
        let weights = weights_at(place.xi);
        let pair = PointPair {
            facet: Some(facet),
            xi: rim.xi,
        };
        Some((weights, pair))
    }
}
