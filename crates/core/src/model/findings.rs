//! Physics of a model that can be judged before it is run.

use super::Model;
use super::deck::{Deck, Interface};
use super::layout;
use crate::error::{ModelError, Warning};
use crate::material::{DamagePlasticityParameters, MaterialParameters, TableRow};

/// Smallest and largest equivalent length l_eq = V^(1/3) of the elements of material `m` [mm]
/// (theory A.8, α_h = 1 for hex8); none if no element has it.
pub(super) fn equivalent_lengths(model: &Model, m: usize) -> Option<(f64, f64)> {
    let of_material =
        (0..model.mesh.elements.len()).filter(|&e| model.mesh.material[e] as usize == m);
    of_material
        .map(|e| box_volume(&model.mesh.corners(e)).cbrt())
        .fold(None, |range, l| {
            let (low, high) = range.unwrap_or((l, l));
            Some((l.min(low), l.max(high)))
        })
}

/// Volume of a hex8 that is a parallelepiped.
fn box_volume(c: &[[f64; 3]; 8]) -> f64 {
    let edge = |n: usize| [0, 1, 2].map(|d| c[n][d] - c[0][d]);
    let ([a, b, c], [d, e, f], [g, h, i]) = (edge(1), edge(3), edge(4));
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
}

/// All warnings of a model.
///
/// # Errors
/// Softening that would snap back within an element.
pub(super) fn findings(deck: &Deck, model: &Model) -> Result<Vec<Warning>, ModelError> {
    let mut warnings = Vec::new();
    let mut errors = Vec::new();
    let mut seen: Vec<&str> = Vec::new();
    for material in &model.materials {
        let name = material.name.as_str();
        if seen.contains(&name) {
            continue; // units and mortar of one material
        }
        seen.push(name);
        let lengths = (0..model.materials.len())
            .filter(|&m| model.materials[m].name == name)
            .filter_map(|m| equivalent_lengths(model, m))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        if let (MaterialParameters::DamagePlasticity(p), Some(lengths)) =
            (&material.parameters, lengths)
        {
            match check_material(deck, name, p, lengths) {
                Ok(found) => warnings.extend(found),
                Err(error) => errors.push(error),
            }
        }
    }
    if let Some(error) = ModelError::gather(errors) {
        return Err(error);
    }
    if let Some(wall) = &deck.wall {
        if let Some(interface) = deck.interfaces.get(&wall.interface) {
            warnings.extend(check_interface(deck, &wall.interface, interface, model));
        }
        warnings.extend(check_bond(deck));
    }
    Ok(warnings)
}

/// A material in elements of these equivalent lengths [mm]: the tables' lengths and softening.
///
/// # Errors
/// Softening steeper than elastic unloading in the largest element (theory A.8).
fn check_material(
    deck: &Deck,
    name: &str,
    p: &DamagePlasticityParameters,
    (_, largest): (f64, f64),
) -> Result<Vec<Warning>, ModelError> {
    let path = format!("materials.{name}");
    let mut warnings = Vec::new();
    let mut errors = Vec::new();
    if p.reference_length.is_none() {
        warnings.push(deck.warning(
            &path,
            "reference_length is missing: the tables are taken as given in every element, and the \
             energy to break a unit depends on the mesh (scaling is off)",
        ));
    }
    for (branch, rows) in [("tension", &p.tension), ("compression", &p.compression)] {
        let limit = snap_back_ratio(p.elastic.E, rows);
        let ratio = p.reference_length.map_or(1.0, |l_ref| largest / l_ref);
        if ratio < limit {
            continue;
        }
        let message = match p.reference_length {
            Some(l_ref) => format!(
                "elements of {largest:.1} mm (cube root of the volume) are over the limit of {:.1} mm: \
                 beyond it the softening of this table (for {l_ref} mm) snaps back within an element",
                limit * l_ref
            ),
            None => {
                "the table falls more steeply than the elastic modulus: it snaps back".to_owned()
            }
        };
        let help = "refine wall.mesh, or give the last row a larger inelastic strain";
        errors.push(deck.error(&format!("{path}.{branch}"), message, help));
    }
    ModelError::gather(errors).map_or(Ok(warnings), Err)
}

