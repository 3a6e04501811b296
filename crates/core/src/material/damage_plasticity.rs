//! Concrete damaged plasticity (theory A, B): Lubliner's yield function in effective stress, a
//! hyperbolic Drucker–Prager potential, one scalar damage with stiffness recovery, and
//! Duvaut–Lions viscosity.

use nalgebra::{Matrix6, Vector6};

use super::hooke;
use super::law::{LocalFailure, MaterialHistory, PointEnergy, Response};
use super::parameters::{DamagePlasticityParameters, ElasticParameters};
use super::return_map::{Point, TrialStress, Variation, weight};
use super::uniaxial::{Branch, Curve, TableError, TableWarning};
use crate::sym6;

/// The law in elements of one size.
#[derive(Clone, Debug)]
pub struct DamagePlasticity {
    elastic: ElasticParameters,
    /// Shear modulus G [MPa].
    pub(super) shear: f64,
    /// Bulk modulus K [MPa].
    pub(super) bulk: f64,
    /// α of the yield function (A.2).
    pub(super) alpha: f64,
    /// γ of the yield function (A.2).
    pub(super) gamma: f64,
    /// T = tan ψ (A.3).
    pub(super) dilation: f64,
    /// a = ε σ_t0 T [MPa] (A.3).
    pub(super) a: f64,
    pub(super) tension: Curve,
    pub(super) compression: Curve,
    tension_recovery: f64,
    compression_recovery: f64,
    viscosity: f64,
    /// Viscosity of the material itself, which a step may exceed [s].
    own_viscosity: f64,
}

/// Yield function above which a step is plastic, over σ̄_c (theory B.1).
const YIELD: f64 = 1e-10;
/// Largest extrapolated damage: what is left keeps the tangent positive definite.
const MOST_DAMAGE: f64 = 0.999;

