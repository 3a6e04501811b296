//! Ranges of `[materials]`.

use super::{Checks, Given as _};
use crate::deck::catalogue::Sort;
use crate::deck::keys;
use crate::deck::quantity::Number;
use crate::deck::schema::registry::SOLIDS;
use crate::deck::schema::{Material, Row, SolidKind};
use crate::material::{Branch, CrackBand, MaterialParameters};

/// Part of the tensile strength of the sharp cone up to which the surface is smooth enough for a return map.
const LARGEST_PART: f64 = 0.95;

/// The two forms of a curve of damage plasticity: a table, or a strength with a fracture energy.
struct Form {
    table: &'static str,
    strength: &'static str,
    energy: &'static str,
    has_table: fn(&Material) -> bool,
    /// Strength [MPa] and energy [N/mm].
    given: fn(&Material) -> [Option<f64>; 2],
}

impl Form {
    /// Whether one of strength and energy is given without the other.
    fn is_half(&self, m: &Material) -> bool {
        let [strength, energy] = (self.given)(m);
        strength.is_some() != energy.is_some()
    }
}

/// Tension and compression.
const EITHER: [Form; 2] = [
    Form {
        table: "tension",
        strength: "f_t",
        energy: "G_ft",
        has_table: |m| !m.tension.is_empty(),
        given: |m| [m.f_t.given(), m.G_ft.given()],
    },
    Form {
        table: "compression",
        strength: "f_c",
        energy: "G_fc",
        has_table: |m| !m.compression.is_empty(),
        given: |m| [m.f_c.given(), m.G_fc.given()],
    },
];

