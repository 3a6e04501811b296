//! Verdict on a finished run.

use super::case::End;
use super::cell::{Place, Verdict};
use super::expect::{Expectation, Measured, percent};
use super::history::History;
use wythe_core::state::{HistoryRow, Status};

/// Data of a finished run that the verdict depends on.
#[derive(Clone, Debug)]
pub struct Ended {
    /// Rows of the history.
    pub rows: Vec<HistoryRow>,
    /// Columns of its probes.
    pub probes: Vec<String>,
    /// Status at the end.
    pub status: Status,
    /// Message of the solver at the end.
    pub message: String,
    /// Tolerance of the residual. `[step]`
    pub tolerances: Vec<f64>,
    /// Energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
}

impl Ended {
    /// Last point of the load history that the run reached.
    pub fn place(&self) -> Place {
        let Some(row) = self.rows.last() else {
            return Place::default();
        };
        let done = row.load_factor;
        // The step is complete, and the next step has no increment yet.
        if done > 1.0 - 1e-9 && row.step + 1 < self.tolerances.len() {
            return Place {
                step: row.step + 1,
                done: 0.0,
            };
        }
        Place {
            step: row.step,
            done,
        }
    }
}

/// Criteria for the verdict on a run.
#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    /// Required end of the run.
    pub status: End,
    /// Largest accepted energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
    /// Expected results.
    pub expect: &'a [Expectation],
}

/// Returns the verdict and the measured value of every expectation of this form.
pub fn judge(terms: Terms<'_>, short: bool, run: &Ended) -> (Verdict, Vec<Measured>) {
    let history = History::new(&run.rows, &run.probes);
    let mut wrong = Vec::new();
    if run.rows.is_empty() && run.status == Status::Completed {
        wrong.push("no increment".to_owned());
    }
    if let Some((row, column)) = history.not_finite() {
        wrong.push(format!("{column} of row {} is not finite", row + 1));
    }
    let balanced = |row: &&HistoryRow| row.residual <= run.tolerances[row.step];
    if let Some(row) = run.rows.iter().find(|row| !balanced(row)) {
        wrong.push(format!(
            "row {} is out of balance by {:.1e} (tolerance {:.1e})",
            row.increment, row.residual, run.tolerances[row.step]
        ));
    }
    // A NaN is out of balance.
    if !matches!(
        run.energy.partial_cmp(&terms.energy),
        Some(std::cmp::Ordering::Less | std::cmp::Ordering::Equal)
    ) {
        wrong.push(format!(
            "energies are out of balance by {} (at most {})",
            percent(run.energy).trim_start_matches('+'),
            percent(terms.energy).trim_start_matches('+')
        ));
    }
    let (error, told) = compare(terms.expect, short, &history, &mut wrong);
    let verdict = match (run.status, terms.status) {
        (Status::Interrupted | Status::Stopped, _) => Verdict::Stopped(run.place()),
        (Status::NotConverged, End::Completed) => {
            Verdict::Diverged(run.place(), reason(&run.message).to_owned())
        }
        (Status::Completed, End::NotConverged) => {
            wrong.insert(0, "holds where it must lose equilibrium".to_owned());
            Verdict::Wrong(wrong)
        }
        _ if wrong.is_empty() => Verdict::Completed(error),
        _ => Verdict::Wrong(wrong),
    };
    (verdict, told)
}

/// Measures the expectations of this form. Returns the largest error against the references and the measured
/// values; expectations that do not hold are added to `wrong`.
pub fn compare(
    expect: &[Expectation],
    short: bool,
    history: &History,
    wrong: &mut Vec<String>,
) -> (Option<f64>, Vec<Measured>) {
    let mut error: Option<f64> = None;
    let mut told = Vec::new();
    for expectation in expect.iter().filter(|e| e.holds_of(short)) {
        let measured = expectation.measure(history);
        if let Some(e) = measured.error {
            error = Some(error.map_or(e.abs(), |worst| worst.max(e.abs())));
        }
        if !measured.holds {
            wrong.push(measured.text.clone());
        }
        told.push(measured);
    }
    (error, told)
}

