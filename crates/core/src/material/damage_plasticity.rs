//! Concrete damaged plasticity (theory/damage-plasticity.md and theory/return-map.md): Lubliner's yield function in
//! effective stress, a hyperbolic Drucker–Prager potential, one scalar damage with stiffness recovery, and
//! Duvaut–Lions viscosity.

use std::sync::Arc;

use nalgebra::{Matrix6, Vector3, Vector6};

use super::band::{BandWidths, Curves, Extent};
use super::law::{LocalFailure, MaterialHistory, PointEnergy, Response};
use super::parameters::{DamagePlasticityParameters, ElasticParameters};
use super::return_map::{Point, TrialStress, weight};
use super::screen::FirstYield;
use super::solid_law::MOST_DAMAGE;
use super::uniaxial::{Curve, TableError, TableWarning};
use super::{Wanted, hooke};
use crate::tensor;

/// The law for elements of one size.
#[derive(Clone, Debug)]
pub struct DamagePlasticity {
    pub(super) elastic: ElasticParameters,
    /// Shear modulus G [MPa].
    pub(super) shear: f64,
    /// Bulk modulus K [MPa].
    pub(super) bulk: f64,
    /// α of the yield function (theory/damage-plasticity.md, eq. 3).
    pub(super) alpha: f64,
    /// γ of the yield function (theory/damage-plasticity.md, eq. 3).
    pub(super) gamma: f64,
    /// T = tan ψ (theory/damage-plasticity.md, eq. 6).
    pub(super) dilation: f64,
    /// a = ε σ_t0 T [MPa] (theory/damage-plasticity.md, eq. 6).
    pub(super) a: f64,
    pub(super) curves: Arc<Curves>,
    extent: Extent,
    /// F at the initial state.
    pub(super) first_yield: FirstYield,
    pub(super) tension_recovery: f64,
    pub(super) compression_recovery: f64,
    viscosity: f64,
    /// Largest rate of damage [1/s].
    damage_rate: f64,
    /// Viscosity of the material [s]; that of a step may be larger.
    own_viscosity: f64,
}

/// A step is plastic if the yield function exceeds this fraction of σ̄_c (theory/return-map.md, Algorithm, step 1).
const YIELD: f64 = 1e-10;
impl DamagePlasticity {
    /// The law for elements of the equivalent length `l_eq` [mm]. Without a length, or without `reference_length` in
    /// the parameters, the tables are used as given.
    ///
    /// # Errors
    /// [`TableError`].
    /// [`TableError`].
    pub fn new(
        parameters: &DamagePlasticityParameters,
        l_eq: Option<f64>,
    ) -> Result<(Self, Vec<TableWarning>), TableError> {
        let (curves, warnings) = Curves::of_length(parameters, l_eq)?;
        let extent = Extent::ball(l_eq.unwrap_or_default());
        Ok((Self::with(parameters, curves, extent), warnings))
    }

    /// The law with given curves for an element with this extent.
    pub fn with(
        parameters: &DamagePlasticityParameters,
        curves: Arc<Curves>,
        extent: Extent,
    ) -> Self {
        let p = parameters;
        let [tension, compression] =
            [&curves.tension, &curves.compression].map(|of| of.curve(0).first_yield());
        let dilation = p.dilation_angle.tan();
        let alpha = (p.fb0_fc0 - 1.0) / (2.0 * p.fb0_fc0 - 1.0);
        let strength = (1.0 - alpha) * compression;
        Self {
            elastic: p.elastic,
            shear: p.elastic.shear_modulus(),
            bulk: p.elastic.bulk_modulus(),
            alpha,
            gamma: 3.0 * (1.0 - p.k_c) / (2.0 * p.k_c - 1.0),
            dilation,
            a: p.eccentricity * tension * dilation,
            first_yield: FirstYield {
                by_mean: 3.0 * alpha,
                by_largest: strength / tension - (1.0 + alpha),
                by_negative: 3.0 * (1.0 - p.k_c) / (2.0 * p.k_c - 1.0),
                strength,
            },
            curves,
            extent,
            tension_recovery: p.tension_recovery,
            compression_recovery: p.compression_recovery,
            viscosity: p.viscosity,
            damage_rate: f64::INFINITY,
            own_viscosity: p.viscosity,
        }
    }

