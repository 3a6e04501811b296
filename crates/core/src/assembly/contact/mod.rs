//! Joints: points on slave facets against master facets, in parallel over slave facets.
//!
//! A contact cell is one slave facet with one of its candidate master facets: 4 + 4 nodes. The candidates, and with
//! them the matrix pattern, stay the same while surfaces move by less than a margin.

mod evaluate;
mod pairing;
mod rims;
mod sight;
mod small_motion;
mod work;

pub(super) use sight::Sight;

use nalgebra::Vector3;
use wythe_contact::pairs::{RIM, STAY};
use wythe_contact::surface::blend;
use wythe_contact::{
    Aabb, Candidates, InterfaceHistory, InterfaceLaw, JointLaw, Kinematics, PointPair, PointStatus,
    SlavePoint, Surface,
};

use super::numerical_stiffness::{FIRM, WELL_WITHIN, numerical_stiffness};
use super::trial::{STIFFEST, Trial};
use crate::model::Model;
use crate::state::State;

/// Search radius across a gap over the mean edge of the facets, if the deck has no `search_radius`. A point with a
/// wider opening has no master; the search finds one again when the joint closes.
const REACH: f64 = 0.06;
/// Search radius over the largest ultimate opening u_k. No bond is lost while it carries.
const REACH_OVER_OPENING: f64 = 2.0;
/// Margin over the same edge: how far surfaces may move before candidates are searched again.
const SKIN: f64 = 0.03;

/// Depth behind a facet up to which a point may come into contact with it, over half of the same edge: the movement
/// of elastic bodies in an increment. A deeper point has come from the side, and its penalty force would throw
/// bodies apart.
const BEHIND: f64 = 1e-5;
/// Height of a step that a point may climb from one facet to the next, over the same edge: settlement and rotation
/// in a cracked wall. A higher step is the side of another body.
const STEP: f64 = 1e-3;
/// Height of a step between bodies over the same edge, up to which a point changes to the next one as soon as it passes
/// the rim: a step of rounding.
const FLUSH: f64 = 1e-5;
/// Distance of bonded faces at rest, over the same edge, up to which they count as touching: coordinates are rounded.
const TOUCHES: f64 = 1e-3;
/// The same below which a distance is rounding.
const ROUNDING: f64 = 1e-9;

/// Surfaces, contact points and candidates.
#[derive(Clone, Debug)]
// More than 15 fields: data of one search, by facet, point and node.
pub struct Contact {
    pub(super) slave: Surface,
    pub(super) master: Surface,
    pub(super) law_of: Vec<u16>,
    /// Normal and shear numerical stiffness of the shifted penalty [N/mm³]. `[slave facet]`
    pub(super) numerical: Vec<[f64; 2]>,
    /// Mass behind each slave facet [tonne/mm²]. `[slave facet]`
    areal_mass: Vec<f64>,
    /// Contact points, four on each slave facet. `[slave facet][point]`
    pub points: Vec<SlavePoint>,
    /// Parts of the points that count, because of planes of symmetry. Empty if all count whole. `[point]`
    share: Vec<f64>,
    /// Weights of the points at their places at rest. `[point]`
    at_rest: Vec<[f64; 4]>,
    /// Small distances of bonded faces at rest, from which their openings count [mm]. `[point]`; empty if there are none.
    closed: Vec<f64>,
    /// Points that this increment has moved to a rim.
    moved: Vec<u32>,
    pub(super) candidates: Candidates,
    pub(super) cells: Vec<[u32; 8]>,
    version: usize,
    distances: Distances,
    /// Positions at the last search of candidates [mm]. `[node]`
    searched_at: Vec<[f64; 3]>,
    /// How deep behind facets that search went [mm].
    searched_deep: f64,
}

/// Distances of the search.
#[derive(Clone, Copy, Debug)]
struct Distances {
    /// Search radius across a gap [mm].
    radius: f64,
    /// How far surfaces may move before candidates are searched again [mm].
    skin: f64,
    /// How far beyond the rim of a surface a point still belongs to it, over half a facet [-].
    rim: f64,
    /// Depth behind a facet up to which a point may come into contact with it [mm].
    behind: f64,
    /// Depth behind the next facet up to which a point may come to it from another facet [mm].
    step: f64,
    /// Largest difference of the heights of flush facets [mm].
    flush: f64,
}

