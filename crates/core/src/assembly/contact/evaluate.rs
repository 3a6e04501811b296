//! Forces and stiffness of all contact points, in groups of facets.

use pulp::Simd;
use rayon::prelude::*;
use wythe_contact::{
    FlatBranches, FourPlaced, FourSeen, InterfaceHistory, JointLaw, Lanes, PointPair, PointStatus,
    Shift, Symmetric, for_law, write_symmetric,
};

use super::sight::Sight;
use super::{Contact, Soft};
use crate::assembly::pattern::CELL;
use crate::assembly::stiffness_reuse::Joint;
use crate::assembly::{Evaluation, Trial};
use crate::model::Model;
use crate::state::State;

/// Facets of a task: some ten microseconds of work, more than the cost of its scheduling.
const GROUP: usize = 16;

/// Input common to all facets.
struct Seen<'a> {
    contact: &'a Contact,
    model: &'a Model,
    state: &'a State,
    x: &'a [[f64; 3]],
    setting: Evaluation,
    soft: Soft,
    /// Whether points at their shear limit get the tangent of stick.
    sticks: bool,
    /// Whether stiffness may be taken at poses.
    keeps: bool,
    /// Facets that are evaluated. None: all facets. `[slave facet]`
    awake: Option<&'a [bool]>,
}

/// Input and output of a group of consecutive facets.
// More than 15 fields: one for each array of the trial that it takes a part of.
struct Group<'a> {
    first: usize,
    force: &'a mut [[[f64; 3]; 8]],
    cells: &'a mut [f64],
    active: &'a mut [bool],
    changed: &'a mut [bool],
    history: &'a mut [InterfaceHistory],
    energy: &'a mut [[f64; 2]],
    status: &'a mut [PointStatus],
    pairs: &'a mut [PointPair],
    gaps: &'a mut [f64],
    joints: &'a mut [Joint],
    anchors: &'a [PointPair],
    last: &'a [[f64; 3]],
    bounding: &'a [f64],
    loose: &'a mut [FlatBranches],
    held: &'a [FlatBranches],
}

impl Contact {
    /// Evaluates forces, and stiffness where the setting asks for it, of every pair. Contact cells follow those of
    /// the elements.
    #[expect(
        clippy::too_many_lines,
        reason = "one list of the arrays that are divided into groups"
    )]
    pub fn evaluate(
        &self,
        model: &Model,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        first_cell: usize,
    ) {
        let n = self.points.len();
        trial.joints.history.resize(n, InterfaceHistory::default());
        trial.joints.energy.resize(n, [0.0; 2]);
        trial.joints.status.resize(n, PointStatus::default());
        trial.joints.gaps.resize(n, 0.0);
        trial.shift.branches.resize(n);
        let keeps = setting.keeps(&state.poses, trial);
        trial.joints.seen_at.clone_from(&trial.x);
        trial.cells.held.fit_joints(n / 4, self.version);
        let seen = Seen {
            contact: self,
            model,
            state,
            x: &trial.x,
            setting,
            soft: Soft::of(state, trial),
            sticks: trial.shift.sticks,
            keeps,
            awake: trial.awake.as_ref().map(|awake| &awake.facets[..]),
        };
        let mut force = &mut trial.cells.force[first_cell..];
        let mut cells = &mut trial.cells.stiffness[first_cell * CELL..];
        let mut active = &mut trial.cells.active[first_cell..];
        let mut changed = &mut trial.cells.changed[first_cell..];
        let points = 4 * GROUP;
        let per_point = trial
            .joints
            .history
            .chunks_mut(points)
            .zip(trial.joints.energy.chunks_mut(points))
            .zip(trial.joints.status.chunks_mut(points))
            .zip(trial.joints.pairs.chunks_mut(points))
            .zip(trial.joints.gaps.chunks_mut(points))
            .zip(trial.cells.held.joints.chunks_mut(GROUP))
            .zip(trial.joints.anchors.chunks(points))
            .zip(trial.shift.traction.chunks(points))
            .zip(trial.shift.bounding.chunks(points))
            .zip(trial.shift.branches.now.chunks_mut(points))
            .zip(trial.shift.branches.held.chunks(points));
        let mut groups = Vec::with_capacity(n.div_ceil(points));
        for per_point in per_point {
            let (rest, held) = per_point;
            let (rest, loose) = rest;
            let (
                (((((((history, energy), status), pairs), gaps), joints), anchors), last),
                bounding,
            ) = rest;
            let first = groups.len() * GROUP;
            let facets = first..first + history.len() / 4;
            let count = self.candidates.range(facets.end - 1).end
                - self.candidates.range(facets.start).start;
            let (f, f_rest) = force.split_at_mut(count);
            let (c, c_rest) = cells.split_at_mut(count * CELL);
            let (a, a_rest) = active.split_at_mut(count);
            let (w, w_rest) = changed.split_at_mut(count);
            (force, cells, active, changed) = (f_rest, c_rest, a_rest, w_rest);
            groups.push(Group {
                first,
                force: f,
                cells: c,
                active: a,
                changed: w,
                history,
                energy,
                status,
                pairs,
                gaps,
                joints,
                anchors,
                last,
                bounding,
                loose,
                held,
            });
        }
        // Functions inlined into it are compiled once for each vector width, and the widest available one is used.
        // Operations and their order are the same, and so are all bits of the results.
        groups
            .into_par_iter()
            .for_each(|group| pulp::Arch::new().dispatch(Work { seen: &seen, group }));
    }

    /// Kinematics of the four points of a facet, computed together for points that stay on their master facets. The
    /// others are computed alone by the caller.
    #[inline(always)]
    fn four(
        &self,
        f: usize,
        slave: &[[f64; 3]; 4],
        x: &[[f64; 3]],
        pairs: &[PointPair],
        anchors: &[PointPair],
    ) -> FourSeen {
        let origin = slave[0];
        let mut placed = FourPlaced::default();
        let mut any = false;
        for p in 0..4 {
            let Some(facet) = pairs[p].facet else {
                continue;
            };
            // A point that has changed its facet in this increment keeps its anchor on the former one.
            let anchor = match anchors[p].facet {
                Some(before) if before == facet => anchors[p].xi,
                Some(_) => continue,
                None => pairs[p].xi,
            };
            let master = self.master.corners(facet as usize, x);
            placed.place(p, &origin, &master, pairs[p].xi, anchor);
            any = true;
        }
        if !any {
            return FourSeen::default();
        }
        let (mut local, mut weights) = ([[0.0; 3]; 4], [Lanes::default(); 4]);
        for a in 0..4 {
            for i in 0..3 {
                local[a][i] = slave[a][i] - origin[i];
            }
            for p in 0..4 {
                weights[a].0[p] = self.points[4 * f + p].weights[a];
            }
        }
        FourSeen::new(&local, &weights, &placed)
    }

    /// Kinematics of a point, from the four computed together or alone. None without a foot or a cell.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "inlined in the hot loop; a struct of references would be built for each point"
    )]
    fn sight(
        &self,
        at: usize,
        four: &FourSeen,
        slave: &[[f64; 3]; 4],
        committed: PointPair,
        pair: PointPair,
        x: &[[f64; 3]],
    ) -> Option<Sight> {
        let facet = pair.facet?;
        let candidates = self.candidates.of(at / 4);
        let cell = candidates.iter().position(|&m| m == facet)?;
        if four.seen[at % 4] {
            return Some(Sight::of(cell, four, at % 4));
        }
        let (_, kin) = self.see(at, slave, committed, pair, x)?;
        Some(Sight::new(cell, &kin))
    }
}

