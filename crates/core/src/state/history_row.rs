//! One converged increment as a row of the history.

use super::Method;

/// One row of `history.csv`. Field names are the column names.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
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
    /// Linear solves of this increment.
    pub iterations: usize,
    /// Cut-backs of this increment.
    pub cutbacks: usize,
    /// Work of reactions, loads, gravity and the ground since the start, and the energy of initial
    /// velocities [J].
    pub external_work_J: f64,
    /// Elastic energy of solids and interfaces now [J].
    pub elastic_energy_J: f64,
    /// Plastic work and damage of the solids since the start [J].
    pub plastic_damage_dissipation_J: f64,
    /// Dissipation of the interfaces since the start [J].
    pub interface_dissipation_J: f64,
    /// Viscous dissipation since the start [J].
    pub viscous_dissipation_J: f64,
    /// Contact points that are open.
    pub open_points: usize,
    /// Contact points that slid in this increment.
    pub sliding_points: usize,
    /// Largest interface damage D [-].
    pub max_interface_damage: f64,
    /// Largest tensile damage of the solids [-].
    pub max_tensile_damage: f64,
    /// Largest compressive damage of the solids [-].
    pub max_compressive_damage: f64,
    /// Largest out-of-balance force at commit, all laws implicit, over the mean nodal force [-].
    pub out_of_balance: f64,
    /// Largest out-of-balance force of the equations that were solved, over the mean nodal force:
    /// what the tolerance refers to [-].
    pub residual: f64,
    /// Kinetic energy now, relative to the ground [J].
    pub kinetic_energy_J: f64,
    /// Work of the Rayleigh damping and of the dashpots of relaxations since the start [J].
    pub damping_dissipation_J: f64,
    /// What the time integration has taken out since the start [J].
    pub numerical_dissipation_J: f64,
    /// Area of the contact points that press, at rest [mm²].
    pub contact_area_mm2: f64,
    /// Part of the step's loads and displacements that act now [-].
    pub load_factor: f64,
    /// What solved the increment.
    pub procedure: Method,
    /// Values of the model's probes, then of its loads: columns of their own after these, see
    /// [`Model::columns`](crate::model::Model::columns).
    #[serde(skip)]
    pub probes: Vec<f64>,
    /// Forces from outside: on each beam, then on each support, then those of each load [N]; in
    /// `results.vtkhdf` only. `[beam, support, load][xyz]`
    #[serde(skip)]
    pub reactions: Vec<[f64; 3]>,
}

impl HistoryRow {
    /// What solids and interfaces have taken: elastic energy and dissipations [J].
    #[expect(non_snake_case, reason = "J is the unit")]
    pub fn taken_J(&self) -> f64 {
        self.elastic_energy_J
            + self.plastic_damage_dissipation_J
            + self.interface_dissipation_J
            + self.viscous_dissipation_J
    }
}
