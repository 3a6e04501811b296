//! Notes on the parts of a scene: walls, rigid bodies, beams, planes of symmetry, blocks, damping.

use crate::deck::masonry::{self, Masonry};
use crate::deck::quantity::{Frequency, GRAVITY};
use crate::deck::rigid;
use crate::deck::schema::{Deck, DeckBeam, Subdivision, Turning};
use crate::deck::symmetry::{self, Plane};
use crate::model::Model;
use crate::model::floors::Floor;
use crate::model::mirrored::{self, MirrorPlane};
use crate::model::scene::{Fidelity, Rayleigh};
use crate::model::sizes::sizes;
use crate::model::ties::Tie;

/// Factors of Rayleigh damping that follow from a ratio at two frequencies.
pub(super) fn damping_notes(deck: &Deck) -> impl Iterator<Item = String> + '_ {
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

/// Notes on bond and mesh of a wall.
pub(super) fn wall_notes(deck: &Deck, masonry: &Masonry<'_>) -> Vec<String> {
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
    if masonry.interlock.first > 0 {
        notes.push(format!(
            "bond{of}: begins with course {} of its bond, so that it interlocks with the walls that it meets",
            masonry.interlock.first + 1
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
        return notes; // reported together with all rigid bodies
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

/// Note on rigid bodies and the modulus of those that stay solids.
pub(super) fn rigid_note(deck: &Deck, model: &Model) -> Option<String> {
    let rigid::Stiffness {
        modulus,
        joint,
        side,
    } = rigid::of_model(deck, model)?;
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
        "rigid: {} bodies of {} hex8 in all{lines}, with six unknowns each; those of which a beam, a spring, a tie or a \
         support holds single nodes are linear elastic, E = {modulus:.4e} MPa: over {side:.1} mm 100 times as stiff as \
         the stiffest interface, k_n = {joint} N/mm^3; tables of their materials are not used",
        units.len(),
        elements.len()
    ))
}

/// Notes on loading beams.
pub(super) fn beams_notes(deck: &Deck, model: &Model) -> Vec<String> {
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
pub(super) fn symmetry_note(deck: &Deck) -> Option<String> {
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
pub(super) fn fidelity_note(
    fidelity: Fidelity,
    planes: &[MirrorPlane],
    least: &Model,
) -> Option<String> {
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

/// Notes on mass, surfaces and the arch.
pub(super) fn block_notes(deck: &Deck, model: &Model) -> Vec<String> {
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

/// Notes on floors: area in plan, mass, springs.
pub(super) fn floor_notes(model: &Model) -> Vec<String> {
    let note = |floor: &Floor| {
        let of_floor = |tie: &&Tie| {
            let rest = tie.name.strip_prefix(&floor.name);
            rest.is_some_and(|rest| rest == "-joists" || rest == "-braces")
        };
        let ties = model.ties.iter().filter(of_floor);
        let springs: Vec<String> = ties
            .map(|tie| {
                let kind = tie.name.rsplit('-').next().unwrap_or_default();
                format!("{} {kind}", tie.strands.len())
            })
            .collect();
        let tied = if springs.is_empty() {
            "it does not tie the walls".to_owned()
        } else {
            format!("{} as springs", springs.join(" and "))
        };
        format!(
            "floor {}: {:.2} m^2, {:.1} kg ({:.2} kN at 9.81 m/s^2), {tied}",
            floor.name,
            1e-6 * floor.area,
            1e3 * floor.mass(),
            1e-3 * GRAVITY * floor.mass()
        )
    };
    model.floors.iter().map(note).collect()
}

/// Note on the pivots of joints that open. Gauss points, and so pivots, lie (1 − 1/√3)/2 = 0.211 of a facet inside its
/// edge (theory/joint.md, eq. 35).
pub(super) fn pivot_note(model: &Model) -> Option<String> {
    let facets = 0..model.contact.slave_facets.len();
    let facets = facets.filter(|f| !model.contact.samples_edges(*f));
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
        "contact: Gauss points move the pivots of joints that have parted inwards by {inset:.3} of a facet, up to \
         {:.1} mm; contact.parts divides facets",
        inset * longest
    ))
}
