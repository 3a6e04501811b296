//! Ranges of `[interfaces]`.

use super::{Checks, Given as _};
use crate::deck::keys;
use crate::deck::quantity::Quantity;
use crate::deck::schema::joint_kinds::KIND_KEYS;
use crate::deck::schema::{Interface, JointKind, Scatter};
use wythe_contact::CapCurve;

/// Largest coefficient of variation of bond strengths: measured ones are below 1.
const MOST_SCATTER: f64 = 2.0;

/// Softening of a joint: its ultimate displacement or the energy below the curve, which follow from each other.
struct Softening {
    /// Keys of displacement and energy.
    keys: [&'static str; 2],
    values: [Option<f64>; 2],
    /// Key and value of the strength.
    strength: (&'static str, f64),
}

impl Checks<'_> {
    pub(super) fn interface(&mut self, path: &str, f: &Interface) {
        let key = |name: &str| format!("{path}.{name}");
        self.not_negative(&key("f_t"), f.f_t);
        self.not_negative(&key("c"), f.c);
        self.not_negative(&key("tan_phi"), f.tan_phi);
        self.not_negative(&key("mu"), f.mu);
        self.positive(&key("penalty_factor"), f.penalty_factor);
        self.positive(&key("normal_stiffness"), f.normal_stiffness);
        self.positive(&key("shear_stiffness"), f.shear_stiffness);
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
        self.keys_of_joint(path, f);
        self.scatter(path, f);
        match f.kind {
            JointKind::Cap => self.cap(path, f),
            JointKind::CohesiveFrictional => self.cohesive(path, f),
        }
    }

    fn scatter(&mut self, path: &str, f: &Interface) {
        let Some(Scatter { cv, .. }) = f.scatter else {
            return;
        };
        let cv = cv.get();
        self.demand(
            cv > 0.0 && cv < MOST_SCATTER,
            &format!("{path}.scatter.cv"),
            || format!("{cv} is not above 0 and below {MOST_SCATTER}"),
            "give the standard deviation over the mean, such as 0.3; without scatter leave the table out",
        );
        self.require(
            !f.is_dry(),
            &format!("{path}.scatter"),
            || "there is no bond that could scatter: f_t and c are 0".to_owned(),
            "leave `scatter` out, or give f_t and c",
        );
    }

    /// Ranges of `kind = "cohesive-frictional"`.
    fn cohesive(&mut self, path: &str, f: &Interface) {
        let dry = f.is_dry();
        for (name, value) in [("zeta", f.zeta), ("xi", f.xi)] {
            self.positive(&format!("{path}.{name}"), value);
            self.missing(path, name, value.is_none() && !dry);
        }
        let opening = Softening {
            keys: ["u_k", "G_I"],
            values: [f.u_k.given(), f.G_I.given()],
            strength: ("f_t", f.tensile_strength()),
        };
        let slip = Softening {
            keys: ["delta_k", "G_II"],
            values: [f.delta_k.given(), f.G_II.given()],
            strength: ("c", f.cohesion()),
        };
        self.either(path, &opening, dry);
        self.either(path, &slip, dry);
    }

    /// Rejects keys of another law, and asks for those that this law requires.
    fn keys_of_joint(&mut self, path: &str, f: &Interface) {
        for key in &KIND_KEYS {
            let needed = f.kind.requires().contains(&key.name);
            self.missing(path, key.name, needed && !(key.is_given)(f));
            self.require(
                key.kinds.contains(&f.kind) || !(key.is_given)(f),
                &format!("{path}.{}", key.name),
                || {
                    let its: Vec<_> = key.kinds.iter().map(|kind| kind.name()).collect();
                    let (name, own, its) = (key.name, f.kind.name(), its.join("\" or \""));
                    format!("`{name}` is a key of kind = \"{its}\", and this joint is \"{own}\"")
                },
                "leave it out, or give the joint a kind that reads it",
            );
        }
    }

    /// Ranges of `kind = "cap"`.
    fn cap(&mut self, path: &str, f: &Interface) {
        let key = |name: &str| format!("{path}.{name}");
        let required = [
            ("G_I", f.G_I, f.tensile_strength() > 0.0),
            ("G_II", f.G_II, f.cohesion() > 0.0),
        ];
        for (name, value, needed) in required {
            self.positive(&key(name), value);
            self.missing(path, name, needed && value.is_none());
        }
        self.positive(&key("f_m"), f.f_m);
        self.positive(&key("kappa_p"), f.kappa_p);
        self.positive(&key("G_fc"), f.G_fc);
        self.positive(&key("C_nn"), f.C_nn);
        self.positive(&key("C_ss"), f.C_ss);
        self.not_negative(&key("tan_psi"), f.tan_psi);
        self.positive(&key("sigma_u"), f.sigma_u);
        self.not_negative(&key("delta"), f.delta);
        self.friction_of_cap(path, f);
        self.crushing(path, f);
    }

    /// Strength and dilatancy of a cap joint that its friction allows.
    fn friction_of_cap(&mut self, path: &str, f: &Interface) {
        let (f_t, c) = (f.tensile_strength(), f.cohesion());
        let steeper = f.initial_friction().max(f.residual_friction());
        self.require(
            f_t * steeper <= c,
            &format!("{path}.f_t"),
            || {
                let most = c / steeper;
                format!("{f_t} MPa is above {most:.4} MPa, where friction ends: c over the larger of tan_phi and mu")
            },
            "give a larger c or a smaller f_t",
        );
        let (tan_psi, least) = (
            f.tan_psi.map_or(0.0, Quantity::get),
            f.initial_friction().min(f.residual_friction()),
        );
        self.require(
            tan_psi <= least,
            &format!("{path}.tan_psi"),
            || {
                format!(
                    "{tan_psi} is above the friction {least}: slip under pressure would give energy"
                )
            },
            "give at most the smaller of tan_phi and mu",
        );
    }

    /// Energy and strength in compression that a cap joint needs.
    fn crushing(&mut self, path: &str, f: &Interface) {
        let (Some(f_m), Some(kappa_p), Some(g_fc)) = (f.f_m, f.kappa_p, f.G_fc) else {
            return;
        };
        let (f_m, kappa_p, g_fc) = (f_m.get(), kappa_p.get(), g_fc.get());
        let spent = CapCurve::RISING * f_m * kappa_p;
        self.require(
            g_fc > spent,
            &format!("{path}.G_fc"),
            || format!("{g_fc} N/mm is not above the {spent:.4} N/mm that are spent before the peak at kappa_p"),
            "give a larger G_fc or a smaller kappa_p",
        );
        let [_, c_ss] = f.cap_weights();
        let c = f.cohesion();
        let (needed, residual) = (c * c_ss.sqrt(), CapCurve::RESIDUAL * f_m);
        self.require(
            needed <= residual,
            &format!("{path}.C_ss"),
            || {
                format!(
                    "the crushed cap, f_m/7 = {residual:.4} MPa, does not hold the cohesion: c sqrt(C_ss) = {needed:.4} MPa"
                )
            },
            &format!("give C_ss at most {:.3}, or a smaller c", (residual / c) * (residual / c)),
        );
    }

    /// Requires exactly one of an ultimate displacement and the energy below the curve, unless the joint is dry.
    fn either(&mut self, path: &str, softening: &Softening, dry: bool) {
        let Softening {
            keys: [length, energy],
            values,
            strength: (strength_name, strength),
        } = *softening;
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
                &keys::example(length),
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
}
