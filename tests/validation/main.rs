//! Examples and cases of docs/validation in their short forms.

#![expect(
    clippy::too_many_lines,
    reason = "a test is read from its input to what it checks, and many are tables of cases"
)]

#[path = "../common/mod.rs"]
mod common;

mod accuracy_speed;
mod cases;
mod falling_scenes;
mod more_scenes;
mod shear_walls;
mod wall_scenes;
