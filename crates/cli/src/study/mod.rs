//! Studies: many models are run side by side, evaluated, and reported on one page.
//!
//! The stability atlas runs every case with every method. It reports which methods complete the case, which end
//! with a wrong answer, and which lose convergence, where and why.
//!
//! [`accuracy`] compares the error of each modelling choice with its computing time.
//!
//! [`validation`] compares results with tests, exact solutions and other models.
//!
//! [`strategies`] runs one deck by every modelling strategy.
//!
//! [`zoo`] runs random walls with default settings and counts how many are solved, and at which cost.
//!
//! ```text
//! cases/NN-name/case.toml ─▶ Case ─┐
//!                     METHODS ─────┴▶ stability ─▶ Cell ─▶ report (Markdown), picture (SVG)
//!                                     deck → run → History → judge
//! ```

pub mod accuracy;
mod case;
mod cell;
pub(crate) mod command;
mod curve;
mod expect;
mod expect_written;
mod history;
mod judge;
mod method;
mod parallel;
mod picture;
mod process;
mod report;
mod run;
mod stability;
pub mod strategies;
pub mod validation;
mod written;
pub mod zoo;

pub use case::{Case, CaseMethod, End, Short, StudyError, cases};
pub use cell::{Cell, Cost, Place, Verdict};
pub use expect::{Expectation, Measure, Measured, Wanted};
pub use history::History;
pub use judge::{Ended, Terms, judge};
pub use method::{METHODS, Method};
pub use picture::picture;
pub use report::{brief, report};
pub use stability::{Options, Row, Study, stability};
