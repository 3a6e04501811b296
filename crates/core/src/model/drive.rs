//! Direction along which the force of a run counts.

use super::Model;

/// Direction along which the force of the curve counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// 0, 1, 2 for x, y, z: of a direction along none of them, the one with the largest component.
    pub axis: usize,
    /// 1, or −1 against the axis.
    pub sense: f64,
    /// The direction, of length 1.
    pub direction: [f64; 3],
}

/// Component beside the axis up to which a direction counts as one along it.
const ALONG: f64 = 1e-6;

impl Drive {
    /// `x`, `-x`, …, or the components of a direction along no axis, as `(0.70711, -0.70711, 0)`.
    pub fn name(self) -> String {
        let beside = (0..3).filter(|i| *i != self.axis);
        if beside.into_iter().any(|i| self.direction[i].abs() > ALONG) {
            let [x, y, z] = self.direction.map(|part| (1e5 * part).round() / 1e5 + 0.0);
            return format!("({x}, {y}, {z})");
        }
        let sign = if self.sense < 0.0 { "-" } else { "" };
        format!("{sign}{}", ["x", "y", "z"][self.axis])
    }

    /// Direction of the drive or load whose force is the curve of a run; `None` if there is none of them.
    pub fn of(model: &Model) -> Option<Self> {
        largest(model.direction_of_curve()?)
    }

    /// Horizontal part of the direction, of length 1; none of a vertical one.
    pub fn sideways(self) -> Option<[f64; 2]> {
        let [x, y, _] = self.direction;
        let length = x.hypot(y);
        (self.axis != 2).then(|| [x / length, y / length])
    }
}

/// Direction of a vector.
pub(crate) fn largest(v: [f64; 3]) -> Option<Drive> {
    let size = |i: &usize| v[*i].abs();
    let axis = (0..3).max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let length = v.iter().map(|part| part * part).sum::<f64>().sqrt();
    let drive = Drive {
        axis,
        sense: v[axis].signum(),
        direction: v.map(|part| part / length),
    };
    (v[axis] != 0.0).then_some(drive)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_names() {
        assert_eq!(largest([0.0, -2.0, 0.0]).unwrap().name(), "-y");
        let oblique = largest([1.0, -1.0, 0.0]).unwrap();
        assert_eq!(oblique.name(), "(0.70711, -0.70711, 0)");
        let steep = largest([3.0, 4.0, 1.0]).unwrap();
        // Rounding of one division.
        let [x, y] = steep.sideways().unwrap();
        assert!((x - 0.6).abs() < 1e-15 && (y - 0.8).abs() < 1e-15);
        assert!(largest([0.0, 1.0, 5.0]).unwrap().sideways().is_none());
        assert!(largest([0.0; 3]).is_none());
    }
}
