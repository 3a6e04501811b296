//! An imported mesh in a scene: its placement, materials, bodies and their faces.

use super::body::{Body, BodyFace};
use super::import::{self, ImportedMesh, Lengths, SIDES, Units, root};
use super::keys::nearest;
use super::quantity::Quantity;
use super::schema::{Deck, DeckImport, Material, validate};
use crate::element::hexahedron::{area_vector, dot, norm};
use crate::error::{ErrorKind, Errors, ModelError, Warning};
use crate::model::mesh::Mesh;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

/// Boundary facets with a common edge belong to one face if the product of their unit normals is at least this: an
/// angle of 30°.
const SMOOTH: f64 = 0.866;

/// A body and one of its faces, or the whole body.
pub(super) type Part = (usize, Option<usize>);

/// A mesh that a deck imports.
pub(super) struct Imported {
    /// Name in the deck.
    pub(super) name: String,
    mesh: ImportedMesh,
    bodies: import::Bodies,
    /// Materials that it uses, by name; with their tables if they come from the file.
    pub(super) materials: Vec<(String, Option<Material>)>,
    /// Index into `materials`. `[element]`
    material: Vec<u16>,
    /// Faces: those of the boundary, then the sets that the deck mentions. `[body][face]`
    pub(super) faces: Vec<Vec<Face>>,
    /// Number of faces that make up the boundary of each body. `[body]`
    skin: Vec<usize>,
    /// Bodies and faces of each set that the deck mentions, by its name without that of the import: all of them,
    /// and those with facets. `[name][faces only]`
    pub(super) sets: HashMap<String, [Vec<Part>; 2]>,
    /// Warnings for the author.
    pub(super) warnings: Vec<Warning>,
}

/// Sides of elements, and nodes if these are not the nodes of the sides.
pub(super) struct Face {
    name: String,
    sides: Vec<(u32, u8)>,
    nodes: Option<Vec<u32>>,
}

impl Imported {
    /// Reads import `index` of a deck.
    ///
    /// # Errors
    /// A file that is no valid mesh, unknown sets and materials, elements without a material.
    pub(super) fn read(deck: &Deck, index: usize) -> Result<Self, ModelError> {
        let said = &deck.imports[index];
        let path = format!("imports.{index}");
        let file = deck.folder().join(&said.file);
        let units = Units::parse(&said.units).unwrap_or_default();
        let wrong = |error: import::ImportError| {
            deck.error(&format!("{path}.file"), error.to_string(), &error.help)
                .of_kind(ErrorKind::Mesh)
        };
        let mut mesh = ImportedMesh::load(&file, &units).map_err(wrong)?;
        mesh.check().map_err(wrong)?;
        let warnings = mesh
            .notes
            .iter()
            .map(|note| deck.warning(&format!("{path}.file"), format!("{}: {note}", said.file)))
            .collect();
        // A material of the deck replaces one of the same name in the file.
        let mut assignment = Assignment {
            deck,
            said,
            path: &path,
            mesh: &mesh,
            materials: Vec::new(),
            of: vec![Assignment::NONE; mesh.elements.len()],
            warnings,
        };
        assignment.of_deck()?;
        assignment.of_file()?;
        assignment.require_all()?;
        let Assignment {
            materials,
            of,
            warnings,
            ..
        } = assignment;
        for x in &mut mesh.nodes {
            *x = laid(said, *x);
        }
        let mut imported = Self {
            name: said.name.clone(),
            bodies: mesh.bodies(),
            mesh,
            materials,
            material: of,
            faces: Vec::new(),
            skin: Vec::new(),
            sets: HashMap::new(),
            warnings,
        };
        // The mesh was checked: no side belongs to three elements.
        let outside = imported.mesh.exterior().unwrap_or_default();
        imported.lay_skin(&outside);
        for mention in deck.mentions() {
            if let Some((name, set)) = mention.split_once('.')
                && name == said.name
                && !imported.sets.contains_key(set)
            {
                imported.lay_set(set, &outside);
            }
        }
        Ok(imported)
    }

    /// Names of bodies, sets and surfaces.
    pub(super) fn names(&self) -> Vec<String> {
        let own = self.mesh.names().into_iter().map(str::to_owned);
        own.chain(self.bodies.names.iter().cloned()).collect()
    }

    fn body_of(&self, element: u32) -> usize {
        self.bodies.of_element[element as usize] as usize
    }

