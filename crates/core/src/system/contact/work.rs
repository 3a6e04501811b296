//! Work of points that open, close or change their facet between two commits.

use wythe_contact::{PointPair, extend};

use super::Contact;
use crate::model::Model;
use crate::solve::State;
use crate::system::Trial;

impl Contact {
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
            let point = self.position(p / 4, p % 4, x);
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
}
