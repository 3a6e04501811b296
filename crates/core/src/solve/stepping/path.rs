//! Path following: the load factor is an unknown, and a constraint sets the length of an increment
//! (docs/theory/procedures.md, eqs 1 to 5).
//!
//! With the load factor λ (part of the step's loads and prescribed displacements), the out-of-balance forces r(q, λ)
//! and the displacements Δq = q − q₀ since the last commit, an iterate is
//!
//! ```text
//! K d₁ = −r,   K d₂ = −∂r/∂λ,   q ← q + d₁ + δλ d₂,   λ ← λ + δλ
//! ```
//!
//! (Batoz and Dhatt 1979). δλ follows from the constraint:
//!
//! ```text
//! arc length (Crisfield 1981):              ‖Δq + d₁ + δλ d₂‖ = l, the root with the smaller angle to the way before
//! dissipation, displacement control:        c·(Δq + d₁ + δλ d₂) = s
//! ```
//!
//! K is the matrix of the procedure. With secant stiffness it stays positive definite where loads fall. The
//! constraint prevents further softening within an iterate, so the iteration converges there too.
//!
//! # The dissipation
//! Gutiérrez (2004) writes the dissipation of an increment by its loads, which assumes unloading to the origin. Here
//! it is measured where it arises. If an element or facet with nodal forces f dissipated D over the displacements Δu
//! of its nodes, it did so at the rate η = D/(f·Δu) of its stress power. With the same rates the next increment
//! dissipates
//!
//! ```text
//! s = Σ η f·Δu = c·Δq
//! ```
//!
//! which is linear in the displacements, free of rigid motion, and zero where nothing dissipates.

use serde::{Deserialize, Serialize};

use crate::assembly::{System, Trial};
use crate::state::Method;

/// Prescribed length of an increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance<'a> {
    /// Prescribed load factor.
    Load,
    /// Prescribed length of Δq [mm].
    Arc {
        /// Length l [mm].
        length: f64,
        /// Displacements of the increment before, which choose the root [mm]. `[slot]`
        onwards: &'a [f64],
    },
    /// Prescribed value of c·Δq.
    Along {
        /// c: [N] for an energy, [-] for a displacement. `[slot]`
        gradient: &'a [f64],
        /// s [N mm or mm].
        by: f64,
    },
}

impl Advance<'_> {
    /// δλ of an iterate, from Δq + d₁ and d₂ [mm] `[slot]`; none if no load factor satisfies the constraint.
    pub fn load_change(&self, reached: &[f64], rate: &[f64]) -> Option<f64> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let change = match *self {
            Self::Load => 0.0,
            Self::Along { gradient, by } => (by - dot(gradient, reached)) / dot(gradient, rate),
            Self::Arc { length, onwards } => {
                // a δλ² + 2 b δλ + c = 0
                let a = dot(rate, rate);
                let b = dot(reached, rate);
                let c = dot(reached, reached) - length * length;
                let root = (b * b - a * c).sqrt();
                // The root with the smaller angle to the increment before.
                let ahead = dot(onwards, rate);
                (-b + if ahead >= 0.0 { root } else { -root }) / a
            }
        };
        change.is_finite().then_some(change)
    }
}

/// Measure of the last increment, from which the next one along the path follows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PathMeasure {
    method: Method,
    /// c, or the displacements of the last increment [mm]. `[slot]`
    gradient: Vec<f64>,
    /// s or l of the last increment.
    measure: f64,
    /// Its step time over the duration of the step.
    size: f64,
    /// Change of the load factor in it.
    load: f64,
    /// Size of the next increment over the last one; the second value is the ratio before cuts.
    ratio: f64,
    planned: f64,
    /// Largest wanted movement in an increment [mm].
    most: f64,
    /// Largest increment size of the step.
    largest: f64,
    cuts: usize,
}

/// Largest wanted movement over the one that the first increment would have at the largest size.
const FAR: f64 = 10.0;
/// Movement over the largest wanted one beyond which the increment left its path.
const LEAP: f64 = 2.0;
/// Number of cuts after which a path is given up.
const CUTS: usize = 6;

impl PathMeasure {
    /// Measure before any increment. Nodes should move by at most `most` [mm] in an increment of at most the size
    /// `largest`.
    pub fn new(most: f64, largest: f64) -> Self {
        Self {
            largest,
            method: Method::Static,
            gradient: Vec::new(),
            measure: 0.0,
            size: 0.0,
            load: 0.0,
            ratio: 1.0,
            planned: 1.0,
            most,
            cuts: 0,
        }
    }