    /// Divides the boundary of each body into faces along its sharp edges.
    fn lay_skin(&mut self, outside: &[(u32, u8)]) {
        self.faces = self.bodies.names.iter().map(|_| Vec::new()).collect();
        let normals: Vec<[f64; 3]> = outside
            .iter()
            .map(|side| {
                let x = self.mesh.facet(*side).map(|n| self.mesh.nodes[n as usize]);
                let area = area_vector(&x);
                let size = norm(area);
                area.map(|a| a / size)
            })
            .collect();
        let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(4 * outside.len());
        for (f, side) in outside.iter().enumerate() {
            let nodes = self.mesh.facet(*side);
            for i in 0..4 {
                let (a, b) = (nodes[i], nodes[(i + 1) % 4]);
                edges.push(([a.min(b), a.max(b)], f as u32));
            }
        }
        edges.sort_unstable();
        let mut parent: Vec<u32> = (0..outside.len() as u32).collect();
        for same in edges.chunk_by(|a, b| a.0 == b.0) {
            for pair in same.windows(2) {
                let (a, b) = (pair[0].1, pair[1].1);
                if dot(normals[a as usize], normals[b as usize]) >= SMOOTH {
                    let (a, b) = (root(&mut parent, a), root(&mut parent, b));
                    parent[a.max(b) as usize] = a.min(b);
                }
            }
        }
        let mut face_of: HashMap<u32, usize> = HashMap::new();
        for (f, side) in outside.iter().enumerate() {
            let body = self.body_of(side.0);
            let faces = &mut self.faces[body];
            let root = root(&mut parent, f as u32);
            let face = *face_of.entry(root).or_insert_with(|| {
                faces.push(Face {
                    name: format!("side-{}", faces.len()),
                    sides: Vec::new(),
                    nodes: None,
                });
                faces.len() - 1
            });
            faces[face].sides.push(*side);
        }
        self.skin = self.faces.iter().map(Vec::len).collect();
    }

    /// Makes a face of each body that the set `set` touches, if the file has it.
    fn lay_set(&mut self, set: &str, outside: &[(u32, u8)]) {
        if let Some(body) = self.bodies.names.iter().position(|name| name == set) {
            let whole = vec![(body, None)];
            self.sets.insert(set.to_owned(), [whole, Vec::new()]);
            if self.mesh.facets_of(set, &[]).is_none() {
                return;
            }
        }
        let (Some(nodes), Some(sides)) =
            (self.mesh.nodes_of(set), self.mesh.facets_of(set, outside))
        else {
            return;
        };
        let mut body_of_node = vec![0; self.mesh.nodes.len()];
        for (e, of) in self.mesh.elements.iter().enumerate() {
            for n in of {
                body_of_node[*n as usize] = self.bodies.of_element[e] as usize;
            }
        }
        // A set may cover several bodies.
        let mut parts: BTreeMap<usize, Face> = BTreeMap::new();
        let empty = || Face {
            name: set.to_owned(),
            sides: Vec::new(),
            nodes: Some(Vec::new()),
        };
        for n in nodes {
            let part = parts.entry(body_of_node[n as usize]).or_insert_with(empty);
            part.nodes.get_or_insert_default().push(n);
        }
        for side in sides {
            let body = self.body_of(side.0);
            parts.entry(body).or_insert_with(empty).sides.push(side);
        }
        let places = self.sets.entry(set.to_owned()).or_default();
        let whole = !places[0].is_empty();
        for (body, face) in parts {
            let at = (body, Some(self.faces[body].len()));
            if !whole && face.nodes.as_ref().is_some_and(|n| !n.is_empty()) {
                places[0].push(at);
            }
            if !face.sides.is_empty() {
                places[1].push(at);
            }
            self.faces[body].push(face);
        }
    }

