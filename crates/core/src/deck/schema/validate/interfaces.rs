//! Ranges of `[interfaces]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{Interface, JointKind, Scatter};
use wythe_contact::{CapCurve, Coupling};

/// Largest coefficient of variation of bond strengths: measured ones are below 1.
const MOST_SCATTER: f64 = 2.0;

impl Checks<'_> {
    pub(super) fn interface(&mut self, path: &str, f: &Interface) {
        let key = |name: &str| format!("{path}.{name}");
        self.not_negative(&key("f_t"), f.f_t);
        self.not_negative(&key("c"), f.c);
        self.not_negative(&key("tan_phi"), f.tan_phi);
        self.not_negative(&key("mu"), f.mu);
        if let Some(factor) = f.penalty_factor {
            self.positive(&key("penalty_factor"), factor);
        }
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
        self.keys_of_joint(path, f);
        let dry = f.is_dry();
        if let Some(Scatter { cv, .. }) = f.scatter {
            let cv = cv.get();
            self.demand(
                cv > 0.0 && cv < MOST_SCATTER,
                &key("scatter.cv"),
                || format!("{cv} is not above 0 and below {MOST_SCATTER}"),
                "give the standard deviation over the mean, such as 0.3; without scatter leave the table out",
            );
            self.require(
                !dry,
                &key("scatter"),
                || "there is no bond that could scatter: f_t and c are 0".to_owned(),
                "leave `scatter` out, or give f_t and c",
            );
        }
        if f.kind == JointKind::Cap {
            self.cap(path, f);
            return;
        }
        for (name, value) in [("zeta", f.zeta), ("xi", f.xi)] {
            match value {
                Some(value) => self.positive(&key(name), value),
                None => self.require(
                    dry,
                    &key(name),
                    || format!("the key `{name}` is missing"),
                    &keys::example(name),
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

    /// Rejects keys of another law.
    fn keys_of_joint(&mut self, path: &str, f: &Interface) {
        let of_cap = [
            ("f_m", f.f_m.is_some()),
            ("G_fc", f.G_fc.is_some()),
            ("kappa_p", f.kappa_p.is_some()),
            ("C_nn", f.C_nn.is_some()),
            ("C_ss", f.C_ss.is_some()),
            ("tan_psi", f.tan_psi.is_some()),
            ("sigma_u", f.sigma_u.is_some()),
            ("delta", f.delta.is_some()),
        ];
        let of_cohesive = [
            ("zeta", f.zeta.is_some()),
            ("xi", f.xi.is_some()),
            ("u_k", f.u_k.is_some()),
            ("delta_k", f.delta_k.is_some()),
            ("coupling", f.coupling != Coupling::default()),
        ];
        let (others, kind): (&[_], _) = match f.kind {
            JointKind::CohesiveFrictional => (&of_cap, JointKind::Cap),
            JointKind::Cap => (&of_cohesive, JointKind::CohesiveFrictional),
        };
        for (name, given) in others {
            self.require(
                !given,
                &format!("{path}.{name}"),
                || {
                    let (own, its) = (f.kind.name(), kind.name());
                    format!("`{name}` is a key of kind = \"{its}\", and this joint is \"{own}\"")
                },
                "leave it out, or give the joint the other kind",
            );
        }
    }

    /// Ranges of `kind = "cap"`.
    fn cap(&mut self, path: &str, f: &Interface) {
        let key = |name: &str| format!("{path}.{name}");
        let required = [
            ("G_I", f.G_I, f.f_t.get() > 0.0),
            ("G_II", f.G_II, f.c.get() > 0.0),
            ("G_fc", f.G_fc, true),
        ];
        for (name, value, needed) in required {
            match value {
                Some(value) => self.positive(&key(name), value),
                None => self.missing(path, name, needed),
            }
        }
        match f.f_m {
            Some(value) => self.positive(&key("f_m"), value),
            None => self.missing(path, "f_m", true),
        }
        match f.kappa_p {
            Some(value) => self.positive(&key("kappa_p"), value),
            None => self.missing(path, "kappa_p", true),
        }
        for (name, value) in [("C_nn", f.C_nn), ("C_ss", f.C_ss)] {
            if let Some(value) = value {
                self.positive(&key(name), value);
            }
        }
        if let Some(value) = f.tan_psi {
            self.not_negative(&key("tan_psi"), value);
        }
        if let Some(value) = f.sigma_u {
            self.positive(&key("sigma_u"), value);
        }
        if let Some(value) = f.delta {
            self.not_negative(&key("delta"), value);
        }
        let (f_t, c) = (f.f_t.get(), f.c.get());
        let steeper = f.tan_phi.get().max(f.mu.get());
        self.require(
            f_t * steeper <= c,
            &key("f_t"),
            || {
                let most = c / steeper;
                format!("{f_t} MPa is above {most:.4} MPa, where friction ends: c over the larger of tan_phi and mu")
            },
            "give a larger c or a smaller f_t",
        );
        let (tan_psi, least) = (
            f.tan_psi.map_or(0.0, Quantity::get),
            f.tan_phi.get().min(f.mu.get()),
        );
        self.require(
            tan_psi <= least,
            &key("tan_psi"),
            || {
                format!(
                    "{tan_psi} is above the friction {least}: slip under pressure would give energy"
                )
            },
            "give at most the smaller of tan_phi and mu",
        );
        let (Some(f_m), Some(kappa_p), Some(g_fc)) = (f.f_m, f.kappa_p, f.G_fc) else {
            return;
        };
        let (f_m, kappa_p, g_fc) = (f_m.get(), kappa_p.get(), g_fc.get());
        let spent = CapCurve::RISING * f_m * kappa_p;
        self.require(
            g_fc > spent,
            &key("G_fc"),
            || format!("{g_fc} N/mm is not above the {spent:.4} N/mm that are spent before the peak at kappa_p"),
            "give a larger G_fc or a smaller kappa_p",
        );
        let [_, c_ss] = f.cap_weights();
        let (needed, residual) = (c * c_ss.sqrt(), CapCurve::RESIDUAL * f_m);
        self.require(
            needed <= residual,
            &key("C_ss"),
            || {
                format!(
                    "the crushed cap, f_m/7 = {residual:.4} MPa, does not hold the cohesion: c sqrt(C_ss) = {needed:.4} MPa"
                )
            },
            &format!("give C_ss at most {:.3}, or a smaller c", (residual / c) * (residual / c)),
        );
    }

    fn missing(&mut self, path: &str, name: &str, needed: bool) {
        self.require(
            !needed,
            &format!("{path}.{name}"),
            || format!("the key `{name}` is missing"),
            &keys::example(name),
        );
    }

    /// Requires exactly one of an ultimate displacement and the energy below the curve, unless the joint is dry.
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
