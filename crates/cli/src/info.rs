//! `wythe info`: a description of a run, a file of fields or a model on one screen.

use std::fmt::Write as _;
use std::path::Path;

use wythe_core::deck::Deck;
use wythe_core::error::IoError;
use wythe_core::model::{self, Model};
use wythe_core::results::answers::{Answers, Backbone, Line, at_drifts, of_point};
use wythe_core::results::output::{
    CHECKPOINT, CRACK_PATTERN, DECK, FIELDS, HISTORY, INTERFACES, LOAD_DISPLACEMENT, MESSAGES,
    REPORT, SUMMARY,
};
use wythe_core::results::vtkhdf::read::FieldsFile;
use wythe_core::results::{ReadError, ReadHistory, RunFolder, SummaryFile};
use wythe_core::state::Status;

use crate::arguments::Info;
use crate::error_estimate;
use crate::failure::Failure;
use crate::say::print;
use crate::terminal::{count, seconds};

/// Prints the description of a folder, of fields or of a model.
pub fn info(arguments: &Info) -> Result<(), Failure> {
    let path = &arguments.path;
    std::fs::metadata(path).map_err(|why| IoError {
        path: path.clone(),
        why,
    })?;
    let is = |ending: &str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
    };
    if arguments.drifts.is_some() && !path.is_dir() {
        return Err(Failure::Model(miette::miette!(
            help = "name a folder of results",
            "--drifts: {} is no folder of results, which has a curve",
            path.display()
        )));
    }
    let mut text = String::new();
    let told = if path.is_dir() {
        folder(&mut text, &RunFolder::open(path)?, arguments)?
    } else if is("toml") {
        model(&mut text, path)?
    } else if is("vtkhdf") || is("hdf") || is("h5") {
        let file = FieldsFile::open(path).map_err(|why| ReadError::Read {
            path: path.clone(),
            why,
        })?;
        fields(&mut text, &file)?
    } else {
        return Err(Failure::Model(miette::miette!(
            help = "name a folder of results, a results.vtkhdf, or a model.toml",
            "{}: neither results nor a model",
            path.display()
        )));
    };
    debug_assert!(told.is_ok(), "writing to a string does not fail");
    print(&text)
}

fn folder(
    text: &mut String,
    folder: &RunFolder,
    asked: &Info,
) -> Result<std::fmt::Result, Failure> {
    let (history, summary) = (folder.history()?, folder.summary()?);
    let answers = folder.answers()?;
    let given = given_drifts(&history, &answers, asked)?;
    // A damaged file of fields, as of a killed run, must not hide the rest.
    let fields = folder.fields();
    let about = fields
        .as_ref()
        .ok()
        .and_then(|f| f.title_and_version().ok());
    let title = about.as_ref().map_or("a run", |(title, _)| title.as_str());
    let version = summary.as_ref().map(|s| s.version.clone());
    let version = version.or_else(|| about.as_ref().map(|(_, version)| version.clone()));
    let frames = fields
        .as_ref()
        .map(|f| f.times().to_vec())
        .map_err(ToString::to_string);
    let tell = |text: &mut String| -> std::fmt::Result {
        writeln!(text, "{title}")?;
        writeln!(text, "  folder      {}", folder.path().display())?;
        writeln!(
            text,
            "  version     {}",
            version.as_deref().unwrap_or("not known")
        )?;
        status(text, summary.as_ref(), folder.path())?;
        if let Some(summary) = &summary {
            sizes(text, summary)?;
            if let Some(part) = summary.part_solved() {
                writeln!(text, "  solved      {part}")?;
            }
        }
        steps(text, &history)?;
        curve(text, &history)?;
        told(text, answers.lines().iter().chain(&given))?;
        if let Some(summary) = &summary {
            errors(text, summary)?;
            cost(text, summary)?;
        }
        energies(text, &history, summary.as_ref())?;
        match frames {
            Ok(times) => of_frames(text, &times)?,
            Err(why) => writeln!(text, "  frames      {why}")?,
        }
        files(text, folder.path())
    };
    Ok(tell(text))
}

