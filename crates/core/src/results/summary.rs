//! `summary.json`: one run in one page.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use crate::files::write_whole;
use crate::model::mirrored::part;

use super::{Curve, Verdict, VerdictKind};
use crate::state::{EnergyBalance, Fall, Status, Summary};

/// The content of `summary.json`. Field names are its keys.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
pub struct SummaryFile {
    /// How the run ended.
    pub status: Status,
    /// What happened, in one sentence; empty in summaries of earlier versions.
    #[serde(default)]
    pub verdict: String,
    /// The same in one word.
    #[serde(default)]
    pub verdict_kind: Option<VerdictKind>,
    /// Where, why and what to try, if it did not complete.
    pub message: String,
    /// Largest force along the motion [kN], see [`Curve::peak`].
    pub peak_force_kN: Option<f64>,
    /// Displacement there [mm].
    pub displacement_at_peak_mm: Option<f64>,
    /// Displacement after the peak at which the force is down to 0.8 of it [mm].
    pub displacement_at_80_percent_mm: Option<f64>,
    /// Last displacement [mm].
    pub final_displacement_mm: Option<f64>,
    /// Secant up to a tenth of the peak [kN/mm], see [`Curve::initial_stiffness`].
    pub initial_stiffness_kN_per_mm: Option<f64>,
    /// Units (bodies).
    pub units: usize,
    /// Hex8 elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Unknowns that were solved.
    pub dofs: usize,
    /// Contact points.
    pub contact_points: usize,
    /// Planes that the scene is mirrored by, if one half of it was solved; two of a quarter.
    #[serde(default)]
    pub mirror_planes: Vec<String>,
    /// Converged increments.
    pub increments: usize,
    /// Linear solves.
    pub iterations: usize,
    /// Cut-backs.
    pub cutbacks: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// How many of them were saved because parts of the matrix had not changed, by their operations.
    #[serde(default)]
    pub reused: f64,
    /// Solves of regions by themselves, where what is out of balance is found in few places.
    #[serde(default)]
    pub local_solves: usize,
    /// Evaluations of all forces, those of the line search among them.
    pub force_evaluations: usize,
    /// Wall-clock time from the creation of the folder to its end [s].
    pub wall_s: f64,
    /// CPU time of the process meanwhile [s], where the system tells.
    pub cpu_s: Option<f64>,
    /// Where the time went.
    pub seconds_by_phase: SecondsByPhase,
    /// Largest resident memory [MB], where the system tells.
    pub peak_rss_MB: Option<f64>,
    /// See [`EnergyBalance`] [-].
    pub energy_balance_error: f64,
    /// Threads.
    pub threads: usize,
    /// Version of wythe.
    pub version: String,
    /// Warnings of the model, then of the run.
    pub warnings: Vec<String>,
    /// Where the procedure changed, and why.
    pub log: Vec<String>,
    /// All that was dissipated [J].
    #[serde(default)]
    pub dissipated_energy_J: f64,
    /// Largest force along the motion on the other side, of a drive to and fro [kN].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opposite_peak_force_kN: Option<f64>,
    /// Displacement there [mm].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_at_opposite_peak_mm: Option<f64>,
    /// What moved under inertia when the run ended, where that took over from statics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fall: Option<Fall>,
    /// Probes and loads by their columns in the history; absent without any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub probes: BTreeMap<String, ProbeRange>,
}

/// What a probe has been through [mm, mm/s].
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ProbeRange {
    /// Lowest value; none before any increment.
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

/// Wall-clock seconds of the phases of a run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SecondsByPhase {
    /// Strains, stresses, tangents and forces of the elements.
    pub elements: f64,
    /// Search and law of the contact.
    pub contact: f64,
    /// Gathering of matrix and residual.
    pub assembly: f64,
    /// Numeric and symbolic factorisation.
    pub factorise: f64,
    /// Substitution and refinement.
    pub solve: f64,
    /// Writing.
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

/// What the summary needs beside the solver's own [`Summary`].
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The load-displacement curve.
    pub curve: &'a Curve,
    /// What happened.
    pub verdict: &'a Verdict,
    /// The energies.
    pub energy: &'a EnergyBalance,
    /// Probes by their columns.
    pub probes: &'a BTreeMap<String, ProbeRange>,
    /// Wall-clock seconds of the run.
    pub wall_s: f64,
    /// CPU seconds of the run.
    pub cpu_s: Option<f64>,
    /// Largest resident memory [MB].
    pub peak_rss_megabytes: Option<f64>,
    /// Warnings of the model.
    pub model_warnings: &'a [String],
}

impl SummaryFile {
    /// Puts together what the solver knows and what was measured beside it.
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
            dissipated_energy_J: measured.energy.dissipated(),
            opposite_peak_force_kN: opposite.map(|p| p.force),
            displacement_at_opposite_peak_mm: opposite.map(|p| p.displacement),
            fall: run.fall.clone(),
            probes: measured.probes.clone(),
        }
    }

    /// What part of the scene was solved, in words; none if all of it.
    pub fn part_solved(&self) -> Option<String> {
        let part = part(self.mirror_planes.len())?;
        let planes = self.mirror_planes.join(" and ");
        Some(format!("{part} of it, mirrored by {planes}"))
    }

    /// Writes the file whole or not at all.
    ///
    /// # Errors
    /// The file, or its temporary neighbour, cannot be written.
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
            wall_s: 1.5,
            cpu_s: Some(3.0),
            peak_rss_megabytes: None,
            model_warnings: &["of the model".to_owned()],
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
