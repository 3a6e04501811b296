//! The zoo: random walls, realistic ones, run as newcomers would run them. Does the default carry each to its end, at a
//! bounded cost, with closed energies?
//!
//! ```text
//! seed ─▶ Wall (its deck) ─▶ a process: wythe run ─▶ folder of the run ─▶ ZooRow ─▶ zoo.csv ─▶ page (Markdown), histogram
//!                                                          careful run ─▶ differences ─┘
//! ```
//!
//! Each wall is run in a process of its own. A recorder is asked between increments only: it could not end a wall that
//! hangs within one, and a panic, a full memory or an overflown stack would take the other walls with it.

mod page;
mod process;
mod python_random;
mod reference;
mod row;
mod study;
mod wall;

pub use page::{histogram, page};
pub use python_random::PythonRandom;
pub use row::{ZooRow, read, table};
pub use study::{Folder, Options, zoo};
pub use wall::{Bonding, Load, Solid, Wall};
