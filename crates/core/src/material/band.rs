//! Width of the band in which softening localises (theory/crack-band.md, eqs 1 and 2): one length per element, or a
//! length for each crack direction.
//!
//! ```text
//! volume:     l = V^(1/3)
//! projected:  l(n) = 2/Σ_a |n·∇N_a|  at the centroid    (Oliver 1989; a brick a × b × c: a, b, c along its
//!             edges, a/cos θ for a crack turned by θ out of its first face)
//! ```
//!
//! With `projected` a material has a family of curves for widths in steps of 1/200, and each point uses the curve of
//! its own width. This is the width across the first principal direction in tension and across the last one in
//! compression. It is fixed when the point begins to soften.

use std::sync::Arc;

use nalgebra::Vector3;

use super::parameters::DamagePlasticityParameters;
use super::uniaxial::{Branch, Curve, TableError, TableWarning, snap_back};

/// Size of an element, as a function of the direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// V^(1/3) [mm].
    pub l_eq: f64,
    /// Gradients of the shape functions at the centroid [1/mm]; zero if the length is the same in all directions.
    pub gradient: [Vector3<f64>; 8],
    /// Smallest and largest width over all directions [mm].
    pub widths: [f64; 2],
}

impl Extent {
    /// The same length [mm] in all directions.
    pub fn ball(length: f64) -> Self {
        Self {
            l_eq: length,
            gradient: [Vector3::zeros(); 8],
            widths: [length; 2],
        }
    }

    /// Smallest and largest width of several extents [mm].
    pub fn range<'a>(of: impl Iterator<Item = &'a Self>) -> [f64; 2] {
        of.fold([f64::INFINITY, 0.0], |[low, high], extent| {
            [low.min(extent.widths[0]), high.max(extent.widths[1])]
        })
    }

    /// Width across the unit direction `n` [mm].
    pub fn across(&self, n: &Vector3<f64>) -> f64 {
        let sum: f64 = self.gradient.iter().map(|g| g.dot(n).abs()).sum();
        if sum > 0.0 { 2.0 / sum } else { self.l_eq }
    }
}

/// Curves of one branch, from the narrowest band to the widest.
#[derive(Clone, Debug)]
pub(super) struct BandWidths {
    curves: Vec<Curve>,
    /// Logarithm of the smallest width, and the number of curves per unit of the logarithm.
    lowest: f64,
    per_log: f64,
    /// κ at the peak stress. Up to this value all curves coincide.
    pub onset: f64,
    /// Largest width that has a curve [mm]; wider bands count as so wide.
    widest: f64,
}

/// Ratio of successive widths; the energies are exact within 1/400.
const RATIO: f64 = 1.005;
/// Factor below the snap-back limit to which wider bands are reduced (theory/crack-band.md, eqs 1 and 2).
const WITHIN: f64 = 1.01;

impl BandWidths {
    fn single(curve: Curve) -> Self {
        Self {
            onset: curve.peak(),
            curves: vec![curve],
            lowest: 0.0,
            per_log: 0.0,
            widest: f64::INFINITY,
        }
    }

    /// Energy per volume that a band of `width` [mm] with hardening `kappa` has dissipated beyond its table's, because
    /// it counts as narrower than it is [N/mm²] (theory/crack-band.md, eq. 9). `e`: Young's modulus [MPa].
    pub fn excess(&self, width: f64, kappa: f64, e: f64) -> f64 {
        // Widths along an edge of the widest elements are this one up to rounding.
        if width <= self.widest * (1.0 + 1e-9) {
            return 0.0;
        }
        let curve = self.curve(self.index(width));
        (1.0 - self.widest / width) * curve.softening_energy(kappa, e)
    }

    /// Index of the curve for a band of `width` [mm].
    #[inline(always)]
    pub fn index(&self, width: f64) -> usize {
        let at = ((width.ln() - self.lowest) * self.per_log).round();
        // A width of 0 gives NaN, which selects the first curve.
        (at.max(0.0) as usize).min(self.curves.len() - 1)
    }

    /// Whether there is more than one curve.
    #[inline(always)]
    pub fn has_several(&self) -> bool {
        self.curves.len() > 1
    }

    #[inline(always)]
    pub fn curve(&self, index: usize) -> &Curve {
        &self.curves[index]
    }
}

/// The softening curves of a material, shared by its laws.
#[derive(Clone, Debug)]
pub struct Curves {
    pub(super) tension: BandWidths,
    pub(super) compression: BandWidths,
}

impl Curves {
    /// Curves for elements of the equivalent length `l_eq` [mm]. Without a length, or without `reference_length` in
    /// the parameters, the tables are used as given.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn of_length(
        p: &DamagePlasticityParameters,
        l_eq: Option<f64>,
    ) -> Result<(Arc<Self>, Vec<TableWarning>), TableError> {
        let scaling = p.reference_length.zip(l_eq);
        let curve = |branch, rows| Curve::new(branch, rows, p.elastic.E, scaling, p.interpolation);
        let (tension, mut warnings) = curve(Branch::Tension, &p.tension)?;
        let (compression, more) = curve(Branch::Compression, &p.compression)?;
        warnings.extend(more);
        let curves = Self {
            tension: BandWidths::single(tension),
            compression: BandWidths::single(compression),
        };
        Ok((Arc::new(curves), warnings))
    }

    /// Curves for bands between the smallest and the largest of `widths` [mm]. If the softening of a wide band would
    /// snap back, the widest admissible curve is used, with a warning. Without widths, or without `reference_length`,
    /// the tables are used as given.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn of_bands(
        p: &DamagePlasticityParameters,
        widths: [f64; 2],
    ) -> Result<(Arc<Self>, Vec<TableWarning>), TableError> {
        let [least, largest] = widths;
        let sound = least > 0.0 && least <= largest && largest.is_finite();
        let Some(l_ref) = p.reference_length.filter(|_| sound) else {
            return Self::of_length(p, None);
        };
        let mut warnings = Vec::new();
        let mut curves_of = |branch, rows| {
            let limit = snap_back(p.elastic.E, rows).map_or(f64::INFINITY, |(row, ratio)| {
                let limit = ratio * l_ref / WITHIN;
                if widths[1] > limit {
                    let width = widths[1];
                    warnings.push(TableWarning::BandNarrowed {
                        branch,
                        row,
                        width,
                        limit,
                    });
                }
                limit
            });
            let [low, high] = widths.map(|w| w.min(limit));
            let count = ((high / low).ln() / RATIO.ln()).ceil().max(0.0) as usize + 1;
            let per_log = 1.0 / RATIO.ln();
            let mut curves = Vec::with_capacity(count);
            for index in 0..count {
                let width = (low * RATIO.powi(index as i32)).min(high);
                let scaling = Some((l_ref, width));
                let (curve, more) =
                    Curve::new(branch, rows, p.elastic.E, scaling, p.interpolation)?;
                curves.push(curve);
                if index == 0 || index + 1 == count {
                    warnings.extend(more);
                }
            }
            let onset = curves[0].peak();
            Ok(BandWidths {
                curves,
                lowest: low.ln(),
                per_log,
                onset,
                widest: high,
            })
        };
        let tension = curves_of(Branch::Tension, &p.tension)?;
        let compression = curves_of(Branch::Compression, &p.compression)?;
        Ok((
            Arc::new(Self {
                tension,
                compression,
            }),
            warnings,
        ))
    }
}
