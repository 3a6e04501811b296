//! `wythe limit`: limit analysis of rigid units.

use std::path::Path;
use std::time::Instant;

use wythe_core::command::argument;
use wythe_core::deck::quantity::Pressure;
use wythe_core::error::Warning;
use wythe_core::limit::{LimitAnalysis, LimitError, LimitSettings, MOST_PROGRAMS, Progress};
use wythe_core::model::Model;
use wythe_core::results::FoundLimit;
use wythe_core::results::limit::FILES;
use wythe_core::results::output::spare_inputs;

use crate::arguments::Limit;
use crate::failure::Failure;
use crate::findings::{self, Sound};
use crate::plot::write_picture;
use crate::say::{print, tell};

/// Part of the associated factor below which a scene carries almost nothing.
const NOTHING: f64 = 1e-3;

/// Reads the model, finds the factor and prints it.
pub fn limit(arguments: &Limit) -> Result<(), Failure> {
    let path = &arguments.model;
    let settings = settings(arguments)?;
    let found = findings::read(path, &arguments.with);
    let Sound {
        deck,
        model,
        warnings,
    } = found.map_err(|unsound| unsound.tell(path))?;
    // The JSON object has them.
    if !arguments.json {
        warn(&warnings);
    }
    if let Some(out) = &arguments.out {
        spare_inputs(out, FILES, &deck.inputs())?;
    }
    let mut limit = analysed(model, &settings)?;
    limit.warnings = warnings;
    if let Some(file) = &arguments.picture {
        write_picture(file, limit.picture(), &deck.inputs())?;
    }
    let written = match &arguments.out {
        Some(out) => limit.write(out)?,
        None => Vec::new(),
    };
    if !arguments.json {
        let files = written.iter().map(|path| format!("{}\n", path.display()));
        let files: String = files.collect();
        return print(&(text(&limit.model, &limit.found, &settings) + &files));
    }
    print(&json(&limit)?)
}

/// Prints the warnings about a deck on standard error, as those of a run.
fn warn(warnings: &[Warning]) {
    for warning in warnings {
        tell!("warning: {warning}");
    }
}

/// `wythe run` with `strategy = "limit"`: prints the factor and writes the files of a limit analysis to the folder.
/// `quiet`: warnings about the deck are in the files alone.
pub fn in_folder(sound: Sound, folder: &Path, quiet: bool) -> Result<(), Failure> {
    let Sound {
        deck,
        model,
        warnings,
    } = sound;
    if !quiet {
        warn(&warnings);
    }
    let settings = LimitSettings::default();
    spare_inputs(folder, FILES, &deck.inputs())?;
    let mut limit = analysed(model, &settings)?;
    limit.warnings = warnings;
    limit.write(folder)?;
    let text = text(&limit.model, &limit.found, &settings);
    print(&format!("{text}results in {}\n", argument(folder)))
}

/// Limit analysis, which tells its progress once it takes long.
fn analysed(model: Model, settings: &LimitSettings) -> Result<FoundLimit, Failure> {
    let start = Instant::now();
    let mut told = |progress: Progress| {
        let seconds = start.elapsed().as_secs();
        if seconds < LONG {
            return;
        }
        let limit = factor_or_force(progress.factor, progress.force);
        match progress.programs {
            0 => tell!(
                "associated: {limit}, an upper bound, after {seconds} s; friction without dilatancy needs some twenty \
                 such programs: --associated ends here"
            ),
            programs => {
                tell!("program {programs} of at most {MOST_PROGRAMS}: {limit}, after {seconds} s");
            }
        }
    };
    FoundLimit::of_told(model, settings, &mut told).map_err(|why| failure(&why))
}

/// A limit in words: the force along a drive [kN], or the factor of the live loads.
fn factor_or_force(factor: f64, force: Option<f64>) -> String {
    match force {
        Some(force) => format!("{force:.4} kN"),
        None => format!("factor {factor:.6}"),
    }
}

/// Seconds from which on progress is told.
const LONG: u64 = 3;

/// The answer as JSON.
fn json(limit: &FoundLimit) -> Result<String, Failure> {
    let failed = |error: serde_json::Error| {
        Failure::InputOutput(miette::Report::msg(format!("no JSON: {error}")))
    };
    limit.table().map_err(failed)
}

