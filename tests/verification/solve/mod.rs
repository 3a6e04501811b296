//! Tests of the module `solve`.

mod amplitudes;
mod buckling;
mod determinism;
mod dynamics;
mod energies;
mod fidelity;
mod ground_motion;
mod light_bodies;
mod loads;
mod oscillators;
mod paths;
mod pulled_solids;
mod relaxation;
mod resume;
mod settlements;
mod stiff_scenes;
mod sudden_peaks;
mod tolerance;
mod vibration;
