//! Interior-point method for programs whose inequalities couple few unknowns each, as those of joints do.
//!
//! ```text
//! min c'x   subject to   E x = b,   A x + s = d,   s in rays and second-order cones
//! ```
//!
//! The homogeneous embedding (Goulart and Chen 2024), which also tells programs without solution apart, with the scaling
//! of Nesterov and Todd and the corrector of Mehrotra. Each step solves equations like those of elastic joints: the
//! linear solver of the runs factorises them.

mod blocks;
mod cones;
mod iteration;
mod normal;
mod solve;

pub use iteration::End;
pub use solve::{Answer, solve};

#[cfg(test)]
mod tests;
