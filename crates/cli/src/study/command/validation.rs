//! `wythe study validation`: results beside tests, exact solutions and other models.

use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use crate::study::Verdict;
use crate::study::validation::{
    Case, Options, Outcome, Validated, cases, chart, index, page, table, validate,
};

use super::{chosen, failed, other, page_before};
use crate::arguments::Validation;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::plot::write;
use crate::say;
use crate::say::print;

/// File of a case's page; code hosting sites show a README with its folder.
const PAGE: &str = "README.md";

/// File of the page that lists the cases, beside their folder.
const INDEX: &str = "validation.md";

pub fn validation(arguments: &Validation) -> Result<(), Failure> {
    let only: Vec<String> = arguments.only.iter().map(u32::to_string).collect();
    let number = |case: &Case| case.number.to_string();
    let is = |case: &Case, n: &str| number(case) == n;
    let cases = chosen(cases(&arguments.cases)?, "case", &only, number, is)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let options = Options {
        short: arguments.short,
        limit: Duration::from_secs_f64(arguments.limit),
        jobs: arguments.jobs.map_or(threads, usize::from),
        folder: arguments.runs.clone(),
    };
    let (interrupt, lines) = (Interrupt::listen(), Mutex::new(()));
    let progress = |case: &Case, outcome: &Outcome| {
        // The lock keeps the lines of several threads apart.
        let _lines = lines.lock();
        say::text(&told(case, outcome));
    };
    let all = validate(&cases, &options, &progress, &|| interrupt.requested());
    if interrupt.requested() {
        return Err(Failure::Interrupted);
    }
    let out = match &arguments.out {
        Some(out) => out.as_path(),
        // The pages report the full forms only.
        None if arguments.short => return print(&summary(&all)),
        None => arguments.cases.as_path(),
    };
    for validated in &all {
        pages(&out.join(validated.case.folder_name()), validated)?;
    }
    let beside = out.parent().unwrap_or(Path::new("."));
    // A study of some cases leaves the rows of the others unchanged.
    let before = match arguments.only.as_slice() {
        [] => String::new(),
        _ => page_before(&beside.join(INDEX))?,
    };
    let name = out.file_name().unwrap_or(out.as_os_str()).to_string_lossy();
    write(beside, INDEX, index(&all, &name, &before).as_bytes())?;
    print(&format!("{}written to {}\n", summary(&all), out.display()))
}

/// Writes the page of a case and the files beside it.
fn pages(folder: &Path, validated: &Validated) -> Result<(), Failure> {
    let case = &validated.case;
    for it in &case.charts {
        let file = format!("{}.svg", it.name);
        let svg = chart(it, validated).map_err(|why| failed(&folder.join(&file), other(why)))?;
        write(folder, &file, svg.as_bytes())?;
    }
    for outcome in &validated.outcomes {
        let name = &outcome.name;
        for (what, svg) in [("scene", &outcome.scene), ("cracks", &outcome.cracks)] {
            if let Some(svg) = svg {
                write(folder, &format!("{name}_{what}.svg"), svg.as_bytes())?;
            }
        }
        // A run that failed leaves the files of an earlier run unchanged.
        if !outcome.history.rows(None).is_empty() {
            let table = table(case, outcome);
            write(folder, &format!("{name}.csv"), table.as_bytes())?;
        }
        // A deck that is already stored under this name is not rewritten, which keeps its comments.
        let file = format!("{name}.toml");
        let of_run = case.runs.iter().find(|r| r.name == *name).map(|r| &r.deck);
        if let Some(deck) = &outcome.deck
            && of_run != Some(&folder.join(&file))
        {
            write(folder, &file, deck.as_bytes())?;
        }
    }
    write(folder, PAGE, page(validated).as_bytes())?;
    Ok(())
}

/// Lines of a finished run.
fn told(case: &Case, outcome: &Outcome) -> String {
    let cost = &outcome.cost;
    let how = match &outcome.verdict {
        Verdict::Completed(_) => "holds".to_owned(),
        Verdict::Wrong(reasons) => format!("WRONG: {}", reasons.join("; ")),
        Verdict::Diverged(place, why) => format!("LOST in {place}: {why}"),
        Verdict::Stopped(place) => format!("STOPPED in {place}"),
        Verdict::Inapplicable(why) | Verdict::Broken(why) => format!("BROKEN: {why}"),
    };
    let mut text = format!(
        "{}, {}: {how}; {} increments, {} solves, {} cuts, {:.1} s\n",
        case.name(),
        outcome.name,
        cost.increments,
        cost.iterations,
        cost.cutbacks,
        cost.seconds
    );
    for measured in &outcome.measured {
        text.push_str(&format!("        {}\n", measured.text));
    }
    text
}

/// Number of runs that fulfil all requirements.
fn summary(all: &[Validated]) -> String {
    let outcomes = || all.iter().flat_map(|v| &v.outcomes);
    let held = outcomes().filter(|o| o.holds()).count();
    format!("{held} of {} runs as expected\n", outcomes().count())
}
