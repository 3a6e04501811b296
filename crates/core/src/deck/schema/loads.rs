//! `[[steps.loads]]`, `amplitude` and `cycles` of a step: loads, and how they and the drive change with time.

use super::rows::rows;
use super::{Deck, DeckProcedure, DeckStep};
use super::{DeckFloor, DeckTie, Names};
use crate::deck::beams;
use crate::deck::quantity::{Force, Length, LineForce, Number, Pressure};
use crate::deck::sections::Draft;
use crate::error::ModelError;
use crate::material::LawOutput;
use crate::model::amplitude::Amplitude;
use crate::model::reactions;
use crate::model::scene::Fidelity;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;
use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;

/// A named load: its place, given where it is named first, and its value at the end of the step.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckLoad {
    /// Name, by which later steps change its value; its columns in the history begin with it.
    pub name: String,
    /// Faces; for a force also blocks.
    pub on: Option<Names>,
    /// A point at rest [mm]: the load acts on the nearest node, of those of `on` if given.
    pub near: Option<[Length; 3]>,
    /// Start of a line at rest [mm]: the load acts on the nodes along it, of those of `on` if given.
    pub from: Option<[Length; 3]>,
    /// End of the line [mm].
    pub to: Option<[Length; 3]>,
    /// Largest distance of these nodes from the line [mm].
    pub within: Option<Length>,
    /// Pressure on faces [MPa], compression positive.
    pub pressure: Option<Pressure>,
    /// Whether the pressure turns with the faces, like that of an airbag; true if absent.
    pub follower: Option<bool>,
    /// Force over the area of faces at rest [MPa].
    pub traction: Option<[Pressure; 3]>,
    /// Total force [N].
    pub force: Option<[Force; 3]>,
    /// Force over the length of the line at rest [N/mm].
    pub line_force: Option<[LineForce; 3]>,
}

/// `amplitude` of a step: rows of (fraction of the duration, factor), or a CSV file of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DeckAmplitude {
    /// Rows in the deck.
    Rows(Vec<[Number; 2]>),
    /// A file in the folder of the deck.
    File(String),
}

/// `cycles` of a driven step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckCycles {
    /// Amplitudes [mm], one after the other, each in both directions.
    pub amplitudes: Vec<Length>,
    /// Number of cycles of each amplitude.
    #[serde(default = "once")]
    pub repeat: u32,
}

fn once() -> u32 {
    1
}

impl DeckLoad {
    /// Kind of the load and its value [MPa, N or N/mm]; a pressure has one number. None if the load gives no value.
    pub fn value(&self) -> Option<(&'static str, [f64; 3])> {
        let pressure = self.pressure.map(|p| ("pressure", [p.get(), 0.0, 0.0]));
        let traction = self.traction.map(|t| ("traction", t.map(Pressure::get)));
        let force = self.force.map(|f| ("force", f.map(Force::get)));
        let line = self
            .line_force
            .map(|f| ("line_force", f.map(LineForce::get)));
        pressure.or(traction).or(force).or(line)
    }

    /// Names of its columns in the history: its value, if that is not a force, and the total force.
    pub fn columns(&self) -> Vec<String> {
        let name = &self.name;
        let value = match self.value() {
            Some(("pressure" | "traction", _)) => Some(format!("{name}_MPa")),
            Some(("line_force", _)) => Some(format!("{name}_N_per_mm")),
            _ => None,
        };
        value.into_iter().chain([format!("{name}_kN")]).collect()
    }
}

impl DeckStep {
    /// Length of a drive along its direction [mm]: its displacement, or the largest amplitude of its cycles.
    pub fn drive(&self) -> f64 {
        let largest = |cycles: &DeckCycles| {
            let ways = cycles.amplitudes.iter().map(|a| a.get());
            ways.fold(0.0, f64::max)
        };
        let said = self.displacement.map(Length::get);
        said.or(self.cycles.as_ref().map(largest)).unwrap_or(0.0)
    }
}

impl Deck {
    /// Additional columns of the history: of probes, loads, outputs, ties, supports and sections.
    pub fn columns(&self) -> Vec<String> {
        // Beams that turn bring loads.
        let whole = beams::written_out(self);
        let deck = whole.as_deref().unwrap_or(self);
        let sections = deck.drafts();
        let mut columns = deck.columns_but_of_sections();
        columns.extend(sections.iter().flat_map(Draft::columns));
        columns
    }

    /// Additional columns of the history without those of sections.
    pub(in crate::deck) fn columns_but_of_sections(&self) -> Vec<String> {
        let probes = self
            .probes
            .iter()
            .map(crate::deck::schema::DeckProbe::column);
        let loads = self
            .loads()
            .into_iter()
            .flat_map(|(_, load)| load.columns());
        let outputs = self.outputs().into_iter().map(|output| output.column());
        let floors = self.floors.iter().flat_map(DeckFloor::columns);
        let ties = self.ties.iter().flat_map(DeckTie::columns).chain(floors);
        let held = self.held_names();
        let supports = held.iter().map(|(name, fixed)| (name.as_str(), *fixed));
        let reactions = reactions::columns(supports);
        let of_solver = probes.chain(loads).chain(outputs).chain(ties);
        of_solver.chain(reactions).collect()
    }

    /// Names of the supports on the ground and the axes along which they hold: the clamped foot of the wall, those of
    /// the deck, the springings of the arch.
    fn held_names(&self) -> Vec<(String, [bool; 3])> {
        let foot = self.clamped().map(|_| ("bottom".to_owned(), [true; 3]));
        let own = self.supports.iter().map(|s| (s.on.0.join(", "), s.holds()));
        let arch = self.arch.as_ref();
        let arch = arch.map(|_| ("springings".to_owned(), [true; 3]));
        foot.into_iter().chain(own).chain(arch).collect()
    }

