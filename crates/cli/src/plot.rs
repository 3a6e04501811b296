//! `wythe plot` and `wythe animate`: draw a run.

use std::path::{Path, PathBuf};

use wythe_core::error::IoError;
use wythe_core::files::{write_out, write_whole};
use wythe_core::results::animation::{self, Animation};
use wythe_core::results::comparison::points_of;
use wythe_core::results::output::spare_inputs;
use wythe_core::results::plotting::columns::{Columns, columns};
use wythe_core::results::plotting::deflection::{Along, Deflection, deflections, main_axis};
use wythe_core::results::plotting::{Line, load_displacements, png, png_of_width};
use wythe_core::results::snapshot::Snapshots;
use wythe_core::results::wall_picture::wall_picture;
use wythe_core::results::{Experiment, ReadError, ReadHistory, RunFolder, Snapshot};

use crate::arguments::{Animate, Plot};
use crate::failure::Failure;
use crate::say::print;

/// Pixels of a PNG per pixel of its SVG.
const ZOOM: f32 = 2.0;

/// Draws the run and prints the names of the pictures.
pub fn plot(arguments: &Plot) -> Result<(), Failure> {
    let pictures = if arguments.x.is_some() || !arguments.y.is_empty() {
        columns_of(arguments)?
    } else {
        pictures_of(arguments)?
    };
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => arguments.folder.join("plots"),
    };
    let mut written = Vec::new();
    for (name, svg) in pictures {
        written.push(write(&out, &format!("{name}.svg"), svg.as_bytes())?);
        if arguments.png {
            let bytes = png(&svg, ZOOM).map_err(|why| undrawn(&why))?;
            written.push(write(&out, &format!("{name}.png"), &bytes)?);
        }
    }
    tell_written(&written)
}

/// Prints the names of files.
fn tell_written(written: &[PathBuf]) -> Result<(), Failure> {
    let lines: Vec<String> = written
        .iter()
        .map(|p| format!("{}\n", p.display()))
        .collect();
    print(&lines.concat())
}

/// Animates the run and prints the names of the files.
pub fn animate(arguments: &Animate) -> Result<(), Failure> {
    let folder = RunFolder::open(&arguments.folder)?;
    let snapshots = Snapshots::open(&folder)?;
    let model = folder.model();
    let animation = Animation {
        look: arguments.view.look(),
        width: arguments.width,
        delay: arguments.delay,
        curve: !arguments.no_curve,
        most: arguments.most as usize,
    };
    let plots = arguments.folder.join("plots");
    if !arguments.png {
        let bytes = animation::gif(&snapshots, model.as_ref(), &animation)?;
        let path = arguments.out.clone();
        let path = path.unwrap_or_else(|| plots.join("animation.gif"));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let into = path.parent().unwrap_or(Path::new(""));
        return tell_written(&[write(into, &name, &bytes)?]);
    }
    let out = arguments.out.clone().unwrap_or(plots);
    let pictures = animation::pictures(&snapshots, model.as_ref(), &animation)?;
    let mut written = Vec::new();
    for (i, svg) in pictures.iter().enumerate() {
        let bytes = png_of_width(svg, arguments.width).map_err(|why| undrawn(&why))?;
        written.push(write(&out, &format!("animation_{i:04}.png"), &bytes)?);
    }
    tell_written(&written)
}

/// The picture of the columns asked for, with its name.
fn columns_of(arguments: &Plot) -> Result<Vec<(String, String)>, Failure> {
    let mut runs = Vec::new();
    for path in std::iter::once(&arguments.folder).chain(&arguments.against) {
        runs.push((name_of(path), RunFolder::open(path)?.history()?));
    }
    let asked = Columns {
        x: arguments.x.clone(),
        y: arguments.y.clone(),
    };
    let named: Vec<(&str, &ReadHistory)> = runs.iter().map(|(n, h)| (n.as_str(), h)).collect();
    let Some((_, first)) = named.first() else {
        return Ok(Vec::new());
    };
    let title = title_of(&arguments.folder);
    let name = asked.or_default(first).file_name();
    Ok(vec![(name, columns(&title, &named, &asked)?)])
}

/// Title of a run, or its name if it has no fields yet.
fn title_of(path: &Path) -> String {
    let fields = RunFolder::open(path).and_then(|folder| folder.fields());
    let title = fields.ok().and_then(|f| f.title_and_version().ok());
    title.map_or_else(|| name_of(path), |(title, _)| title)
}

