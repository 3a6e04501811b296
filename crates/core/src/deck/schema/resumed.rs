//! The deck of a resumed run: keys that may differ from those of the deck with which the run began.
//!
//! These are the title, the output, `stop` and the length of the last step. A longer step keeps its speed and its
//! increments [mm, s, deg]: the duration and the increment sizes, which belong to the whole step or are fractions
//! of it, follow its length.

use miette::Diagnostic;
use toml::{Table, Value};

use super::{Deck, DeckIncrements, DeckStep, StepKind};
use crate::deck::quantity::{Number, Time};

/// A change of the deck that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, Diagnostic)]
pub enum DeckChange {
    /// A key with another value.
    #[error("{key} was {was} when the run began, and is {is} now")]
    #[diagnostic(help(
        "a run goes on with the deck that it began with; only `output`, the title, and the length and `stop` of \
         the last step may change: take this back, or begin anew with `wythe run`"
    ))]
    Key {
        /// Dotted path of the key.
        key: String,
        /// Value when the run began.
        was: String,
        /// Present value.
        is: String,
    },
    /// A last step that cannot be continued in this way.
    #[error("{key}: {why}")]
    #[diagnostic(help(
        "the last step may become longer in the way it goes: the `displacement` of a drive, the `angle` of \
         a tilt, the `duration` of a free motion"
    ))]
    Length {
        /// Dotted path of the key.
        key: String,
        /// Reason.
        why: String,
    },
}

/// Relative rounding error of a length that was divided and multiplied again.
const ROUNDING: f64 = 1e-12;

impl Deck {
    /// Returns this deck for a run that began with `before`, and the old length of the last step as a fraction of
    /// the new one: 1 if it has not become longer.
    ///
    /// # Errors
    /// [`DeckChange`]: the first key that may not differ.
    pub fn resumed_from(mut self, before: &Self) -> Result<(Self, f64), DeckChange> {
        let part = self.take_length(before)?;
        let (was, is) = (before.as_table(), self.as_table());
        let mut different = Vec::new();
        differences("", &Value::Table(was), &Value::Table(is), &mut different);
        let last = format!("steps.{}.", self.steps.len().saturating_sub(1));
        let free = |key: &str| {
            let of_length = key.strip_prefix(&last).is_some_and(|key| {
                ["displacement", "angle", "duration"].contains(&key)
                    || key.split('.').next() == Some("increments")
            });
            let of_stop = key
                .strip_prefix(&last)
                .is_some_and(|key| key.split('.').next() == Some("stop"));
            let of_output = key.split('.').next() == Some("output");
            key == "title" || of_output || of_stop || (part < 1.0 && of_length)
        };
        match different.into_iter().find(|(key, ..)| !free(key)) {
            Some((key, was, is)) => Err(DeckChange::Key { key, was, is }),
            None => Ok((self, part)),
        }
    }

    fn as_table(&self) -> Table {
        // Fails for no deck that was read.
        Table::try_from(self).unwrap_or_default()
    }

    /// Accepts a new length of the last step if its other keys are unchanged; returns the old length over the new
    /// one.
    fn take_length(&mut self, before: &Self) -> Result<f64, DeckChange> {
        let last = self.steps.len().wrapping_sub(1);
        if self.steps.len() != before.steps.len() {
            return Ok(1.0);
        }
        let (Some(step), Some(old)) = (self.steps.last_mut(), before.steps.last()) else {
            return Ok(1.0);
        };
        let (Some((key, is)), Some((_, was))) = (length(step), length(old)) else {
            return Ok(1.0);
        };
        if is == was || step.kind != old.kind {
            return Ok(1.0);
        }
        let key = format!("steps.{last}.{key}");
        let refuse = |why: String| {
            let key = key.clone();
            Err(DeckChange::Length { key, why })
        };
        let part = was / is;
        if !(part > 0.0 && part < 1.0) {
            return refuse(format!(
                "it was {was} when the run began, {is} is not longer"
            ));
        }
        if old.control.is_some() {
            return refuse("a step that a probe steers has no other length".to_owned());
        }
        if old.amplitude.is_some() {
            return refuse("a step with an amplitude has no other length".to_owned());
        }
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a.abs();
        let duration = old.duration.get() / part;
        if step.kind != StepKind::Free && step.duration == old.duration {
            step.duration = Time::new(duration);
        }
        if !near(step.duration.get(), duration) {
            let says = step.duration.get();
            return refuse(format!(
                "with {is} the step takes {duration} s at the speed it began with, not {says} s"
            ));
        }
        let (sizes, now) = (old.increments(), step.increments());
        let [initial, max, min] = [sizes.initial, sizes.max, sizes.min].map(|size| part * size);
        if step.increments == old.increments {
            step.increments = DeckIncrements {
                initial: Some(Number::new(initial)),
                max: Some(Number::new(max)),
                min: Some(Number::new(min)),
                peak: old.increments.peak,
            };
        } else if !(near(now.initial, initial)
            && near(now.max, max)
            && near(now.min, min)
            && near(now.peak, sizes.peak))
        {
            return refuse("the increments of the step cannot change with its length".to_owned());
        }
        Ok(part)
    }
}

