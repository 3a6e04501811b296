//! `summary.json`: the key figures of a run.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use crate::files::write_whole;
use crate::model::mirrored::part;

#[cfg(feature = "run-folder")]
use super::Answers;
use super::estimate::ErrorEstimate;
use super::{Curve, Verdict, VerdictKind};
use crate::state::{EnergyBalance, Fall, Status, Summary};

/// Content of `summary.json`; the names of the fields are its keys.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
// More than 15 fields: one for each key of the file.
pub struct SummaryFile {
    /// Status at the end of the run.
    pub status: Status,
    /// Verdict in one sentence; empty in summaries of earlier versions.
    #[serde(default)]
    pub verdict: String,
    /// Verdict in one word.
    #[serde(default)]
    pub verdict_kind: Option<VerdictKind>,
    /// Place, reason and remedy, if the run did not complete.
    pub message: String,
    /// Largest force along the motion [kN], see [`Curve::peak`].
    pub peak_force_kN: Option<f64>,
    /// Displacement at the peak [mm].
    pub displacement_at_peak_mm: Option<f64>,
    /// Displacement after the peak at which the force has fallen to 0.8 of the peak [mm].
    pub displacement_at_80_percent_mm: Option<f64>,
    /// Last displacement [mm].
    pub final_displacement_mm: Option<f64>,
    /// Secant stiffness up to a tenth of the peak [kN/mm], see [`Curve::initial_stiffness`].
    pub initial_stiffness_kN_per_mm: Option<f64>,
    /// Units (bodies).
    pub units: usize,
    /// Hex8 elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Number of unknowns in the solution.
    pub dofs: usize,
    /// Contact points.
    pub contact_points: usize,
    /// Mirror planes used: one if half of the scene was solved, two for a quarter.
    #[serde(default)]
    pub mirror_planes: Vec<String>,
    /// Number of converged increments.
    pub increments: usize,
    /// Number of linear solves.
    pub iterations: usize,
    /// Number of rejected increments.
    pub cutbacks: usize,
    /// Number of factorisations.
    pub factorisations: usize,
    /// Factorisations saved by reusing unchanged parts of the matrix, weighted by their operations.
    #[serde(default)]
    pub reused: f64,
    /// Number of solves of regions, used if few nodes are out of balance.
    #[serde(default)]
    pub local_solves: usize,
    /// Number of evaluations of all forces, those of the line search included.
    pub force_evaluations: usize,
    /// Wall-clock time from the creation of the folder to the end [s].
    pub wall_s: f64,
    /// CPU time of the process in this time [s]; `None` if the system does not report it.
    pub cpu_s: Option<f64>,
    /// Wall-clock time by phase.
    pub seconds_by_phase: SecondsByPhase,
    /// Peak resident memory [MB]; `None` if the system does not report it.
    pub peak_rss_MB: Option<f64>,
    /// Error of the energy balance [-], see [`EnergyBalance`].
    pub energy_balance_error: f64,
    /// Number of threads.
    pub threads: usize,
    /// Version of wythe.
    pub version: String,
    /// Warnings of the model, followed by those of the run.
    pub warnings: Vec<String>,
    /// Changes of procedure with their reasons.
    pub log: Vec<String>,
    /// What named materials and joints took from the catalogue, with sources; absent without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<String>,
    /// Total dissipated energy [J].
    #[serde(default)]
    pub dissipated_energy_J: f64,
    /// Largest force along the motion on the opposite side of a cyclic drive [kN].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opposite_peak_force_kN: Option<f64>,
    /// Displacement at the opposite peak [mm].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_at_opposite_peak_mm: Option<f64>,
    /// Bodies in motion under inertia at the end of the run, if inertia took over from statics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fall: Option<Fall>,
    /// Ranges of probes and loads by their history columns; absent without any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub probes: BTreeMap<String, ProbeRange>,
    /// Answers in the terms of engineers and codes; `None` in summaries of earlier versions.
    #[cfg(feature = "run-folder")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answers: Option<Answers>,
    /// Estimate of the error by discretisation, if the run has companions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<ErrorEstimate>,
}

/// Range of a probe over the run, in its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ProbeRange {
    /// Lowest value; `None` before the first increment.
    pub lowest: Option<f64>,
    /// Highest value.
    pub highest: Option<f64>,
    /// Last value.
    pub last: Option<f64>,
}

impl ProbeRange {
    /// Adds an increment.
    pub fn push(&mut self, value: f64) {
        self.lowest = Some(self.lowest.map_or(value, |l| l.min(value)));
        self.highest = Some(self.highest.map_or(value, |h| h.max(value)));
        self.last = Some(value);
    }
}

/// Wall-clock times of the phases of a run [s].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SecondsByPhase {
    /// Strains, stresses, tangents and forces of the elements.
    pub elements: f64,
    /// Contact search and joint laws.
    pub contact: f64,
    /// Assembly of matrix and residual.
    pub assembly: f64,
    /// Symbolic and numeric factorisation.
    pub factorise: f64,
    /// Substitution and iterative refinement.
    pub solve: f64,
    /// Writing of results.
    pub output: f64,
}

impl From<[f64; 6]> for SecondsByPhase {
    fn from([elements, contact, assembly, factorise, solve, output]: [f64; 6]) -> Self {
        Self {
            elements,
            contact,
            assembly,
            factorise,
            solve,
            output,
        }
    }
}

