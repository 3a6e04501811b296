//! The part of a floor between two of its sides: the facets that its springs join, and the width that each stands for.

use crate::element::hexahedron::{difference, norm};
use crate::model::ties::TiePoint;

/// Largest number of springs along a side, so that a slip in `spacing` does not fill the memory.
const MOST_JOISTS: f64 = 1000.0;

/// Lengths that differ by less than this fraction of a facet, of `spacing` or of the span are equal: coordinates of decks
/// are rounded.
const ROUNDING: f64 = 1e-3;

/// A facet that carries the floor.
pub(super) struct Bearing {
    pub(super) element: usize,
    pub(super) nodes: [u32; 4],
    /// Parts of its area for which they stand.
    pub(super) shares: [f64; 4],
    /// Its middle [mm].
    pub(super) at: [f64; 3],
    /// The same in plan, along u and v [mm].
    pub(super) plan: [f64; 2],
    /// Its area [mm²].
    pub(super) area: f64,
    /// Half its extent along the side [mm].
    pub(super) half: f64,
}

/// A face that carries the floor.
pub(super) struct Side {
    pub(super) name: String,
    pub(super) bearings: Vec<Bearing>,
    /// Mean of its bearings along the span [mm].
    pub(super) across: f64,
    /// Its ends along it [mm].
    pub(super) ends: [f64; 2],
}

/// The floor between a side and the next.
pub(super) struct Bay<'a> {
    pub(super) sides: [&'a Side; 2],
    /// Direction along the sides: u or v.
    pub(super) along: usize,
    /// Where both sides are [mm].
    pub(super) ends: [f64; 2],
}

/// Points of a spring, and the width of the floor that it stands for [mm].
pub(super) type Strand = (Vec<TiePoint>, f64);

