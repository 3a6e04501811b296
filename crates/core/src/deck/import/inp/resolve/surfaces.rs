//! Surfaces of an `.inp`: sides of hexahedra by the names of their elements or nodes.

use super::{ELEMENTS, Frame, NODES, Search};
use crate::deck::import::inp::raw::Surface;
use crate::deck::import::{ImportedMesh, Place, Wrong};

/// Resolves the surfaces of all frames. Missing members give a note only, because the surface may be unused.
pub(super) fn surfaces(frames: &[Frame<'_>], mesh: &mut ImportedMesh) -> Result<(), Wrong> {
    let any = |f: &Frame<'_>| f.scopes.iter().any(|s| !s.surfaces.is_empty());
    if !frames.iter().any(any) {
        return Ok(());
    }
    // Sides that belong to three elements are rejected by `ImportedMesh::check`.
    let outside = mesh.exterior().unwrap_or_default();
    for (at, frame) in frames.iter().enumerate() {
        for surface in frame.scopes.iter().flat_map(|s| &s.surfaces) {
            let name = frame.full(&surface.name);
            let (sides, nodes) = sides(frames, at, surface, mesh, &outside)?;
            if sides.is_empty() {
                left_without_sides(mesh, name, nodes);
                continue;
            }
            let mut all = mesh.surfaces.remove(&name).unwrap_or_default();
            all.extend(sides);
            all.sort_unstable();
            all.dedup();
            mesh.surfaces.insert(name, all);
        }
    }
    Ok(())
}

/// Keeps a surface without sides of hexahedra as a set of nodes, if it has nodes.
fn left_without_sides(mesh: &mut ImportedMesh, name: String, mut nodes: Vec<u32>) {
    if nodes.is_empty() {
        mesh.notes.push(format!(
            "surface {name} is left out: none of its elements is a hexahedron"
        ));
        return;
    }
    mesh.notes.push(format!(
        "surface {name} of nodes is read as a set of nodes: no side of an element has all of its nodes in it"
    ));
    nodes.sort_unstable();
    nodes.dedup();
    mesh.node_sets.entry(name).or_insert(nodes);
}

/// Sides of elements of a surface, and its nodes if it consists of nodes.
type Found = (Vec<(u32, u8)>, Vec<u32>);

/// Resolves a surface.
fn sides(
    frames: &[Frame<'_>],
    at: usize,
    surface: &Surface,
    mesh: &mut ImportedMesh,
    outside: &[(u32, u8)],
) -> Result<Found, Wrong> {
    let mut all = Vec::new();
    let mut nodes = Vec::new();
    let mut absent = None;
    let kind = if surface.of_nodes { NODES } else { ELEMENTS };
    for (member, side, place) in &surface.members {
        let mut search = Search::new(frames, mesh, kind);
        search.absent = absent;
        search.member(at, member, *place, 0)?;
        let mut found = search.found;
        absent = search.absent;
        match side {
            // Elements of other types have sides of other names.
            Some(_) if found.is_empty() => {}
            Some(side) => {
                let side = number_of(side, surface, *place)?;
                all.extend(found.into_iter().map(|e| (e, side)));
            }
            None if surface.of_nodes => nodes.extend(found),
            None => {
                found.sort_unstable();
                let of_set = |(e, _): &&(u32, u8)| found.binary_search(e).is_ok();
                all.extend(outside.iter().filter(of_set));
            }
        }
    }
    if let Some((label, count)) = absent {
        let what = if surface.of_nodes {
            "nodes"
        } else {
            "elements"
        };
        let name = frames[at].full(&surface.name);
        mesh.notes.push(format!(
            "surface {name}: {count} of its {what} are not there (the first is {label})"
        ));
    }
    if surface.of_nodes {
        all = mesh.sides_between(&nodes, outside);
    }
    Ok((all, nodes))
}

/// Index of a side of a hexahedron from 0; S1 to S6 in the file.
fn number_of(side: &str, surface: &Surface, place: Place) -> Result<u8, Wrong> {
    match side
        .strip_prefix('S')
        .and_then(crate::deck::import::numbers::label)
    {
        Some(n @ 1..=6) => Ok(n as u8 - 1),
        _ => Err(Wrong::new(
            place,
            format!(
                "surface {}: `{side}` is no side of a hexahedron",
                surface.name
            ),
            "its sides are S1 to S6",
        )),
    }
}
