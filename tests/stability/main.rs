//! Where methods fail: the atlas, moving blocks, general contact.

#[path = "../common/mod.rs"]
mod common;

mod atlas;
mod careful;
mod general_contact;
mod moving_blocks;
