//! Checks that a solid law should pass, for tests of user-defined laws.
//!
//! Each check drives the law along random strain paths and reports the first failure:
//!
//! ```text
//! tangent       dσ/dε of the response = central differences of the stress
//! form          σ = (1 − d_v) C₀ : (ε − ε_v)                                                       (1)
//! balance       ½ (σ_n + σ) : Δε = Δψ + D                                                          (2)
//!  dissipation   σ : Δε_v + ½ (ε − ε_v) : C₀ : (ε − ε_v) Δd_v ≥ 0, unless d_v decreases              (3)
//! objectivity   σ(Q ε Qᵀ) = Q σ(ε) Qᵀ
//! ```
//!
//! The solver reads a history by (1) (`material::solid_law`). (3) uses the forces at the end of the step, where an
//! implicit law satisfies its yield condition. The strains are given in the rotating frame of an element, so that
//! isotropy of the law suffices for objectivity. An anisotropic law fails this check.

use nalgebra::{Matrix3, Rotation3, Vector6};

use crate::material::{
    Increment, LocalFailure, MaterialHistory, Response, SolidLaw, Wanted, hooke,
};

/// Random strain paths from the initial state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paths {
    /// Number of paths.
    pub paths: usize,
    /// Steps per path.
    pub steps: usize,
    /// Strain length of one step [-]; a fifth of the strain at first yield exercises most of a law.
    pub strain: f64,
    /// Duration of each step [s].
    pub dt: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Paths {
    /// Forty paths of thirty steps with this strain length [-].
    pub fn of_step(strain: f64) -> Self {
        Self {
            paths: 40,
            steps: 30,
            strain,
            dt: 1.0,
            seed: 1,
        }
    }
}

/// A failed check and its place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the law `{law}` fails at step {step} of path {path} (strain {strain:?}): {what}")]
pub struct CheckFailure {
    /// Name of the law.
    pub law: &'static str,
    /// Path, from 0.
    pub path: usize,
    /// Step, from 0.
    pub step: usize,
    /// Total strain at the failure [-].
    pub strain: [f64; 6],
    /// The reason.
    pub what: CheckError,
}

/// Reason of a failed check.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// The law returned an error.
    #[error("{0}")]
    Law(LocalFailure),
    /// The tangent differs from the derivative of the stress.
    #[error(
        "tangent entry ({row}, {column}) is {found:.6e} MPa, by differences {expected:.6e} MPa"
    )]
    Tangent {
        /// Component of the stress.
        row: usize,
        /// Component of the strain.
        column: usize,
        /// Entry of the tangent [MPa].
        found: f64,
        /// Finite difference [MPa].
        expected: f64,
    },
    /// Two quantities that should be equal differ.
    #[error("{what}: {found:.9e} where {expected:.9e} belongs (tolerance {tolerance:.1e})")]
    Unequal {
        /// Name of the quantity.
        what: &'static str,
        /// Found.
        found: f64,
        /// Expected.
        expected: f64,
        /// Allowed difference.
        tolerance: f64,
    },
    /// The dissipation is negative.
    #[error("the step dissipates {0:.3e} N/mm²")]
    Dissipation(f64),
    /// Too many points lie near a kink for the check of the tangent to be meaningful.
    #[error(
        "the tangent cannot be checked: at {kinks} of {points} points the finite difference crosses a kink of the law"
    )]
    Kinks {
        /// Points where finite differences of two sizes disagree.
        kinks: usize,
        /// Total number of points.
        points: usize,
    },
}

/// Allowed deviation of tangents from finite differences, relative to C₀; the differences err by some 1e-8.
const TANGENT: f64 = 1e-5;
/// Finite differences of one size and of half of it agree within this fraction of C₀ unless there is a kink between.
const KINK: f64 = 1e-6;
/// Strain of a finite difference divided by that of a step.
const DIFFERENCE: f64 = 1e-4;
/// Allowed rounding of stresses and energies, relative to those of an elastic step of the same strain.
const ROUNDING: f64 = 1e-9;

/// Runs all checks on a solid law: its form, balance, dissipation, objectivity and tangent.
///
/// # Errors
/// The first failure.
pub fn all(law: &dyn SolidLaw, paths: &Paths) -> Result<(), CheckFailure> {
    form(law, paths)?;
    balance(law, paths)?;
    dissipation(law, paths)?;
    objectivity(law, paths)?;
    tangent(law, paths)
}

