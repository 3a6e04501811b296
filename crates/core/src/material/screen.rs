//! Which of an element's eight points stay elastic with certainty: one pass with the points in lanes.
//!
//! The yield function of an intact point needs its largest principal stress alone. First a bound of it,
//! σ_max ≤ σ_m + ⅔ q; where that does not do, the value itself from the cubic's trigonometric form,
//!
//! ```text
//! 4c³ − 3c = |cos 3θ| = 27 |J₃| / 2q³,   c in [√3/2, 1]
//! σ_max = σ_m + ⅔ q c  (J₃ ≥ 0),   σ_m + ⅓ q (c + √3 √(1−c²))  (J₃ < 0)
//! ```
//!
//! which loses half of its digits where two values coincide (c = 1): a margin makes up for it. What is not
//! certain here is left to the law.

use super::Material;
use super::damage_plasticity::DamagePlasticity;
use super::parameters::ElasticParameters;
use crate::sym6::ByPoint;

/// Error that the largest principal stress may have, over q: √ε is 1.5e-8, and a few roundings are in it.
const MARGIN: f64 = 1e-6;

/// The yield function of a point that nothing has happened to.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstYield {
    /// 3α.
    pub by_mean: f64,
    /// β; negative where no bound holds.
    pub by_largest: f64,
    /// (1−α) σ̄_c [MPa].
    pub strength: f64,
}

impl Material {
    /// Elastic stresses C₀ : ε [MPa], and a bit for each point that stays elastic if nothing has happened
    /// to it before.
    #[inline(always)]
    pub(crate) fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        match self {
            Self::Elastic(e) => {
                let stress = hooke_by_point(e, strain);
                // What is not finite is reported by the law.
                let finite: [bool; 8] =
                    std::array::from_fn(|g| strain.iter().all(|e| e[g].is_finite()));
                (stress, bits(&finite))
            }
            Self::DamagePlasticity(law) => law.screen(strain),
        }
    }
}

impl DamagePlasticity {
    #[inline(always)]
    fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        let stress = hooke_by_point(&self.elastic, strain);
        let first = &self.first_yield;
        if first.by_largest < 0.0 {
            return (stress, 0);
        }
        let mut mean = [0.0; 8];
        let mut q = [0.0; 8];
        let mut elastic = [false; 8];
        for g in 0..8 {
            mean[g] = (stress[0][g] + stress[1][g] + stress[2][g]) / 3.0;
            let [x, y, z] = [0, 1, 2].map(|i| stress[i][g] - mean[g]);
            let [a, b, c] = [stress[3][g], stress[4][g], stress[5][g]];
            q[g] = (1.5 * (x * x + y * y + z * z + 2.0 * (a * a + b * b + c * c))).sqrt();
        }
        for g in 0..8 {
            let largest = mean[g] + 2.0 / 3.0 * q[g];
            elastic[g] = first.holds(q[g], mean[g], largest);
        }
        let certain = bits(&elastic);
        if certain == 0xff {
            return (stress, certain);
        }
        for g in 0..8 {
            let largest = mean[g] + largest_deviatoric(&stress, g, mean[g], q[g]) + MARGIN * q[g];
            elastic[g] = first.holds(q[g], mean[g], largest);
        }
        (stress, certain | bits(&elastic))
    }
}

impl FirstYield {
    /// Whether (1−α) F ≤ 0 at invariants [MPa]; not if one of them is not finite.
    #[inline(always)]
    fn holds(&self, q: f64, mean: f64, largest: f64) -> bool {
        // Where the largest is negative, γ takes something off: zero is a bound.
        let largest = if largest > 0.0 { largest } else { 0.0 };
        q + self.by_mean * mean + self.by_largest * largest <= self.strength
    }
}

/// Largest principal value of the deviator at point `g` of invariants `mean` and `q` [MPa].
#[inline(always)]
fn largest_deviatoric(stress: &ByPoint, g: usize, mean: f64, q: f64) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|i| stress[i][g] - mean);
    let [a, b, c] = [stress[3][g], stress[4][g], stress[5][g]];
    let j3 = x * (y * z - b * b) - a * (a * z - b * c) + c * (a * b - y * c);
    let third = q / 3.0;
    let cube = third * third * third;
    // A stress of zero has a w of zero.
    let w = 0.5 * j3.abs() / if cube > 0.0 { cube } else { 1.0 };
    let w = if w < 1.0 { w } else { 1.0 };
    // As in `sym6`: 4e-5 off, and each step of Newton doubles its digits.
    let mut c = 0.866_066_33 + w * (0.165_330_35 + w * (-0.040_691_2 + w * 0.009_319_68));
    for _ in 0..2 {
        c -= ((4.0 * c * c - 3.0) * c - w) / (12.0 * c * c - 3.0);
    }
    let across = 1.0 - c * c;
    let across = if across > 0.0 { across } else { 0.0 };
    let paired = c + 3.0_f64.sqrt() * across.sqrt();
    third * if j3 >= 0.0 { 2.0 * c } else { paired }
}

/// C₀ : ε.
#[inline(always)]
fn hooke_by_point(elastic: &ElasticParameters, e: &ByPoint) -> ByPoint {
    let shear = elastic.shear_modulus();
    let lame = elastic.bulk_modulus() - 2.0 / 3.0 * shear;
    let mut stress = [[0.0; 8]; 6];
    for g in 0..8 {
        let volume = lame * (e[0][g] + e[1][g] + e[2][g]);
        for i in 0..3 {
            stress[i][g] = volume + 2.0 * shear * e[i][g];
            stress[3 + i][g] = shear * e[3 + i][g];
        }
    }
    stress
}

/// Bit g of each point that is true.
#[inline(always)]
fn bits(of: &[bool; 8]) -> u8 {
    of.iter()
        .enumerate()
        .fold(0, |bits, (g, &one)| bits | (u8::from(one) << g))
}
