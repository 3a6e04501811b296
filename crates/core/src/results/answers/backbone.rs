//! The curve of one side of a drive, from which stiffness, capacity and ductility are read.

use crate::results::Curve;
use crate::results::curve::crossing;

/// A curve along one side of the drive: travel since the start of the drive and force, both positive along that side.
///
/// Of a drive that only goes out it has all increments. Of a drive to and fro it has those that reach at least the
/// farthest earlier travel on the side, which is the envelope of the loops. Increments in which `auto` follows the
/// inertial motion between two equilibria are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backbone {
    /// (travel [mm], force [kN]); the first is the start of the drive.
    points: Vec<(f64, f64)>,
    /// 1, or −1 for the side of negative displacements.
    side: f64,
    /// Displacement at the start of the drive [mm].
    start: f64,
}

/// Part of the farthest travel by which rounding may miss it.
const ROUNDING: f64 = 1e-9;

impl Backbone {
    /// The side of the peak, or the other one if `opposite`; `None` if the drive has not moved there.
    pub fn of(curve: &Curve, opposite: bool) -> Option<Self> {
        let peak = curve.peak()?;
        let (start, force) = curve.start();
        let to = (peak.displacement - start).signum();
        let side = if opposite { -to } else { to };
        let turns = curve.turns_back();
        let mut points = vec![(0.0, side * force)];
        let mut farthest = 0.0_f64;
        for (_, &(displacement, force)) in curve.in_equilibrium() {
            let travel = side * (displacement - start);
            if turns && (travel <= 0.0 || travel < farthest * (1.0 - ROUNDING)) {
                continue;
            }
            farthest = farthest.max(travel);
            points.push((travel, side * force));
        }
        let moved = points.len() > 1 && farthest > 0.0;
        moved.then_some(Self {
            points,
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

    /// Secant stiffness from the start to the point where the force has first risen by `part` of its rise to the peak,
    /// linear between increments [kN/mm]; `None` if there is no rise.
    pub fn secant(&self, part: f64) -> Option<f64> {
        let from = self.points[0].1;
        let rise = part * (self.points[self.peak()].1 - from);
        let i = self.points.iter().position(|p| p.1 - from >= rise)?;
        let (a, b) = (self.points[i.checked_sub(1)?], self.points[i]);
        let travel = crossing(a, b, from + rise);
        (rise > 0.0 && travel > 0.0).then_some(rise / travel)
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
