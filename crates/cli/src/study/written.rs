//! The file `case.toml` of the atlas, and its checks.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::case::{Case, CaseMethod, ENERGY, End, Short, StudyError};
use super::expect::Wanted;
use super::expect_written::{Checker, ExpectFile};
use super::history::History;
use wythe_core::deck::Deck;
use wythe_core::deck::source::Source;
use wythe_core::error::{IoError, ModelError};

/// Keys of `case.toml` for serde.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    number: u32,
    title: String,
    mechanics: String,
    source: String,
    #[serde(default = "deck")]
    deck: String,
    steps: Option<Vec<usize>>,
    short: Option<ShortFile>,
    energy: Option<f64>,
    #[serde(default)]
    why: String,
    #[serde(default)]
    status: End,
    #[serde(default)]
    methods: Vec<MethodFile>,
    #[serde(default)]
    expect: Vec<ExpectFile>,
}

/// Short form of a case in its file.
#[derive(Deserialize, Serialize)]
#[serde(
    untagged,
    expecting = "expected `short = false` or `short = { set = [\"KEY=VALUE\"] }`"
)]
pub(super) enum ShortFile {
    Is(bool),
    Table(SetFile),
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SetFile {
    set: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodFile {
    name: String,
    set: Vec<String>,
}

fn deck() -> String {
    "deck.toml".to_owned()
}

/// Example of each key of a case.
const EXAMPLES: [(&str, &str); 17] = [
    ("number", "number = 1"),
    ("title", "title = \"Snap-back bar\""),
    (
        "mechanics",
        "mechanics = \"What happens and why methods fail here.\"",
    ),
    ("source", "source = \"Where the reference comes from.\""),
    ("steps", "steps = [1]  # of the deck, counted from 0"),
    (
        "short",
        "short = { set = [\"steps.1.displacement=1 mm\"] }  # or false",
    ),
    ("set", "set = [\"interfaces.joint.penalty_factor=5\"]"),
    ("status", "status = \"completed\"  # or \"not_converged\""),
    ("name", "name = \"peak force\""),
    (
        "of",
        "of = \"peak\"  # or \"trough\", \"final\", \"at\", \"when\", \"area\", \"curve\", \"ratio\"",
    ),
    (
        "column",
        "column = \"force_kN\"  # any column of history.csv",
    ),
    ("at", "at = { column = \"displacement_mm\", value = 0.5 }"),
    ("reaches", "reaches = 0.0"),
    ("file", "file = \"reference.csv\""),
    ("value", "value = 1.23"),
    ("tolerance", "tolerance = 0.01  # relative"),
    ("energy", "energy = 0.02  # with a why"),
];

/// Advice for the key at `path`.
pub fn advice(path: &str) -> String {
    let name = path.rsplit('.').find(|part| part.parse::<usize>().is_err());
    match EXAMPLES.iter().find(|(key, _)| Some(*key) == name) {
        Some((_, line)) => format!("write it like this: {line}"),
        None => "tests/stability/README.md lists the keys of a case".to_owned(),
    }
}

impl CaseFile {
    /// Builds the case after all checks.
    pub fn checked(self, source: &Source, folder: &Path) -> Result<Case, StudyError> {
        let error = |path: &str, message: &str| source.error(path, message, &advice(path));
        if self.energy.is_some_and(|e| e > ENERGY) && self.why.is_empty() {
            let (message, help) = (
                "a larger energy imbalance wants a reason",
                "say why beside it: why = \"…\"",
            );
            return Err(source.error("energy", message, help).into());
        }
        if self.energy.is_some_and(|e| e.is_nan() || e <= 0.0) {
            return Err(error("energy", "must be above 0").into());
        }
        if self.expect.is_empty() {
            let message = "the case expects nothing: a wrong answer would pass";
            let error = source.error("", message, "write one [[expect]] or more");
            return Err(error.into());
        }
        let short = short(source, "short", self.short.as_ref())?;
        let methods = methods(source, &self.methods)?;
        let deck = folder.join(&self.deck);
        let own = Deck::load(&deck, &[])?.columns();
        let columns: Vec<String> = History::names().into_iter().chain(own).collect();
        let written = self.expect.into_iter().enumerate();
        let expect = written.map(|(i, written)| {
            let checker = Checker {
                source,
                path: format!("expect.{i}"),
                columns: &columns,
                folder,
                advice,
            };
            checker.expectation(written)
        });
        let expect = expect.collect::<Result<Vec<_>, _>>()?;
        if expect.iter().all(|e| e.wanted == Wanted::Reported) {
            let message = "all of it is only reported: a wrong answer would pass";
            return Err(error("expect", message).into());
        }
        Ok(Case {
            number: self.number,
            part: String::new(),
            title: self.title,
            mechanics: self.mechanics,
            source: self.source,
            deck,
            steps: self.steps,
            short,
            energy: self.energy.unwrap_or(ENERGY),
            why: self.why,
            status: self.status,
            methods,
            expect,
        })
    }
}

/// Methods of a case, whose names must differ.
fn methods(source: &Source, written: &[MethodFile]) -> Result<Vec<CaseMethod>, StudyError> {
    let mut methods: Vec<CaseMethod> = Vec::new();
    for (i, method) in written.iter().enumerate() {
        let path = format!("methods.{i}");
        if methods.iter().any(|m| m.name == method.name) {
            let key = format!("{path}.name");
            let error = source.error(&key, "two methods have this name", &advice(&key));
            return Err(error.into());
        }
        methods.push(CaseMethod {
            name: method.name.clone(),
            set: pairs(source, &format!("{path}.set"), &method.set)?,
        });
    }
    Ok(methods)
}

/// Text of a case at `path`, its file name for errors, and its folder.
pub(super) fn text(path: &Path) -> Result<(String, String, &Path), IoError> {
    let text =
        wythe_core::input::text(path, wythe_core::input::MOST_OF_TABLE).map_err(|why| IoError {
            path: path.to_owned(),
            why,
        })?;
    let folder = path.parent().unwrap_or(Path::new("."));
    Ok((text, path.display().to_string(), folder))
}

/// Content of a file, and its source with the positions of the keys. `advice` gives the syntax of a key.
pub(super) fn parsed<F: DeserializeOwned>(
    text: &str,
    file: &str,
    advice: fn(&str) -> String,
) -> Result<(Source, F), StudyError> {
    let (source, root) = Source::other(file, text, advice)?;
    let written = F::deserialize(toml::Deserializer::from(root))
        .map_err(|error| source.toml_error(&error))?;
    Ok((source, written))
}

/// Sorted paths in a folder.
pub(super) fn listed(folder: &Path) -> Result<Vec<PathBuf>, IoError> {
    let reading = |why| IoError {
        path: folder.to_owned(),
        why,
    };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(reading)? {
        paths.push(entry.map_err(reading)?.path());
    }
    paths.sort();
    Ok(paths)
}

/// Reads the cases of these files; no two may have the same `id`.
pub(super) fn gathered<C>(
    folder: &Path,
    files: &[PathBuf],
    load: fn(&Path) -> Result<C, StudyError>,
    id: fn(&C) -> String,
) -> Result<Vec<C>, StudyError> {
    let mut ids: Vec<String> = Vec::new();
    let mut cases = Vec::new();
    for file in files {
        let case = load(file)?;
        if let Some(one) = ids.iter().position(|known| *known == id(&case)) {
            return Err(StudyError::SameNumber {
                number: id(&case),
                one: files[one].clone(),
                other: file.clone(),
            });
        }
        ids.push(id(&case));
        cases.push(case);
    }
    if cases.is_empty() {
        return Err(StudyError::NoCase(folder.to_owned()));
    }
    Ok(cases)
}

/// Short form of a case at `path`.
pub(super) fn short(
    source: &Source,
    path: &str,
    written: Option<&ShortFile>,
) -> Result<Short, ModelError> {
    Ok(match written {
        None | Some(ShortFile::Is(true)) => Short::Whole,
        Some(ShortFile::Is(false)) => Short::None,
        Some(ShortFile::Table(SetFile { set })) => {
            Short::Set(pairs(source, &format!("{path}.set"), set)?)
        }
    })
}

/// Splits each `KEY=VALUE`.
pub(super) fn pairs(
    source: &Source,
    path: &str,
    set: &[String],
) -> Result<Vec<(String, String)>, ModelError> {
    set.iter()
        .enumerate()
        .map(|(i, text)| match text.split_once('=') {
            Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
                Ok((key.trim().to_owned(), value.trim().to_owned()))
            }
            _ => Err(source.error(
                &format!("{path}.{i}"),
                format!("`{text}` is not KEY=VALUE"),
                &advice("set"),
            )),
        })
        .collect()
}
