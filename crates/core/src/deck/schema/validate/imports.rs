//! Ranges of `[[imports]]`. The files are checked when the model is built.

use super::Checks;
use crate::deck::import::Units;
use crate::deck::keys;

impl Checks<'_> {
    pub(super) fn imports(&mut self) {
        let deck = self.deck;
        for (i, import) in deck.imports.iter().enumerate() {
            let path = format!("imports.{i}");
            let key = |name: &str| format!("{path}.{name}");
            let name = &import.name;
            self.demand(
                !name.is_empty() && !name.contains('.'),
                &key("name"),
                || format!("`{name}` is no name for an import"),
                "letters, digits, - and _; a dot parts it from its bodies and sets",
            );
            let of_walls = deck.walls().map(|(_, name, _)| name);
            let of_blocks = deck.blocks.iter().map(|b| b.name.as_str());
            let before = deck.imports[..i].iter().map(|other| other.name.as_str());
            let taken = of_walls.chain(of_blocks).chain(before).any(|n| n == name);
            self.demand(
                !taken,
                &key("name"),
                || format!("`{name}` is the name of something else"),
                "give each wall, block and import a name of its own",
            );
            if let Err(why) = Units::parse(&import.units) {
                self.demand(
                    false,
                    &key("units"),
                    || why,
                    &keys::example_at("imports.units"),
                );
            }
            for (set, material) in &import.materials {
                self.known_material(&format!("{path}.materials.{set}"), material);
            }
        }
    }
}
