//! Warnings about flat elements at joints that soften faster than the elements resist.
//!
//! ```text
//!   ┌───────────────┐   h      the shear u = 2 a x z/(L h) bends the element; its incompatible modes take the shear strain
//!  ╱└───────────────┘╲         away, and E ε_x² is left: k = 4 E h/L² for each area of the joint
//!  ←a       L       a→
//! ```
//!
//! If a joint between two such elements loses its bond faster with slip than k, half of the points of a facet slide while the
//! others stick with their whole bond (theory/hex8.md). Elements of displacements alone keep G/h.

use super::schema::Deck;
use crate::element::Formulation;
use crate::element::hexahedron::{EDGES, area_vector, difference, dot, mean, norm};
use crate::error::Warning;
use crate::model::Model;
use crate::model::boundary_facets::BoundaryFacets;
use std::collections::HashSet;
use wythe_contact::{Aabb, Bvh, JointLaw};

/// Part of the steepest slope of a law below which the stiffness is too small. Couplets had residual forces up to 170 %
/// wrong at 0.35 and less of it, and 0.2 % at 0.45 and more, with exponential and nearly linear softening.
const LEAST: f64 = 0.4;

/// Length over depth of a flat element. Couplets of elements up to four times as long as deep had the right residual force.
const FLAT: f64 = 3.0;

/// Cosine of the angle between two facets above which they do not face each other.
const FACING: f64 = -0.5;

/// An element behind a facet of a joint.
#[derive(Clone, Copy)]
struct Side {
    body: u32,
    centre: [f64; 3],
    /// Unit normal of the facet.
    normal: [f64; 3],
    /// Longest edge of the facet, and depth of the element behind it [mm].
    size: [f64; 2],
    /// Compliance L²/(4 E h) of the element against shear that varies along it [mm³/N]; 0 for a rigid one.
    compliance: f64,
}

/// Warnings about the bodies with such elements, each once.
pub(super) fn flat_elements(deck: &Deck, model: &Model) -> Vec<Warning> {
    let contact = &model.contact;
    let slopes = contact.laws.iter().map(|law| law.softening_slopes()[1]);
    let slopes: Vec<f64> = slopes.collect();
    let steepest = slopes.iter().copied().fold(0.0, f64::max);
    if model.formulation != Formulation::Incompatible || !may_be_flat(model, LEAST * steepest) {
        return Vec::new();
    }
    let skin = BoundaryFacets::of(&model.mesh);
    let of = |facets: &[[u32; 4]]| -> Vec<Option<Side>> {
        let behind = skin.behind(facets).into_iter().zip(facets);
        behind
            .map(|(element, facet)| Some(side(model, element? as usize, facet)))
            .collect()
    };
    let slaves = of(&contact.slave_facets);
    let masters: Vec<Side> = of(&contact.master_facets).into_iter().flatten().collect();
    let centres: Vec<Aabb> = masters.iter().map(|m| Aabb::of([&m.centre])).collect();
    let tree = Bvh::build(&centres);
    let mut stack = Vec::new();
    let mut told = HashSet::new();
    let mut warnings = Vec::new();
    for (f, _) in contact.whole_slaves() {
        let law = usize::from(contact.slave_law[f]);
        let (Some(slave), Some(slope)) = (slaves[f], slopes.get(law)) else {
            continue;
        };
        // A joint in a plane of symmetry slides freely.
        if *slope <= 0.0 || contact.planes(f) != [false; 3] {
            continue;
        }
        let nearest = tree.nearest(&slave.centre, &mut stack, |m| {
            let m = &masters[m as usize];
            if m.body != slave.body && dot(m.normal, slave.normal) < FACING {
                norm(difference(m.centre, slave.centre)).powi(2)
            } else {
                f64::INFINITY
            }
        });
        let Some((m, _)) = nearest.filter(|(_, square)| square.is_finite()) else {
            continue;
        };
        let master = masters[m as usize];
        let stiffness = 1.0 / (slave.compliance + master.compliance);
        let flatter = if master.compliance > slave.compliance {
            master
        } else {
            slave
        };
        let is_flat = flatter.size[0] > FLAT * flatter.size[1];
        if is_flat && stiffness < LEAST * slope && told.insert(flatter.body) {
            let law = &contact.law_names[law];
            warnings.push(warning(deck, model, &flatter, (law, stiffness, *slope)));
        }
    }
    warnings
}

