//! From an `.inp` to a mesh: places instances and resolves labels and names.

mod left_out;
mod surfaces;

use std::collections::{BTreeMap, HashMap, HashSet};

use super::raw::{Instance, Member, Node, Raw, Scope, Set};
use crate::deck::import::numbers::label;
use crate::deck::import::{ImportedMesh, MOST_ELEMENTS, MOST_NODES, Place, Section, Wrong};
use crate::deck::keys::nearest;
use crate::element::hexahedron::norm;
use crate::model::scene::turned;
use left_out::{leave_others_out, leave_parts_out, notes};
use surfaces::surfaces;

/// Largest depth of sets of sets; deeper ones refer to each other in a circle.
const DEEPEST: usize = 32;

/// Largest number of members of all sets together.
const MOST_MEMBERS: usize = 400_000_000;

/// Keywords of the two kinds of sets.
const KINDS: [&str; 2] = ["NSET", "ELSET"];
const NODES: usize = 0;
const ELEMENTS: usize = 1;

/// An instance in the mesh, or the assembly (a file without parts) itself.
struct Frame<'a> {
    name: Option<String>,
    /// Scope of the part, and of the instance alone.
    scopes: Vec<&'a Scope>,
    /// Nodes and elements by label. `[kind]`
    labels: [HashMap<u64, u32>; 2],
    /// Labels in ascending order, for ranges. `[kind]`
    order: [Vec<u64>; 2],
    /// Labels of elements that are not read.
    others: HashSet<u64>,
    /// Definitions by name in capitals, in the order of the file. `[kind]`
    sets: [BTreeMap<String, Vec<&'a Set>>; 2],
    /// Members of resolved sets. `[kind]`
    found: [BTreeMap<String, Vec<u32>>; 2],
}

/// Resolves all names of a file.
pub(super) fn resolve(raw: Raw) -> Result<ImportedMesh, Wrong> {
    let mut mesh = ImportedMesh {
        notes: notes(&raw),
        ..ImportedMesh::default()
    };
    let mut frames = frames_of(&raw)?;
    let instances = raw.instances.iter().map(|instance| instance.name.clone());
    mesh.instances.extend(instances);
    let empty = Vec::new();
    for (i, frame) in frames.iter_mut().enumerate() {
        let instance = i.checked_sub(1);
        let moves = instance.map_or(&empty, |i| &raw.instances[i].moves);
        lay(&mut mesh, frame, instance.map(|i| i as u16), moves)?;
    }
    leave_others_out(&mut mesh, &mut frames);
    leave_parts_out(&mut mesh, &raw);
    let mut members = 0;
    for i in 0..frames.len() {
        look_up(&mut frames, i, &mut mesh, &mut members)?;
    }
    surfaces(&frames, &mut mesh)?;
    sections(&frames, &mut mesh)?;
    for frame in frames {
        frame.give_sets(&mut mesh);
    }
    mesh.materials = raw.materials;
    mesh.take_unused_nodes_out();
    Ok(mesh)
}

/// Frames of the assembly and of each instance.
fn frames_of(raw: &Raw) -> Result<Vec<Frame<'_>>, Wrong> {
    let mut frames = vec![Frame::of(None, vec![&raw.scope])];
    for (i, instance) in raw.instances.iter().enumerate() {
        let part = raw.parts.get(&instance.part.to_uppercase());
        let part = part.ok_or_else(|| unknown_part(raw, instance))?;
        let twice = raw.instances[..i]
            .iter()
            .any(|other| other.name.eq_ignore_ascii_case(&instance.name));
        if twice || u16::try_from(i).is_err() {
            return Err(Wrong::new(
                instance.place,
                format!("there are two instances named {}", instance.name),
                "give each a name of its own; at most 65535 in all",
            ));
        }
        let scopes = vec![part, &instance.own];
        frames.push(Frame::of(Some(instance.name.clone()), scopes));
    }
    if frames.len() == 1
        && raw.scope.elements.is_empty()
        && let Some((name, _)) = raw.parts.iter().find(|(_, p)| !p.elements.is_empty())
    {
        return Err(Wrong::new(
            Place::default(),
            format!("the part {name} is not used: there is no *INSTANCE of it"),
            "write the assembly, too, or take *PART and *END PART out",
        ));
    }
    Ok(frames)
}

