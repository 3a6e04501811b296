//! Ranges of `[[probes]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{DeckProbe, Heading, ProbeQuantity};
use crate::model::columns::FIXED;
use crate::model::reactions;

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
            self.plain_name(&format!("{path}.name"), name, "column");
            self.require(
                !columns[..i].contains(column)
                    && !FIXED.contains(&column.as_str())
                    && !reactions::is_column(column),
                &format!("{path}.name"),
                || format!("there are two columns named `{column}`"),
                "give each probe a name of its own",
            );
            self.place_of_probe(&path, probe);
            self.require(
                probe.quantity != ProbeQuantity::Drift
                    || (probe.minus.is_some() && probe.gauge.is_none()),
                &format!("{path}.quantity"),
                || "a drift is measured between two heights".to_owned(),
                &keys::example("minus"),
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

    /// Requires a place and a direction, or a gauge in place of both.
    fn place_of_probe(&mut self, path: &str, probe: &DeckProbe) {
        let zero = |heading: &Heading| heading.unit() == [0.0; 3];
        self.demand(
            !probe.direction.as_ref().is_some_and(zero),
            &format!("{path}.direction"),
            || "a vector of length 0 is no direction".to_owned(),
            &keys::example("direction"),
        );
        let Some(ends) = probe.gauge else {
            self.require(
                probe.on.is_some() || probe.near.is_some(),
                &format!("{path}.on"),
                || "neither `on` nor `near` nor `gauge` is given".to_owned(),
                &keys::example("on"),
            );
            self.require(
                probe.direction.is_some(),
                &format!("{path}.direction"),
                || "the key is missing".to_owned(),
                &keys::example("direction"),
            );
            return;
        };
        self.require(
            probe.near.is_none() && probe.minus.is_none(),
            &format!("{path}.gauge"),
            || "a gauge has two ends of its own".to_owned(),
            "leave `near` and `minus` out; `on` may restrict the nodes of both ends",
        );
        let [a, b] = ends.map(|end| end.map(Quantity::get));
        self.demand(
            a != b,
            &format!("{path}.gauge"),
            || "both ends lie at one point".to_owned(),
            &keys::example("gauge"),
        );
    }
}
