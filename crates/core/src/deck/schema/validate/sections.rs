//! Ranges of `[[sections]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::Quantity;
use crate::deck::schema::DeckSection;
use crate::model::columns::FIXED;

impl Checks<'_> {
    pub(super) fn sections(&mut self) {
        let deck = self.deck;
        for (i, section) in deck.sections.iter().enumerate() {
            self.section(&format!("sections.{i}"), section);
        }
        if deck.sections.is_empty() {
            return;
        }
        let others = deck.columns_but_of_sections();
        let mut taken: Vec<String> = FIXED.map(str::to_owned).into();
        taken.extend(others);
        for draft in deck.drafts() {
            let columns: Vec<String> = draft.columns().collect();
            let twice = columns.iter().find(|column| taken.contains(column));
            if let Some(column) = twice {
                self.require(
                    false,
                    &format!("{}.name", draft.path),
                    || format!("there are two columns named `{column}`"),
                    "give each section a name of its own",
                );
            }
            taken.extend(columns);
        }
    }

    fn section(&mut self, path: &str, section: &DeckSection) {
        let deck = self.deck;
        let key = |name: &str| format!("{path}.{name}");
        if let Some(name) = &section.name {
            self.plain_name(&key("name"), name, "column");
        }
        self.not_empty(&key("of"), section.of.as_ref());
        self.demand(
            section.unit_normal() != [0.0; 3],
            &key("normal"),
            || "a vector of length 0 is no direction".to_owned(),
            &keys::example("sections.normal"),
        );
        if let Some([low, high]) = section.within.map(|w| w.map(|c| c.map(Quantity::get))) {
            self.demand(
                (0..3).all(|i| low[i] < high[i]),
                &key("box"),
                || "the first corner is not the lowest one along x, y and z".to_owned(),
                &keys::example("box"),
            );
        }
        let Some(piers) = &section.piers else {
            for (name, given) in [
                ("through", section.through.is_some()),
                ("name", section.name.is_some()),
            ] {
                self.require(
                    given,
                    &key(name),
                    || "the key is missing".to_owned(),
                    &keys::example_at(&format!("sections.{name}")),
                );
            }
            return;
        };
        let own = section.through.is_some()
            || section.normal.is_some()
            || section.of.is_some()
            || section.within.is_some();
        self.require(
            !own,
            &key("piers"),
            || "the sections of piers have planes of their own".to_owned(),
            "leave `through`, `normal`, `of` and `box` out, or `piers`",
        );
        let wall = deck.walls().find(|(_, name, _)| name == piers);
        let openings = wall.as_ref().map(|(_, _, wall)| wall.openings.len());
        self.require(
            openings.is_some_and(|count| count > 0),
            &key("piers"),
            || match openings {
                None => format!("there is no wall named `{piers}`"),
                Some(_) => format!("`{piers}` has no openings, and so no piers"),
            },
            "the name of a wall with openings; else give `through`",
        );
    }
}
