//! Search for a critical state without dilatancy: sliding joints neither open nor close
//! (docs/theory/limit-analysis.md, eqs 5 and 7).

use super::program::Solution;
use super::scene::RigidScene;
use super::{LimitError, LimitSettings, MOST_PROGRAMS, Progress};

/// Slip allowed at all corners in the first program, over the largest relative velocity of the associated mechanism.
const FIRST: f64 = 3.0;
/// Part by which the allowed slips approach those of the last mechanism, and that after [`MANY`] programs, so that
/// mechanisms that alternate are averaged.
const PART: f64 = 0.5;
const SLOWLY: f64 = 0.2;
const MANY: usize = 16;
/// Work of pressures on joints that open or close as they slide, over that of the live loads, below which a state is
/// critical.
const SETTLED: f64 = 0.01;
/// The same of states that may be the answer.
const NEAR: f64 = 0.02;
/// The same, and relative difference of the factors, of associated solutions without dilatancy.
const SAME: f64 = 1e-6;

/// Result of a search.
pub struct Search {
    /// The state with the lowest factor among those that are critical, or the last one.
    pub best: Solution,
    /// Number of programs, the associated one included.
    pub programs: usize,
    /// Whether a critical state was found.
    pub converged: bool,
}

impl Search {
    /// The associated solution alone.
    pub fn associated(solution: Solution) -> Self {
        Self {
            best: solution,
            programs: 1,
            converged: true,
        }
    }

    /// Solves programs in which each corner may slip by an allowed velocity without opening, until the mechanism slips
    /// by these velocities. The first ones are equal and large, so that the state has the least normal forces.
    ///
    /// # Errors
    /// A program has no solution.
    pub fn without_dilatancy(
        scene: &RigidScene<'_>,
        associated: Solution,
        settings: &LimitSettings,
        tell: &mut dyn FnMut(Progress),
    ) -> Result<Self, LimitError> {
        let mut slips = vec![FIRST * associated.fastest; associated.slips.len()];
        let mut search = Self::associated(associated.clone());
        let mut lowest: Option<Solution> = None;
        search.converged = false;
        while search.programs < MOST_PROGRAMS && !search.converged {
            let next = scene.solve(settings, &slips)?;
            search.programs += 1;
            tell(scene.progress(search.programs, next.factor));
            let part = if search.programs < MANY { PART } else { SLOWLY };
            for (allowed, slip) in slips.iter_mut().zip(&next.slips) {
                *allowed += part * (slip - *allowed);
            }
            search.converged = next.opening_work <= SETTLED;
            let before = lowest.as_ref().map_or(f64::INFINITY, |low| low.factor);
            if next.opening_work <= NEAR && next.factor < before {
                lowest = Some(next.clone());
            }
            search.best = next;
        }
        if let Some(lowest) = lowest {
            search.best = lowest;
            search.converged = true;
        }
        // The associated mechanism may open no sliding joint at all, as where bodies only tip.
        let level = associated.opening_work <= SAME;
        if level && search.best.factor >= (1.0 - SAME) * associated.factor {
            search.best = associated;
            search.converged = true;
        }
        Ok(search)
    }
}
