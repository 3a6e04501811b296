//! Report of `wythe check`: warnings, notes on derived values, and the size of the model.

use super::findings;
use super::masonry::{self, Masonry};
use super::quantity::{Frequency, Quantity};
use super::schema::{Deck, DeckBeam, Interface, JointKind, Subdivision, Turning};
use super::stones::FileStones;
use super::symmetry::{self, Plane};
use super::{rigid, scatter, tables, wall_defaults};
use crate::error::Warning;
use crate::material::by_energy::areas;
use crate::material::uniaxial::snap_back;
use crate::material::{
    Branch, DamagePlasticityParameters, MaterialHistory, MaterialParameters, TableRow,
};
use crate::model::Model;
use crate::model::mirrored;
use crate::model::mirrored::MirrorPlane;
use crate::model::scene::{ContactPoints, Fidelity, NamedMaterial, Rayleigh, Step, Tangent};
use crate::model::sizes::Sizes;
use crate::model::sizes::sizes;
use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;
use wythe_contact::JointLaw;

/// Findings about a deck without errors.
#[derive(Clone, Debug)]
pub struct CheckReport {
    /// Title of the deck.
    pub title: String,
    /// Warnings.
    pub warnings: Vec<Warning>,
    /// Values derived from the deck, one line each.
    pub notes: Vec<String>,
    /// Size of the model.
    pub sizes: Sizes,
    /// Estimated peak memory [MB]: of the mirror half where one is solved, with factors of single precision where
    /// they are tried.
    pub memory_mb: f64,
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: syntax, units and ranges are right", self.title)?;
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        let Sizes {
            units,
            elements,
            nodes,
            dofs,
            contact_points,
        } = self.sizes;
        writeln!(
            f,
            "{units} units, {elements} elements, {nodes} nodes, {dofs} unknowns"
        )?;
        writeln!(
            f,
            "{contact_points} contact points, about {:.0} MB",
            self.memory_mb
        )
    }
}

/// Reports on a model and the deck from which it was built.
pub fn check(deck: &Deck, model: &Model) -> CheckReport {
    let sizes = sizes(model);
    let (planes, least) = mirrored::reduced(model);
    let [memory_mb, in_double] = match &least {
        // Factor 2: the check of symmetry needs as much again.
        Cow::Owned(half) if model.fidelity != Fidelity::Full => memory_mb(deck, half, 2.0),
        _ => memory_mb(deck, model, 1.0),
    };
    let mut notes = notes(deck, model);
    notes.extend(fidelity_note(model.fidelity, &planes, &least));
    if in_double - memory_mb > WORTH_TELLING_MB {
        notes.push(format!(
            "memory: about {in_double:.0} MB where a matrix wants factors of double precision, as under the weight of what is high and thin"
        ));
    }
    CheckReport {
        title: model.title.clone(),
        warnings: model.warnings.clone(),
        notes,
        sizes,
        memory_mb,
    }
}

/// Estimated peak memory [MB] with factors in single and in double precision.
///
/// The sum has the program, two histories at 8 points of each element, matrices of elements and contact pairs, and
/// the linear solver, which counts `times` over. Unsymmetric factors are always in double precision and take a
/// fifth more.
///
/// The factor of a wall that is w unknowns thick grows as that of a plane grid: w log₂(n/w) bytes for each of n
/// unknowns in double precision. In single precision the factor is less than half of all memory, and the logarithm
/// is not noticeable. The constants are measured on walls of 12,000 to 1,430,000 unknowns and are within a sixth of
/// these. Scenes with blocks count as a cube, n^1.22 bytes, measured at 14,000 and 86,000 unknowns; flat scenes
/// take less.
fn memory_mb(deck: &Deck, model: &Model, times: f64) -> [f64; 2] {
    let sizes = sizes(model);
    let element = 2 * 8 * size_of::<MaterialHistory>() + 24 * 24 * 8;
    let contact = 24 * 24 * 8 + 2 * size_of::<wythe_contact::InterfaceHistory>();
    let bodies = model.mesh.elements.len() * element + sizes.contact_points * contact;
    let n = sizes.dofs as f64;
    let planes = planes_through(deck, model);
    let [single, double] = match planes {
        Some(planes) if !deck.has_blocks() => {
            let thick = 3.0 * planes as f64;
            let levels = (n / thick).max(1.0).log2();
            [n * thick * 560.0, n * thick * (440.0 + 34.0 * levels)]
        }
        _ => [980.0 * n.powf(1.22), 1700.0 * n.powf(1.22)],
    };
    let unsymmetric = |s: &Step| s.tangent != Tangent::Secant;
    let solvers = if model.steps.iter().any(unsymmetric) {
        [1.2 * double; 2]
    } else {
        [single, double]
    };
    solvers.map(|solver| PROGRAM_MB + (bodies as f64 + times * solver) * 1e-6)
}

