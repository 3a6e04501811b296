//! Whether inertia carries the force of an increment (docs/theory/inertia.md, eqs 10 and 12).

use serde::{Deserialize, Serialize};

use super::{HistoryRow, is_moving};

/// Origin of the force of an increment, of which inertia may carry a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceBy {
    /// Equilibrium, or motion that the deck asks for: all of it counts.
    #[default]
    Equilibrium,
    /// A displacement drives or steers it, in an increment that `auto` solves with inertia.
    Drive,
    /// The deck: an increment with given loads, which `auto` solves with inertia.
    Loads,
}

/// Part of the work of the drive that goes into motion or comes from it, above which inertia carries the force [-].
const CARRIED: f64 = 0.01;
/// Number of increments in a row without motion after which forces count again. A start from rest sends waves through
/// the structure; they have decayed by then.
const SETTLES: usize = 5;

/// Follows the increments that `auto` solves with inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Kinetic energy after the last increment [J].
    kinetic: f64,
    /// Numerical dissipation after it [J].
    numerical: f64,
    /// Displacement of the history after it [mm].
    displacement: f64,
    /// Number of increments with inertia, without motion, in a row.
    quiet: usize,
}

impl Motion {
    /// Adds an increment. Returns whether inertia carries its force, so that it is not the force of an equilibrium. Given
    /// loads are carried by the structure where it is at rest beneath them, as eq. 10 has it.
    pub fn follow(&mut self, row: &HistoryRow, by: ForceBy) -> bool {
        let [before, kinetic] = [self.kinetic, row.kinetic_energy_J];
        let taken = row.elastic_energy_J
            + row.plastic_damage_dissipation_J
            + row.interface_dissipation_J
            + row.viscous_dissipation_J;
        let rests = kinetic <= before && !is_moving(kinetic, before, taken);
        let into_motion = (row.kinetic_energy_J - self.kinetic).abs()
            + (row.numerical_dissipation_J - self.numerical).abs();
        // kN mm = J.
        let work = (row.force_kN * (row.displacement_mm - self.displacement)).abs();
        // Inertia carries no force of a steady motion, such as that of a wall that slides on.
        let is_quiet = by != ForceBy::Equilibrium && into_motion <= CARRIED * work;
        self.kinetic = row.kinetic_energy_J;
        self.numerical = row.numerical_dissipation_J;
        self.displacement = row.displacement_mm;
        self.quiet = if is_quiet { self.quiet + 1 } else { 0 };
        match by {
            ForceBy::Equilibrium => false,
            ForceBy::Drive => self.quiet < SETTLES,
            ForceBy::Loads => !rests && self.quiet < SETTLES,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(displacement: f64, force: f64, kinetic: f64) -> HistoryRow {
        HistoryRow {
            displacement_mm: displacement,
            force_kN: force,
            kinetic_energy_J: kinetic,
            elastic_energy_J: 100.0,
            ..HistoryRow::default()
        }
    }

    #[test]
    fn a_start_from_rest_does_not_count_until_its_waves_have_decayed() {
        let mut motion = Motion::default();
        assert!(!motion.follow(&row(12.154, 48.3, 0.0), ForceBy::Equilibrium));
        // A wall of 1 t is set in motion: 0.03 J are a fifth of the work of the drive, but 3e-4 of the energy taken.
        assert!(motion.follow(&row(12.157, 71.6, 0.03), ForceBy::Drive));
        for k in 1..SETTLES {
            let x = 12.157 + 0.01 * k as f64;
            assert!(motion.follow(&row(x, 55.0, 0.03), ForceBy::Drive));
        }
        assert!(!motion.follow(&row(12.30, 48.5, 0.03), ForceBy::Drive));
        assert!(!motion.follow(&row(12.31, 48.4, 0.0), ForceBy::Equilibrium));
    }

    #[test]
    fn steady_sliding_counts_and_a_swing_does_not() {
        let mut motion = Motion::default();
        // A wall of 4 J slides on at 1.27 kN; 0.1 J into the motion and out of it again are a swing.
        for k in 0..10 {
            let x = 10.0 + k as f64;
            assert_eq!(
                motion.follow(&row(x, 1.27, 4.0), ForceBy::Drive),
                k < SETTLES,
                "{k}"
            );
        }
        for (k, kinetic) in [4.1, 4.0, 4.1].into_iter().enumerate() {
            assert!(motion.follow(&row(21.0 + k as f64, 1.27, kinetic), ForceBy::Drive));
        }
    }

    #[test]
    fn loads_count_where_the_wall_is_at_rest_beneath_them() {
        let mut motion = Motion::default();
        let mut follow = |force, kinetic, by| motion.follow(&row(0.01 * force, force, kinetic), by);
        assert!(!follow(1.0, 0.0, ForceBy::Equilibrium));
        // Each load sends a wave through the wall, which decays.
        for load in [1.1, 1.2, 1.3] {
            assert!(follow(load, 1e-3, ForceBy::Loads));
            assert!(!follow(load, 1e-5, ForceBy::Loads));
        }
        // It falls under the next one.
        for kinetic in [1e-2, 1.0, 100.0, 90.0] {
            assert!(follow(1.4, kinetic, ForceBy::Loads));
        }
    }
}
