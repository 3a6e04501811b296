//! The interfaces: points on slave facets against master facets, in parallel by slave facet.
//!
//! A contact cell is one slave facet with one of its candidate master facets: 4 + 4 nodes. The
//! candidates stay fixed while surfaces move less than the skin, and the matrix pattern with them.

use nalgebra::Vector3;
use rayon::prelude::*;
use wythe_contact::stencil::Anchor;
use wythe_contact::{
    Aabb, Candidates, InterfaceHistory, InterfaceLaw, Kinematics, PointPair, PointStatus, Shift,
    SlavePoint, Surface, corner_points, extend, frame_at, gauss_points, pair_point, to_frame,
    write_stiffness,
};

use super::numerical::{FIRM, WELL_WITHIN, numerical_stiffness};
use super::pattern::CELL;
use super::{Evaluation, Trial};
use crate::model::Model;
use crate::model::scene::ContactPoints;
use crate::solve::State;

/// Reach of contact across a gap, over the mean edge of the facets, where the deck has no
/// `search_radius`. A point that opens wider is free; the search finds it again when it closes.
const REACH: f64 = 0.06;
/// The same over the largest ultimate opening u_k: no bond is lost while it carries.
const REACH_OVER_OPENING: f64 = 2.0;
/// How far surfaces may move before the candidates are searched anew, over the same edge.
const SKIN: f64 = 0.03;

/// How far behind a facet a point may come into contact with it, over the half of the same edge: what the
/// elastic bodies step by. One that is deeper has come from the side, and its penalty would throw bodies
/// about.
const BEHIND: f64 = 1e-5;
/// How high a step a point climbs where it comes from a facet to the next, over the same edge: what settles and
/// turns in a cracked wall. The side of a higher one is not its face.
const STEP: f64 = 0.01;

/// Surfaces, points and candidates.
#[derive(Clone, Debug)]
pub struct Contact {
    pub(super) slave: Surface,
    master: Surface,
    pub(super) law_of: Vec<u16>,
    /// Normal and shear stiffness of the shifted penalty [N/mm³]. `[slave facet]`
    pub(super) numerical: Vec<[f64; 2]>,
    /// Mass behind each slave facet [tonne/mm²]. `[slave facet]`
    areal_mass: Vec<f64>,
    /// Sampling points. `[slave facet][point]`, four to a facet
    pub points: Vec<SlavePoint>,
    pub(super) candidates: Candidates,
    pub(super) cells: Vec<[u32; 8]>,
    version: usize,
    radius: f64,
    skin: f64,
    /// How far behind a facet a point may come into contact with it [mm].
    behind: f64,
    /// How far behind the next facet a point may come to it from another [mm].
    step: f64,
    /// Positions at the last search of candidates [mm]. `[node]`
    searched_at: Vec<[f64; 3]>,
}

/// What one slave facet writes.
struct Task<'a> {
    facet: usize,
    force: &'a mut [[[f64; 3]; 8]],
    cells: &'a mut [f64],
    active: &'a mut [bool],
    history: &'a mut [InterfaceHistory],
    energy: &'a mut [[f64; 2]],
    status: &'a mut [PointStatus],
    pairs: &'a mut [PointPair],
    anchors: &'a [PointPair],
    last: &'a [[f64; 3]],
    bounding: &'a [f64],
    /// Factor of the numerical stiffness [-], and the least one from what inertia opposes [1/s²].
    soft: [f64; 2],
    /// Tangents of points at their shear limit are those of stick.
    sticks: bool,
}

impl Contact {
    /// Area at rest of the points that press [mm²].
    pub fn pressed_area(&self, history: &[InterfaceHistory]) -> f64 {
        let points = self.points.iter().zip(history);
        let pressed = points.filter(|(_, history)| history.traction[0] < 0.0);
        pressed.map(|(point, _)| point.area).sum()
    }