/// Data of the summary beside the solver's [`Summary`].
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The load-displacement curve.
    pub curve: &'a Curve,
    /// The verdict.
    pub verdict: &'a Verdict,
    /// The energy balance.
    pub energy: &'a EnergyBalance,
    /// Ranges of the probes by column.
    pub probes: &'a BTreeMap<String, ProbeRange>,
    /// The answers.
    #[cfg(feature = "run-folder")]
    pub answers: Option<&'a Answers>,
    /// Wall-clock time of the run [s].
    pub wall_s: f64,
    /// CPU time of the run [s].
    pub cpu_s: Option<f64>,
    /// Peak resident memory [MB].
    pub peak_rss_megabytes: Option<f64>,
    /// Warnings of the model.
    pub model_warnings: &'a [String],
    /// What named materials and joints took from the catalogue.
    pub assumed: &'a [String],
}

impl SummaryFile {
    /// Combines the data of the solver with the measured data.
    pub fn new(run: &Summary, measured: &Measured<'_>) -> Self {
        let peak = measured.curve.peak();
        let turns = measured.curve.turns_back();
        let opposite = measured.curve.opposite_peak().filter(|_| turns);
        let warnings = measured
            .model_warnings
            .iter()
            .chain(&run.warnings)
            .cloned()
            .collect();
        Self {
            status: run.status,
            verdict: measured.verdict.text.clone(),
            verdict_kind: Some(measured.verdict.kind),
            message: run.message.clone(),
            peak_force_kN: peak.map(|p| p.force),
            displacement_at_peak_mm: peak.map(|p| p.displacement),
            displacement_at_80_percent_mm: measured.curve.displacement_at_80_percent(),
            final_displacement_mm: measured.curve.final_displacement(),
            initial_stiffness_kN_per_mm: measured.curve.initial_stiffness(),
            units: run.sizes.units,
            elements: run.sizes.elements,
            nodes: run.sizes.nodes,
            dofs: run.sizes.dofs,
            contact_points: run.sizes.contact_points,
            mirror_planes: run.mirror_planes.iter().map(ToString::to_string).collect(),
            increments: run.increments,
            iterations: run.iterations,
            cutbacks: run.cutbacks,
            factorisations: run.factorisations,
            reused: run.reused,
            local_solves: run.local_solves,
            force_evaluations: run.evaluations,
            wall_s: measured.wall_s,
            cpu_s: measured.cpu_s,
            seconds_by_phase: run.seconds_by_phase.into(),
            peak_rss_MB: measured.peak_rss_megabytes,
            energy_balance_error: measured.energy.error(),
            threads: run.threads,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            warnings,
            log: run.log.clone(),
            assumed: measured.assumed.to_vec(),
            dissipated_energy_J: measured.energy.dissipated(),
            opposite_peak_force_kN: opposite.map(|p| p.force),
            displacement_at_opposite_peak_mm: opposite.map(|p| p.displacement),
            fall: run.fall.clone(),
            probes: measured.probes.clone(),
            #[cfg(feature = "run-folder")]
            answers: measured.answers.cloned(),
            error_estimate: None,
        }
    }

    /// Description of the solved part of the scene; `None` if all of it was solved.
    pub fn part_solved(&self) -> Option<String> {
        let part = part(self.mirror_planes.len())?;
        let planes = self.mirror_planes.join(" and ");
        Some(format!("{part} of it, mirrored by {planes}"))
    }

    /// Writes the whole file or nothing.
    ///
    /// # Errors
    /// The file or its temporary version cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        write_whole(path, text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    #[expect(clippy::too_many_lines, reason = "a list of keys")]
    fn the_keys_are_those_promised_in_their_order() {
        let (curve, energy) = (Curve::default(), EnergyBalance::default());
        let verdict = Verdict {
            kind: VerdictKind::NotConverged,
            text: "not converged".to_owned(),
        };
        let measured = Measured {
            verdict: &verdict,
            curve: &curve,
            energy: &energy,
            probes: &BTreeMap::new(),
            #[cfg(feature = "run-folder")]
            answers: None,
            wall_s: 1.5,
            cpu_s: Some(3.0),
            peak_rss_megabytes: None,
            model_warnings: &["of the model".to_owned()],
            assumed: &[],
        };
        let mut run = fake::summary(Status::NotConverged);
        run.warnings = vec!["of the run".to_owned()];
        let text = serde_json::to_string(&SummaryFile::new(&run, &measured)).unwrap();
        let keys = [
            "status",
            "verdict",
            "verdict_kind",
            "message",
            "peak_force_kN",
            "displacement_at_peak_mm",
            "displacement_at_80_percent_mm",
            "final_displacement_mm",
            "initial_stiffness_kN_per_mm",
            "units",
            "elements",
            "nodes",
            "dofs",
            "contact_points",
            "mirror_planes",
            "increments",
            "iterations",
            "cutbacks",
            "factorisations",
            "reused",
            "local_solves",
            "force_evaluations",
            "wall_s",
            "cpu_s",
            "seconds_by_phase",
            "elements",
            "contact",
            "assembly",
            "factorise",
            "solve",
            "output",
            "peak_rss_MB",
            "energy_balance_error",
            "threads",
            "version",
            "warnings",
            "log",
            "dissipated_energy_J",
        ];
        let mut rest = text.as_str();
        for key in keys {
            let quoted = format!("\"{key}\":");
            let at = rest
                .find(&quoted)
                .unwrap_or_else(|| panic!("{key} is missing in {text}"));
            rest = &rest[at + quoted.len()..];
        }
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value.as_object().unwrap().len(), keys.len() - 6);
        assert_eq!(value["status"], "not_converged");
        assert!(value["displacement_at_80_percent_mm"].is_null());
        assert_eq!(
            value["warnings"],
            serde_json::json!(["of the model", "of the run"])
        );
    }
}