/// Compares consistent tangents with central differences.
///
/// # Errors
/// The first difference, or kinks at more than a tenth of all points.
pub fn tangent(law: &dyn SolidLaw, paths: &Paths) -> Result<(), CheckFailure> {
    let stiffness = stiffness(law);
    let h = DIFFERENCE * paths.strain;
    let (mut points, mut kinks) = (0, 0);
    let mut last = (0, 0, Vector6::zeros());
    follow(law, paths, |at| {
        last = (at.path, at.step, *at.strain);
        points += 1;
        let stress = |column: usize, by: f64| {
            let mut strain = *at.strain;
            strain[column] += by;
            let increment = Increment {
                dt: paths.dt,
                tangent: Wanted::Nowhere,
            };
            law.update(&strain, at.old, increment).map(|r| r.stress)
        };
        for column in 0..6 {
            let central = |h: f64| -> Result<Vector6<f64>, LocalFailure> {
                Ok((stress(column, h)? - stress(column, -h)?) / (2.0 * h))
            };
            let wide = central(h).map_err(CheckError::Law)?;
            let narrow = central(0.5 * h).map_err(CheckError::Law)?;
            if (wide - narrow).amax() > KINK * stiffness {
                kinks += 1;
                return Ok(());
            }
            for row in 0..6 {
                let (found, expected) = (at.new.tangent[(row, column)], narrow[row]);
                if (found - expected).abs() > TANGENT * stiffness {
                    return Err(CheckError::Tangent {
                        row,
                        column,
                        found,
                        expected,
                    });
                }
            }
        }
        Ok(())
    })?;
    if 10 * kinks <= points {
        return Ok(());
    }
    let (path, step, strain) = last;
    Err(CheckFailure {
        law: law.name(),
        path,
        step,
        strain: strain.into(),
        what: CheckError::Kinks { kinks, points },
    })
}

/// Checks (1): the stress follows from the history.
///
/// # Errors
/// The first step with a different stress.
pub fn form(law: &dyn SolidLaw, paths: &Paths) -> Result<(), CheckFailure> {
    follow(law, paths, |at| {
        let h = &at.new.history;
        let expected = hooke(law.elastic(), &(at.strain - h.viscous_strain));
        let expected = expected * (1.0 - h.viscous_damage);
        let tolerance = ROUNDING * stiffness(law) * at.strain.amax();
        equal(
            "stress of the history",
            &at.new.stress,
            &expected,
            tolerance,
        )?;
        equal("stress in the history", &h.stress, &at.new.stress, 0.0)
    })
}

/// Checks (2): elastic energy and dissipation equal the work of the step.
///
/// # Errors
/// The first step with an energy error.
pub fn balance(law: &dyn SolidLaw, paths: &Paths) -> Result<(), CheckFailure> {
    let mut elastic = 0.0;
    let mut before = Vector6::zeros();
    follow(law, paths, |at| {
        if at.step == 0 {
            (elastic, before) = (0.0, Vector6::zeros());
        }
        let work = 0.5 * (at.old.stress + at.new.stress).dot(&(at.strain - before));
        let energy = &at.new.energy;
        let taken = energy.elastic - elastic + energy.plastic_damage + energy.viscous;
        let strain = at.strain.amax();
        (elastic, before) = (energy.elastic, *at.strain);
        let tolerance = ROUNDING * stiffness(law) * strain * strain;
        close("elastic energy and dissipation", taken, work, tolerance)
    })
}

/// Checks (3): the dissipation is not negative.
///
/// # Errors
/// The first step with negative dissipation.
pub fn dissipation(law: &dyn SolidLaw, paths: &Paths) -> Result<(), CheckFailure> {
    follow(law, paths, |at| {
        let (old, new) = (at.old, &at.new.history);
        let elastic = at.strain - new.viscous_strain;
        let release = 0.5 * hooke(law.elastic(), &elastic).dot(&elastic);
        let damage = (new.viscous_damage - old.viscous_damage).max(0.0);
        let plastic = at
            .new
            .stress
            .dot(&(new.viscous_strain - old.viscous_strain));
        let dissipated = plastic + release * damage;
        let strain = at.strain.amax();
        if dissipated >= -ROUNDING * stiffness(law) * strain * strain {
            return Ok(());
        }
        Err(CheckError::Dissipation(dissipated))
    })
}

