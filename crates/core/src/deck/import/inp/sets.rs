//! Sets and surfaces of an `.inp` as written.

use super::lines::Keyword;
use super::raw::{Member, Set, Surface};
use super::reader::member;
use crate::deck::import::numbers::label;
use crate::deck::import::{Place, Wrong};

/// Set of the nodes or elements that follow (`*NODE, NSET=NAME`).
pub(super) fn of_what_follows(name: &str, place: Place) -> Set {
    Set {
        name: name.to_owned(),
        instance: None,
        members: Vec::new(),
        place,
    }
}

/// Adds a label to the last set.
pub(super) fn follow(sets: &mut [Set], label: u64) {
    if let Some(set) = sets.last_mut() {
        // Labels mostly ascend by one: they are stored as ranges.
        match set.members.last_mut() {
            Some(Member::Range([_, to, 1])) if *to + 1 == label => *to = label,
            _ => set.members.push(Member::Range([label, label, 1])),
        }
    }
}

/// The set that an *NSET or *ELSET begins.
pub(super) fn set(keyword: &Keyword, of_nodes: bool) -> Result<Set, Wrong> {
    let name = keyword.required(if of_nodes { "NSET" } else { "ELSET" })?;
    let mut members = Vec::new();
    if let Some(elements) = keyword.get("ELSET").filter(|_| of_nodes) {
        members.push(Member::NodesOf(elements.to_owned()));
    }
    Ok(Set {
        name,
        instance: keyword.get("INSTANCE").map(str::to_owned),
        members,
        place: keyword.place,
    })
}

/// Reads the members on a line: labels and names, or first, last and step.
pub(super) fn members(
    set: &mut Set,
    fields: &[&str],
    generated: bool,
    place: Place,
) -> Result<(), Wrong> {
    if !generated {
        let filled = fields.iter().filter(|f| !f.is_empty());
        set.members.extend(filled.map(|f| member(f)));
        return Ok(());
    }
    let end = fields
        .iter()
        .rposition(|f| !f.is_empty())
        .map_or(0, |i| i + 1);
    let numbers: Vec<Option<u64>> = fields[..end].iter().map(|f| label(f)).collect();
    let range = match numbers[..] {
        [Some(one)] => [one, one, 1],
        [Some(from), Some(to)] if from <= to => [from, to, 1],
        [Some(from), Some(to), Some(step)] if from <= to => [from, to, step],
        _ => {
            return Err(Wrong::new(
                place,
                format!("`{}` generates nothing", fields.join(", ")),
                "first label, last label, step: whole numbers from 1, the last not below the first",
            ));
        }
    };
    set.members.push(Member::Range(range));
    Ok(())
}

/// The surface that a *SURFACE begins; none if its kind is not read.
pub(super) fn surface(keyword: &Keyword) -> Result<Option<Surface>, Wrong> {
    let kind = keyword.get("TYPE").unwrap_or("ELEMENT").to_uppercase();
    let read = ["ELEMENT", "NODE"].contains(&kind.as_str());
    if !read || keyword.has("COMBINE") || keyword.has("CROP") {
        return Ok(None);
    }
    Ok(Some(Surface {
        name: keyword.required("NAME")?,
        of_nodes: kind == "NODE",
        members: Vec::new(),
    }))
}

/// Reads a line of a surface: a label or a set, and the side of its elements.
pub(super) fn sides(surface: &mut Surface, fields: &[&str], place: Place) {
    let Some(who) = fields.first().filter(|f| !f.is_empty()) else {
        return;
    };
    let side = fields.get(1).filter(|f| !f.is_empty() && !surface.of_nodes);
    let side = side.map(|text| text.to_uppercase());
    surface.members.push((member(who), side, place));
}
