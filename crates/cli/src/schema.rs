//! `wythe schema`: prints the schema with which editors complete and check a deck.

use crate::failure::Failure;
use crate::say::print;

/// Prints the JSON schema of decks.
pub fn schema() -> Result<(), Failure> {
    print(&wythe_core::deck::json_schema::text())
}
