//! Checks that any joint law should pass: its tangent, its independence of the directions in the plane, its energy, and
//! its iterate of a softer stiffness.
//!
//! Each check follows a [`Path`] of gaps and returns an error that names the step at which the law fails.
//! [`Path::random`] generates paths that open, close, slide and change direction.

use std::error::Error;
use std::fmt;

use nalgebra::{Matrix3, Vector3};

use crate::joint::JointLaw;
use crate::law::InterfaceHistory;
use crate::shifted::Shift;

/// A path of gaps `[u, δ₁, δ₂]` [mm] that starts from zero. `[step]`
#[derive(Clone, Debug, PartialEq)]
pub struct Path(pub Vec<[f64; 3]>);

impl Path {
    /// A random walk of `steps` steps from a seed: openings of about `unit` [mm], closings down to about `closing`
    /// [mm], slips of about `unit` per step. The mean direction changes every six steps.
    pub fn random(seed: u64, steps: usize, unit: f64, closing: f64) -> Self {
        let mut state = seed;
        // splitmix64
        let mut signed = || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let (mut at, mut drift) = ([0.0; 3], [0.0; 3]);
        let gaps = (0..steps).map(|step| {
            if step % 6 == 0 {
                drift = [0.5 * signed(), signed(), signed()];
            }
            for (at, drift) in at.iter_mut().zip(drift) {
                *at += drift + 0.3 * signed();
            }
            let scale = if at[0] > 0.0 { unit } else { closing };
            [at[0] * scale, at[1] * unit, at[2] * unit]
        });
        Self(gaps.collect())
    }

    /// The same path with every step divided into `parts` equal steps.
    #[must_use]
    pub fn divided(&self, parts: usize) -> Self {
        let (mut from, mut all) = ([0.0; 3], Vec::with_capacity(self.0.len() * parts));
        for to in &self.0 {
            for part in 1..=parts {
                let s = part as f64 / parts as f64;
                all.push([0, 1, 2].map(|i| from[i] + s * (to[i] - from[i])));
            }
            from = *to;
        }
        Self(all)
    }
}

/// A failed check.
#[derive(Clone, Debug, PartialEq)]
pub struct Failed {
    /// Name of the law.
    pub law: &'static str,
    /// The step of the path, from 0.
    pub step: usize,
    /// Its gap [mm].
    pub gap: [f64; 3],
    /// The wrong quantity with its values.
    pub what: String,
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [u, s1, s2] = self.gap;
        write!(
            f,
            "joint law {}: step {}, opening {u} mm, slip ({s1}, {s2}) mm: {}",
            self.law, self.step, self.what
        )
    }
}

impl Error for Failed {}

/// Follows a path and stops at a response that is not finite. `look` receives step, gap, old history and response.
fn walk(
    law: &dyn JointLaw,
    path: &Path,
    mut look: impl FnMut(
        usize,
        &[f64; 3],
        &InterfaceHistory,
        &crate::InterfaceResponse,
    ) -> Result<(), String>,
) -> Result<(), Failed> {
    let mut old = law.virgin();
    for (step, gap) in path.0.iter().enumerate() {
        let answer = law.update(*gap, &old);
        let fail = |what: String| Failed {
            law: law.name(),
            step,
            gap: *gap,
            what,
        };
        let h = &answer.history;
        let numbers = answer
            .traction
            .iter()
            .chain(&h.slots)
            .chain(&h.plastic_slip);
        if !numbers.chain(answer.tangent.iter()).all(|n| n.is_finite()) {
            return Err(fail(format!(
                "traction {:?}, tangent {:?} or history is not finite",
                answer.traction, answer.tangent.data.0
            )));
        }
        look(step, gap, &old, &answer).map_err(fail)?;
        old = answer.history;
    }
    Ok(())
}

/// Result of [`tangent`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tangents {
    /// Columns that were compared.
    pub columns: usize,
    /// Columns at corners of the law, where only a one-sided difference agrees.
    pub corners: usize,
}

