//! Studies: many runs side by side, judged and told on one page.
//!
//! The stability atlas takes every case through every method and says which one gets through, which
//! ends with a wrong answer, and which loses convergence, where and why.
//!
//! [`accuracy`] sets the error of each choice that a user has beside its time.
//!
//! [`validation`] sets runs beside what is known of them: tests, exact solutions, other models.
//!
//! [`zoo`] runs random walls as newcomers would, and says how many come to an answer and at which cost.
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
mod report;
mod run;
mod stability;
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
