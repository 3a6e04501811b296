//! `wythe study strategies`: one deck by every modelling strategy.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::arguments::Strategies;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::plot::write;
use crate::say::{print, tell};
use crate::study::StudyError;
use crate::study::strategies::{Options, Row, chart, page, strategies as run};
use wythe_core::command::argument;
use wythe_core::deck::{Deck, Strategy};

use super::{failed, other};

/// The page and its picture.
const PAGE: &str = "strategies.md";
const PICTURE: &str = "strategies.svg";

/// Runs the study. `program` is the command that runs a deck.
pub fn strategies(arguments: &Strategies, program: &[OsString]) -> Result<(), Failure> {
    let deck = Deck::load(&arguments.model, &arguments.overrides)?;
    let title = if deck.title.is_empty() {
        arguments.model.display().to_string()
    } else {
        deck.title.clone()
    };
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| beside(&arguments.model));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let options = Options {
        program: program.to_vec(),
        deck: arguments.model.clone(),
        set: arguments.overrides.clone(),
        out: out.clone(),
        strategies: chosen(&arguments.only)?,
        limit: Duration::from_secs_f64(arguments.limit),
        threads: arguments.threads.map_or(cores, usize::from),
    };
    let interrupt = Interrupt::listen();
    let progress = |row: &Row| {
        let force = row.force();
        let force = force.map_or_else(|| "no force".to_owned(), |f| format!("{f:.2} kN"));
        tell!(
            "{:10} {force}, {:.1} s, {}",
            row.strategy.name(),
            row.cpu_s,
            row.ended
        );
    };
    let rows = run(&options, &progress, &|| interrupt.requested())?;
    let picture = chart(&rows, &title).map_err(|why| failed(&out.join(PICTURE), other(why)))?;
    if let Some(svg) = &picture {
        write(&out, PICTURE, svg.as_bytes())?;
    }
    let text = page(&rows, &title, picture.map(|_| PICTURE), &command(arguments));
    write(&out, PAGE, text.as_bytes())?;
    if interrupt.requested() {
        return Err(Failure::Interrupted);
    }
    print(&format!(
        "{text}\nwritten to {}\n",
        argument(&out.join(PAGE))
    ))
}

/// Folder of the study beside the deck.
fn beside(deck: &Path) -> PathBuf {
    deck.with_extension("strategies")
}

/// Strategies of these names; all if none is named.
fn chosen(names: &[String]) -> Result<Vec<Strategy>, Failure> {
    let known = || Strategy::ALL.iter().map(|strategy| strategy.name());
    if let Some(name) = names
        .iter()
        .find(|name| !known().any(|k| k == name.as_str()))
    {
        return Err(StudyError::Unknown {
            kind: "strategy",
            name: name.clone(),
            known: known().collect::<Vec<_>>().join(", "),
        }
        .into());
    }
    let wanted =
        |strategy: &Strategy| names.is_empty() || names.iter().any(|name| name == strategy.name());
    Ok(Strategy::ALL.into_iter().filter(wanted).collect())
}

/// Command that produces the page.
fn command(arguments: &Strategies) -> String {
    let mut command = format!("wythe study strategies {}", argument(&arguments.model));
    for (key, value) in &arguments.overrides {
        command += &format!(" --set {}", argument(Path::new(&format!("{key}={value}"))));
    }
    if !arguments.only.is_empty() {
        command += &format!(" --only {}", arguments.only.join(","));
    }
    command + &format!(" --limit {}", arguments.limit)
}
