//! Validation: results beside tests, exact solutions and other models.
//!
//! ```text
//! docs/validation/NN-name/case.toml ─▶ Case ─▶ runs ─▶ Outcome ─▶ page, charts, pictures, CSV, TOML
//!                                                              └─▶ docs/validation.md
//! ```

mod case;
mod charts;
mod outcome;
mod page;
mod point;
mod written;

pub use case::{Axis, Case, Chart, Content, Run, cases};
pub use charts::chart;
pub use outcome::{Options, Outcome, Validated, validate};
pub use page::{index, page, table};
pub use point::PointTest;