/// Largest l_eq/l_ref without snap-back, min E Δε_in/Δσ over the rows beyond the peak (theory A.8).
/// Infinite without softening.
pub(super) fn snap_back_ratio(modulus: f64, rows: &[TableRow]) -> f64 {
    let peak = (0..rows.len()).fold(0, |p, i| {
        if rows[i].stress >= rows[p].stress {
            i
        } else {
            p
        }
    });
    rows[peak..]
        .windows(2)
        .filter(|w| w[1].stress < w[0].stress)
        .map(|w| {
            modulus * (w[1].inelastic_strain - w[0].inelastic_strain) / (w[0].stress - w[1].stress)
        })
        .fold(f64::INFINITY, f64::min)
}

fn check_interface(deck: &Deck, name: &str, f: &Interface, model: &Model) -> Vec<Warning> {
    let path = format!("interfaces.{name}");
    let mut warnings = Vec::new();
    let mut warn = |key: &str, message: String| {
        let path = if key.is_empty() {
            path.clone()
        } else {
            format!("{path}.{key}")
        };
        warnings.push(deck.warning(&path, message));
    };
    let (mu, tan_phi, c, f_t) = (f.mu.get(), f.tan_phi.get(), f.c.get(), f.f_t.get());
    if mu > tan_phi && !f.is_dry() {
        let pressure = c / (mu - tan_phi);
        warn(
            "mu",
            format!(
                "the residual friction is above tan_phi = {tan_phi}: under more than {pressure:.3} MPa \
                 the joint hardens as it breaks"
            ),
        );
    }
    if f_t > 0.0 && tan_phi > 0.0 && f_t >= c / tan_phi {
        let limit = c / tan_phi;
        warn(
            "f_t",
            format!(
                "the Coulomb line ends at c/tan_phi = {limit:.4} MPa, below f_t: a joint pulled \
                 beyond it slides without resistance before it opens"
            ),
        );
    }
    let least = f.snap_back_stiffness();
    for (key, stiffness, least) in [
        (
            "normal_stiffness",
            smallest(model, |l| l.normal_stiffness),
            least[0],
        ),
        (
            "shear_stiffness",
            smallest(model, |l| l.shear_stiffness),
            least[1],
        ),
    ] {
        if stiffness <= least {
            warn(
                key,
                format!(
                    "{stiffness:.3} N/mm^3 is not above {least:.3}: the softening snaps back within the \
                     interface (raise the stiffness or penalty_factor)"
                ),
            );
        }
    }
    if f.normal_stiffness.is_some() && f.penalty_factor.get() != 500.0 {
        warn(
            "penalty_factor",
            "not used: explicit stiffnesses are given".to_owned(),
        );
    }
    warnings
}

/// Smallest stiffness of the model's laws; infinite without interfaces.
fn smallest(model: &Model, of: impl Fn(&wythe_contact::InterfaceLaw) -> f64) -> f64 {
    model
        .contact
        .laws
        .iter()
        .map(of)
        .fold(f64::INFINITY, f64::min)
}

/// Slivers and joints that run through.
fn check_bond(deck: &Deck) -> Vec<Warning> {
    let Some(wall) = &deck.wall else {
        return Vec::new();
    };
    let Ok(pattern) = layout::course_pattern(wall) else {
        return Vec::new();
    };
    let (shortest, lap) = layout::bat_and_lap(&pattern);
    let [unit, joint] = [wall.unit[0].get(), wall.head_joint.get()];
    let mut warnings = Vec::new();
    if shortest < unit / 8.0 {
        let half = (unit - joint) / 2.0;
        warnings.push(deck.warning(
            "wall.length",
            format!("the bats are slivers of {shortest:.2} mm (a half unit is {half:.2} mm)"),
        ));
    }
    if wall.courses > 1 && lap < unit / 8.0 {
        warnings.push(deck.warning(
            "wall.length",
            format!(
                "head joints of neighbouring courses are only {lap:.2} mm apart: hardly a bond"
            ),
        ));
    }
    warnings
}
