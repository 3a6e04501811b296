//! The answers in lines of text, the same in `wythe info` and the report.

use super::{Answers, Bilinear, CrackWidths, LimitState, Onset, PerformancePoint, name_of_class};
use crate::results::estimate::percent;

/// Largest number of loops in a text: the first and the last are shown of more.
const LOOPS: usize = 4;

/// A line with its heading. Consecutive lines may have the same heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Heading of at most ten letters.
    pub head: &'static str,
    /// Text.
    pub text: String,
}

impl Answers {
    /// The answers, a line for each fact that the run has.
    pub fn lines(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        let mut line = |head: &'static str, text: String| lines.push(Line { head, text });
        if let Some(k) = self.secant_stiffness_kN_per_mm {
            line(
                "stiffness",
                format!("{k:.2} kN/mm, secant to 0.7 of the peak"),
            );
        }
        if let (Some(drift), Some(height)) = (self.drift_at_peak, self.height_mm) {
            line(
                "drift",
                format!("{} at the peak, over {height:.0} mm", fine_percent(drift)),
            );
        }
        if let Some(shear) = self.base_shear_at_peak_kN {
            line("base shear", format!("{shear:.3} kN at the peak"));
        }
        for section in &self.sections_at_peak {
            line("section", section.told());
        }
        for (side, found) in [
            ("", self.bilinear),
            ("opposite side: ", self.opposite_bilinear),
        ] {
            if let Some(found) = found {
                line("bilinear", format!("{side}{}", of_bilinear(&found)));
            }
        }
        for text in self.of_loops() {
            line("loops", text);
        }
        let first = &self.first_damage;
        for (what, onset) in [
            ("joint softens", &first.joint),
            ("solid cracks", &first.crack),
            ("solid crushed", &first.crush),
        ] {
            if let Some(onset) = onset {
                line("first", of_onset(what, onset));
            }
        }
        if let Some(mode) = self.failure_mode {
            line("failure", mode.told().to_owned());
        }
        for wall in &self.walls {
            line("wall", wall.told());
        }
        for (when, cracks) in [
            ("at the peak", &self.cracks_at_peak),
            ("at the end", &self.cracks_at_end),
        ] {
            if let Some(cracks) = cracks {
                line("cracks", of_cracks(when, cracks));
            }
        }
        for point in &self.performance_points {
            line("limits", of_point(point));
        }
        lines
    }

    fn of_loops(&self) -> Vec<String> {
        let count = self.loops.len();
        let shown = |i: &usize| count <= LOOPS || *i == 0 || *i + 1 == count;
        let one = |i: usize| {
            let found = &self.loops[i];
            let damping = found.equivalent_damping.map_or(String::new(), |damping| {
                format!(", damping {}", percent(damping))
            });
            format!(
                "{} to {:.3} and {:.3} mm: {:.3} J{damping}",
                found.number,
                found.displacement_mm,
                found.opposite_displacement_mm,
                found.dissipated_energy_J
            )
        };
        (0..count).filter(shown).map(one).collect()
    }
}

fn of_bilinear(found: &Bilinear) -> String {
    let drift = found
        .ultimate_drift
        .map_or(String::new(), |drift| format!(" ({})", fine_percent(drift)));
    let end = if found.reached_80_percent {
        "where 0.8 of the peak is left"
    } else {
        "the end of the curve"
    };
    format!(
        "{:.3} kN from {:.3} mm to {:.3} mm{drift}, {end}; ductility {:.2}",
        found.ultimate_force_kN,
        found.yield_displacement_mm,
        found.ultimate_displacement_mm,
        found.ductility
    )
}

fn of_onset(what: &str, onset: &Onset) -> String {
    format!(
        "{what} at {:.4} mm, {:.3} kN (increment {}): {}",
        onset.displacement_mm,
        onset.force_kN,
        onset.increment,
        onset.place.told()
    )
}

fn of_cracks(when: &str, cracks: &CrackWidths) -> String {
    let widest = [("joint", &cracks.joint), ("solid", &cracks.solid)]
        .into_iter()
        .filter_map(|(what, crack)| Some((what, crack.as_ref()?)))
        .max_by(|a, b| a.1.width_mm.total_cmp(&b.1.width_mm));
    let class = format!(
        "class {} of Burland ({})",
        cracks.burland_class,
        name_of_class(cracks.burland_class)
    );
    match widest {
        Some((what, crack)) => format!(
            "{:.3} mm in a {what} {when}, {class}: {}",
            crack.width_mm,
            crack.place.told()
        ),
        None => format!("none {when}, {class}"),
    }
}

/// A performance point in words.
pub fn of_point(point: &PerformancePoint) -> String {
    let force = point.force_kN.map_or_else(
        || "beyond the end of the run".to_owned(),
        |force| format!("{force:.3} kN"),
    );
    let (drift, at) = (fine_percent(point.drift), point.displacement_mm);
    let told = format!("drift {drift}: {at:.3} mm, {force}");
    match point.limit_state {
        LimitState::Given => told,
        state => format!("{}, {told} ({})", state.told(), point.source),
    }
}

/// A drift in percent, with two or three digits: `0.35 %`, `1.20 %`.
fn fine_percent(part: f64) -> String {
    let percent = 100.0 * part;
    let decimals = if percent.abs() < 0.0995 { 4 } else { 2 };
    format!("{percent:.decimals$} %")
}
