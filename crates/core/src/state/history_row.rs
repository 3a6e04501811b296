//! One converged increment as a row of the history.

use super::Method;

/// One row of `history.csv`. Field names are the column names.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
// More than 15 fields: one for each column.
pub struct HistoryRow {
    /// Increment, from 1 over all steps.
    pub increment: usize,
    /// Step, from 0.
    pub step: usize,
    /// Step time, accumulated over all steps [s].
    pub time: f64,
    /// Displacement of the driven beam in the driven direction [mm].
    pub displacement_mm: f64,
    /// Force on the driven beam in the driven direction [kN].
    pub force_kN: f64,
    /// Force on the driven beam normal to its face, compression positive [kN].
    pub reaction_kN: f64,
    /// Linear solves in this increment.
    pub iterations: usize,
    /// Number of times that this increment was cut.
    pub cutbacks: usize,
    /// Work of reactions, loads, gravity and the ground since the start, and the energy of initial
    /// velocities [J].
    pub external_work_J: f64,
    /// Present elastic energy of solids, joints, springs and ties [J].
    pub elastic_energy_J: f64,
    /// Plastic work and damage of the solids since the start [J].
    pub plastic_damage_dissipation_J: f64,
    /// Dissipation of the joints since the start [J].
    pub interface_dissipation_J: f64,
    /// Viscous dissipation since the start [J].
    pub viscous_dissipation_J: f64,
    /// Contact points that are open.
    pub open_points: usize,
    /// Contact points that slid in this increment.
    pub sliding_points: usize,
    /// Largest damage D of the joints [-].
    pub max_interface_damage: f64,
    /// Largest tensile damage of the solids [-].
    pub max_tensile_damage: f64,
    /// Largest compressive damage of the solids [-].
    pub max_compressive_damage: f64,
    /// Largest out-of-balance force at commit, with all laws updated implicitly, over the mean nodal force [-].
    pub out_of_balance: f64,
    /// Largest out-of-balance force of the equations that were solved, over the mean nodal force [-]. The tolerance
    /// refers to it.
    pub residual: f64,
    /// Present kinetic energy, relative to the ground [J].
    pub kinetic_energy_J: f64,
    /// Work of Rayleigh damping and of the dashpots of relaxations since the start [J].
    pub damping_dissipation_J: f64,
    /// Energy taken by the time integration and the terms of the trapezoidal rule since the start [J].
    pub numerical_dissipation_J: f64,
    /// Area at rest of the contact points under pressure [mm²].
    pub contact_area_mm2: f64,
    /// Part of the step's loads and displacements that acts now [-].
    pub load_factor: f64,
    /// Method that solved the increment.
    pub procedure: Method,
    /// Values of the model's probes, then of its loads, then of the outputs of its solids. They have columns of their
    /// own after these. See [`Model::columns`](crate::model::Model::columns).
    #[serde(skip)]
    pub probes: Vec<f64>,
    /// External forces on each beam, then on each support, then those of each load [N]. They are only in
    /// `results.vtkhdf`. `[beam, support, load][xyz]`
    #[serde(skip)]
    pub reactions: Vec<[f64; 3]>,
}

impl HistoryRow {
    /// Energy taken by solids and joints: elastic energy and dissipations [J].
    #[expect(non_snake_case, reason = "J is the unit")]
    pub fn taken_J(&self) -> f64 {
        self.elastic_energy_J
            + self.plastic_damage_dissipation_J
            + self.interface_dissipation_J
            + self.viscous_dissipation_J
    }
}