    /// Prepares the surfaces of a model; nothing is searched yet.
    pub fn new(model: &Model) -> Self {
        let surfaces = &model.contact;
        let (slave, master) = (surfaces.slave(), surfaces.master());
        let x = &model.mesh.nodes;
        let mut points = Vec::with_capacity(4 * slave.facets.len());
        let (mut edges, mut count) = (0.0, 0.0);
        for f in 0..slave.facets.len() {
            let corners = slave.corners(f, x);
            points.extend(match surfaces.points {
                ContactPoints::Gauss => gauss_points(&corners),
                ContactPoints::Corner => corner_points(&corners),
            });
            for k in 0..4 {
                let (a, b) = (
                    Vector3::from(corners[k]),
                    Vector3::from(corners[(k + 1) % 4]),
                );
                edges += (a - b).norm();
                count += 1.0;
            }
        }
        let edge = if count > 0.0 { edges / count } else { 1.0 };
        let u_k = surfaces.laws.iter().map(|l| l.u_k).fold(0.0, f64::max);
        let chosen = (REACH * edge).max(REACH_OVER_OPENING * u_k);
        let (numerical, areal_mass) = numerical_stiffness(model);
        Self {
            numerical,
            areal_mass,
            slave,
            master,
            law_of: surfaces.slave_law.clone(),
            points,
            candidates: Candidates::default(),
            cells: Vec::new(),
            version: 0,
            radius: surfaces.search_radius.unwrap_or(chosen),
            skin: SKIN * edge,
            behind: 0.5 * BEHIND * edge,
            step: STEP * edge,
            searched_at: Vec::new(),
        }
    }

    /// Histories of points that nothing has happened to.
    pub fn virgin(&self, model: &Model) -> Vec<InterfaceHistory> {
        let laws = &model.contact.laws;
        self.law_of
            .iter()
            .flat_map(|&l| [laws[l as usize].virgin(); 4])
            .collect()
    }