fn unknown_part(raw: &Raw, instance: &Instance) -> Wrong {
    let name = &instance.part;
    let known = raw.parts.keys().map(String::as_str);
    let help = nearest(name, known.clone()).map_or_else(
        || format!("the file has {}", known.collect::<Vec<_>>().join(", ")),
        |near| format!("did you mean {near}?"),
    );
    Wrong::new(
        instance.place,
        format!("instance {}: there is no part named {name}", instance.name),
        help,
    )
}

impl<'a> Frame<'a> {
    fn of(name: Option<String>, scopes: Vec<&'a Scope>) -> Self {
        let named = |of_kind: fn(&Scope) -> &[Set]| {
            let mut named: BTreeMap<String, Vec<&Set>> = BTreeMap::new();
            for set in scopes.iter().flat_map(|scope| of_kind(scope)) {
                named.entry(set.name.to_uppercase()).or_default().push(set);
            }
            named
        };
        let sets = [
            named(|scope| &scope.node_sets),
            named(|scope| &scope.element_sets),
        ];
        Self {
            name,
            scopes,
            others: HashSet::new(),
            labels: Default::default(),
            order: Default::default(),
            sets,
            found: Default::default(),
        }
    }

    /// `INSTANCE.NAME`, or the name in the assembly.
    fn full(&self, name: &str) -> String {
        match &self.name {
            Some(instance) => format!("{instance}.{name}"),
            None => name.to_owned(),
        }
    }

    /// Adds the resolved sets to the mesh, by the names of the file.
    fn give_sets(mut self, mesh: &mut ImportedMesh) {
        let [nodes, elements] = std::mem::take(&mut self.found);
        let written = |kind: usize, capitals: &str| {
            let first = self.sets[kind].get(capitals).and_then(|sets| sets.first());
            self.full(first.map_or(capitals, |set| &set.name))
        };
        let nodes = nodes.into_iter().map(|(n, set)| (written(NODES, &n), set));
        mesh.node_sets.extend(nodes);
        // Sets that contain only elements of other types are dropped.
        let others = !self.others.is_empty();
        let elements = elements
            .into_iter()
            .filter(|(_, set)| !(others && set.is_empty()));
        let elements = elements.map(|(n, set)| (written(ELEMENTS, &n), set));
        mesh.element_sets.extend(elements);
    }

    /// Indices of the labels in a range: first, last, step.
    fn range(&self, kind: usize, [from, to, step]: [u64; 3]) -> Vec<u32> {
        let order = &self.order[kind];
        let first = order.partition_point(|label| *label < from);
        let upto = order[first..].iter().take_while(|label| **label <= to);
        let stepped = upto.filter(|label| (*label - from) % step == 0);
        stepped.map(|label| self.labels[kind][label]).collect()
    }
}

/// Adds the nodes and elements of an instance to the mesh, at its place in the assembly.
fn lay(
    mesh: &mut ImportedMesh,
    frame: &mut Frame<'_>,
    instance: Option<u16>,
    moves: &[Vec<f64>],
) -> Result<(), Wrong> {
    let nodes: usize = frame.scopes.iter().map(|s| s.nodes.len()).sum();
    let elements: usize = frame.scopes.iter().map(|s| s.elements.len()).sum();
    if mesh.nodes.len() + nodes > MOST_NODES || mesh.elements.len() + elements > MOST_ELEMENTS {
        return Err(Wrong::new(
            Place::default(),
            "all instances together have too many elements",
            "at most 1e7 elements: coarsen the mesh, or import a part of it",
        ));
    }
    let scopes = frame.scopes.clone();
    for Node { label, x, place } in scopes.iter().flat_map(|s| &s.nodes) {
        let index = mesh.nodes.len() as u32;
        if frame.labels[NODES].insert(*label, index).is_some() {
            return Err(twice("node", *label, *place));
        }
        mesh.nodes.push(placed(*x, moves));
        mesh.node_labels.push(*label);
    }
    for element in scopes.iter().flat_map(|s| &s.elements) {
        let index = mesh.elements.len() as u32;
        if frame.labels[ELEMENTS]
            .insert(element.label, index)
            .is_some()
        {
            return Err(twice("element", element.label, element.place));
        }
        let mut nodes = [0; 8];
        for (node, label) in nodes.iter_mut().zip(element.nodes) {
            *node = *frame.labels[NODES].get(&label).ok_or_else(|| {
                let of = frame
                    .name
                    .as_ref()
                    .map_or(String::new(), |n| format!(" of {n}"));
                Wrong::new(
                    element.place,
                    format!(
                        "element {}{of} names the node {label}, which is not there",
                        element.label
                    ),
                    "write the node, or mend the element",
                )
            })?;
        }
        mesh.elements.push(nodes);
        mesh.element_labels.push(element.label);
        mesh.element_places.push(element.place);
        mesh.element_instance.push(instance);
    }
    for kind in [NODES, ELEMENTS] {
        frame.order[kind] = frame.labels[kind].keys().copied().collect();
        frame.order[kind].sort_unstable();
    }
    Ok(())
}

