//! Columns of the history.

/// Names of the columns that every history has, in order. Those of probes and loads follow
/// ([`Model::columns`](super::Model::columns)).
pub const FIXED: [&str; 26] = [
    "increment",
    "step",
    "time",
    "displacement_mm",
    "force_kN",
    "reaction_kN",
    "iterations",
    "cutbacks",
    "external_work_J",
    "elastic_energy_J",
    "plastic_damage_dissipation_J",
    "interface_dissipation_J",
    "viscous_dissipation_J",
    "open_points",
    "sliding_points",
    "max_interface_damage",
    "max_tensile_damage",
    "max_compressive_damage",
    "out_of_balance",
    "residual",
    "kinetic_energy_J",
    "damping_dissipation_J",
    "numerical_dissipation_J",
    "contact_area_mm2",
    "load_factor",
    "procedure",
];
