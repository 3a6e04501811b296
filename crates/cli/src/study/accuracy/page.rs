//! Page of the study as Markdown, and the tables beside it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::errors::Errors;
use super::front::{FASTER, beaten, front};
use super::outcome::{Outcome, Studied};
use super::own_error::own_error;
use super::scene::{Group, Origin};
use crate::study::expect::percent;

/// File name of the chart beside a `scene.toml`.
pub const CHART: &str = "chart.svg";
/// File name of the table beside a `scene.toml`.
pub const TABLE: &str = "table.csv";

/// Promised error of the default's peak [-].
const PROMISED: f64 = 0.01;

/// The page. Charts and tables lie in `folder` beside it. Sections of scenes that were not run are copied from the
/// page `before`.
pub fn page(all: &[Studied], advice: &str, folder: &str, before: &str) -> String {
    let mut page = String::from("# Accuracy against speed\n\n");
    if !advice.trim().is_empty() {
        let _ = writeln!(page, "{}\n", advice.trim());
    }
    page.push_str(
        "Each chart shows one scene with each of the choices that a user has: the error against a reference of the\n\
         same scene, over the CPU time of the solver relative to that of the default, measured together. The error is\n\
         the larger one of those of peak and energy (area under the curve, to its end). The tables have both, and the\n\
         root mean square of the difference over the reference's peak. A choice is on the front if no other choice is\n\
         as fast and more accurate, or as accurate and faster; errors below the uncertainty of the reference count as\n\
         equal. A choice without an error did not reach the end.\n\n\
         *Cracks* is the overlap of the crack pattern with that of the reference at the end, in elevation. A cell of\n\
         10 mm is cracked if it has an element with a damage of one half or a crack of 0.05 mm, or a joint that has\n\
         lost half of its bond. The overlap is the number of cells that are cracked in both patterns over the number\n\
         of those cracked in either, where neighbouring cells count as the same. An element cracks as a whole: coarse\n\
         elements cover more cells than fine ones, which alone reduces the overlap.\n\n",
    );
    if let Some(studied) = all.first() {
        let command = studied.scene.command();
        let _ = writeln!(
            page,
            "`{command}` repeats the study, with `--only` one scene; `--references` computes the references.\n"
        );
    }
    let mut sections = sections(before);
    for studied in all {
        sections.insert(studied.scene.number, section(studied, folder));
    }
    let sections: Vec<&str> = sections.values().map(|s| s.trim_end()).collect();
    page.push_str(&sections.join("\n\n"));
    page.push('\n');
    page
}

/// Sections of a page by the number of their scene.
fn sections(page: &str) -> BTreeMap<u32, String> {
    let parts = page.split("\n## ").skip(1);
    let numbered = parts.filter_map(|part| {
        let number = part.split(' ').next()?.parse().ok()?;
        Some((number, format!("## {part}")))
    });
    numbered.collect()
}

