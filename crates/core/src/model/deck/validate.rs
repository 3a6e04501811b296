//! Ranges of a deck, and what its keys demand of each other. Every error is found, not the first.

use super::{Deck, DeckStep, Direction, Interface, Material, Row, StepKind, Wall};
use crate::error::ModelError;
use crate::model::layout;
use crate::model::quantity::{Number, Quantity};

/// Errors found so far.
struct Checks<'a> {
    deck: &'a Deck,
    errors: Vec<ModelError>,
}

/// Checks all that needs no mesh.
///
/// # Errors
/// All values out of range and all contradictions, as one error.
pub(super) fn validate(deck: &Deck) -> Result<(), ModelError> {
    let mut checks = Checks {
        deck,
        errors: Vec::new(),
    };
    checks.require(
        deck.format == 1,
        "format",
        || format!("format {} is not known", deck.format),
        "this version reads format = 1",
    );
    for (name, material) in &deck.materials {
        checks.material(&format!("materials.{name}"), material);
    }
    for (name, interface) in &deck.interfaces {
        checks.interface(&format!("interfaces.{name}"), interface);
    }
    if let Some(wall) = &deck.wall {
        checks.wall(wall);
    }
    for (i, step) in deck.steps.iter().enumerate() {
        checks.step(&format!("steps.{i}"), step);
    }
    checks.require(
        deck.output.every > 0,
        "output.every",
        || "a frame every 0 increments means nothing".to_owned(),
        "1 writes every increment",
    );
    if let Some(radius) = deck.contact.search_radius {
        checks.positive("contact.search_radius", radius);
    }
    ModelError::gather(checks.errors).map_or(Ok(()), Err)
}

