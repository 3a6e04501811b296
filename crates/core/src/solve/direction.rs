//! The direction of an iterate: its linear equations are ordered, filled, factorised and solved.

use super::balance::largest;
use super::newton::{Newton, timed};
use super::outcome::Refusal;
use crate::model::scene::Tangent;
use crate::system::linear::{Backend, LinearError, LinearSolver};
use crate::system::{System, Trial};

impl Newton<'_> {
    /// Which solver the tangents need.
    pub(super) fn backend(&self) -> Backend {
        if self.tangent == Tangent::Secant {
            Backend::MixedLlt
        } else {
            Backend::MultifrontalLu
        }
    }

    /// Whether the matrices of this increment wanted factors of double precision.
    pub(super) fn wanted_double(&self) -> bool {
        let linear = self.linear.as_ref();
        linear.is_some_and(LinearSolver::distrusts_single)
    }

    /// d = −K⁻¹ r.
    pub(super) fn solve(&mut self, system: &mut System, trial: &mut Trial) -> Result<(), Refusal> {
        self.by_load.clear();
        self.solve_both(system, trial)
    }

    /// d = −K⁻¹ r, and `by_load`, if it is not empty, ← K⁻¹ of it.
    pub(super) fn solve_both(
        &mut self,
        system: &mut System,
        trial: &mut Trial,
    ) -> Result<(), Refusal> {
        let backend = self.backend();
        let linear = match &mut self.linear {
            Some(linear) if !system.pattern_changed() => linear,
            linear => {
                let (gather, analysed) = timed(&mut self.clock.factorise, || {
                    system.analyse(&self.equations, backend)
                })
                .map_err(|why| Refusal::Linear { why, dof: None })?;
                self.values = vec![0.0; gather];
                self.filled = None;
                let linear = linear.insert(analysed);
                linear.trust_single(!self.wants_double);
                linear
            }
        };
        timed(&mut self.clock.assembly, || {
            system.refill(trial, &mut self.filled, &mut self.values);
            if let Some(motion) = &self.motion {
                self.filled = None;
                system.add_mass(&self.equations, motion.mass_factor(), &mut self.values);
            }
        });
        for (d, r) in self.direction.iter_mut().zip(&self.residual) {
            *d = -r;
        }
        for (d, pull) in self.direction.iter_mut().zip(self.pull.drain(..)) {
            *d += pull;
        }
        self.clock.factorisations += 1;
        // One behind the other: both are solved for while a part of the factors is near.
        let n = self.direction.len();
        self.direction.extend_from_slice(&self.by_load);
        let solved =
            timed(&mut self.clock.factorise, || linear.factorise(&self.values)).and_then(|stats| {
                self.clock.reused += stats.reused;
                timed(&mut self.clock.solve, || linear.solve(&mut self.direction))
            });
        self.by_load.copy_from_slice(&self.direction[n..]);
        self.direction.truncate(n);
        solved.map_err(|why| {
            let equation = match why {
                LinearError::Singular { equation }
                | LinearError::NotPositiveDefinite { equation }
                | LinearError::NotFinite { equation } => Some(equation),
                _ => None,
            };
            let dof = equation.map(|e| system.dofs.node_of(self.equations.slot_of[e] as usize));
            Refusal::Linear { why, dof }
        })?;
        Ok(())
    }

    /// Whether the direction carries something farther than a point of contact sees.
    pub(super) fn flies(&self, system: &System) -> bool {
        largest(&self.direction).0 > system.contact.reach()
    }
}
