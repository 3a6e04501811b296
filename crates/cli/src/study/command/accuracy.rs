//! `wythe study accuracy-speed`: error against computing time of the choices that a user has.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use crate::study::StudyError;
use crate::study::accuracy::{
    CHART, Options, Outcome, PATTERN, Scene, Studied, TABLE, advice, chart, draft, link, page,
    read, renew, scenes, study, table, with_peers,
};
use miette::miette;
use wythe_core::deck::Deck;
use wythe_core::files::write_whole;

use super::{chosen, failed, other, page_before};
use crate::arguments::AccuracySpeed;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::plot::write;
use crate::say::print;
use crate::say::tell;

/// File of the page, beside the folder of the scenes.
const PAGE: &str = "accuracy-speed.md";
/// File of a scene in its folder.
const SCENE: &str = "scene.toml";

pub fn accuracy_speed(arguments: &AccuracySpeed) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let dir = match &arguments.model {
        Some(model) => drafted(model, arguments, &interrupt)?,
        None => arguments.scenes.clone(),
    };
    let only: Vec<String> = arguments.only.iter().map(u32::to_string).collect();
    let number = |scene: &Scene| scene.number.to_string();
    let is = |scene: &Scene, n: &str| number(scene) == n;
    let scenes = chosen(scenes(&dir)?, "scene", &only, number, is)?;
    let options = Options {
        short: arguments.short,
        limit: Duration::from_secs_f64(arguments.limit),
        jobs: arguments.jobs.get(),
        repeats: arguments.repeats.get(),
    };
    if arguments.references {
        return references(&scenes, options.limit, &interrupt);
    }
    if arguments.redraw {
        let out = arguments.out.as_ref().unwrap_or(&dir);
        let table = |scene: &Scene| read(scene, &out.join(scene.folder_name()).join(TABLE));
        let all: Result<Vec<Studied>, _> = scenes.iter().map(table).collect();
        let all = all.map_err(Failure::input_output)?;
        for studied in &all {
            let folder = out.join(studied.scene.folder_name());
            let path = folder.join(TABLE);
            let measured = std::fs::read_to_string(&path).map_err(|why| failed(&path, why))?;
            write(&folder, TABLE, with_peers(&measured, studied).as_bytes())?;
        }
        return written_out(&all, arguments, &dir, out);
    }
    if let Some(scene) = scenes.iter().find(|s| !s.reference.there()) {
        return Err(StudyError::NoReference {
            file: scene.reference.file.clone(),
            command: scene.command(),
            number: scene.number,
        }
        .into());
    }
    let lines = Mutex::new(());
    let progress = |scene: &Scene, outcome: &Outcome, repeat: usize| {
        // The lock keeps the lines of several threads apart.
        let _lines = lines.lock();
        tell!("{}", told(scene, outcome, repeat));
    };
    let all = study(&scenes, &options, &progress, &|| interrupt.requested());
    if interrupt.requested() {
        return Err(Failure::Interrupted);
    }
    let out = match &arguments.out {
        Some(out) if arguments.model.is_none() => out.as_path(),
        // The page reports the full forms only.
        None if arguments.short => return print(&summary(&all)),
        _ => dir.as_path(),
    };
    for studied in &all {
        let folder = out.join(studied.scene.folder_name());
        write(&folder, TABLE, table(studied).as_bytes())?;
    }
    written_out(&all, arguments, &dir, out)
}

/// Folder of scenes with the scene of `model` and its reference; both are created if they do not exist.
fn drafted(
    model: &Path,
    arguments: &AccuracySpeed,
    interrupt: &Interrupt,
) -> Result<PathBuf, Failure> {
    let file = model.canonicalize().map_err(|why| failed(model, why))?;
    let out = arguments.out.clone();
    let dir = out
        .unwrap_or_else(|| model.with_extension("accuracy"))
        .join("scenes");
    let name = file.file_stem().unwrap_or_default();
    let folder = dir.join(name);
    let scene = folder.join(SCENE);
    if scene.exists() && !arguments.overrides.is_empty() {
        return Err(Failure::Model(miette!(
            help = "write it into `set` there, or name another folder with --out",
            "{} is taken as it stands, and --set says nothing of it",
            scene.display()
        )));
    }
    if scene.exists() {
        tell!("{} is taken as it stands", scene.display());
    } else {
        let deck = Deck::load(&file, &arguments.overrides)?;
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let at = real(&folder).map_err(|why| failed(&folder, why))?;
        let text = draft(&deck, &file, &at, &arguments.overrides, threads);
        let text = text.map_err(Failure::model)?;
        write(&folder, SCENE, text.as_bytes())?;
        tell!("written to {}", scene.display());
    }
    let scene = Scene::load(&scene)?;
    if !scene.reference.there() {
        remade(&scene, Duration::from_secs_f64(arguments.limit), interrupt)?;
    }
    Ok(dir)
}

