//! Implausible values: a unit that is missing or wrong, sizes in the wrong order.

use super::beams::AIR;
use super::quantity::Quantity;
use super::schema::{Deck, Wall};
use crate::error::Warning;

/// Plausible Young's moduli [MPa]: those of rubber (1), timber (10,000), masonry (1,000 to 50,000) and steel
/// (210,000), with a margin on both sides.
const STIFFNESS: [f64; 2] = [0.1, 1e6];
/// Plausible densities [tonne/mm³]: balsa has 100, brick 1,900, steel 7,850, lead 11,340 kg/m³.
const DENSITY: [f64; 2] = [0.99e-10, 1.2e-8];
/// Plausible gravity [mm/s²]: from a tenth of that of the earth to that of a large centrifuge.
const GRAVITY: [f64; 2] = [980.0, 2e6];
/// Largest plausible pressure [MPa]: even the strongest bricks crush below it.
const PRESSURE: f64 = 150.0;
/// Largest height and largest thickness of a brick [mm].
const BRICK: [f64; 2] = [80.0, 150.0];

/// Warnings about values whose unit is probably wrong.
pub(super) fn magnitudes(deck: &Deck) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (name, material) in &deck.materials {
        let path = format!("materials.{name}");
        // The stiffness of a loading beam, and its density unless the deck gives one, are chosen here.
        let generated = deck.is_generated(&path);
        if !generated {
            warnings.extend(stiffness(deck, &format!("{path}.E"), material.E.get()));
        }
        let density = material.density.get();
        if !(generated && density == AIR) {
            warnings.extend(self::density(deck, &format!("{path}.density"), density));
        }
    }
    for (i, step) in deck.steps.iter().enumerate() {
        let path = format!("steps.{i}");
        if let Some(g) = step.gravity {
            warnings.extend(gravity(deck, &format!("{path}.gravity"), g.get()));
        }
        let own = [
            ("pressure", step.pressure),
            ("top_pressure", step.top_pressure),
        ];
        for (key, value) in own {
            let value = value.map_or(0.0, Quantity::get);
            warnings.extend(pressure(deck, &format!("{path}.{key}"), value));
        }
        for (l, load) in step.loads.iter().enumerate() {
            let path = format!("{path}.loads.{l}");
            let value = load.pressure.map_or(0.0, Quantity::get);
            warnings.extend(pressure(deck, &format!("{path}.pressure"), value));
            for value in load.traction.into_iter().flatten() {
                warnings.extend(pressure(deck, &format!("{path}.traction"), value.get()));
            }
        }
    }
    for (path, name, wall) in deck.walls() {
        warnings.extend(exchanged(deck, &path, name, wall));
    }
    warnings
}

fn stiffness(deck: &Deck, path: &str, value: f64) -> Option<Warning> {
    let [low, high] = STIFFNESS;
    if (low..=high).contains(&value) {
        return None;
    }
    let in_pascal = 1e-6 * value;
    let meant = if (low..=high).contains(&in_pascal) {
        format!("; if it is in Pa: E = \"{} MPa\"", brief(in_pascal))
    } else if value > high {
        "; a body that is as good as rigid has rigid = true".to_owned()
    } else {
        format!("; if it is in GPa: E = \"{} GPa\"", brief(value))
    };
    Some(deck.warning(
        path,
        format!(
            "{} MPa is outside the range from rubber (1 MPa) to steel (210000 MPa){meant}",
            brief(value)
        ),
    ))
}

fn density(deck: &Deck, path: &str, value: f64) -> Option<Warning> {
    let [low, high] = DENSITY;
    if value == 0.0 || (low..=high).contains(&value) {
        return None;
    }
    let plausible = |value: &f64| (low..=high).contains(value);
    // The bare number may be meant in kg/m³, in kg/mm³, or in tonne/m³, which is g/cm³.
    let meant = [(1e-12, "kg/m^3"), (1e-3, "kg/mm^3"), (1e-9, "tonne/m^3")];
    let meant = meant
        .iter()
        .find(|(factor, _)| plausible(&(factor * value)));
    let meant = meant.map_or_else(String::new, |(_, unit)| {
        format!(
            "; if it is in {unit}: density = \"{} {unit}\"",
            brief(value)
        )
    });
    Some(deck.warning(
        path,
        format!(
            "{} tonne/mm^3 is {} kg/m^3, which no timber, masonry or steel has{meant}",
            brief(value),
            brief(1e12 * value)
        ),
    ))
}

fn gravity(deck: &Deck, path: &str, value: f64) -> Option<Warning> {
    let [low, high] = GRAVITY;
    if value == 0.0 || (low..=high).contains(&value.abs()) {
        return None;
    }
    let in_metres = (low..=high).contains(&(1e3 * value.abs()));
    let meant = if in_metres {
        format!("; if it is in m/s^2: gravity = \"{} m/s^2\"", brief(value))
    } else {
        String::new()
    };
    Some(deck.warning(
        path,
        format!(
            "{} mm/s^2 is {} times that of the earth{meant}",
            brief(value),
            brief(value / 9806.65)
        ),
    ))
}

fn pressure(deck: &Deck, path: &str, value: f64) -> Option<Warning> {
    if value.abs() <= PRESSURE {
        return None;
    }
    let meant = if value.abs() < 1e3 * PRESSURE {
        format!("; if it is in kPa: \"{} kPa\"", brief(value))
    } else {
        format!("; if it is in Pa: \"{} Pa\"", brief(value))
    };
    Some(deck.warning(
        path,
        format!(
            "{} MPa is more than the strongest brick bears{meant}",
            brief(value)
        ),
    ))
}

/// Warning about a brick whose thickness and height are exchanged.
///
/// The length of a brick is twice its thickness and a joint. If instead it is twice the height and a joint, and the
/// brick is not thicker than a brick is high, its sizes are in the wrong order.
fn exchanged(deck: &Deck, path: &str, name: &str, wall: &Wall) -> Option<Warning> {
    let [length, thickness, height] = wall.unit.map(Quantity::get);
    let joint = wall.head_joint.get();
    let two = 2.0 * (height + joint);
    let is_half = (length + joint - two).abs() <= 0.08 * (length + joint);
    let [low, high] = BRICK;
    let flat = thickness <= low && height > low && height <= high && thickness < 0.8 * height;
    (flat && is_half).then(|| {
        deck.warning(
            &format!("{path}.unit"),
            format!(
                "the units of the wall `{name}` are {} mm thick and {} mm high, on edge: unit is [length, thickness, height]; \
                 if these are exchanged: [{}, {}, {}]",
                brief(thickness),
                brief(height),
                brief(length),
                brief(height),
                brief(thickness)
            ),
        )
    })
}

/// Formats a value with few digits.
fn brief(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-3..1e7).contains(&magnitude) {
        let text = format!("{:.*}", if magnitude < 1.0 { 6 } else { 4 }, value);
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        let text = format!("{value:.3e}");
        match text.split_once('e') {
            Some((digits, power)) if digits.contains('.') => {
                let digits = digits.trim_end_matches('0').trim_end_matches('.');
                format!("{digits}e{power}")
            }
            _ => text,
        }
    }
}