    /// Sets the viscosity to the larger of the material's and `viscosity` [s], and limits the rate of damage.
    pub fn stabilise(&mut self, viscosity: f64, damage_rate: f64) {
        self.viscosity = self.own_viscosity.max(viscosity);
        self.damage_rate = damage_rate;
    }

    /// Removes all viscosity, that of the material too, and the limit on the rate of damage.
    pub fn make_prompt(&mut self) {
        (self.viscosity, self.damage_rate) = (0.0, f64::INFINITY);
    }

    /// Whether a viscosity acts.
    pub fn is_viscous(&self) -> bool {
        self.viscosity > 0.0
    }

    /// Elastic parameters.
    pub fn elastic(&self) -> &ElasticParameters {
        &self.elastic
    }

    /// Tension curve; the one of the narrowest band if there are several.
    pub fn tension(&self) -> &Curve {
        self.curves.tension.curve(0)
    }

    /// Compression curve; the one of the narrowest band if there are several.
    pub fn compression(&self) -> &Curve {
        self.curves.compression.curve(0)
    }

    /// Energy per volume that softening has dissipated beyond the tables' in bands that count as narrower than they are
    /// [N/mm²], in tension and in compression (theory/crack-band.md, eq. 9).
    pub fn narrowing_excess(&self, history: &MaterialHistory) -> [f64; 2] {
        let (h, e) = (history, self.elastic.E);
        let Curves {
            tension,
            compression,
        } = &*self.curves;
        [
            tension.excess(h.crack_band, h.kappa_t, e),
            compression.excess(h.crush_band, h.kappa_c, e),
        ]
    }

    /// (1−α) F at effective stress σ̄ and hardening κ_t, κ_c (theory/damage-plasticity.md, eq. 2) [MPa].
    pub fn yield_function(&self, effective: &Vector6<f64>, kappa_t: f64, kappa_c: f64) -> f64 {
        self.point(&invariants(effective, kappa_t, kappa_c), 0.0).f
    }

