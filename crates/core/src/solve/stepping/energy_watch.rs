//! Energy balance of a run (docs/theory/energies.md, eq. 18).

use serde::{Deserialize, Serialize};

use crate::state::Method;
use crate::state::{EnergyBalance, HistoryRow};

/// Part of the work done above which unaccounted energy is reported.
const BOUND: f64 = 0.01;

/// Part of the energies exchanged above which energy that the time integration has made is reported: impacts make up to a
/// hundredth of theirs.
const MADE: f64 = 0.02;

/// Unaccounted energy after each increment, counted as `energy_balance_error` in the summary.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct EnergyWatch {
    balance: EnergyBalance,
    /// Work less energies after the last increment [J].
    open: f64,
    /// Largest change of `open` within an increment [J]; the increment follows.
    most: f64,
    increment: usize,
    step: usize,
    displacement: f64,
    method: Method,
    /// Largest energy that the time integration had made after an increment [J].
    made: f64,
}

impl EnergyWatch {
    /// Counts a committed increment.
    pub fn add(&mut self, row: &HistoryRow) {
        self.balance.push(row);
        let open = EnergyBalance::open(row);
        let change = (open - self.open).abs();
        if change > self.most || change.is_nan() {
            self.most = change;
            (self.increment, self.step) = (row.increment, row.step);
            (self.displacement, self.method) = (row.displacement_mm, row.procedure);
        }
        self.open = open;
        self.made = self.made.max(-row.numerical_dissipation_J);
    }

    /// Warning, if the time integration has made energy. The balance counts it as a negative dissipation.
    pub fn made_warning(&self) -> Option<String> {
        let exchanged = self.balance.exchanged();
        (self.made > MADE * exchanged).then(|| {
            format!(
                "the time integration has made {:.3} J, {:.1} % of the energies exchanged: smaller increments (increments.max), \
                 or a drive that starts slowly (amplitude)",
                self.made,
                100.0 * self.made / exchanged
            )
        })
    }

    /// Largest work done so far [N mm].
    pub fn work(&self) -> f64 {
        1e3 * self.balance.work()
    }

    /// Warning, if the error exceeds its bound.
    pub fn warning(&self) -> Option<String> {
        let error = self.balance.error();
        if error <= BOUND {
            return None;
        }
        let remedy = match self.method {
            Method::QuasiStatic | Method::Dynamic => {
                "shorter increments there (increments.max) follow the motion more closely"
            }
            Method::Implex => {
                "a unit snaps there: a viscosity of the step, or procedure = \"dissipation\", carries it over"
            }
            _ => {
                "try shorter increments there (increments.max) and a tighter tolerance (tolerance.residual)"
            }
        };
        Some(format!(
            "the energies do not balance: {:.1} % of the work done is unaccounted for (more than {:.0} % is too much); the \
             error grew most in increment {} (steps.{} at {:.4} mm), by {:.1} % of the work: {remedy}",
            100.0 * error,
            100.0 * BOUND,
            self.increment,
            self.step,
            self.displacement,
            100.0 * self.most / self.balance.exchanged(),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(increment: usize, work: f64, elastic: f64) -> HistoryRow {
        HistoryRow {
            increment,
            step: 1,
            displacement_mm: 0.5 * increment as f64,
            external_work_J: work,
            elastic_energy_J: elastic,
            ..HistoryRow::default()
        }
    }

    #[test]
    fn energy_that_the_time_integration_makes_is_reported() {
        let with = |numerical: f64| {
            let mut watch = EnergyWatch::default();
            watch.add(&HistoryRow {
                numerical_dissipation_J: numerical,
                ..row(1, 10.0, 10.0 - numerical)
            });
            watch.made_warning()
        };
        assert_eq!(with(-0.1), None);
        assert_eq!(with(1.0), None);
        assert!(with(-1.0).unwrap().contains("has made 1.000 J"));
    }

    #[test]
    fn energy_errors_are_reported_with_their_place() {
        let mut watch = EnergyWatch::default();
        watch.add(&row(1, 1.0, 0.999));
        watch.add(&row(2, 4.0, 3.99));
        // Here 0.25 % of the work is open.
        assert_eq!(watch.warning(), None);
        watch.add(&row(3, 8.0, 7.0));
        watch.add(&row(4, 10.0, 9.0));
        let told = watch.warning().unwrap();
        for part in [
            "10.0 % of the work",
            "increment 3 (steps.1 at 1.5000 mm)",
            "by 9.9 %",
            "increments.max",
        ] {
            assert!(told.contains(part), "{part}: {told}");
        }
    }
}
