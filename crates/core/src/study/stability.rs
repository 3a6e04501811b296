//! The stability atlas: every case through every method.

use std::panic::AssertUnwindSafe;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::case::{Case, Short, StudyError};
use super::cell::{Cell, Cost, Verdict};
use super::judge::{Ended, judge};
use super::method::METHODS;
use crate::model::{Deck, Model};
use crate::results::summary::EnergyBalance;
use crate::results::{Frame, HistoryRow, Recorder, Summary, usage};
use crate::solve;

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
    cell: usize,
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
    let mut rows = Vec::new();
    for case in cases {
        if options.short && case.short == Short::None {
            continue;
        }
        let of_row = jobs_of(case, rows.len(), options)?;
        let cells = of_row.len();
        jobs.extend(of_row);
        rows.push((case, vec![None; cells]));
    }
    known_methods(cases, options)?;
    let (queue, done) = (Mutex::new(jobs.into_iter()), Mutex::new(rows));
    let next = || queue.lock().ok().and_then(|mut jobs| jobs.next());
    // Plain threads, each with a pool of one: a worker of a shared pool would take up another cell
    // while it waits, and its time would be nobody's.
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.max(1) {
            scope.spawn(|| {
                while let Some(job) = next().filter(|_| !stop()) {
                    let case = match done.lock() {
                        Ok(rows) => rows[job.row].0,
                        Err(_) => return,
                    };
                    let cell = run(case, &job, options, stop);
                    progress(case, &cell);
                    if let Ok(mut rows) = done.lock() {
                        rows[job.row].1[job.cell] = Some(cell);
                    }
                }
            });
        }
    });
    let rows = done.into_inner().unwrap_or_default();
    let interrupted = stop();
    let rows = rows
        .into_iter()
        .map(|(case, cells)| Row {
            case: case.clone(),
            cells: cells.into_iter().flatten().collect(),
        })
        .collect();
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
        .enumerate()
        .map(|(cell, (method, overrides))| Job {
            row,
            cell,
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
fn run(case: &Case, job: &Job, options: &Options, stop: &(dyn Fn() -> bool + Sync)) -> Cell {
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
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool,
        Err(error) => {
            cell.verdict = Verdict::Broken(error.to_string());
            return cell;
        }
    };
    // A panic is a bug of ours, and a finding: the other cells go on.
    let outcome = std::panic::catch_unwind(AssertUnwindSafe(|| {
        pool.install(|| solved(case, overrides, options.limit, stop))
    }));
    let (run, summary, seconds) = match outcome {
        Ok(Ok(solved)) => solved,
        Ok(Err(why)) => {
            cell.verdict = Verdict::Broken(why);
            return cell;
        }
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            cell.verdict = Verdict::Broken(format!("panic: {}", text.unwrap_or("no message")));
            return cell;
        }
    };
    cell.cost = Cost {
        increments: summary.increments,
        iterations: summary.iterations,
        cutbacks: summary.cutbacks,
        seconds,
    };
    cell.energy = run.energy;
    let imbalances = run.rows.iter().map(|row| row.out_of_balance);
    cell.out_of_balance = imbalances.fold(0.0, f64::max);
    cell.procedures = procedures(&run.rows);
    (cell.verdict, cell.measured) = judge(case, options.short, &run);
    cell
}

/// The run of a deck, with its summary and CPU seconds.
fn solved(
    case: &Case,
    overrides: &[(String, String)],
    limit: Duration,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<(Ended, Summary, f64), String> {
    let deck = Deck::load(&case.deck, overrides).map_err(|e| e.to_string())?;
    let (model, _) = Model::from_deck(&deck).map_err(|e| e.to_string())?;
    let (started, cpu) = (Instant::now(), usage::thread_cpu_seconds());
    let mut kept = Kept {
        rows: Vec::new(),
        balance: EnergyBalance::default(),
        ends: started + limit,
        stop,
    };
    let summary = solve::run(&model, &mut kept).map_err(|e| e.to_string())?;
    let seconds = usage::thread_cpu_seconds()
        .zip(cpu)
        .map_or(started.elapsed().as_secs_f64(), |(now, then)| now - then);
    let run = Ended {
        status: summary.status,
        message: summary.message.clone(),
        tolerances: model.steps.iter().map(|s| s.tolerance.residual).collect(),
        probes: model.columns(),
        energy: kept.balance.error(),
        rows: kept.rows,
    };
    Ok((run, summary, seconds))
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

/// Keeps rows and watches the clock.
struct Kept<'a> {
    rows: Vec<HistoryRow>,
    balance: EnergyBalance,
    ends: Instant,
    stop: &'a (dyn Fn() -> bool + Sync),
}

impl Recorder for Kept<'_> {
    fn take(
        &mut self,
        _model: &Model,
        row: &HistoryRow,
        _frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        self.balance.push(row);
        self.rows.push(row.clone());
        Ok(Instant::now() < self.ends && !(self.stop)())
    }
}
