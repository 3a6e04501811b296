//! Ranges of `[interfaces]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{Interface, Scatter};

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
