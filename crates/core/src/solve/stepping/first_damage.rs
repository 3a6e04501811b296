//! Notes the first damage of a run at each commit.

use super::joint_damage::joint_damage;
use super::run::Run;
use crate::model::Model;
use crate::state::{CRACKED, CRUSHED, FirstDamage, HistoryRow, Onset, State};
use wythe_contact::JointLaw;

impl Run<'_> {
    /// Notes damage that began in the last commit, with the displacement and force of its row.
    pub(in crate::solve) fn note_first_damage(&mut self, row: &HistoryRow) {
        let first = &mut self.summary.first_damage;
        if !first.is_complete() {
            note(first, self.model, &self.state, row);
        }
    }
}

fn note(first: &mut FirstDamage, model: &Model, state: &State, row: &HistoryRow) {
    let onset = |place: usize| Onset {
        increment: row.increment,
        step: row.step,
        displacement_mm: row.displacement_mm,
        force_kN: row.force_kN,
        load_factor: row.load_factor,
        place: place as u32,
    };
    // The damage of dry joints is 1 from the start, so that the largest damage of the row decides nothing.
    if first.joint.is_none() && row.max_interface_damage > 0.0 {
        let bonded = |p: usize| {
            let law = model.contact.slave_law[p / 4];
            !model.contact.laws[usize::from(law)].is_dry()
        };
        let points = joint_damage(model, state).filter(|(p, _)| bonded(*p));
        first.joint = most(points, 0.0).map(onset);
    }
    let solids = || state.material.iter().enumerate();
    if first.crack.is_none() && row.max_tensile_damage > CRACKED {
        let damage = solids().map(|(i, h)| (i / 8, h.tensile_damage));
        first.crack = most(damage, CRACKED).map(onset);
    }
    if first.crush.is_none() && row.max_compressive_damage > CRUSHED {
        let damage = solids().map(|(i, h)| (i / 8, h.compressive_damage));
        first.crush = most(damage, CRUSHED).map(onset);
    }
}

/// Place of the largest damage above a limit; the first of equal ones.
fn most(damage: impl Iterator<Item = (usize, f64)>, limit: f64) -> Option<usize> {
    let mut best = (None, limit);
    for (place, damage) in damage {
        if damage > best.1 {
            best = (Some(place), damage);
        }
    }
    best.0
}
