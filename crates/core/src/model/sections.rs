//! Sections: cuts through a model whose resultants are columns of the history.

use super::Mesh;
use super::axis::{Axis, along_axis};
use crate::element::hexahedron::{cross, difference, dot, norm};

/// A cut through solids and joints along faces of elements.
///
/// The part of the model on the side of the normal acts on the other one with a force and a moment: those that the
/// nodes between both parts, and the joints between both parts, carry.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Name; the names of its columns begin with it.
    pub name: String,
    /// Normal n, then two directions t₁, t₂ in the plane, at right angles, of length 1. A direction of the plane is an
    /// axis of the scene where one lies in it. `[n,t₁,t₂][xyz]`
    pub directions: [[f64; 3]; 3],
    /// Point at rest to which moments refer [mm]; it moves with the mean of the nodes of the cut.
    pub centre: [f64; 3],
    /// Area at rest [mm²].
    pub area: f64,
    /// Elements on the side of the normal. `[element]`
    pub above: Vec<u32>,
    /// Elements on the other side.
    pub below: Vec<u32>,
}

/// Number of columns of a section.
pub const COLUMNS: usize = 6;

impl Section {
    /// Directions of a section with this normal: itself, then two in its plane.
    pub fn directions(normal: [f64; 3]) -> [[f64; 3]; 3] {
        let part = |axis: &usize| normal[*axis].abs();
        let lies_in = |axis: &usize| normal[*axis] == 0.0;
        // An oblique normal has no axis in its plane: the one that is closest to it is projected.
        let closest = || (0..3).min_by(|a, b| part(a).total_cmp(&part(b)));
        let axis = (0..3).find(lies_in).or_else(closest).unwrap_or(0);
        let along = along_axis(axis);
        let part = normal[axis];
        let first = unit([0, 1, 2].map(|i| along[i] - part * normal[i]));
        let second = cross(normal, first);
        // Along an axis, not against it.
        let against = second.contains(&-1.0);
        let second = if against {
            second.map(|x| 0.0 - x)
        } else {
            second
        };
        [normal, first, second]
    }

    /// Names of the columns: normal force, two shear forces [kN], two bending moments, torque [kN m].
    pub fn columns(name: &str, directions: &[[f64; 3]; 3]) -> [String; COLUMNS] {
        let called = |d: usize| {
            let axis = (0..3).find(|axis| directions[d][*axis].abs() == 1.0);
            axis.map_or(d.to_string(), |axis| Axis::NAMES[axis].to_owned())
        };
        let [a, b] = [called(1), called(2)];
        [
            format!("{name}_N_kN"),
            format!("{name}_V{a}_kN"),
            format!("{name}_V{b}_kN"),
            format!("{name}_M{a}_kNm"),
            format!("{name}_M{b}_kNm"),
            format!("{name}_T_kNm"),
        ]
    }

    /// Values of the columns from force [N] and moment [N mm] of the part above on the part below.
    pub fn values(&self, force: [f64; 3], moment: [f64; 3]) -> [f64; COLUMNS] {
        let along = |v: [f64; 3], d: usize| dot(v, self.directions[d]);
        let [normal, first, second] = [0, 1, 2].map(|d| 1e-3 * along(force, d));
        let [torque, about_first, about_second] = [0, 1, 2].map(|d| 1e-6 * along(moment, d));
        [normal, first, second, about_first, about_second, torque]
    }

    /// Factors by which the columns of a half grow to those of both halves, mirrored along an axis that lies in the
    /// plane of the section: components that cancel have 0.
    pub fn of_both_halves(&self, axis: usize) -> [f64; COLUMNS] {
        let along = self.directions.map(|d| d[axis].abs() == 1.0);
        let force = |d: usize| if along[d] { 0.0 } else { 2.0 };
        let moment = |d: usize| if along[d] { 2.0 } else { 0.0 };
        [
            force(0),
            force(1),
            force(2),
            moment(1),
            moment(2),
            moment(0),
        ]
    }
}

/// Sides of a plane.
pub struct Sides {
    /// Elements on the side of the normal.
    pub above: Vec<u32>,
    /// Elements on the other side.
    pub below: Vec<u32>,
    /// Centroid of the cut, in the plane [mm].
    pub centre: [f64; 3],
    /// Area of the cut [mm²].
    pub area: f64,
}

/// Part of the size of an element by which it may overlap a plane and count as touching it.
const TOUCHING: f64 = 1e-6;

impl Sides {
    /// Sides of some elements of a mesh at the plane through a point with a normal of length 1. Elements belong to the
    /// side of their middle. None if no element is cut or touched on either side.
    pub fn of(
        mesh: &Mesh,
        elements: impl Iterator<Item = u32>,
        normal: [f64; 3],
        through: [f64; 3],
    ) -> Option<Self> {
        let mut sides = Self {
            above: Vec::new(),
            below: Vec::new(),
            centre: [0.0; 3],
            area: 0.0,
        };
        for e in elements {
            let corners = mesh.corners(e as usize);
            let height = |x: &[f64; 3]| dot(difference(*x, through), normal);
            let heights = corners.map(|x| height(&x));
            let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
            let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let middle = [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / 8.0);
            let at = height(&middle);
            let side = if at > 0.0 {
                &mut sides.above
            } else {
                &mut sides.below
            };
            side.push(e);
            let near = TOUCHING * (high - low);
            if low > near || high < -near {
                continue;
            }
            // An element that only touches the plane has half of the area; the other half is across.
            let whole = if low < -near && high > near { 1.0 } else { 0.5 };
            let area = whole * mesh.volume(e as usize) / (high - low);
            sides.area += area;
            for i in 0..3 {
                sides.centre[i] += area * (middle[i] - at * normal[i]);
            }
        }
        if sides.area <= 0.0 || sides.above.is_empty() || sides.below.is_empty() {
            return None;
        }
        sides.centre = sides.centre.map(|x| x / sides.area);
        Some(sides)
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = norm(v);
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_a_plane_are_axes_where_one_lies_in_it() {
        let names = |normal| Section::columns("s", &Section::directions(normal));
        let level = names([0.0, 0.0, 1.0]);
        assert_eq!(
            level,
            [
                "s_N_kN", "s_Vx_kN", "s_Vy_kN", "s_Mx_kNm", "s_My_kNm", "s_T_kNm"
            ]
        );
        assert_eq!(names([1.0, 0.0, 0.0])[1..3], ["s_Vy_kN", "s_Vz_kN"]);
        assert_eq!(names([0.0, 1.0, 0.0])[1..3], ["s_Vx_kN", "s_Vz_kN"]);
        // A normal between x and z: y lies in the plane, and the other direction has no name.
        assert_eq!(names([0.6, 0.0, 0.8])[1..3], ["s_Vy_kN", "s_V2_kN"]);
        for normal in [
            [0.0, 0.0, -1.0],
            [0.6, 0.0, 0.8],
            [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0],
        ] {
            let [n, a, b] = Section::directions(normal);
            let products = [
                dot(n, a),
                dot(n, b),
                dot(a, b),
                dot(a, a) - 1.0,
                dot(b, b) - 1.0,
            ];
            // Rounding of a few products.
            assert!(products.iter().all(|p| p.abs() < 1e-15), "{products:?}");
            assert!(!b.contains(&-1.0), "{b:?}");
        }
    }
}
