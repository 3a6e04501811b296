//! Exchange of secant and direct tangents in steps whose joints are all dry (docs/theory/procedures.md, Algorithm).
//!
//! Stones that slide at many points at once may take ten times as many solves with secant tangents as with direct ones,
//! or a tenth as many, and no scene tells beforehand. Where increments take many solves, the others are tried for a few
//! increments, and those stay that advance further per solve. Trials become rarer, so that they cost little.

use serde::{Deserialize, Serialize};

/// Solves before the first trial; doubled by each trial.
const BUDGET: usize = 500;
/// Solves of a trial, and of the increments with which it is compared.
const TRIAL: usize = 200;
/// Solves per increment up to which tangents do well enough to need no trial.
const FEW: usize = 8;

/// Increments, their solves, and how far they advance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Window {
    increments: usize,
    solves: usize,
    /// As a part of the step.
    advance: f64,
}

impl Window {
    /// Advance per solve.
    fn pace(self) -> f64 {
        self.advance / self.solves.max(1) as f64
    }

    const fn is_slow(self) -> bool {
        self.solves > FEW * self.increments
    }
}

/// Counts the solves of a step and tells when its tangents are exchanged.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Exchange {
    budget: usize,
    /// Solves since the last trial.
    spent: usize,
    window: Window,
    /// During a trial: increments before it, with the other tangents.
    compared_with: Option<Window>,
}

impl Default for Exchange {
    fn default() -> Self {
        Self {
            budget: BUDGET,
            spent: 0,
            window: Window::default(),
            compared_with: None,
        }
    }
}

impl Exchange {
    /// Counts an increment of so many solves that advances by this part of the step.
    pub fn count(&mut self, solves: usize, advance: f64) {
        let window = &mut self.window;
        window.increments += 1;
        window.solves += solves;
        window.advance += advance;
        self.spent += solves;
    }

    /// Whether tangents are exchanged after the increments that were counted: for a trial, or back after one that
    /// advanced less.
    pub fn is_due(&mut self) -> bool {
        if self.window.solves < TRIAL {
            return false;
        }
        let window = std::mem::take(&mut self.window);
        if let Some(before) = self.compared_with.take() {
            self.spent = 0;
            self.budget *= 2;
            return window.pace() < before.pace();
        }
        let tries = self.spent >= self.budget && window.is_slow();
        if tries {
            self.compared_with = Some(window);
        }
        tries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Increments of a trial with these solves each, until tangents are exchanged; at most 1,000.
    fn until_due(exchange: &mut Exchange, solves: usize, advance: f64) -> Option<usize> {
        (1..=1000).find(|_| {
            exchange.count(solves, advance);
            exchange.is_due()
        })
    }

    #[test]
    fn tangents_that_advance_further_stay() {
        let mut exchange = Exchange::default();
        assert_eq!(
            until_due(&mut exchange, 20, 0.01),
            Some(BUDGET.next_multiple_of(TRIAL) / 20)
        );
        // The trial advances twice as far; the next comes after twice as many solves.
        assert!((0..TRIAL / 20).all(|_| {
            exchange.count(20, 0.02);
            !exchange.is_due()
        }));
        assert_eq!(until_due(&mut exchange, 20, 0.02), Some(2 * BUDGET / 20));
        // It advances less far.
        assert_eq!(until_due(&mut exchange, 20, 0.01), Some(TRIAL / 20));
    }

    #[test]
    fn increments_of_few_solves_need_no_trial() {
        assert_eq!(until_due(&mut Exchange::default(), FEW, 1e-9), None);
    }
}
