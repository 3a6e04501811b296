//! How much the crack bands that count as narrower than they are have dissipated too much (theory/crack-band.md, eq. 9).

use super::run::Run;
use crate::material::Material;

/// Part of the dissipation of the solids above which the excess is reported.
const BOUND: f64 = 0.02;

impl Run<'_> {
    /// Warning, if softening in narrowed bands dissipated considerably more than its tables say.
    pub(in crate::solve) fn narrowed_bands(&self) -> Option<String> {
        let bulk = &self.system.bulk;
        let mut excess = vec![0.0; self.model.materials.len()];
        for (e, points) in self.state.material.chunks_exact(8).enumerate() {
            if let Material::DamagePlasticity(law) = bulk.law(e) {
                let material = usize::from(self.model.mesh.material[e]);
                for (point, weight) in points.iter().zip(&bulk.shape(e).weight) {
                    let [tension, compression] = law.narrowing_excess(point);
                    excess[material] += weight * (tension + compression);
                }
            }
        }
        let energies = &self.state.energies;
        let dissipated = energies.plastic_damage + energies.viscous;
        let part = excess.iter().sum::<f64>() / dissipated;
        let materials = self.model.materials.iter().zip(&excess);
        let (worst, _) = materials.max_by(|a, b| a.1.total_cmp(b.1))?;
        (part > BOUND).then(|| {
            format!(
                "cracks in elements that are too wide for the softening of their tables (most in material {}) took {:.1} % \
                 of the energy that the solids dissipated beyond what the tables give: finer elements, or a larger \
                 inelastic strain in the last row, mend that",
                worst.name,
                100.0 * part
            )
        })
    }
}
