//! The load-displacement curve and the quantities read from it.

use crate::model::Model;
use crate::model::live::PartInCurve;
use crate::model::scene::Step;
use crate::state::Method;
use crate::state::{ForceBy, HistoryRow, Motion};

/// Displacement and force of the driven steps, in order, from the point where the drive begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Point where the drive begins: (displacement [mm], force [kN]) of the last increment before it, or the origin.
    start: (f64, f64),
    /// Increments of driven steps: (displacement [mm], force [kN]). `[increment]`
    points: Vec<(f64, f64)>,
    /// Whether the force includes inertia, so that it cannot be a peak. `[increment]`
    moving: Vec<bool>,
    motion: Motion,
    /// Whether another drive came before, so that the start is found from the first two points.
    follows_another: bool,
    /// Parts of the step at which the first two points lie.
    parts: Vec<f64>,
}

/// Use of a step in the curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepOfCurve {
    /// Its increments are points of the curve.
    pub driven: bool,
    /// Its increments show another drive, so that the curve does not begin at them.
    pub other: bool,
    /// Origin of the force in increments with inertia. Procedures that seek equilibria use inertia only to reach the next
    /// one.
    pub inertia: ForceBy,
}

impl StepOfCurve {
    /// Use of each step of a model. `[step]`
    pub fn all(model: &Model) -> Vec<Self> {
        let parts = model.parts_in_curve().into_iter().zip(&model.steps);
        let of = |(part, step): (PartInCurve, &Step)| Self {
            driven: part == PartInCurve::Points,
            other: part == PartInCurve::Other,
            inertia: match step.procedure.seeks_equilibrium() {
                true if step.prescribes() => ForceBy::Drive,
                true => ForceBy::Loads,
                false => ForceBy::Equilibrium,
            },
        };
        parts.map(of).collect()
    }
}

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Index among the points of the curve.
    pub index: usize,
    /// Displacement [mm].
    pub displacement: f64,
    /// Force [kN].
    pub force: f64,
}

/// Fraction of the peak force up to which the initial stiffness is measured.
pub(super) const INITIAL: f64 = 0.1;

/// Part of the largest force to which it falls at the ultimate displacement.
pub const ULTIMATE: f64 = 0.8;

/// Fraction of the peak force below which a lower force counts as a loss.
const LOST: f64 = 0.995;

/// Part of its range by which a drive that turns back moves at least.
const BACK: f64 = 0.01;

/// Part of the farthest travel by which the rounding of summed increments may miss it.
const ROUNDING: f64 = 1e-9;

impl Curve {
    /// Adds an increment. An increment before the first driven one moves the start of the curve, unless it shows another
    /// drive. A later increment of a step without a drive (a pause) is ignored.
    pub fn push(&mut self, row: &HistoryRow, of: StepOfCurve) {
        let point = (row.displacement_mm, row.force_kN);
        let by = match row.procedure {
            Method::QuasiStatic => of.inertia,
            _ => ForceBy::Equilibrium,
        };
        let moving = self.motion.follow(row, by);
        if of.driven {
            self.points.push(point);
            self.moving.push(moving);
            if self.follows_another && self.points.len() <= 2 {
                self.parts.push(row.load_factor);
                self.extrapolate_start();
            }
        } else if of.other {
            self.follows_another |= self.points.is_empty();
        } else if self.points.is_empty() {
            self.start = point;
            self.follows_another = false;
        }
    }

    /// The start of a drive that follows another one, whose rows show the other force: the point on the line through the
    /// first two points at which the step begins.
    fn extrapolate_start(&mut self) {
        if let ([a, b], [from, to]) = (&self.points[..], &self.parts[..])
            && *from > 0.0
            && to > from
        {
            let back = from / (to - from);
            self.start = (a.0 - back * (b.0 - a.0), a.1 - back * (b.1 - a.1));
        }
    }