impl Checks<'_> {
    pub(super) fn material(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("E"), m.E);
        self.positive(&key("f_b"), m.f_b);
        self.strength_by_test(path, m);
        let nu = m.nu.get();
        self.demand(
            nu > -1.0 && nu < 0.5,
            &key("nu"),
            || format!("Poisson's ratio {nu} is not between -1 and 0.5"),
            "brick and mortar have about 0.15",
        );
        self.not_negative(&key("density"), m.density);
        self.keys_of_its_law(path, m);
        match m.kind {
            SolidKind::DamagePlasticity => {}
            SolidKind::DruckerPrager => self.drucker_prager(path, m),
        }
        self.surface(path, m);
        self.within(&key("tension_recovery"), m.tension_recovery, 0.0..=1.0);
        self.within(
            &key("compression_recovery"),
            m.compression_recovery,
            0.0..=1.0,
        );
        self.not_negative(&key("viscosity"), m.viscosity);
        self.positive(&key("reference_length"), m.reference_length);
        self.demand(
            m.crack_band != Some(CrackBand::Projected)
                || m.reference_length.is_some()
                || m.has_energies(),
            &key("crack_band"),
            || "`crack_band` needs `reference_length`".to_owned(),
            "give reference_length, the width of the band for which the tables hold",
        );
        if m.kind == SolidKind::DamagePlasticity {
            self.energies(path, m);
        }
        self.tables(path, m);
    }

    /// Requires that `f_b` stands beside the name of a unit, from which other values follow.
    fn strength_by_test(&mut self, path: &str, m: &Material) {
        let named = m.name.as_deref().map(Sort::of);
        let (message, help) = match named {
            _ if m.f_b.is_none() => return,
            Some(Some(Sort::Unit) | None) => return,
            None => (
                "`f_b` is read beside `name` only, whose values follow from it",
                "give `name` (docs/reference/materials.md), or the strength as f_c with G_fc",
            ),
            Some(Some(Sort::Mortar)) => (
                "`f_b` is the strength of a unit, and this is a mortar",
                "give the strength of the mortar as f_c",
            ),
        };
        self.require(false, &format!("{path}.f_b"), || message.to_owned(), help);
    }

    /// Ranges of the yield surface and the flow potential of damage plasticity.
    fn surface(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        let psi = m.dilation_angle.get();
        // ψ = 0 or eccentricity = 0 gives the flow potential a vertex: a = ε σ_t0 tan ψ
        // (theory/damage-plasticity.md, eq. 6).
        self.demand(
            psi > 0.0 && psi < 90.0,
            &key("dilation_angle"),
            || format!("{psi} degrees is not between 0 and 90"),
            "the paper takes \"10 deg\"; without dilation take a small angle such as \"0.1 deg\"",
        );
        self.positive(&key("eccentricity"), m.eccentricity);
        let ratio = m.fb0_fc0.get();
        self.demand(
            ratio >= 1.0,
            &key("fb0_fc0"),
            || format!("{ratio} is below 1: biaxial below uniaxial strength"),
            "1.16 is usual",
        );
        let k_c = m.K_c.get();
        self.demand(
            k_c > 0.5 && k_c <= 1.0,
            &key("K_c"),
            || format!("{k_c} is not above 0.5 and at most 1"),
            "2/3 is usual",
        );
    }

    /// Checks the curves of damage plasticity: both are given, in any form, or neither.
    fn tables(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        let damage = m.kind == SolidKind::DamagePlasticity;
        let by_energy = |branch| damage && m.by_energy(branch).is_some();
        let t = m.tension.is_empty() && !by_energy(Branch::Tension);
        let c = m.compression.is_empty() && !by_energy(Branch::Compression);
        let half = damage && EITHER.iter().any(|form| form.is_half(m));
        if t != c && !half {
            let (given, missing) = if c { (0, 1) } else { (1, 0) };
            let (own, other) = (&EITHER[given], &EITHER[missing]);
            let (at, what) = if (own.has_table)(m) {
                (own.table, format!("the table `{}` is given", own.table))
            } else {
                (
                    own.energy,
                    format!("`{}` and `{}` are given", own.strength, own.energy),
                )
            };
            self.require(
                false,
                &key(at),
                || format!("{what}, the table `{}` is missing", other.table),
                &format!(
                    "{}; or give `{}` and `{}`; or leave out both for linear elasticity",
                    keys::example(other.table),
                    other.strength,
                    other.energy
                ),
            );
        }
        self.table(&key("tension"), &m.tension);
        self.table(&key("compression"), &m.compression);
    }

    /// Checks strengths and fracture energies of damage plasticity: each has its partner and no table beside it.
    fn energies(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        for form in &EITHER {
            let [strength, energy] = (form.given)(m);
            self.positive(&key(form.strength), strength.map(Number::new));
            self.positive(&key(form.energy), energy.map(Number::new));
            let (given, missing) = match [strength, energy] {
                [None, None] => continue,
                [Some(_), None] => (form.strength, form.energy),
                _ => (form.energy, form.strength),
            };
            if (form.has_table)(m) {
                self.require(
                    false,
                    &key(given),
                    || format!("`{given}` is given beside the table `{}`", form.table),
                    &format!(
                        "leave out the table, or leave out `{}` and `{}`: they say the same",
                        form.strength, form.energy
                    ),
                );
            } else if form.is_half(m) {
                self.require(
                    false,
                    &key(given),
                    || format!("`{given}` is given, `{missing}` is missing"),
                    &keys::example_at(&format!("materials.{missing}")),
                );
            }
        }
        let mixed = m.has_energies() && !(m.tension.is_empty() && m.compression.is_empty());
        self.require(
            !mixed || m.reference_length.is_some(),
            &key("reference_length"),
            || "a table beside a fracture energy needs `reference_length`, the width for which it holds".to_owned(),
            &keys::example("reference_length"),
        );
        self.first_yield(path, m);
    }

    /// Requires that the compressive strength by its energy is so far above the tensile strength that the yield
    /// surface has β ≥ 0 at first yield, f_c/3 (theory/damage-plasticity.md, eq. 3).
    fn first_yield(&mut self, path: &str, m: &Material) {
        let peak = m.tension.iter().map(|row| row.0.get());
        let by_energy = m.by_energy(Branch::Tension).map(|of| of.strength);
        let f_t = by_energy.or_else(|| peak.reduce(f64::max));
        let (Some(f_t), Some(of)) = (f_t, m.by_energy(Branch::Compression)) else {
            return;
        };
        let alpha = (m.fb0_fc0.get() - 1.0) / (2.0 * m.fb0_fc0.get() - 1.0);
        let least = 3.0 * f_t * (1.0 + alpha) / (1.0 - alpha);
        self.require(
            of.strength >= least || !(of.strength > 0.0 && f_t > 0.0 && (0.0..1.0).contains(&alpha)),
            &format!("{path}.f_c"),
            || {
                format!(
                    "{} MPa is below {least:.3} MPa, 3 (1 + α)/(1 − α) times the tensile strength: the material \
                     yields from f_c/3 on, and the yield surface needs more there",
                    of.strength
                )
            },
            "give a larger f_c, a smaller tensile strength, or the table `compression`",
        );
    }

    /// Ranges of hyperbolic Drucker–Prager plasticity.
    fn drucker_prager(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("c"), m.c);
        self.positive(&key("f_t"), m.f_t);
        self.positive(&key("G_I"), m.G_I);
        self.positive(&key("G_c"), m.G_c);
        let (Some(c), Some(phi), Some(f_t)) = (m.c, m.phi, m.f_t) else {
            return;
        };
        let degrees = phi.get();
        self.demand(
            degrees > 0.0 && degrees < 90.0,
            &key("phi"),
            || format!("{degrees} degrees is not between 0 and 90"),
            "soil has 25 to 40 degrees, stone 30 to 60",
        );
        if let Some(psi) = m.psi {
            let psi = psi.get();
            self.demand(
                psi > 0.0 && psi <= degrees,
                &key("psi"),
                || format!("{psi} degrees is not above 0 and at most phi = {degrees}"),
                "more would give energy away; without dilation take a small angle such as \"0.1 deg\"",
            );
        }
        let MaterialParameters::DruckerPrager(p) = m.parameters() else {
            return;
        };
        let (largest, f_t) = (p.largest_tensile_strength(), f_t.get());
        let sound = c.get() > 0.0 && degrees > 0.0 && degrees < 90.0;
        self.demand(
            !sound || f_t < LARGEST_PART * largest,
            &key("f_t"),
            || {
                format!(
                    "{f_t} MPa is not below {LARGEST_PART} times the {largest:.4} MPa that the sharp cone of c and \
                     phi carries in tension"
                )
            },
            "give less tensile strength, or more cohesion",
        );
    }

    /// Keys that the law does not read, and those that it lacks.
    fn keys_of_its_law(&mut self, path: &str, m: &Material) {
        let (law, given) = (m.kind.registered(), m.given());
        for key in &given {
            if law.keys.contains(&key.as_str()) {
                continue;
            }
            let of = SOLIDS
                .iter()
                .filter(|other| other.keys.contains(&key.as_str()));
            let of: Vec<String> = of.map(|other| format!("\"{}\"", other.name)).collect();
            self.require(
                false,
                &format!("{path}.{key}"),
                || format!("`{key}` is not read by kind = \"{}\"", law.name),
                &format!("leave `{key}` out, or say kind = {}", of.join(" or ")),
            );
        }
        for key in law.required {
            self.require(
                given.iter().any(|own| own == key),
                path,
                || format!("kind = \"{}\" needs `{key}`", law.name),
                &keys::example(key),
            );
        }
    }

    /// Checks rows of (stress, inelastic strain, damage) as far as they do not depend on the modulus. Other
    /// conditions (theory/damage-plasticity.md, eqs 10 and 11) are checked when the law is built.
    fn table(&mut self, path: &str, rows: &[Row]) {
        if self.broken.holds(path) {
            return;
        }
        let mut before = (f64::NEG_INFINITY, 0.0);
        for (i, Row(stress, strain, damage)) in rows.iter().enumerate() {
            let (stress, strain, damage) = (stress.get(), strain.get(), damage.get());
            let cell = |column: usize| format!("{path}.{i}.{column}");
            let row = i + 1;
            self.demand(
                stress > 0.0,
                &cell(0),
                || format!("row {row}: the stress {stress} is not positive"),
                "stresses are positive in tension and in compression; leave a residual strength, e.g. \
                 a hundredth of the peak",
            );
            if i == 0 {
                self.demand(
                    strain == 0.0,
                    &cell(1),
                    || format!("row 1: the inelastic strain is {strain}, not 0"),
                    "the first row is first yield: inelastic strain 0, damage 0",
                );
                self.demand(
                    damage == 0.0,
                    &cell(2),
                    || format!("row 1: the damage is {damage}, not 0"),
                    "the first row is first yield: inelastic strain 0, damage 0",
                );
            } else {
                self.demand(
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
                self.demand(
                    damage >= before.1,
                    &cell(2),
                    || format!("row {row}: the damage falls from {} to {damage}", before.1),
                    "damage never heals: let it grow from row to row",
                );
            }
            self.demand(
                (0.0..1.0).contains(&damage),
                &cell(2),
                || format!("row {row}: the damage {damage} is not admissible (0 <= damage < 1)"),
                "the paper ends at 0.95; above 0.99 nothing is left to compute with",
            );
            before = (strain, damage);
        }
        self.rises_to_its_peak(path, rows);
    }

    /// Requires that the stress rises up to the peak. Rows beyond the peak are scaled to the element
    /// (theory/crack-band.md, eq. 4), those before it are not, so that a fall before the peak would be softening
    /// that is not scaled.
    fn rises_to_its_peak(&mut self, path: &str, rows: &[Row]) {
        let stress = |i: usize| rows[i].0.get();
        let peak = (0..rows.len()).fold(0, |p, i| if stress(i) > stress(p) { i } else { p });
        let fall = (1..=peak).find(|&i| stress(i) < stress(i - 1));
        if let Some(i) = fall {
            let (low, high) = (stress(i), stress(peak));
            self.demand(
                false,
                &format!("{path}.{i}.0"),
                || {
                    format!(
                        "row {}: the stress falls to {low} before the peak of {high} in row {}",
                        i + 1,
                        peak + 1
                    )
                },
                "let the stress rise to one peak and fall after it",
            );
        }
    }
}