fn status(text: &mut String, summary: Option<&SummaryFile>, path: &Path) -> std::fmt::Result {
    let status = match summary.map(|s| s.status) {
        Some(Status::Completed) => "completed; the folder is whole",
        Some(Status::Collapsed) => "collapsed; the folder is whole",
        Some(Status::NotConverged) => "not converged; all up to there is whole",
        Some(Status::Stopped) => "stopped by a callback; all up to there is whole",
        Some(Status::Interrupted) => "interrupted; all up to there is whole",
        None => "no summary: the run goes on, was killed, or could not write",
    };
    writeln!(text, "  status      {status}")?;
    let verdict = summary.map_or("", |s| s.verdict.as_str());
    if !verdict.is_empty() {
        writeln!(text, "  verdict     {verdict}")?;
    }
    let message = summary.map_or("", |s| s.message.as_str());
    if !message.is_empty() && message != verdict {
        writeln!(text, "              {message}")?;
    }
    let resumable = path.join(CHECKPOINT).is_file();
    let done = summary.is_some_and(|s| matches!(s.status, Status::Completed | Status::Collapsed));
    if resumable && !done {
        writeln!(
            text,
            "              can be resumed: there is a {CHECKPOINT}"
        )?;
    } else if !done {
        writeln!(
            text,
            "              cannot be resumed: there is no {CHECKPOINT}"
        )?;
    }
    for note in summary
        .iter()
        .flat_map(|s| &s.log)
        .filter(|l| l.contains(" ends at "))
    {
        writeln!(text, "              {note}")?;
    }
    Ok(())
}

fn sizes(text: &mut String, s: &SummaryFile) -> std::fmt::Result {
    writeln!(
        text,
        "  sizes       {}, {}, {}, {}, {}",
        count(s.units, "unit"),
        count(s.elements, "element"),
        count(s.nodes, "node"),
        count(s.dofs, "unknown"),
        count(s.contact_points, "contact point")
    )
}

fn steps(text: &mut String, history: &ReadHistory) -> std::fmt::Result {
    if history.rows.is_empty() {
        return writeln!(text, "  steps       no increment is done");
    }
    let mut head = "steps";
    for rows in history.rows.chunk_by(|a, b| a.step == b.step) {
        let Some(end) = rows.last() else { continue };
        let (step, d, f) = (end.step, end.displacement_mm, end.force_kN);
        writeln!(
            text,
            "  {head:10}  {step}: {}, load factor {:.4}, ends at {d:.4} mm, {f:.3} kN",
            count(rows.len(), "increment"),
            end.load_factor
        )?;
        head = "";
    }
    Ok(())
}

fn curve(text: &mut String, history: &ReadHistory) -> std::fmt::Result {
    let curve = history.curve();
    let Some(peak) = curve.peak() else {
        return writeln!(text, "  peak        nothing was driven");
    };
    writeln!(
        text,
        "  {:10}  {:.3} kN at {:.4} mm{}",
        curve.word_of_largest(),
        peak.force,
        peak.displacement,
        curve
            .displacement_at_80_percent()
            .map_or(String::new(), |d| format!("; 80 % of it at {d:.4} mm"))
    )?;
    match curve.initial_stiffness() {
        Some(k) => writeln!(text, "              initial stiffness {k:.2} kN/mm"),
        None => Ok(()),
    }
}

/// Lines under their headings; a heading stands once.
fn told<'a>(text: &mut String, lines: impl Iterator<Item = &'a Line>) -> std::fmt::Result {
    let mut before = "";
    for line in lines {
        let head = if line.head == before { "" } else { line.head };
        writeln!(text, "  {head:10}  {}", line.text)?;
        before = line.head;
    }
    Ok(())
}

/// Points of the curve at the drifts of `--drifts`.
fn given_drifts(
    history: &ReadHistory,
    answers: &Answers,
    asked: &Info,
) -> Result<Vec<Line>, Failure> {
    let Some(drifts) = &asked.drifts else {
        return Ok(Vec::new());
    };
    let side = Backbone::of(&history.curve(), false).ok_or_else(|| {
        Failure::Model(miette::miette!(
            help = "ask for drifts of a run that drives a face, a beam or a spring",
            "--drifts: nothing was driven"
        ))
    })?;
    let height = asked.height.or(answers.height_mm).ok_or_else(|| {
        Failure::Model(miette::miette!(
            help = "say --height MM",
            "--drifts: the model has no clear height, as nothing above its supports is driven sideways"
        ))
    })?;
    let line = |point| Line {
        head: "drifts",
        text: of_point(&point),
    };
    let points = at_drifts(&side, height, &drifts.0);
    Ok(points.into_iter().map(line).collect())
}

