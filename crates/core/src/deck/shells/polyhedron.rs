//! Polyhedra with plane faces: volume, convexity, warp.

use super::ShellError;
use super::hull::hull;
use super::merge::merged;
use super::split::{Shell, area_vector, point, volume};
use crate::deck::schema::NotConvex;
use crate::element::hexahedron::{cross, difference, dot, norm};

/// A closed polyhedron.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::deck) struct Polyhedron {
    /// Corners [mm].
    pub(in crate::deck) corners: Vec<[f64; 3]>,
    /// Faces: corners counter-clockwise seen from outside.
    pub(in crate::deck) faces: Vec<Vec<u32>>,
}

/// Distance of a corner from the plane of a face up to which it lies in it, over the size of the stone. Files of
/// metres with three decimals round a stone of 250 mm to 0.002 of its size.
pub(super) const FLAT: f64 = 2e-3;

/// The same distance where faces that are merged with the first one have outlines with holes.
const FINE: f64 = 1e-7;

/// Distance by which a corner may lie outside the plane of a face, over the size of the stone.
const CONVEX: f64 = 5e-3;

/// Warp of a face over the size of the stone that is worth a warning.
pub(in crate::deck) const WARPED: f64 = 1e-2;

/// Largest number of corners of a stone: each is compared with each face.
const MOST_CORNERS: usize = 2000;

/// Largest number of vertices of which the convex hull is taken.
const MOST_OF_HULL: usize = 5000;

impl Polyhedron {
    /// Merges the coplanar faces of a shell and checks that it is convex. Returns the volume that its convex hull
    /// adds if the hull stands in its place [mm³].
    ///
    /// # Errors
    /// Shells that are not convex or have too many corners.
    pub(in crate::deck) fn of(
        shell: &Shell,
        not_convex: NotConvex,
    ) -> Result<(Self, f64), ShellError> {
        let size = volume(&shell.vertices, &shell.faces).cbrt();
        let own = Self::merged(&shell.vertices, &shell.faces, size);
        let why = match own {
            Ok(own) => return Ok((own, 0.0)),
            Err(why) => why,
        };
        let wrong = |message: String, help: &str| Err(ShellError::new(shell.place, message, help));
        if let Fault::Corners(count) = why {
            return wrong(
                format!(
                    "{} has {count} corners after its coplanar faces are merged",
                    shell.called()
                ),
                "at most 2000: simplify the mesh of the stone",
            );
        }
        if not_convex == NotConvex::Error {
            return wrong(
                format!("{} is not convex: {why}", shell.called()),
                "cut it into convex stones, or take its hull by not_convex = \"hull\"",
            );
        }
        if shell.vertices.len() > MOST_OF_HULL {
            let count = shell.vertices.len();
            return wrong(
                format!(
                    "{} has {count} vertices, too many for its hull",
                    shell.called()
                ),
                "at most 5000: simplify the mesh of the stone",
            );
        }
        let faces = hull(&shell.vertices).unwrap_or_default();
        match Self::merged(&shell.vertices, &faces, size) {
            Ok(hull) => {
                let more = hull.volume() - size.powi(3);
                Ok((hull, more))
            }
            Err(why) => wrong(
                format!("{} has no convex hull: {why}", shell.called()),
                "write the stone again with fewer faces",
            ),
        }
    }

    /// The convex polyhedron of faces of which the coplanar ones are merged.
    fn merged(vertices: &[[f64; 3]], faces: &[Vec<u32>], size: f64) -> Result<Self, Fault> {
        // Curved surfaces of small faces have no plane regions of a simple outline: each face stays by itself.
        let own = merged(vertices, faces, FLAT * size);
        let own = own.or_else(|why| merged(vertices, faces, FINE * size).map_err(|_| why))?;
        own.require_convex(size)?;
        Ok(own)
    }

    /// Volume [mm³].
    pub(in crate::deck) fn volume(&self) -> f64 {
        volume(&self.corners, &self.faces)
    }

    /// Area vector of a face [mm²].
    pub(in crate::deck) fn area_vector(&self, face: usize) -> [f64; 3] {
        area_vector(&self.corners, &self.faces[face])
    }