fn twice(what: &str, label: u64, place: Place) -> Wrong {
    Wrong::new(
        place,
        format!("{what} {label} is there twice"),
        "labels are each there once in a part",
    )
}

/// Position of a point of a part: first moved, then turned about an axis of the assembly.
fn placed(x: [f64; 3], moves: &[Vec<f64>]) -> [f64; 3] {
    let mut x = x;
    for numbers in moves {
        if let [ax, ay, az, bx, by, bz, angle] = numbers[..] {
            let (a, axis) = ([ax, ay, az], [bx - ax, by - ay, bz - az]);
            let length = norm(axis);
            if length > 0.0 && angle != 0.0 {
                let from = [0, 1, 2].map(|d| x[d] - a[d]);
                let to = turned(from, axis.map(|c| c / length), angle.to_radians());
                x = [0, 1, 2].map(|d| to[d] + a[d]);
            }
        } else {
            for (x, by) in x.iter_mut().zip(numbers) {
                *x += by;
            }
        }
    }
    x
}

/// Resolves all sets of a frame; those of instances must be resolved before those of the assembly.
fn look_up(
    frames: &mut [Frame<'_>],
    at: usize,
    mesh: &mut ImportedMesh,
    members: &mut usize,
) -> Result<(), Wrong> {
    // The assembly is the first frame and may name sets of any instance: it comes last.
    let at = (at + 1) % frames.len();
    for kind in [ELEMENTS, NODES] {
        let names: Vec<String> = frames[at].sets[kind].keys().cloned().collect();
        for name in names {
            let mut search = Search::new(frames, mesh, kind);
            search.set(at, &name, 0)?;
            let Search { found, absent, .. } = search;
            *members += found.len();
            if *members > MOST_MEMBERS {
                return Err(Wrong::new(
                    Place::default(),
                    "its sets have too many members",
                    "take out sets that are not used",
                ));
            }
            if let Some((label, count)) = absent {
                mesh.notes.push(format!(
                    "{} {}: {count} of its labels are not there (the first is {label})",
                    KINDS[kind],
                    frames[at].full(&name)
                ));
            }
            frames[at].found[kind].insert(name, found);
        }
    }
    Ok(())
}

/// Search for the nodes or elements that members of sets denote.
struct Search<'s, 'a> {
    frames: &'s [Frame<'a>],
    mesh: &'s ImportedMesh,
    kind: usize,
    found: Vec<u32>,
    /// The first label that is not there, and the number of those.
    absent: Option<(u64, usize)>,
}

