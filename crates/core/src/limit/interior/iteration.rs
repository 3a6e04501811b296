//! The iteration of the homogeneous embedding.

use super::cones::{Cone, Shape};
use super::normal::{Normal, Parts};
use crate::linear::dot;

/// Most iterations.
const ITERATIONS: usize = 100;
/// Part of the way to the boundary that a step goes.
const FRACTION: f64 = 0.99;
/// Relative residual of a proof that there is no solution.
const PROOF: f64 = 1e-8;
/// Most correctors of a step, how much further each one aims, and the least product of s and z over the mean that it
/// aims at.
const CORRECTORS: usize = 4;
const FURTHER: f64 = 0.3;
const NEAR: f64 = 0.1;
/// Steps that need no corrector.
const LONG: f64 = 0.9;
/// Iterations in which the error must fall to a tenth.
const PATIENCE: usize = 30;
/// Objectives below this count as this in the relative gap.
const SMALL: f64 = 1e-3;
/// Steps below this lead nowhere.
const SHORT: f64 = 1e-4;

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Solved.
    Solved,
    /// Nothing satisfies the constraints.
    Infeasible,
    /// The objective has no bound.
    Unbounded,
    /// Rounding stopped the iteration before.
    Stalled,
}

/// A program in its scaled form, with the state of the iteration.
pub struct Iteration<'a> {
    normal: &'a mut Normal,
    cones: Vec<Cone>,
    cost: Vec<f64>,
    right: Parts,
    /// x, times τ.
    pub x: Vec<f64>,
    /// y, times τ.
    pub y: Vec<f64>,
    z: Vec<f64>,
    s: Vec<f64>,
    /// Common factor of the unknowns.
    pub tau: f64,
    kappa: f64,
}

/// A change of the state.
struct Step {
    parts: Parts,
    s: Vec<f64>,
    tau: f64,
    kappa: f64,
}

/// Residuals of the embedding.
struct Residuals {
    parts: Parts,
    objective: f64,
    /// Mean product of s and z, and of τ and κ.
    mean: f64,
}

fn most(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, v| v.abs().max(most))
}

fn add(to: &mut [f64], factor: f64, v: &[f64]) {
    to.iter_mut().zip(v).for_each(|(t, v)| *t += factor * v);
}

impl<'a> Iteration<'a> {
    /// An iteration for a program in its scaled form.
    pub fn new(normal: &'a mut Normal, cones: Vec<Cone>, cost: Vec<f64>, right: Parts) -> Self {
        Self {
            normal,
            cones,
            cost,
            right,
            x: Vec::new(),
            y: Vec::new(),
            z: Vec::new(),
            s: Vec::new(),
            tau: 1.0,
            kappa: 1.0,
        }
    }

    /// Begins at the least-squares states, moved into the cones.
    fn begin(&mut self) -> Option<()> {
        self.cones.iter_mut().for_each(Cone::reset);
        self.normal.factorise(&self.cones).then_some(())?;
        let zeros = |n: usize| vec![0.0; n];
        let forces = Parts {
            x: zeros(self.cost.len()),
            ..self.right.clone()
        };
        let forces = self.normal.solve(&forces, &self.cones)?;
        let velocities = Parts {
            x: self.cost.iter().map(|c| -c).collect(),
            y: zeros(self.right.y.len()),
            z: zeros(self.right.z.len()),
        };
        let velocities = self.normal.solve(&velocities, &self.cones)?;
        self.x = forces.x;
        self.s = forces.z.iter().map(|z| -z).collect();
        self.y = velocities.y;
        self.z = velocities.z;
        for v in [&mut self.s, &mut self.z] {
            let depth = self.cones.iter().map(|cone| cone.depth(v));
            let depth = depth.fold(f64::INFINITY, f64::min);
            let size = most(v).max(1e-3);
            if depth < 1e-2 * size {
                let shift = size - depth.min(0.0);
                self.cones.iter().for_each(|cone| v[cone.first] += shift);
            }
        }
        (self.tau, self.kappa) = (1.0, 1.0);
        Some(())
    }

    fn residuals(&self) -> Residuals {
        let mut parts = self.normal.multiply(&self.x, &self.y, &self.z);
        add(&mut parts.z, 1.0, &self.s);
        add(&mut parts.z, -self.tau, &self.right.z);
        add(&mut parts.y, -self.tau, &self.right.y);
        add(&mut parts.x, self.tau, &self.cost);
        let bound = dot(&self.right.y, &self.y) + dot(&self.right.z, &self.z);
        let mean = dot(&self.s, &self.z) + self.tau * self.kappa;
        Residuals {
            objective: dot(&self.cost, &self.x) + bound + self.kappa,
            mean: mean / (self.cones.len() + 1) as f64,
            parts,
        }
    }

