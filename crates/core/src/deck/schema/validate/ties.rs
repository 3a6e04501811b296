//! Ranges of `[[ties]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{DeckProbe, DeckTie, StepKind, TieBond};
use crate::error::ErrorKind;
use crate::model::columns::FIXED;

/// Largest number of bars in a bed joint.
const MOST_BARS: u32 = 100;

impl Checks<'_> {
    pub(super) fn ties(&mut self) {
        let deck = self.deck;
        if deck.ties.is_empty() {
            return;
        }
        let mut taken: Vec<String> = deck.probes.iter().map(DeckProbe::column).collect();
        taken.extend(deck.loads().iter().flat_map(|(_, load)| load.columns()));
        for (i, tie) in deck.ties.iter().enumerate() {
            let path = format!("ties.{i}");
            self.plain_name(&format!("{path}.name"), &tie.name, "column");
            let columns = tie.columns();
            let again = columns.iter().enumerate().find(|(c, column)| {
                let seen = taken.contains(column) || columns[..*c].contains(column);
                seen || FIXED.contains(&column.as_str())
            });
            self.require(
                again.is_none(),
                &format!("{path}.name"),
                || {
                    format!(
                        "there are two columns named `{}`",
                        again.map_or("", |c| c.1)
                    )
                },
                "give each tie, load and probe a name of its own, and name each course once",
            );
            taken.extend(columns);
            self.line_of_tie(&path, tie);
            self.section_of_tie(&path, tie);
            self.step_of_tie(&path, tie);
        }
    }

    /// Requires points, or a wall and courses.
    fn line_of_tie(&mut self, path: &str, tie: &DeckTie) {
        let key = |name: &str| format!("{path}.{name}");
        let by_courses = tie.along.is_some() || tie.courses.is_some();
        self.require(
            tie.points.is_some() != by_courses,
            &key("points"),
            || {
                let why = if by_courses {
                    "both `points` and `along` or `courses` are given"
                } else {
                    "neither `points` nor `along` is given: where does the tie lie?"
                };
                why.to_owned()
            },
            "points = [[0, 0, 0], [\"2 m\", 0, 0]]; or along = \"wall\" with courses = [3, 6], for bars in bed joints",
        );
        if let Some(points) = &tie.points {
            let count = points.len();
            self.require(
                count >= 2 && (count == 2 || tie.is_bonded()),
                &key("points"),
                || match tie.bond {
                    TieBond::Anchored => {
                        format!(
                            "an anchored tie is straight between two ends, and has {count} points"
                        )
                    }
                    TieBond::Bonded => format!("{count} points make no line"),
                },
                "two points; bond = \"bonded\" follows a line of more",
            );
            return;
        }
        for (name, there, needed) in [
            ("courses", tie.courses.is_some(), tie.along.is_some()),
            ("along", tie.along.is_some(), tie.courses.is_some()),
        ] {
            self.require(
                there || !needed,
                &key(name),
                || format!("the key `{name}` is missing"),
                &keys::example(&format!("ties.{name}")),
            );
        }
        self.joints_of_tie(path, tie);
    }

    /// Checks the wall and the courses of bars in bed joints.
    fn joints_of_tie(&mut self, path: &str, tie: &DeckTie) {
        let key = |name: &str| format!("{path}.{name}");
        self.demand(
            tie.courses
                .as_ref()
                .is_none_or(|courses| !courses.is_empty()),
            &key("courses"),
            || "the list is empty".to_owned(),
            &keys::example("ties.courses"),
        );
        let (Some(name), true) = (&tie.along, self.scene_is_known()) else {
            return;
        };
        let deck = self.deck;
        let wall = deck.walls().find(|(_, known, _)| *known == name);
        let Some((_, _, wall)) = wall else {
            let known = deck.walls().map(|(_, known, _)| known);
            let help = keys::nearest(name, known).map_or_else(
                || keys::example("ties.along"),
                |near| format!("did you mean `{near}`?"),
            );
            let message = format!("there is no wall named `{name}`");
            let error = deck.error(&key("along"), message, &help);
            if !self.is_full() {
                self.errors.push(error.of_kind(ErrorKind::UnknownName));
            }
            return;
        };
        let last = tie
            .courses
            .iter()
            .flatten()
            .find(|k| **k + 1 >= wall.courses);
        self.require(
            last.is_none(),
            &key("courses"),
            || {
                let (k, count) = (last.copied().unwrap_or_default(), wall.courses);
                format!("there is no bed joint on course {k}: the wall has the courses 0 to {}", count - 1)
            },
            "courses are counted from 0, as in the names of units; the uppermost has no joint on it",
        );
    }

    /// Checks area and material.
    fn section_of_tie(&mut self, path: &str, tie: &DeckTie) {
        let key = |name: &str| format!("{path}.{name}");
        self.require(
            tie.area.is_some() != tie.diameter.is_some(),
            &key("area"),
            || match tie.area {
                Some(_) => "both `area` and `diameter` are given".to_owned(),
                None => "neither `area` nor `diameter` is given".to_owned(),
            },
            "area = \"314 mm^2\" of all bars together, or diameter = \"20 mm\" of each",
        );
        self.positive(&key("area"), tie.area);
        self.positive(&key("diameter"), tie.diameter);
        self.demand(
            (1..=MOST_BARS).contains(&tie.bars),
            &key("bars"),
            || format!("{} bars", tie.bars),
            "from 1 to 100",
        );
        self.positive(&key("E"), tie.E);
        self.positive(&key("f_y"), tie.f_y);
        self.positive(&key("rupture"), tie.rupture);
        self.not_negative(&key("hardening"), tie.hardening);
        self.not_negative(&key("unbonded"), tie.unbonded);
        self.require(
            tie.hardening.is_none() || tie.f_y.is_some(),
            &key("hardening"),
            || "a tie without `f_y` stays elastic and does not harden".to_owned(),
            &keys::example("ties.f_y"),
        );
        self.require(
            tie.unbonded.is_none() || tie.is_bonded(),
            &key("unbonded"),
            || "an anchored tie is free over its whole length".to_owned(),
            "leave it out, or bond = \"bonded\"",
        );
    }

    /// Checks the step in which a tie is installed, and its prestress.
    fn step_of_tie(&mut self, path: &str, tie: &DeckTie) {
        let key = |name: &str| format!("{path}.{name}");
        let deck = self.deck;
        self.positive(&key("prestress"), tie.prestress);
        let step = deck.step_of_tie(tie);
        if let (Some(name), None) = (&tie.step, step) {
            let help = match keys::nearest(
                name,
                deck.steps.iter().map(crate::deck::schema::DeckStep::name),
            ) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "the name of a step, or its kind if it has none".to_owned(),
            };
            let error = deck.error(
                &key("step"),
                format!("there is no step named `{name}`"),
                &help,
            );
            if !self.is_full() && !self.broken.section("steps") {
                self.errors.push(error.of_kind(ErrorKind::UnknownName));
            }
        }
        let Some(prestress) = tie.prestress else {
            return;
        };
        let area = tie.whole_area();
        let stress = prestress.get() / area;
        let limit = tie.f_y.map_or(f64::INFINITY, Quantity::get);
        self.require(
            area == 0.0 || stress < limit,
            &key("prestress"),
            || format!("{stress:.1} MPa in the tie reach its yield stress"),
            "less force, or a larger area",
        );
        let bonds = tie.is_bonded();
        self.require(
            !bonds,
            &key("prestress"),
            || "a tie that is bonded along its length cannot be stressed".to_owned(),
            "leave it out, or bond = \"anchored\"",
        );
        let Some((i, step)) = step.and_then(|i| Some((i, deck.steps.get(i)?))) else {
            return;
        };
        let reverses = step.amplitude.is_some() || step.cycles.is_some();
        self.require(
            step.kind != StepKind::Drive && !reverses,
            &key("prestress"),
            || format!("it grows with the loads of a step, and steps.{i} drives or has an amplitude"),
            "put a step before it, such as kind = \"gravity\" or kind = \"free\", or name one: step = \"stress\"",
        );
    }
}
