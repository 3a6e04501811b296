//! A deck and the model built from it on request.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use pyo3::prelude::*;
use serde_json::{Value, json};
use wythe_core::deck::{self, Deck as CoreDeck};
use wythe_core::error::{DeckError, ModelError, Warning};
use wythe_core::limit::LimitSettings;
use wythe_core::model::Model;
use wythe_core::results::checkpoint::CheckpointFile;
use wythe_core::results::export::inp;
use wythe_core::results::output::{CHECKPOINT, DECK};
use wythe_core::results::plotting::scene;
use wythe_core::results::{FoundLimit, FoundModes};

use crate::errors::{self, Text};
use crate::limit::LimitOfModel;
use crate::modes::FoundShapes;

/// Title of a model without one.
const UNTITLED: &str = "model";

/// The model with its warnings, or the error that prevents it.
type Built = Result<(Model, Vec<Warning>), ModelError>;

/// A deck that was read; immutable.
#[pyclass(frozen, module = "wythe._wythe")]
pub struct Deck {
    said: CoreDeck,
    text: Text,
    built: OnceLock<Arc<Built>>,
}

impl Deck {
    fn new(deck: CoreDeck, text: Text) -> Self {
        Self {
            said: deck,
            text,
            built: OnceLock::new(),
        }
    }

    pub fn deck(&self) -> &CoreDeck {
        &self.said
    }

    /// The model and its warnings, built at the first call.
    pub fn built(&self, py: Python<'_>) -> Arc<Built> {
        let build = || Arc::new(Model::from_deck(&self.said));
        py.detach(|| Arc::clone(self.built.get_or_init(build)))
    }

    /// The model, or the exception that explains why there is none.
    pub fn sound(&self, py: Python<'_>) -> PyResult<Arc<Built>> {
        let built = self.built(py);
        match &*built {
            Ok(_) => Ok(built),
            Err(error) => Err(errors::of_model(py, error, self.text)),
        }
    }
}

#[pymethods]
impl Deck {
    /// Reads a text that was `written` by the user or generated. Files named in it are in `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, written, folder, overrides))]
    fn read(
        py: Python<'_>,
        text: &str,
        written: bool,
        folder: Option<PathBuf>,
        overrides: Vec<(String, String)>,
    ) -> PyResult<Self> {
        let kind = if written { Text::Written } else { Text::Made };
        let deck = py
            .detach(|| CoreDeck::from_str_with(text, UNTITLED, &overrides))
            .map_err(|error| errors::of_model(py, &error, kind))?;
        Ok(Self::new(deck.in_folder(folder.unwrap_or_default()), kind))
    }

