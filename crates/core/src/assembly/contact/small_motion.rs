//! Stiffness of the joints for small motions about a state.

use wythe_contact::Symmetric;

use super::evaluate::write_cells;
use super::{Contact, Sight};
use crate::assembly::pattern::CELL;
use crate::assembly::small_motion::PointMotion;
use crate::assembly::trial::Trial;

impl Contact {
    /// Writes the stiffness of all points to the contact cells, the first of which is `first_cell`. `stiffness` gives
    /// normal and shear stiffness [N/mm³] of a point; zero for a point that carries nothing.
    ///
    /// The tractions turn with the facets in the exact stiffness only, which is not symmetric; their part is left out.
    pub fn write_small_motion(
        &self,
        trial: &mut Trial,
        first_cell: usize,
        stiffness: &dyn Fn(PointMotion) -> [f64; 2],
    ) {
        let (x, pairs) = (&trial.x, &trial.joints.pairs);
        for f in 0..self.points.len() / 4 {
            let range = self.candidates.range(f);
            let range = first_cell + range.start..first_cell + range.end;
            let slave = self.slave.corners(f, x);
            let mut parts = Vec::with_capacity(4);
            for p in 4 * f..4 * f + 4 {
                let pair = pairs[p];
                let Some(facet) = pair.facet.filter(|_| !self.is_image(p)) else {
                    continue;
                };
                let Some((cell, kin)) = self.see(p, &slave, pair, pair, x) else {
                    continue;
                };
                let sight = Sight::new(cell, &kin);
                let area = self.points[p].area;
                let [normal, shear] = stiffness(PointMotion {
                    point: p,
                    facet,
                    gap: self.opening(p, sight.gap),
                    area,
                });
                if normal > 0.0 || shear > 0.0 {
                    let k = [normal, shear, 0.0, shear];
                    parts.push((
                        sight.cell,
                        Symmetric::new(sight.weights, &sight.frame, k, area),
                    ));
                }
            }
            let active = &mut trial.cells.active[range.clone()];
            active.fill(false);
            let cells = &mut trial.cells.stiffness[range.start * CELL..range.end * CELL];
            write_cells(pulp::Scalar::new(), &parts, active, cells);
        }
    }

    /// Mean edge of the facets [mm].
    pub fn edge(&self) -> f64 {
        self.distances.skin / super::SKIN
    }
}
