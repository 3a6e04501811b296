//! Tests of the module `deck`.

mod all_findings;
mod arches;
mod bad_decks;
mod bad_scenes;
mod bonds;
mod bounded_decks;
mod catalogue;
mod checker;
mod grids;
mod held_faces;
mod imported_scenes;
mod imports;
mod layers;
mod misplaced_bodies;
mod random_decks;
mod random_imports;
mod reading;
mod scatter;
mod scenes;
mod schema;
mod sides;
mod snap;
mod stone_files;
mod strategies;
mod turned_dry_walls;
mod wall;