/// Absolute path without links of a file that need not exist.
fn real(path: &Path) -> std::io::Result<PathBuf> {
    match (path.canonicalize(), path.parent(), path.file_name()) {
        (Err(_), Some(parent), Some(name)) if parent.as_os_str().is_empty() => {
            Ok(Path::new(".").canonicalize()?.join(name))
        }
        (Err(_), Some(parent), Some(name)) => Ok(real(parent)?.join(name)),
        (there, ..) => there,
    }
}

/// Writes the charts, and the page beside their folder.
fn written_out(
    all: &[Studied],
    arguments: &AccuracySpeed,
    dir: &Path,
    out: &Path,
) -> Result<(), Failure> {
    for studied in all {
        let folder = out.join(studied.scene.folder_name());
        if let Some(svg) = chart(studied).map_err(|why| failed(&folder.join(CHART), other(why)))? {
            write(&folder, CHART, svg.as_bytes())?;
        }
    }
    let beside = out.parent().unwrap_or(Path::new("."));
    // A study of some scenes leaves the sections of the others unchanged.
    let before = match arguments.only.as_slice() {
        [] => String::new(),
        _ => page_before(&beside.join(PAGE))?,
    };
    let advice = advice(dir)?;
    let text = page(all, &advice, &link(out), &before);
    write(beside, PAGE, text.as_bytes())?;
    let out = beside.join(PAGE);
    print(&format!("{}written to {}\n", summary(all), out.display()))
}

/// Computes the references that come from runs.
fn references(scenes: &[Scene], limit: Duration, interrupt: &Interrupt) -> Result<(), Failure> {
    for scene in scenes {
        remade(scene, limit, interrupt)?;
    }
    Ok(())
}

/// Computes the reference of a scene if it comes from a run.
fn remade(scene: &Scene, limit: Duration, interrupt: &Interrupt) -> Result<(), Failure> {
    let file = &scene.reference.file;
    let made = renew(scene, limit, &|| interrupt.requested());
    if interrupt.requested() {
        return Err(Failure::Interrupted);
    }
    let told = match made.map_err(|why| unmade(file, &why))? {
        None => format!("{}: its reference comes from elsewhere\n", scene.name()),
        Some(made) => {
            write_whole(file, made.curve.as_bytes()).map_err(|why| failed(file, why))?;
            if let Some(text) = &made.pattern {
                write(&scene.folder, PATTERN, text.as_bytes())?;
            }
            format!("{}: written to {}\n", scene.name(), file.display())
        }
    };
    print(&told)
}

/// Failure of a reference whose run failed or ended early; its file is unchanged.
fn unmade(file: &Path, why: &str) -> Failure {
    Failure::NotConverged(miette!(
        help = "another end (`to`) or other keys (`set` of the reference) in scene.toml",
        "{} is not made: its run {why}",
        file.display()
    ))
}

/// Line of a finished run.
fn told(scene: &Scene, outcome: &Outcome, repeat: usize) -> String {
    let cracks = |part: f64| format!(", cracks {:.0} %", 100.0 * part);
    let cracks = outcome.cracks.map_or_else(String::new, cracks);
    let how = match &outcome.errors {
        Ok(errors) => format!(
            "peak {:+.2} %, energy {:+.2} %, RMS {:.2} %{cracks}",
            100.0 * errors.peak,
            100.0 * errors.energy,
            100.0 * errors.rms
        ),
        Err(why) => format!("NO ERROR: {why}"),
    };
    let (name, cost) = (&outcome.choice.name, &outcome.cost);
    let (cpu, wall) = (outcome.cpu_seconds(), outcome.wall_seconds());
    let took = if cpu.is_finite() {
        format!(
            "; {} solves, {cpu:.2} s of CPU, {wall:.2} s",
            cost.iterations
        )
    } else {
        String::new() // the choice was not run
    };
    format!("{}, {name} ({repeat}): {how}{took}", scene.name())
}

/// Number of choices that reached the end.
fn summary(all: &[Studied]) -> String {
    let outcomes = || all.iter().flat_map(|s| &s.outcomes);
    let ended = outcomes().filter(|o| o.errors.is_ok()).count();
    format!(
        "{ended} of {} choices came to the end\n",
        outcomes().count()
    )
}
