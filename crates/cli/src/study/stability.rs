//! The stability atlas: every case through every method.

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

/// How the atlas is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Methods by name; all if empty.
    pub methods: Vec<String>,
    /// The short forms instead of the full ones.
    pub short: bool,
    /// Wall time that a cell may take, looked at after each increment.
    pub limit: Duration,
    /// Cells at a time, each on one thread.
    pub jobs: usize,
}

/// A case with its cells.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: Case,
    /// A cell for each of its methods.
    pub cells: Vec<Cell>,
}

/// An atlas.
#[derive(Clone, Debug)]
pub struct Study {
    /// By number of the case.
    pub rows: Vec<Row>,
    /// Whether these are the short forms.
    pub short: bool,
    /// Whether it was stopped before its end: cells are missing.
    pub interrupted: bool,
}

/// A cell to be run.
struct Job {
    row: usize,
    method: String,
    /// Overrides of the deck, or why the method does not apply.
    overrides: Result<Vec<(String, String)>, String>,
}

/// Takes cases through methods. `progress` hears of each cell as it ends, on any thread; `stop` is
/// asked after each increment.
///
/// # Errors
/// [`StudyError`]: the deck of a case is wrong, or no case has such a method. What happens within a
/// cell is its verdict.
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

/// The cells of a case. One with methods of its own takes those of the atlas only where they are asked
/// for by name.
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
        .map(|m| (m.name.to_owned(), m.overrides(case, &deck).map(with)));
    let own = case.methods.iter();
    let own = own.map(|m| (m.name.clone(), Ok(with(m.set.clone()))));
    let methods = of_atlas.chain(own);
    let methods = methods.filter(|(name, _)| wanted(name));
    Ok(methods
        .map(|(method, overrides)| Job {
            row,
            method,
            overrides,
        })
        .collect())
}

/// A method that nobody has is a slip.
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

/// Runs one cell on a thread of its own.
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
    let ran = on_one_thread(|| {
        let deck = Deck::load(&case.deck, overrides).map_err(|e| e.to_string())?;
        let (model, _) = Model::from_deck(&deck).map_err(|e| e.to_string())?;
        run::run(&model, Nowhere, watch)
    });
    let run = match ran {
        Ok(ran) => {
            cell.cost = ran.cost;
            ran.ended
        }
        Err(why) => {
            cell.verdict = Verdict::Broken(why);
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

/// Procedures and their increments, in the order in which they first come; none if one solved all.
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
