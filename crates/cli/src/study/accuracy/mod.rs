//! Accuracy against speed: one scene with each of the choices that a user has, error against computing time.
//!
//! ```text
//!                             a model ─▶ draft ─▶ scene.toml
//! docs/accuracy-speed/NN-name/scene.toml ─▶ Scene ─▶ runs, interleaved ─▶ Outcome ─▶ chart, table (CSV), section
//!                             reference.csv ─▶ Known ─┤                          └─▶ docs/accuracy-speed.md
//!                             pattern.txt ─▶ Pattern ─┘
//! ```

mod chart;
mod draft;
mod errors;
mod front;
mod offered;
mod outcome;
mod own_error;
mod page;
mod pattern;
mod peer;
mod reading;
mod renew;
mod scene;
mod written;

pub use chart::chart;
pub use draft::{DraftError, draft};
pub use errors::{Errors, Known};
pub use front::{FASTER, beaten, front, median};
pub use outcome::{Options, Outcome, Studied, study};
pub use page::{CHART, TABLE, link, page, table, with_peers};
pub use pattern::{Cracks, Grid, PATTERN, Pattern};
pub use peer::Peer;
pub use reading::read;
pub use renew::{Renewed, renew};
pub use scene::{Choice, Group, Origin, Reference, SCENES, Scene, advice, scenes};
