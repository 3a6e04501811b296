//! Examples and cases of docs/validation in their short forms.

#[path = "../common/mod.rs"]
mod common;

mod accuracy_speed;
mod cases;
mod falling_scenes;
mod more_scenes;
mod shear_walls;
mod wall_scenes;
