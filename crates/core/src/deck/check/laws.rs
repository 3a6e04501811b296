//! Notes on materials and interfaces: element sizes, energies, stiffnesses.

use crate::deck::findings;
use crate::deck::quantity::Quantity;
use crate::deck::scatter;
use crate::deck::schema::{Deck, Interface, JointKind};
use crate::material::by_energy::areas;
use crate::material::uniaxial::snap_back;
use crate::material::{Branch, DamagePlasticityParameters, MaterialParameters, TableRow};
use crate::model::Model;
use crate::model::scene::NamedMaterial;
use std::collections::HashSet;
use wythe_contact::JointLaw;

/// Note on a material and the sizes of its elements; none without elements.
pub(super) fn material_note(
    model: &Model,
    material: &NamedMaterial,
    elements: &[usize],
) -> Option<String> {
    let lengths = findings::equivalent_lengths(model, elements);
    let (low, high) = (lengths.first()?, lengths.last()?);
    let kind = match &material.parameters {
        MaterialParameters::Elastic(_) => "linear elastic".to_owned(),
        MaterialParameters::DruckerPrager(p) => {
            let (f_t, f_c) = (p.tensile_strength, p.compressive_strength());
            let limits = match p.longest() {
                [t, c] if t.is_infinite() && c.is_infinite() => "no softening".to_owned(),
                [t, c] => {
                    format!("snap-back from {t:.1} mm (tension) and {c:.1} mm (compression) on")
                }
            };
            format!("f_t {f_t:.3} MPa, f_c {f_c:.3} MPa, {limits}")
        }
        MaterialParameters::Custom(law) => format!("law `{}`", law.name()),
        MaterialParameters::DamagePlasticity(p) => {
            let [tension, compression] = [&p.tension, &p.compression]
                .map(|rows| snap_back(p.elastic.E, rows).map_or(f64::INFINITY, |(_, ratio)| ratio));
            let bands = if p.has_bands() {
                let [low, high] = findings::band_widths(model, elements);
                format!("{low:.1} to {high:.1} mm across a crack, ")
            } else {
                String::new()
            };
            let reference = p
                .reference_length
                .map_or_else(|| "none".to_owned(), |l| format!("{l} mm"));
            format!(
                "{bands}reference length {reference}, snap-back above {tension:.2} (tension) and {compression:.2} \
                 (compression) times it"
            )
        }
    };
    let lengths = if high - low < 0.05 {
        format!("{low:.1} mm")
    } else {
        format!("{low:.1} to {high:.1} mm")
    };
    let name = &material.name;
    Some(format!("material {name}: l_eq {lengths}; {kind}"))
}

/// Notes on the energies of both curves of a material: per area where the tables have a length, else per volume.
pub(super) fn energy_notes(deck: &Deck, name: &str, p: &DamagePlasticityParameters) -> [String; 2] {
    [
        (Branch::Tension, &p.tension, ["f_t", "G_ft"]),
        (Branch::Compression, &p.compression, ["f_c", "G_fc"]),
    ]
    .map(|(branch, rows, [strength, energy])| {
        let peak = rows.iter().map(|row| row.stress).fold(0.0, f64::max);
        let given = deck.materials.get(name);
        let by_energy = given.and_then(|m| m.by_energy(branch)).is_some();
        let [before, beyond] = areas(rows);
        let (unit, times) = match p.reference_length {
            Some(length) => ("N/mm", length),
            None => ("N/mm per mm of an element", 1.0),
        };
        let mut note = format!(
            "material {name}: {strength} = {peak} MPa, {energy} = {:.4} {unit} beyond the peak",
            times * beyond
        );
        if !by_energy {
            note += &by_row(rows, times);
        }
        if before > 0.0 {
            // Hardening is not scaled to the element, so that its energy is one per volume.
            note += &format!(", {before:.4} N/mm^2 up to it");
        }
        if let (Some(length), Some((_, ratio))) = (p.reference_length, snap_back(p.elastic.E, rows))
        {
            let size = p.elastic.E * length * beyond / (peak * peak);
            note += &format!(
                "; no snap-back below {:.1} mm, {:.2} E {energy}/{strength}^2",
                ratio * length,
                ratio * length / size
            );
        }
        note
    })
}

