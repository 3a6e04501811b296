//! `[[settlements]]`: names and shapes, and the drives that name them.

use super::Checks;
use super::references::meant;
use crate::deck::keys;
use crate::deck::schema::{DeckProfile, DeckSettlement};

impl Checks<'_> {
    pub(super) fn settlements(&mut self) {
        let deck = self.deck;
        for (i, settlement) in deck.settlements.iter().enumerate() {
            let path = format!("settlements.{i}");
            let name = &settlement.name;
            self.plain_name(&format!("{path}.name"), name, "settlement");
            let twice = deck.settlements[..i].iter().any(|s| s.name == *name);
            self.demand(
                !twice,
                &format!("{path}.name"),
                || format!("there are two settlements named `{name}`"),
                "give each a name of its own",
            );
            self.not_empty(&format!("{path}.on"), Some(&settlement.on));
            self.shape_of_ground(&path, settlement);
        }
        self.names_of_settlements();
    }

    /// Requires one shape, and one that is defined.
    fn shape_of_ground(&mut self, path: &str, settlement: &DeckSettlement) {
        let key = |name: &str| format!("{path}.{name}");
        let given = [
            settlement.trough.is_some(),
            settlement.tilt.is_some(),
            settlement.table.is_some(),
        ];
        self.require(
            given.iter().filter(|given| **given).count() == 1,
            &key("trough"),
            || "a settlement has one shape: trough, tilt or table".to_owned(),
            "trough = { centre = \"3 m\", inflection = \"1.5 m\" }",
        );
        if let Some(trough) = &settlement.trough {
            self.positive(&key("trough.inflection"), trough.inflection);
        }
        if let Some(tilt) = &settlement.tilt {
            self.require(
                tilt.from.get() != tilt.to.get(),
                &key("tilt.to"),
                || "a line needs two points".to_owned(),
                "tilt = { from = \"0 m\", to = \"6 m\" }: 0 at the first, 1 at the second",
            );
        }
        if let Some(DeckProfile { at, values }) = &settlement.table {
            let ascends = at.windows(2).all(|pair| pair[0].get() < pair[1].get());
            self.require(
                at.len() >= 2 && at.len() == values.len() && ascends,
                &key("table.at"),
                || {
                    format!(
                        "{} coordinates and {} values are no table",
                        at.len(),
                        values.len()
                    )
                },
                "as many values as ascending coordinates, at least two: table = { at = [\"0 m\", \"6 m\"], values = [0, 1] }",
            );
        }
    }

    fn names_of_settlements(&mut self) {
        let deck = self.deck;
        let known = || deck.settlements.iter().map(|s| s.name.as_str());
        if (0..deck.settlements.len()).any(|i| self.broken.holds(&format!("settlements.{i}.name")))
        {
            return;
        }
        for (i, step) in deck.steps.iter().enumerate() {
            let path = format!("steps.{i}.settlement");
            let absent = |name: &&String| !known().any(|s| s == name.as_str());
            if let Some(name) = step.settlement.as_ref().filter(absent)
                && !self.is_full()
            {
                let help = meant(name, known()).unwrap_or_else(|| keys::example("settlements"));
                let message = format!("there is no settlement named `{name}`");
                self.refer("settlements", &path, deck.error(&path, message, &help));
            }
        }
    }
}
