//! Nonlinear elimination: concentrated residuals are balanced in a region first.
//!
//! Where a crack runs or a unit loosens, most of the out-of-balance force r of an iterate acts at few nodes, and the
//! next global solves would serve these nodes only. A region Ω is taken around them, and
//!
//! ```text
//! K_ΩΩ d = −r_Ω,   q_Ω ← q_Ω + η d
//! ```
//!
//! is repeated with all other unknowns fixed. It costs Ω alone: only cells that touch it are evaluated. The next
//! global solve starts from there (Lanzkron, Rose and Wilkes, SIAM J. Sci. Comput. 17, 1996; Cai and Li, 33, 2011).
//! Equations and convergence criteria are those of the whole, so only the way to equilibrium changes.

use super::line_search::{LineSearch, dot};
use super::newton::{Newton, along, timed};
use super::outcome::{Problem, Rejection};
use crate::assembly::{Evaluation, Solids, System};
use crate::linear::Region;
use crate::model::scene::Fidelity;

/// Part of the sum of squared out-of-balance forces that must act at few nodes.
const SHARE: f64 = 0.8;
/// At most one in `FEW` of all nodes counts as few.
const FEW: usize = 50;
/// Rings of neighbours in the region around these nodes, so that they are not pushed against fixed nodes close by.
const RINGS: usize = 3;
/// The region has at most one in `PART` of all nodes; a larger one is hardly cheaper than the whole.
const PART: usize = 6;
/// Most solves of a region between two global solves.
const SOLVES: usize = 6;
/// The region is done when its out-of-balance force falls below this part of the force outside it.
const ENOUGH: f64 = 0.5;

impl Newton<'_> {
    /// Balances the region in which the out-of-balance forces are concentrated, if there is one. Returns true if
    /// something moved; forces and stiffness are then those of all equations at `self.q`. `scale`: scale of the
    /// tolerance [N].
    ///
    /// # Errors
    /// A local failure of a law.
    pub(in crate::solve) fn eliminate(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
        scale: f64,
    ) -> Result<bool, Rejection> {
        let Some(region) = self.region(at.system, setting) else {
            return Ok(false);
        };
        let equations = region.equations().iter();
        let slots = equations.map(|&e| self.equations.slot_of[e as usize]);
        at.system.watch(at.trial, slots);
        let enough = self.enough(&region, scale);
        let solves = self.balance(at, setting, region, enough);
        at.trial.awake = None;
        solves.map(|solves| solves > 0)
    }

    /// Region in which the out-of-balance forces are concentrated; none if they are spread, or where regions do not
    /// apply.
    fn region(&mut self, system: &System, setting: Evaluation) -> Option<Region> {
        let secant = matches!(setting.solids, Solids::Secant | Solids::Softened);
        let applies = self.model.fidelity == Fidelity::Auto
            && secant
            && self.motion.is_none()
            && self.dashpots.is_none()
            && system.general.is_absent()
            && system.rigid.is_empty()
            && !system.pattern_changed();
        let pattern = self.matrix.solver.as_ref().filter(|_| applies)?.pattern();
        let nodes = pattern.n_groups();
        timed(&mut self.clock.factorise, || {
            let few = pattern.concentrated(&self.vectors.residual, SHARE, nodes / FEW)?;
            let inside = pattern.around(few, RINGS, nodes / PART)?;
            // A region that cannot be analysed is left to the global solve.
            Region::new(pattern, &inside).ok()
        })
    }

    /// Out-of-balance force below which the region is done [N].
    fn enough(&self, region: &Region, scale: f64) -> f64 {
        let outside = dot(&self.vectors.residual, &self.vectors.residual)
            - region.square(&self.vectors.residual);
        (ENOUGH * outside.max(0.0).sqrt()).max(scale * self.step.tolerance.residual)
    }

    /// Solves the region until its out-of-balance force is at most `enough` [N]. Returns the number of solves.
    fn balance(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
        mut region: Region,
        enough: f64,
    ) -> Result<usize, Rejection> {
        for solves in 0..SOLVES {
            if region.square(&self.vectors.residual).sqrt() <= enough {
                return Ok(solves);
            }
            timed(&mut self.clock.assembly, || {
                at.system
                    .refill(at.trial, &mut self.matrix.filled, &mut self.matrix.values);
            });
            let direction = timed(&mut self.clock.solve, || {
                region.direction(&self.matrix.values, &self.vectors.residual)
            });
            // A region that cannot be solved by itself is left to the global solve.
            let Ok(direction) = direction else {
                return Ok(solves);
            };
            self.clock.local_solves += 1;
            let slot = |e: &u32| self.equations.slot_of[*e as usize] as usize;
            let slots: Vec<usize> = region.equations().iter().map(slot).collect();
            let origin: Vec<f64> = slots.iter().map(|&slot| self.q[slot]).collect();
            LineSearch::new(region.dot(&direction, &self.vectors.residual)).run(|eta| {
                for ((&slot, from), d) in slots.iter().zip(&origin).zip(&direction) {
                    self.q[slot] = from + eta * d;
                }
                self.evaluate(at, along(setting))?;
                Ok(region.dot(&direction, &self.vectors.residual))
            })?;
            at.trial.keep_tractions();
            self.evaluate(at, setting)?;
        }
        Ok(SOLVES)
    }
}
