//! Energies of a run, and whether its bodies move.

use serde::{Deserialize, Serialize};

/// Kinetic energy below which all bodies are at rest, over the energy that solids and interfaces have taken [-].
pub const QUIET: f64 = 1e-3;
/// Growth of the kinetic energy within an increment by which a motion begins [-].
const GROWS: f64 = 1.2;
/// Part of [`QUIET`] below which a growth is noise of the tolerance.
const BEGINS: f64 = 0.01;

/// Whether bodies move, or begin to, at the end of an increment: `kinetic` and `before` are the kinetic energies at its end
/// and at its start, `taken` the energy that solids and interfaces have taken (all in one unit).
pub fn is_moving(kinetic: f64, before: f64, taken: f64) -> bool {
    kinetic >= QUIET * taken && kinetic > 0.0
        || kinetic > GROWS * before && kinetic > BEGINS * QUIET * taken
}

/// Energies since the start [N mm].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Work of reactions, loads, gravity and the ground, and the energy of initial velocities.
    pub external: f64,
    /// Elastic energy of solids and interfaces now.
    pub elastic: f64,
    /// Plastic work and damage of the solids.
    pub plastic_damage: f64,
    /// Dissipation of the interfaces.
    pub interface: f64,
    /// Viscous dissipation.
    pub viscous: f64,
    /// Kinetic energy now, relative to the ground.
    pub kinetic: f64,
    /// Work of the Rayleigh damping, and of the dashpots of relaxations.
    pub damping: f64,
    /// What the time integration has taken out.
    pub numerical: f64,
    /// What increments in equilibrium have left open: taken beyond the work done.
    #[serde(default)]
    pub leaked: f64,
}

impl Energies {
    /// What solids and interfaces have taken [N mm].
    pub fn taken(&self) -> f64 {
        self.elastic + self.plastic_damage + self.interface + self.viscous
    }

    /// Work done that is not accounted for [N mm].
    pub fn open(&self) -> f64 {
        self.external - self.taken() - self.kinetic - self.damping - self.numerical
    }

    /// Kinetic energy over what solids and interfaces have taken [-].
    pub fn moving(&self) -> f64 {
        if self.kinetic > 0.0 {
            self.kinetic / self.taken()
        } else {
            0.0
        }
    }

    /// Whether bodies move, or begin to, in the increment since `before`.
    pub fn moves_on(&self, before: &Self) -> bool {
        is_moving(self.kinetic, before.kinetic, self.taken())
    }

    /// What was dissipated since `before`, over that and the change of the elastic energy [-].
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
    fn what_begins_to_move_moves() {
        // Kinetic energies at the end and at the start, over 1 that was taken.
        assert!(is_moving(QUIET, QUIET, 1.0));
        assert!(is_moving(1e-4, 0.0, 1.0) && is_moving(1e-4, 8e-5, 1.0));
        // Evenly, slower and slower, or by rounding.
        assert!(!is_moving(1e-4, 1e-4, 1.0) && !is_moving(1e-4, 1e-3, 1.0));
        assert!(!is_moving(1e-6, 0.0, 1.0) && !is_moving(0.0, 0.0, 0.0));
    }
}