    /// Takes the increment that ends at `trial`, with its displacements `dq` [mm] `[slot]`, its size and its change
    /// of the load factor, as measure for the next increment of `method`, which is `growth` times as long. Returns
    /// false if the increment dissipated nothing and so does not measure a dissipation.
    #[expect(clippy::too_many_arguments, reason = "an increment and its measures")]
    pub fn learn(
        &mut self,
        method: Method,
        system: &System,
        trial: &Trial,
        dq: &[f64],
        (size, load): (f64, f64),
        growth: f64,
    ) -> bool {
        let (gradient, measure) = if method == Method::ArcLength {
            (dq.to_vec(), length(dq))
        } else {
            let c = system.dissipation_gradient(trial, dq);
            let s = c.iter().zip(dq).map(|(c, u)| c * u).sum();
            (c, s)
        };
        if measure.is_nan() || measure <= 0.0 {
            return false;
        }
        let movement = dq.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        if self.most.is_infinite() {
            // In steps without a drive, the first increment sets the scale of movements.
            self.most = FAR * movement * self.largest / size;
        }
        let ratio = growth.min(self.most / movement);
        *self = Self {
            method,
            gradient,
            measure,
            size,
            load,
            ratio,
            planned: ratio,
            most: self.most,
            largest: self.largest,
            cuts: 0,
        };
        true
    }

    /// Whether an increment of given dissipation left the path for a distant equilibrium.
    pub fn is_left_by(&self, dq: &[f64]) -> bool {
        self.method == Method::Dissipation && dq.iter().any(|u| u.abs() > LEAP * self.most)
    }

    /// This measure in a step that started with the measure `first`; none if it does not have `slots` displacements.
    pub fn of_step(self, first: &Self, slots: usize) -> Option<Self> {
        let fits = self.gradient.is_empty() || self.gradient.len() == slots;
        let most = if first.most.is_finite() {
            first.most
        } else {
            self.most
        };
        fits.then_some(Self {
            most,
            largest: first.largest,
            ..self
        })
    }

    /// Rescales the measure for a longer step, of which the present one is `part`.
    pub fn lengthen(&mut self, part: f64) {
        self.size *= part;
        self.load *= part;
    }

    /// Whether the next increment of `method` can be measured.
    pub fn leads(&self, method: Method) -> bool {
        self.method == method
    }

    /// Discards the measured increment.
    pub fn forget(&mut self) {
        *self = Self::new(self.most, self.largest);
    }

    /// Size and expected load change of the next increment.
    pub fn next(&self) -> (f64, f64) {
        (self.ratio * self.size, self.ratio * self.load)
    }

    /// Constraint of the next increment.
    pub fn advance(&self) -> Advance<'_> {
        let by = self.ratio * self.measure;
        if self.method == Method::ArcLength {
            Advance::Arc {
                length: by,
                onwards: &self.gradient,
            }
        } else {
            Advance::Along {
                gradient: &self.gradient,
                by,
            }
        }
    }

    /// Restores the uncut length, for another method.
    pub fn mend(&mut self) {
        (self.ratio, self.cuts) = (self.planned, 0);
    }

    /// Shortens the next increment; false if it was cut too often.
    pub fn cut(&mut self, factor: f64) -> bool {
        self.ratio *= factor;
        self.cuts += 1;
        self.cuts <= CUTS
    }
}

/// Euclidean norm ‖v‖.
pub fn length(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_step_ends_on_its_circle_and_continues_forward() {
        let (reached, rate) = ([0.3, -0.2, 0.1], [1.0, 0.5, -2.0]);
        for onwards in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]] {
            let advance = Advance::Arc {
                length: 2.0,
                onwards: &onwards,
            };
            let change = advance.load_change(&reached, &rate).unwrap();
            let way: Vec<f64> = reached
                .iter()
                .zip(rate)
                .map(|(r, d)| r + change * d)
                .collect();
            assert!((length(&way) - 2.0).abs() < 1e-14, "{way:?}"); // rounding
            assert!(way[0] * onwards[0] > 0.0, "{way:?}");
        }
    }

    #[test]
    fn a_step_that_no_load_can_reach_is_rejected() {
        let advance = Advance::Arc {
            length: 1.0,
            onwards: &[1.0, 0.0],
        };
        assert_eq!(advance.load_change(&[3.0, 0.0], &[0.0, 1.0]), None);
        let along = Advance::Along {
            gradient: &[1.0, 0.0],
            by: 1.0,
        };
        assert_eq!(along.load_change(&[0.0, 0.0], &[0.0, 1.0]), None);
    }
}