fn section(studied: &Studied, folder: &str) -> String {
    let scene = &studied.scene;
    let at = format!("{folder}/{}", link(&scene.folder));
    let mut text = format!("## {}\n\n{}\n\n", scene.name(), scene.what.trim());
    let _ = writeln!(
        text,
        "![{}: errors over times]({at}/{CHART})\n",
        scene.name()
    );
    if !scene.says.trim().is_empty() {
        let _ = writeln!(text, "{}\n", scene.says.trim());
    }
    let _ = writeln!(text, "{}\n", verdict(studied));
    let _ = writeln!(text, "{}\n", reference(studied));
    text.push_str(
        "| Choice | | peak | energy | RMS | cracks | CPU, ratio | CPU s | wall, ratio | wall s | solves | front |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let on = front(&studied.points(), scene.reference.uncertainty);
    let ratios = studied.ratios();
    for (i, outcome) in studied.outcomes.iter().enumerate() {
        let errors = told(&outcome.errors);
        let cracks = outcome.cracks.map_or_else(String::new, unsigned);
        let _ = writeln!(
            text,
            "| {} | {} | {errors} | {cracks} | {} | {} | {} | {} | {} | {} |",
            outcome.choice.name,
            group(outcome),
            number(ratios[i][0]),
            number(outcome.cpu_seconds()),
            number(ratios[i][1]),
            number(outcome.wall_seconds()),
            outcome.cost.iterations,
            if on.contains(&i) { "×" } else { "" },
        );
    }
    text.push_str(&peers(studied));
    let _ = write!(
        text,
        "\nTimes: {} [The table]({at}/{TABLE}) has more digits.",
        studied.sitting
    );
    if !scene.set.is_empty() {
        let all = scene.set.iter().map(|(k, v)| format!("`{k}={v}`"));
        let all: Vec<String> = all.collect();
        let deck = scene.deck.file_name().unwrap_or_default();
        let deck = deck.to_string_lossy();
        let _ = write!(text, " The scene is `{deck}` with {}.", all.join(", "));
    }
    let _ = writeln!(text, "\n");
    text.push_str(&settings(studied));
    text
}

/// Errors as three cells of a row.
fn told(errors: &Result<Errors, String>) -> String {
    match errors {
        Ok(e) => format!(
            "{} | {} | {}",
            percent(e.peak),
            percent(e.energy),
            unsigned(e.rms)
        ),
        Err(why) => format!("{} | | ", why.replace('|', "\\|").replace('\n', " ")),
    }
}

/// Rows of the peers, and the differences of their models.
fn peers(studied: &Studied) -> String {
    let (mut rows, mut differ) = (String::new(), String::new());
    for (peer, errors) in studied.peers() {
        let name = &peer.name;
        let (ratio, cpu) = (number(peer.ratio()), number(peer.cpu));
        let _ = writeln!(
            rows,
            "| {name} | peer | {} | | {ratio} | {cpu} | | | | |",
            told(&errors)
        );
        let ours = number(peer.default_cpu);
        let _ = writeln!(
            differ,
            "\n*{name}*, measured separately, where the default took {ours} s of CPU. {}",
            peer.differs.trim()
        );
    }
    rows + &differ
}

/// Table of the keys that each choice sets.
fn settings(studied: &Studied) -> String {
    let mut text = String::from("| Choice | sets |\n|---|---|\n");
    for outcome in &studied.outcomes {
        let choice = &outcome.choice;
        let mut set: Vec<String> = choice
            .set
            .iter()
            .map(|(k, v)| format!("`{k}={v}`"))
            .collect();
        if choice.threads > 1 {
            set.push(format!("{} threads", choice.threads));
        }
        if choice.factor != 1.0 {
            set.push(format!("forces times {}", choice.factor));
        }
        let _ = writeln!(
            text,
            "| {} | {} |",
            choice.name,
            set.join(", ").replace('|', "\\|")
        );
    }
    text
}

/// Statement on whether the default fulfils its requirements.
fn verdict(studied: &Studied) -> String {
    let points = studied.points();
    let floor = studied.scene.reference.uncertainty;
    let mut of_default = studied.outcomes.iter().enumerate();
    let Some((i, default)) = of_default.find(|(_, o)| o.choice.group == Group::Default) else {
        return "The default was not run.".to_owned();
    };
    let Ok(errors) = &default.errors else {
        return "**The default does not reach the end.**".to_owned();
    };
    let within = if errors.peak.abs() <= PROMISED {
        format!(
            "The default's peak is within 1 % of the reference ({})",
            percent(errors.peak)
        )
    } else {
        format!(
            "**The default's peak is not within 1 % of the reference** ({})",
            percent(errors.peak)
        )
    };
    let times: Vec<f64> = points.iter().map(|point| point.0).collect();
    let both = studied
        .outcomes
        .iter()
        .map(|o| o.errors.as_ref().ok().copied());
    let both: Vec<Option<Errors>> = both.collect();
    let faster = match beaten(&times, &both, i, floor) {
        None => format!(
            "no other choice is as accurate in both peak and energy and takes at most {} of its time.",
            percent(FASTER).trim_start_matches('+')
        ),
        Some(by) => format!(
            "**{} is as accurate in both peak and energy in {} of its time.**",
            studied.outcomes[by].choice.name,
            percent(points[by].0).trim_start_matches('+')
        ),
    };
    let front = if front(&points, floor).contains(&i) {
        "on the front"
    } else {
        "not on the front"
    };
    format!("{within} and {front}; {faster}")
}

fn reference(studied: &Studied) -> String {
    let scene = &studied.scene;
    let (reference, number) = (&scene.reference, scene.number);
    let made = match &reference.origin {
        Origin::Run(choice) => {
            let set: Vec<String> = choice
                .set
                .iter()
                .map(|(k, v)| format!("`{k}={v}`"))
                .collect();
            format!(
                "`{} --only {number} --references`, with {}",
                scene.command(),
                set.join(", ")
            )
        }
        Origin::Command(command) => command.trim().to_owned(),
    };
    let uncertainty = unsigned(reference.uncertainty);
    let how = reference.how.trim();
    let own = own_error(studied).map_or_else(String::new, |own| format!(" {own}"));
    format!("Reference: {how} Its uncertainty: {uncertainty}. Made by {made}.{own}")
}

fn group(outcome: &Outcome) -> &'static str {
    match outcome.choice.group {
        Group::Default => "",
        group => group.name(),
    }
}