/// Whether any two elements alike could have less stiffness than `least` [N/mm³], whichever of their faces is a joint's.
fn may_be_flat(model: &Model, least: f64) -> bool {
    let mesh = &model.mesh;
    let is_flat = |e: usize| {
        let x = mesh.corners(e);
        let edges = EDGES.map(|[a, b]| norm(difference(x[a], x[b])));
        let longest = edges.into_iter().fold(0.0, f64::max);
        let depth = mesh.volume(e) / (longest * longest);
        1.0 < 2.0 * least * compliance(model, e, [longest, depth])
    };
    least > 0.0 && (0..mesh.elements.len()).any(is_flat)
}

/// Compliance of an element of this length and depth [mm³/N]; 0 for a rigid one.
fn compliance(model: &Model, element: usize, [length, depth]: [f64; 2]) -> f64 {
    let material = &model.materials[usize::from(model.mesh.material[element])];
    if material.rigid {
        return 0.0;
    }
    length * length / (4.0 * material.parameters.elastic().E * depth)
}

/// The element behind a facet.
fn side(model: &Model, element: usize, facet: &[u32; 4]) -> Side {
    let mesh = &model.mesh;
    let x = facet.map(|n| mesh.nodes[n as usize]);
    let area = area_vector(&x);
    let size = norm(area);
    let edges = [0, 1, 2, 3].map(|k| norm(difference(x[(k + 1) % 4], x[k])));
    let length = edges.into_iter().fold(0.0, f64::max);
    let depth = mesh.volume(element) / size;
    Side {
        body: mesh.unit[element],
        centre: mean(&x),
        normal: area.map(|a| a / size),
        size: [length, depth],
        compliance: compliance(model, element, [length, depth]),
    }
}

/// The warning about the body of an element, beside a joint with this law, stiffness and slope [N/mm³].
fn warning(
    deck: &Deck,
    model: &Model,
    side: &Side,
    (law, stiffness, slope): (&str, f64, f64),
) -> Warning {
    let [length, depth] = side.size;
    let name = model.mesh.names.get(side.body as usize);
    let name = name.map_or("", String::as_str);
    let enough = length * (stiffness / (LEAST * slope)).sqrt();
    let message = format!(
        "the elements of `{name}` at its joint are flat, {length:.1} mm along it and {depth:.1} mm deep: incompatible ones \
         resist shear that varies along them by {stiffness:.3} N/mm^3 only, and {law} softens by up to {slope:.3} N/mm^3, so \
         that parts of facets may stick while others slide, with several times the friction (elements of {enough:.1} mm \
         along the joint, or element.formulation = \"full\" or \"b-bar\")"
    );
    deck.warning(&key(deck, model, side.body, name), message)
}

/// Key of the mesh of a body.
fn key(deck: &Deck, model: &Model, body: u32, name: &str) -> String {
    if let Some(i) = deck.blocks.iter().position(|block| block.name == name) {
        return format!("blocks.{i}.mesh");
    }
    let mut walls = model.mesh.walls.iter();
    let wall = walls.find(|wall| wall.units.binary_search(&body).is_ok());
    let path = wall.and_then(|wall| {
        let mut walls = deck.walls();
        walls.find_map(|(path, name, _)| (name == wall.name).then_some(path))
    });
    path.map_or("element.formulation".to_owned(), |path| {
        format!("{path}.mesh")
    })
}
