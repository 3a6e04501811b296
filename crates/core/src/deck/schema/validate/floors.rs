//! Ranges of `[[floors]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::schema::{DeckFloor, DeckProbe, DeckProcedure, DeckStep, DeckTie, StepKind};
use crate::error::ErrorKind;

impl Checks<'_> {
    pub(super) fn floors(&mut self) {
        let deck = self.deck;
        if deck.floors.is_empty() {
            return;
        }
        let mut taken: Vec<String> = deck.probes.iter().map(DeckProbe::column).collect();
        taken.extend(deck.loads().iter().flat_map(|(_, load)| load.columns()));
        taken.extend(deck.ties.iter().flat_map(DeckTie::columns));
        for (i, floor) in deck.floors.iter().enumerate() {
            let path = format!("floors.{i}");
            let name = format!("{path}.name");
            self.plain_name(&name, &floor.name, "floor");
            let twice = deck.floors[..i]
                .iter()
                .any(|other| other.name == floor.name);
            self.demand(
                !twice,
                &name,
                || format!("there are two floors named `{}`", floor.name),
                "give each a name of its own",
            );
            let columns = floor.columns();
            let again = columns.iter().find(|column| taken.contains(column));
            self.require(
                twice || again.is_none(),
                &name,
                || format!("there are two columns named `{}`", again.map_or("", |c| c)),
                "give each floor, tie, load and probe a name of its own",
            );
            taken.extend(columns);
            self.not_empty(&format!("{path}.on"), Some(&floor.on));
            self.floor(&path, floor);
        }
        self.require(
            deck.symmetry.is_empty(),
            "floors",
            || "floors and planes of symmetry do not go together".to_owned(),
            "model the whole scene: a scene that is its own mirror image is cut by itself where that is possible",
        );
        self.weight_of_floors();
    }

    fn floor(&mut self, path: &str, floor: &DeckFloor) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("load"), floor.load);
        self.positive(&key("mass"), floor.mass);
        self.positive(&key("axial"), floor.axial);
        self.positive(&key("shear"), floor.shear);
        self.positive(&key("spacing"), floor.spacing);
        let springs = floor.axial.is_some() || floor.shear.is_some();
        self.require(
            floor.load.is_none() || floor.mass.is_none(),
            &key("mass"),
            || "both `load` and `mass` are given".to_owned(),
            "load = \"3 kN/m^2\" over its area in plan, or mass = \"4 tonne\" in all",
        );
        self.require(
            floor.load.is_some() || floor.mass.is_some() || floor.rigid || springs,
            &key("load"),
            || "the floor neither weighs nor ties".to_owned(),
            &keys::example("load"),
        );
        self.require(
            !(floor.rigid && springs),
            &key("rigid"),
            || "a rigid floor has its own stiffness".to_owned(),
            "leave out `axial` and `shear`, or `rigid`",
        );
        self.require(
            floor.spacing.is_none() || floor.rigid || springs,
            &key("spacing"),
            || "the floor has no springs that could have a distance".to_owned(),
            "leave it out, or add rigid = true, or `axial` and `shear`",
        );
    }

    /// Requires gravity or inertia for floors that weigh.
    fn weight_of_floors(&mut self) {
        let deck = self.deck;
        let weighs = |floor: &DeckFloor| floor.load.is_some() || floor.mass.is_some();
        let Some(i) = deck.floors.iter().position(weighs) else {
            return;
        };
        let acts = |step: &DeckStep| {
            matches!(step.kind, StepKind::Gravity | StepKind::Free)
                || matches!(step.procedure, DeckProcedure::Dynamic)
        };
        let known = !self.broken.section("steps") && !self.is_full();
        if known && !deck.steps.is_empty() && !deck.steps.iter().any(acts) {
            let path = format!("floors.{i}");
            let message = format!(
                "`{}` has mass, and no step has gravity",
                deck.floors[i].name
            );
            let help = "put a step before the others: kind = \"gravity\"";
            let error = deck.error(&path, message, help);
            self.errors.push(error.of_kind(ErrorKind::Conflict));
        }
    }
}
