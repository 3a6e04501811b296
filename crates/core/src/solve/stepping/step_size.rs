//! Increment sizes within one step (docs/theory/procedures.md, eqs 12 and 13).

use serde::{Deserialize, Serialize};

use crate::model::amplitude::{Branch, ROUNDING};
use crate::model::scene::Increments;

/// One increment, from `start` to `start + size`, as parts of the step's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Start of the increment.
    pub start: f64,
    /// Size of the increment.
    pub size: f64,
    /// Whether only time passes, and the loads stay as they are at its start.
    pub holds: bool,
}

impl Increment {
    /// End of the increment.
    pub fn end(&self) -> f64 {
        if self.holds {
            self.start
        } else {
            self.start + self.size
        }
    }

    /// An increment of no size at its end.
    pub fn and_then_none(&self) -> Self {
        Self {
            start: self.end(),
            size: 0.0,
            holds: false,
        }
    }

    /// Whether the increment ends the step.
    pub fn ends_step(&self) -> bool {
        self.end() >= 1.0 - ROUNDING
    }
}

/// Chooses the increment sizes of one step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Schedule {
    limits: Increments,
    done: f64,
    size: f64,
    /// Time of the next row of the amplitude, or the end of the step. An increment ends there.
    until: f64,
}

/// Largest size of an increment that holds the loads, over that of one in which they grow.
const HELD: f64 = 4.0;

/// The next increment would be smaller than allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooSmall;

impl Schedule {
    /// Starts a step. `until` is the time of the second row of its amplitude, 1 if that is the end.
    pub fn new(limits: Increments, until: f64) -> Self {
        Self {
            limits,
            done: 0.0,
            size: limits.initial.min(limits.max),
            until,
        }
    }

    /// Part of the step that is done.
    pub fn done(&self) -> f64 {
        self.done
    }

    /// Continues along a branch of the amplitude, from its start.
    pub fn turn(&mut self, branch: Branch) {
        (self.done, self.until) = (branch.from[0], branch.to[0]);
    }

    /// Limits the next increment to the initial size of the step.
    pub fn begin_small(&mut self) {
        self.size = self.size.min(self.limits.initial);
    }

    /// The next increment; none at the end of the step or of a branch of its amplitude. A rest below 1.5 increments
    /// is halved, so that no very small one is left.
    pub fn next(&self) -> Option<Increment> {
        let left = self.until - self.done;
        if left <= ROUNDING {
            return None;
        }
        let size = if left <= self.size * (1.0 + 1e-9) {
            left
        } else if left < 1.5 * self.size {
            left / 2.0
        } else {
            self.size
        };
        Some(Increment {
            start: self.done,
            size,
            holds: false,
        })
    }

    /// Notes a committed increment; the next may be `factor` times as large.
    pub fn accept(&mut self, increment: Increment, factor: f64) {
        self.done = increment.end();
        // An increment shortened by the end of the step does not determine the size.
        let base = if increment.size < 0.5 * self.size {
            self.size
        } else {
            increment.size
        };
        let most = if increment.holds {
            HELD * self.limits.max
        } else {
            self.limits.max
        };
        self.size = (base * factor).max(self.limits.min).min(most);
    }

    /// Size of the next increment, if that much is left of the step.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Limits the next increment to `size`.
    pub fn shorten(&mut self, size: f64) {
        self.size = self.size.min(size).max(self.limits.min);
    }

    /// Notes that a path has reached part `load` of the step's loads.
    pub fn reach(&mut self, load: f64) {
        self.done = load;
    }

    /// Sets the size of the next increment, within the limits of the step.
    pub fn resume(&mut self, size: f64) {
        self.size = size.max(self.limits.min).min(self.limits.max);
    }

    /// The same schedule with other limits.
    pub fn within(self, limits: Increments) -> Self {
        Self { limits, ..self }
    }

    /// Rescales the schedule for a longer step, of which the present one is `part`.
    pub fn lengthen(&mut self, part: f64) {
        self.done *= part;
        self.size *= part;
    }

    /// Cuts a rejected increment to `factor` of its size.
    ///
    /// # Errors
    /// [`TooSmall`] if that is below the smallest increment.
    pub fn cut(&mut self, increment: Increment, factor: f64) -> Result<(), TooSmall> {
        self.size = increment.size * factor;
        if self.size < self.limits.min {
            Err(TooSmall)
        } else {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_covered_whole() {
        let mut schedule = Schedule::new(
            Increments {
                initial: 0.07,
                max: 0.2,
                min: 1e-6,
                peak: 1.0,
            },
            1.0,
        );
        let mut end = 0.0;
        while let Some(increment) = schedule.next() {
            assert_eq!(increment.start, end);
            end = increment.end();
            schedule.accept(increment, 1.5);
        }
        // Sums of parts of one: a few roundings.
        assert!((end - 1.0).abs() < 1e-14);
    }

    #[test]
    fn an_increment_that_holds_the_loads_takes_no_part_of_the_step() {
        let limits = Increments {
            initial: 0.1,
            max: 0.1,
            min: 1e-6,
            peak: 1.0,
        };
        let mut schedule = Schedule::new(limits, 1.0);
        for _ in 0..10 {
            let holds = Increment {
                size: schedule.size(),
                holds: true,
                ..schedule.next().unwrap()
            };
            schedule.accept(holds, 1.5);
        }
        assert_eq!((schedule.done(), schedule.size()), (0.0, HELD * limits.max));
        schedule.shorten(limits.max);
        assert_eq!(schedule.next().unwrap().end(), limits.max);
    }

    #[test]
    fn increments_end_on_the_rows_of_an_amplitude() {
        let limits = Increments {
            initial: 0.03,
            max: 0.07,
            min: 1e-6,
            peak: 1.0,
        };
        let rows = [0.0, 0.25, 0.3, 0.75, 1.0];
        let mut schedule = Schedule::new(limits, rows[1]);
        for pair in rows.windows(2) {
            schedule.turn(Branch {
                from: [pair[0], 0.0],
                to: [pair[1], 1.0],
            });
            while let Some(increment) = schedule.next() {
                assert!(increment.end() <= pair[1] + ROUNDING);
                schedule.accept(increment, 1.5);
            }
            assert!((schedule.done() - pair[1]).abs() <= ROUNDING);
        }
    }

    #[test]
    fn cutting_below_the_smallest_increment_is_rejected() {
        let mut schedule = Schedule::new(
            Increments {
                initial: 0.1,
                max: 0.2,
                min: 0.03,
                peak: 1.0,
            },
            1.0,
        );
        let Some(first) = schedule.next() else {
            panic!("a step has an increment")
        };
        assert_eq!(schedule.cut(first, 0.4), Ok(()));
        let Some(second) = schedule.next() else {
            panic!("a cut step has an increment")
        };
        assert!((second.size - 0.04).abs() < 1e-15);
        assert_eq!(schedule.cut(second, 0.4), Err(TooSmall));
    }
}