/// A difference in memory that is worth a note [MB].
const WORTH_TELLING_MB: f64 = 500.0;

/// Number of node planes through the thickness of the walls: those of a unit times the number of units through the
/// thickness. None without walls.
fn planes_through(deck: &Deck, model: &Model) -> Option<usize> {
    let walls = || deck.walls().map(|(_, _, wall)| wall);
    let thickness = walls().map(masonry::thickness).max_by(f64::total_cmp)?;
    let axes: Vec<usize> = [0, 1]
        .into_iter()
        .filter(|d| walls().any(|wall| wall.axes().1 == *d))
        .collect();
    let mesh = &model.mesh;
    // Only half of the thickness is present where a plane of symmetry cuts it.
    let laid = [0, 1].map(|d| {
        let [front, back] = mesh.extent(d);
        back - front
    });
    let planes = |unit: &[usize], d: usize| {
        let nodes = unit.iter().flat_map(|e| mesh.corners(*e));
        let mut x: Vec<f64> = nodes.map(|x| x[d]).collect();
        x.sort_by(f64::total_cmp);
        x.dedup_by(|b, a| *b - *a <= SAME_PLANE);
        let times = thickness.min(laid[d]) / (x[x.len() - 1] - x[0]);
        let times = times.round().clamp(1.0, MOST_LEAVES);
        x.len() * times as usize
    };
    let elements: Vec<usize> = (0..mesh.elements.len()).collect();
    let units = elements.chunk_by(|a, b| mesh.unit[*a] == mesh.unit[*b]);
    // Where walls run along both axes, the orientation of a unit is unknown: the smaller count is taken.
    units
        .filter_map(|unit| axes.iter().map(|d| planes(unit, *d)).min())
        .max()
}

/// Upper bound of the number of units through a wall [-].
const MOST_LEAVES: f64 = 100.0;

/// Nodes closer along an axis lie in one plane [mm].
const SAME_PLANE: f64 = 1e-6;

/// Memory of a run of two bricks [MB].
const PROGRAM_MB: f64 = 23.0;

fn notes(deck: &Deck, model: &Model) -> Vec<String> {
    let mut notes = Vec::new();
    let mut elements: Vec<Vec<usize>> = vec![Vec::new(); model.materials.len()];
    for (e, material) in model.mesh.material.iter().enumerate() {
        elements[usize::from(*material)].push(e);
    }
    for (material, elements) in model.materials.iter().zip(&elements) {
        notes.extend(material_note(model, material, elements));
        if let (MaterialParameters::DamagePlasticity(p), false) =
            (&material.parameters, elements.is_empty())
        {
            notes.extend(energy_notes(deck, &material.name, p));
            if p.has_bands() {
                let widths = findings::band_widths(model, elements);
                notes.extend(tables::band_notes(deck, &material.name, p, widths));
            }
        }
    }
    notes.extend(deck.assumed().iter().map(ToString::to_string));
    notes.extend(deck.derived.iter().cloned());
    for (name, f) in findings::interfaces(deck, model) {
        let is_derived = deck.is_generated(&format!("interfaces.{name}"));
        notes.extend(interface_notes(name, f, model, is_derived));
        notes.extend(scatter_note(deck, name, model));
    }
    for wall in masonry::lay_all(deck).unwrap_or_default() {
        notes.extend(wall_notes(deck, &wall));
    }
    notes.extend(wall_defaults::notes(deck));
    notes.extend(symmetry_note(deck));
    notes.extend(rigid_note(deck, model));
    notes.extend(beams_notes(deck, model));
    if deck.has_blocks() {
        notes.extend(block_notes(deck, model));
    }
    notes.extend(pivot_note(model));
    notes.extend(damping_notes(deck));
    notes
}