    /// Step for the part `keep` of the residuals that stays, with the products of s and z that `shift` asks for.
    fn step(
        &mut self,
        residuals: &Residuals,
        keep: f64,
        shift: (Vec<f64>, f64),
        fixed: &Parts,
    ) -> Option<Step> {
        let (shift, product) = shift;
        let mut right = residuals.parts.clone();
        let solved = 1.0 - keep;
        for v in [&mut right.x, &mut right.y, &mut right.z] {
            for r in v.iter_mut() {
                *r *= -solved;
            }
        }
        add(&mut right.z, 1.0, &shift);
        let mut parts = self.normal.solve(&right, &self.cones)?;
        let value = |parts: &Parts| {
            dot(&self.cost, &parts.x) + dot(&self.right.y, &parts.y) + dot(&self.right.z, &parts.z)
        };
        let tau = (-solved * residuals.objective + product / self.tau - value(&parts))
            / (value(fixed) - self.kappa / self.tau);
        add(&mut parts.x, tau, &fixed.x);
        add(&mut parts.y, tau, &fixed.y);
        add(&mut parts.z, tau, &fixed.z);
        // Δs = −shift − W² Δz
        let mut s = parts.z.clone();
        for cone in &self.cones {
            let own = cone.of_mut(&mut s);
            cone.apply(own);
            cone.apply(own);
        }
        s.iter_mut().zip(&shift).for_each(|(s, d)| *s = -d - *s);
        let kappa = (-product - self.kappa * tau) / self.tau;
        Some(Step {
            parts,
            s,
            tau,
            kappa,
        })
    }

    /// Largest step inside of the cones, at most 1.
    fn length(&self, step: &Step) -> f64 {
        let along = |v: f64, d: f64| if d < 0.0 { -v / d } else { f64::INFINITY };
        let scalars = along(self.tau, step.tau).min(along(self.kappa, step.kappa));
        let cones = self.cones.iter().map(|cone| {
            let s = cone.step(&self.s, &step.s);
            s.min(cone.step(&self.z, &step.parts.z))
        });
        cones.fold(scalars.min(1.0), f64::min)
    }

    /// Products that the corrector asks for: s + W (λ \ (W⁻¹Δs ∘ WΔz − σμ e)).
    fn corrected(&self, step: &Step, centre: f64) -> Vec<f64> {
        let mut shift = self.s.clone();
        for cone in &self.cones {
            let copy = |v: &[f64]| {
                let mut own = [0.0; 3];
                own[..cone.rows()].copy_from_slice(cone.of(v));
                own
            };
            let rows = cone.rows();
            let (mut l, mut s, mut z) = (copy(&self.z), copy(&step.s), copy(&step.parts.z));
            cone.apply(&mut l[..rows]);
            cone.unapply(&mut s[..rows]);
            cone.apply(&mut z[..rows]);
            let mut wanted = cone.product(&s, &z);
            wanted[0] -= centre;
            let mut change = cone.quotient(&l, &wanted);
            cone.apply(&mut change[..rows]);
            add(cone.of_mut(&mut shift), 1.0, &change[..rows]);
        }
        shift
    }

    /// A step with products of s and z nearer to each other at its end, and its length, if it is longer (Gondzio 1996).
    fn centred(
        &mut self,
        residuals: &Residuals,
        step: &Step,
        length: f64,
        centre: f64,
        fixed: &Parts,
    ) -> Option<(Step, f64)> {
        let wanted = (length + FURTHER).min(1.0);
        // Change of a product that brings it into the range around the centre.
        let change = |now: f64| {
            let into = now.clamp(NEAR * centre, centre / NEAR) - now;
            into.max(-centre / NEAR)
        };
        let mut shift = vec![0.0; self.s.len()];
        for cone in self.cones.iter().filter(|cone| cone.shape == Shape::Ray) {
            let i = cone.first;
            let s = self.s[i] + wanted * step.s[i];
            let z = self.z[i] + wanted * step.parts.z[i];
            shift[i] = -change(s * z) / self.z[i];
        }
        let scalars = (self.tau + wanted * step.tau) * (self.kappa + wanted * step.kappa);
        let product = -change(scalars);
        let mut found = self.step(residuals, 1.0, (shift, product), fixed)?;
        add(&mut found.parts.x, 1.0, &step.parts.x);
        add(&mut found.parts.y, 1.0, &step.parts.y);
        add(&mut found.parts.z, 1.0, &step.parts.z);
        add(&mut found.s, 1.0, &step.s);
        found.tau += step.tau;
        found.kappa += step.kappa;
        let longer = self.length(&found);
        (longer >= length + 0.1 * FURTHER).then_some((found, longer))
    }

