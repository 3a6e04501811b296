//! Stiffness for small motions about a state: the linear system of which vibrations are the solutions
//! (theory/vibration.md, eqs 1 and 2).

use super::pattern::CELL;
use super::{Evaluation, Solids, System, Trial, Turning};
use crate::material::LocalFailure;
use crate::model::ties::{Installed, TieStage};
use crate::state::State;

/// A contact point that faces a master facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion {
    /// Number of the point. `[slave facet][point]`
    pub point: usize,
    /// The master facet that it faces.
    pub facet: u32,
    /// Its normal gap [mm].
    pub gap: f64,
    /// Its area [mm²].
    pub area: f64,
}

impl System {
    /// Installs ties in a state, and leaves out in the trial those that are not there yet. `since`: empty, or of each tie.
    pub fn install_ties(&self, since: &[Installed<'_>], state: &mut State, trial: &mut Trial) {
        let stage = |since: &Installed<'_>| match since {
            Installed::Later => TieStage::Absent,
            Installed::AtRest | Installed::At(_) => TieStage::Fixed,
        };
        trial.ties.stages = since.iter().map(stage).collect();
        for (tie, since) in since.iter().enumerate() {
            if let Installed::At(u) = since {
                self.ties.install(tie, u, &mut state.ties);
            }
        }
    }

    /// Writes the stiffness about the displacements `q` to the cells of the trial: solids with the damage of the
    /// state and the stiffness of their stress, joints by `joint`, springs, ties. General contact and follower pressures
    /// have no part. The trial must have been started from the state.
    ///
    /// # Errors
    /// Number of the element and the reason, if an element is inverted.
    pub fn write_small_motion(
        &mut self,
        state: &State,
        trial: &mut Trial,
        joint: &dyn Fn(PointMotion) -> [f64; 2],
    ) -> Result<(), (usize, LocalFailure)> {
        self.search(trial, &state.q);
        let n_elements = self.bulk.elements.len();
        let n_loaded = n_elements + self.contact.cell_count() + self.general.cells().len();
        let n_sprung = n_loaded + self.springs.cells().len();
        let n_tied = n_sprung + self.ties.cells().len();
        let n_cells = n_tied + self.outside.cells().len() + self.steered_cells().len();
        trial.cells.force.resize(n_loaded, [[0.0; 3]; 8]);
        trial.cells.stiffness.resize(n_cells * CELL, 0.0);
        trial.cells.active.clear();
        trial.cells.active.resize(n_cells, false);
        trial.cells.changed.resize(n_cells, true);
        // Damage and inelastic strain of the state are held.
        let setting = Evaluation {
            dt: 0.0,
            solids: Solids::Extrapolated { ratio: 0.0 },
            shifted: false,
            tangent: true,
            turning: Turning::Ignored,
        };
        self.bulk.evaluate(state, trial, setting)?;
        self.contact.write_small_motion(trial, n_elements, joint);
        self.springs
            .write_stiffness(&mut trial.cells.stiffness[n_loaded * CELL..n_sprung * CELL]);
        trial.node_force.clear();
        trial.node_force.resize(self.bulk.reference.len(), [0.0; 3]);
        // Ties measure their work from the positions at the start, which are those of the state.
        trial.x_start.clone_from(&trial.x);
        self.ties.evaluate(state, trial);
        self.ties.write_stiffness(
            &trial.ties.segments,
            true,
            &mut trial.cells.stiffness[n_sprung * CELL..n_tied * CELL],
        );
        trial.cells.active[n_loaded..n_tied].fill(true);
        Ok(())
    }
}