/// Compares the tangent with finite differences of the traction over `h` [mm]. At corners of the law one of the
/// one-sided differences must agree. `tolerance` is relative to the larger elastic stiffness.
///
/// # Errors
/// A column that agrees neither with the central difference nor with a one-sided difference.
pub fn tangent(
    law: &dyn JointLaw,
    path: &Path,
    h: f64,
    tolerance: f64,
) -> Result<Tangents, Failed> {
    let mut found = Tangents::default();
    let [k_n, k_s] = law.stiffness();
    let scale = k_n.max(k_s);
    walk(law, path, |_, gap, old, answer| {
        for j in 0..3 {
            let side = |s: f64| {
                let mut at = *gap;
                at[j] += s * h;
                Vector3::from(law.update(at, old).traction)
            };
            let (up, down, here) = (side(1.0), side(-1.0), Vector3::from(answer.traction));
            let column = answer.tangent.column(j).into_owned();
            let off = |difference: Vector3<f64>| (difference - column).amax() / scale;
            let central = off((up - down) / (2.0 * h));
            let one = off((up - here) / h).min(off((here - down) / h));
            found.columns += 1;
            if central > tolerance {
                found.corners += 1;
                // The error of a one-sided difference is of first order.
                if one.is_nan() || one > 10.0 * tolerance {
                    let most = central.min(one);
                    return Err(format!(
                        "column {j} of the tangent {column:?} is off by {most:.1e} of the stiffness"
                    ));
                }
            }
        }
        Ok(())
    })?;
    Ok(found)
}

