//! Surfaces and interactions: friction and contact stiffness as keywords, the bond as comments.

use std::collections::HashMap;
use std::fmt::Write as _;

use super::{labels, set};
use crate::deck::import::SIDES;
use crate::model::Model;
use wythe_contact::{CohesiveFrictional, InterfaceLaw, JointLaw};

/// Element and number of its side, by the sorted nodes of the side.
type Sides = HashMap<[u32; 4], (usize, usize)>;

/// Slave surfaces, one per law, the surface of all masters, and their interactions.
pub(super) fn contact(text: &mut String, model: &Model) -> std::fmt::Result {
    let contact = &model.contact;
    if contact.slave_facets.is_empty() {
        return Ok(());
    }
    let mut sides = Sides::new();
    for (e, nodes) in model.mesh.elements.iter().enumerate() {
        for (side, corners) in SIDES.iter().enumerate() {
            let mut facet = corners.map(|n| nodes[n]);
            facet.sort_unstable();
            sides.entry(facet).or_insert((e, side));
        }
    }
    let names = labels(contact.law_names.iter().map(String::as_str));
    for (l, name) in names.iter().enumerate() {
        let all = contact.whole_slaves();
        let of = all.filter(|(f, _)| usize::from(contact.slave_law[*f]) == l);
        let facets = of.map(|(_, facet)| facet);
        surface(text, &format!("SLAVE_{name}"), facets, &sides)?;
    }
    surface(text, "MASTER", contact.master_facets.iter(), &sides)?;
    for (law, name) in contact.laws.iter().zip(&names) {
        interaction(text, name, law)?;
    }
    writeln!(text, "*CONTACT\n*CONTACT INCLUSIONS")?;
    for name in &names {
        writeln!(text, "SLAVE_{name}, MASTER")?;
    }
    writeln!(text, "*CONTACT PROPERTY ASSIGNMENT")?;
    for name in &names {
        writeln!(text, "SLAVE_{name}, MASTER, {name}")?;
    }
    Ok(())
}

/// Defines a surface by sets of elements with the same side.
fn surface<'a>(
    text: &mut String,
    name: &str,
    facets: impl Iterator<Item = &'a [u32; 4]>,
    sides: &Sides,
) -> std::fmt::Result {
    let mut of_side: [Vec<usize>; 6] = Default::default();
    for facet in facets {
        let mut nodes = *facet;
        nodes.sort_unstable();
        // Every facet is a side of an element.
        if let Some((e, side)) = sides.get(&nodes) {
            of_side[*side].push(*e);
        }
    }
    for (side, elements) in of_side.iter().enumerate() {
        let name = format!("_{name}_S{}", side + 1);
        set(text, "ELSET", &name, elements.iter().copied())?;
    }
    writeln!(text, "*SURFACE, TYPE=ELEMENT, NAME={name}")?;
    for (side, _) in of_side.iter().enumerate().filter(|(_, e)| !e.is_empty()) {
        writeln!(text, "_{name}_S{0}, S{0}", side + 1)?;
    }
    Ok(())
}

fn interaction(text: &mut String, name: &str, law: &InterfaceLaw) -> std::fmt::Result {
    let Some(law) = law.as_cohesive_frictional() else {
        let [normal, shear] = law.stiffness();
        return writeln!(
            text,
            "*SURFACE INTERACTION, NAME={name}\n\
             ** The joint law {} needs a user subroutine (UINTER); its shear stiffness is {shear:?} N/mm3.\n\
             *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{normal:?}",
            law.name()
        );
    };
    let CohesiveFrictional {
        f_t,
        c,
        tan_phi,
        mu,
        u_k,
        delta_k,
        zeta,
        xi,
        normal_stiffness,
        shear_stiffness,
        ..
    } = law;
    writeln!(text, "*SURFACE INTERACTION, NAME={name}")?;
    if *f_t > 0.0 || *c > 0.0 {
        // Area below the softening curve: theory/joint.md, eqs 30 and 31.
        let area = |strength: f64, end: f64, b: f64| {
            if strength == 0.0 {
                return 0.0; // the end of the curve may be infinite
            }
            strength * end * (1.0 / b - 1.0 / b.exp_m1())
        };
        let energies = [area(*f_t, *u_k, *zeta), area(*c, *delta_k, *xi)];
        writeln!(
            text,
            "** The bond needs a user subroutine (UINTER): f_t = {f_t:?}, c = {c:?} MPa, tan_phi = {tan_phi:?}, \
             u_k = {u_k:?}, delta_k = {delta_k:?} mm, zeta = {zeta:?}, xi = {xi:?}.\n\
             ** Without one the nearest is, its leading asterisks taken away:\n\
             ***COHESIVE BEHAVIOR\n\
             **{normal_stiffness:?}, {shear_stiffness:?}, {shear_stiffness:?}\n\
             ***DAMAGE INITIATION, CRITERION=QUADS\n\
             **{f_t:?}, {c:?}, {c:?}\n\
             ***DAMAGE EVOLUTION, TYPE=ENERGY, MIXED MODE BEHAVIOR=POWER LAW, POWER=1.\n\
             **{0:?}, {1:?}, {1:?}",
            energies[0], energies[1]
        )?;
    }
    writeln!(text, "*FRICTION\n{mu:?}")?;
    writeln!(
        text,
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{normal_stiffness:?}"
    )
}
