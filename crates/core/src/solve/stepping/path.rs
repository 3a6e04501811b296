//! Path following: the load is an unknown, and one more equation says how far an increment goes.
//!
//! With λ the part of the step's loads and prescribed displacements, r(q, λ) the out-of-balance forces
//! and Δq = q − q₀ the way from the last commit, an iterate is
//!
//! ```text
//! K d₁ = −r,   K d₂ = −∂r/∂λ,   q ← q + d₁ + δλ d₂,   λ ← λ + δλ
//! ```
//!
//! (Batoz and Dhatt 1979), δλ such that the way is as long as it should be:
//!
//! ```text
//! arc length (Crisfield 1981):              ‖Δq + d₁ + δλ d₂‖ = l, the root that goes on
//! dissipation, displacement control:        c·(Δq + d₁ + δλ d₂) = s
//! ```
//!
//! K is the matrix of the procedure: with secant stiffness it stays positive definite where loads fall,
//! and the constraint, which holds what softens where it is, makes the iteration converge there.
//!
//! # The dissipation
//! Gutiérrez (2004) writes the dissipation of an increment by its loads, which asks for unloading to the
//! origin. Here it is taken from where it arises: an element or a facet with nodal forces f that has
//! dissipated D over the way Δu of its nodes does so at the rate η = D/(f·Δu) of its stress power.
//! With the same rates in the next increment its dissipation is
//!
//! ```text
//! s = Σ η f·Δu = c·Δq
//! ```
//!
//! linear in the displacements, free of rigid motion, and zero where nothing softens.

use serde::{Deserialize, Serialize};

use crate::assembly::{System, Trial};
use crate::state::Method;

/// How far an increment goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance<'a> {
    /// To a given load.
    Load,
    /// By a given length of Δq [mm].
    Arc {
        /// Length l [mm].
        length: f64,
        /// A way that goes on, by which the root is chosen [mm]. `[slot]`
        onwards: &'a [f64],
    },
    /// Until c·Δq has a given value.
    Along {
        /// c: N for an energy, none for a displacement. `[slot]`
        gradient: &'a [f64],
        /// s [N mm or mm].
        by: f64,
    },
}

impl Advance<'_> {
    /// δλ of an iterate, from Δq + d₁ and d₂ [mm] `[slot]`; none if no load gets there.
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
                // Of the two ways the one with the smaller angle to the way before.
                let ahead = dot(onwards, rate);
                (-b + if ahead >= 0.0 { root } else { -root }) / a
            }
        };
        change.is_finite().then_some(change)
    }
}

/// The increment behind, by which the next one along the path is measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PathMeasure {
    method: Method,
    /// c, or the way behind [mm]. `[slot]`
    gradient: Vec<f64>,
    /// Its measure s or l.
    measure: f64,
    /// Its step time over the duration of the step.
    size: f64,
    /// What it added to the load.
    load: f64,
    /// Next increment over it, and what it was before it was cut.
    ratio: f64,
    planned: f64,
    /// Largest movement wanted in one increment [mm].
    most: f64,
    /// Largest increment of the step, as part of it.
    largest: f64,
    cuts: usize,
}

/// How far an increment may lead beside one of the largest size when the step began to move.
const FAR: f64 = 10.0;
/// The same, of the largest movement wanted, beyond which it has jumped.
const LEAP: f64 = 2.0;
/// Cuts after which a path is given up.
const CUTS: usize = 6;

impl PathMeasure {
    /// Nothing behind yet; nodes move by no more than `most` [mm] in an increment, whose size is no more
    /// than `largest`.
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

    /// Takes the increment that `trial` ends, its size and what it added to the load, over its way `dq`, as the measure of the next
    /// one of `method`, `growth` times as long. One in which nothing dissipated is no measure of
    /// dissipation; false then.
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
            // Nothing is driven: the first increment, by the load, tells what is far.
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

    /// Whether a way of dissipation has left the path: it has come to an equilibrium far from the last
    /// one, over what lies between.
    pub fn is_left_by(&self, dq: &[f64]) -> bool {
        self.method == Method::Dissipation && dq.iter().any(|u| u.abs() > LEAP * self.most)
    }

    /// This measure in a step that began with the measure `first`; none if it does not measure `slots` of
    /// displacements.
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

    /// The whole step becomes `part` of a longer one.
    pub fn lengthen(&mut self, part: f64) {
        self.size *= part;
        self.load *= part;
    }

    /// Whether the next increment of `method` can be measured.
    pub fn leads(&self, method: Method) -> bool {
        self.method == method
    }

    /// Forgets what is behind.
    pub fn forget(&mut self) {
        *self = Self::new(self.most, self.largest);
    }

    /// The next increment: its size and what it should add to the load if it goes on as before.
    pub fn next(&self) -> (f64, f64) {
        (self.ratio * self.size, self.ratio * self.load)
    }

    /// How far it goes.
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

    /// The whole way again, for another method.
    pub fn mend(&mut self) {
        (self.ratio, self.cuts) = (self.planned, 0);
    }

    /// A shorter way; false if it was cut too often.
    pub fn cut(&mut self, factor: f64) -> bool {
        self.ratio *= factor;
        self.cuts += 1;
        self.cuts <= CUTS
    }
}

/// ‖v‖.
pub fn length(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_ends_on_its_circle_and_goes_on() {
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
    fn a_way_that_no_load_leads_to_is_refused() {
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