/// Curves, cracks and deflections of the runs, with their names.
fn pictures_of(arguments: &Plot) -> Result<Vec<(String, String)>, Failure> {
    let experiments: Vec<Experiment> = arguments
        .compare
        .iter()
        .map(|path| Experiment::read(path))
        .collect::<Result<_, _>>()?;
    let runs: Vec<Run> = std::iter::once(&arguments.folder)
        .chain(&arguments.against)
        .map(|path| Run::open(path, arguments))
        .collect::<Result<_, _>>()?;
    let Some(first) = runs.first() else {
        return Ok(Vec::new());
    };
    let mut pictures = Vec::new();
    let title = &first.snapshot.title;
    let driven = runs.iter().any(|run| run.line.points.len() > 1);
    let curves = if driven || !experiments.is_empty() {
        let lines: Vec<Line> = runs.iter().map(|run| run.line.clone()).collect();
        load_displacements(title, &lines, &experiments).map_err(|why| undrawn(&why))?
    } else {
        let named = runs
            .iter()
            .map(|run| (run.line.name.as_str(), &run.history));
        columns(title, &named.collect::<Vec<_>>(), &Columns::default())?
    };
    pictures.push(("curves".to_owned(), curves));
    let look = arguments.view.look();
    let model = RunFolder::open(&arguments.folder)?.model();
    pictures.push((
        format!(
            "cracks_{:04}{}",
            first.snapshot.number,
            look.view.file_name()
        ),
        wall_picture(&first.snapshot, model.as_ref(), &look)?,
    ));
    pictures.extend(deflections_of(&runs, first)?);
    Ok(pictures)
}

/// Pictures of the deflections of runs over height and length, with their names; `first` gives title and axis.
fn deflections_of(runs: &[Run], first: &Run) -> Result<Vec<(String, String)>, Failure> {
    let axis = main_axis(&first.snapshot.frame);
    let mut pictures = Vec::new();
    for (along, name) in [
        (Along::Height, "deflection_height"),
        (Along::Length, "deflection_length"),
    ] {
        // In its plane a wall is stiff along its length.
        if along == Along::Length && axis == 0 {
            continue;
        }
        let bent = |run: &Run| {
            let Snapshot { mesh, frame, .. } = &run.snapshot;
            let name = format!("{}, {}", run.line.name, run.snapshot.caption());
            (name, Deflection::of(mesh, frame, along, axis))
        };
        let bent = runs.iter().map(bent);
        let bent: Vec<_> = bent.filter(|(_, bent)| !bent.points.is_empty()).collect();
        if !bent.is_empty() {
            let svg = deflections(&first.snapshot.title, along, axis, &bent);
            pictures.push((name.to_owned(), svg.map_err(|why| undrawn(&why))?));
        }
    }
    Ok(pictures)
}

/// Curve and frame of a run.
struct Run {
    line: Line,
    history: ReadHistory,
    snapshot: Snapshot,
}

impl Run {
    fn open(path: &Path, arguments: &Plot) -> Result<Self, ReadError> {
        let snapshots = Snapshots::open(&RunFolder::open(path)?)?;
        let curve = snapshots.history().curve();
        let peak = curve.peak();
        Ok(Self {
            line: Line {
                name: name_of(path),
                points: points_of(&curve),
                marks: peak
                    .map(|p| (p.displacement, p.force))
                    .into_iter()
                    .collect(),
            },
            snapshot: snapshots.at(arguments.frame)?,
            history: snapshots.history().clone(),
        })
    }
}

/// Name of a run: `wall` for `somewhere/wall.out`.
fn name_of(path: &Path) -> String {
    let whole = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let name = whole
        .file_name()
        .unwrap_or(whole.as_os_str())
        .to_string_lossy();
    name.strip_suffix(".out").unwrap_or(&name).to_owned()
}

/// Writes to a path given by the user, which may be a device or a pipe, but never over an input.
pub fn write_answer(path: &Path, bytes: &[u8], inputs: &[PathBuf]) -> Result<(), Failure> {
    if let (Some(folder), Some(name)) = (path.parent(), path.file_name().and_then(|n| n.to_str())) {
        spare_inputs(folder, [name], inputs)?;
    }
    write_out(path, bytes).map_err(|why| {
        let path = path.to_owned();
        IoError { path, why }.into()
    })
}

/// Writes a picture as SVG or PNG, by the extension of the file.
pub fn write_picture(picture: &Path, svg: String, inputs: &[PathBuf]) -> Result<(), Failure> {
    let extension = picture
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    let bytes = match extension.to_ascii_lowercase().as_str() {
        "svg" => svg.into_bytes(),
        "png" => png(&svg, 2.0).map_err(|why| undrawn(&why))?,
        _ => {
            return Err(Failure::Model(miette::miette!(
                help = "name it scene.svg or scene.png",
                "{} is neither an SVG nor a PNG",
                picture.display()
            )));
        }
    };
    write_answer(picture, &bytes, inputs)
}

/// Writes a file into a folder, which is created if necessary.
pub fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, IoError> {
    let path = folder.join(name);
    std::fs::create_dir_all(folder).map_err(|why| IoError {
        path: folder.to_owned(),
        why,
    })?;
    write_whole(&path, bytes).map_err(|why| IoError {
        path: path.clone(),
        why,
    })?;
    Ok(path)
}

/// Failure of a picture that cannot be drawn.
pub fn undrawn(why: &str) -> Failure {
    Failure::Model(miette::miette!(
        help = "look for values in history.csv that are not finite",
        "the picture cannot be drawn: {why}"
    ))
}