fn errors(text: &mut String, s: &SummaryFile) -> std::fmt::Result {
    let mut head = "error";
    for line in s.error_estimate.iter().flat_map(error_estimate::lines) {
        writeln!(text, "  {head:10}  {line}")?;
        head = "";
    }
    Ok(())
}

fn cost(text: &mut String, s: &SummaryFile) -> std::fmt::Result {
    writeln!(
        text,
        "  cost        {}, {}, {}, {} on {}{}",
        count(s.increments, "increment"),
        count(s.iterations, "iteration"),
        count(s.cutbacks, "cut-back"),
        seconds(s.wall_s),
        count(s.threads, "thread"),
        s.peak_rss_MB
            .map_or(String::new(), |mb| format!(", {mb:.0} MB"))
    )
}

fn energies(
    text: &mut String,
    history: &ReadHistory,
    summary: Option<&SummaryFile>,
) -> std::fmt::Result {
    let Some(row) = history.rows.last() else {
        return Ok(());
    };
    writeln!(
        text,
        "  energies    {:.3} J from outside",
        row.external_work_J
    )?;
    let parts = [
        ("elastic", row.elastic_energy_J),
        ("kinetic", row.kinetic_energy_J),
        ("plastic and damage", row.plastic_damage_dissipation_J),
        ("interfaces", row.interface_dissipation_J),
        ("viscous", row.viscous_dissipation_J),
        ("damping", row.damping_dissipation_J),
        ("numerical", row.numerical_dissipation_J),
    ];
    let there = parts.iter().filter(|(_, value)| *value != 0.0);
    let parts: Vec<String> = there
        .map(|(name, value)| format!("{name} {value:.3}"))
        .collect();
    if !parts.is_empty() {
        writeln!(text, "              {} J", parts.join(", "))?;
    }
    match summary {
        Some(s) => writeln!(
            text,
            "              balance closes to {:.1e}",
            s.energy_balance_error
        ),
        None => Ok(()),
    }
}

fn of_frames(text: &mut String, times: &[f64]) -> std::fmt::Result {
    match times {
        [] => writeln!(text, "  frames      none"),
        [first, .., last] => writeln!(
            text,
            "  frames      {}, 0 to {}, from t = {first:.4} to {last:.4} s",
            times.len(),
            times.len() - 1
        ),
        [only] => writeln!(text, "  frames      1, at t = {only:.4} s"),
    }
}

/// Lists the files of a run with their sizes.
fn files(text: &mut String, path: &Path) -> std::fmt::Result {
    let names = [
        HISTORY,
        FIELDS,
        INTERFACES,
        MESSAGES,
        DECK,
        LOAD_DISPLACEMENT,
        CRACK_PATTERN,
        REPORT,
        CHECKPOINT,
        SUMMARY,
    ];
    let mut head = "files";
    for name in names {
        if let Ok(there) = std::fs::metadata(path.join(name)) {
            writeln!(text, "  {head:10}  {name:26}{:>10}", bytes(there.len()))?;
            head = "";
        }
    }
    Ok(())
}

/// Formats a size: 812 B, 1.5 kB, 23 MB.
fn bytes(count: u64) -> String {
    let mut value = count as f64;
    for unit in ["B", "kB", "MB", "GB"] {
        if value < 1000.0 {
            let decimals = usize::from(unit != "B" && value < 10.0);
            return format!("{value:.decimals$} {unit}");
        }
        value /= 1000.0;
    }
    format!("{value:.1} TB")
}