    /// A curve that starts at the first of these points [mm, kN].
    pub fn of_points(points: &[(f64, f64)]) -> Self {
        let (start, points) = points.split_first().unwrap_or((&(0.0, 0.0), &[]));
        Self {
            start: *start,
            points: points.to_vec(),
            moving: vec![false; points.len()],
            ..Self::default()
        }
    }

    /// The curve with both quantities multiplied by `side`, 1 or −1.
    #[must_use]
    pub fn along(&self, side: f64) -> Self {
        let turned = |p: (f64, f64)| (side * p.0, side * p.1);
        Self {
            start: turned(self.start),
            points: self.points.iter().copied().map(turned).collect(),
            ..self.clone()
        }
    }

    /// Increments of driven steps: (displacement [mm], force [kN]).
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Point where the drive begins: (displacement [mm], force [kN]).
    pub fn start(&self) -> (f64, f64) {
        self.start
    }

    /// Last displacement [mm]; `None` if nothing was driven.
    pub fn final_displacement(&self) -> Option<f64> {
        self.points.last().map(|p| p.0)
    }

    /// Increments in equilibrium, whose force inertia does not carry, with their indices.
    pub fn in_equilibrium(&self) -> impl Iterator<Item = (usize, &(f64, f64))> {
        let points = self.points.iter().enumerate();
        points.filter(|(index, _)| !self.moving[*index])
    }

    /// Whether inertia carries the force of the last increment.
    pub fn ends_moving(&self) -> bool {
        self.moving.last().is_some_and(|moving| *moving)
    }

    /// Sense in which the force is counted along the motion: −1 where it acts against the motion throughout and grows,
    /// as that of ground that sinks under a wall or of a load of the opposite sign; else 1.
    fn sense(&self) -> f64 {
        let moved = self.in_equilibrium().filter(|(_, p)| p.0 != self.start.0);
        let (mut low, mut high, mut side) = (f64::INFINITY, f64::NEG_INFINITY, 1.0);
        for (_, &(displacement, force)) in moved {
            side = (displacement - self.start.0).signum();
            low = low.min(side * force);
            high = high.max(side * force);
        }
        let start = side * self.start.1;
        if high < 0.0 && start - low > high - start {
            -1.0
        } else {
            1.0
        }
    }

    /// The peak: the largest s F with s = sign(d − d₀), so that a wall driven towards −x has a peak as well. It is
    /// the earliest of equal ones, and `None` if nothing moved or no increment is in equilibrium. Increments in which
    /// `auto` follows the inertial motion between two equilibria do not count. Where the force acts against the motion
    /// throughout and grows, it is the largest −s F.
    pub fn peak(&self) -> Option<Peak> {
        let sense = self.sense();
        let mut best: Option<(f64, Peak)> = None;
        for (index, &(displacement, force)) in self.in_equilibrium() {
            let travel = displacement - self.start.0;
            let along = sense * travel.signum() * force;
            if travel != 0.0 && best.is_none_or(|(most, _)| along > most) {
                best = Some((
                    along,
                    Peak {
                        index,
                        displacement,
                        force,
                    },
                ));
            }
        }
        best.map(|(_, peak)| peak)
    }

    /// Whether the drive is cyclic: it moves both ways by at least half of its range.
    pub fn turns_back(&self) -> bool {
        let ways = || {
            std::iter::once(&self.start)
                .chain(&self.points)
                .map(|p| p.0)
        };
        let range = ways().fold(f64::NEG_INFINITY, f64::max) - ways().fold(f64::INFINITY, f64::min);
        let returns = |sign: f64| {
            let mut farthest = f64::NEG_INFINITY;
            ways().any(|d| {
                farthest = farthest.max(sign * d);
                sign * d <= farthest - 0.5 * range * (1.0 - ROUNDING)
            })
        };
        // A drive that only moves outwards returns for one of the signs.
        returns(1.0) && returns(-1.0)
    }

