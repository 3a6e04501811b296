//! Ranges of `[[steps.loads]]`, `amplitude` and `cycles`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::{Number, Quantity};
use crate::deck::schema::{DeckAmplitude, DeckLoad, DeckProbe, DeckProcedure, DeckStep, StepKind};
use crate::model::columns::FIXED;
use crate::model::reactions;

impl Checks<'_> {
    /// Checks the loads of all steps: the place of a load is given once, and its kind does not change.
    pub(super) fn loads(&mut self) {
        let deck = self.deck;
        let first = deck.loads();
        for (s, step) in deck.steps.iter().enumerate() {
            for (l, load) in step.loads.iter().enumerate() {
                let path = format!("steps.{s}.loads.{l}");
                self.value(&path, load);
                let twice = step.loads[..l].iter().any(|other| other.name == load.name);
                self.require(
                    !twice,
                    &format!("{path}.name"),
                    || format!("this step has two loads named `{}`", load.name),
                    "a load has one value at the end of a step",
                );
                match first.iter().find(|(_, known)| known.name == load.name) {
                    Some((begin, known)) if *begin != path => {
                        self.said_before(&path, load, begin, known);
                    }
                    _ => self.place(&path, load),
                }
            }
        }
        self.columns_of_loads(&first);
    }

    /// Checks names of loads: they become column names and must be unique.
    fn columns_of_loads(&mut self, first: &[(String, &DeckLoad)]) {
        let mut taken: Vec<String> = self.deck.probes.iter().map(DeckProbe::column).collect();
        for (path, load) in first {
            let (path, name) = (format!("{path}.name"), &load.name);
            self.plain_name(&path, name, "column");
            for column in load.columns() {
                let again = taken.contains(&column)
                    || FIXED.contains(&column.as_str())
                    || reactions::is_column(&column);
                self.require(
                    !again,
                    &path,
                    || format!("there are two columns named `{column}`"),
                    "give each load and probe a name of its own",
                );
                taken.push(column);
            }
        }
    }

    /// Checks that a load has one value and only the keys of its kind.
    fn value(&mut self, path: &str, load: &DeckLoad) {
        let values = [
            load.pressure.is_some(),
            load.traction.is_some(),
            load.force.is_some(),
            load.line_force.is_some(),
        ];
        let count = values.iter().filter(|given| **given).count();
        self.require(
            count == 1,
            path,
            || match count {
                0 => "the load has no value".to_owned(),
                _ => format!("the load has {count} values"),
            },
            "one of: pressure = \"20 kPa\", traction = [..], force = [\"1 kN\", 0, 0], line_force = [..]",
        );
        self.require(
            load.follower.is_none() || load.pressure.is_some(),
            &format!("{path}.follower"),
            || "nothing but a pressure turns with its faces".to_owned(),
            "leave it out, or give a pressure",
        );
    }

    /// Checks the place of a load, which depends on its kind.
    fn place(&mut self, path: &str, load: &DeckLoad) {
        let key = |name: &str| format!("{path}.{name}");
        let Some((kind, _)) = load.value() else {
            return;
        };
        let on_faces = matches!(kind, "pressure" | "traction");
        let along = load.from.is_some() || load.to.is_some();
        self.require(
            !on_faces || (load.near.is_none() && !along),
            path,
            || format!("a {kind} acts on faces, not on a point or a line"),
            "name faces by `on`; force = [..] acts on a point, line_force = [..] on a line",
        );
        self.require(
            !on_faces || load.on.is_some(),
            &key("on"),
            || "the key `on` is missing: which faces?".to_owned(),
            &keys::example_at("steps.loads.on"),
        );
        self.not_empty(&key("on"), load.on.as_ref());
        self.require(
            kind != "line_force" || along,
            &key("from"),
            || "the key `from` is missing: where does the line begin?".to_owned(),
            &keys::example("from"),
        );
        self.require(
            load.from.is_some() == load.to.is_some(),
            &key(if load.from.is_some() { "to" } else { "from" }),
            || "a line has two ends, `from` and `to`".to_owned(),
            &keys::example("to"),
        );
        self.require(
            load.from.is_none() || load.from != load.to,
            &key("to"),
            || "the line ends where it begins".to_owned(),
            "a force acts on a point: near = [..]",
        );
        self.require(
            load.near.is_none() || !along,
            &key("near"),
            || "a load acts on a point or along a line".to_owned(),
            "leave out `near`, or `from` and `to`",
        );
        self.require(
            kind != "force" || along || load.near.is_some() || load.on.is_some(),
            &key("on"),
            || "neither `on`, `near` nor `from` and `to` is given".to_owned(),
            &keys::example("near"),
        );
        self.require(
            load.within.is_none() || along,
            &key("within"),
            || "`within` belongs to a line".to_owned(),
            "leave it out",
        );
        self.positive(&key("within"), load.within);
    }

    /// Checks a load that an earlier step has named: only its value may change.
    fn said_before(&mut self, path: &str, load: &DeckLoad, begin: &str, known: &DeckLoad) {
        let name = &load.name;
        let same = |a: Option<(&str, _)>, b: Option<(&str, _)>| match (a, b) {
            (Some((a, _)), Some((b, _))) => a == b,
            _ => true,
        };
        self.require(
            same(load.value(), known.value()),
            path,
            || format!("`{name}` is another kind of load in {begin}"),
            "a load stays of its kind: give this one a name of its own",
        );
        let says_other = |what: bool, other: bool| what && other;
        let differs = says_other(load.on.is_some(), load.on != known.on)
            || says_other(load.near.is_some(), load.near != known.near)
            || says_other(load.from.is_some(), load.from != known.from)
            || says_other(load.to.is_some(), load.to != known.to)
            || says_other(load.within.is_some(), load.within != known.within)
            || says_other(
                load.follower.is_some(),
                load.follower.unwrap_or(true) != known.follower.unwrap_or(true),
            );
        self.require(
            !differs,
            path,
            || format!("`{name}` acts elsewhere, or otherwise, in {begin}"),
            "a load stays where it is: say its value only, or give this one a name of its own",
        );
    }

    /// Checks the amplitude, cycles and loads of a step.
    pub(super) fn course(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        self.require(
            step.kind != StepKind::Load || !step.loads.is_empty(),
            &key("loads"),
            || "the step loads nothing".to_owned(),
            &keys::example("loads"),
        );
        self.require(
            step.cycles.is_none() || step.amplitude.is_none(),
            &key("cycles"),
            || "`cycles` are an amplitude, and `amplitude` is given, too".to_owned(),
            "leave out one of them",
        );
        if let Some(cycles) = &step.cycles {
            let positive = cycles.amplitudes.iter().all(|a| a.get() > 0.0);
            self.require(
                !cycles.amplitudes.is_empty() && positive && cycles.repeat > 0,
                &key("cycles"),
                || "cycles have amplitudes above 0 and are driven once at least".to_owned(),
                &keys::example("cycles"),
            );
        }
        let rows = match &step.amplitude {
            Some(DeckAmplitude::Rows(rows)) => Some(rows),
            _ => None,
        };
        if let Some(rows) = rows {
            self.rows_of_amplitude(path, step, rows);
        }
        let path_follows = matches!(
            step.procedure,
            DeckProcedure::ArcLength | DeckProcedure::Dissipation
        );
        self.require(
            step.cycles.is_none() || !path_follows,
            &key("cycles"),
            || "this procedure finds the load along a path, and cannot turn it round".to_owned(),
            "\"auto\", \"static\", \"implex\", \"quasi_static\", \"dynamic\" or \"displacement_control\"",
        );
    }

    fn rows_of_amplitude(&mut self, path: &str, step: &DeckStep, rows: &[[Number; 2]]) {
        let key = format!("{path}.amplitude");
        let help = "rows of [part of the step's time, factor], from [0, 0] to time 1";
        let rows = rows.iter().map(|row| row.map(Quantity::get)).collect();
        let amplitude = match crate::model::amplitude::Amplitude::new(rows) {
            Ok(amplitude) => amplitude,
            Err(no) => {
                self.demand(false, &format!("{key}.{}", no.row), || no.why, help);
                return;
            }
        };
        if let Some((why, help)) = misfit(step, &amplitude) {
            self.require(false, &key, || why, help);
        }
    }
}

/// Reason why a step cannot use an amplitude, and advice.
pub(in crate::deck) fn misfit(
    step: &DeckStep,
    amplitude: &crate::model::amplitude::Amplitude,
) -> Option<(String, &'static str)> {
    let follows = matches!(
        step.procedure,
        DeckProcedure::ArcLength | DeckProcedure::Dissipation
    );
    let rises = amplitude.rises();
    if follows && !(rises && amplitude.end() == 1.0) {
        return Some((
            "the amplitude turns back or does not end at 1, and this procedure finds the load along a path"
                .to_owned(),
            "\"auto\", \"static\", \"implex\", \"quasi_static\", \"dynamic\" or \"displacement_control\"",
        ));
    }
    let kept = matches!(
        step.kind,
        StepKind::Preload | StepKind::Gravity | StepKind::Tilt
    );
    (kept && amplitude.end() != 1.0).then(|| {
        (
            format!(
                "the amplitude ends at {}, but the effect of a {} remains in later steps",
                amplitude.end(),
                step.kind.name()
            ),
            "let it end at [1, 1]",
        )
    })
}
