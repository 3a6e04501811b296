//! Pure point laws of the solids: (strain, old history) → (stress, tangent, new history).

pub mod law;
pub mod parameters;

pub use law::{LocalFailure, MaterialHistory, PointEnergy, Response};
pub use parameters::{
    DamagePlasticityParameters, ElasticParameters, Interpolation, MaterialParameters, TableRow,
};
