//! Ranges of `[[steps]]`.

use super::Checks;
use crate::model::deck::{DeckDynamics, DeckStep, Direction, StepKind};
use crate::model::keys;

impl Checks<'_> {
    pub(super) fn step(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("duration"), step.duration);
        let drive = step.kind == StepKind::Drive;
        let horizontal = !matches!(step.direction, Some(Direction::Z | Direction::MinusZ));
        let other = |name: &str| {
            let (kind, own) = if drive {
                ("drive", "preload")
            } else {
                ("preload", "drive")
            };
            format!("`{name}` belongs to a {own}, and this step is a {kind}")
        };
        for (name, given, allowed) in [
            ("top_pressure", step.top_pressure.is_some(), !drive),
            ("direction", step.direction.is_some(), drive),
            ("displacement", step.displacement.is_some(), drive),
            ("vertical", step.vertical.is_some(), drive),
        ] {
            self.require(
                !given || allowed,
                &key(name),
                || other(name),
                "leave it out here, or make it a step of its own",
            );
            let needed = allowed && name != "vertical";
            self.require(
                !needed || given,
                &key(name),
                || format!("the key `{name}` is missing"),
                &keys::example(name),
            );
        }
        self.require(
            step.vertical.is_none() || !drive || horizontal,
            &key("vertical"),
            || "the vertical motion is the one that is driven".to_owned(),
            "leave out `vertical`, or drive in x or y",
        );
        if let Some(pressure) = step.top_pressure {
            let value = pressure.get();
            self.require(
                value >= 0.0,
                &key("top_pressure"),
                || format!("the pressure {value} MPa pulls"),
                "compression is positive here; to pull, drive in z",
            );
        }
        if let Some(displacement) = step.displacement {
            self.require(
                displacement.get() != 0.0,
                &key("displacement"),
                || "the displacement is 0".to_owned(),
                &keys::example("displacement"),
            );
        }
        self.inertia(path, step);
        let sizes = step.increments();
        let ok = sizes.min > 0.0 && sizes.min <= sizes.initial && sizes.initial <= sizes.max;
        self.require(
            ok && sizes.max <= 1.0,
            &key("increments"),
            || {
                let (initial, max, min) = (sizes.initial, sizes.max, sizes.min);
                format!("initial = {initial}, max = {max}, min = {min} are not in order")
            },
            "fractions of the step: 0 < min <= initial <= max <= 1",
        );
        self.require(
            step.viscosity.get() >= 0.0,
            &key("viscosity"),
            || format!("{} is negative", step.viscosity.get()),
            "step time, 0 for none",
        );
        if let Some(residual) = step.tolerance.residual {
            self.positive(&key("tolerance.residual"), residual);
        }
        self.require(
            step.tolerance.max_iterations > 0,
            &key("tolerance.max_iterations"),
            || "no iteration is allowed".to_owned(),
            "max_iterations = 25",
        );
    }

    /// Keys of inertia: those that its kind knows, in their ranges, and mass to act on.
    fn inertia(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        let dynamic = step.dynamics == DeckDynamics::Dynamic;
        for (name, given) in [
            ("alpha", step.alpha.is_some()),
            ("rayleigh", step.rayleigh.is_some()),
            ("ground", step.ground.is_some()),
        ] {
            self.require(
                dynamic || !given,
                &key(name),
                || format!("`{name}` belongs to a dynamic step"),
                "say dynamics = \"dynamic\", or leave it out",
            );
        }
        self.require(
            step.ground_unit.is_none() || step.ground.is_some(),
            &key("ground_unit"),
            || "there is no record whose unit this would be".to_owned(),
            &keys::example("ground"),
        );
        if let Some(alpha) = step.alpha {
            let value = alpha.get();
            self.require(
                (-1.0 / 3.0..=0.0).contains(&value),
                &key("alpha"),
                || format!("{value} is not between -1/3 and 0"),
                "0 keeps all energy, -0.05 takes out what the increments do not resolve",
            );
        }
        if let Some(rayleigh) = step.rayleigh {
            self.not_negative(&key("rayleigh.mass"), rayleigh.mass);
            self.not_negative(&key("rayleigh.stiffness"), rayleigh.stiffness);
        }
        if step.dynamics != DeckDynamics::Static {
            let materials = self.deck.materials.iter();
            let massless = materials
                .filter(|(_, m)| m.density.get() <= 0.0)
                .map(|(name, _)| name.clone());
            for name in massless.collect::<Vec<_>>() {
                self.require(
                    false,
                    &key("dynamics"),
                    || format!("the step has inertia and the material `{name}` has no mass"),
                    &format!("add to [materials.{name}]: {}", keys::example("density")),
                );
            }
        }
    }
}
