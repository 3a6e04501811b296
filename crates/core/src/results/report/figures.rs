//! Key figures of a run as tiles of the page.

use super::Experiment;
use super::page::escape;
use crate::results::answers::{PerformancePoint, name_of_class};
use crate::results::curve;
use crate::results::{Answers, ReadHistory, SummaryFile};

/// Names of the highlighted tile.
const PEAK: &str = "Peak force";
const LARGEST: &str = "Largest force";

/// A tile: name, value, unit and note.
struct Tile {
    name: &'static str,
    value: String,
    unit: &'static str,
    note: String,
}

/// The tiles as HTML. Figures of the summary are omitted if there is none.
pub(super) fn tiles(
    history: &ReadHistory,
    (summary, answers): (Option<&SummaryFile>, Option<&Answers>),
    experiment: Option<&Experiment>,
) -> String {
    let mut tiles = mechanics(history, experiment);
    tiles.extend(answers.into_iter().flat_map(answered));
    tiles.extend(effort(history, summary));
    let html = |tile: &Tile| {
        let Tile {
            name,
            value,
            unit,
            note,
        } = tile;
        let (value, note) = (escape(value), escape(note));
        let class = if [PEAK, LARGEST].contains(name) {
            "tile peak"
        } else {
            "tile"
        };
        format!(
            "<div class=\"{class}\"><dt>{name}</dt><dd><strong>{value}</strong> <span class=\"unit\">{unit}</span>\
             <span class=\"note\">{note}</span></dd></div>\n"
        )
    };
    tiles.iter().map(html).collect()
}

fn mechanics(history: &ReadHistory, experiment: Option<&Experiment>) -> Vec<Tile> {
    let curve = history.curve();
    let mut tiles = Vec::new();
    let mut tile = |name, value: String, unit, note: String| {
        tiles.push(Tile {
            name,
            value,
            unit,
            note,
        });
    };
    if let Some(peak) = curve.peak() {
        let at = format!("at {} mm", brief(peak.displacement));
        let note = match experiment.and_then(|e| measured_peak(e, peak.force.signum())) {
            Some(measured) => format!("{at}; measured {} kN", brief(measured)),
            None => at,
        };
        let name = if curve.passes_peak() { PEAK } else { LARGEST };
        tile(name, brief(peak.force), "kN", note);
    }
    if let Some(stiffness) = curve.initial_stiffness() {
        let note = "secant to a tenth of the largest force".to_owned();
        tile("Initial stiffness", brief(stiffness), "kN/mm", note);
    }
    if let Some(displacement) = curve.displacement_at_80_percent() {
        let note = "force down to 0.8 of the peak".to_owned();
        tile("At 80 %", brief(displacement), "mm", note);
    }
    if let Some(&(displacement, force)) = curve.points().last() {
        let note = format!("force {} kN", brief(force));
        tile("Final displacement", brief(displacement), "mm", note);
    }
    if let Some(last) = history.rows.last() {
        let dissipated = last.plastic_damage_dissipation_J
            + last.interface_dissipation_J
            + last.viscous_dissipation_J
            + last.damping_dissipation_J
            + last.numerical_dissipation_J;
        let work = last.external_work_J;
        let note = format!("{} J dissipated", brief(dissipated));
        tile("Work from outside", brief(work), "J", note);
    }
    tiles
}

