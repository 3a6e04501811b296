//! Blocks of stress in joints that are no rectangles (docs/theory/limit-analysis.md, eq. 8).

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix2, Vector2};

use super::joints::{Joint, area, centroid, clipped};

/// Directions in which blocks of stress lie, beside those of the sides. A multiple of four: a joint that is its own image
/// has images of its directions.
const DIRECTIONS: usize = 36;
/// Borders of blocks in each direction.
const BORDERS: usize = 20;
/// Sides below this part of the outline are chords of curves: the other directions stand for them.
const SIDE: f64 = 1.0 / 12.0;
/// Directions that are one, as part of 1 by which the cosine of their angle differs from it.
const SAME: f64 = 1e-9;
/// Relative difference of the second moments of area below which any axes are principal ones.
const ROUND: f64 = 1e-6;

/// A straight border of a block of stress: pressures up to f_c have at most the moment about it that f_c has on all of the
/// joint beyond it. Lengths are parts of the extent of the joint across the border.
#[derive(Clone, Debug)]
pub struct Border {
    /// How far corners lie beyond it, negative before it. `[corner]`
    pub arms: Vec<f64>,
    /// The same of the centroid.
    pub middle: f64,
    /// Moment about it of the part of the joint beyond it, over the area of the joint.
    pub moment: f64,
}

impl Border {
    /// Borders of a joint. Those of all directions and places would be exact; the moments that these let pass are less than
    /// 2 % too large.
    pub fn all(joint: &Joint) -> Vec<Self> {
        let polygon = joint.flat();
        let (whole, middle) = (area(&polygon), centroid(&polygon));
        let mut borders = Vec::new();
        for along in directions(&polygon) {
            let places: Vec<f64> = polygon.iter().map(|x| x.dot(&along)).collect();
            let low = places.iter().copied().fold(f64::INFINITY, f64::min);
            let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let extent = high - low;
            for k in 1..=BORDERS {
                // Near the ends they are close to each other, so that relative errors are even.
                let depth = 0.5 * (1.0 - (PI * k as f64 / BORDERS as f64).cos());
                let at = high - depth * extent;
                let beyond = beyond(&polygon, along, at);
                let arm = centroid(&beyond).dot(&along) - at;
                borders.push(Self {
                    arms: places.iter().map(|place| (place - at) / extent).collect(),
                    middle: (middle.dot(&along) - at) / extent,
                    moment: area(&beyond) * arm / (whole * extent),
                });
            }
        }
        borders
    }
}

/// Part of a polygon that lies farther along a direction than a border.
fn beyond(polygon: &[Vector2<f64>], along: Vector2<f64>, at: f64) -> Vec<Vector2<f64>> {
    let from = at * along;
    clipped(polygon, from, from + Vector2::new(along.y, -along.x))
}

/// Directions towards the edges of a joint, of length 1: even ones in the plane in which all second moments of area of the
/// joint are equal, and those across its longer sides.
fn directions(polygon: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let [first, second] = axes(polygon);
    let even = (0..DIRECTIONS).map(|k| {
        let (sine, cosine) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
        cosine * first + sine * second
    });
    let sides = || polygon.iter().zip(polygon.iter().cycle().skip(1));
    let outline: f64 = sides().map(|(a, b)| (b - a).norm()).sum();
    let long = sides()
        .map(|(a, b)| b - a)
        .filter(|side| side.norm() >= SIDE * outline);
    let across = long.flat_map(|side| {
        let out = Vector2::new(side.y, -side.x);
        [out, -out]
    });
    let mut all: Vec<Vector2<f64>> = Vec::new();
    for along in even.chain(across) {
        let Some(along) = along.try_normalize(0.0) else {
            continue;
        };
        if all.iter().all(|known| known.dot(&along) < 1.0 - SAME) {
            all.push(along);
        }
    }
    all
}

