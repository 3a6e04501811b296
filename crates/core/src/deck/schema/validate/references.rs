//! Unknown names in a deck: blocks and their faces, springs, probes.

use super::Checks;
use crate::deck::keys;
use crate::deck::masonry;
use crate::deck::name_registry::NameRegistry;
use crate::deck::schema::{DeckPlace, Names};

impl Checks<'_> {
    #[expect(
        clippy::too_many_lines,
        reason = "a list of all keys that name something"
    )]
    /// Checks all names of blocks, faces, springs and probes.
    pub(super) fn references(&mut self) {
        self.names_of_springs();
        self.names_of_beams();
        self.names_of_probes();
        let names = ["name", "copies"];
        let unknown = |i: usize| {
            let name = |key: &str| self.broken.holds(&format!("blocks.{i}.{key}"));
            names.into_iter().any(name)
        };
        let deck = self.deck;
        let broken = |path: String| self.broken.section(&path);
        if !deck.has_scene()
            || !self.scene_is_known()
            || deck.walls().any(|(path, _, _)| broken(path))
            || (0..deck.blocks.len()).any(unknown)
            || (0..deck.imports.len()).any(|i| broken(format!("imports.{i}.name")))
            || (0..deck.beams.len()).any(|i| broken(format!("beams.{i}.name")))
            || self.broken.holds("arch.voussoirs")
        {
            return; // some names are unknown
        }
        // Walls that cannot be built give their error elsewhere.
        let Ok(walls) = masonry::lay_all(deck) else {
            return;
        };
        let Some((roll, twice)) = NameRegistry::call(deck, &walls, None) else {
            return; // too many names
        };
        self.errors.extend(twice);
        for (i, contact) in deck.contacts.iter().enumerate() {
            for (key, side) in [("slave", &contact.slave), ("master", &contact.master)] {
                self.places(&roll, &format!("contacts.{i}.{key}"), side.as_ref(), true);
            }
        }
        for (i, support) in deck.supports.iter().enumerate() {
            self.places(&roll, &format!("supports.{i}.on"), Some(&support.on), false);
        }
        for (i, spring) in deck.springs.iter().enumerate() {
            self.places(&roll, &format!("springs.{i}.on"), Some(&spring.on), false);
        }
        for (i, settlement) in deck.settlements.iter().enumerate() {
            let path = format!("settlements.{i}.on");
            self.places(&roll, &path, Some(&settlement.on), false);
        }
        for (i, floor) in deck.floors.iter().enumerate() {
            self.places(&roll, &format!("floors.{i}.on"), Some(&floor.on), true);
        }
        for (i, beam) in deck.beams.iter().enumerate() {
            self.places(&roll, &format!("beams.{i}.on"), Some(&beam.on), true);
        }
        for (i, layer) in deck.layers.iter().enumerate() {
            self.places(&roll, &format!("layers.{i}.on"), Some(&layer.on), true);
        }
        for (i, probe) in deck.probes.iter().enumerate() {
            let path = format!("probes.{i}");
            self.places(&roll, &format!("{path}.on"), probe.on.as_ref(), false);
            if let Some(DeckPlace { on, .. }) = &probe.minus {
                // `minus = "base"` has no key `on`; the error then points at the table above.
                self.places(&roll, &format!("{path}.minus.on"), on.as_ref(), false);
            }
        }
        for (i, section) in deck.sections.iter().enumerate() {
            self.places(
                &roll,
                &format!("sections.{i}.of"),
                section.of.as_ref(),
                false,
            );
        }
        for (i, step) in deck.steps.iter().enumerate() {
            self.places(&roll, &format!("steps.{i}.face"), step.face.as_ref(), true);
            for (l, load) in step.loads.iter().enumerate() {
                let faces = load.pressure.is_some() || load.traction.is_some();
                let path = format!("steps.{i}.loads.{l}.on");
                self.places(&roll, &path, load.on.as_ref(), faces);
            }
        }
    }

    fn places(&mut self, roll: &NameRegistry, path: &str, names: Option<&Names>, faces: bool) {
        let Some(names) = names.filter(|_| !self.broken.holds(path)) else {
            return;
        };
        for name in &names.0 {
            if self.is_full() {
                return;
            }
            if let Err(error) = roll.place(self.deck, path, name, faces) {
                self.errors.push(error);
            }
        }
    }

    fn names_of_springs(&mut self) {
        let deck = self.deck;
        for (i, spring) in deck.springs.iter().enumerate() {
            let twice = deck.springs[..i].iter().any(|s| s.name == spring.name);
            self.demand(
                !twice,
                &format!("springs.{i}.name"),
                || format!("there are two springs named `{}`", spring.name),
                "give each a name of its own",
            );
        }
        let known = || deck.springs.iter().map(|s| s.name.as_str());
        let springs = 0..deck.springs.len();
        let mut names = springs.map(|i| format!("springs.{i}.name"));
        if names.any(|name| self.broken.holds(&name)) {
            return;
        }
        for (i, step) in deck.steps.iter().enumerate() {
            let path = format!("steps.{i}.spring");
            let absent = |name: &&String| !known().any(|s| s == name.as_str());
            if let Some(name) = step.spring.as_ref().filter(absent)
                && !self.is_full()
            {
                let help = meant(name, known()).unwrap_or_else(|| keys::example("springs"));
                let message = format!("there is no spring named `{name}`");
                self.refer("springs", &path, deck.error(&path, message, &help));
            }
        }
    }

    fn names_of_beams(&mut self) {
        let deck = self.deck;
        let known = || deck.beams.iter().map(|b| b.name.as_str());
        if (0..deck.beams.len()).any(|i| self.broken.holds(&format!("beams.{i}.name"))) {
            return;
        }
        for (i, beam) in deck.beams.iter().enumerate() {
            let taken = deck.materials.contains_key(&beam.name)
                || deck.springs.iter().any(|s| s.name == beam.name)
                || deck
                    .steps
                    .iter()
                    .flat_map(|s| &s.loads)
                    .any(|l| l.name == beam.name);
            self.demand(
                !taken,
                &format!("beams.{i}.name"),
                || {
                    format!(
                        "a material, a spring or a load is called `{}`, too",
                        beam.name
                    )
                },
                "a beam has a material, a jack and a load of its name: call it otherwise",
            );
        }
        for (i, step) in deck.steps.iter().enumerate() {
            let path = format!("steps.{i}.beam");
            let absent = |name: &&String| !known().any(|b| b == name.as_str());
            if let Some(name) = step.beam.as_ref().filter(absent)
                && !self.is_full()
            {
                let help = meant(name, known()).unwrap_or_else(|| keys::example("beams"));
                let message = format!("there is no beam named `{name}`");
                self.refer("beams", &path, deck.error(&path, message, &help));
            }
        }
    }

    fn names_of_probes(&mut self) {
        let deck = self.deck;
        let known = || deck.probes.iter().map(|p| p.name.as_str());
        let probes = 0..deck.probes.len();
        let mut names = probes.map(|i| format!("probes.{i}.name"));
        if names.any(|name| self.broken.holds(&name)) {
            return;
        }
        for (i, step) in deck.steps.iter().enumerate() {
            let path = format!("steps.{i}.control.probe");
            let Some(control) = &step.control else {
                continue;
            };
            let name = &control.probe;
            if !known().any(|p| p == name) {
                let help = meant(name, known()).unwrap_or_else(|| keys::example("probes"));
                let message = format!("there is no probe named `{name}`");
                self.refer("probes", &path, deck.error(&path, message, &help));
            }
        }
    }
}

pub(super) fn meant<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    keys::nearest(name, known).map(|near| format!("did you mean `{near}`?"))
}