    /// One implicit step of duration `dt` [s] to the total strain.
    ///
    /// # Errors
    /// [`LocalFailure`] if the strain is not finite or the return map finds no root.
    pub fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        dt: f64,
        want_tangent: bool,
    ) -> Result<Response, LocalFailure> {
        let wanted = if want_tangent {
            Wanted::Everywhere
        } else {
            Wanted::Nowhere
        };
        // Compile for every vector unit, as is done for elements, in which the step is inlined.
        pulp::Arch::new().dispatch(OneStep {
            law: self,
            strain,
            old,
            dt,
            wanted,
        })
    }

    /// [`Self::update`], with the tangent only where it is wanted.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "the formulas of one implicit step and its consistent tangent"
    )]
    pub(super) fn step(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        dt: f64,
        wanted: Wanted,
    ) -> Result<Response, LocalFailure> {
        if !strain.iter().all(|e| e.is_finite()) {
            return Err(LocalFailure::StrainNotFinite);
        }
        let trial_stress = hooke(&self.elastic, &(strain - old.plastic_strain));
        let inviscid = self.inviscid(&trial_stress, old, wanted)?;
        let (_, damage) = self.intact(&inviscid.point);
        let want_tangent = inviscid.is_wanted(wanted);
        if !inviscid.is_plastic() && rests(old, damage) {
            return Ok(self.at_rest(strain, old, &inviscid, want_tangent));
        }
        let mut history = MaterialHistory {
            plastic_strain: old.plastic_strain,
            kappa_t: inviscid.point.kappa_t,
            kappa_c: inviscid.point.kappa_c,
            damage,
            crack_band: inviscid.bands[0],
            crush_band: inviscid.bands[1],
            tensile_damage: inviscid.point.tension.damage.max(old.tensile_damage),
            compressive_damage: inviscid
                .point
                .compression
                .damage
                .max(old.compressive_damage),
            ..*old
        };
        // ε_p grows by λN = (3/2) φ s + (λT/3) 1 (theory/return-map.md, eq. 4); shear components are doubled.
        if inviscid.is_plastic() {
            let (phi, volume) = (
                1.5 * inviscid.point.phi,
                inviscid.point.lambda * self.dilation / 3.0,
            );
            for i in 0..3 {
                history.plastic_strain[i] += phi * inviscid.deviator[i] + volume;
                history.plastic_strain[3 + i] += 2.0 * phi * inviscid.deviator[3 + i];
            }
        }
        // Duvaut–Lions viscosity by backward Euler, θ = Δt/(μ+Δt) (theory/damage-plasticity.md, eq. 13).
        let mut theta = if self.viscosity > 0.0 {
            dt / (self.viscosity + dt)
        } else {
            1.0
        };
        // If damage would exceed its largest rate, damage and plastic strain are both delayed.
        let (rise, most) = (damage - old.viscous_damage, self.damage_rate * dt);
        let held_back = rise > most && most < theta * rise;
        if held_back {
            theta = most / rise;
        }
        history.viscous_strain =
            history.plastic_strain * theta + old.viscous_strain * (1.0 - theta);
        history.viscous_damage = theta * history.damage + (1.0 - theta) * old.viscous_damage;
        history.viscous_strain_step = history.viscous_strain - old.viscous_strain;
        history.viscous_damage_step = history.viscous_damage - old.viscous_damage;
        if !inviscid.is_plastic() && self.viscosity == 0.0 && theta == 1.0 {
            // A change of r in an elastic step, or the last change after a viscosity ended, must not be extrapolated.
            history.viscous_strain_step = Vector6::zeros();
            history.viscous_damage_step = 0.0;
        }
        let elastic_strain = strain - history.viscous_strain;
        let effective = hooke(&self.elastic, &elastic_strain);
        history.stress = effective * (1.0 - history.viscous_damage);
        let energy = self.energies(old, &history, &elastic_strain, &effective, &inviscid);
        let intact = 1.0 - history.viscous_damage;
        let tangent = if !want_tangent {
            Matrix6::zeros()
        } else if held_back {
            // The increment of damage is fixed by its rate, so that it has no derivative by the strain.
            self.secant(intact)
        } else {
            self.tangent(&inviscid, theta, intact, &effective)
        };
        Ok(Response {
            stress: history.stress,
            tangent,
            history,
            energy,
        })
    }

    /// Stiffness of a point with the intact part `intact`: (1−d) C₀ [MPa].
    fn secant(&self, intact: f64) -> Matrix6<f64> {
        let mut secant = Matrix6::zeros();
        for i in 0..6 {
            let mut strain = Vector6::zeros();
            strain[i] = 1.0;
            secant.set_column(i, &(hooke(&self.elastic, &strain) * intact));
        }
        secant
    }

    /// Intact part and stress with extrapolated viscous strain and damage.
    pub fn extrapolated(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        ratio: f64,
    ) -> (f64, Vector6<f64>) {
        let most = MOST_DAMAGE.max(old.viscous_damage);
        let damage = (old.viscous_damage + ratio * old.viscous_damage_step).clamp(0.0, most);
        let viscous = old.viscous_strain + old.viscous_strain_step * ratio;
        (
            1.0 - damage,
            hooke(&self.elastic, &(strain - viscous)) * (1.0 - damage),
        )
    }

    /// The inviscid step from a trial stress. Principal directions are computed only if a tangent is wanted.
    #[inline(always)]
    fn inviscid(
        &self,
        trial_stress: &Vector6<f64>,
        old: &MaterialHistory,
        wanted: Wanted,
    ) -> Result<Inviscid, LocalFailure> {
        let mean = tensor::mean(trial_stress);
        let deviator = trial_stress - tensor::UNIT * mean;
        let q = (1.5 * tensor::norm_squared(&deviator)).sqrt();
        let (kappa_t, kappa_c) = (old.kappa_t, old.kappa_c);
        let mut trial = TrialStress {
            mean,
            q,
            s: [0.0; 3],
            kappa_t,
            kappa_c,
            curve_index: [0; 2],
        };
        let mut bands = [old.crack_band, old.crush_band];
        if self.has_bands() {
            trial.curve_index = self.indices(bands);
        }
        let tension = self.curves.tension.curve(trial.curve_index[0]).at(kappa_t);
        let compression = self
            .curves
            .compression
            .curve(trial.curve_index[1])
            .at(kappa_c);
        // Without damage r does not affect the stress, and a bound of F suffices. The bound σ_max ≤ σ_m + (2/3) q
        // needs no principal values.
        let largest = (mean + 2.0 / 3.0 * q).max(0.0);
        let bound = self.yield_value(q, mean, largest, &tension, &compression);
        let recovering = self.compression_recovery * tension.damage != 0.0
            || self.tension_recovery * compression.damage != 0.0;
        if bound <= 0.0 && self.beta(&tension, &compression) >= 0.0 && !recovering {
            let point = Point::elastic(mean, tension, compression, kappa_t, kappa_c, bound);
            return Ok(Inviscid {
                trial,
                point,
                deviator,
                directions: None,
                bands,
            });
        }
        let principal = tensor::Principal::of(&deviator);
        trial.s = principal.values();
        let mut point = self.point(&trial, 0.0);
        // A value that is not finite has no root either.
        if point.f > YIELD * compression.effective || !point.f.is_finite() {
            if self.seeks_bands(old) {
                bands = self.bands(&principal.directions(), old);
                trial.curve_index = self.indices(bands);
                // The stress is unchanged, but the curve differs from here on.
                point = self.point(&trial, 0.0);
            }
            point = self.solve(&trial, &point)?;
        }
        let mut inviscid = Inviscid {
            trial,
            point,
            deviator,
            directions: None,
            bands,
        };
        if inviscid.is_wanted(wanted) {
            inviscid.directions = Some(principal.directions());
        }
        Ok(inviscid)
    }

    /// Whether the bands have individual widths.
    #[inline(always)]
    fn has_bands(&self) -> bool {
        self.curves.tension.has_several() || self.curves.compression.has_several()
    }

    /// Whether the width of a band of this point, should it yield, is still open in one of the branches.
    #[inline(always)]
    fn seeks_bands(&self, old: &MaterialHistory) -> bool {
        let held =
            old.kappa_t > self.curves.tension.onset && old.kappa_c > self.curves.compression.onset;
        self.has_bands() && !held
    }

    /// Indices of the curves for bands of these widths [mm].
    #[inline(always)]
    fn indices(&self, bands: [f64; 2]) -> [usize; 2] {
        [
            self.curves.tension.index(bands[0]),
            self.curves.compression.index(bands[1]),
        ]
    }

    /// Widths of the crack band and of the crush band of a point that yields [mm], across the principal directions of
    /// the trial stress, which the step preserves. They are fixed once the point softens (theory/crack-band.md,
    /// Decisions, "Direction"). The tangent of that step treats them as constant.
    fn bands(&self, directions: &[Vector3<f64>; 3], old: &MaterialHistory) -> [f64; 2] {
        let band = |of: &BandWidths, kappa: f64, held: f64, n: &Vector3<f64>| {
            if kappa > of.onset {
                held
            } else {
                self.extent.across(n)
            }
        };
        [
            band(
                &self.curves.tension,
                old.kappa_t,
                old.crack_band,
                &directions[0],
            ),
            band(
                &self.curves.compression,
                old.kappa_c,
                old.crush_band,
                &directions[2],
            ),
        ]
    }

    /// An elastic step that does not change the history, as in most points of a wall.
    #[inline(always)]
    fn at_rest(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        inviscid: &Inviscid,
        want_tangent: bool,
    ) -> Response {
        let elastic_strain = strain - old.plastic_strain;
        let effective = hooke(&self.elastic, &elastic_strain);
        let intact = 1.0 - old.damage;
        let history = MaterialHistory {
            viscous_strain_step: Vector6::zeros(),
            viscous_damage_step: 0.0,
            stress: effective * intact,
            ..*old
        };
        Response {
            stress: history.stress,
            tangent: if want_tangent {
                self.tangent(inviscid, 1.0, intact, &effective)
            } else {
                Matrix6::zeros()
            },
            history,
            energy: PointEnergy {
                elastic: 0.5 * history.stress.dot(&elastic_strain),
                ..PointEnergy::default()
            },
        }
    }

    /// Factors of the intact part 1 − d = (1 − s_t d_c)(1 − s_c d_t), and d (theory/damage-plasticity.md, eq. 12).
    #[inline(always)]
    pub(super) fn intact(&self, p: &Point) -> ([f64; 2], f64) {
        let s_t = 1.0 - self.tension_recovery * p.r;
        let s_c = 1.0 - self.compression_recovery * (1.0 - p.r);
        let factors = [
            1.0 - s_t * p.compression.damage,
            1.0 - s_c * p.tension.damage,
        ];
        (factors, 1.0 - factors[0] * factors[1])
    }

    /// Energies of the step. With work by the trapezoidal rule the dissipation is exactly ½(σ_n + σ_{n+1}):Δε_v + ½
    /// (C₀:e_n):e_{n+1} Δd_v.
    #[inline(always)]
    fn energies(
        &self,
        old: &MaterialHistory,
        new: &MaterialHistory,
        elastic_strain: &Vector6<f64>,
        effective: &Vector6<f64>,
        inviscid: &Inviscid,
    ) -> PointEnergy {
        let d_strain = new.viscous_strain - old.viscous_strain;
        let d_damage = new.viscous_damage - old.viscous_damage;
        let effective_old = old.stress / (1.0 - old.viscous_damage);
        let plastic = 0.5 * (old.stress + new.stress).dot(&d_strain);
        let damage = 0.5 * effective_old.dot(elastic_strain) * d_damage;
        let mut viscous = 0.0;
        if self.viscosity > 0.0 || new.viscous_damage < new.damage {
            // Work on the overstress: stress and energy release in excess of the inviscid state.
            let relaxed_effective = inviscid.effective();
            let relaxed = relaxed_effective * (1.0 - new.damage);
            let release = |s: &Vector6<f64>| {
                let mean = tensor::mean(s);
                let deviatoric = tensor::norm_squared(&(s - tensor::UNIT * mean));
                deviatoric / (4.0 * self.shear) + mean * mean / (2.0 * self.bulk)
            };
            viscous = (new.stress - relaxed).dot(&d_strain)
                + (release(effective) - release(&relaxed_effective)) * d_damage;
        }
        PointEnergy {
            elastic: 0.5 * new.stress.dot(elastic_strain),
            plastic_damage: plastic + damage - viscous,
            recovery: if d_damage < 0.0 { damage } else { 0.0 },
            viscous,
        }
    }
}

