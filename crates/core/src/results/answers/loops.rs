//! Energy dissipated in the loops of a drive to and fro, and the damping with the same energy.
//!
//! ξ = E_D / (2 π (E⁺ + E⁻)) with E_D = ∮ F dd over the loop and E± = F± d±/2 at its farthest displacements to both
//! sides. It is E_D/(4 π E_so) (Chopra, *Dynamics of structures*) with the mean of both sides as the stored energy, as
//! Magenes and Calvi (1997) evaluate tests of walls.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::results::Curve;
use crate::results::backbone::area;

/// A loop of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Loop {
    /// Number, from 1.
    pub number: usize,
    /// Farthest displacement to the side on which the drive begins [mm].
    pub displacement_mm: f64,
    /// Force there [kN].
    pub force_kN: f64,
    /// Farthest displacement to the other side [mm].
    pub opposite_displacement_mm: f64,
    /// Force there [kN].
    pub opposite_force_kN: f64,
    /// Enclosed area E_D [J].
    pub dissipated_energy_J: f64,
    /// Equivalent viscous damping ξ [-]; `None` if a side stores no energy.
    pub equivalent_damping: Option<f64>,
}

/// Smallest amplitude of a loop, and distance from the start at which the last loop counts as closed, relative to the
/// range of the drive [-].
const CLOSED: f64 = 1e-6;

/// Loops of a curve: from one passage of the start of the drive in the direction of its first motion to the next. A
/// loop that does not return to the start is left out. Empty if the drive does not turn back.
pub fn loops(curve: &Curve) -> Vec<Loop> {
    let start = curve.start();
    let points = curve.points().iter();
    let Some(first) = points.clone().find(|p| p.0 != start.0) else {
        return Vec::new();
    };
    if !curve.turns_back() {
        return Vec::new();
    }
    let side = (first.0 - start.0).signum();
    let all: Vec<(f64, f64)> = std::iter::once(&start)
        .chain(points)
        .map(|p| (side * (p.0 - start.0), side * p.1))
        .collect();
    let range = all.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
    let mut found = Vec::new();
    for path in parts(&all, CLOSED * range) {
        let number = found.len() + 1;
        found.extend(closed(&path, number, (start.0, side), CLOSED * range));
    }
    found
}

/// Parts of a path between its upward passages of zero, linear between points. The last one ends with the path.
fn parts(all: &[(f64, f64)], near: f64) -> Vec<Vec<(f64, f64)>> {
    let mut parts = Vec::new();
    let mut part = vec![all[0]];
    let mut away = false;
    for pair in all.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        away |= a.0.abs() > near;
        if away && a.0 <= near && b.0 > near {
            let passed = if a.0 < 0.0 {
                (0.0, a.1 - a.0 * (b.1 - a.1) / (b.0 - a.0))
            } else {
                a
            };
            part.push(passed);
            parts.push(std::mem::replace(&mut part, vec![passed]));
            away = false;
        }
        part.push(b);
    }
    parts.push(part);
    parts
}

/// The loop of a path; `None` if it does not return.
fn closed(
    path: &[(f64, f64)],
    number: usize,
    (start, side): (f64, f64),
    near: f64,
) -> Option<Loop> {
    let end = path.last()?;
    // Of equal ones the first, at which the drive arrives.
    let outermost = |sign: f64| {
        path.iter()
            .min_by(|a, b| (-sign * a.0).total_cmp(&(-sign * b.0)))
    };
    let (far, back) = (outermost(1.0)?, outermost(-1.0)?);
    let went = far.0 > near || back.0 < -near;
    if !went || end.0.abs() > near {
        return None;
    }
    let dissipated = area(path);
    let stored = [far, back].map(|p| 0.5 * p.0 * p.1);
    let both = stored.iter().all(|e| *e > 0.0);
    let stored: f64 = stored.iter().sum();
    Some(Loop {
        number,
        displacement_mm: start + side * far.0,
        force_kN: side * far.1,
        opposite_displacement_mm: start + side * back.0,
        opposite_force_kN: side * back.1,
        dissipated_energy_J: dissipated,
        equivalent_damping: both.then(|| dissipated / (2.0 * PI * stored)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn rigid_plastic_loops_have_a_damping_of_two_over_pi() {
        // Friction of 10 kN: a rectangle 4 mm wide and 20 kN high.
        let once = [
            (0.0, 10.0),
            (2.0, 10.0),
            (2.0, -10.0),
            (-2.0, -10.0),
            (-2.0, 10.0),
            (0.0, 10.0),
        ];
        let twice = [&[(0.0, 0.0)][..], &once, &once[1..]].concat();
        let found = loops(&Curve::of_points(&twice));
        assert_eq!(found.len(), 2);
        for one in &found {
            assert_relative_eq!(one.dissipated_energy_J, 80.0, max_relative = 1e-12); // a few operations
            // 80/(2 π (10 + 10)) = 2/π, the value of rigid-plastic behaviour.
            assert_relative_eq!(
                one.equivalent_damping.unwrap(),
                2.0 / PI,
                max_relative = 1e-12
            );
        }
        assert_eq!(found[1].number, 2);
        assert_eq!(found[0].opposite_displacement_mm, -2.0);
    }

    #[test]
    fn passages_between_increments_are_interpolated_and_open_loops_left_out() {
        // Elastic: no energy. The second loop does not return.
        let line = [
            (0.0, 0.0),
            (2.0, 4.0),
            (-2.0, -4.0),
            (3.0, 6.0),
            (-3.0, -6.0),
        ];
        let found = loops(&Curve::of_points(&line));
        assert_eq!(found.len(), 1);
        assert!(found[0].dissipated_energy_J.abs() < 1e-12); // rounding of terms of a few J
        assert!(loops(&Curve::of_points(&[(0.0, 0.0), (1.0, 1.0)])).is_empty());
        // The mirrored drive has the same loops.
        let turned = loops(&Curve::of_points(&line.map(|(d, f)| (-d, -f))));
        assert_eq!(turned[0].displacement_mm, -2.0);
        assert_eq!(turned[0].force_kN, -4.0);
    }
}
