//! Tests of the module `material`.

mod crack_band;
mod damage_plasticity;
mod drucker_prager;
mod energies;
mod return_map;
mod solid_laws;
mod tables;
