//! `wythe._wythe`: the private Rust half of the Python package, a thin layer over `Deck → Model → solve →
//! RunDirectory`.
//!
//! The Python half (`python/wythe`) has the public names, defaults and documentation and checks the arguments. The
//! functions here return arrays, JSON texts and errors.
#![forbid(unsafe_code)]
// Input of users ends in typed errors.
#![cfg_attr(
    not(test),
    deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]
#![expect(
    clippy::needless_pass_by_value,
    reason = "what comes from Python is owned"
)]

mod arrays;
mod command;
mod errors;
mod fields;
mod folder;
mod laws;
mod limit;
mod model;
mod modes;
mod point;
mod run;
mod tests;

/// The Python module; see the crate.
#[pyo3::pymodule]
mod _wythe {
    #[pymodule_export]
    use crate::command::{command, schema, templates};
    #[pymodule_export]
    use crate::fields::Fields;
    #[pymodule_export]
    use crate::folder::{
        animate, answers, at_drifts, collection, columns_picture, compare, default_columns,
        error_lines, experiment, export_frame, figures, history, history_column, picture, png,
        report, salvage, summary, time_of_peak, wall,
    };
    #[pymodule_export]
    use crate::laws::{check_joint_law, check_solid_law, drive_joint_law, drive_solid_law};
    #[pymodule_export]
    use crate::limit::LimitOfModel;
    #[pymodule_export]
    use crate::model::Deck;
    #[pymodule_export]
    use crate::modes::{FoundShapes, modes_of_run};
    #[pymodule_export]
    use crate::point::{drive_interface, drive_material};
    #[pymodule_export]
    use crate::run::{estimate_error, resume, run};
    #[pymodule_export]
    use crate::tests::{evaluate, test_decks, tests};

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "a name of Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
