//! The program as a matrix: A x + s = b with s in cones.

use std::ops::Range;

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use super::bodies::Wrench;
use super::borders::Border;
use super::joints::Joint;
use super::program::{Corner, Program};
use super::unknowns::Orbit;

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
    /// Matrix, right side and cones. Unknowns: λ, forces at the corners, of rods, reactions. Forces and equations of a
    /// group of bodies are multiples of its size.
    pub(super) fn matrix(&self) -> Matrix {
        let first = self.unknowns.first_rows();
        let equations = first[self.bodies.all.len()];
        let mut bounds = Bounds {
            right: vec![0.0; equations],
            cones: vec![ZeroConeT(equations)],
            ..Bounds::default()
        };
        self.add_equilibrium(&first, &mut bounds);
        self.add_rods(&mut bounds);
        self.add_friction(&mut bounds);
        self.add_crushing(&mut bounds);
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

    /// Eq. 1. Equations of a body that stands for its image, too, are those of both, so that their multipliers are its
    /// velocities.
    fn add_equilibrium(&self, first: &[usize], bounds: &mut Bounds) {
        let Bounds { entries, right, .. } = bounds;
        let unknowns = self.unknowns;
        let mut act = |body: usize, column: usize, part: f64, wrench: &Wrench| {
            let part = part * unknowns.stands_for(body);
            for (m, motion) in unknowns.motions[body].iter().enumerate() {
                entries.add(first[body] + m, column, part * motion.power(wrench));
            }
        };
        for (b, wrench) in self.loads[1].iter().enumerate() {
            act(b, 0, self.scales.live / self.scales.of_body(b), wrench);
        }
        for (column, orbit) in unknowns.orbits() {
            let directions =
                unknowns.directions(orbit, &self.joints[self.corners[orbit.corner].joint]);
            for (i, along) in directions.into_iter().take(orbit.width).enumerate() {
                for member in orbit.members() {
                    let corner = &self.corners[member];
                    let force = unknowns.at_member(orbit, member, self.corners, along);
                    let joint = &self.joints[corner.joint];
                    for (body, sign) in joint.bodies.into_iter().zip([1.0, -1.0]) {
                        let arm = corner.at - self.bodies.all[body].centre;
                        act(body, column + i, 1.0, &Wrench::at(arm, sign * force));
                    }
                }
            }
        }
        let columns = unknowns.first_rod()..;
        for (column, (r, image)) in columns.zip(&unknowns.rods) {
            for rod in [Some(*r), *image].into_iter().flatten() {
                for (body, wrench) in &self.rods[rod].ends {
                    act(*body, column, 1.0, wrench);
                }
            }
        }
        let columns = unknowns.first_rod() + unknowns.rods.len()..;
        for (column, reaction) in columns.zip(&unknowns.reactions) {
            for (body, wrench) in reaction {
                act(*body, column, 1.0, wrench);
            }
        }
        for (b, motions) in unknowns.motions.iter().enumerate() {
            let part = unknowns.stands_for(b) / self.scales.of_body(b);
            for (m, motion) in motions.iter().enumerate() {
                right[first[b] + m] = -part * motion.power(&self.loads[0][b]);
            }
        }
    }

    /// Adds the bounds of the rods.
    fn add_rods(&self, bounds: &mut Bounds) {
        let before = bounds.right.len();
        for (column, (r, _)) in (self.unknowns.first_rod()..).zip(&self.unknowns.rods) {
            let rod = &self.rods[*r];
            let scale = self.scales.between(rod.bodies());
            if rod.most.is_finite() {
                bounds.below(&[(column, 1.0)], rod.most / scale);
            }
            if rod.least.is_finite() {
                bounds.below(&[(column, -1.0)], -rod.least / scale);
            }
        }
        bounds.close(before);
    }

    /// Eq. 2. In a plane it is linear; where there is no shear force, a bound of the normal force.
    fn add_friction(&self, bounds: &mut Bounds) {
        let scale = |corner: &Corner| self.scales.between(self.joints[corner.joint].bodies);
        let corners = self.unknowns.orbits();
        let corners = corners.map(|(column, orbit)| (column, orbit, &self.corners[orbit.corner]));
        // The bound of the shear forces gives μ n + c ≥ 0.
        let follows = |corner: &Corner| {
            corner.friction > 0.0 && corner.friction * corner.tension >= corner.cohesion
        };
        for (column, _, corner) in corners.clone().filter(|(_, orbit, _)| orbit.width == 3) {
            bounds.below(
                &[(column, -corner.friction)],
                corner.cohesion / scale(corner),
            );
            bounds.below(&[(column + 1, -1.0)], 0.0);
            bounds.below(&[(column + 2, -1.0)], 0.0);
            bounds.cones.push(SecondOrderConeT(3));
        }
        let before = bounds.right.len();
        for (column, orbit, corner) in corners {
            let sides: &[f64] = match orbit.width {
                1 if follows(corner) => &[0.0],
                2 => &[1.0, -1.0],
                _ => &[],
            };
            for side in sides {
                let mut terms = vec![(column, -corner.friction)];
                if orbit.width == 2 {
                    terms.push((column + 1, *side));
                }
                bounds.below(&terms, corner.cohesion / scale(corner));
            }
            if !follows(corner) {
                bounds.below(&[(column, -1.0)], corner.tension / scale(corner));
            }
        }
        bounds.close(before);
    }

    /// Eq. 3 at each joint, of two images at one; eq. 8 at those that are no rectangles.
    fn add_crushing(&self, bounds: &mut Bounds) {
        let Some(strength) = self.strength else {
            return;
        };
        let mut first = 0;
        let mut orbits = self.unknowns.orbits().peekable();
        for joint in self.joints {
            let corners = first..first + joint.corners.len();
            first = corners.end;
            let mut orbits_of_joint = Vec::with_capacity(corners.len());
            while let Some(orbit) = orbits.next_if(|(_, orbit)| corners.contains(&orbit.corner)) {
                orbits_of_joint.push(orbit);
            }
            if orbits_of_joint.is_empty() {
                continue;
            }
            let scale = self.scales.between(joint.bodies);
            let tension = joint.strength.tension * joint.area / scale;
            let pressed = Pressed {
                joint,
                corners,
                orbits: orbits_of_joint,
                most: [strength * joint.area / scale + tension, tension],
            };
            if joint.is_rectangle() {
                let mirror = self.unknowns.mirror.as_ref().map(|mirror| mirror.axis);
                pressed.add_edges(mirror, bounds);
            } else {
                pressed.add_borders(bounds);
            }
        }
    }
}