/// Contact points of all slave facets, and the parts of them that count; no parts if all count whole.
fn points_at_rest(model: &Model, slave: &Surface) -> (Vec<SlavePoint>, Vec<f64>) {
    let surfaces = &model.contact;
    let mut points = Vec::with_capacity(4 * slave.facets.len());
    let mut share = Vec::with_capacity(points.capacity());
    for (f, facet) in slave.facets.iter().enumerate() {
        let planes = surfaces.planes(f);
        for mut point in surfaces.sampled(f, &model.mesh.nodes) {
            let part = model.mesh.point_share(facet, &point.weights, planes);
            share.push(part);
            point.area *= part;
            points.push(point);
        }
    }
    if share.iter().all(|part| *part == 1.0) {
        share.clear();
    }
    (points, share)
}

/// Mean length of the edges of the slave facets [mm]; 1 without facets.
fn mean_edge(model: &Model, slave: &Surface) -> f64 {
    let (mut edges, mut count) = (0.0, 0.0);
    for (f, _) in model.contact.whole_slaves() {
        let corners = slave.corners(f, &model.mesh.nodes).map(Vector3::from);
        for k in 0..4 {
            edges += (corners[k] - corners[(k + 1) % 4]).norm();
            count += 1.0;
        }
    }
    if count > 0.0 { edges / count } else { 1.0 }
}

impl Contact {
    /// Number of points with a status. With planes of symmetry it is that of the whole scene over the number of its
    /// parts, rounded.
    pub fn count(&self, status: &[PointStatus], wanted: PointStatus) -> usize {
        let has = |(_, status): &(usize, &PointStatus)| **status == wanted;
        let points = status.iter().enumerate().filter(has);
        if self.share.is_empty() {
            return points.count();
        }
        points.map(|(p, _)| self.share[p]).sum::<f64>().round() as usize
    }

    /// Area at rest of the points under pressure [mm²].
    pub fn pressed_area(&self, history: &[InterfaceHistory]) -> f64 {
        let points = self.points.iter().zip(history);
        let pressed = points.filter(|(_, history)| history.traction[0] < 0.0);
        pressed.map(|(point, _)| point.area).sum()
    }

    /// Search radius [mm]. A point that moves farther in one increment may pass through a facet undetected.
    pub fn reach(&self) -> f64 {
        if self.points.is_empty() {
            f64::INFINITY
        } else {
            self.distances.radius
        }
    }

    /// Prepares the surfaces of a model. No candidates are searched yet.
    pub fn new(model: &Model) -> Self {
        let surfaces = &model.contact;
        let (slave, master) = (surfaces.slave(), surfaces.master());
        let (points, share) = points_at_rest(model, &slave);
        let edge = mean_edge(model, &slave);
        let u_k = surfaces
            .laws
            .iter()
            .map(JointLaw::ultimate_opening)
            .fold(0.0, f64::max);
        let chosen = (REACH * edge).max(REACH_OVER_OPENING * u_k);
        let (numerical, areal_mass) = numerical_stiffness(model);
        Self {
            numerical,
            areal_mass,
            slave,
            master,
            law_of: surfaces.slave_law.clone(),
            share,
            at_rest: points.iter().map(|point| point.weights).collect(),
            closed: Vec::new(),
            moved: Vec::new(),
            points,
            candidates: Candidates::default(),
            cells: Vec::new(),
            version: 0,
            distances: Distances {
                radius: surfaces.search_radius.unwrap_or(chosen),
                // In general contact the edges carry facets beyond rims.
                rim: if surfaces.general.is_some() {
                    STAY
                } else {
                    RIM
                },
                skin: SKIN * edge,
                behind: 0.5 * BEHIND * edge,
                step: STEP * edge,
                flush: FLUSH * edge,
            },
            searched_at: Vec::new(),
            searched_deep: 0.0,
        }
    }

    /// Initial histories of all points.
    pub fn virgin(&self, model: &Model) -> Vec<InterfaceHistory> {
        let laws = &model.contact.laws;
        self.law_of
            .iter()
            .flat_map(|&l| [laws[l as usize].virgin(); 4])
            .collect()
    }

    /// Whether a point is the image of another point in a plane of symmetry, which represents both.
    pub fn is_image(&self, point: usize) -> bool {
        self.points[point].area == 0.0
    }

