//! The program as a matrix: A x + s = b with s in cones.

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use super::bodies::Wrench;
use super::program::{Corner, Program};
use super::unknowns::{Orbit, members};

/// Matrix entries as they are found.
#[derive(Default)]
struct Triplets {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Triplets {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        if value != 0.0 {
            self.rows.push(row);
            self.columns.push(column);
            self.values.push(value);
        }
    }
}

/// Inequalities as they are found: entries, right sides, cones.
#[derive(Default)]
struct Bounds {
    entries: Triplets,
    right: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Bounds {
    /// Adds Σ value × x[column] ≤ most.
    fn below(&mut self, terms: &[(usize, f64)], most: f64) {
        for (column, value) in terms {
            self.entries.add(self.right.len(), *column, *value);
        }
        self.right.push(most);
    }

    /// Adds the cone N² ≤ f_c A (N − 2 Σ n_v s_v/h): the block of stress f_c that carries N ends at an edge, h is the
    /// depth of the joint towards this edge, and `terms` are columns with the sums of 1 and of 2 s_v/h over their
    /// corners. With a tensile strength N is N + f_t A, and f_c is f_c + f_t: stresses count from −f_t. `most` is
    /// (f_c + f_t) A, `tension` f_t A.
    fn crush(&mut self, [most, tension]: [f64; 2], terms: &[(usize, f64, f64)]) {
        let row = self.right.len();
        for (column, count, arm) in terms {
            let left = count - arm;
            self.entries.add(row, *column, -left);
            self.entries.add(row + 1, *column, -2.0 * count);
            self.entries.add(row + 2, *column, left);
        }
        self.right
            .extend([most + tension, 2.0 * tension, most - tension]);
        self.cones.push(SecondOrderConeT(3));
    }

    /// Closes the rows from `before` on as one cone of inequalities.
    fn close(&mut self, before: usize) {
        if self.right.len() > before {
            self.cones.push(NonnegativeConeT(self.right.len() - before));
        }
    }
}

/// The program A x + s = b with s in cones, of which the first ones are the equations.
pub struct Matrix {
    /// A.
    pub entries: CscMatrix<f64>,
    /// b.
    pub right: Vec<f64>,
    /// Cones.
    pub cones: Vec<SupportedConeT<f64>>,
}

impl Matrix {
    /// Number of equations.
    pub fn equations(&self) -> usize {
        match self.cones.first() {
            Some(ZeroConeT(count)) => *count,
            _ => 0,
        }
    }
}

impl Program<'_> {
    /// Matrix, right side and cones. Unknowns: λ, forces at the corners, of rods, reactions. Forces are multiples of
    /// `scale`.
    pub(super) fn matrix(&self, scale: f64) -> Matrix {
        let first = self.unknowns.first_rows();
        let equations = first[self.bodies.all.len()];
        let mut bounds = Bounds {
            right: vec![0.0; equations],
            cones: vec![ZeroConeT(equations)],
            ..Bounds::default()
        };
        self.add_equilibrium(scale, &first, &mut bounds);
        self.add_rods(scale, &mut bounds);
        self.add_friction(scale, &mut bounds);
        self.add_crushing(scale, &mut bounds);
        let Bounds {
            entries,
            right,
            cones,
        } = bounds;
        let (rows, columns) = (right.len(), self.unknowns.columns());
        let matrix = CscMatrix::new_from_triplets(
            rows,
            columns,
            entries.rows,
            entries.columns,
            entries.values,
        );
        Matrix {
            entries: matrix,
            right,
            cones,
        }
    }