/// A joint with a compressive strength.
struct Pressed<'a> {
    joint: &'a Joint,
    /// Its corners.
    corners: Range<usize>,
    /// Their orbits with the first columns of these.
    orbits: Vec<(usize, &'a Orbit)>,
    /// (f_c + f_t) A and f_t A, over the size of the forces.
    most: [f64; 2],
}

impl Pressed<'_> {
    /// Columns of normal forces, with the number of corners of the joint for which each stands and the sum of their arms.
    fn terms(&self, arms: &[f64]) -> Vec<(usize, f64, f64)> {
        let term = |(column, orbit): &(usize, &Orbit)| {
            let members = orbit.members().filter(|v| self.corners.contains(v));
            let members: Vec<f64> = members.map(|v| arms[v - self.corners.start]).collect();
            (*column, members.len() as f64, members.iter().sum())
        };
        self.orbits.iter().map(term).collect()
    }

    /// Eq. 3. In a plane of symmetry that for edges across it follows from those of the other two.
    fn add_edges(&self, mirror: Option<usize>, bounds: &mut Bounds) {
        let crossed = self.orbits.iter().any(|(_, orbit)| orbit.width == 2);
        let axis = mirror.filter(|_| crossed);
        for edge in self.joint.edges() {
            if axis.is_none_or(|axis| edge[axis].abs() <= 0.5) {
                bounds.crush(self.most, &self.terms(&self.joint.arms(&edge)));
            }
        }
    }

    /// Eq. 8, and N ≤ f_c A.
    fn add_borders(&self, bounds: &mut Bounds) {
        let [most, tension] = self.most;
        let before = bounds.right.len();
        for border in Border::all(self.joint) {
            let terms = self.terms(&border.arms).into_iter();
            let terms: Vec<_> = terms.map(|(column, _, arm)| (column, arm)).collect();
            bounds.below(&terms, most * border.moment - tension * border.middle);
        }
        let counts = self.terms(&vec![0.0; self.corners.len()]).into_iter();
        let counts: Vec<_> = counts.map(|(column, count, _)| (column, count)).collect();
        bounds.below(&counts, most - tension);
        bounds.close(before);
    }
}