    /// Centroid of a face [mm].
    pub(in crate::deck) fn middle_of(&self, face: usize) -> [f64; 3] {
        let normal = self.area_vector(face);
        let corners = &self.faces[face];
        let at = |n: u32| self.corners[n as usize];
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for pair in corners[1..].windows(2) {
            let triangle = [at(corners[0]), at(pair[0]), at(pair[1])];
            let area = cross(
                difference(triangle[1], triangle[0]),
                difference(triangle[2], triangle[0]),
            );
            let weight = dot(area, normal);
            total += weight;
            (0..3)
                .for_each(|d| sum[d] += weight * triangle.iter().map(|x| x[d]).sum::<f64>() / 3.0);
        }
        sum.map(|x| x / total)
    }

    /// Centroid of the volume [mm].
    pub(in crate::deck) fn middle(&self) -> [f64; 3] {
        let origin = self.corners[0];
        let at = |n: u32| difference(self.corners[n as usize], origin);
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for face in &self.faces {
            for pair in face[1..].windows(2) {
                let [a, b, c] = [face[0], pair[0], pair[1]].map(at);
                let volume = dot(cross(a, b), c);
                total += volume;
                (0..3).for_each(|d| sum[d] += volume * (a[d] + b[d] + c[d]) / 4.0);
            }
        }
        [0, 1, 2].map(|d| origin[d] + sum[d] / total)
    }

    /// Largest distance of a corner from the plane of its face, over the cube root of the volume [-].
    pub(in crate::deck) fn warp(&self) -> f64 {
        let size = self.volume().cbrt();
        let of_face = |f: usize| {
            let plane = self.plane(f);
            let corners = self.faces[f].iter();
            corners
                .map(|n| plane.above(self.corners[*n as usize]).abs())
                .fold(0.0, f64::max)
        };
        (0..self.faces.len()).map(of_face).fold(0.0, f64::max) / size
    }

    fn plane(&self, face: usize) -> Plane {
        let area = self.area_vector(face);
        let length = norm(area);
        let corners = &self.faces[face];
        let count = corners.len() as f64;
        Plane {
            normal: area.map(|x| x / length),
            origin: [0, 1, 2].map(|d| {
                corners
                    .iter()
                    .map(|n| self.corners[*n as usize][d])
                    .sum::<f64>()
                    / count
            }),
        }
    }

    fn require_convex(&self, size: f64) -> Result<(), Fault> {
        if self.corners.len() > MOST_CORNERS {
            return Err(Fault::Corners(self.corners.len()));
        }
        for (f, face) in self.faces.iter().enumerate() {
            let plane = self.plane(f);
            for (n, x) in self.corners.iter().enumerate() {
                let above = plane.above(*x);
                if above > CONVEX * size && !face.contains(&(n as u32)) {
                    return Err(Fault::Above(*x, plane.origin, above));
                }
            }
        }
        Ok(())
    }
}

/// A plane with its outward unit normal.
pub(super) struct Plane {
    pub(super) normal: [f64; 3],
    pub(super) origin: [f64; 3],
}

impl Plane {
    /// Distance of a point above the plane [mm].
    pub(super) fn above(&self, x: [f64; 3]) -> f64 {
        dot(self.normal, difference(x, self.origin))
    }
}

/// Reason why a shell is no convex polyhedron.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fault {
    /// A corner lies outside the plane of a face: corner, middle of the face, distance [mm].
    Above([f64; 3], [f64; 3], f64),
    /// A face near this point has a hole, or touches itself.
    Hole([f64; 3]),
    /// The number of corners, edges and faces is not that of a shell without holes.
    Holes,
    /// Number of corners, which is too large.
    Corners(usize),
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Above(corner, face, above) => {
                let (corner, face) = (point(*corner), point(*face));
                write!(
                    f,
                    "its corner {corner} lies {above:.3} mm outside its face at {face}"
                )
            }
            Self::Hole(x) => write!(f, "its face at {} has a hole, or touches itself", point(*x)),
            Self::Holes => f.write_str("it has a hole through it, or touches itself"),
            Self::Corners(count) => write!(f, "it has {count} corners"),
        }
    }
}