fn unsigned(part: f64) -> String {
    percent(part).trim_start_matches('+').to_owned()
}

/// A number with three significant digits.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let places = 2 - value.abs().max(1e-3).log10().floor() as i32;
    format!("{value:.*}", places.max(0) as usize)
}

/// All results of a scene as CSV.
pub fn table(studied: &Studied) -> String {
    let mut text = format!("# {}\n", studied.sitting);
    text.push_str(
        "choice,group,peak,peak_error,energy_error,rms,cracks,cpu_s,cpu_ratio,wall_s,wall_ratio,threads,increments,solves,cuts,energy_imbalance,why\n",
    );
    for (outcome, ratio) in studied.outcomes.iter().zip(studied.ratios()) {
        let (errors, why) = (numbers(&outcome.errors), why(&outcome.errors));
        let cost = &outcome.cost;
        let _ = writeln!(
            text,
            "{},{},{:.6},{:.6},{:.6},{:.6},{:.4},{:.4},{:.4},{:.4},{:.4},{},{},{},{},{:.1e},{why}",
            outcome.choice.name,
            outcome.choice.group.name(),
            outcome.peak,
            errors[0],
            errors[1],
            errors[2],
            outcome.cracks.unwrap_or(f64::NAN),
            outcome.cpu_seconds(),
            ratio[0],
            outcome.wall_seconds(),
            ratio[1],
            outcome.choice.threads,
            cost.increments,
            cost.iterations,
            cost.cutbacks,
            outcome.energy,
        );
    }
    text + &peer_rows(studied)
}

/// A measured table with its rows of peers replaced by the present ones.
pub fn with_peers(measured: &str, studied: &Studied) -> String {
    let is_peer = |line: &&str| line.split(',').nth(1) == Some("peer");
    let kept = measured.lines().filter(|line| !is_peer(line));
    let kept: String = kept.flat_map(|line| [line, "\n"]).collect();
    kept + &peer_rows(studied)
}

fn peer_rows(studied: &Studied) -> String {
    let mut text = String::new();
    for (peer, errors) in studied.peers() {
        let (of, why) = (numbers(&errors), why(&errors));
        let _ = writeln!(
            text,
            "{},peer,{:.6},{:.6},{:.6},{:.6},NaN,{:.4},{:.4},NaN,NaN,1,NaN,NaN,NaN,NaN,{why}",
            peer.name,
            peer.peak(),
            of[0],
            of[1],
            of[2],
            peer.cpu,
            peer.ratio(),
        );
    }
    text
}

/// Errors of peak, energy and RMS; NaN if there are none.
fn numbers(errors: &Result<Errors, String>) -> [f64; 3] {
    let errors = errors.as_ref().ok();
    errors.map_or([f64::NAN; 3], |e| [e.peak, e.energy, e.rms])
}

/// Reason for missing errors, as a field of CSV.
fn why(errors: &Result<Errors, String>) -> String {
    // CSV doubles a quotation mark within quotation marks.
    let why = errors.as_ref().err();
    why.map_or_else(String::new, |w| format!("\"{}\"", w.replace('"', "\"\"")))
}

/// Name of a folder for links, without blanks.
pub fn link(folder: &Path) -> String {
    let name = folder.file_name().unwrap_or(folder.as_os_str());
    name.to_string_lossy().replace(' ', "%20")
}