/// Two joists that braces join, and their distance [mm].
type Crossed<'a> = ([&'a Bearing; 2], [&'a Bearing; 2], f64);

impl Bearing {
    /// The end of a spring: the middle of the facet.
    fn point(&self) -> TiePoint {
        TiePoint {
            at: self.at,
            element: self.element as u32,
            nodes: self.nodes.map(|n| (n, 0.25)).to_vec(),
        }
    }
}

impl Bay<'_> {
    /// Distance D of its sides [mm].
    pub(super) fn span(&self) -> f64 {
        self.sides[1].across - self.sides[0].across
    }

    /// Width of the bay [mm].
    fn width(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// Area in plan [mm²].
    pub(super) fn area(&self) -> f64 {
        self.span() * self.width()
    }

    /// Bearings of a side beside the bay.
    pub(super) fn bearings(&self, side: usize) -> impl Iterator<Item = &Bearing> {
        let [low, high] = self.ends;
        let within = move |b: &&Bearing| {
            let slack = ROUNDING * b.half;
            (low - slack..=high + slack).contains(&b.plan[self.along])
        };
        self.sides[side].bearings.iter().filter(within)
    }

    /// Pairs of bearings that joists join, in order along the sides, at most `spacing` apart unless an opening lies
    /// between them.
    fn joists(&self, spacing: f64) -> Vec<[&Bearing; 2]> {
        let low = self.ends[0];
        let count = (self.width() / spacing - ROUNDING).ceil();
        let count = count.clamp(1.0, MOST_JOISTS);
        let step = self.width() / count;
        let mut joists: Vec<[&Bearing; 2]> = Vec::new();
        for k in 0..=count as usize {
            let s = low + k as f64 * step;
            let [Some(first), Some(second)] = [0, 1].map(|side| self.nearest(side, s, step)) else {
                continue;
            };
            let goes_on = |a: &Bearing, b: &Bearing| {
                b.plan[self.along] - a.plan[self.along] > ROUNDING * a.half
            };
            let is_new = joists
                .last()
                .is_none_or(|[a, b]| goes_on(a, first) && goes_on(b, second));
            let [_, across, length] = self.vector(first, second);
            if is_new && across > ROUNDING * length {
                joists.push([first, second]);
            }
        }
        joists
    }

    /// Bearing nearest to a place along the side, of these the nearest to its middle, of these the first along it; none
    /// where an opening has no bearing within half a `step`.
    fn nearest(&self, side: usize, s: f64, step: f64) -> Option<&Bearing> {
        let middle = self.sides[side].across;
        let along = |b: &Bearing| (b.plan[self.along] - s).abs();
        let across = |b: &Bearing| (b.plan[1 - self.along] - middle).abs();
        let near = least(self.bearings(side).collect(), along);
        let near = least(near, across);
        let near = least(near, |b| b.plan[self.along]);
        let near = least(near, |b| b.plan[1 - self.along]);
        let nearest = *near.first()?;
        let reach = (1.0 + ROUNDING) * (nearest.half + 0.5 * step);
        (along(nearest) <= reach).then_some(nearest)
    }

    /// Vector from one bearing to another: along the sides, along the span, and its length [mm].
    fn vector(&self, a: &Bearing, b: &Bearing) -> [f64; 3] {
        let [along, across] = [self.along, 1 - self.along].map(|d| b.plan[d] - a.plan[d]);
        [along, across, norm(difference(b.at, a.at))]
    }

    /// Stiffness of a spring along the sides and along the span, over its E A [1/mm].
    fn stiffness(&self, a: &Bearing, b: &Bearing) -> [f64; 2] {
        let [along, across, length] = self.vector(a, b);
        [along, across].map(|part| part * part / length.powi(3))
    }

    /// Strands of the joists and of the braces with the width that each stands for [mm], for a floor with this axial
    /// stiffness and stiffness against shear [N/mm] (theory/ties.md, eq. 12, 13).
    pub(super) fn strands(&self, spacing: f64, [axial, shear]: [f64; 2]) -> [Vec<Strand>; 2] {
        let joists = self.joists(spacing);
        let (span, whole) = (self.span(), self.width());
        let gaps: Vec<f64> = joists.windows(2).map(|w| self.gap(&w[0], &w[1])).collect();
        let (braces, stiffening) = self.braces(&joists, &gaps);
        // The stiffness of the braces along the joists is taken from these.
        let own = axial * whole / span;
        let left = if own > 0.0 {
            (1.0 - shear * stiffening / own).max(0.0)
        } else {
            1.0
        };
        let covered: f64 = gaps.iter().sum();
        let gap = |k: Option<usize>| k.and_then(|k| gaps.get(k)).copied().unwrap_or(0.0);
        let beside = |k: usize| 0.5 * (gap(k.checked_sub(1)) + gap(Some(k)));
        let edge = |k: usize| {
            if k == 0 || k + 1 == joists.len() {
                whole - covered
            } else {
                0.0
            }
        };
        let ends = joists.len().min(2) as f64;
        let along = joists.iter().enumerate().map(|(k, [a, b])| {
            let width = beside(k) + edge(k) / ends;
            let [_, along_span] = self.stiffness(a, b);
            (strand(a, b), left * width / (span * along_span))
        });
        [along.collect(), braces]
    }

    /// Distance of two joists along the sides [mm].
    fn gap(&self, a: &[&Bearing; 2], b: &[&Bearing; 2]) -> f64 {
        let gaps = [0, 1].map(|side| b[side].plan[self.along] - a[side].plan[self.along]);
        0.5 * (gaps[0] + gaps[1])
    }

    /// Strands of the braces between joists with these `gaps`, and their stiffness along the span over that against
    /// shear.
    fn braces(&self, joists: &[[&Bearing; 2]], gaps: &[f64]) -> (Vec<Strand>, f64) {
        let span = self.span();
        // Braces join joists about as far apart as the floor spans: steeper ones would stiffen it along the joists.
        let mean = gaps.iter().sum::<f64>() / gaps.len().max(1) as f64;
        let fields = (span / mean + ROUNDING).round().max(1.0) as usize;
        let fields = fields.min(gaps.len()).max(1);
        let pairs = joists.iter().zip(joists.iter().skip(fields));
        let pairs: Vec<Crossed<'_>> = pairs.map(|(a, b)| (*a, *b, self.gap(a, b))).collect();
        let share = self.width() / pairs.iter().map(|(_, _, gap)| gap).sum::<f64>();
        let (mut braces, mut stiffening) = (Vec::new(), 0.0);
        for (a, b, gap) in pairs {
            let crossed = [[a[0], b[1]], [b[0], a[1]]];
            let [against_shear, along_span] = crossed
                .map(|[from, to]| self.stiffness(from, to))
                .iter()
                .fold([0.0; 2], |sum, k| [sum[0] + k[0], sum[1] + k[1]]);
            let width = share * gap / (span * against_shear);
            braces.extend(crossed.map(|[from, to]| (strand(from, to), width)));
            stiffening += width * along_span;
        }
        (braces, stiffening)
    }
}

/// The bearings with the least value of a length [mm], up to rounding.
fn least(of: Vec<&Bearing>, length: impl Fn(&Bearing) -> f64) -> Vec<&Bearing> {
    let least = of.iter().map(|b| length(b)).fold(f64::INFINITY, f64::min);
    let is_least = |b: &&Bearing| length(b) - least <= ROUNDING * b.half;
    of.into_iter().filter(is_least).collect()
}

fn strand(a: &Bearing, b: &Bearing) -> Vec<TiePoint> {
    [a, b].map(Bearing::point).to_vec()
}
