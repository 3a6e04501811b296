//! Search for a critical state without dilatancy: sliding joints neither open nor close
//! (docs/theory/limit-analysis.md, eqs 5 and 7).

use super::program::Solution;
use super::scene::RigidScene;
use super::{LimitError, LimitSettings, MOST_PROGRAMS, Progress};

/// Slip allowed in the first program, over the largest relative velocity of the associated mechanism: at all corners, and
/// in a second search at those of upright joints alone. The first search has the least normal forces, the second one
/// those of head joints without pressure, which weight alone does not press.
const FIRST: [f64; 2] = [3.0, 30.0];
/// Normals of upright joints have a smaller vertical part.
const UPRIGHT: f64 = 0.5;
/// Most programs of the first search, with the associated one.
const MOST_OF_FIRST: usize = 40;
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
/// Velocity at which corners close, over the largest one, below which bodies do not pass through each other.
const CLOSED: f64 = 0.02;
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
    /// by these velocities, from two starts.
    ///
    /// # Errors
    /// A program has no solution.
    pub fn without_dilatancy(
        scene: &RigidScene<'_>,
        associated: Solution,
        settings: &LimitSettings,
        tell: &mut dyn FnMut(Progress),
    ) -> Result<Self, LimitError> {
        let mut search = Self::associated(associated.clone());
        search.converged = false;
        let mut lowest: Option<Solution> = None;
        let all = vec![FIRST[0] * associated.fastest; associated.slips.len()];
        let upright = scene.unknowns.corners.iter().map(|orbit| {
            let [normal, ..] = scene.joints[scene.corners[orbit.corner].joint].frame;
            let is_upright = normal.z.abs() < UPRIGHT;
            f64::from(u8::from(is_upright)) * FIRST[1] * associated.fastest
        });
        let upright: Vec<f64> = upright.collect();
        let mixed = upright.iter().any(|s| *s > 0.0) && upright.contains(&0.0);
        search.from((scene, settings), all, MOST_OF_FIRST, &mut lowest, tell)?;
        if mixed {
            let most = search.programs + MOST_PROGRAMS - MOST_OF_FIRST;
            search.from((scene, settings), upright, most, &mut lowest, tell)?;
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

    /// Solves programs from these allowed slips until one is critical, or `most` programs were solved in all. Keeps the
    /// last one, and the `lowest` of those that may be the answer.
    fn from(
        &mut self,
        (scene, settings): (&RigidScene<'_>, &LimitSettings),
        mut slips: Vec<f64>,
        most: usize,
        lowest: &mut Option<Solution>,
        tell: &mut dyn FnMut(Progress),
    ) -> Result<(), LimitError> {
        let first = self.programs;
        while self.programs < most {
            let next = scene.solve(settings, &slips)?;
            self.programs += 1;
            tell(scene.progress(self.programs, next.factor));
            let many = self.programs - first >= MANY;
            let part = if many { SLOWLY } else { PART };
            for (allowed, slip) in slips.iter_mut().zip(&next.slips) {
                *allowed += part * (slip - *allowed);
            }
            let admissible = next.closing <= CLOSED;
            let settled = admissible && next.opening_work <= SETTLED;
            let before = lowest.as_ref().map_or(f64::INFINITY, |low| low.factor);
            if admissible && next.opening_work <= NEAR && next.factor < before {
                *lowest = Some(next.clone());
            }
            self.best = next;
            if settled {
                break;
            }
        }
        Ok(())
    }
}