/// Task for one group.
struct Work<'a, 'b> {
    seen: &'a Seen<'a>,
    group: Group<'b>,
}

impl pulp::WithSimd for Work<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for k in 0..self.group.history.len() / 4 {
            let f = self.group.first + k;
            if self.seen.awake.is_some_and(|awake| !awake[f]) {
                continue;
            }
            let law = self.seen.contact.law_of[f];
            // One dispatch per facet.
            for_law!(&self.seen.model.contact.laws[law as usize], law => {
                facet(simd, self.seen, &mut self.group, k, law);
            });
        }
    }
}

/// Evaluates facet `k` of a group.
#[inline(always)]
#[expect(
    clippy::too_many_lines,
    reason = "the four points of a facet share their arrays; compiled as one loop for each vector width"
)]
fn facet<S: Simd, L: JointLaw + ?Sized>(
    simd: S,
    seen: &Seen,
    group: &mut Group,
    k: usize,
    law: &L,
) {
    let &Seen {
        contact,
        state,
        x,
        setting,
        ..
    } = seen;
    let f = group.first + k;
    let first_cell = contact.candidates.range(group.first).start;
    let range = contact.candidates.range(f);
    let range = range.start - first_cell..range.end - first_cell;
    let forces = &mut group.force[range.clone()];
    forces.fill([[0.0; 3]; 8]);
    let active = &mut group.active[range.clone()];
    let changed = &mut group.changed[range.clone()];
    let cells = &mut group.cells[range.start * CELL..range.end * CELL];
    let slave = contact.slave.corners(f, x);
    let four = contact.four(
        f,
        &slave,
        x,
        &group.pairs[4 * k..4 * k + 4],
        &group.anchors[4 * k..4 * k + 4],
    );
    let mut before = 0_u64;
    if setting.tangent {
        before = bits(active);
        active.fill(false);
    }
    // Stiffness of each point and the index of its cell among those of the facet (shifted penalty).
    let (mut parts, mut count) = ([(0, Symmetric::default()); 4], 0);
    // The same at the points' poses, used if all points are close to them.
    let (mut posed, mut joint) = ([Symmetric::default(); 4], Joint::default());
    joint.held = seen.keeps;
    for p in 0..4 {
        let at = 4 * k + p;
        let point = &contact.points[4 * f + p];
        let old = &state.interface[4 * f + p];
        if contact.is_image(4 * f + p) {
            group.history[at] = *old;
            group.energy[at] = [0.0; 2];
            group.status[at] = PointStatus::Stick;
            continue;
        }
        let committed = group.anchors[at];
        let pair = group.pairs[at];
        let sight = contact.sight(4 * f + p, &four, &slave, committed, pair, x);
        let Some(sight) = sight else {
            group.pairs[at] = PointPair::default();
            group.history[at] = law.lost(old);
            // The stored energy of the point is dissipated.
            group.energy[at] = [0.0, law.free_energy(old) * point.area];
            group.status[at] = PointStatus::Open;
            group.loose[at] = [false, false, true];
            continue;
        };
        let pair = PointPair {
            xi: sight.xi,
            ..pair
        };
        group.pairs[at] = pair;
        group.gaps[at] = sight.gap;
        let crossed = committed.facet.is_some() && committed.facet != pair.facet;
        let carried;
        let old = if crossed {
            carried = contact.carried(old, committed, pair, &sight.axes(), x);
            &carried
        } else {
            old
        };
        let gap = [
            contact.opening(4 * f + p, sight.gap),
            old.slip[0] + sight.slip[0],
            old.slip[1] + sight.slip[1],
        ];
        let last = &group.last[at];
        let mut stick = law.stiffness();
        let mut response = if setting.shifted {
            let shift = Shift {
                stiffness: contact.shifted_stiffness(f, law, last, old, seen.soft),
                traction: *last,
                bounding: group.bounding[at],
            };
            stick = [0, 1].map(|i| stick[i].min(shift.stiffness[i]));
            law.update_shifted(gap, old, &shift)
        } else {
            law.update(gap, old)
        };
        if seen.sticks && response.status == PointStatus::Slip {
            for i in 1..3 {
                for j in 0..3 {
                    response.tangent[(i, j)] = if i == j { stick[1] } else { 0.0 };
                }
            }
        }
        if setting.shifted {
            let loose = response.flat_branches(old);
            group.loose[at] = loose;
            response.hold(group.held[at], loose, stick[0]);
        }
        sight.add_force(&response.traction, point.area, &mut forces[sight.cell]);
        if setting.tangent && !setting.shifted {
            let to = &mut cells[sight.cell * CELL..(sight.cell + 1) * CELL];
            if !active[sight.cell] {
                to.fill(0.0);
                active[sight.cell] = true;
            }
            // Computed alone again, because the exact stiffness needs the derivatives of the frame.
            if let Some((_, kin)) = contact.see(4 * f + p, &slave, committed, pair, x) {
                kin.add_exact_stiffness(&response.traction, &response.tangent, point.area, to);
            }
        } else if setting.tangent {
            let k = &response.tangent;
            let k = [k[(0, 0)], k[(1, 1)], k[(1, 2)], k[(2, 2)]];
            let part = Symmetric::new(sight.weights, &sight.frame, k, point.area);
            parts[count] = (sight.cell, part);
            if joint.held {
                let pose = &state.poses.points[4 * f + p];
                joint.held = pose.stands_for(&pair, &sight);
                joint.seen |= 1 << p;
                joint.k[p] = k;
                posed[count] = pose.stiffness(&point.weights, k, point.area);
            }
            count += 1;
        }
        group.history[at] = response.history;
        group.energy[at] = [
            response.elastic_energy * point.area,
            response.dissipation * point.area,
        ];
        group.status[at] = response.status;
    }
    if setting.tangent && joint.held {
        if group.joints[k] == joint {
            for (cell, _) in &parts[..count] {
                active[*cell] = true;
            }
            if active.len() > 64 || bits(active) != before {
                changed.fill(true);
            }
            return;
        }
        for (part, posed) in parts[..count].iter_mut().zip(&posed) {
            part.1 = *posed;
        }
    }
    if setting.tangent {
        group.joints[k] = joint;
        changed.fill(true);
    }
    write_cells(simd, &parts[..count], active, cells);
}

/// Sums the stiffness of the points of each cell into it, and marks these cells.
#[inline(always)]
pub(super) fn write_cells<S: Simd>(
    simd: S,
    parts: &[(usize, Symmetric)],
    active: &mut [bool],
    cells: &mut [f64],
) {
    for first in 0..parts.len() {
        let cell = parts[first].0;
        if active[cell] {
            continue;
        }
        active[cell] = true;
        let (mut together, mut n) = ([Symmetric::default(); 4], 0);
        for (_, part) in parts[first..].iter().filter(|(c, _)| *c == cell) {
            together[n] = *part;
            n += 1;
        }
        let to = &mut cells[cell * CELL..(cell + 1) * CELL];
        write_symmetric(simd, &together[..n], to);
    }
}

/// One bit for each of the first 64.
#[inline(always)]
fn bits(active: &[bool]) -> u64 {
    let set = active.iter().take(64).enumerate();
    set.fold(0, |bits, (i, active)| bits | u64::from(*active) << i)
}