fn failure(why: &LimitError) -> Failure {
    let report = miette::miette!(help = why.advice(), "{why}");
    match why {
        LimitError::Solver(_) => Failure::NotConverged(report),
        _ => Failure::Model(report),
    }
}

/// Settings of the command line.
fn settings(arguments: &Limit) -> Result<LimitSettings, Failure> {
    let strength = arguments.strength.as_deref().map(pressure).transpose()?;
    let along = arguments.along.as_deref().map(direction).transpose()?;
    Ok(LimitSettings {
        associated: arguments.associated,
        bonded: arguments.bonded,
        strength,
        along,
        ..LimitSettings::default()
    })
}

/// A pressure above 0 [MPa].
fn pressure(text: &str) -> Result<f64, Failure> {
    let value = text.parse().map_or_else(
        |_| serde_json::json!(text),
        |number: f64| serde_json::json!(number),
    );
    let found = serde_json::from_value::<Pressure>(value)
        .ok()
        .map(Pressure::get);
    found.filter(|p| *p > 0.0).ok_or_else(|| {
        Failure::Model(miette::miette!(
            help = "write it like this: --strength '8 MPa'",
            "--strength: `{text}` is no pressure above 0"
        ))
    })
}

/// `x`, `-y`, … as a vector.
fn direction(text: &str) -> Result<[f64; 3], Failure> {
    let (name, sign) = match text.strip_prefix('-') {
        Some(name) => (name, -1.0),
        None => (text, 1.0),
    };
    let axis = ["x", "y", "z"].iter().position(|axis| *axis == name);
    let Some(axis) = axis else {
        return Err(Failure::Model(miette::miette!(
            help = "x, -x, y, -y, z or -z",
            "--along: `{text}` is no direction"
        )));
    };
    let mut along = [0.0; 3];
    along[axis] = sign;
    Ok(along)
}

/// The result as text.
fn text(model: &Model, found: &LimitAnalysis, settings: &LimitSettings) -> String {
    let mut text = format!("{}\n", model.title);
    let mut line = |head: &str, what: String| text += &format!("  {head:12}{what}\n");
    line("live load", found.live_load.clone());
    line("limit", factor_or_force(found.factor, found.force));
    let joints = if settings.bonded {
        "with their bond"
    } else {
        "dry"
    };
    let flow = if settings.associated {
        "associated: they open as they slide"
    } else {
        "without dilatancy"
    };
    line("joints", format!("{joints}, {flow}"));
    if !settings.associated {
        let unit = if found.force.is_some() { 1e-3 } else { 1.0 };
        line(
            "associated",
            format!("{:.6}, an upper bound", unit * found.associated_factor),
        );
    }
    let certificate = if settings.associated {
        format!(
            "the mechanism gives the same factor within {:.0e}",
            found.gap
        )
    } else {
        format!(
            "joints that slide open or close by {:.1} % of the work of the live load",
            100.0 * found.opening_work
        )
    };
    line("certificate", certificate);
    let [bodies, joints, corners] = found.sizes;
    line(
        "sizes",
        format!("{bodies} bodies that can move, {joints} joints, {corners} corners"),
    );
    if let Some(axis) = found.mirror {
        line(
            "symmetry",
            format!("about a plane across {axis}: half of the forces are unknown"),
        );
    }
    let moving = found.mechanism.iter().filter(|unit| {
        let speed = unit.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        speed > 1e-2
    });
    line("mechanism", format!("{} units move", moving.count()));
    if let Some(note) = &found.note {
        text += &format!("note: {note}\n");
    }
    text + &warnings(found)
}

/// Warnings about a factor.
fn warnings(found: &LimitAnalysis) -> String {
    let mut text = String::new();
    if found.factor.abs() < NOTHING * found.associated_factor.abs() {
        text += "warning: without dilatancy the lowest state carries almost nothing: joints that only the live load or a \
                 held beam presses may be without pressure; the associated factor is that of joints which stay pressed\n";
    }
    if let Some(light) = &found.light_body {
        text += &format!(
            "warning: the load on {} is {:.0e} of that on the heaviest body to which it is joined, directly or over \
             others; programs are solved to 1e-9 of that load and may miss a mechanism of the light body alone: leave \
             it out, or analyse it by itself\n",
            light.name, light.part
        );
    }
    if !found.converged {
        text += &format!(
            "warning: in the mechanisms of {} programs joints open or close as they slide; the last factor is given\n",
            found.programs
        );
    }
    text
}