    /// The largest force along the motion on the side of the start opposite to the peak; `None` if the drive never
    /// went there.
    pub fn opposite_peak(&self) -> Option<Peak> {
        let peak = self.peak()?;
        let side = (peak.displacement - self.start.0).signum();
        let there = self
            .in_equilibrium()
            .filter(|(_, p)| side * (p.0 - self.start.0) < 0.0);
        let most = there.max_by(|a, b| (-side * a.1.1).total_cmp(&(-side * b.1.1)));
        most.map(|(index, &(displacement, force))| Peak {
            index,
            displacement,
            force,
        })
    }

    /// Rise of the force along the motion over the last `part` of the travel, linear between increments [kN].
    pub fn rises_over(&self, part: f64) -> f64 {
        let Some(&(end, force)) = self.points.last() else {
            return 0.0;
        };
        let travel = end - self.start.0;
        let from = end - part * travel;
        let sign = travel.signum();
        let all: Vec<(f64, f64)> = std::iter::once(self.start)
            .chain(self.points.iter().copied())
            .collect();
        let last = all.iter().rposition(|p| sign * (p.0 - from) <= 0.0);
        let before = match last {
            Some(i) if i + 1 < all.len() => at(all[i], all[i + 1], from),
            _ => force,
        };
        self.sense() * sign * (force - before)
    }

    /// Rise of the force over the last `part` of the farthest travel on one side of the start, along the envelope of the
    /// loops [kN].
    pub(super) fn rises_outwards(&self, side: f64, part: f64) -> f64 {
        let mut envelope = self.envelope(side);
        let Some(&(end, _)) = envelope.last() else {
            return 0.0;
        };
        envelope.insert(0, (0.0, side * self.start.1));
        // The largest force at the end: loops may reach it several times.
        let at_end = envelope.iter().filter(|p| p.0 >= end * (1.0 - ROUNDING));
        let force = at_end.map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
        let from = (1.0 - part) * end;
        let first = envelope.iter().position(|p| p.0 >= from);
        let before = match first {
            Some(i) if i > 0 => at(envelope[i - 1], envelope[i], from),
            _ => side * self.start.1,
        };
        force - before
    }

    /// Whether the force has fallen below its largest value, which makes that value a peak. Unloading is no fall.
    pub fn passes_peak(&self) -> bool {
        let (Some(peak), Some(last)) = (self.peak(), self.points.last()) else {
            return false;
        };
        if self.unloads() {
            return self.loses(peak);
        }
        let sense = self.sense() * (peak.displacement - self.start.0).signum();
        is_less(sense * last.1, sense * peak.force)
    }

    /// Whether the drive moves back, by more than a hundredth of its range.
    fn unloads(&self) -> bool {
        let Some(peak) = self.peak() else {
            return false;
        };
        let side = (peak.displacement - self.start.0).signum();
        let out = || {
            let all = std::iter::once(&self.start).chain(&self.points);
            all.map(|p| side * (p.0 - self.start.0))
        };
        let (low, high) = out().fold((0.0_f64, 0.0_f64), |(low, high), d| {
            (low.min(d), high.max(d))
        });
        let mut farthest = f64::NEG_INFINITY;
        out().any(|d| {
            farthest = farthest.max(d);
            d < farthest - BACK * (high - low)
        })
    }

    /// Increments in equilibrium on one side of the start that reach at least the farthest earlier travel there: the
    /// envelope of the loops, or all of a drive that only goes out. Travel and force along the side. `[point]`
    pub(super) fn envelope(&self, side: f64) -> Vec<(f64, f64)> {
        let unloads = self.unloads();
        let mut farthest = 0.0_f64;
        let mut points = Vec::with_capacity(self.points.len());
        for (_, &(displacement, force)) in self.in_equilibrium() {
            let travel = side * (displacement - self.start.0);
            if unloads && (travel <= 0.0 || travel < farthest * (1.0 - ROUNDING)) {
                continue;
            }
            farthest = farthest.max(travel);
            points.push((travel, side * force));
        }
        points
    }

