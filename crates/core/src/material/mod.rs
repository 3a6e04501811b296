//! Pure point laws of the solids: (strain, old history) → (stress, tangent, new history).

pub mod band;
pub mod damage_plasticity;
pub mod law;
pub mod parameters;
mod return_map;
#[cfg(test)]
mod sample;
mod screen;
mod tangent;
pub mod uniaxial;

pub use band::{Curves, Extent};
pub use damage_plasticity::DamagePlasticity;
pub use law::{LocalFailure, MaterialHistory, PointEnergy, Response};
pub use parameters::{
    CrackBand, DamagePlasticityParameters, ElasticParameters, Interpolation, MaterialParameters,
    TableRow,
};
pub use uniaxial::{Branch, Curve, TableError, TableWarning};

use nalgebra::{Matrix6, Vector6};

/// Isotropic elastic stiffness C₀ [MPa], engineering Voigt.
pub fn elastic_stiffness(elastic: &ElasticParameters) -> Matrix6<f64> {
    let shear = elastic.shear_modulus();
    let lame = elastic.bulk_modulus() - 2.0 / 3.0 * shear;
    let mut c = Matrix6::zeros();
    for i in 0..3 {
        for j in 0..3 {
            c[(i, j)] = lame;
        }
        c[(i, i)] += 2.0 * shear;
        c[(3 + i, 3 + i)] = shear;
    }
    c
}

/// Any law of the solids.
#[derive(Clone, Debug)]
pub enum Material {
    /// Linear elasticity.
    Elastic(ElasticParameters),
    /// Concrete damaged plasticity.
    DamagePlasticity(Box<DamagePlasticity>),
}

impl Material {
    /// Law of a material in elements of equivalent length `l_eq` [mm] (theory/crack-band.md, eq. 1); none for a
    /// point without size: tables as given.
    ///
    /// # Errors
    /// [`TableError`], naming branch and row.
    pub fn new(
        parameters: &MaterialParameters,
        l_eq: Option<f64>,
    ) -> Result<(Self, Vec<TableWarning>), TableError> {
        match parameters {
            MaterialParameters::Elastic(e) => Ok((Self::Elastic(*e), Vec::new())),
            MaterialParameters::DamagePlasticity(p) => {
                let (law, warnings) = DamagePlasticity::new(p, l_eq)?;
                Ok((Self::DamagePlasticity(Box::new(law)), warnings))
            }
        }
    }

    /// One implicit step of `dt` [s] of step time to the total strain (engineering Voigt).
    ///
    /// # Errors
    /// [`LocalFailure`] if the law has no answer.
    pub fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        dt: f64,
        tangent: bool,
    ) -> Result<Response, LocalFailure> {
        match self {
            Self::Elastic(e) => elastic(e, strain),
            Self::DamagePlasticity(law) => law.update(strain, old, dt, tangent),
        }
    }

    /// Elastic strain [-] under an effective stress [MPa].
    pub fn elastic_strain(&self, effective: &Vector6<f64>) -> Vector6<f64> {
        let elastic = match self {
            Self::Elastic(elastic) => elastic,
            Self::DamagePlasticity(law) => law.elastic(),
        };
        let (shear, bulk) = (elastic.shear_modulus(), elastic.bulk_modulus());
        let mean = crate::tensor::mean(effective);
        let mut strain = (effective - crate::tensor::UNIT * mean) / (2.0 * shear);
        for i in 0..3 {
            strain[i] += mean / (3.0 * bulk);
            // Engineering shear.
            strain[3 + i] *= 2.0;
        }
        strain
    }

    /// Intact part 1 − d̃ and stress [MPa] with viscous strain and damage extrapolated by `ratio`
    /// = Δt/Δt_n times their last change (theory/return-map.md, eqs 19 and 20, for the solids alone).
    pub fn extrapolated(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        ratio: f64,
    ) -> (f64, Vector6<f64>) {
        match self {
            Self::Elastic(e) => (1.0, hooke(e, strain)),
            Self::DamagePlasticity(law) => law.extrapolated(strain, old, ratio),
        }
    }

    /// [`Self::update`], with the tangent where it is wanted.
    ///
    /// # Errors
    /// [`LocalFailure`] if the law has no answer.
    #[inline(always)]
    pub(crate) fn step(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        dt: f64,
        tangent: Wanted,
    ) -> Result<Response, LocalFailure> {
        match self {
            Self::Elastic(e) => elastic(e, strain),
            Self::DamagePlasticity(law) => law.step(strain, old, dt, tangent),
        }
    }

    /// Symmetric positive definite stand-in for the tangent of a point that yields, of which a part is
    /// intact.
    pub(crate) fn bounded(&self, tangent: &Matrix6<f64>, intact: f64) -> Matrix6<f64> {
        match self {
            Self::Elastic(e) => elastic_stiffness(e),
            Self::DamagePlasticity(law) => law.bounded(tangent, intact),
        }
    }
}

/// Where a consistent tangent is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Nowhere.
    Nowhere,
    /// At points that yield.
    WherePlastic,
    /// Everywhere.
    Everywhere,
}

/// C₀ : ε without the matrix.
#[inline(always)]
pub(crate) fn hooke(elastic: &ElasticParameters, e: &Vector6<f64>) -> Vector6<f64> {
    let shear = elastic.shear_modulus();
    let lame = elastic.bulk_modulus() - 2.0 / 3.0 * shear;
    let volume = lame * (e[0] + e[1] + e[2]);
    Vector6::new(
        volume + 2.0 * shear * e[0],
        volume + 2.0 * shear * e[1],
        volume + 2.0 * shear * e[2],
        shear * e[3],
        shear * e[4],
        shear * e[5],
    )
}

#[inline(always)]
fn elastic(
    parameters: &ElasticParameters,
    strain: &Vector6<f64>,
) -> Result<Response, LocalFailure> {
    if !strain.iter().all(|e| e.is_finite()) {
        return Err(LocalFailure::StrainNotFinite);
    }
    let stress = hooke(parameters, strain);
    Ok(Response {
        stress,
        tangent: elastic_stiffness(parameters),
        history: MaterialHistory {
            stress,
            ..MaterialHistory::default()
        },
        energy: PointEnergy {
            elastic: 0.5 * stress.dot(strain),
            ..PointEnergy::default()
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_elastic_strain_gives_its_stress_back() {
        let elastic = ElasticParameters {
            E: 4000.0,
            nu: 0.2,
            density: 0.0,
        };
        let law = Material::Elastic(elastic);
        let stress = Vector6::new(1.0, -2.0, 0.5, 0.3, -0.7, 1.1);
        let back = hooke(&elastic, &law.elastic_strain(&stress));
        // Some roundings of ten numbers of the size of one.
        assert!((back - stress).norm() < 1e-14, "{back}");
    }
}
