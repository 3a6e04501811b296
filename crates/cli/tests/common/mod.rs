//! Helpers shared by the tests of the command.
#![allow(dead_code, reason = "each test file uses its part")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

pub fn wythe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(arguments)
        // The drawn characters do not depend on the environment of the tests.
        .env("LC_ALL", "C.UTF-8")
        .output()
        .unwrap()
}

pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub fn stderr(output: &Output) -> String {
    // miette wraps lines and draws boxes: compare words only.
    let text = String::from_utf8_lossy(&output.stderr);
    text.split(|c: char| c.is_whitespace() || "│×╭─╰▶╮╯·".contains(c))
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A column of a CSV text.
pub fn column(text: &str, name: &str) -> Vec<f64> {
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let index = header
        .iter()
        .position(|h| *h == name)
        .unwrap_or_else(|| panic!("{name}"));
    rows.map(|row| row.split(',').nth(index).unwrap().parse().unwrap())
        .collect()
}

/// A couplet whose joint has the explicit stiffnesses that a single point needs.
pub fn couplet() -> String {
    repository("examples/01_couplet_tension.toml")
        .display()
        .to_string()
}

pub const STIFFNESSES: [&str; 4] = [
    "--set",
    "interfaces.joint.normal_stiffness=99000",
    "--set",
    "interfaces.joint.shear_stiffness=43043.47826",
];
