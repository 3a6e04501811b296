//! The load-displacement curve and the numbers an engineer reads off it.

use super::HistoryRow;

/// Displacement and force of the driven steps, in order, from the point where driving began.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Where driving began: (displacement [mm], force [kN]) of the last increment before it, or the
    /// origin.
    start: (f64, f64),
    /// Increments of driven steps: (displacement [mm], force [kN]). `[increment]`
    points: Vec<(f64, f64)>,
}

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Its place among the curve's points.
    pub index: usize,
    /// Displacement [mm].
    pub displacement: f64,
    /// Force [kN].
    pub force: f64,
}

/// Part of the peak's force up to which the initial stiffness is measured.
const INITIAL: f64 = 0.1;

impl Curve {
    /// Adds an increment. Those that come before any driven one move the curve's start; those of
    /// undriven steps later on (a pause of the driving) are no part of it.
    pub fn push(&mut self, row: &HistoryRow, driven: bool) {
        let point = (row.displacement_mm, row.force_kN);
        if driven {
            self.points.push(point);
        } else if self.points.is_empty() {
            self.start = point;
        }
    }

    /// A curve that begins with the first of these points [mm, kN].
    pub fn of_points(points: &[(f64, f64)]) -> Self {
        let (start, points) = points.split_first().unwrap_or((&(0.0, 0.0), &[]));
        Self {
            start: *start,
            points: points.to_vec(),
        }
    }

    /// Increments of driven steps: (displacement [mm], force [kN]).
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Where driving began: (displacement [mm], force [kN]).
    pub fn start(&self) -> (f64, f64) {
        self.start
    }

    /// Last displacement [mm]; none if nothing was driven.
    pub fn final_displacement(&self) -> Option<f64> {
        self.points.last().map(|p| p.0)
    }

    /// The largest force along the motion: of s F with s = sign(d − d₀), so that a wall driven
    /// towards −x has a peak as well. The earliest if several are equal; none if nothing moved.
    pub fn peak(&self) -> Option<Peak> {
        let mut best: Option<(f64, Peak)> = None;
        for (index, &(displacement, force)) in self.points.iter().enumerate() {
            let travel = displacement - self.start.0;
            let along = travel.signum() * force;
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

    /// Displacement after the peak at which the force has first fallen to 0.8 of it, linear between
    /// increments [mm]; none if it never falls that far.
    pub fn displacement_at_80_percent(&self) -> Option<f64> {
        let peak = self.peak()?;
        let target = 0.8 * peak.force;
        let sign = peak.force.signum();
        let after = &self.points[peak.index..];
        let i = after.iter().position(|p| sign * p.1 <= sign * target)?;
        Some(crossing(after[i.checked_sub(1)?], after[i], target))
    }

    /// Initial stiffness [kN/mm]: the secant from where driving began to where the force has first
    /// risen by a tenth of what it rises to its peak, linear between increments. With a first
    /// increment beyond that it is the secant of the first increment.
    pub fn initial_stiffness(&self) -> Option<f64> {
        self.secant_stiffness(INITIAL)
    }

    /// The same up to where the force has risen by another part of what it rises [kN/mm].
    pub fn secant_stiffness(&self, part: f64) -> Option<f64> {
        let (d0, f0) = self.start;
        let rise = part * (self.peak()?.force - f0);
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

/// Displacement at which the line from a to b has this force.
fn crossing(a: (f64, f64), b: (f64, f64), force: f64) -> f64 {
    if b.1 == a.1 {
        b.0
    } else {
        a.0 + (b.0 - a.0) * (force - a.1) / (b.1 - a.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn curve(preload: &[(f64, f64)], driven: &[(f64, f64)]) -> Curve {
        let mut curve = Curve::default();
        for (points, flag) in [(preload, false), (driven, true)] {
            for &(displacement, force) in points {
                curve.push(
                    &HistoryRow {
                        displacement_mm: displacement,
                        force_kN: force,
                        ..HistoryRow::default()
                    },
                    flag,
                );
            }
        }
        curve
    }

    // Rises at 40 kN/mm to 20 kN, bends to a peak of 50 kN at 2 mm, falls to 30 kN at 4 mm.
    const WALL: [(f64, f64); 5] = [
        (0.25, 10.0),
        (0.5, 20.0),
        (2.0, 50.0),
        (3.0, 45.0),
        (4.0, 30.0),
    ];

    #[test]
    fn a_wall_is_read_by_hand() {
        let wall = curve(&[(0.0, 0.0), (0.0, 0.0)], &WALL);
        let peak = wall.peak().unwrap();
        assert_eq!((peak.displacement, peak.force), (2.0, 50.0));
        // 40 kN lies a third of the way from 45 to 30.
        assert_relative_eq!(
            wall.displacement_at_80_percent().unwrap(),
            3.0 + 1.0 / 3.0,
            max_relative = 1e-14 // one interpolation in f64
        );
        // 5 kN at 0.125 mm
        assert_relative_eq!(
            wall.initial_stiffness().unwrap(),
            40.0,
            max_relative = 1e-14
        );
        assert_eq!(wall.final_displacement(), Some(4.0));
    }

    #[test]
    fn driven_the_other_way_it_reads_the_same_with_its_signs() {
        let mirrored: Vec<_> = WALL.iter().map(|p| (-p.0, -p.1)).collect();
        let (wall, other) = (curve(&[], &WALL), curve(&[], &mirrored));
        let peak = other.peak().unwrap();
        assert_eq!((peak.displacement, peak.force), (-2.0, -50.0));
        assert_eq!(other.initial_stiffness(), wall.initial_stiffness());
        assert_eq!(
            other.displacement_at_80_percent().map(|d| -d),
            wall.displacement_at_80_percent()
        );
    }

    #[test]
    fn the_start_is_the_last_increment_before_driving() {
        let wall = curve(&[(0.1, 3.0)], &[(1.1, 13.0), (2.1, 23.0)]);
        assert_eq!(wall.start(), (0.1, 3.0));
        // (23 − 3)/10 = 2 kN after 0.2 mm
        assert_relative_eq!(
            wall.initial_stiffness().unwrap(),
            10.0,
            max_relative = 1e-12
        );
    }

    #[test]
    fn what_never_happened_is_none() {
        let nothing = curve(&[(0.0, 0.0)], &[]);
        assert_eq!(nothing.peak(), None);
        assert_eq!(nothing.initial_stiffness(), None);
        assert_eq!(nothing.final_displacement(), None);
        let still_rising = curve(&[], &WALL[..3]);
        assert_eq!(still_rising.displacement_at_80_percent(), None);
        assert_eq!(still_rising.peak().unwrap().force, 50.0);
    }
}
