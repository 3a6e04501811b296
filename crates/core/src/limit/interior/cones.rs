//! Cones of the interior-point method: rays x ≥ 0 and second-order cones x₀ ≥ |(x₁, x₂)|, with their scaling
//! (Nesterov and Todd 1997).

/// A cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One row, not negative.
    Ray,
    /// Three rows, the first one at least the length of the others.
    Round,
}

/// A cone with its first row and its scaling W, for which W z = W⁻¹ s.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// Shape.
    pub shape: Shape,
    /// First row.
    pub first: usize,
    /// Axis of W, of hyperbolic length 1.
    axis: [f64; 3],
    /// Size of W.
    size: f64,
}

/// u₀² − u₁² − u₂².
fn hyperbolic(u: &[f64]) -> f64 {
    let shear = u[1].hypot(u[2]);
    (u[0] - shear) * (u[0] + shear)
}

impl Cone {
    /// A cone with W = 1.
    pub fn new(shape: Shape, first: usize) -> Self {
        Self {
            shape,
            first,
            axis: [1.0, 0.0, 0.0],
            size: 1.0,
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self.shape {
            Shape::Ray => 1,
            Shape::Round => 3,
        }
    }

    /// Own rows of a vector.
    pub fn of<'a>(&self, v: &'a [f64]) -> &'a [f64] {
        &v[self.first..self.first + self.rows()]
    }

    /// Own rows of a vector.
    pub fn of_mut<'a>(&self, v: &'a mut [f64]) -> &'a mut [f64] {
        &mut v[self.first..self.first + self.rows()]
    }

    /// Makes W the identity.
    pub fn reset(&mut self) {
        *self = Self::new(self.shape, self.first);
    }

    /// Sets W from s and z inside of the cone; false if rounding has put one of them on its boundary.
    pub fn scale(&mut self, s: &[f64], z: &[f64]) -> bool {
        let (s, z) = (self.of(s), self.of(z));
        match self.shape {
            Shape::Ray => {
                self.size = (s[0] / z[0]).sqrt();
            }
            Shape::Round => {
                let (long_s, long_z) = (hyperbolic(s).sqrt(), hyperbolic(z).sqrt());
                let product: f64 = s.iter().zip(z).map(|(a, b)| a * b).sum();
                let gamma = (0.5 + 0.5 * product / (long_s * long_z)).sqrt();
                let mix =
                    |i: usize, sign: f64| (s[i] / long_s + sign * z[i] / long_z) / (2.0 * gamma);
                let [_, a, b] = [0.0, mix(1, -1.0), mix(2, -1.0)];
                // Of hyperbolic length 1 whatever the rounding.
                self.axis = [(1.0 + a * a + b * b).sqrt(), a, b];
                self.size = (long_s / long_z).sqrt();
            }
        }
        self.size.is_finite() && self.size > 0.0 && self.axis.iter().all(|a| a.is_finite())
    }

    /// v ← W v on own rows.
    pub fn apply(&self, v: &mut [f64]) {
        self.act(v, 1.0, self.size);
    }

    /// v ← W⁻¹ v on own rows.
    pub fn unapply(&self, v: &mut [f64]) {
        self.act(v, -1.0, 1.0 / self.size);
    }

    fn act(&self, v: &mut [f64], sign: f64, size: f64) {
        match self.shape {
            Shape::Ray => v[0] *= size,
            Shape::Round => {
                let [a, b, c] = [self.axis[0], sign * self.axis[1], sign * self.axis[2]];
                let shear = b * v[1] + c * v[2];
                let along = v[0] + shear / (1.0 + a);
                v[0] = size * (a * v[0] + shear);
                v[1] = size * (v[1] + b * along);
                v[2] = size * (v[2] + c * along);
            }
        }
    }

    /// u ∘ v, the product of which λ ∘ λ is that of s and z.
    pub fn product(&self, u: &[f64], v: &[f64]) -> [f64; 3] {
        match self.shape {
            Shape::Ray => [u[0] * v[0], 0.0, 0.0],
            Shape::Round => [
                u[0] * v[0] + u[1] * v[1] + u[2] * v[2],
                u[0] * v[1] + v[0] * u[1],
                u[0] * v[2] + v[0] * u[2],
            ],
        }
    }

    /// u of λ ∘ u = v.
    pub fn quotient(&self, l: &[f64], v: &[f64]) -> [f64; 3] {
        match self.shape {
            Shape::Ray => [v[0] / l[0], 0.0, 0.0],
            Shape::Round => {
                let first = (l[0] * v[0] - l[1] * v[1] - l[2] * v[2]) / hyperbolic(l);
                [
                    first,
                    (v[1] - first * l[1]) / l[0],
                    (v[2] - first * l[2]) / l[0],
                ]
            }
        }
    }

    /// Distance of own rows from the boundary, negative outside.
    pub fn depth(&self, v: &[f64]) -> f64 {
        let v = self.of(v);
        match self.shape {
            Shape::Ray => v[0],
            Shape::Round => v[0] - v[1].hypot(v[2]),
        }
    }

    /// Largest step along d from v inside of the cone to its boundary.
    pub fn step(&self, v: &[f64], d: &[f64]) -> f64 {
        let (v, d) = (self.of(v), self.of(d));
        match self.shape {
            Shape::Ray if d[0] < 0.0 => -v[0] / d[0],
            Shape::Ray => f64::INFINITY,
            Shape::Round => {
                // Least positive root of a α² + 2 b α + c.
                let a = hyperbolic(d);
                let b = v[0] * d[0] - v[1] * d[1] - v[2] * d[2];
                let c = hyperbolic(v).max(0.0);
                let root = b * b - a * c;
                if root < 0.0 || (a >= 0.0 && b >= 0.0) {
                    // d leads inwards, or the line misses the boundary.
                    return f64::INFINITY;
                }
                if b >= 0.0 {
                    (b + root.sqrt()) / -a
                } else {
                    c / (root.sqrt() - b)
                }
            }
        }
    }
}
