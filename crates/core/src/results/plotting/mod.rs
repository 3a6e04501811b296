//! Pictures of runs as SVG and PNG: load-displacement curves with experiments, deflections, charts and the scene.

pub mod chart;
#[cfg(feature = "run-folder")]
pub mod deflection;
pub mod histogram;
pub mod raster;
pub mod scatter;
#[cfg(feature = "run-folder")]
pub mod scene;

pub use chart::{Line, curves, load_displacements};
#[cfg(feature = "run-folder")]
pub use deflection::{Along, Deflection, deflections};
pub use histogram::{Bars, histogram};
pub use raster::png;
pub use scatter::{Spot, scatter};
#[cfg(feature = "run-folder")]
pub use scene::scene;
