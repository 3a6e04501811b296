//! A run of a standard test: its sizes, its history, its gauges.

use super::formulas::LAST;
use crate::deck::Deck;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{DeckTest, TestKind};
use crate::element::hexahedron::{difference, norm};
use crate::error::{DeckError, ModelError};
use crate::model::Model;
use crate::results::output::DECK;
use crate::results::{Curve, ReadError, ReadHistory, RunFolder, VerdictKind};
use std::collections::BTreeMap;
use std::path::Path;

/// Tensile damage of the solids from which a test of a joint is one of its units or mortar, too [-].
const CRACKED: f64 = 0.5;

/// Damage of the joints at the end up to which they are undamaged [-].
const UNDAMAGED: f64 = 0.1;

/// Part of the largest force which a joint may still lose at the end of its test [-].
const UNBROKEN: f64 = 0.02;

/// A run of a standard test.
#[derive(Clone, Debug)]
pub struct TestRun {
    /// Name of its folder, without the ending.
    pub name: String,
    /// Test and sizes.
    pub test: DeckTest,
    /// History.
    pub history: ReadHistory,
    /// Distances at rest of the two nodes of each probe that is a gauge, by column [mm].
    pub gauges: BTreeMap<String, f64>,
    /// Load factor of the last equilibrium, if the run collapsed [-].
    pub collapsed_at: Option<f64>,
    /// Verdict; none of a run that has not ended.
    pub verdict: Option<VerdictKind>,
    /// Values of `[test]` that are not those of the steps.
    pub contradictions: Vec<String>,
}

/// An error of an evaluation.
#[derive(Debug, thiserror::Error)]
pub enum EvaluationError {
    /// No folder was given.
    #[error("there is no run to evaluate")]
    NoRuns,
    /// A run of a deck without `[test]`.
    #[error("{0}: its deck has no table [test], which says which test it is")]
    NoTest(String),
    /// Runs of two tests.
    #[error("{first} and {other} are runs of different tests")]
    Mixed {
        /// A run.
        first: String,
        /// A run of another test.
        other: String,
    },
    /// A run without a force.
    #[error("{0}: the run has no increment in which a force or a displacement acts")]
    NoCurve(String),
    /// A size that the evaluation needs.
    #[error("{run}: test.{key} is missing in its deck")]
    NoSize {
        /// The run.
        run: String,
        /// The key.
        key: &'static str,
    },
    /// A column that the evaluation needs.
    #[error("{run}: the history has no column {column}")]
    NoColumn {
        /// The run.
        run: String,
        /// The column.
        column: String,
    },
    /// A folder that cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A deck that cannot be read.
    #[error(transparent)]
    Deck(#[from] Box<DeckError>),
    /// A deck that cannot be built.
    #[error(transparent)]
    Model(#[from] Box<ModelError>),
}

impl EvaluationError {
    /// Advice how to correct it.
    pub fn help(&self) -> &'static str {
        match self {
            Self::NoRuns | Self::Read(_) => {
                "name the folders of the runs: wythe evaluate triplet-0.2.out triplet-0.6.out"
            }
            Self::NoTest(_) => "wythe new NAME --test en1052-3 writes decks with it",
            Self::Mixed { .. } => "evaluate the runs of one test at a time",
            Self::NoCurve(_) => "run the deck through its last step",
            Self::NoSize { .. } | Self::NoColumn { .. } | Self::Model(_) | Self::Deck(_) => {
                "docs/reference/standard-tests.md lists the sizes and probes that an evaluation needs"
            }
        }
    }
}

/// Values of `[test]` that none of the steps has, although some have such a value. The evaluation takes those of `[test]`.
pub(super) fn contradictions(deck: &Deck) -> Vec<String> {
    let Some(test) = &deck.test else {
        return Vec::new();
    };
    let said = |key: &str, of_test: Option<f64>, of_steps: Vec<f64>| {
        let of_test = of_test?;
        // Values with units are converted.
        let is_same = |value: &f64| (value - of_test).abs() <= 1e-9 * of_test.abs();
        let differs = !of_steps.is_empty() && !of_steps.iter().any(is_same);
        differs.then(|| {
            format!(
                "test.{key} is {of_test}, and the steps have {}: the results are those of test.{key}, which has to be \
                 changed with the steps",
                of_steps[0]
            )
        })
    };
    let steps = || deck.steps.iter();
    let pressures = steps().flat_map(|step| [step.top_pressure, step.pressure]);
    let pressures = pressures.flatten().map(Quantity::get).collect();
    let angles = steps().filter_map(|step| step.angle).map(Quantity::get);
    let found = [
        said("pressure", test.pressure.map(Quantity::get), pressures),
        said("angle", test.angle.map(Quantity::get), angles.collect()),
    ];
    found.into_iter().flatten().collect()
}

impl TestRun {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// No run, no deck, a deck without `[test]` or that cannot be built.
    pub fn read(path: &Path) -> Result<Self, EvaluationError> {
        let folder = RunFolder::open(path)?;
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let deck = Deck::load(folder.path().join(DECK), &[]).map_err(Box::new)?;
        let deck = folder.place(deck);
        let Some(test) = deck.test.clone() else {
            return Err(EvaluationError::NoTest(name));
        };
        let summary = folder.summary()?;
        let fall = summary.as_ref().and_then(|summary| summary.fall.as_ref());
        Ok(Self {
            name,
            test,
            history: folder.history()?,
            gauges: gauges(&deck)?,
            collapsed_at: fall.map(|fall| fall.load_factor),
            verdict: summary.and_then(|summary| summary.verdict_kind),
            contradictions: contradictions(&deck),
        })
    }

