//! The `wythe` command.
#![forbid(unsafe_code)]

fn main() {}
