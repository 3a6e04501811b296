//! Forces and stiffness of touches.

use rayon::prelude::*;
use wythe_contact::stencil::PointStiffness;
use wythe_contact::{InterfaceHistory, PointStatus, Shift, write_stiffness};

use super::General;
use super::live::{Live, Sight};
use crate::assembly::numerical_stiffness::{FIRM, WELL_WITHIN};
use crate::assembly::pattern::CELL;
use crate::assembly::{Evaluation, Trial};
use crate::state::Touch;

/// Contribution of a touch to its cell.
struct Share {
    sight: Sight,
    response: wythe_contact::InterfaceResponse,
}

/// Factors of the numerical stiffness.
#[derive(Clone, Copy)]
struct Softness {
    stiffening: f64,
    inertia: f64,
    sticks: bool,
}

impl General {
    /// Evaluates forces, and stiffness where the setting asks for it, of all touches. Their cells begin at
    /// `first_cell`.
    pub fn evaluate(&self, trial: &mut Trial, setting: Evaluation, first_cell: usize) {
        if self.cells.is_empty() {
            return;
        }
        let count = self.cells.len();
        let force = &mut trial.cells.force[first_cell..first_cell + count];
        force.fill([[0.0; 3]; 8]);
        let soft = Softness {
            stiffening: trial.shift.stiffening,
            inertia: trial.inertia,
            sticks: trial.shift.sticks,
        };
        let (x0, x) = (&trial.x_start, &trial.x);
        let shares: Vec<Option<Share>> = (trial.general.touches.par_iter_mut())
            .with_min_len(32)
            .map(|one| self.answer(one, [x0, x], setting, soft))
            .collect();
        for (one, share) in trial.general.touches.iter().zip(&shares) {
            let Some(Share { sight, response }) = share else {
                continue;
            };
            let Ok(cell) = self.cells.binary_search(&one.cell) else {
                continue;
            };
            let area = one.touch.area;
            let traction = sight.frame[0] * response.traction[0]
                + sight.frame[1] * response.traction[1]
                + sight.frame[2] * response.traction[2];
            for (f, w) in force[cell].iter_mut().zip(one.in_cell(&sight.weights)) {
                for i in 0..3 {
                    f[i] += w * traction[i] * area;
                }
            }
        }
        if setting.tangent {
            self.sum_stiffness(trial, &shares, setting, first_cell);
        }
    }

    /// Sums the stiffness of all touches into their cells.
    fn sum_stiffness(
        &self,
        trial: &mut Trial,
        shares: &[Option<Share>],
        setting: Evaluation,
        first_cell: usize,
    ) {
        let count = self.cells.len();
        let cells = &mut trial.cells.stiffness[first_cell * CELL..(first_cell + count) * CELL];
        let active = &mut trial.cells.active[first_cell..first_cell + count];
        active.fill(false);
        trial.cells.changed[first_cell..first_cell + count].fill(true);
        let mut of_cell: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (t, (one, share)) in trial.general.touches.iter().zip(shares).enumerate() {
            let stiff = share
                .as_ref()
                .is_some_and(|s| s.response.tangent != nalgebra::Matrix3::zeros());
            if let (true, Ok(cell)) = (stiff, self.cells.binary_search(&one.cell)) {
                of_cell[cell].push(t);
            }
        }
        let touches = &trial.general.touches;
        (cells.par_chunks_mut(CELL).zip(active).zip(of_cell))
            .filter(|(_, of)| !of.is_empty())
            .for_each(|((cell, active), of)| {
                *active = true;
                let points: Vec<PointStiffness> = (of.iter())
                    .filter_map(|&t| point_stiffness(&touches[t], shares[t].as_ref()?, setting))
                    .collect();
                write_stiffness(&points, cell);
                if setting.shifted {
                    return;
                }
                for &t in &of {
                    let Some(Share { sight, response }) = &shares[t] else {
                        continue;
                    };
                    if let Some(kin) = &sight.exact {
                        let (traction, tangent) = (&response.traction, &response.tangent);
                        touches[t].add_exact(kin, traction, tangent, cell);
                    }
                }
            });
    }

