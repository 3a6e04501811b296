//! Ranges of `[[steps]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::{Number, Quantity};
use crate::deck::schema::{
    DeckProcedure, DeckRayleigh, DeckStep, Direction, Heading, StepKind, Turning,
};
use crate::model::scene::Tangent;

/// Largest number of iterations of an increment.
const MOST_ITERATIONS: usize = 10_000;

/// Largest number of cycles of a step: with ten increments each they take days.
const MOST_CYCLES: f64 = 1e4;

/// Name of an optional key of a step, and whether it is given.
macro_rules! key {
    ($step:ident.$name:ident) => {
        (stringify!($name), $step.$name.is_some())
    };
}

/// Condition on a key of a step.
struct Rule<'a> {
    name: &'a str,
    given: bool,
    /// Kinds of steps that have the key.
    kinds: &'a [StepKind],
    /// Whether the key applies to the body or spring that the step moves.
    here: bool,
    needed: bool,
}

impl Checks<'_> {
    pub(super) fn step(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("duration"), step.duration);
        self.keys_of_kind(path, step);
        self.pushes(path, step);
        self.tilt(path, step);
        self.reach(path, step);
        self.inertia(path, step);
        self.course(path, step);
        self.procedure(path, step);
        self.stop(path, step);
        self.sizes(path, step);
        self.demand(
            step.viscosity.get() >= 0.0,
            &key("viscosity"),
            || format!("{} is negative", step.viscosity.get()),
            "step time, 0 for none",
        );
        self.tolerance(path, step);
    }

    /// Checks pressures, gravity, and the directions that are free.
    fn pushes(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        let drive = step.kind == StepKind::Drive;
        let rises = |direction: Heading| direction.unit()[2] != 0.0;
        let horizontal = !step.direction.is_some_and(rises);
        self.demand(
            step.direction
                .is_none_or(|direction| direction.unit() != [0.0; 3]),
            &key("direction"),
            || "a vector of length 0 is no direction".to_owned(),
            &keys::example("direction"),
        );
        self.require(
            step.vertical.is_none() || !drive || horizontal,
            &key("vertical"),
            || "the vertical motion is the one that is driven".to_owned(),
            "leave out `vertical`, or drive in x or y",
        );
        for (name, pressure) in [
            ("top_pressure", step.top_pressure),
            ("pressure", step.pressure),
        ] {
            let value = pressure.map_or(0.0, Quantity::get);
            self.demand(
                value >= 0.0,
                &key(name),
                || format!("the pressure {value} MPa pulls"),
                "compression is positive here; to pull, drive in z",
            );
        }
        self.positive(&key("gravity"), step.gravity);
        if let (Some(free), Some(direction), true) = (&step.free, step.direction, drive) {
            let driven = direction.unit();
            self.require(
                free.iter().all(|axis| driven[axis.index()] == 0.0),
                &key("free"),
                || "the direction that is driven cannot be free".to_owned(),
                "name the other directions only",
            );
        }
    }

    fn tilt(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        self.demand(
            !matches!(step.axis, Some(Direction::Z | Direction::MinusZ)),
            &key("axis"),
            || "a turn about z tilts nothing".to_owned(),
            &keys::example("axis"),
        );
        if let Some(angle) = step.angle.map(Quantity::get) {
            self.demand(
                angle.abs() <= 180.0,
                &key("angle"),
                || format!("{angle} degrees are more than half a turn"),
                &keys::example("angle"),
            );
        }
    }

    /// Checks how far a step drives.
    fn reach(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        if let Some(cycles) = &step.cycles {
            let count = cycles.amplitudes.len() as f64 * f64::from(cycles.repeat);
            self.demand(
                count <= MOST_CYCLES,
                &key("cycles.repeat"),
                || format!("{count} cycles are too many for one step"),
                "at most 1e4 in one step: amplitudes times repeat",
            );
        }
        self.require(
            step.cycles.is_none() || step.displacement.is_none(),
            &key("displacement"),
            || "`cycles` say how far the step drives".to_owned(),
            "leave out `displacement`, or `cycles`",
        );
        if let Some(displacement) = step.displacement {
            self.demand(
                displacement.get() != 0.0,
                &key("displacement"),
                || "the displacement is 0".to_owned(),
                &keys::example("displacement"),
            );
        }
    }

    /// Checks the increments.
    fn sizes(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
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
        self.positive(&key("increments.peak"), step.increments.peak);
    }

    fn tolerance(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.tolerance.{name}");
        self.positive(&key("residual"), step.tolerance.residual);
        self.demand(
            step.tolerance.max_iterations > 0,
            &key("max_iterations"),
            || "no iteration is allowed".to_owned(),
            "max_iterations = 25",
        );
        let iterations = step.tolerance.max_iterations;
        self.demand(
            iterations <= MOST_ITERATIONS,
            &key("max_iterations"),
            || format!("{iterations} iterations are too many for one increment"),
            "max_iterations = 25; shorter increments find what many iterations do not",
        );
    }

    /// Checks keys of inertia: procedure, ranges, and mass.
    fn inertia(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        let dynamic = step.procedure == DeckProcedure::Dynamic;
        for (name, given) in [
            ("alpha", step.alpha.is_some()),
            ("rayleigh", step.rayleigh.is_some()),
            ("ground", step.ground.is_some()),
        ] {
            self.require(
                dynamic || !given,
                &key(name),
                || format!("`{name}` belongs to a dynamic step"),
                "say procedure = \"dynamic\", or leave it out",
            );
        }
        self.require(
            step.ground_unit.is_none() || step.ground.is_some(),
            &key("ground_unit"),
            || "there is no record whose unit this would be".to_owned(),
            &keys::example("ground"),
        );
        self.ground_changes(path, step);
        if let Some(alpha) = step.alpha {
            let value = alpha.get();
            self.demand(
                (-1.0 / 3.0..=0.0).contains(&value),
                &key("alpha"),
                || format!("{value} is not between -1/3 and 0"),
                "0 keeps all energy, -0.05 takes out what the increments do not resolve",
            );
        }
        if let Some(rayleigh) = step.rayleigh {
            self.rayleigh(&key("rayleigh"), &rayleigh);
        }
        if matches!(
            step.procedure,
            DeckProcedure::QuasiStatic | DeckProcedure::Dynamic
        ) {
            self.masses(&key("procedure"));
        }
    }

    /// Checks that what changes records has a record to change.
    fn ground_changes(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        for (name, given) in [
            ("ground_factor", step.ground_factor.is_some()),
            ("ground_start", step.ground_start.is_some()),
        ] {
            self.require(
                !given || step.ground.is_some(),
                &key(name),
                || "there is no record that it could change".to_owned(),
                &keys::example("ground"),
            );
        }
        let (Some(ground), Some(factor)) = (&step.ground, step.ground_factor) else {
            return;
        };
        let factors = [factor.x, factor.y, factor.z].map(Number::get);
        for ((axis, file), factor) in ["x", "y", "z"].iter().zip(ground.files()).zip(factors) {
            self.require(
                file.is_some() || factor == 1.0,
                &key(&format!("ground_factor.{axis}")),
                || format!("`ground` has no record of {axis} that it could change"),
                &format!("ground = {{ {axis} = \"record.csv\" }}, or leave the factor out"),
            );
        }
    }

    /// Checks factors, or ratio and frequencies, of Rayleigh damping.
    fn rayleigh(&mut self, path: &str, rayleigh: &DeckRayleigh) {
        let key = |name: &str| format!("{path}.{name}");
        if let Some(mass) = rayleigh.mass {
            self.not_negative(&key("mass"), mass);
        }
        if let Some(stiffness) = rayleigh.stiffness {
            self.not_negative(&key("stiffness"), stiffness);
        }
        let by_ratio = [rayleigh.ratio.is_some(), rayleigh.frequencies.is_some()];
        let by_factors = rayleigh.mass.is_some() || rayleigh.stiffness.is_some();
        if by_ratio == [false; 2] {
            return;
        }
        self.require(
            by_ratio == [true; 2],
            path,
            || "`ratio` and `frequencies` belong together".to_owned(),
            "say both: rayleigh = { ratio = 0.05, frequencies = [\"8 Hz\", \"40 Hz\"] }",
        );
        self.require(
            !by_factors,
            path,
            || "the damping is given twice".to_owned(),
            "say `ratio` and `frequencies`, or `mass` and `stiffness`",
        );
        if let Some(ratio) = rayleigh.ratio {
            let value = ratio.get();
            self.demand(
                (0.0..1.0).contains(&value),
                &key("ratio"),
                || format!("{value} is not between 0 and 1"),
                "masonry that does not crack has 0.02 to 0.05",
            );
        }
        for frequency in rayleigh.frequencies.into_iter().flatten() {
            let value = frequency.get();
            self.demand(
                value > 0.0,
                &key("frequencies"),
                || format!("{value} Hz is not above 0"),
                "`wythe modes` finds the natural frequencies",
            );
        }
    }

    /// Requires that all materials have mass.
    fn masses(&mut self, path: &str) {
        let deck = self.deck;
        for (name, material) in &deck.materials {
            let is_known = !self.broken.section(&format!("materials.{name}"));
            let is_massless = is_known && material.density.get() <= 0.0;
            self.require(
                !is_massless,
                path,
                || format!("the step has inertia and the material `{name}` has no mass"),
                &format!("add to [materials.{name}]: {}", keys::example("density")),
            );
        }
    }

    /// Checks conditions between a procedure and other keys.
    fn procedure(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.{name}");
        self.require(
            step.procedure != DeckProcedure::Implex || step.tangent == Tangent::Secant,
            &key("tangent"),
            || "extrapolated solids have a secant stiffness and no other".to_owned(),
            "leave `tangent` out, or take another procedure",
        );
        let controlled = step.procedure == DeckProcedure::DisplacementControl;
        self.require(
            controlled == step.control.is_some(),
            &key("control"),
            || {
                if controlled {
                    "the key `control` is missing: which displacement steers the load?".to_owned()
                } else {
                    "`control` belongs to the procedure \"displacement_control\"".to_owned()
                }
            },
            &if controlled {
                keys::example("control")
            } else {
                "say procedure = \"displacement_control\", or leave it out".to_owned()
            },
        );
        if let Some(control) = &step.control {
            self.demand(
                control.displacement.get() != 0.0,
                &key("control.displacement"),
                || "the displacement is 0".to_owned(),
                &keys::example("displacement"),
            );
            self.require(
                step.kind != StepKind::Free,
                &key("control"),
                || "a free step has no load to steer".to_owned(),
                "steer a preload, gravity, a tilt, a drive, or a load",
            );
        }
    }

    /// Checks `stop`: its conditions must be possible.
    fn stop(&mut self, path: &str, step: &DeckStep) {
        let key = |name: &str| format!("{path}.stop{name}");
        let Some(stop) = step.stop else { return };
        self.require(
            stop.below_peak.is_some() || stop.displacement.is_some(),
            &key(""),
            || "`stop` does not say at what".to_owned(),
            &keys::example("stop"),
        );
        if let Some(part) = stop.below_peak.map(Quantity::get) {
            self.require(
                part > 0.0 && part < 1.0,
                &key(".below_peak"),
                || format!("{part} is not between 0 and 1"),
                "the part of its peak to which the force falls: below_peak = 0.8",
            );
        }
        if let Some(by) = stop.displacement
            && step.kind == StepKind::Drive
        {
            let (by, whole) = (by.get(), step.drive().abs());
            self.require(
                by > 0.0 && (by <= whole || step.amplitude.is_some()),
                &key(".displacement"),
                || format!("{by} mm is not above 0 and within the {whole} mm of the step"),
                "how far this step drives, without sign: displacement = \"3 mm\"",
            );
        }
    }

    /// Checks which keys are allowed and required for the kind of the step and of the scene.
    fn keys_of_kind(&mut self, path: &str, step: &DeckStep) {
        if !self.scene_is_known() {
            return;
        }
        use StepKind::{Drive, Free, Gravity, Load, Preload, Tilt};
        // Steps of a clamped wall without face or spring move the level beam on its top.
        let clamped = self.deck.clamped().is_some() || !self.deck.has_scene();
        let of_spring = step.spring.is_some() || step.settlement.is_some();
        let settles = step.settlement.is_some();
        // A beam of `[[beams]]` is pressed and driven like a face.
        let of_face = step.face.is_some() || step.beam.is_some();
        let of_beam = clamped && !of_face && !of_spring;
        let pushes: &[StepKind] = &[Preload, Drive];
        let weighs: &[StepKind] = &[Gravity, Tilt, Free];
        let once = step.cycles.is_none();
        let face = !of_beam && !of_spring && step.beam.is_none();
        let rule = |(name, given), kinds, here, needed| Rule {
            name,
            given,
            kinds,
            here,
            needed,
        };
        let rules = [
            rule(key!(step.top_pressure), &[Preload], of_beam, of_beam),
            rule(key!(step.pressure), &[Preload], !of_beam, !of_beam),
            rule(key!(step.direction), &[Drive], true, !settles),
            rule(key!(step.displacement), &[Drive], true, once),
            rule(key!(step.cycles), &[Drive], true, false),
            rule(key!(step.stop), &[Drive, Load], true, false),
            rule(key!(step.vertical), &[Drive], of_beam, false),
            rule(key!(step.face), pushes, true, face),
            rule(key!(step.beam), pushes, true, false),
            rule(key!(step.free), pushes, !of_beam, false),
            rule(key!(step.spring), &[Drive], true, false),
            rule(key!(step.settlement), &[Drive], true, false),
            rule(key!(step.gravity), &[Gravity, Free], true, false),
            rule(key!(step.angle), weighs, true, step.kind == Tilt),
            rule(key!(step.axis), weighs, true, false),
        ];
        for rule in &rules {
            self.rule(path, step.kind, rule, of_beam);
        }
        self.beam(path, step);
        self.require(
            !of_spring || (step.face.is_none() && step.free.is_none()),
            &format!("{path}.spring"),
            || "a drive moves either a face or a spring".to_owned(),
            "make the other a step of its own",
        );
        let others = [&step.spring, &step.beam].iter().any(|o| o.is_some());
        let others = others || step.face.is_some() || step.free.is_some();
        self.require(
            !settles || !others,
            &format!("{path}.settlement"),
            || "a drive moves either the ground, a face, a beam or a spring".to_owned(),
            "make the other a step of its own",
        );
    }

    /// Checks a key of a step of this kind, which moves the level beam of a wall if `of_beam`.
    fn rule(&mut self, path: &str, kind: StepKind, rule: &Rule<'_>, of_beam: bool) {
        let (name, given, kinds) = (rule.name, rule.given, rule.kinds);
        let path_of_key = format!("{path}.{name}");
        let known = kinds.contains(&kind);
        self.require(
            !given || known,
            &path_of_key,
            || {
                let own: Vec<&str> = kinds.iter().map(|k| k.name()).collect();
                let (own, kind) = (own.join(" or "), kind.name());
                format!("`{name}` belongs to a {own}, and this step is a {kind}")
            },
            "leave it out here, or make it a step of its own",
        );
        let (other, help) = if of_beam {
            (
                "a face, and this step is of the level beam of the wall",
                "of the beam: `top_pressure`, `vertical`; or name a `face`",
            )
        } else {
            (
                "the level beam of a clamped wall",
                "of faces: `face`, `pressure`, `free`",
            )
        };
        self.require(
            !given || !known || rule.here,
            &path_of_key,
            || format!("`{name}` is of {other}"),
            help,
        );
        self.missing(path, name, rule.needed && known && rule.here && !given);
    }

    /// Checks a step that moves a beam of `[[beams]]`.
    fn beam(&mut self, path: &str, step: &DeckStep) {
        let Some(name) = &step.beam else { return };
        let key = |name: &str| format!("{path}.{name}");
        self.require(
            step.face.is_none() && step.spring.is_none(),
            &key("beam"),
            || "a step moves either a beam, a face or a spring".to_owned(),
            "make the other a step of its own",
        );
        let mut beams = self.deck.beams.iter();
        let turns = beams.any(|beam| beam.name == *name && beam.rotation == Turning::Free);
        self.require(
            !turns || step.free.is_none(),
            &key("free"),
            || format!("`{name}` turns and moves freely but for what drives it"),
            "leave it out; `free` is of beams that stay level",
        );
        let upright = step
            .direction
            .is_some_and(|direction| direction.unit()[2] != 0.0);
        self.require(
            !(turns && upright && step.kind == StepKind::Drive),
            &key("direction"),
            || format!("`{name}` may rotate and cannot be driven vertically"),
            "press it by a preload, drive it along x or y; rotation = \"level\" may be driven along z",
        );
    }
}
