//! Ranges of `[materials]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::schema::registry::SOLIDS;
use crate::deck::schema::{Material, Row, SolidKind};
use crate::material::{CrackBand, MaterialParameters};

/// Part of the tensile strength of the sharp cone up to which the surface is smooth enough for a return map.
const LARGEST_PART: f64 = 0.95;

impl Checks<'_> {
    pub(super) fn material(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("E"), m.E);
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
            m.crack_band != Some(CrackBand::Projected) || m.reference_length.is_some(),
            &key("crack_band"),
            || "a band has nothing to be set against: reference_length is missing".to_owned(),
            "give reference_length, the width of the band for which the tables hold",
        );
        self.tables(path, m);
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

    /// Checks the tables of damage plasticity: both are given, or neither.
    fn tables(&mut self, path: &str, m: &Material) {
        let key = |name: &str| format!("{path}.{name}");
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
                    keys::example(missing)
                ),
            );
        }
        self.table(&key("tension"), &m.tension);
        self.table(&key("compression"), &m.compression);
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