/// Principal axes of a polygon, each as long as one over its radius of gyration. Of a regular polygon they follow its first
/// side.
fn axes(polygon: &[Vector2<f64>]) -> [Vector2<f64>; 2] {
    let middle = centroid(polygon);
    let mut moments = Matrix2::zeros();
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (a, b) = (a - middle, b - middle);
        let sum = a + b;
        let squares = a * a.transpose() + b * b.transpose() + sum * sum.transpose();
        moments += squares * (a.perp(&b) / 24.0);
    }
    let eigen = moments.symmetric_eigen();
    let [least, most] = [eigen.eigenvalues.min(), eigen.eigenvalues.max()];
    if most - least < ROUND * most {
        let side = (polygon[1] - polygon[0]).try_normalize(0.0);
        let side = side.unwrap_or(Vector2::x());
        return [side, Vector2::new(-side.y, side.x)];
    }
    [0, 1].map(|i| {
        let axis = eigen.eigenvectors.column(i).into_owned();
        axis / eigen.eigenvalues[i].max(f64::MIN_POSITIVE).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limit::joints::Strength;
    use nalgebra::Vector3;

    fn joint(corners: &[[f64; 2]]) -> Joint {
        let corners: Vec<Vector3<f64>> = corners
            .iter()
            .map(|[x, y]| Vector3::new(*x, *y, 0.0))
            .collect();
        let mut joint = Joint {
            bodies: [0, 1],
            frame: [Vector3::z(), Vector3::x(), Vector3::y()],
            corners,
            area: 0.0,
            law: None,
            strength: Strength {
                friction: 0.5,
                cohesion: 0.0,
                tension: 0.0,
            },
        };
        joint.area = area(&joint.flat());
        joint
    }

    /// Largest distance along a direction of length 1 from the centroid at which N of a part of f_c A acts.
    fn eccentricity(joint: &Joint, towards: [f64; 2], part: f64) -> f64 {
        let polygon = joint.flat();
        let middle = centroid(&polygon);
        let mut spread = Matrix2::zeros();
        for x in &polygon {
            spread += (x - middle) * (x - middle).transpose();
        }
        let inverse = spread.try_inverse().unwrap();
        let of_border = |border: &Border| {
            // Arms are linear in the place, so that least squares give their slope.
            let mut slope = Vector2::zeros();
            for (x, arm) in polygon.iter().zip(&border.arms) {
                slope += (x - middle) * (arm - border.middle);
            }
            let rise = (inverse * slope).dot(&Vector2::from(towards));
            if rise > 1e-12 {
                (border.moment / part - border.middle) / rise
            } else {
                f64::INFINITY
            }
        };
        let all = Border::all(joint);
        all.iter().map(of_border).fold(f64::INFINITY, f64::min)
    }

    /// Towards the apex of a triangle of height h the block is a similar one of height h √(N/f_c A), and away from it the
    /// rest beside a similar one.
    #[test]
    fn blocks_in_a_triangle_have_their_closed_forms() {
        let h = 260.0;
        let triangle = joint(&[[0.0, 0.0], [300.0, 0.0], [150.0, h]]);
        for part in [0.1, 0.3, 0.6, 0.95_f64] {
            let apex = 2.0 / 3.0 * h * (1.0 - part.sqrt());
            let found = eccentricity(&triangle, [0.0, 1.0], part);
            assert!(
                found > 0.999 * apex && found < 1.02 * apex,
                "{part}: {found} {apex}"
            );
            // M = 0 of the whole: the rest is a triangle towards the apex.
            let rest = 1.0 - part;
            let base = 2.0 / 3.0 * h * (1.0 - rest.sqrt()) * rest / part;
            let found = eccentricity(&triangle, [0.0, -1.0], part);
            assert!(
                found > 0.999 * base && found < 1.02 * base,
                "{part}: {found} {base}"
            );
        }
    }

    /// Blocks in a circle are its segments.
    #[test]
    fn blocks_in_a_drum_are_segments() {
        let corner = |k: u32| {
            let (sine, cosine) = (TAU * f64::from(k) / 96.0).sin_cos();
            [150.0 * cosine, 150.0 * sine]
        };
        let drum = joint(&(0..96).map(corner).collect::<Vec<_>>());
        for half in [0.5, 1.0, 1.5, 2.0_f64] {
            // Half of the angle of the segment.
            let part = (half - half.sin() * half.cos()) / PI;
            let known = 2.0 / 3.0 * 150.0 * half.sin().powi(3) / (part * PI);
            for degrees in [0.0, 7.0, 45.0, 201.0_f64] {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let found = eccentricity(&drum, [cosine, sine], part);
                // The polygon of 96 sides has 0.07 % less area.
                assert!(
                    found > 0.997 * known && found < 1.02 * known,
                    "{half}: {found} {known}"
                );
            }
        }
    }

    #[test]
    fn shares_of_the_corners_have_the_centroid() {
        for corners in [
            vec![[0.0, 0.0], [300.0, 0.0], [220.0, 200.0], [50.0, 260.0]],
            vec![[0.0, 0.0], [300.0, 0.0], [150.0, 260.0]],
            vec![
                [0.0, 0.0],
                [120.0, -40.0],
                [260.0, 30.0],
                [240.0, 150.0],
                [60.0, 190.0],
            ],
        ] {
            let joint = joint(&corners);
            let shares = joint.shares();
            let sum: f64 = shares.iter().sum();
            assert!((sum / joint.area - 1.0).abs() < 1e-12); // rounding
            let moments = joint.flat().into_iter().zip(&shares).map(|(x, a)| x * *a);
            let place = moments.sum::<Vector2<f64>>() / sum;
            assert!((place - centroid(&joint.flat())).norm() < 1e-9);
        }
        let rectangle = joint(&[[1.0, 2.0], [8.1, 2.0], [8.1, 5.3], [1.0, 5.3]]);
        assert!(rectangle.is_rectangle());
        assert_eq!(rectangle.shares(), vec![rectangle.area / 4.0; 4]);
    }
}
