//! wythe pushes walls of bricks to collapse: the detailed micro-model of masonry.
#![forbid(unsafe_code)]

pub use wythe_contact as contact;
pub use wythe_core::*;
