//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Pushes walls of bricks to collapse: the detailed micro-model of masonry.
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXIT_CODES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 completed; 2 bad model or usage; 3 not converged, results \
    kept; 4 input/output; 130 interrupted; 1 a bug of wythe.";

/// The sub-commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a model through all its steps.
    Run(Run),
    /// Check a model without running it: syntax, units, ranges, physics, sizes.
    Check(Check),
    /// Take one material or interface point along a prescribed path.
    Drive(Drive),
}

/// A model and what is said anew of it.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// Override a key of the model, e.g. steps.1.increments.max=0.02 (repeatable).
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub overrides: Vec<(String, String)>,
}

/// `wythe run`
#[derive(Debug, Args)]
pub struct Run {
    /// The model, a TOML file.
    pub model: PathBuf,
    /// Folder for the results [default: MODEL.out beside the model].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe check`
#[derive(Debug, Args)]
pub struct Check {
    /// The model, a TOML file.
    pub model: PathBuf,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe drive`
#[derive(Debug, Args)]
pub struct Drive {
    /// What kind of point.
    #[command(subcommand)]
    pub point: Point,
}

/// The kinds of points.
#[derive(Debug, Subcommand)]
pub enum Point {
    /// A point of a solid. Path columns: eps_xx eps_yy eps_zz gam_xy gam_yz gam_zx (engineering
    /// shear), sig_xx_MPa … where stress-driven, and perhaps time [s].
    Material(DrivePoint),
    /// A point of an interface. Path columns: u_mm d1_mm d2_mm (opening and slips), sig_MPa,
    /// tau1_MPa, tau2_MPa where traction-driven, and perhaps time [s].
    Interface(DrivePoint),
}

/// `wythe drive material` and `wythe drive interface`
#[derive(Debug, Args)]
pub struct DrivePoint {
    /// Name of the material or interface in the model.
    pub name: String,
    /// The model, a TOML file.
    #[arg(long, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// The path: a CSV file with a header; # begins a comment. One implicit step a row.
    #[arg(long, value_name = "PATH.csv")]
    pub path: PathBuf,
    /// Where the answer goes [default: standard output].
    #[arg(long, value_name = "OUT.csv")]
    pub out: Option<PathBuf>,
    /// Implicit steps a row.
    #[arg(long, value_name = "N", default_value = "1")]
    pub substeps: NonZeroUsize,
    /// Drive this component by its stress column and solve for its strain: xx yy zz xy yz zx, or
    /// normal tau1 tau2 (repeatable).
    #[arg(long, value_name = "COMPONENT")]
    pub stress: Vec<String>,
    #[command(flatten)]
    pub with: ModelArguments,
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected KEY=VALUE, e.g. steps.1.increments.max=0.02".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn overrides_split_at_the_first_equals_sign() {
        let parse = |text: &str| key_value(text).map(|(k, v)| format!("{k}|{v}"));
        assert_eq!(parse("a.b = 2.12 MPa").as_deref(), Ok("a.b|2.12 MPa"));
        assert_eq!(parse("title=a=b").as_deref(), Ok("title|a=b"));
        for wrong in ["a.b", "=1", "a="] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
