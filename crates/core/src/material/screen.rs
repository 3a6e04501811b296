//! Screening of an element's eight points for those that certainly remain elastic, with the points innermost.
//!
//! The yield function of an undamaged point needs only its largest principal stress. The first test uses the bound
//! σ_max ≤ σ_m + ⅔ q. If that does not suffice, the value is computed from the trigonometric form of the cubic,
//!
//! ```text
//! 4c³ − 3c = |cos 3θ| = 27 |J₃| / 2q³,   c in [√3/2, 1]
//! σ_max = σ_m + ⅔ q c  (J₃ ≥ 0),   σ_m + ⅓ q (c + √3 √(1−c²))  (J₃ < 0)
//! ```
//!
//! which loses half of its digits where two principal values coincide (c = 1). A margin compensates this. Points that
//! remain undecided are left to the law.

use super::damage_plasticity::DamagePlasticity;
use super::parameters::ElasticParameters;
use super::{Material, SolidLaw};
use crate::tensor::ByPoint;

/// Error bound of the largest principal stress divided by q: √ε is 1.5e-8, times a few rounding errors.
const MARGIN: f64 = 1e-6;

/// The yield function of a point in its initial state.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstYield {
    /// 3α.
    pub by_mean: f64,
    /// β; negative if there is no bound.
    pub by_largest: f64,
    /// γ, used if the largest principal stress is negative.
    pub by_negative: f64,
    /// (1−α) σ̄_c [MPa].
    pub strength: f64,
}

impl Material {
    /// Elastic stresses C₀ : ε [MPa], and a bit for each point that remains elastic if it is in its initial state.
    #[inline(always)]
    pub(crate) fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        match self {
            Self::Elastic(e) => elastic(e, strain),
            Self::DamagePlasticity(law) => law.screen(strain),
            Self::DruckerPrager(law) => law.screen(strain),
            Self::Custom(law) => law.screen(strain),
        }
    }
}

/// For linear elasticity: all points with finite strain.
#[inline(always)]
pub(super) fn elastic(parameters: &ElasticParameters, strain: &ByPoint) -> (ByPoint, u8) {
    let stress = hooke_by_point(parameters, strain);
    // Values that are not finite are reported by the law.
    let finite: [bool; 8] = std::array::from_fn(|g| strain.iter().all(|e| e[g].is_finite()));
    (stress, bits(&finite))
}