    /// Appends the bodies to the mesh, one after the other with all nodes and elements. `material`: indices of
    /// `materials` in the model.
    pub(super) fn append(&self, mesh: &mut Mesh, material: &[u16]) -> Vec<Body> {
        let first_body = mesh.unit.last().map_or(0, |u| u + 1);
        let count = self.bodies.names.len();
        let mut of_body: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (e, body) in self.bodies.of_element.iter().enumerate() {
            of_body[*body as usize].push(e as u32);
        }
        let mut node_to = vec![u32::MAX; self.mesh.nodes.len()];
        let mut element_to = vec![usize::MAX; self.mesh.elements.len()];
        let mut bodies = Vec::with_capacity(count);
        for (b, elements) in of_body.iter().enumerate() {
            let mut nodes: Vec<u32> = elements
                .iter()
                .flat_map(|e| self.mesh.elements[*e as usize])
                .collect();
            nodes.sort_unstable();
            nodes.dedup();
            let first_node = mesh.nodes.len() as u32;
            for n in nodes {
                node_to[n as usize] = mesh.nodes.len() as u32;
                mesh.nodes.push(self.mesh.nodes[n as usize]);
            }
            let number = first_body + b as u32;
            for e in elements.iter().map(|e| *e as usize) {
                element_to[e] = mesh.elements.len();
                let nodes = self.mesh.elements[e].map(|n| node_to[n as usize]);
                mesh.elements.push(nodes);
                mesh.material.push(material[usize::from(self.material[e])]);
                mesh.unit.push(number);
                mesh.course.push(0);
            }
            let faces = self.faces[b].iter().map(|face| {
                let facet = |side: &(u32, u8)| {
                    let e = element_to[side.0 as usize];
                    (e, SIDES[usize::from(side.1)].map(|n| mesh.elements[e][n]))
                };
                let facets: Vec<_> = face.sides.iter().map(facet).collect();
                let outline = |f: &(usize, [u32; 4])| f.1.map(|n| mesh.nodes[n as usize]);
                let nodes = face.nodes.as_ref();
                BodyFace {
                    name: Cow::Owned(face.name.clone()),
                    outlines: facets.iter().map(outline).collect(),
                    facets,
                    nodes: nodes.map(|n| n.iter().map(|n| node_to[*n as usize]).collect()),
                }
            });
            bodies.push(Body {
                name: format!("{}.{}", self.name, self.bodies.names[b]),
                number,
                faces: faces.collect(),
                skin: self.skin[b],
                nodes: first_node..mesh.nodes.len() as u32,
                curved: true,
            });
        }
        bodies
    }
}

/// Position of a point of an import [mm]: turned about the origin, then moved.
fn laid(import: &DeckImport, x: [f64; 3]) -> [f64; 3] {
    let x = import.rotate.map_or(x, |rotation| rotation.turn(x));
    let at = import.at.map(Quantity::get);
    [0, 1, 2].map(|d| at[d] + x[d])
}

/// Materials of an import, as they are given to its elements.
struct Assignment<'a> {
    deck: &'a Deck,
    said: &'a DeckImport,
    path: &'a str,
    mesh: &'a ImportedMesh,
    /// Names of the materials, with those that the file defines.
    materials: Vec<(String, Option<Material>)>,
    /// Index into `materials`. `[element]`
    of: Vec<u16>,
    warnings: Vec<Warning>,
}

