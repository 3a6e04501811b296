//! The stability atlas: every case with every method.

use std::time::Duration;

use super::case::{Case, Short, StudyError};
use super::cell::{Cell, Cost, Verdict};
use super::judge::judge;
use super::method::METHODS;
use super::parallel::{on_one_thread, side_by_side};
use super::run::{self, Nowhere, Watch};
use wythe_core::deck::Deck;
use wythe_core::model::Model;
use wythe_core::state::HistoryRow;

/// Options of the atlas.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names of the methods; all if empty.
    pub methods: Vec<String>,
    /// Whether the short forms are run instead of the full ones.
    pub short: bool,
    /// Largest wall time of a cell, checked after each increment.
    pub limit: Duration,
    /// Number of cells at a time, each on one thread.
    pub jobs: usize,
}

/// A case and its cells.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: Case,
    /// One cell for each method of the case.
    pub cells: Vec<Cell>,
}

/// Results of the atlas.
#[derive(Clone, Debug)]
pub struct Study {
    /// Rows, sorted by the number of the case.
    pub rows: Vec<Row>,
    /// Whether the rows are those of the short forms.
    pub short: bool,
    /// Whether the study was stopped before its end, so that cells are missing.
    pub interrupted: bool,
}

/// A cell to be run.
struct Job {
    row: usize,
    method: String,
    /// Whether the method is a modelling strategy, which the deck may not allow.
    derived: bool,
    /// Overrides of the deck, or the reason why the method does not apply.
    overrides: Result<Vec<(String, String)>, String>,
}

/// Runs the cases with the methods. `progress` is called with each finished cell, on any thread; `stop` is called
/// after each increment.
///
/// # Errors
/// [`StudyError`]: the deck of a case is invalid, or no case has a method of this name. An error within a cell is
/// its verdict.
pub fn stability(
    cases: &[Case],
    options: &Options,
    progress: &(dyn Fn(&Case, &Cell) + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Study, StudyError> {
    let mut jobs = Vec::new();
    let mut chosen = Vec::new();
    for case in cases {
        if options.short && case.short == Short::None {
            continue;
        }
        jobs.extend(jobs_of(case, chosen.len(), options)?);
        chosen.push(case);
    }
    known_methods(cases, options)?;
    let run = |job: Job| {
        let case = chosen[job.row];
        let cell = cell(case, &job, options, stop);
        progress(case, &cell);
        (job.row, cell)
    };
    let done = side_by_side(jobs, options.jobs, stop, &run);
    let mut rows: Vec<Row> = chosen
        .iter()
        .map(|&case| Row {
            case: case.clone(),
            cells: Vec::new(),
        })
        .collect();
    for (row, cell) in done.into_iter().flatten() {
        rows[row].cells.push(cell);
    }
    let interrupted = stop();
    Ok(Study {
        rows,
        short: options.short,
        interrupted,
    })
}

/// Cells of a case. A case with its own methods runs methods of the atlas only if they are requested by name.
fn jobs_of(case: &Case, row: usize, options: &Options) -> Result<Vec<Job>, StudyError> {
    let form = match &case.short {
        Short::Set(set) if options.short => set.clone(),
        _ => Vec::new(),
    };
    let deck = Deck::load(&case.deck, &form)?;
    let wanted =
        |name: &str| options.methods.is_empty() || options.methods.iter().any(|m| m == name);
    let with = |set: Vec<(String, String)>| form.iter().cloned().chain(set).collect();
    let of_atlas = METHODS
        .iter()
        .filter(|m| case.methods.is_empty() || options.methods.iter().any(|name| name == m.name))
        .map(|m| Job {
            row,
            method: m.name.to_owned(),
            derived: m.strategy.is_some(),
            overrides: m.overrides(case, &deck).map(with),
        });
    let own = case.methods.iter().map(|m| Job {
        row,
        method: m.name.clone(),
        derived: false,
        overrides: Ok(with(m.set.clone())),
    });
    let methods = of_atlas.chain(own);
    Ok(methods.filter(|job| wanted(&job.method)).collect())
}

/// Rejects the name of a method that no case has.
fn known_methods(cases: &[Case], options: &Options) -> Result<(), StudyError> {
    let own = cases
        .iter()
        .flat_map(|c| c.methods.iter().map(|m| m.name.as_str()));
    let known: Vec<&str> = METHODS.iter().map(|m| m.name).chain(own).collect();
    match options
        .methods
        .iter()
        .find(|m| !known.contains(&m.as_str()))
    {
        None => Ok(()),
        Some(name) => Err(StudyError::Unknown {
            kind: "method",
            name: name.clone(),
            known: known.join(", "),
        }),
    }
}

/// Runs one cell on one thread.
fn cell(case: &Case, job: &Job, options: &Options, stop: &(dyn Fn() -> bool + Sync)) -> Cell {
    let mut cell = Cell {
        method: job.method.clone(),
        verdict: Verdict::Broken(String::new()),
        cost: Cost::default(),
        measured: Vec::new(),
        out_of_balance: 0.0,
        energy: 0.0,
        procedures: Vec::new(),
    };
    let overrides = match &job.overrides {
        Ok(overrides) => overrides,
        Err(why) => {
            cell.verdict = Verdict::Inapplicable(why.clone());
            return cell;
        }
    };
    let watch = Watch {
        limit: options.limit,
        stop,
    };
    let refused = |why: String| {
        if job.derived {
            Verdict::Inapplicable(why)
        } else {
            Verdict::Broken(why)
        }
    };
    let run = || {
        let deck = Deck::load(&case.deck, overrides).map_err(|e| refused(e.to_string()))?;
        let model = Model::from_deck(&deck).map_err(|e| refused(e.to_string()))?;
        run::run(&model.0, Nowhere, watch).map_err(Verdict::Broken)
    };
    let ran = on_one_thread(|| Ok(run()));
    let run = match ran.unwrap_or_else(|why| Err(Verdict::Broken(why))) {
        Ok(ran) => {
            cell.cost = ran.cost;
            ran.ended
        }
        Err(verdict) => {
            cell.verdict = verdict;
            return cell;
        }
    };
    cell.energy = run.energy;
    let imbalances = run.rows.iter().map(|row| row.out_of_balance);
    cell.out_of_balance = imbalances.fold(0.0, f64::max);
    cell.procedures = procedures(&run.rows);
    let (verdict, measured) = judge(case.terms(), options.short, &run);
    cell.verdict = verdict;
    cell.measured = measured.into_iter().map(|m| m.text).collect();
    cell
}

/// Procedures and their numbers of increments, in order of first appearance; empty if one procedure solved all.
fn procedures(rows: &[HistoryRow]) -> Vec<(String, usize)> {
    let mut counts: Vec<(String, usize)> = Vec::new();
    for row in rows {
        let name = row.procedure.name();
        match counts.iter_mut().find(|(known, _)| known == name) {
            Some((_, count)) => *count += 1,
            None => counts.push((name.to_owned(), 1)),
        }
    }
    if counts.len() < 2 {
        counts.clear();
    }
    counts
}
