//! `wythe study zoo`: random walls, run with default settings only.

use std::ffi::OsString;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use crate::study::zoo::{Folder, Options, Wall, ZooRow, histogram, page, zoo as run};
use wythe_core::command::argument;
use wythe_core::deck::Strategy;

use super::{failed, other};
use crate::arguments::Zoo;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::plot::write;
use crate::say::print;

/// The page and its picture.
const PAGE: &str = "zoo.md";
const PICTURE: &str = "solves.svg";

/// Runs the study. `program` is the command that runs a deck.
pub fn zoo(arguments: &Zoo, program: &[OsString]) -> Result<(), Failure> {
    let seeds = listed(&arguments.seeds)?;
    let out = arguments.out.as_path();
    let folder = Folder::new(out);
    if arguments.decks_only {
        for &seed in &seeds {
            folder.write_deck(&Wall::drawn(seed))?;
        }
        let walls = out.join(Folder::WALLS);
        return print(&format!("{} decks in {}\n", seeds.len(), walls.display()));
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = arguments.threads.get();
    let options = Options {
        program: program.to_vec(),
        limit: Duration::from_secs_f64(arguments.limit),
        jobs: arguments.jobs.map_or((cores / threads).max(1), usize::from),
        threads,
        strategy: arguments.strategy,
        reference: arguments.reference,
        fresh: arguments.fresh,
    };
    let (interrupt, lines) = (Interrupt::listen(), Mutex::new(()));
    let progress = |row: &ZooRow| {
        // The lock keeps the lines of several threads apart.
        let _lines = lines.lock();
        crate::say::tell!("{}", told(row));
    };
    let rows = run(&seeds, &folder, &options, &progress, &|| {
        interrupt.requested()
    })?;
    let picture = histogram(&rows).map_err(|why| failed(&out.join(PICTURE), other(why)))?;
    if let Some(svg) = &picture {
        write(out, PICTURE, svg.as_bytes())?;
    }
    let picture = picture.map(|_| PICTURE);
    let text = page(&rows, picture, &command(&rows, arguments));
    write(out, PAGE, text.as_bytes())?;
    if interrupt.requested() {
        return Err(Failure::Interrupted);
    }
    print(&format!(
        "{}written to {}\n",
        summary(&rows),
        out.join(PAGE).display()
    ))
}

/// Largest accepted number of seeds; more are taken for a typing error.
const AT_MOST: u64 = 100_000;

/// Seeds in their order, without repetition.
fn listed(ranges: &[RangeInclusive<u64>]) -> Result<Vec<u64>, Failure> {
    let length = |r: &RangeInclusive<u64>| (r.end() - r.start()).saturating_add(1);
    let count = ranges.iter().map(length).fold(0, u64::saturating_add);
    if count > AT_MOST {
        return Err(Failure::Model(miette::miette!(
            help = "run them in parts, into a folder each",
            "{count} walls are more than {AT_MOST}"
        )));
    }
    let mut seeds = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for seed in ranges.iter().cloned().flatten() {
        if seen.insert(seed) {
            seeds.push(seed);
        }
    }
    Ok(seeds)
}

/// Command that produces the page.
fn command(rows: &[ZooRow], arguments: &Zoo) -> String {
    let mut ranges: Vec<(u64, u64)> = Vec::new();
    for row in rows {
        match ranges.last_mut() {
            Some((_, last)) if last.checked_add(1) == Some(row.seed) => *last = row.seed,
            _ => ranges.push((row.seed, row.seed)),
        }
    }
    let range = |&(a, b): &(u64, u64)| {
        if a == b {
            a.to_string()
        } else {
            format!("{a}..{b}")
        }
    };
    let seeds: Vec<String> = ranges.iter().map(range).collect();
    let mut command = format!("wythe study zoo --seeds {}", seeds.join(","));
    command += &format!(" --limit {}", arguments.limit);
    if arguments.strategy != Strategy::default() {
        command += &format!(" --strategy {}", arguments.strategy.name());
    }
    if arguments.reference {
        command += " --reference";
    }
    if arguments.out != Path::new(Zoo::OUT) {
        command += &format!(" --out {}", argument(&arguments.out));
    }
    command
}

/// Line of a finished wall.
fn told(row: &ZooRow) -> String {
    let percent =
        |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{:+.2} %", 100.0 * v));
    let mut line = format!(
        "{:4} {:12} {:9} {:13} {} increments, {} solves, {} cuts, {:.1} s",
        row.seed,
        row.load,
        row.bond,
        row.status,
        row.increments,
        row.solves,
        row.cutbacks,
        row.cpu_s
    );
    if row.energies_out() {
        line += &format!(", energies out by {}", percent(row.energy_balance_error));
    }
    if !row.reference_status.is_empty() {
        line += &format!(
            "; reference {}: peak {}, area {}",
            row.reference_status,
            percent(row.peak_difference),
            percent(row.area_difference)
        );
    }
    if !row.answered() && !row.message.is_empty() {
        line += &format!("\n     {}", row.message);
    }
    line
}

/// Number of walls that reached an answer.
fn summary(rows: &[ZooRow]) -> String {
    let answered = rows.iter().filter(|r| r.answered()).count();
    let good = rows.iter().filter(|r| r.good()).count();
    format!(
        "{answered} of {} walls completed or collapsed, {good} of them with nothing wrong\n",
        rows.len()
    )
}
