//! Settles traction patterns without nodal forces at the end of an increment (docs/theory/equilibrium.md, eq. 10; see
//! `assembly::traction_patterns`).

use serde::{Deserialize, Serialize};

use super::newton::{Newton, timed};
use super::outcome::{Problem, Rejection, Report};
use crate::assembly::Evaluation;

/// Largest change of the work of sliding points by unsettled patterns, over the work that the increment turns over.
const PATTERNS: f64 = 5e-3;

/// Most iterations for balance with settled tractions.
const PATIENCE: usize = 10;

/// Increments in which patterns are not settled: the next 1, 2, 4 … after no balance was found with them.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::solve) struct Pause {
    left: usize,
    next: usize,
}

impl Newton<'_> {
    /// Settles the patterns of an increment in balance and balances it again. Stiff penalties may ask for patterns
    /// that find no balance; the increment then stays as it was.
    ///
    /// # Errors
    /// A local failure of a law where it succeeded before.
    pub(in crate::solve) fn settle(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
        report: Report,
    ) -> Result<Report, Rejection> {
        if self.pause.left > 0 {
            self.pause.left -= 1;
            return Ok(report);
        }
        let way: Vec<f64> = self.q.iter().zip(&at.state.q).map(|(q, s)| q - s).collect();
        let [_, turned] = self.works(at.system, at.state, at.trial, &way);
        let model = self.model;
        let settled = timed(&mut self.clock.contact, || {
            at.system
                .settled_tractions(model, at.state, at.trial, &way, PATTERNS * turned)
        });
        let Some(settled) = settled else {
            return Ok(report);
        };
        let (kept, q) = (at.trial.without_stiffness(), self.q.clone());
        at.trial.take_tractions(settled);
        // The balanced iterate counts as the first one.
        let iterations = 1..1 + PATIENCE;
        let again = self.equilibrate(at, setting, iterations);
        if let Ok(report) = again {
            self.pause = Pause::default();
            return Ok(report);
        }
        let next = (2 * self.pause.next).max(1);
        self.pause = Pause { left: next, next };
        at.trial.go_back(kept);
        self.load_to(report.load_factor, at.system, at.trial);
        self.q = q;
        self.evaluate(at, setting)?;
        Ok(Report {
            iterations: at.solves.count,
            ..report
        })
    }
}