    /// Law of a point.
    pub fn law<'m>(&self, model: &'m Model, point: usize) -> &'m InterfaceLaw {
        &model.contact.laws[self.law_of[point / 4] as usize]
    }

    /// Body of the master facet of a point, if it has one.
    pub(super) fn faced_body(&self, pair: &PointPair) -> Option<u32> {
        pair.facet.map(|facet| self.master.body[facet as usize])
    }

    /// Number of searches that changed the candidates.
    pub fn version(&self) -> usize {
        self.version
    }

    /// Contact cells: 4 slave and 4 master nodes each.
    pub fn cells(&self) -> impl Iterator<Item = &[u32; 8]> {
        self.cells.iter()
    }

    /// Cells of one slave facet with their indices among all contact cells.
    pub fn cells_of(&self, facet: usize) -> impl Iterator<Item = (usize, &[u32; 8])> {
        let range = self.candidates.range(facet);
        range.clone().zip(&self.cells[range])
    }

    /// Master facets of these cells.
    pub fn masters_of(&self, facet: usize) -> &[u32] {
        self.candidates.of(facet)
    }

    /// Number of contact cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Positions of the four points of a facet at their places at rest on it [mm].
    fn positions(&self, facet: usize, x: &[[f64; 3]]) -> [[f64; 3]; 4] {
        let corners = self.slave.corners(facet, x);
        [0, 1, 2, 3].map(|p| blend(&self.at_rest[4 * facet + p], &corners).into())
    }

    /// Positions of nodes at the last search of candidates [mm]. `[node]`
    pub fn searched_at(&self) -> &[[f64; 3]] {
        &self.searched_at
    }

    /// How deep behind facets that search went [mm].
    pub fn searched_deep(&self) -> f64 {
        self.searched_deep
    }

    /// Searches candidates at positions `x` [mm] `[node]`, up to `deep` [mm] behind facets.
    pub fn search_from(&mut self, x: &[[f64; 3]], deep: f64) {
        let boxes: Vec<Aabb> = (0..self.slave.facets.len())
            .map(|f| Aabb::of(&self.positions(f, x)))
            .collect();
        let reach = deep.max(self.distances.radius) + self.distances.skin;
        self.searched_deep = deep;
        let found = Candidates::find(&self.slave, &boxes, &self.master, x, reach);
        self.searched_at.clear();
        self.searched_at.extend_from_slice(x);
        if found != self.candidates {
            self.candidates = found;
            self.version += 1;
            self.cells.clear();
            for (f, slave) in self.slave.facets.iter().enumerate() {
                for &m in self.candidates.of(f) {
                    let master = self.master.facets[m as usize];
                    let mut cell = [0; 8];
                    cell[..4].copy_from_slice(slave);
                    cell[4..].copy_from_slice(&master);
                    self.cells.push(cell);
                }
            }
        }
    }

    /// Adds `ratio` times the last change to the tractions of the last commit, within the bounds of the law
    /// (theory/equilibrium.md, eq. 12).
    pub fn extrapolate(&self, model: &Model, state: &State, trial: &mut Trial, ratio: f64) {
        let Some(last) = &state.last else { return };
        let points = state.interface.iter().zip(&last.dtraction);
        for (p, (traction, (old, change))) in
            trial.shift.traction.iter_mut().zip(points).enumerate()
        {
            let law = self.law(model, p);
            let guess = [0, 1, 2].map(|i| old.traction[i] + ratio * change[i]);
            *traction = law.within_bounds(guess, old);
        }
    }

    /// Numerical stiffness of a point whose last traction is `last` [N/mm³] (theory/equilibrium.md, eq. 7).
    #[inline(always)]
    pub(super) fn shifted_stiffness(
        &self,
        facet: usize,
        law: &(impl JointLaw + ?Sized),
        last: &[f64; 3],
        old: &InterfaceHistory,
        soft: Soft,
    ) -> [f64; 2] {
        let factor = if soft.steady && law.exertion(last, old) < WELL_WITHIN {
            // Two values only, so that this stiffness seldom changes.
            if soft.factor < STIFFEST {
                FIRM
            } else {
                soft.factor
            }
        } else {
            let firm = law.utilisation(last, old) < WELL_WITHIN;
            soft.factor.max(if firm { FIRM } else { 1.0 })
        };
        let least = soft.inertia * self.areal_mass[facet];
        self.numerical[facet].map(|k| (k * factor).max(least))
    }
}

/// Factors of the numerical stiffness in an iterate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Soft {
    /// Factor of the numerical stiffness [-].
    pub factor: f64,
    /// Least stiffness over the mass behind it, with inertia [1/s²].
    pub inertia: f64,
    /// Whether points well within their limits follow the factor in two steps only, so that their stiffness can be
    /// reused.
    pub steady: bool,
}

impl Soft {
    /// Factors of the present iterate.
    pub fn of(state: &State, trial: &Trial) -> Self {
        Self {
            factor: trial.shift.stiffening,
            inertia: trial.inertia,
            steady: state.poses.steady && !trial.is_under_loads(),
        }
    }
}

/// Total gap `[u, δ₁, δ₂]` of a pair with this opening [mm]: its slip is added to that of the history.
pub(super) fn total_gap(opening: f64, kin: &Kinematics, old: &InterfaceHistory) -> [f64; 3] {
    [
        opening,
        old.slip[0] + kin.slip[0],
        old.slip[1] + kin.slip[1],
    ]
}
