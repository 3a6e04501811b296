//! Time in which loads waited for bodies that move: it is no part of the duration of the steps.

use wythe_core::model::Model;
use wythe_core::state::{HistoryRow, Method};

/// Time for which loads waited so far.
#[derive(Debug, Default)]
pub struct Waiting {
    /// Whether the loads of a step may wait. `[step]`
    may_wait: Vec<bool>,
    /// Step, time and load factor of the last increment.
    last: Option<(usize, f64, f64)>,
    /// Time so far [s].
    time: f64,
}

impl Waiting {
    /// Before the first increment of a model.
    pub fn of(model: &Model) -> Self {
        // Rows of an amplitude may have the same value.
        let steps = model.steps.iter();
        Self::in_steps(steps.map(|step| step.only_loads() && step.amplitude.is_none()))
    }

    fn in_steps(may_wait: impl Iterator<Item = bool>) -> Self {
        Self {
            may_wait: may_wait.collect(),
            ..Self::default()
        }
    }

    /// Time for which loads waited until this increment, the one after the last that was asked for [s].
    pub fn until(&mut self, row: &HistoryRow) -> f64 {
        let may_wait = self.may_wait.get(row.step).is_some_and(|may| *may);
        let now = (row.step, row.time, row.load_factor);
        if let Some((step, time, load)) = self.last.replace(now)
            && may_wait
            && row.procedure == Method::QuasiStatic
            && (step, load) == (row.step, row.load_factor)
        {
            self.time += row.time - time;
        }
        self.time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loads_that_inertia_holds_wait() {
        let mut waiting = Waiting::in_steps([false, true].into_iter());
        let row = |step, time, load_factor, procedure| HistoryRow {
            step,
            time,
            load_factor,
            procedure,
            ..HistoryRow::default()
        };
        for (row, until) in [
            (row(0, 1.0, 0.5, Method::QuasiStatic), 0.0),
            (row(0, 2.0, 0.5, Method::QuasiStatic), 0.0), // a step that drives
            (row(1, 2.5, 0.5, Method::QuasiStatic), 0.0),
            (row(1, 2.75, 0.5, Method::QuasiStatic), 0.25),
            (row(1, 3.25, 0.5, Method::QuasiStatic), 0.75),
            (row(1, 3.5, 0.75, Method::QuasiStatic), 0.75),
            (row(1, 4.0, 0.75, Method::Static), 0.75),
        ] {
            assert_eq!(waiting.until(&row), until, "{row:?}");
        }
    }
}