impl<'s, 'a> Search<'s, 'a> {
    fn new(frames: &'s [Frame<'a>], mesh: &'s ImportedMesh, kind: usize) -> Self {
        Self {
            frames,
            mesh,
            kind,
            found: Vec::new(),
            absent: None,
        }
    }

    /// Adds the members of a set of a frame; the name is in capitals.
    fn set(&mut self, at: usize, name: &str, depth: usize) -> Result<(), Wrong> {
        let frame = &self.frames[at];
        if let Some(known) = frame.found[self.kind].get(name) {
            self.found.extend(known);
            return Ok(());
        }
        let Some(definitions) = frame.sets[self.kind].get(name) else {
            return Ok(());
        };
        for set in definitions {
            let of = match set.instance.as_deref() {
                None => at,
                Some(instance) => frame_named(self.frames, instance, set.place)?,
            };
            for member in &set.members {
                self.member(of, member, set.place, depth)?;
                // A set may name the same members on every line.
                if self.found.len() > 64 + 2 * (self.mesh.nodes.len() + self.mesh.elements.len()) {
                    self.sort();
                }
            }
        }
        self.sort();
        Ok(())
    }

    fn sort(&mut self) {
        self.found.sort_unstable();
        self.found.dedup();
    }

    /// Adds the nodes or elements that one member denotes.
    fn member(
        &mut self,
        at: usize,
        member: &Member,
        place: Place,
        depth: usize,
    ) -> Result<(), Wrong> {
        let (frame, kind) = (&self.frames[at], self.kind);
        match member {
            Member::Label(label) => match frame.labels[kind].get(label) {
                Some(index) => self.found.push(*index),
                None if kind == ELEMENTS && frame.others.contains(label) => {}
                None => self.absent.get_or_insert((*label, 0)).1 += 1,
            },
            Member::Range(range) => self.found.extend(frame.range(kind, *range)),
            Member::NodesOf(set) => {
                let mut elements = Search::new(self.frames, self.mesh, ELEMENTS);
                elements.absent = self.absent;
                elements.member(at, &Member::Name(set.clone()), place, depth)?;
                self.absent = elements.absent;
                let nodes = elements
                    .found
                    .iter()
                    .flat_map(|&e| self.mesh.elements[e as usize]);
                self.found.extend(nodes);
            }
            Member::Name(name) => self.named(at, name, place, depth)?,
        }
        Ok(())
    }

    /// Adds what a name denotes: a set, or the label of a node or an element of an instance.
    fn named(&mut self, at: usize, name: &str, place: Place, depth: usize) -> Result<(), Wrong> {
        if depth >= DEEPEST {
            return Err(Wrong::new(
                place,
                format!("the set {name} is made of sets that are made of sets, and so on"),
                "let sets not contain each other in a circle",
            ));
        }
        let (at, name) = place_of(self.frames, at, name, place)?;
        let (frame, kind) = (&self.frames[at], self.kind);
        if let Some(label) = label(name) {
            if let Some(index) = frame.labels[kind].get(&label) {
                self.found.push(*index);
                return Ok(());
            }
            if kind == ELEMENTS && frame.others.contains(&label) {
                return Ok(()); // belongs to an instance and was left out
            }
        }
        let name = name.to_uppercase();
        if !frame.sets[kind].contains_key(&name) {
            let known = frame.sets[kind].keys().map(String::as_str);
            return Err(unknown(KINDS[kind], &name, known, place));
        }
        self.set(at, &name, depth + 1)
    }
}

/// Splits `INSTANCE.NAME` in the assembly into the frame of the instance and the name; other names stay in frame
/// `at`.
fn place_of<'n>(
    frames: &[Frame<'_>],
    at: usize,
    name: &'n str,
    place: Place,
) -> Result<(usize, &'n str), Wrong> {
    match name.split_once('.') {
        Some((instance, set)) if at == 0 && frames.len() > 1 => {
            Ok((frame_named(frames, instance, place)?, set))
        }
        _ => Ok((at, name)),
    }
}

fn frame_named(frames: &[Frame<'_>], name: &str, place: Place) -> Result<usize, Wrong> {
    let names = frames.iter().map(|f| f.name.as_deref().unwrap_or_default());
    let found = names.clone().position(|n| n.eq_ignore_ascii_case(name));
    found
        .filter(|i| *i > 0)
        .ok_or_else(|| unknown("instance", name, names.skip(1), place))
}

fn unknown<'a>(
    kind: &str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
    place: Place,
) -> Wrong {
    let help = nearest(name, known.clone()).map_or_else(
        || {
            let some: Vec<&str> = known.take(8).collect();
            if some.is_empty() {
                format!("there is no {kind} at all here")
            } else {
                format!("there are {}", some.join(", "))
            }
        },
        |near| format!("did you mean {near}?"),
    );
    Wrong::new(place, format!("there is no {kind} named {name}"), help)
}

/// Assigns materials to elements.
fn sections(frames: &[Frame<'_>], mesh: &mut ImportedMesh) -> Result<(), Wrong> {
    for (at, frame) in frames.iter().enumerate() {
        for section in frame.scopes.iter().flat_map(|s| &s.sections) {
            let mut search = Search::new(frames, mesh, ELEMENTS);
            search.named(at, &section.set, section.place, 0)?;
            let elements = search.found;
            mesh.sections.push(Section {
                set: frame.full(&section.set),
                elements,
                material: section.material.clone(),
                place: section.place,
            });
        }
    }
    Ok(())
}
