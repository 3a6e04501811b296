//! Energies of a run, and the criterion for motion of its bodies.

use serde::{Deserialize, Serialize};

/// Kinetic energy below which all bodies are at rest, over the energy taken by solids and joints [-].
pub const QUIET: f64 = 1e-3;
/// Growth of the kinetic energy within an increment by which a motion begins [-].
const GROWS: f64 = 1.2;
/// Part of [`QUIET`] below which growth is attributed to the tolerance.
const BEGINS: f64 = 0.01;

/// Whether bodies move, or begin to move, at the end of an increment (theory/inertia.md, eq. 10). `kinetic` and
/// `before` are the kinetic energies at its end and start, `taken` is the energy taken by solids and joints, all in
/// one unit.
pub fn is_moving(kinetic: f64, before: f64, taken: f64) -> bool {
    kinetic >= QUIET * taken && kinetic > 0.0
        || kinetic > GROWS * before && kinetic > BEGINS * QUIET * taken
}

/// Energies since the start [N mm].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Work of reactions, loads, gravity, the ground and jacks of ties, and the energy of initial velocities.
    pub external: f64,
    /// Present elastic energy of solids, joints, springs and ties.
    pub elastic: f64,
    /// Plastic work and damage of the solids; plastic work of ties, and their energy when they break.
    pub plastic_damage: f64,
    /// Dissipation of the joints.
    pub interface: f64,
    /// Viscous dissipation.
    pub viscous: f64,
    /// Present kinetic energy, relative to the ground.
    pub kinetic: f64,
    /// Work of Rayleigh damping and of the dashpots of relaxations.
    pub damping: f64,
    /// Energy taken by the time integration and the terms of the trapezoidal rule.
    pub numerical: f64,
    /// Sum of the energies that increments in equilibrium left open: taken beyond the work done.
    #[serde(default)]
    pub leaked: f64,
}

impl Energies {
    /// Energy taken by solids and joints [N mm].
    pub fn taken(&self) -> f64 {
        self.elastic + self.plastic_damage + self.interface + self.viscous
    }

    /// Work that is not accounted for [N mm].
    pub fn open(&self) -> f64 {
        self.external - self.taken() - self.kinetic - self.damping - self.numerical
    }

    /// Kinetic energy over the energy taken by solids and joints [-]; infinite where these took none.
    ///
    /// The errors of joints that a falling body has left may make their dissipation negative, and larger than the elastic
    /// energy that is left.
    pub fn moving(&self) -> f64 {
        if self.kinetic > 0.0 {
            self.kinetic / self.taken().max(self.elastic).max(0.0)
        } else {
            0.0
        }
    }

    /// Whether bodies move, or begin to move, in the increment since `before`.
    pub fn moves_on(&self, before: &Self) -> bool {
        is_moving(self.kinetic, before.kinetic, self.taken())
    }

    /// Whether bodies are faster than they were `before`, beyond the tolerance.
    pub fn hastens(&self, before: &Self) -> bool {
        self.kinetic > before.kinetic && self.kinetic > BEGINS * QUIET * self.taken()
    }

    /// Energy dissipated since `before`, over its sum with the change of the elastic energy [-].
    pub fn dissipated_share(&self, before: &Self) -> f64 {
        let sum = |e: &Self| e.plastic_damage + e.interface + e.viscous;
        let dissipated = sum(self) - sum(before);
        let stored = (self.elastic - before.elastic).abs();
        if dissipated > 0.0 {
            dissipated / (dissipated + stored)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_moves_if_its_kinetic_energy_grows() {
        // Kinetic energies at the end and at the start, with 1 as the energy taken.
        assert!(is_moving(QUIET, QUIET, 1.0));
        assert!(is_moving(1e-4, 0.0, 1.0) && is_moving(1e-4, 8e-5, 1.0));
        // Even motion, decelerating motion, or rounding.
        assert!(!is_moving(1e-4, 1e-4, 1.0) && !is_moving(1e-4, 1e-3, 1.0));
        assert!(!is_moving(1e-6, 0.0, 1.0) && !is_moving(0.0, 0.0, 0.0));
    }

    #[test]
    fn a_body_that_falls_moves_though_joints_took_no_energy() {
        let energies = |interface: f64| Energies {
            elastic: 1.0,
            interface,
            kinetic: 10.0,
            ..Energies::default()
        };
        assert!((energies(1.0).moving() - 5.0).abs() < 1e-15);
        // More than the elastic energy is booked as negative dissipation.
        assert!((energies(-2.0).moving() - 10.0).abs() < 1e-15);
        assert!(
            Energies {
                elastic: 0.0,
                ..energies(0.0)
            }
            .moving()
                > 1e9
        );
    }
}