/// The energy of each row of a table beyond its peak, if there are several.
fn by_row(rows: &[TableRow], times: f64) -> String {
    let of = |end: usize| times * areas(&rows[..=end])[1];
    let softening = (1..rows.len()).filter(|end| of(*end) > 0.0);
    let told: Vec<String> = softening
        .map(|end| format!("{:.4} to row {}", of(end), end + 1))
        .collect();
    if told.len() < 2 {
        return String::new();
    }
    format!(" ({})", told.join(", "))
}

/// A value for a note, to four decimals.
fn decimals(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Parameters of an interface, and its stiffnesses in this model.
pub(super) fn interface_notes(
    name: &str,
    f: &Interface,
    model: &Model,
    is_derived: bool,
) -> [String; 2] {
    let kind = if let (JointKind::Cap, Some(curve)) = (f.kind, f.cap_curve()) {
        format!(
            "interface {name}: cap law, f_m = {} MPa at a plastic closing of {} mm, half of it at {:.4} mm <=> G_fc = \
             {:.4} N/mm, C_ss = {}; f_t = {} MPa, G_I = {} N/mm; c = {} MPa, G_II = {} N/mm",
            decimals(curve.strength),
            decimals(curve.peak),
            curve.middle,
            curve.energy(),
            decimals(f.cap_weights()[1]),
            decimals(f.tensile_strength()),
            decimals(f.G_I.map_or(0.0, Quantity::get)),
            decimals(f.cohesion()),
            decimals(f.G_II.map_or(0.0, Quantity::get)),
        )
    } else if f.is_dry() {
        format!("interface {name}: dry, friction {}", f.residual_friction())
    } else {
        format!(
            "interface {name}: u_k = {:.4} mm <=> G_I = {:.2} N/m; delta_k = {:.4} mm <=> G_II = \
             {:.2} N/m without normal stress, {:.2} N/m under 1 MPa",
            f.ultimate_opening(),
            1e3 * f.mode_1_energy(),
            f.ultimate_slip(),
            1e3 * f.mode_2_energy(0.0),
            1e3 * f.mode_2_energy(-1.0),
        )
    };
    let contact = &model.contact;
    let laws = contact.laws.iter().zip(&contact.law_names);
    let pairs = laws.filter(|(_, n)| *n == name).map(|(law, _)| {
        let [normal, shear] = law.stiffness();
        format!("{} / {}", rounded(normal), rounded(shear))
    });
    let mut pairs: Vec<String> = pairs.collect();
    let mut told = HashSet::new();
    pairs.retain(|pair| told.insert(pair.clone())); // units that scatter have equal stiffnesses
    let stiffness = format!(
        "interface {name}: k_n / k_s = {} N/mm^3{}",
        pairs.join(", "),
        if f.normal_stiffness.is_some() {
            if is_derived {
                " of unit and mortar"
            } else {
                " as given"
            }
        } else {
            " by the elements that meet"
        }
    );
    [kind, stiffness]
}

/// Formats a stiffness without decimals, or with an exponent if it has more than ten digits.
fn rounded(stiffness: f64) -> String {
    if stiffness < 1e10 {
        format!("{stiffness:.0}")
    } else {
        format!("{stiffness:.3e}")
    }
}

/// Note on the strength factors of the units, if the bond of the interface scatters.
pub(super) fn scatter_note(deck: &Deck, name: &str, model: &Model) -> Option<String> {
    let scatter = deck.interfaces.get(name)?.scatter?;
    let factors = scatter::factors(deck, &model.contact, name)?;
    let units = factors.len();
    let drawn = factors.into_iter().map(|(_, x)| x);
    let (least, largest, sum) = drawn.fold((f64::INFINITY, 0.0_f64, 0.0), |(a, b, sum), x| {
        (a.min(x), b.max(x), sum + x)
    });
    let (cv, seed) = (scatter.cv.get(), scatter.seed);
    Some(format!(
        "interface {name}: f_t and c scatter with cv = {cv}, seed {seed}: {least:.3} to {largest:.3} times their \
         mean, {:.3} on average over {units} units",
        sum / units as f64
    ))
}