impl DamagePlasticity {
    /// Fits the parameters to elements of equivalent length `l_eq` [mm]; none, or none in the
    /// parameters' `reference_length`: tables as given.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn new(
        parameters: &DamagePlasticityParameters,
        l_eq: Option<f64>,
    ) -> Result<(Self, Vec<TableWarning>), TableError> {
        let p = parameters;
        let scaling = p.reference_length.zip(l_eq);
        let curve = |branch, rows| Curve::new(branch, rows, p.elastic.E, scaling, p.interpolation);
        let (tension, mut warnings) = curve(Branch::Tension, &p.tension)?;
        let (compression, more) = curve(Branch::Compression, &p.compression)?;
        warnings.extend(more);
        let dilation = p.dilation_angle.tan();
        let law = Self {
            elastic: p.elastic,
            shear: p.elastic.shear_modulus(),
            bulk: p.elastic.bulk_modulus(),
            alpha: (p.fb0_fc0 - 1.0) / (2.0 * p.fb0_fc0 - 1.0),
            gamma: 3.0 * (1.0 - p.k_c) / (2.0 * p.k_c - 1.0),
            dilation,
            a: p.eccentricity * tension.first_yield() * dilation,
            tension,
            compression,
            tension_recovery: p.tension_recovery,
            compression_recovery: p.compression_recovery,
            viscosity: p.viscosity,
            own_viscosity: p.viscosity,
        };
        Ok((law, warnings))
    }

    /// Takes the larger of its own viscosity and that of a step [s] from here on.
    pub fn stabilise(&mut self, viscosity: f64) {
        self.viscosity = self.own_viscosity.max(viscosity);
    }

    /// Tension curve.
    pub fn tension(&self) -> &Curve {
        &self.tension
    }

    /// Compression curve.
    pub fn compression(&self) -> &Curve {
        &self.compression
    }

    /// (1−α) F at effective stress σ̄ and hardening κ_t, κ_c (theory A.2) [MPa].
    pub fn yield_function(&self, effective: &Vector6<f64>, kappa_t: f64, kappa_c: f64) -> f64 {
        self.point(&invariants(effective, kappa_t, kappa_c), 0.0).f
    }

    /// One implicit step of `dt` [s] to the total strain.
    ///
    /// # Errors
    /// [`LocalFailure`] for a strain that is not finite, or a return map without a root.
    pub fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        dt: f64,
        want_tangent: bool,
    ) -> Result<Response, LocalFailure> {
        if !strain.iter().all(|e| e.is_finite()) {
            return Err(LocalFailure::StrainNotFinite);
        }
        let trial_stress = hooke(&self.elastic, &(strain - old.plastic_strain));
        let inviscid = self.inviscid(&trial_stress, old, want_tangent)?;
        let mut history = MaterialHistory {
            plastic_strain: old.plastic_strain + inviscid.flow,
            kappa_t: inviscid.point.kappa_t,
            kappa_c: inviscid.point.kappa_c,
            damage: inviscid.damage,
            tensile_damage: inviscid.point.tension.damage.max(old.tensile_damage),
            compressive_damage: inviscid
                .point
                .compression
                .damage
                .max(old.compressive_damage),
            ..*old
        };
        // Theory A.7: backward Euler of Duvaut–Lions, θ = Δt/(μ+Δt).
        let theta = if self.viscosity > 0.0 {
            dt / (self.viscosity + dt)
        } else {
            1.0
        };
        history.viscous_strain =
            history.plastic_strain * theta + old.viscous_strain * (1.0 - theta);
        history.viscous_damage = theta * history.damage + (1.0 - theta) * old.viscous_damage;
        history.viscous_strain_step = history.viscous_strain - old.viscous_strain;
        history.viscous_damage_step = history.viscous_damage - old.viscous_damage;
        if inviscid.point.lambda == 0.0 && self.viscosity == 0.0 {
            // A change of r in an elastic step is no rate to go on with.
            history.viscous_damage_step = 0.0;
        }
        let elastic_strain = strain - history.viscous_strain;
        let effective = hooke(&self.elastic, &elastic_strain);
        let intact = 1.0 - history.viscous_damage;
        let stress = effective * intact;
        history.stress = stress;
        let energy = self.energies(old, &history, &elastic_strain, &effective, &inviscid);
        let tangent = if want_tangent {
            // D = (1−d_v)[(1−θ) C₀ + θ D̄] − θ (C₀:(ε−ε_v)) ⊗ ∇d
            let mut d = inviscid.tangent * (theta * intact);
            if theta < 1.0 {
                d += super::elastic_stiffness(&self.elastic) * ((1.0 - theta) * intact);
            }
            d - effective * inviscid.damage_gradient.transpose() * theta
        } else {
            Matrix6::zeros()
        };
        Ok(Response {
            stress,
            tangent,
            history,
            energy,
        })
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

    /// The inviscid step from a trial stress.
    fn inviscid(
        &self,
        trial_stress: &Vector6<f64>,
        old: &MaterialHistory,
        want_tangent: bool,
    ) -> Result<Inviscid, LocalFailure> {
        let mean = sym6::mean(trial_stress);
        let deviator = trial_stress - sym6::UNIT * mean;
        let q = (1.5 * sym6::norm_squared(&deviator)).sqrt();
        let virgin = old.kappa_t == 0.0 && old.kappa_c == 0.0;
        if virgin && self.surely_elastic(mean, q) {
            let trial = TrialStress {
                mean,
                q,
                s: [0.0; 3],
                kappa_t: 0.0,
                kappa_c: 0.0,
            };
            let tangent = if want_tangent {
                super::elastic_stiffness(&self.elastic)
            } else {
                Matrix6::zeros()
            };
            return Ok(Inviscid {
                point: self.point(&trial, 0.0),
                damage: 0.0,
                flow: Vector6::zeros(),
                effective: *trial_stress,
                tangent,
                damage_gradient: Vector6::zeros(),
            });
        }
        let (s, directions) = sym6::principal(&deviator);
        let trial = TrialStress {
            mean,
            q,
            s,
            kappa_t: old.kappa_t,
            kappa_c: old.kappa_c,
        };
        let mut point = self.point(&trial, 0.0);
        let plastic = point.f > YIELD * point.compression.effective;
        if plastic {
            point = self.solve(&trial)?;
        }
        // ε_p from the flow rule: N = (3/2) s/A + (T/3) 1, s = η s_tr; shear components doubled.
        let mut flow = Vector6::zeros();
        if plastic {
            let factor = if point.a > 0.0 {
                1.5 * point.eta / point.a
            } else {
                0.0
            };
            for i in 0..3 {
                flow[i] = point.lambda * (factor * deviator[i] + self.dilation / 3.0);
                flow[3 + i] = point.lambda * factor * deviator[3 + i] * 2.0;
            }
        }
        let effective = deviator * point.eta + sym6::UNIT * point.mean;
        let (d_t, d_c) = (point.tension.damage, point.compression.damage);
        let s_t = 1.0 - self.tension_recovery * point.r;
        let s_c = 1.0 - self.compression_recovery * (1.0 - point.r);
        let intact = (1.0 - s_t * d_c) * (1.0 - s_c * d_t);
        let mut result = Inviscid {
            point,
            damage: 1.0 - intact,
            flow,
            effective,
            tangent: Matrix6::zeros(),
            damage_gradient: Vector6::zeros(),
        };
        if want_tangent {
            self.differentiate(&trial, &deviator, &directions, plastic, &mut result);
        }
        Ok(result)
    }

    /// A bound of f that needs no principal values: the largest is at most σ_m + (2/3) q.
    fn surely_elastic(&self, mean: f64, q: f64) -> bool {
        let (sc, st) = (self.compression.first_yield(), self.tension.first_yield());
        let beta = ((1.0 - self.alpha) * sc / st - (1.0 + self.alpha)).max(0.0);
        let largest = (mean + 2.0 / 3.0 * q).max(0.0);
        q + 3.0 * self.alpha * mean + beta * largest <= (1.0 - self.alpha) * sc
    }

    /// Effective tangent and gradient of the damage by the strain (theory B.2).
    fn differentiate(
        &self,
        trial: &TrialStress,
        deviator: &Vector6<f64>,
        directions: &[nalgebra::Vector3<f64>; 3],
        plastic: bool,
        result: &mut Inviscid,
    ) {
        let p = result.point;
        // Gradients of the trial invariants; Voigt components of tensors pair with engineering shear.
        let grad_q = if trial.q > 0.0 {
            deviator * (3.0 * self.shear / trial.q)
        } else {
            Vector6::zeros()
        };
        let mut grad_s =
            directions.map(|n| (sym6::dyad(&n) - sym6::UNIT / 3.0) * (2.0 * self.shear));
        average_repeated(&trial.s, &mut grad_s);

        let along = Variation {
            lambda: 1.0,
            ..Variation::default()
        };
        let by_lambda = self.slope(trial, &p, &along);
        let mut eta = Vector6::zeros();
        let mut mean = Vector6::zeros();
        let mut damage = Vector6::zeros();
        for k in 0..6 {
            let mut v = Variation {
                mean: if k < 3 { self.bulk } else { 0.0 },
                q: grad_q[k],
                s: [grad_s[0][k], grad_s[1][k], grad_s[2][k]],
                lambda: 0.0,
            };
            if plastic {
                v.lambda = -self.slope(trial, &p, &v).f / by_lambda.f;
            }
            let slope = self.slope(trial, &p, &v);
            eta[k] = slope.eta;
            mean[k] = slope.mean;
            let (kt, kc) = if plastic {
                (slope.kappa_t, slope.kappa_c)
            } else {
                (0.0, 0.0)
            };
            damage[k] = self.damage_slope(&p, kt, kc, slope.r);
        }
        let mut tangent = Matrix6::zeros();
        for i in 0..3 {
            for j in 0..3 {
                let unit = if i == j { 1.0 } else { 0.0 };
                tangent[(i, j)] = 2.0 * self.shear * p.eta * (unit - 1.0 / 3.0);
            }
            tangent[(3 + i, 3 + i)] = self.shear * p.eta;
        }
        tangent += deviator * eta.transpose() + sym6::UNIT * mean.transpose();
        result.tangent = tangent;
        result.damage_gradient = damage;
    }

    /// dd from dκ_t, dκ_c and dr (theory A.6, B.2).
    fn damage_slope(&self, p: &Point, kappa_t: f64, kappa_c: f64, r: f64) -> f64 {
        let (w_t, w_c) = (self.tension_recovery, self.compression_recovery);
        let (d_t, d_c) = (p.tension.damage, p.compression.damage);
        let (s_t, s_c) = (1.0 - w_t * p.r, 1.0 - w_c * (1.0 - p.r));
        let first = s_t * p.compression.damage_slope * kappa_c - w_t * d_c * r;
        let second = s_c * p.tension.damage_slope * kappa_t + w_c * d_t * r;
        first * (1.0 - s_c * d_t) + second * (1.0 - s_t * d_c)
    }

    /// Energies of the step. With work by the trapezoidal rule the dissipation is
    /// ½(σ_n + σ_{n+1}):Δε_v + ½ (C₀:e_n):e_{n+1} Δd_v to the last bit.
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
        if self.viscosity > 0.0 {
            // Work on the overstress, stress and energy release beyond the inviscid state.
            let relaxed = inviscid.effective * (1.0 - inviscid.damage);
            let release = |s: &Vector6<f64>| {
                let mean = sym6::mean(s);
                let deviatoric = sym6::norm_squared(&(s - sym6::UNIT * mean));
                deviatoric / (4.0 * self.shear) + mean * mean / (2.0 * self.bulk)
            };
            viscous = (new.stress - relaxed).dot(&d_strain)
                + (release(effective) - release(&inviscid.effective)) * d_damage;
        }
        PointEnergy {
            elastic: 0.5 * new.stress.dot(elastic_strain),
            plastic_damage: plastic + damage - viscous,
            recovery: if d_damage < 0.0 { damage } else { 0.0 },
            viscous,
        }
    }
}

