//! The trait of solid laws: total strain and old history give stress, tangent and new history.
//!
//! Strain, stress and history are small strains, Cauchy stresses and internal variables in the rotated frame of an
//! element, so that a law need not consider rotations. The solver also reads the history. It assumes
//! ```text
//! σ = (1 − d_v) C₀ : (ε − ε_v)                                                                     (1)
//! ```
//!
//! with `viscous_damage` d_v and `viscous_strain` ε_v, wherever it extrapolates (theory/return-map.md, eq. 19), takes
//! a secant, measures a crack or interpolates within an increment. For a law without viscosity [`Response::inviscid`]
//! sets these variables and the energies from `damage` d and `plastic_strain` ε_p.

use std::fmt;
use std::sync::Arc;

use nalgebra::{Matrix6, Vector6};

use super::law::{LocalFailure, MaterialHistory, PointEnergy, Response};
use super::parameters::ElasticParameters;
use super::tangent::bounded;
use super::{Wanted, hooke};
use crate::tensor::ByPoint;

/// One implicit step of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Step time Δt [s], for laws with viscosity.
    pub dt: f64,
    /// Points for which the consistent tangent is wanted; other tangents are not read.
    pub tangent: Wanted,
}

/// A scalar of [`MaterialHistory`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// κ_t [-].
    KappaT,
    /// κ_c [-].
    KappaC,
    /// d [-].
    Damage,
    /// d_t [-].
    TensileDamage,
    /// d_c [-].
    CompressiveDamage,
    /// A component of ε_p [-], 0 to 5 in Voigt order, engineering shear.
    PlasticStrain(usize),
}

impl Slot {
    /// Its value in a history.
    pub fn of(self, history: &MaterialHistory) -> f64 {
        match self {
            Self::KappaT => history.kappa_t,
            Self::KappaC => history.kappa_c,
            Self::Damage => history.damage,
            Self::TensileDamage => history.tensile_damage,
            Self::CompressiveDamage => history.compressive_damage,
            Self::PlasticStrain(i) => history.plastic_strain[i],
        }
    }
}

/// A history variable that a law writes to the results, in addition to those of all solids (stress, plastic strain,
/// tensile and compressive damage). Its name is used for an element field (largest value of the eight points) in
/// `results.vtkhdf` and its copies, for a column `max_NAME` of the history (largest value of all points), and for a
/// column of `wythe drive`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawOutput {
    /// Name: letters, digits and `_`.
    pub name: &'static str,
    /// Unit; `1` if dimensionless.
    pub unit: &'static str,
    /// Position in the history.
    pub slot: Slot,
}

impl LawOutput {
    /// An output with name, unit and slot.
    pub const fn new(name: &'static str, unit: &'static str, slot: Slot) -> Self {
        Self { name, unit, slot }
    }

    /// Name of its column in the history.
    pub fn column(&self) -> String {
        format!("max_{}", self.name)
    }

    /// Outputs of several laws, each name once.
    pub fn once<'a>(of: impl Iterator<Item = &'a Self>) -> Vec<Self> {
        let mut once: Vec<Self> = Vec::new();
        for output in of {
            if once.iter().all(|known| known.name != output.name) {
                once.push(*output);
            }
        }
        once
    }
}

/// All points of one element. `[gauss point]`
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// Total strains [-]. `[component][gauss point]`
    pub strain: &'a ByPoint,
    /// Histories at the last accepted increment.
    pub old: &'a [MaterialHistory],
    /// A bit for each point to be computed.
    pub which: u8,
    /// The step.
    pub increment: Increment,
}

impl Points<'_> {
    /// Total strain [-] of point `g`.
    #[inline(always)]
    pub fn strain_of(&self, g: usize) -> Vector6<f64> {
        let mut strain = Vector6::zeros();
        for k in 0..6 {
            strain[k] = self.strain[k][g];
        }
        strain
    }
}

/// A solid law. Vectors are engineering Voigt, order xx, yy, zz, xy, yz, zx; tension is positive; stresses are in
/// MPa.
///
/// `name`, `elastic` and `update` define a law. All other methods have defaults, which a law overrides where it has a
/// better form. The elasticity must be isotropic, because the element condenses its incompatible modes with it
/// (theory/hex8.md, eq. 4).
pub trait SolidLaw: Send + Sync + fmt::Debug {
    /// Name of the law, as used for `kind` in a deck and in messages.
    fn name(&self) -> &'static str;

    /// Elastic constants and density.
    fn elastic(&self) -> &ElasticParameters;

