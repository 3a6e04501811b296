//! Reads the sections of a `.msh`.

use super::cursor::{Cursor, Endian};
use super::gather::{Element, Gathered};
use crate::deck::import::numbers::real;
use crate::deck::import::{MOST_ELEMENTS, MOST_NODES, Wrong};
use crate::error::is_hidden;

/// `$MeshFormat`: returns the version, 2 or 4, and sets the form of the numbers that follow.
pub(super) fn format(cursor: &mut Cursor<'_>) -> Result<u32, Wrong> {
    let help = "save it as version 4.1 (Mesh.MshFileVersion = 4.1; gmsh -format msh41)";
    let version = cursor.word().and_then(real);
    let kind = cursor.int()?;
    let size = cursor.int()?;
    let version = match version {
        Some(4.1) => 4,
        Some(v) if (2.0..3.0).contains(&v) => 2,
        Some(v) => return Err(cursor.wrong(format!("version {v} of Gmsh's format"), help)),
        None => return Err(cursor.wrong("a $MeshFormat without a version", help)),
    };
    if size != 8 || !(0..=1).contains(&kind) {
        return Err(cursor.wrong(
            format!("a file of type {kind} with numbers of {size} bytes"),
            help,
        ));
    }
    if kind == 1 {
        cursor.line();
        // The file contains the number 1, whose bytes show their order.
        cursor.binary = Some(Endian::Little);
        match cursor.int()? {
            1 => {}
            0x0100_0000 => cursor.binary = Some(Endian::Big),
            other => {
                return Err(cursor.wrong(
                    format!("{other} stands where 1 tells the order of the bytes"),
                    "the file is damaged: save it again",
                ));
            }
        }
    }
    Ok(version)
}

/// Reads a number as text, also in a binary file.
fn written(cursor: &mut Cursor<'_>) -> Result<i64, Wrong> {
    let number = cursor.word().and_then(|w| w.parse().ok());
    number.ok_or_else(|| {
        cursor.wrong(
            "a whole number is missing",
            "the file does not follow its format: save it again",
        )
    })
}

/// `$PhysicalNames`: text, also in binary files.
pub(super) fn physical_names(
    cursor: &mut Cursor<'_>,
    gathered: &mut Gathered,
) -> Result<(), Wrong> {
    let count = written(cursor)?;
    for _ in 0..count {
        if cursor.at_end_of("PhysicalNames") {
            break;
        }
        let (dimension, tag) = (written(cursor)?, written(cursor)?);
        let line = cursor.line().unwrap_or_default();
        let name = line.trim().trim_matches('"').to_owned();
        if name.contains(is_hidden) {
            return Err(cursor.wrong(
                format!("a control character stands in the name of the physical group {tag}"),
                "names are of characters that can be seen",
            ));
        }
        gathered.names.insert((dimension, tag), name);
    }
    Ok(())
}

/// `$Entities` of version 4: physical groups of each entity.
pub(super) fn entities(cursor: &mut Cursor<'_>, gathered: &mut Gathered) -> Result<(), Wrong> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size()?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = cursor.int()?;
            // Coordinates of a point, or of a bounding box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                cursor.real()?;
            }
            let groups = cursor.size()?;
            for _ in 0..groups {
                let group = cursor.int()?.abs();
                let of = gathered.groups.entry((dimension as i64, tag));
                of.or_default().push(group);
            }
            if dimension > 0 {
                let bounds = cursor.size()?;
                for _ in 0..bounds {
                    cursor.int()?;
                }
            }
        }
    }
    Ok(())
}

/// Number of blocks of a section; three other numbers stand behind it.
fn blocks(cursor: &mut Cursor<'_>) -> Result<u64, Wrong> {
    let blocks = cursor.size()?;
    for _ in 0..3 {
        cursor.size()?;
    }
    Ok(blocks)
}

/// `$Nodes`.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    gathered: &mut Gathered,
    version: u32,
) -> Result<(), Wrong> {
    let too_many = "at most 8e7 nodes: coarsen the mesh";
    if version == 2 {
        let count = written(cursor)?;
        if cursor.binary.is_some() {
            cursor.line();
        }
        for _ in 0..count {
            let tag = cursor.tag(version)?;
            let x = [cursor.real()?, cursor.real()?, cursor.real()?];
            gathered.node(tag, x, cursor)?;
            if gathered.nodes.len() > MOST_NODES {
                return Err(cursor.wrong("there are too many nodes", too_many));
            }
        }
        return Ok(());
    }
    for _ in 0..blocks(cursor)? {
        let (dimension, _, parametric) = (cursor.int()?, cursor.int()?, cursor.int()?);
        let count = cursor.size()?;
        let mut tags = Vec::new();
        for _ in 0..count {
            tags.push(cursor.size()?);
            if tags.len() + gathered.nodes.len() > MOST_NODES {
                return Err(cursor.wrong("there are too many nodes", too_many));
            }
        }
        let parameters = if parametric == 0 {
            0
        } else {
            dimension.clamp(0, 3)
        };
        for tag in tags {
            let x = [cursor.real()?, cursor.real()?, cursor.real()?];
            for _ in 0..parameters {
                cursor.real()?;
            }
            gathered.node(tag, x, cursor)?;
        }
    }
    Ok(())
}