/// The inviscid end of a step.
struct Inviscid {
    point: Point,
    damage: f64,
    flow: Vector6<f64>,
    effective: Vector6<f64>,
    tangent: Matrix6<f64>,
    damage_gradient: Vector6<f64>,
}

/// Invariants of a stress taken as trial state.
fn invariants(stress: &Vector6<f64>, kappa_t: f64, kappa_c: f64) -> TrialStress {
    let mean = sym6::mean(stress);
    let deviator = stress - sym6::UNIT * mean;
    let q = (1.5 * sym6::norm_squared(&deviator)).sqrt();
    TrialStress {
        mean,
        q,
        s: sym6::principal(&deviator).0,
        kappa_t,
        kappa_c,
    }
}

/// Coinciding principal values share the mean of their gradients: a subgradient that belongs to no
/// arbitrary choice of directions.
fn average_repeated(s: &[f64; 3], grad: &mut [Vector6<f64>; 3]) {
    let close = 1e-9 * (s[0].abs() + s[2].abs());
    let (upper, lower) = (s[0] - s[1] <= close, s[1] - s[2] <= close);
    if upper && lower {
        *grad = [(grad[0] + grad[1] + grad[2]) / 3.0; 3];
    } else if upper {
        let mean = (grad[0] + grad[1]) / 2.0;
        (grad[0], grad[1]) = (mean, mean);
    } else if lower {
        let mean = (grad[1] + grad[2]) / 2.0;
        (grad[1], grad[2]) = (mean, mean);
    }
}

/// r(σ̄) of a stress (theory A.4), for tests and reports.
pub fn tension_weight(effective: &Vector6<f64>) -> f64 {
    weight(&sym6::principal(effective).0)
}