/// The answers in a few tiles; the lines below them say the rest.
fn answered(answers: &Answers) -> Vec<Tile> {
    let mut tiles = Vec::new();
    let mut tile = |name, value: String, unit, note: String| {
        tiles.push(Tile {
            name,
            value,
            unit,
            note,
        });
    };
    if let Some(mode) = answers.failure_mode {
        let note = "mode of failure".to_owned();
        tile("Failure", mode.told().to_owned(), "", note);
    }
    if let Some(found) = answers.bilinear {
        let to = brief(found.ultimate_displacement_mm);
        let note = format!("to {to} mm; {} kN/mm", brief(found.stiffness_kN_per_mm));
        tile("Bilinear", brief(found.ultimate_force_kN), "kN", note);
        let note = "ultimate over yield displacement".to_owned();
        tile("Ductility", brief(found.ductility), "", note);
    }
    if let Some(drift) = answers.drift_at_peak {
        let note = "at the largest force".to_owned();
        tile("Drift", brief(100.0 * drift), "%", note);
    }
    if let Some(onset) = &answers.first_damage.joint {
        let note = format!("joint softens, at {} mm", brief(onset.displacement_mm));
        tile("First damage", brief(onset.force_kN), "kN", note);
    }
    if let Some(onset) = &answers.first_damage.crack {
        let note = format!("solid cracks, at {} mm", brief(onset.displacement_mm));
        tile("First crack", brief(onset.force_kN), "kN", note);
    }
    if let Some(cracks) = &answers.cracks_at_end {
        let widths = [&cracks.joint, &cracks.solid].map(|c| c.as_ref().map_or(0.0, |c| c.width_mm));
        let class = cracks.burland_class;
        let note = format!(
            "at the end, class {class} of Burland: {}",
            name_of_class(class)
        );
        tile("Widest crack", brief(widths[0].max(widths[1])), "mm", note);
    }
    if let Some(last) = answers.loops.last() {
        let energy = brief(last.dissipated_energy_J);
        let damping = last
            .equivalent_damping
            .map(|damping| brief(100.0 * damping));
        let note = format!("equivalent viscous, loop {}: {energy} J", last.number);
        tile(
            "Damping",
            damping.unwrap_or_else(|| "–".to_owned()),
            "%",
            note,
        );
    }
    tiles.extend(answers.performance_points.iter().map(limit));
    tiles
}

fn limit(point: &PerformancePoint) -> Tile {
    let (drift, at) = (brief(100.0 * point.drift), brief(point.displacement_mm));
    Tile {
        name: "EN 1998-3",
        value: point.force_kN.map_or_else(|| "–".to_owned(), brief),
        unit: "kN",
        note: format!("{}, {drift} % drift, {at} mm", point.limit_state.told()),
    }
}

fn effort(history: &ReadHistory, summary: Option<&SummaryFile>) -> Vec<Tile> {
    let count = |of: fn(&crate::state::HistoryRow) -> usize| history.rows.iter().map(of).sum();
    let cutbacks = summary.map_or_else(|| count(|r| r.cutbacks), |s| s.cutbacks);
    let solves = summary.map_or_else(|| count(|r| r.iterations), |s| s.iterations);
    let mut tiles = vec![
        Tile {
            name: "Increments",
            value: history.rows.len().to_string(),
            unit: "",
            note: format!("{cutbacks} cut-back{}", plural(cutbacks)),
        },
        Tile {
            name: "Linear solves",
            value: solves.to_string(),
            unit: "",
            note: match summary {
                Some(s) => format!("{} factorisations", s.factorisations),
                None => "of accepted increments".to_owned(),
            },
        },
    ];
    if let Some(s) = summary {
        let memory = s
            .peak_rss_MB
            .map_or(String::new(), |m| format!(", {m:.0} MB"));
        tiles.push(Tile {
            name: "Time",
            value: brief(s.wall_s),
            unit: "s",
            note: format!("{} thread{}{memory}", s.threads, plural(s.threads)),
        });
        tiles.push(Tile {
            name: "Energy balance",
            value: brief(100.0 * s.energy_balance_error),
            unit: "%",
            note: "largest gap over the largest work".to_owned(),
        });
        tiles.push(Tile {
            name: "Unknowns",
            value: s.dofs.to_string(),
            unit: "",
            note: format!(
                "{} elements, {} unit{}, {} contact points{}",
                s.elements,
                s.units,
                plural(s.units),
                s.contact_points,
                s.part_solved()
                    .map_or_else(String::new, |part| format!("; solved is {part}"))
            ),
        });
    }
    tiles
}

/// Largest measured force with this sign [kN].
fn measured_peak(experiment: &Experiment, sign: f64) -> Option<f64> {
    let along = experiment.points.iter().map(|p| sign * p.1);
    along.max_by(f64::total_cmp).map(|force| sign * force)
}

/// Four significant digits, with an exponent for very small values.
fn brief(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-4 {
        format!("{value:.1e}")
    } else {
        curve::brief(value)
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