/// `$Elements`.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    gathered: &mut Gathered,
    version: u32,
) -> Result<(), Wrong> {
    if version == 2 {
        return elements_of_2(cursor, gathered);
    }
    for _ in 0..blocks(cursor)? {
        let (dimension, entity, kind) = (cursor.int()?, cursor.int()?, cursor.int()?);
        let count = cursor.size()?;
        let groups = gathered.groups.get(&(dimension, entity));
        let groups = groups.cloned().unwrap_or_default();
        let corners = nodes_of(cursor, kind)?;
        for _ in 0..count {
            let place = next_line(cursor);
            let tag = cursor.size()?;
            let mut nodes = [0; 125];
            for node in &mut nodes[..corners] {
                *node = cursor.size()?;
            }
            add(
                cursor,
                gathered,
                (kind, tag, place),
                &nodes[..corners],
                &groups,
            )?;
        }
    }
    Ok(())
}

/// Elements of version 2: each has its group among its tags; a binary file has blocks of one type.
fn elements_of_2(cursor: &mut Cursor<'_>, gathered: &mut Gathered) -> Result<(), Wrong> {
    let total = written(cursor)?;
    if cursor.binary.is_some() {
        cursor.line();
    }
    let mut read = 0;
    while read < total {
        let mut header = [0; 3];
        let mut place = next_line(cursor);
        for number in &mut header {
            *number = cursor.int()?;
        }
        // In text: number, type, count of tags. In binary form: type, count of elements, count of tags.
        let (kind, count) = match cursor.binary {
            Some(_) => (header[0], header[1]),
            None => (header[1], 1),
        };
        let corners = nodes_of(cursor, kind)?;
        if count < 1 {
            return Err(cursor.wrong(
                format!("a block of {count} elements"),
                "the file is damaged: save it again",
            ));
        }
        for _ in 0..count {
            let tag = match cursor.binary {
                Some(_) => cursor.tag(2)?,
                None => header[0].unsigned_abs(),
            };
            let mut group = 0;
            for i in 0..header[2] {
                let value = cursor.int()?;
                group = if i == 0 { value.abs() } else { group };
            }
            let mut nodes = [0; 125];
            for node in &mut nodes[..corners] {
                *node = cursor.tag(2)?;
            }
            let groups: &[i64] = if group == 0 { &[] } else { &[group] };
            add(
                cursor,
                gathered,
                (kind, tag, place),
                &nodes[..corners],
                groups,
            )?;
            place = next_line(cursor);
            read += 1;
        }
    }
    Ok(())
}

/// Line of the next word.
fn next_line(cursor: &mut Cursor<'_>) -> crate::deck::import::Place {
    let mut place = cursor.place();
    if cursor.binary.is_none() {
        place.line = cursor.line_of_next();
    }
    place
}

/// Adds an element of a type, with its tag, line and nodes, to its physical groups.
fn add(
    cursor: &Cursor<'_>,
    gathered: &mut Gathered,
    (kind, tag, place): (i64, u64, crate::deck::import::Place),
    nodes: &[u64],
    groups: &[i64],
) -> Result<(), Wrong> {
    gathered.element(
        Element {
            kind,
            tag,
            nodes,
            place,
        },
        groups,
    )?;
    if gathered.count() <= MOST_ELEMENTS {
        return Ok(());
    }
    Err(cursor.wrong(
        "there are too many elements",
        "at most 1e7: coarsen the mesh",
    ))
}

/// Number of nodes of an element type (Gmsh reference manual, 10.2).
fn nodes_of(cursor: &Cursor<'_>, kind: i64) -> Result<usize, Wrong> {
    const NODES: [usize; 31] = [
        2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4,
        5, 6, 20, 35, 56,
    ];
    let known = usize::try_from(kind)
        .ok()
        .and_then(|k| k.checked_sub(1))
        .and_then(|k| NODES.get(k).copied());
    let higher = [(92, 64), (93, 125)].iter().find(|(k, _)| *k == kind);
    known.or(higher.map(|(_, n)| *n)).ok_or_else(|| {
        cursor.wrong(
            format!("elements of the type {kind} are not known"),
            "mesh it with hexahedra of first order, type 5",
        )
    })
}