impl Checks<'_> {
    fn require(&mut self, ok: bool, path: &str, message: impl FnOnce() -> String, help: &str) {
        if !ok {
            self.errors.push(self.deck.error(path, message(), help));
        }
    }

    fn positive<const L: i8, const M: i8, const T: i8, const A: i8>(
        &mut self,
        path: &str,
        value: Quantity<L, M, T, A>,
    ) {
        let value = value.get();
        self.require(
            value > 0.0,
            path,
            || format!("{value} is not positive"),
            "give a value above 0",
        );
    }

    fn not_negative<const L: i8, const M: i8, const T: i8, const A: i8>(
        &mut self,
        path: &str,
        value: Quantity<L, M, T, A>,
    ) {
        let value = value.get();
        self.require(
            value >= 0.0,
            path,
            || format!("{value} is negative"),
            "give 0 or more",
        );
    }

    fn within(&mut self, path: &str, value: Number, range: std::ops::RangeInclusive<f64>) {
        let value = value.get();
        let (low, high) = (*range.start(), *range.end());
        self.require(
            range.contains(&value),
            path,
            || format!("{value} is not between {low} and {high}"),
            &format!("give a value from {low} to {high}"),
        );
    }

    fn material(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("E"), m.E);
        let nu = m.nu.get();
        self.require(
            nu > -1.0 && nu < 0.5,
            &key("nu"),
            || format!("Poisson's ratio {nu} is not between -1 and 0.5"),
            "brick and mortar have about 0.15",
        );
        self.not_negative(&key("density"), m.density);
        let psi = m.dilation_angle.get();
        // ψ = 0 or eccentricity = 0 puts a vertex in the flow potential (a = ε σ_t0 tan ψ, theory A.3)
        self.require(
            psi > 0.0 && psi < 90.0,
            &key("dilation_angle"),
            || format!("{psi} degrees is not between 0 and 90"),
            "the paper takes \"10 deg\"; without dilation take a small angle such as \"0.1 deg\"",
        );
        self.positive(&key("eccentricity"), m.eccentricity);
        let ratio = m.fb0_fc0.get();
        self.require(
            ratio >= 1.0,
            &key("fb0_fc0"),
            || format!("{ratio} is below 1: biaxial below uniaxial strength"),
            "1.16 is usual",
        );
        let k_c = m.K_c.get();
        self.require(
            k_c > 0.5 && k_c <= 1.0,
            &key("K_c"),
            || format!("{k_c} is not above 0.5 and at most 1"),
            "2/3 is usual",
        );
        self.within(&key("tension_recovery"), m.tension_recovery, 0.0..=1.0);
        self.within(
            &key("compression_recovery"),
            m.compression_recovery,
            0.0..=1.0,
        );
        self.not_negative(&key("viscosity"), m.viscosity);
        if let Some(length) = m.reference_length {
            self.positive(&key("reference_length"), length);
        }
        let (t, c) = (m.tension.is_empty(), m.compression.is_empty());
        if t != c {
            let (given, missing) = if c {
                ("tension", "compression")
            } else {
                ("compression", "tension")
            };
            self.require(
                false,
                &key(given),
                || format!("the table `{given}` is given, the table `{missing}` is missing"),
                &format!(
                    "{}; or leave out both for linear elasticity",
                    super::super::keys::example(missing)
                ),
            );
        }
        self.table(&key("tension"), &m.tension);
        self.table(&key("compression"), &m.compression);
    }

    /// Rows of (stress, inelastic strain, damage): what holds whatever the modulus. What depends on
    /// it (theory A.5) is checked where the law is built.
    fn table(&mut self, path: &str, rows: &[Row]) {
        let mut before = (f64::NEG_INFINITY, 0.0);
        for (i, Row(stress, strain, damage)) in rows.iter().enumerate() {
            let (stress, strain, damage) = (stress.get(), strain.get(), damage.get());
            let cell = |column: usize| format!("{path}.{i}.{column}");
            let row = i + 1;
            self.require(
                stress > 0.0,
                &cell(0),
                || format!("row {row}: the stress {stress} is not positive"),
                "stresses are positive in tension and in compression; leave a residual strength, e.g. \
                 a hundredth of the peak",
            );
            if i == 0 {
                self.require(
                    strain == 0.0,
                    &cell(1),
                    || format!("row 1: the inelastic strain is {strain}, not 0"),
                    "the first row is first yield: inelastic strain 0, damage 0",
                );
                self.require(
                    damage == 0.0,
                    &cell(2),
                    || format!("row 1: the damage is {damage}, not 0"),
                    "the first row is first yield: inelastic strain 0, damage 0",
                );
            } else {
                self.require(
                    strain > before.0,
                    &cell(1),
                    || {
                        format!(
                            "row {row}: the inelastic strain {strain} does not grow beyond {} of row {i}",
                            before.0
                        )
                    },
                    "order the rows by inelastic strain (total strain minus stress/E)",
                );
                self.require(
                    damage >= before.1,
                    &cell(2),
                    || format!("row {row}: the damage falls from {} to {damage}", before.1),
                    "damage never heals: let it grow from row to row",
                );
            }
            self.require(
                (0.0..1.0).contains(&damage),
                &cell(2),
                || format!("row {row}: the damage {damage} is not admissible (0 <= damage < 1)"),
                "the paper ends at 0.95; above 0.99 nothing is left to compute with",
            );
            before = (strain, damage);
        }
    }

    fn interface(&mut self, path: &str, f: &Interface) {
        let key = |name: &str| format!("{path}.{name}");
        self.not_negative(&key("f_t"), f.f_t);
        self.not_negative(&key("c"), f.c);
        self.not_negative(&key("tan_phi"), f.tan_phi);
        self.not_negative(&key("mu"), f.mu);
        self.positive(&key("penalty_factor"), f.penalty_factor);
        for (name, value) in [
            ("normal_stiffness", f.normal_stiffness),
            ("shear_stiffness", f.shear_stiffness),
        ] {
            if let Some(value) = value {
                self.positive(&key(name), value);
            }
        }
        if f.normal_stiffness.is_some() != f.shear_stiffness.is_some() {
            let given = if f.normal_stiffness.is_some() {
                "normal_stiffness"
            } else {
                "shear_stiffness"
            };
            self.require(
                false,
                &key(given),
                || "one stiffness is given without the other".to_owned(),
                "give both normal_stiffness and shear_stiffness, or neither and a penalty_factor",
            );
        }
        let dry = f.is_dry();
        for (name, value) in [("zeta", f.zeta), ("xi", f.xi)] {
            match value {
                Some(value) => self.positive(&key(name), value),
                None => self.require(
                    dry,
                    &key(name),
                    || format!("the key `{name}` is missing"),
                    &super::super::keys::example(name),
                ),
            }
        }
        let (u_k, delta_k) = (f.u_k.map(Quantity::get), f.delta_k.map(Quantity::get));
        let (g_1, g_2) = (f.G_I.map(Quantity::get), f.G_II.map(Quantity::get));
        self.either(path, ["u_k", "G_I"], [u_k, g_1], ("f_t", f.f_t.get()), dry);
        self.either(
            path,
            ["delta_k", "G_II"],
            [delta_k, g_2],
            ("c", f.c.get()),
            dry,
        );
    }

    /// An ultimate displacement or the energy below the curve: exactly one, unless the joint is dry.
    fn either(
        &mut self,
        path: &str,
        [length, energy]: [&str; 2],
        values: [Option<f64>; 2],
        (strength_name, strength): (&str, f64),
        dry: bool,
    ) {
        let key = |name: &str| format!("{path}.{name}");
        for (name, value) in [length, energy].into_iter().zip(values) {
            if let Some(value) = value {
                self.require(
                    value > 0.0,
                    &key(name),
                    || format!("{value} is not positive"),
                    "give a value above 0",
                );
            }
        }
        match values {
            [Some(_), Some(_)] => self.require(
                false,
                &key(energy),
                || format!("both `{length}` and `{energy}` are given"),
                "each follows from the other: leave out one (`wythe check` prints both)",
            ),
            [None, None] => self.require(
                dry,
                &key(length),
                || format!("neither `{length}` nor `{energy}` is given"),
                &super::super::keys::example(length),
            ),
            [None, Some(_)] => self.require(
                dry || strength > 0.0,
                &key(energy),
                || format!("`{length}` cannot follow from `{energy}` where `{strength_name}` is 0"),
                &format!("give `{length}`"),
            ),
            [Some(_), None] => {}
        }
    }

    fn wall(&mut self, wall: &Wall) {
        for (i, size) in wall.unit.into_iter().enumerate() {
            self.positive(&format!("wall.unit.{i}"), size);
        }
        self.positive("wall.bed_joint", wall.bed_joint);
        self.positive("wall.head_joint", wall.head_joint);
        self.positive("wall.length", wall.length);
        self.require(
            wall.courses > 0,
            "wall.courses",
            || "a wall has at least one course".to_owned(),
            "courses = 18",
        );
        let m = wall.mesh;
        self.require(
            m.length >= 2 && m.height >= 2 && m.thickness >= 1,
            "wall.mesh",
            || {
                let [l, h, t] = [m.length, m.height, m.thickness];
                format!("the subdivision [{l}, {h}, {t}] leaves no element for the unit")
            },
            "length and height count one joint element each: at least [2, 2, 1]; the paper's coarse \
             mesh is [5, 2, 2]",
        );
        let (bottom, top) = (wall.clamped.bottom_courses, wall.clamped.top_courses);
        let courses = wall.courses;
        if courses > 0 {
            // Held and driven nodes must differ: neither may be all of them, nor both overlap.
            let apart = u64::from(bottom) + u64::from(top) <= u64::from(courses);
            self.require(
                apart && bottom < courses && top < courses,
                "wall.clamped",
                || format!("{bottom} courses held and {top} driven are too many of {courses}"),
                "clamp fewer courses; 0 holds only the face",
            );
        }
        for (path, name) in [
            ("unit_material", &wall.unit_material),
            ("mortar_material", &wall.mortar_material),
        ] {
            if !self.deck.materials.contains_key(name) {
                let error =
                    self.deck
                        .unknown(&format!("wall.{path}"), "material", name, "materials");
                self.errors.push(error);
            }
        }
        if !self.deck.interfaces.contains_key(&wall.interface) {
            let error =
                self.deck
                    .unknown("wall.interface", "interface", &wall.interface, "interfaces");
            self.errors.push(error);
        }
        let sizes = [
            wall.bed_joint,
            wall.head_joint,
            wall.length,
            wall.unit[0],
            wall.unit[2],
        ];
        if sizes.iter().all(|s| s.get() > 0.0)
            && let Err(refusal) = layout::course_pattern(wall)
        {
            self.require(false, refusal.key, || refusal.message, &refusal.help);
        }
    }

    fn step(&mut self, path: &str, step: &DeckStep) {
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
                &super::super::keys::example(name),
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
                &super::super::keys::example("displacement"),
            );
        }
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
        self.positive(&key("tolerance.residual"), step.tolerance.residual);
        self.require(
            step.tolerance.max_iterations > 0,
            &key("tolerance.max_iterations"),
            || "no iteration is allowed".to_owned(),
            "max_iterations = 25",
        );
    }
}
