//! Energy balance of a run.

use super::HistoryRow;

/// Error of the energy balance (theory/energies.md, eqs 1 and 18). Every term is integrated where it arises and none
/// is found by difference:
///
/// error = maxᵢ |W − (E + T + D_pd + D_i + D_v + D_d + D_n)|ᵢ / maxᵢ (|W_d| + |W − W_d|)ᵢ over all increments i.
///
/// W is the work of reactions and loads, W_d that of the drive, E the elastic and T the kinetic energy. D are the dissipations: plastic and
/// damage, joints, viscous, damping and numerical.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EnergyBalance {
    /// maxᵢ |W − (E + T + ΣD)|ᵢ [J].
    gap: f64,
    /// maxᵢ |W|ᵢ [J].
    work: f64,
    /// maxᵢ (|W_d| + |W − W_d|)ᵢ with the work W_d of the drive [J]. Gravity may take what a push gives.
    exchanged: f64,
    /// W_d after the last increment [J].
    driven: f64,
    /// Step, displacement [mm] and force [kN] of the last increment.
    last: (usize, f64, f64),
    /// ΣD of the last increment [J].
    dissipated: f64,
}

impl EnergyBalance {
    /// Adds an increment.
    pub fn push(&mut self, row: &HistoryRow) {
        self.dissipated = inside(row) - row.elastic_energy_J - row.kinetic_energy_J;
        self.gap = larger(self.gap, Self::open(row).abs());
        self.work = larger(self.work, row.external_work_J.abs());
        let (step, displacement, force) = self.last;
        if step == row.step {
            self.driven += 0.5 * (force + row.force_kN) * (row.displacement_mm - displacement);
        }
        self.last = (row.step, row.displacement_mm, row.force_kN);
        let rest = row.external_work_J - self.driven;
        self.exchanged = larger(self.exchanged, self.driven.abs() + rest.abs());
    }

    /// W − (E + T + ΣD) after an increment [J].
    pub fn open(row: &HistoryRow) -> f64 {
        row.external_work_J - inside(row)
    }

    /// maxᵢ |W|ᵢ [J].
    pub fn work(&self) -> f64 {
        self.work
    }

    /// Largest work that the drive and all else have exchanged [J]: at least [`work`](Self::work).
    pub fn exchanged(&self) -> f64 {
        self.exchanged
    }

    /// Dissipation up to the last increment [J].
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    /// Error [-]. Zero before any work is done.
    pub fn error(&self) -> f64 {
        if self.exchanged == 0.0 {
            0.0
        } else {
            self.gap / self.exchanged
        }
    }
}

/// E + T + ΣD after an increment [J].
fn inside(row: &HistoryRow) -> f64 {
    row.elastic_energy_J
        + row.plastic_damage_dissipation_J
        + row.interface_dissipation_J
        + row.viscous_dissipation_J
        + row.kinetic_energy_J
        + row.damping_dissipation_J
        + row.numerical_dissipation_J
}

/// The larger of two numbers. NaN counts as larger, because a balance that cannot be computed does not close.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn row(work: f64, elastic: f64, dissipations: [f64; 3]) -> HistoryRow {
        HistoryRow {
            external_work_J: work,
            elastic_energy_J: elastic,
            plastic_damage_dissipation_J: dissipations[0],
            interface_dissipation_J: dissipations[1],
            viscous_dissipation_J: dissipations[2],
            ..HistoryRow::default()
        }
    }

    #[test]
    fn the_energy_error_is_the_largest_gap_over_the_largest_work() {
        let mut balance = EnergyBalance::default();
        assert_eq!(balance.error(), 0.0);
        balance.push(&row(10.0, 6.0, [1.0, 2.0, 0.5])); // gap 0.5
        balance.push(&row(-50.0, -50.0, [0.0; 3])); // the largest work, no gap
        balance.push(&row(20.0, 5.0, [5.0, 5.0, 5.25])); // gap 0.25
        assert_relative_eq!(balance.error(), 0.01, max_relative = 1e-14); // one division
        balance.push(&row(f64::NAN, 0.0, [0.0; 3]));
        balance.push(&row(10.0, 10.0, [0.0; 3]));
        assert!(balance.error().is_nan());
    }

    #[test]
    fn work_that_gravity_takes_from_a_push_counts() {
        let mut balance = EnergyBalance::default();
        let pushed = |displacement: f64, work: f64, elastic: f64| HistoryRow {
            displacement_mm: displacement,
            force_kN: 2.0,
            ..row(work, elastic, [0.0; 3])
        };
        // The push does 4 J in the second row, and gravity takes all but 0.1 J of them.
        balance.push(&pushed(0.0, 0.0, 0.0));
        balance.push(&pushed(2.0, 0.1, 0.0));
        assert_relative_eq!(balance.exchanged(), 7.9, max_relative = 1e-14); // one sum
        assert_relative_eq!(balance.error(), 0.1 / 7.9, max_relative = 1e-14);
    }
}