    /// Word for the largest force in texts.
    pub fn word_of_largest(&self) -> &'static str {
        if self.passes_peak() {
            "peak"
        } else {
            "largest"
        }
    }

    /// Whether a drive that turns back later reaches the farthest displacement on the side of the peak, or a larger one,
    /// with a lower force.
    pub fn loses(&self, peak: Peak) -> bool {
        let side = (peak.displacement - self.start.0).signum();
        let sense = self.sense() * side;
        let out = |d: f64| side * (d - self.start.0);
        let before = self.points[..=peak.index].iter().map(|p| out(p.0));
        let mut farthest = before.fold(0.0, f64::max);
        let mut after = self.points.iter().skip(peak.index + 1);
        after.any(|p| {
            let outer = out(p.0) >= farthest * (1.0 - ROUNDING);
            farthest = farthest.max(out(p.0));
            outer && is_less(sense * p.1, sense * peak.force)
        })
    }

    /// Displacement after the peak at which the force first falls to 0.8 of the peak, linear between increments [mm];
    /// `None` if it never does. Where the drive turns back only increments count that reach at least the largest
    /// earlier displacement on the side of the peak, because unloading is not a loss of strength.
    pub fn displacement_at_80_percent(&self) -> Option<f64> {
        let peak = self.peak()?;
        let side = (peak.displacement - self.start.0).signum();
        let sign = (side * peak.force).signum();
        let points: Vec<_> = self
            .envelope(side)
            .iter()
            .map(|p| (p.0, sign * p.1))
            .collect();
        let target = ULTIMATE * peak.force.abs();
        let first = points.iter().position(|p| p.1 >= peak.force.abs())?;
        let after = &points[first..];
        let i = after.iter().position(|p| p.1 <= target)?;
        let travel = crossing(after[i.checked_sub(1)?], after[i], target);
        Some(self.start.0 + side * travel)
    }

    /// Initial stiffness [kN/mm]: secant from the start of the drive to the point where the force has first risen by
    /// a tenth of its rise to the peak, linear between increments. If the first increment exceeds that force, it is
    /// the secant of this increment.
    pub fn initial_stiffness(&self) -> Option<f64> {
        self.secant_stiffness(INITIAL)
    }

    /// The same for another fraction `part` of the rise to the peak [kN/mm].
    pub fn secant_stiffness(&self, part: f64) -> Option<f64> {
        let (d0, f0) = self.start;
        let mut rise = part * (self.peak()?.force - f0);
        if self.unloads() {
            // The first way out decides the sign.
            let first = self
                .points
                .iter()
                .find(|p| (p.1 - f0).abs() >= rise.abs())?;
            rise = rise.abs() * (first.1 - f0).signum();
        }
        let sign = rise.signum();
        let i = self
            .points
            .iter()
            .position(|p| sign * (p.1 - f0) >= sign * rise)?;
        let before = i.checked_sub(1).map_or(self.start, |k| self.points[k]);
        let travel = crossing(before, self.points[i], f0 + rise) - d0;
        (travel != 0.0).then_some(rise / travel)
    }
}

/// Whether a force is less than the largest by more than rounding and noise.
fn is_less(force: f64, most: f64) -> bool {
    force < most - (1.0 - LOST) * most.abs()
}

/// Force at this displacement on the line from a to b.
fn at(a: (f64, f64), b: (f64, f64), displacement: f64) -> f64 {
    if b.0 == a.0 {
        b.1
    } else {
        a.1 + (b.1 - a.1) * (displacement - a.0) / (b.0 - a.0)
    }
}

/// Displacement at this force on the line from a to b.
pub(super) fn crossing(a: (f64, f64), b: (f64, f64), force: f64) -> f64 {
    if b.1 == a.1 {
        b.0
    } else {
        a.0 + (b.0 - a.0) * (force - a.1) / (b.1 - a.1)
    }
}

/// Four significant digits without an exponent: peaks lie between micrometres (couplets) and millimetres (walls).
#[cfg(any(feature = "plot", feature = "run-folder"))]
pub(super) fn brief(value: f64) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        3 - value.abs().log10().floor() as i32
    };
    format!("{value:.*}", digits.clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests;