    /// What the laws of its solids show, each name once; nothing where solids stay elastic.
    fn outputs(&self) -> Vec<LawOutput> {
        if self.fidelity == Fidelity::Elastic {
            return Vec::new();
        }
        let materials = self.materials.values();
        LawOutput::once(materials.flat_map(|material| material.parameters().outputs()))
    }

    /// Loads in order, each at its first occurrence, with its path.
    pub(in crate::deck) fn loads(&self) -> Vec<(String, &DeckLoad)> {
        let mut loads: Vec<(String, &DeckLoad)> = Vec::new();
        let mut known = HashSet::new();
        for (s, step) in self.steps.iter().enumerate() {
            for (l, load) in step.loads.iter().enumerate() {
                if known.insert(load.name.as_str()) {
                    loads.push((format!("steps.{s}.loads.{l}"), load));
                }
            }
        }
        loads
    }

    /// Reads the amplitude of a step, if it has one.
    ///
    /// # Errors
    /// A file that cannot be read, or invalid rows: key, file, line and reason.
    pub fn amplitude(&self, step: usize) -> Result<Option<Amplitude>, ModelError> {
        let read = self.read_amplitude(step)?;
        let of = &self.steps[step];
        if let Some(amplitude) = &read
            && let Some((why, help)) = crate::deck::schema::validate::misfit(of, amplitude)
        {
            return Err(self.error(&format!("steps.{step}.amplitude"), why, help));
        }
        // Along a path the load factor is an unknown and the amplitude is not used.
        let follows = matches!(
            of.procedure,
            DeckProcedure::ArcLength | DeckProcedure::Dissipation
        );
        Ok(read.filter(|_| !follows))
    }

    fn read_amplitude(&self, step: usize) -> Result<Option<Amplitude>, ModelError> {
        let of = &self.steps[step];
        let path = format!("steps.{step}.amplitude");
        let help = "rows of [part of the step's time, factor], from [0, 0] to time 1";
        match (&of.amplitude, &of.cycles) {
            (Some(DeckAmplitude::Rows(rows)), _) => {
                let rows = rows.iter().map(|row| row.map(Number::get)).collect();
                Amplitude::new(rows)
                    .map(Some)
                    .map_err(|no| self.error(&format!("{path}.{}", no.row), no.why, help))
            }
            (Some(DeckAmplitude::File(file)), _) => self.amplitude_of_file(&path, file).map(Some),
            (None, Some(cycles)) => {
                let ways: Vec<f64> = cycles.amplitudes.iter().map(|a| a.get()).collect();
                Amplitude::cycles(&ways, cycles.repeat)
                    .map(Some)
                    .map_err(|no| {
                        let help = "cycles = { amplitudes = [\"1 mm\", \"2 mm\"], repeat = 2 }";
                        self.error(&format!("steps.{step}.cycles"), no.why, help)
                    })
            }
            (None, None) => Ok(None),
        }
    }

    fn amplitude_of_file(&self, key: &str, file: &str) -> Result<Amplitude, ModelError> {
        let (path, text) = self.table(key, file)?;
        record(&text).map_err(|(line, why)| {
            let help = "a line has a time and a factor, such as 2.5, -0.75; times ascend from 0, in any unit: \
                        the last is the end of the step";
            self.error(key, format!("{} line {line}: {why}", path.display()), help)
        })
    }
}

/// The amplitude of a file, or the invalid line (from 1) and the reason. Its last time is the end of the step.
fn record(text: &str) -> Result<Amplitude, (usize, String)> {
    let rows = rows(text, "no time and factor")?;
    let whole = rows.last().map_or(1.0, |row| row.1[0]);
    let parts = rows
        .iter()
        .map(|(_, [time, factor])| [time / whole, *factor]);
    let line = |row: usize| rows.get(row).map_or(1, |row| row.0);
    Amplitude::new(parts.collect()).map_err(|no| (line(no.row), no.why))
}

impl JsonSchema for DeckAmplitude {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "DeckAmplitude".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let row = <[Number; 2]>::json_schema(generator);
        json_schema!({ "type": ["string", "array"], "items": row })
    }
}

struct AmplitudeVisitor;

impl<'de> Visitor<'de> for AmplitudeVisitor {
    type Value = DeckAmplitude;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("rows of [part of the step's time, factor], or the name of a CSV file")
    }

    fn visit_str<E: de::Error>(self, file: &str) -> Result<DeckAmplitude, E> {
        Ok(DeckAmplitude::File(file.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<DeckAmplitude, A::Error> {
        let rows = Vec::deserialize(SeqAccessDeserializer::new(seq))?;
        Ok(DeckAmplitude::Rows(rows))
    }
}

impl<'de> Deserialize<'de> for DeckAmplitude {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AmplitudeVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_times_in_any_unit() {
        let amplitude = record("# protocol\ns,mm\n0,0\n2.5,1\n7.5,-1\n10,0\n").unwrap();
        let rows = [[0.0, 0.0], [0.25, 1.0], [0.75, -1.0], [1.0, 0.0]];
        assert_eq!(amplitude.rows(), rows);
        for (text, line) in [
            ("0,0\n1,1\n1,2", 3),
            ("0,1\n1,1", 1),
            ("0,0\n1", 2),
            ("", 1),
        ] {
            assert_eq!(record(text).unwrap_err().0, line, "{text}");
        }
    }
}