    /// Load-displacement curve.
    pub(super) fn curve(&self) -> Curve {
        self.history.curve()
    }

    /// Area of the bed, `length` times `thickness` [mm²].
    pub(super) fn area(&self) -> Result<f64, EvaluationError> {
        Ok(self.size("length", self.test.length)? * self.size("thickness", self.test.thickness)?)
    }

    /// A size of `[test]` in its base unit.
    pub(super) fn size<const L: i8, const M: i8, const T: i8, const A: i8>(
        &self,
        key: &'static str,
        value: Option<Quantity<L, M, T, A>>,
    ) -> Result<f64, EvaluationError> {
        let run = || self.name.clone();
        value
            .map(Quantity::get)
            .ok_or_else(|| EvaluationError::NoSize { run: run(), key })
    }

    /// A column of the history beyond the fixed ones. `[increment]`
    pub(super) fn column(&self, name: &str) -> Result<Vec<f64>, EvaluationError> {
        let at = self.history.probes.iter().position(|column| column == name);
        let Some(at) = at else {
            return Err(EvaluationError::NoColumn {
                run: self.name.clone(),
                column: name.to_owned(),
            });
        };
        let of = |row: &crate::state::HistoryRow| row.probes.get(at).copied().unwrap_or_default();
        Ok(self.history.rows.iter().map(of).collect())
    }

    /// Largest force [kN] and the index of its row in the history.
    ///
    /// # Errors
    /// A run without a curve.
    pub(super) fn peak(&self) -> Result<(f64, usize), EvaluationError> {
        let none = || EvaluationError::NoCurve(self.name.clone());
        let peak = self.curve().peak().ok_or_else(none)?;
        let mut rows = self.history.rows.iter().zip(self.history.driven());
        let here = rows.position(|(row, driven)| {
            driven && row.displacement_mm == peak.displacement && row.force_kN == peak.force
        });
        Ok((peak.force, here.ok_or_else(none)?))
    }

    /// Adds remarks on the run.
    pub(super) fn remarks(&self, notes: &mut Vec<String>) {
        self.remark_on_verdict(notes);
        let told = self.contradictions.iter();
        notes.extend(told.map(|what| format!("{}: {what}", self.name)));
        if self.test.kind.measures_joints() {
            if self.broke_beside_the_joint() {
                self.remark_on_solids(notes);
            } else {
                self.remark_on_joints(notes);
            }
        }
        if self.test.kind == TestKind::TiltingTable && !self.has_fallen() {
            notes.push(format!(
                "{}: the wall has not fallen: the angle is that at which the run ended, and no angle of collapse",
                self.name
            ));
        }
    }

