//! Search direction of an iterate: assembly, ordering, factorisation and solution of the linear equations.

use super::convergence::largest;
use super::newton::{Newton, timed};
use super::outcome::{Problem, Rejection};
use crate::assembly::{System, Trial};
use crate::linear::{Backend, LinearError, LinearSolver};
use crate::model::scene::{Fidelity, Tangent};
use crate::solve::stepping::path::Advance;

/// Growth of the mean nodal force since the last factorisation beyond which that factorisation does not prove
/// stability.
const GROWTH: f64 = 1.02;

/// Largest displacement by which out-of-balance forces still move a scene over the largest of the scene.
const NEAR: f64 = 5e-3;

/// Factors at hand, of a matrix of this increment.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct Factors {
    /// Mean nodal force at the factorisation [N].
    force: f64,
    /// Whether they served a later iterate.
    served: bool,
}

impl Newton<'_> {
    /// Linear solver that the tangent needs.
    pub(in crate::solve) fn backend(&self) -> Backend {
        if self.choice.tangent == Tangent::Secant {
            Backend::MixedLlt
        } else {
            Backend::MultifrontalLu
        }
    }

    /// Whether matrices of this increment needed factors in double precision.
    pub(in crate::solve) fn wanted_double(&self) -> bool {
        let linear = self.matrix.solver.as_ref();
        linear.is_some_and(LinearSolver::distrusts_single)
    }

    /// d = −K⁻¹ r.
    pub(in crate::solve) fn solve(
        &mut self,
        system: &mut System,
        trial: &mut Trial,
    ) -> Result<(), Rejection> {
        self.vectors.by_load.clear();
        self.solve_both(system, trial, &[])
    }

    /// Solves d = −K⁻¹ r and, if `by_load` is not empty, `by_load` ← K⁻¹ `by_load`, with the first guess `guess`.
    pub(in crate::solve) fn solve_both(
        &mut self,
        system: &mut System,
        trial: &mut Trial,
        guess: &[f64],
    ) -> Result<(), Rejection> {
        self.fill(system, trial)?;
        for (d, r) in self
            .vectors
            .direction
            .iter_mut()
            .zip(&self.vectors.residual)
        {
            *d = -r;
        }
        for (d, pull) in self
            .vectors
            .direction
            .iter_mut()
            .zip(self.vectors.pull.drain(..))
        {
            *d += pull;
        }
        // Both right-hand sides are solved together, while each part of the factors is in the cache.
        let solved = if system.rigid.is_empty() {
            let n = self.vectors.direction.len();
            let mut both = std::mem::take(&mut self.vectors.direction);
            both.extend_from_slice(&self.vectors.by_load);
            let solved = self.solve_in_place(trial, &mut both, guess);
            self.vectors.by_load.copy_from_slice(&both[n..]);
            both.truncate(n);
            self.vectors.direction = both;
            solved
        } else {
            self.solve_bodies(system, trial)
        };
        solved.map_err(|why| self.rejection(system, why))
    }

    /// The same in the unknowns of rigid bodies (docs/theory/rigid-bodies.md, eq. 4).
    fn solve_bodies(&mut self, system: &System, trial: &Trial) -> Result<(), LinearError> {
        let (dofs, equations) = (&system.dofs, &self.equations);
        let gathered = |forces: &[f64]| system.rigid.gathered(dofs, equations, forces);
        let mut both = gathered(&self.vectors.direction);
        let n = both.len();
        let loads = !self.vectors.by_load.is_empty();
        if loads {
            both.extend(gathered(&self.vectors.by_load));
        }
        self.solve_in_place(trial, &mut both, &[])?;
        let (dofs, equations) = (&system.dofs, &self.equations);
        let scattered = |moved: &[f64]| system.rigid.scattered(dofs, equations, moved);
        self.vectors.direction = scattered(&both[..n]);
        if loads {
            self.vectors.by_load = scattered(&both[n..]);
        }
        Ok(())
    }

    /// `sides` ← K⁻¹ `sides`, for one or two right-hand sides, with factors at hand or new ones.
    fn solve_in_place(
        &mut self,
        trial: &Trial,
        sides: &mut [f64],
        guess: &[f64],
    ) -> Result<(), LinearError> {
        if self.solve_near(sides, guess)? {
            return Ok(());
        }
        self.factorise(trial)?;
        let solver = self.matrix.solver.as_mut();
        let solver = solver.ok_or(LinearError::NotFactorised)?;
        timed(&mut self.clock.solve, || solver.solve(sides)).map(drop)
    }

    /// Solves with factors of an earlier matrix of the increment, where they apply. Returns whether they served.
    fn solve_near(&mut self, sides: &mut [f64], guess: &[f64]) -> Result<bool, LinearError> {
        let applies = self.model.fidelity == Fidelity::Auto && self.motion.is_none();
        let (Some(linear), Some(factors)) = (&mut self.matrix.solver, &mut self.matrix.factors)
        else {
            return Ok(false);
        };
        if !applies {
            return Ok(false);
        }
        let served = timed(&mut self.clock.solve, || {
            linear.solve_near(&self.matrix.values, sides, guess)
        })?;
        factors.served |= served;
        Ok(served)
    }

    /// Whether the displacements by which the out-of-balance forces still move the scene are small beside its own
    /// (docs/theory/equilibrium.md, eq. 18c). The forces of slender bodies do not show it: a column bends long before
    /// the forces across it are large beside its weight.
    /// `scale`: see [`Newton::scale`] [N].
    pub(in crate::solve) fn is_near(
        &mut self,
        at: &mut Problem<'_>,
        scale: f64,
    ) -> Result<bool, Rejection> {
        let relaxes = self.dashpots.as_ref().is_some_and(|d| d.factor > 0.0);
        let prescribed = self.step.drives() || at.attempt.advance != Advance::Load;
        // Without load all displacements are roundings.
        let unloaded = scale <= self.scales.least;
        if self.motion.is_some() || relaxes || prescribed || unloaded {
            return Ok(true);
        }
        if self.matrix.factors.is_none() {
            // A start that is accepted without a solve.
            self.fill(at.system, at.trial)?;
            let factorised = self.factorise(at.trial);
            factorised.map_err(|why| self.rejection(at.system, why))?;
            at.solves.one_more();
        }
        let Some(linear) = &mut self.matrix.solver else {
            return Ok(true);
        };
        let rigid = &at.system.rigid;
        let mut by = if rigid.is_empty() {
            self.vectors.residual.clone()
        } else {
            rigid.gathered(&at.system.dofs, &self.equations, &self.vectors.residual)
        };
        let estimated = timed(&mut self.clock.solve, || linear.estimate(&mut by));
        estimated.map_err(|why| self.rejection(at.system, why))?;
        let slots = self.equations.slot_of.iter();
        let moved = slots.map(|&slot| self.q[slot as usize].abs());
        Ok(largest(&by).0 <= NEAR * moved.fold(0.0, f64::max))
    }

    /// Proves that the matrix at the end of an increment is positive definite. Only a factorisation detects loss of
    /// stability, such as the buckling of a wall. If the last one was made at smaller forces, or if the step ends
    /// here, the matrix is factorised once more.
    pub(in crate::solve) fn prove(
        &mut self,
        system: &mut System,
        trial: &mut Trial,
        ends: bool,
    ) -> Result<(), Rejection> {
        // Under loads alone every factorisation may have been made at smaller forces.
        let loaded = !self.step.prescribes() && self.motion.is_none();
        let open = |factors: Factors| {
            let grew = trial.mean_nodal_force > GROWTH * factors.force;
            (factors.served && ends) || ((factors.served || loaded) && grew)
        };
        if self.matrix.factors.is_some_and(open) {
            self.fill(system, trial)?;
            let proven = self.factorise(trial);
            proven.map_err(|why| self.rejection(system, why))?;
        }
        Ok(())
    }

    /// Orders the matrix if its pattern is new, and assembles its values.
    fn fill(&mut self, system: &mut System, trial: &mut Trial) -> Result<(), Rejection> {
        let backend = self.backend();
        if self.matrix.solver.is_none() || system.pattern_changed() {
            let (gather, mut linear) = timed(&mut self.clock.factorise, || {
                system.analyse(&self.equations, backend)
            })
            .map_err(|why| Rejection::Linear { why, dof: None })?;
            self.matrix.values = vec![0.0; gather];
            self.matrix.filled = None;
            linear.trust_single(!self.matrix.wants_double);
            self.matrix.solver = Some(linear);
            self.matrix.factors = None;
        }
        timed(&mut self.clock.assembly, || {
            system.refill(trial, &mut self.matrix.filled, &mut self.matrix.values);
            if let Some(motion) = &self.motion {
                self.matrix.filled = None;
                system.add_mass(
                    &self.equations,
                    motion.mass_factor(),
                    &mut self.matrix.values,
                );
            }
            if let Some(dashpots) = &self.dashpots {
                self.matrix.filled = None;
                dashpots.add_to(system, &self.equations, &mut self.matrix.values);
            }
        });
        Ok(())
    }

    /// Factorises the present matrix.
    fn factorise(&mut self, trial: &Trial) -> Result<(), LinearError> {
        let linear = self
            .matrix
            .solver
            .as_mut()
            .ok_or(LinearError::NotFactorised)?;
        self.clock.factorisations += 1;
        self.matrix.factors = None;
        let stats = timed(&mut self.clock.factorise, || {
            linear.factorise(&self.matrix.values)
        })?;
        self.clock.reused += stats.reused;
        self.matrix.factors = Some(Factors {
            force: trial.mean_nodal_force,
            served: false,
        });
        Ok(())
    }

    /// Rejection for linear equations without a solution, with the node and direction of the equation.
    fn rejection(&self, system: &System, why: LinearError) -> Rejection {
        let equation = match why {
            LinearError::Singular { equation }
            | LinearError::NotPositiveDefinite { equation }
            | LinearError::NotFinite { equation } => Some(equation),
            _ => None,
        };
        let dof = equation.map(|e| system.node_of_equation(&self.equations, e));
        // A beam that moves no free node has none.
        let dof = dof.filter(|(node, _)| *node < system.dofs.slot.len());
        Rejection::Linear { why, dof }
    }

    /// Whether the direction moves a node farther than the search reach of contact.
    pub(in crate::solve) fn flies(&self, system: &System) -> bool {
        largest(&self.vectors.direction).0 > system.contact.reach()
    }
}
