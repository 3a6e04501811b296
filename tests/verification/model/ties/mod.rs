//! Ties: rods and bars of the model, and of decks.

mod decks;
mod rods;
