//! The curve of one side of a drive, from which stiffness, capacity and ductility are read.

use crate::results::Curve;
use crate::results::curve::{ULTIMATE, crossing};

/// A curve along one side of the drive: travel since the start of the drive and force, both positive along that side.
///
/// Of a drive that only goes out it has all increments. Of a drive that turns back it has those that reach at least the
/// farthest earlier travel on the side, which is the envelope of the loops. Increments in which `auto` follows the
/// inertial motion between two equilibria are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backbone {
    /// (travel [mm], force [kN]); the first is the start of the drive.
    points: Vec<(f64, f64)>,
    /// All increments in equilibrium, in order of time, the start first.
    all: Vec<(f64, f64)>,
    /// 1, or −1 for the side of negative displacements.
    side: f64,
    /// Displacement at the start of the drive [mm].
    start: f64,
}

impl Backbone {
    /// The side of the peak, or the other one if `opposite`; `None` if the drive has not moved there.
    pub fn of(curve: &Curve, opposite: bool) -> Option<Self> {
        let peak = curve.peak()?;
        let (start, force) = curve.start();
        let to = (peak.displacement - start).signum();
        let side = if opposite { -to } else { to };
        let mut points = vec![(0.0, side * force)];
        let mut all = points.clone();
        points.extend(curve.envelope(side));
        all.extend(
            curve
                .in_equilibrium()
                .map(|(_, p)| (side * (p.0 - start), side * p.1)),
        );
        let moved = points.iter().any(|p| p.0 > 0.0);
        moved.then_some(Self {
            points,
            all,
            side,
            start,
        })
    }

    /// (travel [mm], force [kN]). `[point]`
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Index of the largest force, the first of equal ones.
    pub fn peak(&self) -> usize {
        let mut best = 0;
        for (i, point) in self.points.iter().enumerate() {
            if i == 1 || point.1 > self.points[best].1 {
                best = i;
            }
        }
        best
    }

    /// Displacement of the drive at a travel [mm].
    pub fn displacement(&self, travel: f64) -> f64 {
        self.start + self.side * travel
    }

    /// Force of the drive for a force along the side [kN].
    pub fn force(&self, along: f64) -> f64 {
        self.side * along
    }

    /// Force along the side where the travel is first reached, linear between increments [kN]; `None` beyond the end.
    pub fn force_at(&self, travel: f64) -> Option<f64> {
        let i = self.points.iter().position(|p| p.0 >= travel)?;
        let b = self.points[i];
        let a = i.checked_sub(1).map_or(b, |k| self.points[k]);
        let part = if b.0 == a.0 {
            1.0
        } else {
            (travel - a.0) / (b.0 - a.0)
        };
        Some(a.1 + part * (b.1 - a.1))
    }

    /// Secant stiffness to the point where the force has first risen by `part` of its rise to the peak, linear between
    /// increments [kN/mm]; `None` if there is no rise. It counts from the start, or, where the drive has come back from
    /// the other side, from the point at which the force was zero: a joint that slid has another displacement there.
    pub fn secant(&self, part: f64) -> Option<f64> {
        let from = self.points[0].1;
        let most = self.points[self.peak()].1;
        let target = from + part * (most - from);
        let i = self.all.iter().position(|p| p.0 > 0.0 && p.1 >= target)?;
        let rising = &self.all[..=i];
        let zero = rising
            .windows(2)
            .rposition(|p| p[0].1 <= 0.0 && p[1].1 > 0.0);
        let turned = |k: &usize| rising[..=*k].windows(2).any(|p| p[1].0 < p[0].0);
        let zero = zero.filter(turned);
        let begin = match zero {
            Some(k) => (crossing(rising[k], rising[k + 1], 0.0), 0.0),
            None => self.all[0],
        };
        // After the point without force it may be reached before the start of the drive.
        let from = zero.map_or(0, |k| k + 1);
        let i = from + rising[from..].iter().position(|p| p.1 >= target)?;
        let before = self.all[i.checked_sub(1)?];
        let travel = crossing(before, self.all[i], target) - begin.0;
        (target > begin.1 && travel > 0.0).then(|| (target - begin.1) / travel)
    }

    /// Displacement after the peak at which the force has fallen to 0.8 of it [mm]; `None` if it never does.
    pub fn displacement_at_80_percent(&self) -> Option<f64> {
        let (points, has_fallen) = self.until(ULTIMATE);
        let last = points.last().filter(|_| has_fallen)?;
        Some(self.displacement(last.0))
    }

    /// The part up to the first fall to `part` of the peak after it, linear between increments, and whether the force
    /// has fallen so far; otherwise the whole curve.
    pub fn until(&self, part: f64) -> (Vec<(f64, f64)>, bool) {
        let peak = self.peak();
        let limit = part * self.points[peak].1;
        let after = self.points[peak..].iter().position(|p| p.1 <= limit);
        match after {
            Some(i) if i > 0 => {
                let (a, b) = (self.points[peak + i - 1], self.points[peak + i]);
                let mut points = self.points[..peak + i].to_vec();
                points.push((crossing(a, b, limit), limit));
                (points, true)
            }
            _ => (self.points.clone(), false),
        }
    }
}

/// ∫ F dd along points, by trapezoids [J].
pub fn area(points: &[(f64, f64)]) -> f64 {
    let pairs = points.windows(2);
    pairs
        .map(|p| 0.5 * (p[1].0 - p[0].0) * (p[0].1 + p[1].1))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slider of 100 kN/mm and 10 kN, driven to and fro: both sides have its stiffness, and the same at any size of
    /// the increments past zero.
    #[test]
    fn both_sides_of_a_slider_have_its_stiffness() {
        let slider = |first: f64| {
            Curve::of_points(&[
                (0.0, 0.0),
                (0.1, 10.0),
                (5.0, 10.0),
                (4.9, 0.0),
                (4.8, -10.0),
                (0.0, -10.0),
                (-first, -10.0),
                (-5.0, -10.0),
            ])
        };
        for first in [1e-3, 0.5] {
            for opposite in [false, true] {
                let side = Backbone::of(&slider(first), opposite).unwrap();
                // A few operations.
                assert!(
                    (side.secant(0.7).unwrap() - 100.0).abs() < 1e-9,
                    "{first} {opposite}"
                );
            }
        }
    }

    #[test]
    fn a_cyclic_drive_has_an_envelope_on_either_side() {
        let curve = Curve::of_points(&[
            (0.0, 0.0),
            (1.0, 10.0),
            (0.0, -2.0),
            (-1.0, -8.0),
            (0.0, 2.0),
            (1.0, 9.0),
            (2.0, 12.0),
            (-2.0, -7.0),
        ]);
        let there = Backbone::of(&curve, false).unwrap();
        assert_eq!(
            there.points(),
            [(0.0, 0.0), (1.0, 10.0), (1.0, 9.0), (2.0, 12.0)]
        );
        let back = Backbone::of(&curve, true).unwrap();
        assert_eq!(back.points(), [(0.0, 0.0), (1.0, 8.0), (2.0, 7.0)]);
        assert_eq!((back.displacement(2.0), back.force(7.0)), (-2.0, -7.0));
        assert_eq!(there.force_at(1.5), Some(10.5));
        assert_eq!(there.force_at(2.5), None);
        let outwards = Curve::of_points(&[(0.0, 0.0), (1.0, 10.0)]);
        assert!(Backbone::of(&outwards, true).is_none());
    }
}
