//! Nonlinear elimination: what is out of balance in few places is balanced there first.
//!
//! Where a crack runs or a unit comes loose, most of the out-of-balance force r of an iterate sits at few nodes, and the
//! next solves of the whole would be spent on them. A region Ω is taken around such nodes, and
//!
//! ```text
//! K_ΩΩ d = −r_Ω,   q_Ω ← q_Ω + η d
//! ```
//!
//! repeated with everything else where it is, at the cost of Ω alone: only cells that touch it are evaluated. The next
//! solve of the whole starts from there (Lanzkron, Rose and Wilkes, SIAM J. Sci. Comput. 17, 1996; Cai and Li, 33, 2011).
//! The equations, and when they are in balance, are those of the whole: nothing changes but the way there.

use super::line_search::{LineSearch, dot};
use super::newton::{Newton, along, timed};
use super::outcome::Refusal;
use crate::assembly::{Evaluation, Solids, System, Trial};
use crate::linear::Region;
use crate::model::scene::Fidelity;
use crate::state::State;

/// Part of the sum of squares of the out-of-balance forces that is found at few nodes.
const SHARE: f64 = 0.8;
/// Few nodes: one of so many.
const FEW: usize = 50;
/// Rings of neighbours around them: where they push against the rest, they do so from some way off.
const RINGS: usize = 3;
/// The region is one node of so many, at most: otherwise it is hardly cheaper than the whole.
const PART: usize = 6;
/// Most solves of a region before the next one of the whole.
const SOLVES: usize = 6;
/// Part of what was out of balance outside below which the region is no longer what counts.
const ENOUGH: f64 = 0.5;

impl Newton<'_> {
    /// Balances the region in which the out-of-balance forces are concentrated, if they are. True if something moved:
    /// forces and stiffness are then those of all equations at `self.q`, as they were before. `scale`: that of
    /// the tolerance [N].
    ///
    /// # Errors
    /// The law that gave no answer.
    pub(in crate::solve) fn eliminate(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        scale: f64,
    ) -> Result<bool, Refusal> {
        let Some(region) = self.region(system, setting) else {
            return Ok(false);
        };
        let equations = region.equations().iter();
        let slots = equations.map(|&e| self.equations.slot_of[e as usize]);
        system.watch(trial, slots);
        let enough = self.enough(&region, scale);
        let solves = self.balance(system, state, trial, setting, region, enough);
        trial.awake = None;
        solves.map(|solves| solves > 0)
    }

    /// Where the out-of-balance forces are concentrated; none if they are not, or where regions are not solved.
    fn region(&mut self, system: &System, setting: Evaluation) -> Option<Region> {
        let secant = matches!(setting.solids, Solids::Secant | Solids::Softened);
        let applies = self.model.fidelity == Fidelity::Auto
            && secant
            && self.motion.is_none()
            && self.dashpots.is_none()
            && system.general.is_absent()
            && !system.pattern_changed();
        let pattern = self.linear.as_ref().filter(|_| applies)?.pattern();
        let nodes = pattern.n_groups();
        timed(&mut self.clock.factorise, || {
            let few = pattern.concentrated(&self.residual, SHARE, nodes / FEW)?;
            let inside = pattern.around(few, RINGS, nodes / PART)?;
            // What cannot be analysed is left to the whole.
            Region::new(pattern, &inside).ok()
        })
    }

    /// Out-of-balance force of a region below which it is left [N].
    fn enough(&self, region: &Region, scale: f64) -> f64 {
        let outside = dot(&self.residual, &self.residual) - region.square(&self.residual);
        (ENOUGH * outside.max(0.0).sqrt()).max(scale * self.step.tolerance.residual)
    }

    /// Solves the region until no more than `enough` is out of balance there [N]. Returns the number of solves.
    fn balance(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        mut region: Region,
        enough: f64,
    ) -> Result<usize, Refusal> {
        for solves in 0..SOLVES {
            if region.square(&self.residual).sqrt() <= enough {
                return Ok(solves);
            }
            timed(&mut self.clock.assembly, || {
                system.refill(trial, &mut self.filled, &mut self.values);
            });
            let direction = timed(&mut self.clock.solve, || {
                region.direction(&self.values, &self.residual)
            });
            // What cannot be solved by itself is left to the whole.
            let Ok(direction) = direction else {
                return Ok(solves);
            };
            self.clock.local_solves += 1;
            let slot = |e: &u32| self.equations.slot_of[*e as usize] as usize;
            let slots: Vec<usize> = region.equations().iter().map(slot).collect();
            let origin: Vec<f64> = slots.iter().map(|&slot| self.q[slot]).collect();
            LineSearch::new(region.dot(&direction, &self.residual)).run(|eta| {
                for ((&slot, from), d) in slots.iter().zip(&origin).zip(&direction) {
                    self.q[slot] = from + eta * d;
                }
                self.evaluate(system, state, trial, along(setting))?;
                Ok(region.dot(&direction, &self.residual))
            })?;
            trial.keep_tractions();
            self.evaluate(system, state, trial, setting)?;
        }
        Ok(SOLVES)
    }
}