    /// Reads the file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, overrides: Vec<(String, String)>) -> PyResult<Self> {
        let deck = py
            .detach(|| CoreDeck::load(&path, &overrides))
            .map_err(|error| errors::of_deck(py, &error))?;
        Ok(Self::new(deck, Text::File))
    }

    /// Reads the copy in the folder of a run. Files named in it are in their folder at the time of the run.
    #[staticmethod]
    fn of_run(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let deck = py
            .detach(|| CoreDeck::load(folder.join(DECK), &[]))
            .map_err(|error| errors::of_deck(py, &error))?;
        // Only the checkpoint knows this folder.
        let checkpoint = py.detach(|| CheckpointFile::read(&folder.join(CHECKPOINT)));
        let files = checkpoint.ok().and_then(|read| read.deck_folder);
        let deck = match files {
            Some(files) => deck.in_folder(files.into()),
            None => deck,
        };
        Ok(Self::new(deck, Text::File))
    }

    /// Converts JSON to TOML.
    #[staticmethod]
    fn toml_of_json(text: &str) -> PyResult<String> {
        // The Python half has removed nulls, which TOML does not have.
        let value: toml::Value = serde_json::from_str(text)
            .map_err(|error| errors::bug(&format!("a deck as JSON: {error}")))?;
        toml::to_string(&value).map_err(|error| errors::bug(&format!("a deck as TOML: {error}")))
    }

    /// The deck with all defaults in base units.
    fn to_toml(&self) -> PyResult<String> {
        let text = self.said.to_toml();
        text.map_err(|error| errors::bug(&format!("the deck as TOML: {error}")))
    }

    /// The deck with all defaults as JSON.
    fn to_json(&self) -> PyResult<String> {
        let text = serde_json::to_string(&self.said);
        text.map_err(|error| errors::bug(&format!("the deck as JSON: {error}")))
    }

    /// Whether lines and columns refer to a text written by the user.
    #[getter]
    fn is_written(&self) -> bool {
        self.text != Text::Made
    }

    #[getter]
    fn title(&self) -> &str {
        &self.said.title
    }

    /// Folder of the files named in the deck.
    #[getter]
    fn folder(&self) -> PathBuf {
        self.said.folder().to_owned()
    }

    /// Files that the deck names, and those that its meshes include.
    fn files(&self) -> Vec<PathBuf> {
        self.said.other_files()
    }

    /// The steps as in the deck.
    fn steps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&self.said.steps);
        let text = text.map_err(|error| errors::bug(&format!("steps as JSON: {error}")))?;
        errors::from_json(py, &text)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.said == other.said
    }

    /// Output of `wythe check --json`.
    fn check(&self, py: Python<'_>) -> String {
        let built = self.built(py);
        let found = py.detach(|| match &*built {
            Err(error) => json!({
                "ok": false,
                "title": self.said.title,
                "errors": error.all().map(|error| error_json(error, self.text)).collect::<Vec<_>>(),
                "warnings": error.warnings(),
                "notes": [],
                "sizes": null,
                "memory_MB": null,
                "processor_time_s": null,
            }),
            Ok((model, warnings)) => {
                let report = deck::check(&self.said, model);
                json!({
                    "ok": true,
                    "title": report.title,
                    "errors": [],
                    "warnings": warnings,
                    "notes": report.notes,
                    "sizes": report.sizes,
                    "memory_MB": report.memory_mb,
                    "processor_time_s": report.time_s,
                })
            }
        });
        found.to_string()
    }

    /// Picture of the model as SVG.
    fn picture(&self, py: Python<'_>) -> PyResult<String> {
        let built = self.sound(py)?;
        py.detach(|| match &*built {
            Ok((model, _)) => Ok(scene(model)),
            Err(error) => Err(errors::bug(&error.to_string())),
        })
    }

    /// Limit analysis.
    #[pyo3(signature = (associated, bonded, strength, along))]
    fn limit(
        &self,
        py: Python<'_>,
        associated: bool,
        bonded: bool,
        strength: Option<f64>,
        along: Option<[f64; 3]>,
    ) -> PyResult<LimitOfModel> {
        let built = self.sound(py)?;
        let settings = LimitSettings {
            associated,
            bonded,
            strength,
            along,
            ..LimitSettings::default()
        };
        let Ok((model, warnings)) = &*built else {
            return Err(errors::bug("a sound model is none"));
        };
        let found = py.detach(|| {
            let warnings = warnings.clone();
            FoundLimit::of(model.clone(), &settings).map(|found| FoundLimit { warnings, ..found })
        });
        LimitOfModel::of(py, found)
    }

    /// The lowest modes at rest.
    fn modes(&self, py: Python<'_>, count: usize) -> PyResult<FoundShapes> {
        let built = self.sound(py)?;
        let found = py.detach(|| match &*built {
            Ok((model, _)) => FoundModes::of_model(model.clone(), count),
            Err(error) => Err(DeckError::from(error.clone()).into()),
        });
        FoundShapes::of(py, found)
    }

    /// The model in the format of Abaqus.
    fn inp(&self, py: Python<'_>) -> PyResult<String> {
        let built = self.sound(py)?;
        py.detach(|| match &*built {
            Ok((model, _)) => Ok(inp::inp(model)),
            Err(error) => Err(errors::bug(&error.to_string())),
        })
    }
}

fn error_json(error: &ModelError, text: Text) -> Value {
    let (line, column) = errors::place(error, text);
    json!({
        "key": error.key(),
        "line": line,
        "column": column,
        "message": error.message(),
        "fix": errors::in_python(error.advice()),
    })
}