impl Assignment<'_> {
    /// Material of elements that have none yet.
    const NONE: u16 = u16::MAX;

    /// Gives a material to elements.
    ///
    /// # Errors
    /// An element that has another material.
    fn give(&mut self, material: u16, elements: Vec<u32>) -> Result<(), usize> {
        for e in elements.into_iter().map(|e| e as usize) {
            if self.of[e] != Self::NONE && self.of[e] != material {
                return Err(e);
            }
            self.of[e] = material;
        }
        Ok(())
    }

    /// Gives the materials of the deck to its sets.
    fn of_deck(&mut self) -> Result<(), ModelError> {
        let (deck, said, mesh) = (self.deck, self.said, self.mesh);
        for (set, name) in &said.materials {
            let key = format!("{}.materials.{set}", self.path);
            let elements = mesh.elements_of(set).ok_or_else(|| {
                let known: Vec<&str> = mesh.names_of_elements();
                let help = nearest(set, known.iter().copied()).map_or_else(
                    || format!("the file has {}", known.join(", ")),
                    |near| format!("did you mean `{near}`?"),
                );
                let message = format!("{} has no set of elements named `{set}`", said.file);
                deck.error(&key, message, &help).of_kind(ErrorKind::Mesh)
            })?;
            let found = self.materials.iter().position(|(n, _)| n == name);
            let material = found.unwrap_or_else(|| {
                self.materials.push((name.clone(), None));
                self.materials.len() - 1
            });
            self.give(material as u16, elements).map_err(|e| {
                let message = format!("{} is in another set with a material, too", mesh.name_of(e));
                deck.error(&key, message, "let the sets not overlap")
                    .of_kind(ErrorKind::Mesh)
            })?;
        }
        Ok(())
    }

    /// Gives the materials of the sections of the file to elements without one of the deck.
    fn of_file(&mut self) -> Result<(), ModelError> {
        let (deck, mesh) = (self.deck, self.mesh);
        let of_deck = self.materials.len();
        let mut index = HashMap::new();
        for section in &mesh.sections {
            let left = |e: &&u32| {
                let of = self.of[**e as usize];
                of == Self::NONE || usize::from(of) >= of_deck
            };
            let elements: Vec<u32> = section.elements.iter().filter(left).copied().collect();
            if elements.is_empty() {
                continue;
            }
            let key = section.material.to_uppercase();
            let material = if let Some(material) = index.get(&key) {
                *material
            } else {
                let brought = self.brought(&section.material)?;
                self.materials.push(brought);
                let material = (self.materials.len() - 1) as u16;
                index.insert(key, material);
                material
            };
            self.give(material, elements).map_err(|e| {
                let message = format!("{} is in two solid sections", mesh.name_of(e));
                deck.error(
                    &self.file(),
                    message,
                    "let the sets of sections not overlap",
                )
                .of_kind(ErrorKind::Mesh)
            })?;
        }
        Ok(())
    }

    fn require_all(&self) -> Result<(), ModelError> {
        let Some(e) = self.of.iter().position(|m| *m == Self::NONE) else {
            return Ok(());
        };
        let error = self.mesh.wrong_element(
            e,
            "has no material: no set of `materials` and no section of the file has it",
            "",
        );
        let known = self.mesh.names_of_elements().join(", ");
        let example = crate::deck::keys::example_at("imports.materials");
        let help = format!("{example}; the file has the sets {known}");
        Err(self
            .deck
            .error(&self.file(), error.to_string(), &help)
            .of_kind(ErrorKind::Mesh))
    }

    /// Path of the file in the deck.
    fn file(&self) -> String {
        format!("{}.file", self.path)
    }

    /// A material named in the file: that of the deck if it has one of this name, else that of the file.
    fn brought(&mut self, name: &str) -> Result<(String, Option<Material>), ModelError> {
        let (deck, said, file) = (self.deck, self.said, self.file());
        if let Some(known) = import::find(name, deck.materials.keys().map(String::as_str)) {
            return Ok((known.to_owned(), None));
        }
        let of_name = |m: &&import::ImportedMaterial| m.name.eq_ignore_ascii_case(name);
        let Some(material) = self.mesh.materials.iter().find(of_name) else {
            return Err(deck.error(
                &file,
                format!(
                    "{} has a section of the material {name}, but no such material",
                    said.file
                ),
                "write the material in the file, or in the deck, or say `materials` for the set",
            ).of_kind(ErrorKind::Mesh));
        };
        let lengths = self.mesh.lengths_of(name);
        let (made, notes) = material.in_a_deck(lengths).map_err(|why| {
            let line = material.place.line;
            let message = format!("{} line {line}: material {name}: {why}", said.file);
            let help = "write the material in the deck, where it stands in place of this one";
            deck.error(&file, message, help).of_kind(ErrorKind::Mesh)
        })?;
        let warning = |note| deck.warning(&file, format!("{}: material {name}: {note}", said.file));
        self.warnings.extend(notes.into_iter().map(warning));
        let mut errors = Errors::default();
        let path = format!("{}.materials.{name}", self.path);
        for error in validate::imported_material(deck, &path, &made) {
            errors.push(error);
        }
        errors.end((material.name.clone(), Some(made)))
    }
}

/// Equivalent lengths V^(1/3) of elements [mm].
pub(super) fn lengths(
    mesh: &ImportedMesh,
    elements: impl Iterator<Item = usize>,
) -> Option<Lengths> {
    let mut one = Mesh {
        nodes: Vec::new(),
        elements: vec![[0, 1, 2, 3, 4, 5, 6, 7]],
        ..Mesh::default()
    };
    let mut lengths: Vec<f64> = elements
        .map(|e| {
            one.nodes = mesh.elements[e].map(|n| mesh.nodes[n as usize]).into();
            one.volume(0).cbrt()
        })
        .collect();
    lengths.sort_by(f64::total_cmp);
    Some(Lengths {
        least: *lengths.first()?,
        median: lengths[lengths.len() / 2],
        most: *lengths.last()?,
    })
}