/// Factors of Rayleigh damping that follow from a ratio at two frequencies.
fn damping_notes(deck: &Deck) -> impl Iterator<Item = String> + '_ {
    deck.steps.iter().enumerate().filter_map(|(i, step)| {
        let rayleigh = step.rayleigh?;
        let (ratio, frequencies) = (rayleigh.ratio?.get(), rayleigh.frequencies?);
        let [first, second] = frequencies.map(Frequency::get);
        let Rayleigh { mass, stiffness } = rayleigh.factors();
        Some(format!(
            "step {i}: damping ratio {ratio} at {first} and {second} Hz gives rayleigh mass = {mass:.5} s^-1, \
             stiffness = {stiffness:.4e} s, least ratio {:.4} at {:.2} Hz; the stiffness part damps the solids, not \
             the joints",
            Rayleigh { mass, stiffness }.ratio((first * second).sqrt()),
            (first * second).sqrt()
        ))
    })
}

/// Note on a material and the sizes of its elements; none without elements.
fn material_note(model: &Model, material: &NamedMaterial, elements: &[usize]) -> Option<String> {
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
fn energy_notes(deck: &Deck, name: &str, p: &DamagePlasticityParameters) -> [String; 2] {
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

/// Notes on bond and mesh of a wall.
fn wall_notes(deck: &Deck, masonry: &Masonry<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    let only = deck.walls().count() == 1;
    let of = if only {
        String::new()
    } else {
        format!(" of {}", masonry.name)
    };
    let (shortest, lap) = masonry.bat_and_lap();
    if lap.is_finite() {
        notes.push(format!(
            "bond{of}: shortest unit {shortest:.2} mm, lap {lap:.2} mm"
        ));
    }
    notes.extend(storey_note(masonry, &of));
    let snapped = &masonry.snapped;
    if snapped.count > 0 {
        notes.push(format!(
            "snap{of}: pieces shorter than {:.4} mm joined to the units beside them: {} units or lintels are longer, by at \
             most {:.2} mm",
            snapped.below, snapped.count, snapped.longest
        ));
    }
    if masonry.wall.rigid {
        return notes; // reported together with all rigid-like bodies
    }
    let Subdivision {
        length,
        height,
        thickness,
    } = masonry.wall.mesh;
    let name = match masonry.wall.mesh {
        Subdivision::COARSE => "coarse, ",
        Subdivision::FINE => "fine, ",
        _ => "",
    };
    notes.push(format!(
        "mesh{of}: {name}[{length}, {height}, {thickness}] = {} hex8 a whole representative element",
        length * height * thickness
    ));
    notes
}

/// Note on the heights at which the storeys of a wall end.
fn storey_note(masonry: &Masonry<'_>, of: &str) -> Option<String> {
    let heights = masonry::storey_heights(masonry.wall);
    let told = |[end, asked]: &[f64; 2]| format!("{end:.1} mm (asked: {asked:.1})");
    let told: Vec<String> = heights.iter().map(told).collect();
    (!told.is_empty()).then(|| format!("storeys{of} end with a course at {}", told.join(", ")))
}

/// Note on the modulus of rigid-like bodies.
fn rigid_note(deck: &Deck, model: &Model) -> Option<String> {
    let rigid::Stiffness {
        modulus,
        joint,
        side,
    } = rigid::stiffness(deck, of_files(deck))?;
    let names = model.materials.iter().map(|m| m.name.as_str());
    let is_rigid: Vec<bool> = names.map(|name| rigid::base(name) != name).collect();
    let elements = 0..model.mesh.elements.len();
    let elements = elements.filter(|e| is_rigid[usize::from(model.mesh.material[*e])]);
    let elements: Vec<usize> = elements.collect();
    let mut units: Vec<u32> = elements.iter().map(|e| model.mesh.unit[*e]).collect();
    units.dedup();
    let lines = if deck.walls().any(|(_, _, wall)| wall.rigid) {
        " (units have a line of the mesh where neighbours end)"
    } else {
        ""
    };
    Some(format!(
        "rigid: {} bodies of {} hex8 in all{lines}, linear elastic, E = {modulus:.4e} MPa: over {side:.1} mm 100 times as \
         stiff as the stiffest interface, k_n = {joint} N/mm^3; tables of their materials are not used",
        units.len(),
        elements.len()
    ))
}

/// Longest side of the rigid blocks of files [mm].
fn of_files(deck: &Deck) -> f64 {
    let of_block = |i: usize| {
        // Files that cannot be read are errors of the model.
        let stones = deck.blocks[i]
            .rigid
            .then(|| FileStones::read(deck, i).ok().flatten());
        stones.flatten()
    };
    let all: Vec<Option<FileStones>> = (0..deck.blocks.len()).map(of_block).collect();
    FileStones::longest_side(&all, deck)
}

/// Notes on loading beams.
fn beams_notes(deck: &Deck, model: &Model) -> Vec<String> {
    let note = |beam: &DeckBeam| {
        let material = model.materials.iter().find(|m| m.name == beam.name)?;
        let modulus = material.parameters.elastic().E;
        let how = match beam.rotation {
            Turning::Free => {
                "it turns freely: loads are spread over it, a jack (a spring as stiff) drives the mean of it, at half \
                 its depth"
            }
            Turning::Level => "its top stays level",
        };
        Some(format!(
            "beam {}: a block {} mm deep, E = {modulus:.4e} MPa, stiff against all that it lies on; {how}",
            beam.name,
            beam.depth.get(),
        ))
    };
    deck.beams.iter().filter_map(note).collect()
}

/// Note on the part of the scene that the deck models.
fn symmetry_note(deck: &Deck) -> Option<String> {
    let planes = Plane::all(deck);
    let told: Vec<String> = planes
        .iter()
        .map(|plane| {
            let side = if plane.above { "above" } else { "below" };
            format!("what lies {side} {}", plane.called())
        })
        .collect();
    let part = match symmetry::multiplicity(deck) {
        1 => return None,
        2 => "half",
        4 => "a quarter",
        _ => "an eighth",
    };
    Some(format!(
        "symmetry: {} is modelled, {part} of the whole; forces, reactions, masses, areas and energies are those of this \
         part: {} times as much is that of the whole. Displacements and pressures are the same",
        told.join(" and "),
        symmetry::multiplicity(deck)
    ))
}

/// Note on the part of the scene that is solved, where the scene is its own mirror image in these planes. `least`:
/// the part that is solved.
fn fidelity_note(fidelity: Fidelity, planes: &[MirrorPlane], least: &Model) -> Option<String> {
    let part = mirrored::part(planes.len())?;
    let unknowns = sizes(least).dofs;
    let planes: Vec<String> = planes.iter().map(ToString::to_string).collect();
    let image = format!(
        "the scene is its own mirror image in the plane {}",
        planes.join(" and ")
    );
    Some(match fidelity {
        Fidelity::Auto | Fidelity::Elastic => {
            format!(
                "fidelity: {image}: {part} of it, {unknowns} unknowns, is solved, and the whole is shown"
            )
        }
        Fidelity::Full => format!(
            "fidelity: {image}: with fidelity = \"auto\" {part} of it, {unknowns} unknowns, is solved, and the whole is shown"
        ),
    })
}

/// A value for a note, to four decimals.
fn decimals(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Parameters of an interface, and its stiffnesses in this model.
fn interface_notes(name: &str, f: &Interface, model: &Model, is_derived: bool) -> [String; 2] {
    let kind = if let (JointKind::Cap, Some(curve)) = (f.kind, f.cap_curve()) {
        format!(
            "interface {name}: cap law, f_m = {} MPa at a plastic closing of {} mm, half of it at {:.4} mm <=> G_fc = \
             {:.4} N/mm, C_ss = {}; f_t = {} MPa, G_I = {} N/mm; c = {} MPa, G_II = {} N/mm",
            decimals(curve.strength),
            decimals(curve.peak),
            curve.middle,
            curve.energy(),
            decimals(f.cap_weights()[1]),
            decimals(f.f_t.get()),
            decimals(f.G_I.map_or(0.0, Quantity::get)),
            decimals(f.c.get()),
            decimals(f.G_II.map_or(0.0, Quantity::get)),
        )
    } else if f.is_dry() {
        format!("interface {name}: dry, friction {}", f.mu.get())
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
fn scatter_note(deck: &Deck, name: &str, model: &Model) -> Option<String> {
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

/// Notes on mass, surfaces and the arch.
fn block_notes(deck: &Deck, model: &Model) -> Vec<String> {
    let mesh = &model.mesh;
    let volume: f64 = (0..mesh.elements.len()).map(|e| mesh.volume(e)).sum();
    let mass: f64 = (0..mesh.elements.len())
        .map(|e| {
            let material = &model.materials[mesh.material[e] as usize].parameters;
            material.elastic().density * mesh.volume(e)
        })
        .sum();
    let mut notes = vec![
        format!("blocks: {:.6} m^3, {:.3} kg", 1e-9 * volume, 1e3 * mass),
        format!(
            "surfaces: {} slave and {} master facets; a slave meets every master of another block that \
             it comes to",
            model.contact.whole_slaves().count(),
            model.contact.master_facets.len()
        ),
    ];
    if let Some(arch) = &deck.arch {
        let (radius, thickness) = (arch.centre_line(), arch.thickness.get());
        let half_angle = 0.5 * arch.embrace();
        notes.push(format!(
            "arch: centre line {radius:.2} mm, clear span {:.2} mm, rise {:.2} mm, angle {:.2} deg, thickness {:.5} of \
             the radius",
            (2.0 * radius - thickness) * half_angle.sin(),
            (radius - 0.5 * thickness) * (1.0 - half_angle.cos()),
            2.0 * half_angle.to_degrees(),
            thickness / radius
        ));
    }
    notes
}

/// Note on the pivots of rocking blocks. Gauss points, and so all pivots, lie (1 − 1/√3)/2 = 0.211 of a facet
/// inside its edge (theory/joint.md, eq. 35).
fn pivot_note(model: &Model) -> Option<String> {
    if model.contact.points == ContactPoints::Corner {
        return None;
    }
    let facets = 0..model.contact.slave_facets.len();
    let longest = facets.flat_map(|f| {
        let outline = model.contact.outline(f, &model.mesh.nodes);
        (0..4).map(move |i| {
            let (a, b) = (outline[i], outline[(i + 1) % 4]);
            (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
        })
    });
    let longest = longest.reduce(f64::max)?;
    let inset = (1.0 - 1.0 / 3.0_f64.sqrt()) / 2.0;
    Some(format!(
        "contact: Gauss points move pivots inwards by {inset:.3} of a facet, up to {:.1} mm; for dry \
         joints and rigid-like blocks take points = \"corner\"",
        inset * longest
    ))
}