    /// Eq. 1.
    fn add_equilibrium(&self, scale: f64, first: &[usize], bounds: &mut Bounds) {
        let Bounds { entries, right, .. } = bounds;
        let motions = &self.unknowns.motions;
        let mut act = |body: usize, column: usize, part: f64, wrench: &Wrench| {
            for (m, motion) in motions[body].iter().enumerate() {
                entries.add(first[body] + m, column, part * motion.power(wrench));
            }
        };
        let live = self.live_scale(scale) / scale;
        for (b, wrench) in self.loads[1].iter().enumerate() {
            act(b, 0, live, wrench);
        }
        let width = self.unknowns.width();
        for (o, orbit) in self.unknowns.corners.iter().enumerate() {
            let corner = &self.corners[orbit.0];
            let joint = &self.joints[corner.joint];
            let directions = self.unknowns.directions(joint);
            for (i, along) in directions.into_iter().take(width).enumerate() {
                for (body, sign) in joint.bodies.into_iter().zip([1.0, -1.0]) {
                    let arm = corner.at - self.bodies.all[body].centre;
                    let wrench = Wrench::at(arm, sign * along);
                    act(body, 1 + width * o + i, members(orbit), &wrench);
                }
            }
        }
        let rods = self.unknowns.rods.iter();
        let rods = rods.map(|orbit| (members(orbit), &self.rods[orbit.0].ends[..]));
        let single = self.unknowns.reactions.iter();
        let single = single.map(|reaction| (1.0, &reaction[..]));
        for (column, (part, wrenches)) in (self.unknowns.first_rod()..).zip(rods.chain(single)) {
            for (body, wrench) in wrenches {
                act(*body, column, part, wrench);
            }
        }
        for (b, motions) in motions.iter().enumerate() {
            for (m, motion) in motions.iter().enumerate() {
                right[first[b] + m] = -motion.power(&self.loads[0][b]) / scale;
            }
        }
    }

    /// Adds the bounds of the rods.
    fn add_rods(&self, scale: f64, bounds: &mut Bounds) {
        let before = bounds.right.len();
        for (column, (r, _)) in (self.unknowns.first_rod()..).zip(&self.unknowns.rods) {
            let rod = &self.rods[*r];
            if rod.most.is_finite() {
                bounds.below(&[(column, 1.0)], rod.most / scale);
            }
            let least = if rod.compression { -rod.most } else { 0.0 };
            if least.is_finite() {
                bounds.below(&[(column, -1.0)], -least / scale);
            }
        }
        bounds.close(before);
    }

    /// Eq. 2. In a plane it is linear.
    fn add_friction(&self, scale: f64, bounds: &mut Bounds) {
        let width = self.unknowns.width();
        let corners = self.unknowns.corners.iter().enumerate();
        let corners = corners.map(|(o, (v, _))| (1 + width * o, &self.corners[*v]));
        // The bound of the shear forces gives μ n + c ≥ 0.
        let follows = |corner: &Corner| {
            corner.friction > 0.0 && corner.friction * corner.tension >= corner.cohesion
        };
        if width == 3 {
            for (column, corner) in corners.clone() {
                bounds.below(&[(column, -corner.friction)], corner.cohesion / scale);
                bounds.below(&[(column + 1, -1.0)], 0.0);
                bounds.below(&[(column + 2, -1.0)], 0.0);
                bounds.cones.push(SecondOrderConeT(3));
            }
        }
        let before = bounds.right.len();
        for (column, corner) in corners {
            if width == 2 {
                for side in [1.0, -1.0] {
                    let terms = [(column, -corner.friction), (column + 1, side)];
                    bounds.below(&terms, corner.cohesion / scale);
                }
            }
            if follows(corner) {
                continue;
            }
            bounds.below(&[(column, -1.0)], corner.tension / scale);
        }
        bounds.close(before);
    }

    /// Eq. 3. In a plane that for edges across it follows from those of the other two.
    fn add_crushing(&self, scale: f64, bounds: &mut Bounds) {
        let Some(strength) = self.strength else {
            return;
        };
        let mut first = 0;
        let mut orbits = self.unknowns.corners.iter().enumerate().peekable();
        for joint in self.joints {
            let own = first..first + joint.corners.len();
            first = own.end;
            let mut of_joint = Vec::with_capacity(own.len());
            while let Some(orbit) = orbits.next_if(|(_, (v, _))| own.contains(v)) {
                of_joint.push(orbit);
            }
            if of_joint.is_empty() {
                continue;
            }
            let tension = joint.strength.tension * joint.area / scale;
            let most = strength * joint.area / scale + tension;
            for edge in joint.edges() {
                if self
                    .unknowns
                    .axis
                    .is_some_and(|axis| edge[axis].abs() > 0.5)
                {
                    continue;
                }
                let arms = joint.arms(&edge);
                let arm = |v: &usize| arms[v - own.start];
                let term = |(o, orbit): &(usize, &Orbit)| {
                    let both = arm(&orbit.0) + orbit.1.as_ref().map_or(0.0, arm);
                    (1 + self.unknowns.width() * o, members(orbit), both)
                };
                let terms: Vec<_> = of_joint.iter().map(term).collect();
                bounds.crush([most, tension], &terms);
            }
        }
    }
}
