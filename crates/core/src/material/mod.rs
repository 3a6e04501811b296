//! Pure point laws of solids: (strain, old history) → (stress, tangent, new history).
//!
//! [`SolidLaw`] is the trait of all of them. The built-in laws are variants of [`Material`], so that the loop over
//! the points of an element needs no virtual call. A user-defined law is [`Material::Custom`], with one virtual call
//! per element. The registry of `kind = "..."` is [`deck::schema::registry`](crate::deck::schema::registry).

pub mod band;
mod built_in;
pub mod by_energy;
pub mod damage_plasticity;
pub mod drucker_prager;
pub mod law;
pub mod parameters;
mod return_map;
#[cfg(test)]
mod sample;
mod screen;
pub mod solid_law;
mod tangent;
pub mod uniaxial;

pub use band::{Curves, Extent};
pub use by_energy::ByEnergy;
pub use damage_plasticity::DamagePlasticity;
pub use drucker_prager::DruckerPrager;
pub use law::{LocalFailure, MaterialHistory, PointEnergy, Response};
pub use parameters::{
    CrackBand, DamagePlasticityParameters, DruckerPragerParameters, ElasticParameters,
    Interpolation, MaterialParameters, TableRow,
};
pub use solid_law::{CustomLaw, Increment, LawOutput, Points, Slot, SolidLaw};
pub use uniaxial::{Branch, Curve, TableError, TableWarning};

use std::sync::Arc;

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

/// Any solid law.
#[derive(Clone, Debug)]
pub enum Material {
    /// Linear elasticity.
    Elastic(ElasticParameters),
    /// Concrete damaged plasticity.
    DamagePlasticity(Box<DamagePlasticity>),
    /// Hyperbolic Drucker–Prager plasticity.
    DruckerPrager(Box<DruckerPrager>),
    /// A user-defined law.
    Custom(Arc<dyn SolidLaw>),
}

impl Material {
    /// The law of a material in elements of the equivalent length `l_eq` [mm] (theory/crack-band.md, eq. 1). `None`
    /// stands for a point without size, for which tables are used as given.
    ///
    /// # Errors
    /// [`TableError`] with branch and row.
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
            MaterialParameters::DruckerPrager(p) => {
                let law = DruckerPrager::new(p, l_eq)?;
                Ok((Self::DruckerPrager(Box::new(law)), Vec::new()))
            }
            MaterialParameters::Custom(CustomLaw(law)) => {
                let fitted = l_eq.map_or(Ok(None), |l_eq| law.fitted(l_eq));
                let name = law.name();
                let fitted = fitted.map_err(|why| TableError::Law { law: name, why })?;
                let law = fitted.unwrap_or_else(|| law.clone());
                Ok((Self::Custom(law), Vec::new()))
            }
        }
    }

    /// The law as a trait object.
    pub fn law(&self) -> &dyn SolidLaw {
        match self {
            Self::Elastic(law) => law,
            Self::DamagePlasticity(law) => &**law,
            Self::DruckerPrager(law) => &**law,
            Self::Custom(law) => &**law,
        }
    }

    /// One implicit step of duration `dt` [s] to the total strain (engineering Voigt).
    ///
    /// # Errors
    /// [`LocalFailure`] if the law has no solution.
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
            Self::DruckerPrager(_) | Self::Custom(_) => {
                let law = self.law();
                let wanted = if tangent {
                    Wanted::Everywhere
                } else {
                    Wanted::Nowhere
                };
                let increment = Increment {
                    dt,
                    tangent: wanted,
                };
                let response = law.update(strain, old, increment)?;
                response.checked(law.name(), tangent)?;
                Ok(response)
            }
        }
    }

    /// Elastic strain [-] under an effective stress [MPa].
    pub fn elastic_strain(&self, effective: &Vector6<f64>) -> Vector6<f64> {
        let elastic = match self {
            Self::Elastic(elastic) => elastic,
            Self::DamagePlasticity(law) => law.elastic(),
            Self::DruckerPrager(_) | Self::Custom(_) => self.law().elastic(),
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
            Self::DruckerPrager(law) => law.extrapolated(strain, old, ratio),
            Self::Custom(law) => law.extrapolated(strain, old, ratio),
        }
    }

    /// [`Self::update`], with the tangent only where it is wanted. Within an element a user-defined law computes all
    /// points at once instead ([`SolidLaw::update_points`]).
    ///
    /// # Errors
    /// [`LocalFailure`] if the law has no solution.
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
            Self::DruckerPrager(law) => law.update(strain, old, Increment { dt, tangent }),
            Self::Custom(law) => law.update(strain, old, Increment { dt, tangent }),
        }
    }

    /// Symmetric positive definite approximation of the tangent of a yielding point with the intact part `intact`.
    pub(crate) fn bounded(&self, tangent: &Matrix6<f64>, intact: f64) -> Matrix6<f64> {
        match self {
            Self::Elastic(e) => elastic_stiffness(e),
            Self::DamagePlasticity(law) => law.bounded(tangent, intact),
            Self::DruckerPrager(law) => law.bounded(tangent, intact),
            Self::Custom(law) => law.bounded(tangent, intact),
        }
    }
}

/// Points for which a consistent tangent is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// At no point.
    Nowhere,
    /// At points that yield.
    WherePlastic,
    /// At all points.
    Everywhere,
}

/// Stress C₀ : ε [MPa] of an elastic strain (engineering Voigt) without forming the matrix.
#[inline(always)]
pub fn hooke(elastic: &ElasticParameters, e: &Vector6<f64>) -> Vector6<f64> {
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
        // Tolerance: some rounding errors of ten numbers of order one.
        assert!((back - stress).norm() < 1e-14, "{back}");
    }
}