/// The solver's reason alone, without the place before it and the advice after it.
pub(super) fn reason(message: &str) -> &str {
    let why = message
        .split_once("an increment of")
        .and_then(|(_, rest)| rest.split_once(": "))
        .map_or(message, |(_, why)| why);
    why.split_once("; try ").map_or(why, |(why, _)| why)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::case::Case;
    use crate::study::expect::{Measure, Wanted};

    fn case(expect: Vec<Expectation>) -> Case {
        Case {
            expect,
            ..Case::empty()
        }
    }

    fn peak(value: f64) -> Expectation {
        Expectation {
            name: "peak force".to_owned(),
            measure: Measure::Peak("force_kN".to_owned()),
            wanted: Wanted::Relative(value, 0.01),
            steps: None,
            of_short: true,
            of_full: true,
            why: String::new(),
        }
    }

    /// Two increments of one step of 1 s, in equilibrium, up to 3 kN.
    fn run() -> Ended {
        let row = |i: usize| HistoryRow {
            increment: i,
            time: 0.5 * i as f64,
            load_factor: 0.5 * i as f64,
            force_kN: 1.5 * i as f64,
            residual: 1e-3,
            ..HistoryRow::default()
        };
        Ended {
            rows: vec![row(1), row(2)],
            probes: Vec::new(),
            status: Status::Completed,
            message: String::new(),
            tolerances: vec![5e-3],
            energy: 1e-3,
        }
    }

    fn verdict(case: &Case, run: &Ended) -> Verdict {
        judge(case.terms(), false, run).0
    }

    #[test]
    fn a_run_in_balance_that_meets_its_reference_is_completed() {
        let Verdict::Completed(Some(error)) = verdict(&case(vec![peak(2.99)]), &run()) else {
            panic!("{:?}", verdict(&case(vec![peak(2.99)]), &run()))
        };
        assert!((error - (3.0 / 2.99 - 1.0)).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_finite_not_in_balance_or_beside_the_reference_is_wrong() {
        let right = case(vec![peak(3.0)]);
        let said = |case: &Case, run: &Ended| match verdict(case, run) {
            Verdict::Wrong(reasons) => reasons.join("; "),
            other => panic!("{other:?}"),
        };
        let mut nan = run();
        nan.rows[0].elastic_energy_J = f64::NAN;
        assert!(said(&right, &nan).contains("elastic_energy_J of row 1"));
        for residual in [6e-3, f64::NAN, f64::INFINITY] {
            let mut loose = run();
            loose.rows[1].residual = residual;
            assert!(said(&right, &loose).contains("row 2 is out of balance"));
        }
        for energy in [0.011, f64::NAN] {
            let mut leaking = run();
            leaking.energy = energy;
            assert!(said(&right, &leaking).contains("energies"));
        }
        assert!(said(&case(vec![peak(2.0)]), &run()).contains("peak force 3.00000, +50 %"));
        let mut nothing = run();
        nothing.rows.clear();
        assert!(said(&right, &nothing).contains("no increment"));
    }

    #[test]
    fn lost_convergence_is_told_with_its_place_and_may_be_the_right_answer() {
        let mut lost = run();
        lost.status = Status::NotConverged;
        lost.rows.truncate(1);
        lost.message =
            "step 0 (drive), 50.00 % of it done, an increment of 1e-6 of it, static: the matrix \
                        is singular; try to press it"
                .to_owned();
        let right = case(vec![peak(1.5)]);
        let place = Place { step: 0, done: 0.5 };
        assert_eq!(
            verdict(&right, &lost),
            Verdict::Diverged(place, "the matrix is singular".to_owned())
        );
        let must_fall = Case {
            status: End::NotConverged,
            ..right.clone()
        };
        assert!(matches!(verdict(&must_fall, &lost), Verdict::Completed(_)));
        assert!(matches!(verdict(&must_fall, &run()), Verdict::Wrong(_)));
        lost.status = Status::Interrupted;
        assert_eq!(verdict(&right, &lost), Verdict::Stopped(place));
    }

    #[test]
    fn expectations_of_the_other_form_are_not_asked() {
        let only_full = Expectation {
            of_short: false,
            ..peak(7.0)
        };
        let case = case(vec![only_full]);
        assert!(matches!(
            judge(case.terms(), true, &run()).0,
            Verdict::Completed(_)
        ));
        assert!(matches!(
            judge(case.terms(), false, &run()).0,
            Verdict::Wrong(_)
        ));
    }
}
