//! Forces in the sections at the largest force.

use serde::{Deserialize, Serialize};

use crate::element::hexahedron::{cross, dot};
use crate::model::Model;
use crate::model::sections::{COLUMNS, Section};
use crate::state::HistoryRow;

/// Forces in a section: those of the part on the side of its normal on the other part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct SectionForces {
    /// Name of the section.
    pub name: String,
    /// Area at rest [mm²].
    pub area_mm2: f64,
    /// Centre at rest, to which moments refer [mm]. `[xyz]`
    pub centre_mm: [f64; 3],
    /// Normal force over the area, tension positive [MPa].
    pub mean_stress_MPa: f64,
    /// Distance of the normal force from the centre along the two directions of the plane [mm]; `None` without a
    /// normal force.
    pub eccentricity_mm: Option<[f64; 2]>,
    /// Values of the columns of the history, by their names without that of the section [kN, kN m].
    pub values: Vec<(String, f64)>,
}

impl SectionForces {
    /// Forces in all sections of a model in a row of its history.
    pub fn all(model: &Model, row: &HistoryRow) -> Vec<Self> {
        let Some(first) = row.probes.len().checked_sub(COLUMNS * model.sections.len()) else {
            return Vec::new();
        };
        let values = row.probes[first..].chunks(COLUMNS);
        let sections = model.sections.iter().zip(values);
        sections
            .map(|(section, values)| Self::of(section, values))
            .collect()
    }

    fn of(section: &Section, values: &[f64]) -> Self {
        let names = Section::columns("", &section.directions);
        let named = names
            .iter()
            .map(|name| name.trim_start_matches('_').to_owned());
        // The moment about t₁ is that of a normal force off along ± t₂, and the other way round.
        let normal = values[0];
        let [_, first, second] = section.directions;
        let eccentricity = |along: [f64; 3]| {
            let arm = cross(along, section.directions[0]);
            1e3 * (values[3] * dot(arm, first) + values[4] * dot(arm, second)) / normal
        };
        Self {
            name: section.name.clone(),
            area_mm2: section.area,
            centre_mm: section.centre,
            mean_stress_MPa: 1e3 * normal / section.area,
            eccentricity_mm: (normal != 0.0).then(|| [eccentricity(first), eccentricity(second)]),
            values: named.zip(values.iter().copied()).collect(),
        }
    }

    /// In words: the components that are not small.
    pub fn told(&self) -> String {
        let most = |end: &str| {
            let own = self.values.iter().filter(|(name, _)| name.ends_with(end));
            own.map(|(_, value)| value.abs()).fold(0.0, f64::max)
        };
        let (force, moment) = (most("_kN"), most("_kNm"));
        let shown = self.values.iter().filter(|(name, value)| {
            let most = if name.ends_with("_kNm") {
                moment
            } else {
                force
            };
            name == "N_kN" || value.abs() > SMALL * most
        });
        let shown = shown.map(|(name, value)| {
            let (what, unit) = name.rsplit_once('_').unwrap_or((name, ""));
            let unit = if unit == "kNm" { "kN m" } else { unit };
            format!("{what} {value:.3} {unit}")
        });
        let shown: Vec<String> = shown.collect();
        format!(
            "{}: {} ({:.3} MPa)",
            self.name,
            shown.join(", "),
            self.mean_stress_MPa
        )
    }
}

/// Components below this part of the largest one are left out of a line.
const SMALL: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eccentricity_is_the_place_of_the_normal_force() {
        for normal in [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]] {
            let section = Section {
                name: "cut".to_owned(),
                directions: Section::directions(normal),
                centre: [0.0; 3],
                area: 2e4,
                above: Vec::new(),
                below: Vec::new(),
            };
            // A force of −10 kN along the normal, 30 mm and −20 mm from the centre.
            let [n, a, b] = section.directions;
            let at = [0, 1, 2].map(|i| 30.0 * a[i] - 20.0 * b[i]);
            let force = n.map(|n| -1e4 * n);
            let moment = cross(at, force);
            let found = SectionForces::of(&section, &section.values(force, moment));
            let [along_a, along_b] = found.eccentricity_mm.unwrap();
            // Rounding of a few products.
            assert!((along_a - 30.0).abs() < 1e-12, "{normal:?}: {along_a}");
            assert!((along_b + 20.0).abs() < 1e-12, "{normal:?}: {along_b}");
            assert!((found.mean_stress_MPa + 0.5).abs() < 1e-15);
        }
    }
}