/// Compares the stresses of a rotated path with rotated stresses.
///
/// # Errors
/// The first difference.
pub fn objectivity(law: &dyn SolidLaw, paths: &Paths) -> Result<(), CheckFailure> {
    let turn = *Rotation3::from_euler_angles(0.4, -0.9, 1.7).matrix();
    let mut other = MaterialHistory::default();
    follow(law, paths, |at| {
        if at.step == 0 {
            other = MaterialHistory::default();
        }
        let strain = turned(&turn, at.strain, 0.5);
        let increment = Increment {
            dt: paths.dt,
            tangent: Wanted::Nowhere,
        };
        let answer = law.update(&strain, &other, increment);
        let answer = answer.map_err(CheckError::Law)?;
        other = answer.history;
        let expected = turned(&turn, &at.new.stress, 1.0);
        // Softening transfers rounding errors from step to step and may double them each time.
        let tolerance = 1e3 * ROUNDING * stiffness(law) * at.strain.amax();
        equal(
            "stress of the turned path",
            &answer.stress,
            &expected,
            tolerance,
        )
    })
}

/// One step of a path.
struct At<'a> {
    path: usize,
    step: usize,
    strain: &'a Vector6<f64>,
    old: &'a MaterialHistory,
    new: &'a Response,
}

/// Drives the law along all paths.
fn follow(
    law: &dyn SolidLaw,
    paths: &Paths,
    mut check: impl FnMut(&At<'_>) -> Result<(), CheckError>,
) -> Result<(), CheckFailure> {
    let increment = Increment {
        dt: paths.dt,
        tangent: Wanted::Everywhere,
    };
    for path in 0..paths.paths {
        let mut random = Random(paths.seed.wrapping_add(1 + path as u64));
        let mut old = MaterialHistory::default();
        let mut strain = Vector6::zeros();
        let mut direction = random.direction();
        for step in 0..paths.steps {
            // Every eighth step leaves the direction: half of these steps reverse it, the others take a random one.
            match random.below(16) {
                0 => direction = -direction,
                1 => direction = random.direction(),
                _ => {}
            }
            let noise = random.direction() * 0.3;
            strain += (direction + noise) * paths.strain;
            let answer = law.update(&strain, &old, increment);
            let checked = answer.map_err(CheckError::Law).and_then(|new| {
                new.checked(law.name(), true).map_err(CheckError::Law)?;
                check(&At {
                    path,
                    step,
                    strain: &strain,
                    old: &old,
                    new: &new,
                })?;
                Ok(new)
            });
            let new = checked.map_err(|what| CheckFailure {
                law: law.name(),
                path,
                step,
                strain: strain.into(),
                what,
            })?;
            old = new.history;
        }
    }
    Ok(())
}

/// Largest entry of C₀ [MPa].
fn stiffness(law: &dyn SolidLaw) -> f64 {
    crate::material::elastic_stiffness(law.elastic()).amax()
}

fn close(what: &'static str, found: f64, expected: f64, tolerance: f64) -> Result<(), CheckError> {
    if (found - expected).abs() <= tolerance {
        return Ok(());
    }
    Err(CheckError::Unequal {
        what,
        found,
        expected,
        tolerance,
    })
}

fn equal(
    what: &'static str,
    found: &Vector6<f64>,
    expected: &Vector6<f64>,
    tolerance: f64,
) -> Result<(), CheckError> {
    let mut pairs = found.iter().zip(expected);
    pairs.try_for_each(|(found, expected)| close(what, *found, *expected, tolerance))
}

/// Q v Qᵀ for Voigt components whose shear components are 1/`shear` times those of the tensor.
fn turned(q: &Matrix3<f64>, v: &Vector6<f64>, shear: f64) -> Vector6<f64> {
    let (a, b, c) = (shear * v[3], shear * v[4], shear * v[5]);
    let m = q * Matrix3::new(v[0], a, c, a, v[1], b, c, b, v[2]) * q.transpose();
    let [a, b, c] = [m[(0, 1)], m[(1, 2)], m[(0, 2)]].map(|s| s / shear);
    Vector6::new(m[(0, 0)], m[(1, 1)], m[(2, 2)], a, b, c)
}

/// SplitMix64 of G. Steele, D. Lea and C. Flood (2014): the same numbers on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// Uniform in −1 to 1.
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A random strain of unit length, with volume changes of both signs.
    fn direction(&mut self) -> Vector6<f64> {
        let volume = 0.5 * self.signed();
        let mut v = Vector6::from_fn(|_, _| self.signed());
        for i in 0..3 {
            v[i] += volume;
        }
        v.normalize()
    }
}