    /// One implicit step from the history `old` to the total strain [-]. The function must be pure, because a step is
    /// repeated many times before its history is accepted. A step that yields must increase `kappa_t` or `kappa_c`.
    ///
    /// # Errors
    /// [`LocalFailure`] if there is no solution; the increment is then repeated with a smaller size.
    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        increment: Increment,
    ) -> Result<Response, LocalFailure>;

    /// Additional history variables for the results.
    fn outputs(&self) -> &'static [LawOutput] {
        &[]
    }

    /// The law for elements of the equivalent length `l_eq` [mm], in which softening dissipates a given energy per
    /// area of crack. `None`: the law does not depend on the size.
    ///
    /// # Errors
    /// The reason why there is no law for elements of this size.
    fn fitted(&self, l_eq: f64) -> Result<Option<Arc<dyn SolidLaw>>, String> {
        let _ = l_eq;
        Ok(None)
    }

    /// Elastic stresses C₀ : ε [MPa] of eight points, and a bit for each point that certainly remains elastic if it
    /// is in its initial state. Such points are not updated. Default: no bits.
    fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        (super::screen::hooke_by_point(self.elastic(), strain), 0)
    }

    /// Intact part 1 − d̃ [-] and stress [MPa] with viscous strain and damage extrapolated by `ratio` = Δt/Δt_n times
    /// their last change (theory/return-map.md, eq. 19). Default: that of (1).
    fn extrapolated(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        ratio: f64,
    ) -> (f64, Vector6<f64>) {
        let most = MOST_DAMAGE.max(old.viscous_damage);
        let damage = (old.viscous_damage + ratio * old.viscous_damage_step).clamp(0.0, most);
        let viscous = old.viscous_strain + old.viscous_strain_step * ratio;
        let effective = hooke(self.elastic(), &(strain - viscous));
        (1.0 - damage, effective * (1.0 - damage))
    }

    /// Symmetric positive definite approximation [MPa] of the tangent of a yielding point with the intact part
    /// `intact`. Default: the symmetric part of the tangent, with eigenvalues relative to C₀ limited to between 0.3
    /// and 1 times the intact part.
    fn bounded(&self, tangent: &Matrix6<f64>, intact: f64) -> Matrix6<f64> {
        let elastic = self.elastic();
        bounded(
            elastic.bulk_modulus(),
            elastic.shear_modulus(),
            tangent,
            intact,
        )
    }

    /// Elastic stress [MPa] as a fraction of the yield stress in the same direction, for a point in its initial
    /// state: 1 on the yield surface [-]. Default: unknown.
    fn reached(&self, stress: &Vector6<f64>) -> Option<f64> {
        let _ = stress;
        None
    }

    /// [`Self::update`] of those points of an element whose bit is set; the other responses are left unchanged.
    /// Default: one point after the other, without a virtual call for each.
    ///
    /// # Errors
    /// The error of the first point that fails.
    fn update_points(
        &self,
        points: &Points<'_>,
        answers: &mut [Response; 8],
    ) -> Result<(), LocalFailure> {
        for (g, answer) in answers.iter_mut().enumerate() {
            if points.which & (1 << g) != 0 {
                let strain = points.strain_of(g);
                *answer = self.update(&strain, &points.old[g], points.increment)?;
            }
        }
        Ok(())
    }
}

/// Largest extrapolated damage; the remainder keeps the tangent positive definite.
pub(super) const MOST_DAMAGE: f64 = 0.999;

impl Response {
    /// Response of a law without viscosity. `history` holds its internal variables, among them `plastic_strain` and
    /// `damage` of (1). Stress, viscous strain, viscous damage and their changes are set here. The energies follow
    /// from the trapezoidal rule,
    ///
    /// ```text
    /// ψ = ½ σ : (ε − ε_p)                                                                              (2)
    /// D = ½ (σ_n + σ) : Δε_p + ½ (C₀ : e_n) : e Δd,   e = ε − ε_p                                      (3)
    /// ```
    pub fn inviscid(
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        stress: Vector6<f64>,
        tangent: Matrix6<f64>,
        history: MaterialHistory,
    ) -> Self {
        let d_strain = history.plastic_strain - old.viscous_strain;
        let d_damage = history.damage - old.viscous_damage;
        let history = MaterialHistory {
            viscous_strain: history.plastic_strain,
            viscous_damage: history.damage,
            viscous_strain_step: d_strain,
            viscous_damage_step: d_damage,
            stress,
            ..history
        };
        let elastic_strain = strain - history.plastic_strain;
        let intact_before = 1.0 - old.viscous_damage;
        let mut damage = 0.0;
        if d_damage != 0.0 && intact_before > 0.0 {
            damage = 0.5 * old.stress.dot(&elastic_strain) / intact_before * d_damage;
        }
        Self {
            stress,
            tangent,
            history,
            energy: PointEnergy {
                elastic: 0.5 * stress.dot(&elastic_strain),
                plastic_damage: 0.5 * (old.stress + stress).dot(&d_strain) + damage,
                recovery: if d_damage < 0.0 { damage } else { 0.0 },
                viscous: 0.0,
            },
        }
    }

    /// Checks that all numbers are finite; the tangent only if it is wanted.
    ///
    /// # Errors
    /// [`LocalFailure::NotFinite`] with the name of the law.
    pub fn checked(&self, law: &'static str, tangent: bool) -> Result<(), LocalFailure> {
        let finite = |v: &Vector6<f64>| v.iter().all(|x| x.is_finite());
        let h = &self.history;
        let vectors = [h.plastic_strain, h.viscous_strain, h.viscous_strain_step];
        let scalars = [
            h.kappa_t,
            h.kappa_c,
            h.damage,
            h.viscous_damage,
            h.tensile_damage,
            h.compressive_damage,
            h.viscous_damage_step,
            h.crack_band,
            h.crush_band,
        ];
        let e = &self.energy;
        let energies = [e.elastic, e.plastic_damage, e.recovery, e.viscous];
        let what = if !finite(&self.stress) || !finite(&h.stress) {
            "stress"
        } else if tangent && !self.tangent.iter().all(|x| x.is_finite()) {
            "tangent"
        } else if !vectors.iter().all(finite) || !scalars.iter().all(|x| x.is_finite()) {
            "history"
        } else if !energies.iter().all(|x| x.is_finite()) {
            "energy"
        } else {
            return Ok(());
        };
        Err(LocalFailure::NotFinite { law, what })
    }
}

impl Default for Response {
    fn default() -> Self {
        Self {
            stress: Vector6::zeros(),
            tangent: Matrix6::zeros(),
            history: MaterialHistory::default(),
            energy: PointEnergy::default(),
        }
    }
}

/// A user-defined law, shared by all elements of its material.
#[derive(Clone, Debug)]
pub struct CustomLaw(pub Arc<dyn SolidLaw>);

impl PartialEq for CustomLaw {
    /// Equality means the same object, not equal parameters.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl std::ops::Deref for CustomLaw {
    type Target = dyn SolidLaw;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}