    fn advance(&mut self, step: &Step, length: f64) {
        add(&mut self.x, length, &step.parts.x);
        add(&mut self.y, length, &step.parts.y);
        add(&mut self.z, length, &step.parts.z);
        add(&mut self.s, length, &step.s);
        self.tau += length * step.tau;
        self.kappa += length * step.kappa;
    }

    /// One iteration: predictor and corrector with the same factors. `None`: rounding stops it.
    fn iterate(&mut self, residuals: &Residuals) -> Option<()> {
        let (s, z) = (&self.s, &self.z);
        let scaled = self.cones.iter_mut().all(|cone| cone.scale(s, z));
        (scaled && self.normal.factorise(&self.cones)).then_some(())?;
        let fixed = Parts {
            x: self.cost.iter().map(|c| -c).collect(),
            ..self.right.clone()
        };
        let fixed = self.normal.solve(&fixed, &self.cones)?;
        let product = self.tau * self.kappa;
        let guess = self.step(residuals, 0.0, (self.s.clone(), product), &fixed)?;
        let length = self.length(&guess);
        let keep = (1.0 - length).powi(3);
        let centre = keep * residuals.mean;
        let shift = self.corrected(&guess, centre);
        let product = product + guess.tau * guess.kappa - centre;
        let mut step = self.step(residuals, keep, (shift, product), &fixed)?;
        let mut length = self.length(&step);
        for _ in 0..CORRECTORS {
            if length > LONG {
                break;
            }
            let Some((better, longer)) = self.centred(residuals, &step, length, centre, &fixed)
            else {
                break;
            };
            (step, length) = (better, longer);
        }
        let length = FRACTION * length;
        if length.is_nan() || length < SHORT {
            return None;
        }
        self.advance(&step, length);
        Some(())
    }

    /// Largest of the relative residuals and the relative gap.
    fn error(&self, residuals: &Residuals) -> f64 {
        let size = |v: &[f64]| 1.0f64.max(most(v));
        let primal = most(&residuals.parts.z).max(most(&residuals.parts.y)) / self.tau;
        let primal = primal / size(&self.right.y).max(most(&self.right.z));
        let dual = most(&residuals.parts.x) / self.tau / size(&self.cost);
        let [value, bound] = self.objectives();
        let gap = (value - bound).abs() / value.abs().max(SMALL);
        primal.max(dual).max(gap)
    }

    /// Objective and its bound.
    pub fn objectives(&self) -> [f64; 2] {
        let bound = dot(&self.right.y, &self.y) + dot(&self.right.z, &self.z);
        [dot(&self.cost, &self.x) / self.tau, -bound / self.tau]
    }

    /// Whether the state proves that there is no solution.
    fn without_solution(&self) -> Option<End> {
        let bound = dot(&self.right.y, &self.y) + dot(&self.right.z, &self.z);
        let mut product = self.normal.multiply(&self.x, &self.y, &self.z);
        if bound < 0.0 && most(&product.x) <= -PROOF * bound {
            return Some(End::Infeasible);
        }
        let value = dot(&self.cost, &self.x);
        add(&mut product.z, 1.0, &self.s);
        let miss = most(&product.y).max(most(&product.z));
        (value < 0.0 && miss <= -PROOF * value).then_some(End::Unbounded)
    }

    /// Iterates to a tolerance, and returns the end and the error of the best state, which stays.
    pub fn run(&mut self, tolerance: f64) -> (End, f64) {
        if self.begin().is_none() {
            return (End::Stalled, f64::INFINITY);
        }
        let mut best = (f64::INFINITY, self.state());
        let mut errors = Vec::with_capacity(ITERATIONS);
        while errors.len() < ITERATIONS {
            let residuals = self.residuals();
            let error = self.error(&residuals);
            if error <= tolerance {
                return (End::Solved, error);
            }
            if error < best.0 {
                best = (error, self.state());
            }
            // Near a solution κ vanishes, near none τ.
            if self.tau < self.kappa
                && let Some(end) = self.without_solution()
            {
                return (end, error);
            }
            errors.push(best.0);
            let earlier = errors.len().checked_sub(PATIENCE).map(|i| errors[i]);
            let slow = earlier.is_some_and(|earlier| best.0 > 0.1 * earlier);
            if slow || self.iterate(&residuals).is_none() {
                break;
            }
        }
        let (error, (x, y, z, tau)) = best;
        (self.x, self.y, self.z, self.tau) = (x, y, z, tau);
        (End::Stalled, error)
    }

    fn state(&self) -> (Vec<f64>, Vec<f64>, Vec<f64>, f64) {
        (self.x.clone(), self.y.clone(), self.z.clone(), self.tau)
    }
}