/// Follows the path rotated in the tangential plane by `angle` [rad], once plain and once mirrored, and compares the
/// responses.
///
/// # Errors
/// A traction that differs by more than `tolerance` times the largest traction of the path, or a slot that
/// differs by more than `tolerance` times the largest slot.
pub fn objectivity(
    law: &dyn JointLaw,
    path: &Path,
    angle: f64,
    tolerance: f64,
) -> Result<(), Failed> {
    let (s, c) = angle.sin_cos();
    for sign in [1.0, -1.0] {
        let turn = |[n, a, b]: [f64; 3]| [n, c * a - s * b, sign * (s * a + c * b)];
        let mut turned = law.virgin();
        let (mut most, mut most_slot) = (f64::MIN_POSITIVE, f64::MIN_POSITIVE);
        walk(law, path, |_, gap, _, answer| {
            let other = law.update(turn(*gap), &turned);
            turned = other.history;
            let expected = turn(answer.traction);
            for i in 0..3 {
                most = most.max(expected[i].abs());
            }
            for slot in answer.history.slots {
                most_slot = most_slot.max(slot.abs());
            }
            if off(&expected, &other.traction) > tolerance * most {
                return Err(format!(
                    "the traction {:?} turned is {expected:?}, that of the turned gap is {:?}",
                    answer.traction, other.traction
                ));
            }
            let (own, its) = (&answer.history.slots, &other.history.slots);
            if off(own, its) > tolerance * most_slot {
                return Err(format!(
                    "slots {own:?} become {its:?} where the gap is turned"
                ));
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Checks that in every step the work of the tractions (trapezoidal rule) equals the change of free energy plus
/// dissipation plus crossing work, and that the dissipation is not negative. The path should have small steps.
///
/// Returns work and dissipation of the path [N/mm].
///
/// # Errors
/// A step whose balance error exceeds `tolerance` times the largest energy of the path so far, or whose
/// dissipation is more negative than that.
pub fn dissipation(law: &dyn JointLaw, path: &Path, tolerance: f64) -> Result<[f64; 2], Failed> {
    let mut at = [0.0; 3];
    let (mut stored, mut work, mut lost) = (law.free_energy(&law.virgin()), 0.0, 0.0);
    let mut largest = f64::MIN_POSITIVE;
    walk(law, path, |_, gap, old, answer| {
        let step: f64 = (0..3)
            .map(|i| 0.5 * (old.traction[i] + answer.traction[i]) * (gap[i] - at[i]))
            .sum();
        let now = law.free_energy(&answer.history);
        let crossing = law.crossing_work(old, &answer.history);
        let open = step - (now - stored) - answer.dissipation - crossing;
        (at, stored) = (*gap, now);
        work += step;
        lost += answer.dissipation;
        largest = largest.max(now).max(lost).max(work.abs());
        if open.abs() > tolerance * largest {
            return Err(format!(
                "the energies of the step are open by {open:.2e} N/mm: work {step:.2e}, dissipation {:.2e}",
                answer.dissipation
            ));
        }
        if answer.dissipation < -tolerance * largest {
            return Err(format!("it dissipates {:.2e} N/mm", answer.dissipation));
        }
        Ok(())
    })?;
    Ok([work, lost])
}

/// Most iterates of a step of [`shifted`]: with a quarter of the stiffness, 3/4 to this power is below 1e-249.
const ITERATES: usize = 2000;
/// Change of the tractions that is rounding, over the largest of the path so far.
const SETTLED: f64 = 1e-14;
/// Rounding of the tangent of an iterate, a projector times the stiffness, over the numerical stiffness.
const PROJECTOR: f64 = 1e-12;

/// Compares the fixed point of [`JointLaw::update_shifted`] with [`JointLaw::update`] in every step of the path: the
/// tractions of an iterate are taken over, from those of the step before, until they no longer change. The numerical
/// stiffness is `part` of that of the law, but no less than four times its softening slopes, as in a run. The tangent
/// of each iterate must be symmetric and positive semidefinite.
///
/// Gives the number of iterates.
///
/// # Errors
/// Tractions that do not settle; a traction or slot that differs by more than `tolerance` of the largest on the path, a
/// damage by more than `tolerance`, an opening or slip by `tolerance` of the largest gap over `part`; a tangent that is
/// not symmetric or has a negative eigenvalue, beyond rounding.
pub fn shifted(
    law: &dyn JointLaw,
    path: &Path,
    part: f64,
    tolerance: f64,
) -> Result<usize, Failed> {
    let (whole, slopes) = (law.stiffness(), law.softening_slopes());
    let stiffness = [0, 1].map(|i| (part * whole[i]).max(4.0 * slopes[i]).min(whole[i]));
    let mut iterates = 0;
    let (mut most, mut most_slot, mut farthest) =
        (f64::MIN_POSITIVE, f64::MIN_POSITIVE, f64::MIN_POSITIVE);
    walk(law, path, |_, gap, old, answer| {
        let larger = |most: f64, of: &[f64]| of.iter().fold(most, |most, n| most.max(n.abs()));
        most = larger(most, &answer.traction);
        most_slot = larger(most_slot, &answer.history.slots);
        farthest = larger(farthest, gap);

        let mut traction = old.traction;
        let mut settled = None;
        for _ in 0..ITERATES {
            let shift = Shift {
                stiffness,
                traction,
                bounding: traction[0],
            };
            let iterate = law.update_shifted(*gap, old, &shift);
            iterates += 1;
            semidefinite(&iterate.tangent, stiffness)?;
            let change = off(&iterate.traction, &traction);
            traction = iterate.traction;
            if change <= SETTLED * most {
                settled = Some(iterate.history);
                break;
            }
        }
        let Some(history) = settled else {
            return Err(format!(
                "the traction of the iterates does not settle: {traction:?} after {ITERATES}"
            ));
        };
        let own = &answer.history;
        let lengths = |h: &InterfaceHistory| {
            let [[s_1, s_2], [p_1, p_2]] = [h.slip, h.plastic_slip];
            [h.opening, h.opening_max, h.slip_max, s_1, s_2, p_1, p_2]
        };
        for (name, found, exact, scale) in [
            ("traction", &traction[..], &answer.traction[..], most),
            ("damage", &[history.damage], &[own.damage], 1.0),
            ("slots", &history.slots, &own.slots, most_slot),
            (
                "lengths [opening, its largest, largest slip, slip, plastic slip]",
                &lengths(&history),
                &lengths(own),
                farthest / part,
            ),
        ] {
            let off = off(found, exact);
            // A number that is not finite is wrong, too.
            if off.is_nan() || off > tolerance * scale {
                return Err(format!(
                    "{name} of the settled iterate {found:?}, of the law {exact:?}"
                ));
            }
        }
        Ok(())
    })?;
    Ok(iterates)
}

/// Largest difference; NaN if there is one.
fn off(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |most, d| if d > most || d.is_nan() { d } else { most })
}

/// Demands that the tangent of an iterate is symmetric without negative eigenvalues, within rounding of `stiffness`.
fn semidefinite(tangent: &Matrix3<f64>, stiffness: [f64; 2]) -> Result<(), String> {
    let rounding = PROJECTOR * stiffness[0].max(stiffness[1]);
    let skew = (tangent - tangent.transpose()).amax();
    if skew.is_nan() || skew > rounding {
        return Err(format!(
            "the tangent of an iterate is not symmetric: {:?}",
            tangent.data.0
        ));
    }
    let least = tangent.symmetric_eigenvalues().min();
    if least.is_nan() || least < -rounding {
        return Err(format!(
            "the tangent of an iterate has the eigenvalue {least:.2e} N/mm³: {:?}",
            tangent.data.0
        ));
    }
    Ok(())
}
