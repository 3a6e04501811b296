//! Pictures of runs as SVG and PNG: load-displacement curves with experiments, any columns of the history,
//! deflections, charts and the scene.

mod axes;
pub mod chart;
#[cfg(feature = "run-folder")]
pub mod columns;
#[cfg(feature = "run-folder")]
pub mod deflection;
pub mod histogram;
pub mod mechanism;
mod place;
pub mod raster;
pub mod scatter;
#[cfg(feature = "run-folder")]
pub mod scene;
#[cfg(feature = "run-folder")]
pub mod shape;

pub use chart::{Line, curves, load_displacements};
#[cfg(feature = "run-folder")]
pub use deflection::{Along, Deflection, deflections};
pub use histogram::{Bars, histogram};
pub use mechanism::mechanism;
pub use raster::{png, png_of_width};
pub use scatter::{Scatter, Spot};
#[cfg(feature = "run-folder")]
pub use scene::scene;

use plotters::coord::Shift;
use plotters::prelude::*;

/// SVG text of a picture of this size [px] that `draw` fills.
///
/// # Errors
/// Message of plotters if it cannot draw.
pub fn svg(
    size: (u32, u32),
    draw: impl FnOnce(&DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Undrawn>,
) -> Result<String, String> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    draw(&root).map_err(|error| error.to_string())?;
    root.present().map_err(|error| error.to_string())?;
    drop(root);
    svg.push('\n');
    Ok(svg)
}

/// Error of plotters.
pub type Undrawn = DrawingAreaErrorKind<std::io::Error>;