fn fields(text: &mut String, file: &FieldsFile) -> Result<std::fmt::Result, Failure> {
    let read = |why| ReadError::Read {
        path: file.path().to_owned(),
        why,
    };
    let (title, version) = file.title_and_version().map_err(read)?;
    let (mesh, surface) = (file.mesh().map_err(read)?, file.surface().map_err(read)?);
    let materials = file.materials().map_err(read)?;
    let size = std::fs::metadata(file.path()).map_or(0, |m| m.len());
    let units = mesh.unit.iter().max().map_or(0, |last| *last as usize + 1);
    let extent = [0, 1, 2].map(|i| {
        let along = mesh.nodes.iter().map(|x| x[i]);
        let [low, high] = [
            along.clone().fold(f64::INFINITY, f64::min),
            along.fold(f64::NEG_INFINITY, f64::max),
        ];
        if low <= high { high - low } else { 0.0 }
    });
    let tell = |text: &mut String| -> std::fmt::Result {
        writeln!(text, "{title}")?;
        writeln!(
            text,
            "  file        {}, {}",
            file.path().display(),
            bytes(size)
        )?;
        writeln!(text, "  version     {version}")?;
        let [x, y, z] = extent;
        writeln!(
            text,
            "  solids      {}, {}, {}; {x:.1} × {y:.1} × {z:.1} mm",
            count(units, "unit"),
            count(mesh.elements.len(), "element"),
            count(mesh.nodes.len(), "node")
        )?;
        for (m, name) in materials.iter().enumerate() {
            let of = mesh
                .material
                .iter()
                .filter(|&&of| usize::from(of) == m)
                .count();
            let head = if m == 0 { "materials" } else { "" };
            writeln!(text, "  {head:10}  {name}: {}", count(of, "element"))?;
        }
        writeln!(
            text,
            "  interfaces  {}",
            count(surface.quads.len(), "contact point")
        )?;
        of_frames(text, file.times())
    };
    Ok(tell(text))
}

fn model(text: &mut String, path: &Path) -> Result<std::fmt::Result, Failure> {
    let deck = Deck::load(path, &[])?;
    let (model, warnings) = Model::from_deck(&deck)?;
    let sizes = model::sizes::sizes(&model);
    let tell = |text: &mut String| -> std::fmt::Result {
        writeln!(text, "{}", model.title)?;
        writeln!(text, "  model       {}", path.display())?;
        writeln!(
            text,
            "  sizes       {}, {}, {}, {}, {}",
            count(sizes.units, "unit"),
            count(sizes.elements, "element"),
            count(sizes.nodes, "node"),
            count(sizes.dofs, "unknown"),
            count(sizes.contact_points, "contact point")
        )?;
        let materials: Vec<&str> = model.materials.iter().map(|m| m.name.as_str()).collect();
        writeln!(text, "  materials   {}", materials.join(", "))?;
        // The list holds a law once for every pair of stiffnesses and every unit with scattered properties.
        let mut laws: Vec<&str> = Vec::new();
        for name in &model.contact.law_names {
            if !laws.contains(&name.as_str()) {
                laws.push(name);
            }
        }
        writeln!(text, "  interfaces  {}", laws.join(", "))?;
        for (i, step) in deck.steps.iter().enumerate() {
            let head = if i == 0 { "steps" } else { "" };
            writeln!(
                text,
                "  {head:10}  {i}: {}, {}",
                step.name(),
                step.kind.name()
            )?;
        }
        let probes: Vec<&str> = model.probes.iter().map(|p| p.column.as_str()).collect();
        if !probes.is_empty() {
            writeln!(text, "  probes      {}", probes.join(", "))?;
        }
        let loads: Vec<&str> = model.loads.iter().map(|l| l.name.as_str()).collect();
        if !loads.is_empty() {
            writeln!(text, "  loads       {}", loads.join(", "))?;
        }
        match warnings.len() {
            0 => writeln!(text, "  warnings    none"),
            n => writeln!(text, "  warnings    {n}: see `wythe check`"),
        }
    };
    Ok(tell(text))
}

#[cfg(test)]
mod tests {
    use super::bytes;

    #[test]
    fn sizes_of_files_read_as_people_say_them() {
        let said = [812, 1500, 23_000_000, 9_960_000].map(bytes);
        assert_eq!(said, ["812 B", "1.5 kB", "23 MB", "10.0 MB"]);
    }
}
