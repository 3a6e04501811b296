//! The file `scene.toml`, and its checks.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::errors::Known;
use super::pattern::{PATTERN, Pattern};
use super::peer::{Peer, spent_to};
use super::scene::{Choice, Group, Origin, Reference, Scene};
use crate::study::curve;
use crate::study::written::{ShortFile, pairs, parsed, short, text};
use crate::study::{History, Short, StudyError};
use wythe_core::deck::Deck;
use wythe_core::deck::source::Source;

/// Keys of `scene.toml` for serde; TOML omits keys without a value.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
// More than 15 fields: one for each key of the file.
pub struct SceneFile {
    pub number: u32,
    pub title: String,
    pub what: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub says: String,
    pub deck: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    pub short: Option<ShortFile>,
    pub x: String,
    pub y: String,
    pub steps: Option<Vec<usize>>,
    pub from: Option<f64>,
    pub to: f64,
    pub short_to: Option<f64>,
    pub reference: ReferenceFile,
    pub choices: Vec<ChoiceFile>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peers: Vec<PeerFile>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceFile {
    pub file: String,
    pub x: Option<String>,
    pub y: Option<String>,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub y_factor: f64,
    pub peak: Option<f64>,
    pub how: String,
    pub uncertainty: f64,
    pub set: Option<Vec<String>>,
    #[serde(default = "one_thread")]
    pub threads: usize,
    pub factor: Option<f64>,
    pub command: Option<String>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ChoiceFile {
    pub name: String,
    pub group: Group,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    #[serde(default = "one_thread")]
    pub threads: usize,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub factor: f64,
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub short: bool,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PeerFile {
    name: String,
    differs: String,
    file: String,
    x: Option<String>,
    y: Option<String>,
    #[serde(default = "one")]
    y_factor: f64,
    #[serde(default = "cpu")]
    cpu: String,
    default_cpu: f64,
}

/// Keys of `index.toml` for serde.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct IndexFile {
    advice: String,
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde hands it over")]
#[expect(clippy::float_cmp, reason = "the default itself")]
fn is_one(factor: &f64) -> bool {
    *factor == one()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde hands it over")]
fn is_yes(short: &bool) -> bool {
    *short
}

fn one_thread() -> usize {
    1
}

fn cpu() -> String {
    "cpu_s".to_owned()
}

fn yes() -> bool {
    true
}

/// Advice for the key at `path`.
pub fn advice(path: &str) -> String {
    let name = path.rsplit('.').find(|part| part.parse::<usize>().is_err());
    let line = match name {
        Some("group") => {
            let names = "default, element, mesh, points, penalty, procedure, step, tolerance, symmetry, fidelity, threads";
            return format!("groups are {names} and several; one choice is the default");
        }
        Some("set") => "set = [\"steps.1.increments.max=0.005\"]",
        Some("uncertainty") => "uncertainty = 0.002  # part of the reference's peak",
        Some("default_cpu") => {
            "default_cpu = 25.1  # CPU seconds of the scene's default in the same sitting"
        }
        Some("to") => "to = 0.6  # in units of x; the reference and the runs go so far",
        Some("steps") => "steps = [1]  # rows of these steps of the deck only",
        Some("command") => {
            "command = \"what made the file\", or set = [\"KEY=VALUE\"] of a run of the scene"
        }
        _ => return "docs/reference/studies.md lists the keys of a scene".to_owned(),
    };
    format!("write it like this: {line}")
}

/// Reads the advice from `index.toml`.
pub fn advice_of(file: &Path) -> Result<String, StudyError> {
    let (text, name, _) = text(file)?;
    let (_, index): (_, IndexFile) = parsed(&text, &name, advice)?;
    Ok(index.advice)
}

impl SceneFile {
    /// Builds the scene after all checks.
    pub fn checked(self, source: &Source, folder: &Path) -> Result<Scene, StudyError> {
        let error = |path: &str, message: String| -> StudyError {
            source.error(path, message, &advice(path)).into()
        };
        let [(x, of_x), (y, of_y)] = [&self.x, &self.y].map(|column| signed(column));
        let set = pairs(source, "set", &self.set)?;
        let deck = folder.join(&self.deck);
        let with_set = Deck::load(&deck, &set)?;
        self.columns(&with_set, &error)?;
        let last = with_set.steps.len();
        if let Some(step) = self.steps.iter().flatten().find(|step| **step >= last) {
            let what = format!("the deck has {last} steps, counted from 0, and no step {step}");
            return Err(error("steps", what));
        }
        let context = Context {
            source,
            folder,
            columns: [x, y],
            error: &error,
        };
        let reference = context.reference(self.reference)?;
        // Loads before the first of these rows may have changed the compared values.
        let begins = reference.curve.first().map_or(0.0, |point| point[0]);
        let from = self.from.unwrap_or(begins.max(0.0));
        if !(from >= 0.0 && from < self.to && self.to.is_finite()) {
            let what = "must be beyond `from`, which is 0 or more".to_owned();
            return Err(error("to", what));
        }
        let short_to = self.short_to.unwrap_or(self.to);
        if !(from < short_to && short_to <= self.to) {
            let what = "must lie between `from` and `to`".to_owned();
            return Err(error("short_to", what));
        }
        let short = short(source, "short", self.short.as_ref())?;
        let choices = context.choices(self.choices)?;
        let peers = context.peers(self.peers, self.to, &choices)?;
        let there = reference.there();
        for to in [self.to, short_to].into_iter().filter(|_| there) {
            Known::new(&reference.curve, [from, to], reference.peak)
                .map_err(|why| error("reference.file", why))?;
        }
        try_all(&deck, &set, &short, &choices, &error)?;
        Ok(Scene {
            number: self.number,
            title: self.title,
            what: self.what,
            says: self.says,
            folder: folder.to_owned(),
            deck,
            set,
            short,
            x: x.to_owned(),
            y: y.to_owned(),
            signs: [of_x, of_y],
            steps: self.steps,
            range: [from, self.to],
            short_to,
            reference,
            choices,
            peers,
        })
    }

    /// Rejects columns that the history does not have.
    fn columns(&self, deck: &Deck, error: &Error<'_>) -> Result<(), StudyError> {
        let own = deck.columns();
        let columns: Vec<String> = History::names().into_iter().chain(own).collect();
        for (key, column) in [("x", &self.x), ("y", &self.y)] {
            let (name, _) = signed(column);
            if !columns.iter().any(|own| own == name) {
                return Err(error(key, format!("the history has no column `{name}`")));
            }
        }
        Ok(())
    }
}

/// Name of a column, and −1 if a minus precedes it, else 1.
fn signed(column: &str) -> (&str, f64) {
    match column.strip_prefix('-') {
        Some(name) => (name, -1.0),
        None => (column, 1.0),
    }
}

type Error<'a> = dyn Fn(&str, String) -> StudyError + 'a;

/// Loads the deck with every choice, because an error in the last choice would otherwise appear only after hours.
fn try_all(
    deck: &Path,
    set: &[(String, String)],
    short: &Short,
    choices: &[Choice],
    error: &Error<'_>,
) -> Result<(), StudyError> {
    for (i, choice) in choices.iter().enumerate() {
        let mut forms = vec![&[][..]];
        if let (Short::Set(more), true) = (short, choice.short) {
            forms.push(more);
        }
        for form in forms {
            let all = [set, form, &choice.set].concat();
            Deck::load(deck, &all).map_err(|why| {
                let what = format!("the deck of `{}` is wrong: {why}", choice.name);
                error(&format!("choices.{i}"), what)
            })?;
        }
    }
    Ok(())
}

fn named(name: &str, key: &str, error: &Error<'_>) -> Result<(), StudyError> {
    if name.is_empty() || name.contains([',', '"', '\n', '|']) {
        let what = "a name has letters, and no comma, quote or bar".to_owned();
        return Err(error(key, what));
    }
    Ok(())
}

/// Context for the checks of a scene's parts.
#[derive(Clone, Copy)]
struct Context<'a> {
    source: &'a Source,
    folder: &'a Path,
    /// Compared columns.
    columns: [&'a str; 2],
    error: &'a Error<'a>,
}

impl Context<'_> {
    fn choices(&self, written: Vec<ChoiceFile>) -> Result<Vec<Choice>, StudyError> {
        let Self { source, error, .. } = *self;
        let mut choices: Vec<Choice> = Vec::new();
        for (i, written) in written.into_iter().enumerate() {
            let key = |name: &str| format!("choices.{i}.{name}");
            if choices.iter().any(|c| c.name == written.name) {
                return Err(error(&key("name"), "two choices have this name".to_owned()));
            }
            // The table of a scene is a CSV file.
            named(&written.name, &key("name"), error)?;
            if written.threads == 0 {
                return Err(error(&key("threads"), "must be 1 or more".to_owned()));
            }
            if !(written.factor.is_finite() && written.factor > 0.0) {
                return Err(error(&key("factor"), "must be above 0".to_owned()));
            }
            choices.push(Choice {
                set: pairs(source, &key("set"), &written.set)?,
                name: written.name,
                group: written.group,
                threads: written.threads,
                factor: written.factor,
                short: written.short,
            });
        }
        let mut defaults = choices.iter().filter(|c| c.group == Group::Default);
        match (defaults.next(), defaults.next()) {
            (Some(default), None) if default.short => Ok(choices),
            (Some(_), None) => Err(error(
                "choices",
                "the default must be in the short form, too".to_owned(),
            )),
            (None, _) => Err(error(
                "choices",
                "none of the choices is the default".to_owned(),
            )),
            _ => Err(error("choices", "two choices are the default".to_owned())),
        }
    }

    /// Checks the peers, whose names must differ from each other and from those of the choices.
    fn peers(
        &self,
        written: Vec<PeerFile>,
        to: f64,
        choices: &[Choice],
    ) -> Result<Vec<Peer>, StudyError> {
        let checked = written.into_iter().enumerate();
        let checked = checked.map(|(i, peer)| self.peer(i, peer, to));
        let peers = checked.collect::<Result<Vec<Peer>, _>>()?;
        for (i, peer) in peers.iter().enumerate() {
            let of_choices = choices.iter().map(|c| &c.name);
            let mut others = of_choices.chain(peers[..i].iter().map(|p| &p.name));
            if others.any(|name| *name == peer.name) {
                let what = "two choices or peers have this name".to_owned();
                return Err((self.error)(&format!("peers.{i}.name"), what));
            }
        }
        Ok(peers)
    }

    fn peer(&self, i: usize, written: PeerFile, to: f64) -> Result<Peer, StudyError> {
        let Self {
            error,
            columns: [x, y],
            ..
        } = *self;
        let key = |name: &str| format!("peers.{i}.{name}");
        named(&written.name, &key("name"), error)?;
        if !(written.default_cpu.is_finite() && written.default_cpu > 0.0) {
            return Err(error(&key("default_cpu"), "must be above 0".to_owned()));
        }
        let file = self.folder.join(&written.file);
        let x = written.x.as_deref().unwrap_or(x);
        let curve = curve::read(&file, x, written.y.as_deref().unwrap_or(y))?;
        let spent = curve::read(&file, x, &written.cpu)?;
        let Some(cpu) = spent_to(&spent, to).filter(|cpu| *cpu > 0.0) else {
            let what = format!("its curve does not come to {to}, or its time there is not above 0");
            return Err(error(&key("file"), what));
        };
        let curve = curve.into_iter().map(|[x, y]| [x, written.y_factor * y]);
        Ok(Peer {
            name: written.name,
            differs: written.differs,
            curve: curve.collect(),
            file,
            cpu,
            default_cpu: written.default_cpu,
        })
    }

    fn reference(&self, written: ReferenceFile) -> Result<Reference, StudyError> {
        let Self {
            source,
            folder,
            columns: [x, y],
            error,
        } = *self;
        let key = |name: &str| format!("reference.{name}");
        if !(written.uncertainty.is_finite() && written.uncertainty > 0.0) {
            let what = "must be above 0: no number is exact".to_owned();
            return Err(error(&key("uncertainty"), what));
        }
        if written.peak.is_some_and(|p| !(p.is_finite() && p > 0.0)) {
            return Err(error(&key("peak"), "must be above 0".to_owned()));
        }
        let origin = match (written.set, written.command) {
            (Some(set), None) => Origin::Run(Choice {
                name: "reference".to_owned(),
                group: Group::Several,
                set: pairs(source, &key("set"), &set)?,
                threads: written.threads.max(1),
                factor: written.factor.unwrap_or(1.0),
                short: false,
            }),
            (None, Some(command)) => Origin::Command(command),
            _ => {
                let what = "a reference says its `set` or its `command`, one of them".to_owned();
                return Err(error(&key("command"), what));
            }
        };
        let file = folder.join(&written.file);
        let columns = [
            written.x.as_deref().unwrap_or(x),
            written.y.as_deref().unwrap_or(y),
        ];
        // A reference that is still to be computed has no file.
        let curve = if file.exists() || matches!(origin, Origin::Command(_)) {
            curve::read(&file, columns[0], columns[1])?
        } else {
            Vec::new()
        };
        let pattern = folder.join(PATTERN);
        Ok(Reference {
            pattern: pattern
                .exists()
                .then(|| Pattern::read(&pattern))
                .transpose()?,
            curve: curve
                .into_iter()
                .map(|[x, y]| [x, written.y_factor * y])
                .collect(),
            peak: written.peak,
            file,
            how: written.how,
            uncertainty: written.uncertainty,
            origin,
        })
    }
}
