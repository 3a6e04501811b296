//! `wythe study`: runs many models side by side, evaluates them and reports them on one page.

mod accuracy;
mod strategies;
mod validation;
mod zoo;

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::study::{self, Case, Cell, Options, StudyError};
use wythe_core::error::IoError;
use wythe_core::files::write_whole;

use crate::arguments::{Stability, Study};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::say::print;
use crate::say::tell;

/// The page and its picture.
const PAGE: &str = "stability.md";
const PICTURE: &str = "stability.svg";

/// Runs the requested study. `program` is the command that runs a deck in a process of its own.
pub fn study(arguments: &Study, program: &[OsString]) -> Result<(), Failure> {
    match arguments {
        Study::Stability(arguments) => stability(arguments),
        Study::AccuracySpeed(arguments) => accuracy::accuracy_speed(arguments),
        Study::Validation(arguments) => validation::validation(arguments),
        Study::Strategies(arguments) => strategies::strategies(arguments, program),
        Study::Zoo(arguments) => zoo::zoo(arguments, program),
    }
}

fn stability(arguments: &Stability) -> Result<(), Failure> {
    // A number without a letter selects all cases of that number.
    let is = |case: &Case, n: &str| case.id() == n || case.number.to_string() == n;
    let cases = chosen(
        study::cases(&arguments.cases)?,
        "case",
        &arguments.only,
        Case::id,
        is,
    )?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let options = Options {
        methods: arguments.methods.clone(),
        short: arguments.short,
        limit: Duration::from_secs_f64(arguments.limit),
        jobs: arguments.jobs.map_or(threads, usize::from),
    };
    // A part of the atlas must not replace the stored whole.
    let whole = arguments.only.is_empty() && arguments.methods.is_empty() && !arguments.short;
    let out = match &arguments.out {
        Some(out) => Some(out.as_path()),
        None => whole.then(|| Path::new("docs")),
    };
    let (interrupt, lines) = (Interrupt::listen(), Mutex::new(()));
    let count = AtomicUsize::new(0);
    let progress = |case: &Case, cell: &Cell| {
        // The lock keeps the lines of several threads apart.
        let _line = lines.lock();
        let number = count.fetch_add(1, Ordering::Relaxed) + 1;
        tell!("{number:4}  {}", line(case, cell, arguments.verbose));
    };
    let atlas = study::stability(&cases, &options, &progress, &|| interrupt.requested())?;
    if atlas.interrupted {
        return Err(Failure::Interrupted);
    }
    let page = study::report(&atlas, PICTURE);
    let Some(out) = out else {
        return print(&page);
    };
    let picture = study::picture(&atlas).map_err(|why| failed(&out.join(PICTURE), other(why)))?;
    std::fs::create_dir_all(out).map_err(|why| failed(out, why))?;
    for (name, text) in [(PICTURE, &picture), (PAGE, &page)] {
        let path = out.join(name);
        write_whole(&path, text.as_bytes()).map_err(|why| failed(&path, why))?;
    }
    print(&format!("written to {}\n", out.join(PAGE).display()))
}

/// Selected cases; all if none are named. `kind` is the noun for errors, `id` gives the name of a case, `is`
/// decides whether a name means a case.
fn chosen<C>(
    cases: Vec<C>,
    kind: &'static str,
    only: &[String],
    id: impl Fn(&C) -> String,
    is: impl Fn(&C, &str) -> bool,
) -> Result<Vec<C>, StudyError> {
    if let Some(name) = only.iter().find(|n| !cases.iter().any(|c| is(c, n))) {
        let known: Vec<String> = cases.iter().map(&id).collect();
        return Err(StudyError::Unknown {
            kind,
            name: name.clone(),
            known: known.join(", "),
        });
    }
    let wanted = |case: &C| only.is_empty() || only.iter().any(|n| is(case, n));
    Ok(cases.into_iter().filter(wanted).collect())
}

/// Progress line of a cell, with the measured values if `verbose`.
fn line(case: &Case, cell: &Cell, verbose: bool) -> String {
    let cost = &cell.cost;
    let mut line = format!(
        "{:3} {:30} {:14} {}; {} increments, {} solves, {} cuts, {:.2} s",
        case.id(),
        case.title,
        cell.method,
        study::brief(cell),
        cost.increments,
        cost.iterations,
        cost.cutbacks,
        cost.seconds
    );
    if verbose {
        for text in cell.why().into_iter().chain(cell.measured.iter().cloned()) {
            // Writing to a string does not fail.
            let _ = write!(line, "\n        {text}");
        }
    }
    line
}

/// Text of a page before it is replaced; empty if there is none.
fn page_before(file: &Path) -> Result<String, Failure> {
    match std::fs::read_to_string(file) {
        Err(why) if why.kind() == ErrorKind::NotFound => Ok(String::new()),
        read => read.map_err(|why| failed(file, why)),
    }
}

/// An error in words.
fn other(why: String) -> std::io::Error {
    std::io::Error::other(why)
}

fn failed(path: &Path, why: std::io::Error) -> Failure {
    Failure::input_output(IoError {
        path: path.to_owned(),
        why,
    })
}