    /// The law of a point.
    pub fn law<'m>(&self, model: &'m Model, point: usize) -> &'m InterfaceLaw {
        &model.contact.laws[self.law_of[point / 4] as usize]
    }

    /// The body that a point faces, if it faces one.
    pub(super) fn faced_body(&self, pair: &PointPair) -> Option<u32> {
        pair.facet.map(|facet| self.master.body[facet as usize])
    }

    /// Counts the searches of candidates.
    pub fn version(&self) -> usize {
        self.version
    }

    /// Contact cells: 4 slave and 4 master nodes each.
    pub fn cells(&self) -> impl Iterator<Item = &[u32; 8]> {
        self.cells.iter()
    }

    /// Those of one slave facet, with their places among all contact cells.
    pub fn cells_of(&self, facet: usize) -> impl Iterator<Item = (usize, &[u32; 8])> {
        let range = self.candidates.range(facet);
        range.clone().zip(&self.cells[range])
    }

    /// Number of contact cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Positions of the four points of a facet [mm].
    fn positions(&self, facet: usize, x: &[[f64; 3]]) -> [[f64; 3]; 4] {
        let corners = self.slave.corners(facet, x);
        [0, 1, 2, 3].map(|p| {
            let weights = &self.points[4 * facet + p].weights;
            [0, 1, 2].map(|i| (0..4).map(|a| weights[a] * corners[a][i]).sum())
        })
    }

    /// Where candidates were searched last [mm]. `[node]`
    pub fn searched_at(&self) -> &[[f64; 3]] {
        &self.searched_at
    }

    /// Searches the candidates at positions `x` [mm] `[node]`.
    pub fn search_from(&mut self, x: &[[f64; 3]]) {
        let boxes: Vec<Aabb> = (0..self.slave.facets.len())
            .map(|f| Aabb::of(&self.positions(f, x)))
            .collect();
        let reach = self.radius + self.skin;
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

    /// Renews the candidates if surfaces moved beyond the skin, then pairs every point.
    pub fn search(&mut self, trial: &mut Trial) {
        let x = &trial.x;
        let moved = self.searched_at.len() != x.len()
            || self.searched_at.iter().zip(x).any(|(a, b)| {
                let d: f64 = (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum();
                // Both surfaces move.
                d > 0.25 * self.skin * self.skin
            });
        if moved {
            self.search_from(x);
        }
        let anchors = trial.anchors.par_chunks_mut(4);
        let (free, x_start) = (&trial.free, &trial.x_start);
        trial
            .pairs
            .par_chunks_mut(4)
            .zip(anchors)
            .enumerate()
            .for_each(|(f, (pairs, anchors))| {
                let points = self.positions(f, x);
                for (p, ((pair, anchor), point)) in
                    pairs.iter_mut().zip(anchors).zip(points).enumerate()
                {
                    let point = Vector3::from(point);
                    let present = pair.facet.map(|facet| (facet, pair.xi));
                    let candidates = self.candidates.of(f);
                    let mut found =
                        pair_point(&point, present, candidates, &self.master, x, self.radius);
                    if !x_start.is_empty() {
                        let is_free = free[4 * f + p];
                        let depth = if is_free { self.behind } else { self.step };
                        found = found.filter(|&(facet, xi)| {
                            let stays = !is_free && anchor.facet == Some(facet);
                            let before = || Vector3::from(self.positions(f, x_start)[p]);
                            stays
                                || !self.is_behind(depth, &point, facet, xi, x)
                                || !self.is_behind(depth, &before(), facet, xi, x_start)
                        });
                    }
                    *pair = match found {
                        Some((facet, xi)) => PointPair {
                            facet: Some(facet),
                            xi,
                        },
                        None => PointPair::default(),
                    };
                    if anchor.facet.is_none() {
                        *anchor = *pair;
                    }
                }
            });
    }

    /// Whether a point [mm] lies behind a facet by more than `depth` [mm].
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

    /// What the trapezoidal rule makes of points that open, close or change their facet in the increment that
    /// `trial` ends [N mm].
    pub fn crossing_work(&self, model: &Model, state: &State, trial: &Trial) -> f64 {
        let points = state.interface.iter().zip(&trial.interface).enumerate();
        points
            .map(|(p, (old, new))| {
                let work = if trial.pairs[p].facet == state.pairs[p].facet {
                    self.law(model, p).crossing_work(old, new)
                } else {
                    self.work_of_change(p, state, trial)
                };
                work * self.points[p].area
            })
            .sum()
    }

    /// The same of a point that has come from facet a, or from none, to b, or to none [N/mm]. The rule's work of its
    /// normal tractions t₀, t₁ is ½ t₀ Δg_a + ½ t₁ Δg_b, and the energies of its branches are ½ t₀ g_a0 and ½ t₁ g_b1:
    /// ½ t₀ g_a1 − ½ t₁ g_b0 is left. One that is lost dissipates its energy besides.
    fn work_of_change(&self, p: usize, state: &State, trial: &Trial) -> f64 {
        let (old, new) = (&state.interface[p], &trial.interface[p]);
        if trial.x_start.is_empty() {
            return 0.0;
        }
        let gap = |pair: PointPair, x: &[[f64; 3]]| {
            let corners = self.master.corners(pair.facet? as usize, x);
            let point = Vector3::from(self.positions(p / 4, x)[p % 4]);
            extend(&point, &corners, pair.xi).map(|foot| foot.gap)
        };
        let mut work = 0.0;
        if old.traction[0] != 0.0 {
            let stored = if trial.pairs[p].facet.is_none() {
                old.opening
            } else {
                0.0
            };
            let now = gap(state.pairs[p], &trial.x);
            work += now.map_or(0.0, |now| 0.5 * old.traction[0] * (now - stored));
        }
        if new.traction[0] != 0.0 {
            let before = gap(trial.pairs[p], &trial.x_start);
            work -= before.map_or(0.0, |before| 0.5 * new.traction[0] * before);
        }
        work
    }

    /// Tractions of the last commit and `ratio` times their last change, within the law's bounds.
    pub fn extrapolate(&self, model: &Model, state: &State, trial: &mut Trial, ratio: f64) {
        let Some(last) = &state.last else { return };
        let points = state.interface.iter().zip(&last.dtraction);
        for (p, (traction, (old, change))) in trial.traction.iter_mut().zip(points).enumerate() {
            let law = self.law(model, p);
            let guess = [0, 1, 2].map(|i| old.traction[i] + ratio * change[i]);
            *traction = law.within_bounds(guess, old);
        }
    }

    /// Forces and, where asked for, stiffness of every pair; cells follow those of the elements.
    pub fn evaluate(
        &self,
        model: &Model,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        first_cell: usize,
    ) {
        let n = self.points.len();
        trial.interface.resize(n, InterfaceHistory::default());
        trial.point_energy.resize(n, [0.0; 2]);
        trial.status.resize(n, PointStatus::default());
        let x = &trial.x;
        let mut force = &mut trial.cell_force[first_cell..];
        let mut cells = &mut trial.cells[first_cell * CELL..];
        let mut active = &mut trial.active[first_cell..];
        let per_point = trial
            .interface
            .chunks_exact_mut(4)
            .zip(trial.point_energy.chunks_exact_mut(4))
            .zip(trial.status.chunks_exact_mut(4))
            .zip(trial.pairs.chunks_exact_mut(4))
            .zip(trial.anchors.chunks_exact(4))
            .zip(trial.traction.chunks_exact(4))
            .zip(trial.bounding.chunks_exact(4));
        let mut tasks = Vec::with_capacity(n / 4);
        for (facet, ((((((history, energy), status), pairs), anchors), last), bounding)) in
            per_point.enumerate()
        {
            let count = self.candidates.range(facet).len();
            let (f, f_rest) = force.split_at_mut(count);
            let (c, c_rest) = cells.split_at_mut(count * CELL);
            let (a, a_rest) = active.split_at_mut(count);
            (force, cells, active) = (f_rest, c_rest, a_rest);
            tasks.push(Task {
                facet,
                force: f,
                cells: c,
                active: a,
                history,
                energy,
                status,
                pairs,
                anchors,
                last,
                bounding,
                soft: [trial.stiffening, trial.inertia],
                sticks: trial.sticks,
            });
        }
        tasks
            .into_par_iter()
            .with_min_len(8)
            .for_each(|mut task| self.facet(model, state, x, setting, &mut task));
    }

    /// One slave facet.
    fn facet(
        &self,
        model: &Model,
        state: &State,
        x: &[[f64; 3]],
        setting: Evaluation,
        task: &mut Task,
    ) {
        let f = task.facet;
        let law = &model.contact.laws[self.law_of[f] as usize];
        let slave = self.slave.corners(f, x);
        task.force.fill([[0.0; 3]; 8]);
        let mut stiff = [None; 4];
        if setting.tangent {
            task.active.fill(false);
        }
        for p in 0..4 {
            let point = &self.points[4 * f + p];
            let old = &state.interface[4 * f + p];
            let committed = task.anchors[p];
            let pair = &mut task.pairs[p];
            let Some((cell, kin)) = self.see(4 * f + p, &slave, committed, *pair, x) else {
                *pair = PointPair::default();
                task.history[p] = lost(law, old);
                // What the point stored is set free.
                task.energy[p] = [0.0, law.free_energy(old) * point.area];
                task.status[p] = PointStatus::Open;
                continue;
            };
            pair.xi = kin.xi;
            let old = self.carried(old, committed, *pair, &kin, x);
            let gap = total_gap(&kin, &old);
            let mut stick = law.shear_stiffness;
            let mut response = if setting.shifted {
                let shift = Shift {
                    stiffness: self.shifted_stiffness(f, law, &task.last[p], old.damage, task.soft),
                    traction: task.last[p],
                    bounding: task.bounding[p],
                };
                stick = stick.min(shift.stiffness[1]);
                law.update_shifted(gap, &old, &shift)
            } else {
                law.update(gap, &old)
            };
            if task.sticks && response.status == PointStatus::Slip {
                for i in 1..3 {
                    for j in 0..3 {
                        response.tangent[(i, j)] = if i == j { stick } else { 0.0 };
                    }
                }
            }
            kin.add_force(&response.traction, point.area, &mut task.force[cell]);
            if setting.tangent && setting.shifted {
                stiff[p] = Some((cell, kin.stiffness(&response.tangent, point.area)));
            } else if setting.tangent {
                let to = &mut task.cells[cell * CELL..(cell + 1) * CELL];
                if !task.active[cell] {
                    to.fill(0.0);
                    task.active[cell] = true;
                }
                kin.add_exact_stiffness(&response.traction, &response.tangent, point.area, to);
            }
            task.history[p] = response.history;
            task.energy[p] = [
                response.elastic_energy * point.area,
                response.dissipation * point.area,
            ];
            task.status[p] = response.status;
        }
        for (cell, first) in stiff.iter().flatten() {
            if !task.active[*cell] {
                let (mut together, mut count) = ([*first; 4], 0);
                for (_, one) in stiff.iter().flatten().filter(|(c, _)| c == cell) {
                    together[count] = *one;
                    count += 1;
                }
                let to = &mut task.cells[cell * CELL..(cell + 1) * CELL];
                write_stiffness(&together[..count], to);
                task.active[*cell] = true;
            }
        }
    }

    /// Numerical stiffness of a point with traction `last`, of `[factor, inertia]` [N/mm³].
    pub(super) fn shifted_stiffness(
        &self,
        facet: usize,
        law: &InterfaceLaw,
        last: &[f64; 3],
        damage: f64,
        [stiffening, inertia]: [f64; 2],
    ) -> [f64; 2] {
        let firm = law.utilisation(last, damage) < WELL_WITHIN;
        let factor = stiffening.max(if firm { FIRM } else { 1.0 });
        let least = inertia * self.areal_mass[facet];
        self.numerical[facet].map(|k| (k * factor).max(least))
    }

    /// Kinematics of a point, and the place of its cell among those of its facet.
    pub(super) fn see(
        &self,
        at: usize,
        slave: &[[f64; 3]; 4],
        committed: PointPair,
        pair: PointPair,
        x: &[[f64; 3]],
    ) -> Option<(usize, Kinematics)> {
        let facet = pair.facet?;
        let cell = self.candidates.of(at / 4).binary_search(&facet).ok()?;
        let master = self.master.corners(facet as usize, x);
        let anchor = self.anchor(committed, pair, x);
        let weights = &self.points[at].weights;
        let kin = Kinematics::new(slave, weights, &master, pair.xi, anchor)?;
        Some((cell, kin))
    }

    /// Where the slip of this increment starts: the foot at the last commit, wherever it is now. A
    /// point that comes into contact starts where it is.
    fn anchor(&self, committed: PointPair, now: PointPair, x: &[[f64; 3]]) -> Anchor {
        match committed.facet {
            Some(facet) if Some(facet) == now.facet => Anchor::Same(committed.xi),
            Some(facet) => {
                // The point has crossed to another facet in this increment.
                let corners = self.master.corners(facet as usize, x);
                Anchor::At(wythe_contact::surface::point_at(&corners, committed.xi).into())
            }
            None => Anchor::Same(now.xi),
        }
    }

    /// History with its tangential components in the frame of the present facet.
    pub(super) fn carried(
        &self,
        old: &InterfaceHistory,
        committed: PointPair,
        now: PointPair,
        kin: &Kinematics,
        x: &[[f64; 3]],
    ) -> InterfaceHistory {
        match committed.facet {
            Some(facet) if Some(facet) != now.facet => {
                let corners = self.master.corners(facet as usize, x);
                let from = frame_at(&corners, committed.xi);
                let shear = to_frame([old.traction[1], old.traction[2]], &from, &kin.frame);
                InterfaceHistory {
                    slip: to_frame(old.slip, &from, &kin.frame),
                    plastic_slip: to_frame(old.plastic_slip, &from, &kin.frame),
                    traction: [old.traction[0], shear[0], shear[1]],
                    ..*old
                }
            }
            _ => *old,
        }
    }
}

/// `[u, δ₁, δ₂]` of a pair [mm], its slip on from that of its history.
pub(super) fn total_gap(kin: &Kinematics, old: &InterfaceHistory) -> [f64; 3] {
    [
        kin.gap,
        old.slip[0] + kin.slip[0],
        old.slip[1] + kin.slip[1],
    ]
}

/// A point that faces nothing: no traction; if it comes back it sticks where it is.
fn lost(law: &InterfaceLaw, old: &InterfaceHistory) -> InterfaceHistory {
    // What left its surface has no bond to come back to.
    let damage = if law.is_dry() { old.damage } else { 1.0 };
    InterfaceHistory {
        slip: old.plastic_slip,
        damage,
        traction: [0.0; 3],
        opening: 0.0,
        ..*old
    }
}