/// Key and value that give the length of a step.
fn length(step: &DeckStep) -> Option<(&'static str, f64)> {
    match step.kind {
        StepKind::Drive => step.displacement.map(|d| ("displacement", d.get())),
        StepKind::Tilt => step.angle.map(|a| ("angle", a.get())),
        StepKind::Free => Some(("duration", step.duration.get())),
        StepKind::Preload | StepKind::Gravity | StepKind::Load => None,
    }
}

/// Dotted paths at which two values differ, with both values.
fn differences(path: &str, was: &Value, is: &Value, found: &mut Vec<(String, String, String)>) {
    let below = |key: &str| {
        if path.is_empty() {
            key.to_owned()
        } else {
            format!("{path}.{key}")
        }
    };
    const NOTHING: &str = "not said";
    let say = |value: Option<&Value>| value.map_or_else(|| NOTHING.to_owned(), Value::to_string);
    match (was, is) {
        (Value::Table(was), Value::Table(is)) => {
            let gone = was.keys().filter(|key| !is.contains_key(*key));
            for key in is.keys().chain(gone) {
                match (was.get(key), is.get(key)) {
                    (Some(was), Some(is)) => differences(&below(key), was, is, found),
                    (was, is) => found.push((below(key), say(was), say(is))),
                }
            }
        }
        (Value::Array(was), Value::Array(is)) if was.len() == is.len() => {
            for (i, (was, is)) in was.iter().zip(is).enumerate() {
                differences(&below(&i.to_string()), was, is, found);
            }
        }
        (Value::Array(was), Value::Array(is)) => {
            let entries = |array: &[Value]| format!("of {} entries", array.len());
            found.push((path.to_owned(), entries(was), entries(is)));
        }
        // Numbers are compared bitwise, because their bits determine the results.
        (Value::Float(was), Value::Float(is)) if was.to_bits() == is.to_bits() => {}
        (was, is) if was == is => {}
        (was, is) => found.push((path.to_owned(), was.to_string(), is.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use miette::Diagnostic;

    const WALL: &str = include_str!("../../../../../examples/03_shear_wall_j7d.toml");

    fn deck(overrides: &[(&str, &str)]) -> Deck {
        let overrides: Vec<_> = overrides
            .iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
            .collect();
        Deck::from_str_with(WALL, "wall.toml", &overrides).unwrap()
    }

    #[test]
    fn output_title_and_the_end_of_the_last_step_may_change() {
        let changes = [
            ("output.every", "1"),
            ("title", "other"),
            ("steps.1.stop.below_peak", "0.5"),
        ];
        let before = deck(&[]);
        let (now, part) = deck(&changes).resumed_from(&before).unwrap();
        assert_eq!((now.output.every, part), (1, 1.0));
        assert!(now.steps[1].stop.is_some());
    }

    #[test]
    fn changed_keys_are_reported_with_both_values() {
        for (key, value, named) in [
            ("materials.brick.E", "17 GPa", "materials.brick.E"),
            (
                "materials.brick.tension.0.0",
                "3.4",
                "materials.brick.tension.0",
            ),
            ("wall.courses", "4", "wall.courses"),
            ("steps.0.top_pressure", "2 MPa", "steps.0.top_pressure"),
            ("steps.1.duration", "2", "steps.1.duration"),
            ("steps.1.increments.max", "0.01", "steps.1.increments.max"),
            (
                "steps.1.tolerance.max_iterations",
                "9",
                "steps.1.tolerance.max_iterations",
            ),
        ] {
            let error = deck(&[(key, value)]).resumed_from(&deck(&[])).unwrap_err();
            let DeckChange::Key { key, .. } = &error else {
                panic!("{error}")
            };
            assert!(key.starts_with(named), "{error}");
            assert!(error.help().is_some());
        }
    }

    #[test]
    fn a_longer_last_step_keeps_its_speed_and_its_increments() {
        let before = deck(&[]);
        let (old, old_sizes) = (&before.steps[1], before.steps[1].increments());
        let whole = old.displacement.unwrap().get();
        let twice = format!("{}", 2.0 * whole);
        let longer = deck(&[("steps.1.displacement", &twice)]);
        let (now, part) = longer.resumed_from(&before).unwrap();
        assert_eq!(part, 0.5);
        let step = &now.steps[1];
        assert_eq!(step.duration.get(), 2.0 * old.duration.get());
        assert_eq!(step.increments().max, 0.5 * old_sizes.max);
        // A deck that was written by `to_toml` is accepted unchanged.
        let text = now.to_toml().unwrap();
        let read = Deck::from_str(&text, "model.toml").unwrap();
        let (again, part) = read.clone().resumed_from(&before).unwrap();
        assert_eq!((&again, part), (&read, 0.5));
        assert_eq!(read.clone().resumed_from(&read).unwrap().1, 1.0);
    }

    #[test]
    fn a_shorter_a_backward_or_a_faster_step_is_rejected() {
        let before = deck(&[("steps.1.displacement", "4")]);
        for (displacement, duration) in [("3", "1"), ("-8", "1"), ("8", "1.5")] {
            let now = deck(&[
                ("steps.1.displacement", displacement),
                ("steps.1.duration", duration),
            ]);
            let error = now.resumed_from(&before).unwrap_err();
            assert!(matches!(error, DeckChange::Length { .. }), "{error}");
        }
    }
}