/// Arguments of [`DamagePlasticity::update`].
struct OneStep<'a> {
    law: &'a DamagePlasticity,
    strain: &'a Vector6<f64>,
    old: &'a MaterialHistory,
    dt: f64,
    wanted: Wanted,
}

impl pulp::NullaryFnOnce for OneStep<'_> {
    type Output = Result<Response, LocalFailure>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.law.step(self.strain, self.old, self.dt, self.wanted)
    }
}

/// Whether an elastic step to this damage leaves the history unchanged: no stiffness recovery, and viscous and
/// inviscid variables are equal.
#[inline(always)]
fn rests(old: &MaterialHistory, damage: f64) -> bool {
    damage == old.damage && damage == old.viscous_damage && old.viscous_strain == old.plastic_strain
}

/// The inviscid state at the end of a step.
pub(super) struct Inviscid {
    pub(super) trial: TrialStress,
    pub(super) point: Point,
    /// Deviator of the trial stress.
    pub(super) deviator: Vector6<f64>,
    /// Principal directions; `None` if no derivative needs them.
    pub(super) directions: Option<[Vector3<f64>; 3]>,
    /// Widths of its crack band and its crush band [mm].
    bands: [f64; 2],
}

impl Inviscid {
    #[inline(always)]
    pub(super) fn is_plastic(&self) -> bool {
        self.point.lambda > 0.0
    }

    /// Whether the tangent of this step is wanted.
    #[inline(always)]
    fn is_wanted(&self, wanted: Wanted) -> bool {
        match wanted {
            Wanted::Nowhere => false,
            Wanted::WherePlastic => self.is_plastic(),
            Wanted::Everywhere => true,
        }
    }

    /// Effective stress at the end [MPa].
    #[inline(always)]
    fn effective(&self) -> Vector6<f64> {
        self.deviator * self.point.eta + tensor::UNIT * self.point.mean
    }
}

/// Invariants of a stress as a trial state.
fn invariants(stress: &Vector6<f64>, kappa_t: f64, kappa_c: f64) -> TrialStress {
    let mean = tensor::mean(stress);
    let deviator = stress - tensor::UNIT * mean;
    let q = (1.5 * tensor::norm_squared(&deviator)).sqrt();
    TrialStress {
        mean,
        q,
        s: tensor::principal(&deviator).0,
        kappa_t,
        kappa_c,
        curve_index: [0; 2],
    }
}

/// r(σ̄) of a stress (theory/damage-plasticity.md, eq. 7), for tests and reports.
pub fn tension_weight(effective: &Vector6<f64>) -> f64 {
    weight(&tensor::principal(effective).0)
}
