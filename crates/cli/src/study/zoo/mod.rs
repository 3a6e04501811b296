//! The zoo: realistic random walls, run with default settings only. The study checks that each run reaches its end
//! at a bounded cost, with balanced energies.
//!
//! ```text
//! seed ─▶ Wall (its deck) ─▶ a process: wythe run ─▶ folder of the run ─▶ ZooRow ─▶ zoo.csv ─▶ page, histogram
//!                                                          careful run ─▶ differences ─┘
//! ```
//!
//! Each wall is run in a process of its own. A recorder is called between increments only: it could not end a run
//! that hangs within an increment, and a panic, exhausted memory or a stack overflow would end the runs of the
//! other walls too.

mod page;
mod python_random;
mod reference;
mod row;
mod study;
mod wall;

pub use page::{histogram, page};
pub use python_random::PythonRandom;
pub use row::{ZooRow, one_line, read, status, table};
pub use study::{Folder, Options, zoo};
pub use wall::{Bonding, Load, Solid, Wall};
