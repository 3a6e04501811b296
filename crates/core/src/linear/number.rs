//! Number types of fronts: double or single precision.

use faer::traits::RealField;
use pulp::Simd;

/// A floating-point number and its vectors.
pub(super) trait Number: RealField + Copy + Send + Sync + 'static {
    /// A vector of it.
    type Vector<S: Simd>: Copy;
    /// Machine epsilon: twice the unit roundoff.
    const EPSILON: f64;
    const ZERO: Self;
    const ONE: Self;

    fn of(x: f64) -> Self;
    fn f64(self) -> f64;
    fn root(self) -> Self;
    /// A power of two that scales the largest of `x` to about one, for types in which small numbers would be lost.
    fn scale(x: &[f64]) -> f64;

    /// Count of numbers in a vector.
    fn lanes<S: Simd>() -> usize;
    /// Whole vectors and the rest.
    fn vectors<S: Simd>(x: &[Self]) -> (&[Self::Vector<S>], &[Self]);
    fn vectors_mut<S: Simd>(x: &mut [Self]) -> (&mut [Self::Vector<S>], &mut [Self]);
    fn splat<S: Simd>(simd: S, x: Self) -> Self::Vector<S>;
    fn minus<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn times<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn negative<S: Simd>(simd: S, a: Self::Vector<S>) -> Self::Vector<S>;
    /// a b + c, fused where the processor supports it.
    fn mul_add<S: Simd>(
        simd: S,
        a: Self::Vector<S>,
        b: Self::Vector<S>,
        c: Self::Vector<S>,
    ) -> Self::Vector<S>;
    fn sum<S: Simd>(simd: S, a: Self::Vector<S>) -> Self;
    /// Loads fewer numbers than a vector has, followed by zeros.
    fn load<S: Simd>(simd: S, x: &[Self]) -> Self::Vector<S>;
    fn store<S: Simd>(simd: S, x: &mut [Self], a: Self::Vector<S>);
}

macro_rules! number {
    ($t:ident, $v:ident, $lanes:ident, $as:ident, $as_mut:ident, $splat:ident, $sub:ident, $mul:ident,
     $neg:ident, $fma:ident, $sum:ident, $load:ident, $store:ident, $scale:expr) => {
        impl Number for $t {
            type Vector<S: Simd> = S::$v;
            const EPSILON: f64 = $t::EPSILON as f64;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn root(self) -> Self {
                self.sqrt()
            }
            fn scale(x: &[f64]) -> f64 {
                $scale(x)
            }
            #[inline(always)]
            fn lanes<S: Simd>() -> usize {
                S::$lanes
            }
            #[inline(always)]
            fn vectors<S: Simd>(x: &[Self]) -> (&[S::$v], &[Self]) {
                S::$as(x)
            }
            #[inline(always)]
            fn vectors_mut<S: Simd>(x: &mut [Self]) -> (&mut [S::$v], &mut [Self]) {
                S::$as_mut(x)
            }
            #[inline(always)]
            fn splat<S: Simd>(simd: S, x: Self) -> S::$v {
                simd.$splat(x)
            }
            #[inline(always)]
            fn minus<S: Simd>(simd: S, a: S::$v, b: S::$v) -> S::$v {
                simd.$sub(a, b)
            }
            #[inline(always)]
            fn times<S: Simd>(simd: S, a: S::$v, b: S::$v) -> S::$v {
                simd.$mul(a, b)
            }
            #[inline(always)]
            fn negative<S: Simd>(simd: S, a: S::$v) -> S::$v {
                simd.$neg(a)
            }
            #[inline(always)]
            fn mul_add<S: Simd>(simd: S, a: S::$v, b: S::$v, c: S::$v) -> S::$v {
                simd.$fma(a, b, c)
            }
            #[inline(always)]
            fn sum<S: Simd>(simd: S, a: S::$v) -> Self {
                simd.$sum(a)
            }
            #[inline(always)]
            fn load<S: Simd>(simd: S, x: &[Self]) -> S::$v {
                simd.$load(x)
            }
            #[inline(always)]
            fn store<S: Simd>(simd: S, x: &mut [Self], a: S::$v) {
                simd.$store(x, a);
            }
        }
    };
}

number!(
    f64,
    f64s,
    F64_LANES,
    as_simd_f64s,
    as_mut_simd_f64s,
    splat_f64s,
    sub_f64s,
    mul_f64s,
    neg_f64s,
    mul_add_e_f64s,
    reduce_sum_f64s,
    partial_load_f64s,
    partial_store_f64s,
    |_| 1.0
);
number!(
    f32,
    f32s,
    F32_LANES,
    as_simd_f32s,
    as_mut_simd_f32s,
    splat_f32s,
    sub_f32s,
    mul_f32s,
    neg_f32s,
    mul_add_e_f32s,
    reduce_sum_f32s,
    partial_load_f32s,
    partial_store_f32s,
    to_one
);

/// Exact scale: a multiplication by a power of two causes no rounding.
fn to_one(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest.is_normal() {
        (-largest.log2().floor()).clamp(-1000.0, 1000.0).exp2()
    } else {
        1.0
    }
}