    /// Response of the law to one touch.
    fn answer(
        &self,
        one: &mut Live,
        [x0, x]: [&[[f64; 3]]; 2],
        setting: Evaluation,
        soft: Softness,
    ) -> Option<Share> {
        let Some(sight) = one.see(self, x) else {
            let freed = one.law.free_energy(&one.old) * one.touch.area;
            one.touch.history = InterfaceHistory {
                damage: 1.0,
                ..InterfaceHistory::default()
            };
            one.energy = [0.0, freed];
            one.status = PointStatus::Open;
            return None;
        };
        let (law, area) = (one.law, one.touch.area);
        let old = one.carried(self, &sight.frame, x);
        let gap = [
            sight.gap - one.touch.offset,
            old.slip[0] + sight.slip[0],
            old.slip[1] + sight.slip[1],
        ];
        let mut stick = law.shear_stiffness;
        let mut response = if setting.shifted {
            let firm = law.utilisation(&one.last, 1.0) < WELL_WITHIN;
            let factor = soft.stiffening.max(if firm { FIRM } else { 1.0 });
            let least = soft.inertia * one.areal_mass;
            let shift = Shift {
                stiffness: one.numerical.map(|k| (k * factor).max(least)),
                traction: one.last,
                bounding: one.bounding,
            };
            stick = stick.min(shift.stiffness[1]);
            law.update_shifted(gap, &old, &shift)
        } else {
            law.update(gap, &old)
        };
        if soft.sticks && response.status == PointStatus::Slip {
            for i in 1..3 {
                for j in 0..3 {
                    response.tangent[(i, j)] = if i == j { stick } else { 0.0 };
                }
            }
        }
        let way = self.way(one.touch.facets, [x0, x]);
        one.note_approach(&sight, &response.traction, &way);
        if one.turns && setting.shifted && response.status == PointStatus::Slip {
            // The touch goes from one shear limit to the other and back. It gets the secant of the friction.
            let across = response.tangent[(1, 1)] + response.tangent[(2, 2)];
            for i in 1..3 {
                for j in 1..3 {
                    response.tangent[(i, j)] = if i == j { across } else { 0.0 };
                }
            }
        }
        one.touch.at = sight.at;
        one.touch.history = response.history;
        one.energy = [response.elastic_energy * area, response.dissipation * area];
        one.status = response.status;
        Some(Share { sight, response })
    }

    /// Movement of the nodes of two facets [mm].
    pub(super) fn way(&self, facets: [u32; 2], [x0, x]: [&[[f64; 3]]; 2]) -> [[f64; 3]; 8] {
        let mut way = [[0.0; 3]; 8];
        let nodes = facets.map(|f| self.faces.surface.facets[f as usize]);
        for (u, &n) in way.iter_mut().zip(nodes.iter().flatten()) {
            let (from, to) = (x0[n as usize], x[n as usize]);
            *u = [0, 1, 2].map(|i| to[i] - from[i]);
        }
        way
    }

    /// Touches after a commit.
    pub fn committed(&self, trial: &Trial) -> Vec<Touch> {
        let mut touches: Vec<Touch> = trial
            .general
            .touches
            .iter()
            .filter_map(Live::committed)
            .collect();
        touches.sort_by_key(Touch::key);
        touches.dedup_by_key(|touch| touch.key());
        touches
    }

    /// Term of the trapezoidal rule for bodies that meet or part in the increment that `trial` ends [N mm].
    pub fn crossing_work(&self, trial: &Trial) -> f64 {
        let live: f64 = trial.general.touches.iter().map(Live::crossing_work).sum();
        live + trial.general.loss[1]
    }
}

/// Stiffness of a touch with a fixed normal. For edges the rotation of the normal is left out of the exact tangent,
/// too.
fn point_stiffness(one: &Live, share: &Share, setting: Evaluation) -> Option<PointStiffness> {
    if !setting.shifted && share.sight.exact.is_some() {
        return None;
    }
    let rotation = nalgebra::Matrix3::from_columns(&share.sight.frame);
    Some(PointStiffness {
        weights: one.in_cell(&share.sight.weights),
        block: rotation * share.response.tangent * rotation.transpose() * one.touch.area,
    })
}