impl DamagePlasticity {
    #[inline(always)]
    pub(super) fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        let stress = hooke_by_point(&self.elastic, strain);
        let first = &self.first_yield;
        if first.by_largest < 0.0 {
            return (stress, 0);
        }
        let mut mean = [0.0; 8];
        let mut q = [0.0; 8];
        let mut elastic = [false; 8];
        // Loops without closures: closures are compiled without vector instructions
        // (docs/decisions/vector-instructions.md).
        for g in 0..8 {
            mean[g] = (stress[0][g] + stress[1][g] + stress[2][g]) / 3.0;
            let (x, y, z) = (
                stress[0][g] - mean[g],
                stress[1][g] - mean[g],
                stress[2][g] - mean[g],
            );
            let (a, b, c) = (stress[3][g], stress[4][g], stress[5][g]);
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
    /// Whether (1−α) F ≤ 0 at these invariants [MPa]. `largest` is the largest principal stress or an upper bound; F
    /// increases with it. False if a value is not finite.
    #[inline(always)]
    fn holds(&self, q: f64, mean: f64, largest: f64) -> bool {
        let slope = if largest >= 0.0 {
            self.by_largest
        } else {
            self.by_negative
        };
        q + self.by_mean * mean + slope * largest <= self.strength
    }
}

/// Largest principal value of the deviator at point `g` with invariants `mean` and `q` [MPa].
#[inline(always)]
fn largest_deviatoric(stress: &ByPoint, g: usize, mean: f64, q: f64) -> f64 {
    let (x, y, z) = (
        stress[0][g] - mean,
        stress[1][g] - mean,
        stress[2][g] - mean,
    );
    let (a, b, c) = (stress[3][g], stress[4][g], stress[5][g]);
    let j3 = x * (y * z - b * b) - a * (a * z - b * c) + c * (a * b - y * c);
    let third = q / 3.0;
    let cube = third * third * third;
    // Zero stress gives w = 0.
    let w = 0.5 * j3.abs() / if cube > 0.0 { cube } else { 1.0 };
    let w = if w < 1.0 { w } else { 1.0 };
    // The start of `tensor` has an error of 4e-5, and each Newton step doubles the number of digits.
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
pub(super) fn hooke_by_point(elastic: &ElasticParameters, e: &ByPoint) -> ByPoint {
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

/// Bit g for each point that is true.
#[inline(always)]
pub(super) fn bits(of: &[bool; 8]) -> u8 {
    let mut bits = 0;
    for g in 0..8 {
        bits |= u8::from(of[g]) << g;
    }
    bits
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3, Vector6};

    use super::*;
    use crate::material::sample::brick;
    use crate::material::{DamagePlasticityParameters, MaterialHistory, hooke};

    fn parameters(tension: f64, k_c: f64) -> DamagePlasticityParameters {
        DamagePlasticityParameters {
            k_c,
            ..brick(
                &[[tension, 0.0, 0.0], [0.1, 0.002, 0.9]],
                &[[11.0, 0.0, 0.0], [0.6, 0.007, 0.9]],
            )
        }
    }

    /// Principal values where the bounds are sharp, where values coincide, and where all are zero.
    const CASES: [[f64; 3]; 10] = [
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0, 1.0, 1.0],
        [-1.0, 0.0, 0.0],
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [0.3, -0.2, -1.0],
        [-0.1, -0.1, -1.0],
    ];

    /// Points that the screen calls elastic are elastic by the law, and points well inside the surface are
    /// recognised: on both sides of the surface, exactly on it, and in all directions.
    #[expect(
        clippy::too_many_lines,
        reason = "one loop over materials and directions"
    )]
    #[test]
    fn screening_is_safe_and_sharp() {
        let mut screened = 0;
        for (k_c, tension) in [(2.0 / 3.0, 3.5), (0.51, 1.0), (1.0, 6.0), (0.7, 8.0)] {
            let p = parameters(tension, k_c);
            let (law, _) = DamagePlasticity::new(&p, None).expect("a sound table");
            for (n, case) in CASES.iter().enumerate() {
                let turn = match n % 3 {
                    0 => Rotation3::identity(),
                    1 => Rotation3::new(Vector3::new(0.4, -1.0, 0.3)),
                    _ => Rotation3::new(Vector3::new(1e-8, 0.0, 1e-5)),
                };
                let m = turn.matrix()
                    * nalgebra::Matrix3::from_diagonal(&Vector3::from(*case))
                    * turn.matrix().transpose();
                // Strain for this stress: ε = σ (1+ν)/E − ν/E tr σ.
                let trace = case.iter().sum::<f64>() * 0.15 / 16700.0;
                let by = 1.15 / 16700.0;
                let strain = Vector6::new(
                    by * m[(0, 0)] - trace,
                    by * m[(1, 1)] - trace,
                    by * m[(2, 2)] - trace,
                    2.0 * by * m[(0, 1)],
                    2.0 * by * m[(1, 2)],
                    2.0 * by * m[(2, 0)],
                );
                let f =
                    |size: f64| law.yield_function(&hooke(&p.elastic, &(strain * size)), 0.0, 0.0);
                let (mut low, mut high) = (0.0, 1000.0);
                if f(high) <= 0.0 {
                    continue; // never yields
                }
                while high - low > f64::EPSILON * high {
                    let middle = 0.5 * (low + high);
                    *(if f(middle) > 0.0 { &mut high } else { &mut low }) = middle;
                }
                let sizes = [
                    0.0,
                    0.5 * low,
                    low * (1.0 - 1e-4),
                    low * (1.0 - 1e-7),
                    low,
                    high,
                    high * (1.0 + 1e-7),
                    2.0 * high,
                ];
                let lanes: ByPoint =
                    std::array::from_fn(|k| std::array::from_fn(|g| strain[k] * sizes[g]));
                let (stress, elastic) =
                    Material::DamagePlasticity(Box::new(law.clone())).screen(&lanes);
                for (g, size) in sizes.iter().enumerate() {
                    let one = strain * *size;
                    let old = MaterialHistory::default();
                    let answer = law.update(&one, &old, 1.0, false).expect("an answer");
                    if elastic & (1 << g) != 0 {
                        screened += 1;
                        assert_eq!(answer.history.kappa_t + answer.history.kappa_c, 0.0);
                        for k in 0..6 {
                            // Tolerance: rounding of the same sums.
                            let error = (stress[k][g] - answer.stress[k]).abs();
                            assert!(error <= 1e-14 * answer.stress.amax(), "{case:?} {g}");
                        }
                    } else {
                        assert!(
                            g > 2,
                            "{case:?} at {size}, k_c {k_c}: well inside, not screened"
                        );
                    }
                }
                let broken: ByPoint = lanes.map(|row| row.map(|e| e * f64::NAN));
                let material = Material::DamagePlasticity(Box::new(law.clone()));
                assert_eq!(material.screen(&broken).1, 0);
                assert_eq!(Material::Elastic(p.elastic).screen(&broken).1, 0);
                assert_eq!(Material::Elastic(p.elastic).screen(&lanes).1, 0xff);
            }
        }
        assert!(screened > 100, "{screened}");
    }
}