    /// Whether the wall of a tilting table has fallen.
    pub(super) fn has_fallen(&self) -> bool {
        self.collapsed_at.is_some() || self.verdict == Some(VerdictKind::Collapsed)
    }

    /// Whether units or mortar have cracked at the end of the test of a joint that is undamaged.
    fn broke_beside_the_joint(&self) -> bool {
        let last = self.history.rows.last();
        last.is_some_and(|row| {
            row.max_tensile_damage >= CRACKED && row.max_interface_damage <= UNDAMAGED
        })
    }

    fn remark_on_solids(&self, notes: &mut Vec<String>) {
        let Some(last) = self.history.rows.last() else {
            return;
        };
        notes.push(format!(
            "{}: units or mortar broke (tensile damage {:.2} at the end), and the joint did not (damage {:.2}): strength \
             and energy are not those of the joint, which carries more",
            self.name, last.max_tensile_damage, last.max_interface_damage
        ));
    }

    /// Tells where the forces are not those of the joint alone, or where the drive was too short to break it.
    fn remark_on_joints(&self, notes: &mut Vec<String>) {
        let name = &self.name;
        let Ok((peak, row)) = self.peak() else { return };
        let damage = self.history.rows[row].max_tensile_damage;
        if damage >= CRACKED {
            notes.push(format!(
                "{name}: solids had cracked at the largest force (tensile damage {damage:.2}): it is not the strength \
                 of the joint alone; look where they cracked"
            ));
        }
        if self.verdict != Some(VerdictKind::PeakPassed) {
            return;
        }
        let missing = match self.test.kind {
            TestKind::BondWrench => return,
            TestKind::CoupletTension => "the fracture energy lacks the rest",
            _ => "the residual strength is not reached",
        };
        let curve = self.curve();
        let last = curve.points().last().map_or(0.0, |point| point.1);
        let left = match self.test.kind {
            TestKind::CoupletTension => last,
            _ => -curve.rises_over(LAST),
        };
        if left > UNBROKEN * peak {
            notes.push(format!(
                "{name}: the force still falls at the end, at {last:.3} kN: {missing}; drive it further"
            ));
        }
    }

    fn remark_on_verdict(&self, notes: &mut Vec<String>) {
        let name = &self.name;
        let remark = match self.verdict {
            None => "has not ended",
            // The stress of the wall, or the pressure of a jack, is no force to be broken.
            Some(VerdictKind::StillRising)
                if matches!(
                    self.test.kind,
                    TestKind::FlatJack | TestKind::FlatJackDouble
                ) =>
            {
                return;
            }
            Some(VerdictKind::StillRising) => {
                "still rises at its end: the largest force is no strength"
            }
            Some(VerdictKind::NotConverged) => {
                "did not converge: the largest force may not be the strength"
            }
            Some(VerdictKind::Interrupted | VerdictKind::Stopped) => {
                "was interrupted: the largest force may not be the strength"
            }
            Some(_) => return,
        };
        notes.push(format!("{name} {remark}"));
    }
}

/// Distances of the nodes of the gauges of a deck [mm], by column.
fn gauges(deck: &Deck) -> Result<BTreeMap<String, f64>, EvaluationError> {
    if deck.probes.iter().all(|probe| probe.gauge.is_none()) {
        return Ok(BTreeMap::new());
    }
    let (model, _) = Model::from_deck(deck).map_err(Box::new)?;
    let is_gauge = deck.probes.iter().map(|probe| probe.gauge.is_some());
    let found = model
        .probes
        .iter()
        .zip(is_gauge)
        .filter(|(_, is_gauge)| *is_gauge);
    let length = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|n| model.mesh.nodes[n as usize]);
        norm(difference(b, a))
    };
    Ok(found
        .map(|(probe, _)| {
            (
                probe.column.clone(),
                length([probe.minus[0], probe.nodes[0]]),
            )
        })
        .collect())
}
