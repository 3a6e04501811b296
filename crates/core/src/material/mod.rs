//! Pure point laws of the solids: (strain, old history) → (stress, tangent, new history).

pub mod damage_plasticity;
pub mod law;
pub mod parameters;
mod return_map;
pub mod uniaxial;

pub use damage_plasticity::DamagePlasticity;
pub use law::{LocalFailure, MaterialHistory, PointEnergy, Response};
pub use parameters::{
    DamagePlasticityParameters, ElasticParameters, Interpolation, MaterialParameters, TableRow,
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
    /// Law of a material in elements of equivalent length `l_eq` [mm] (theory A.8); none for a
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

    /// Intact part 1 − d̃ and stress [MPa] with viscous strain and damage extrapolated by `ratio`
    /// = Δt/Δt_n times their last change (theory B.3, for the solids alone).
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

    /// Symmetric positive definite stand-in for the tangent of a point of which a part is intact: for one
    /// that yields, asked by its old history and Δt, the consistent one bounded, else (1−d) C₀.
    ///
    /// # Errors
    /// [`LocalFailure`] if the law has no answer.
    pub fn softened(
        &self,
        strain: &Vector6<f64>,
        intact: f64,
        asked: Option<(&MaterialHistory, f64)>,
    ) -> Result<Matrix6<f64>, LocalFailure> {
        match (self, asked) {
            (Self::DamagePlasticity(law), Some((old, dt))) => {
                let tangent = law.update(strain, old, dt, true)?.tangent;
                Ok(law.bounded(&tangent, intact))
            }
            (Self::DamagePlasticity(law), None) => Ok(law.secant_stiffness(intact)),
            (Self::Elastic(e), _) => Ok(elastic_stiffness(e)),
        }
    }
}

/// C₀ : ε without the matrix.
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
