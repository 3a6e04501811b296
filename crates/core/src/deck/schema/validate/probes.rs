//! Ranges of `[[probes]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::schema::DeckProbe;
use crate::model::columns::FIXED;

impl Checks<'_> {
    pub(super) fn probes(&mut self) {
        let deck = self.deck;
        if deck.probes.is_empty() {
            return;
        }
        let columns: Vec<String> = deck.probes.iter().map(DeckProbe::column).collect();
        for (i, (probe, column)) in deck.probes.iter().zip(&columns).enumerate() {
            let path = format!("probes.{i}");
            let name = &probe.name;
            let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
            self.demand(
                name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(plain),
                &format!("{path}.name"),
                || format!("`{name}` is no name for a column"),
                "a letter, then letters, digits, - and _",
            );
            self.require(
                !columns[..i].contains(column) && !FIXED.contains(&column.as_str()),
                &format!("{path}.name"),
                || format!("there are two columns named `{column}`"),
                "give each probe a name of its own",
            );
            self.require(
                probe.on.is_some() || probe.near.is_some(),
                &format!("{path}.on"),
                || "neither `on` nor `near` is given".to_owned(),
                &keys::example("on"),
            );
            self.not_empty(&format!("{path}.on"), probe.on.as_ref());
            if let Some(minus) = &probe.minus {
                self.require(
                    minus.on.is_some() || minus.near.is_some(),
                    &format!("{path}.minus"),
                    || "neither `on` nor `near` is given".to_owned(),
                    &keys::example("minus"),
                );
                self.not_empty(&format!("{path}.minus.on"), minus.on.as_ref());
            }
        }
    }
}
