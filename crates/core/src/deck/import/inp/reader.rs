//! Interprets the lines of an `.inp` by part, instance and assembly.

use std::sync::Arc;

use super::lines::{Keyword, Sink, unquoted};
use super::materials::Table;
use super::raw::{Element, Instance, Member, Node, Other, Raw, Scope, SolidSection};
use super::sets;
use crate::deck::import::numbers::{label, numbers, real};
use crate::deck::import::{MOST_ELEMENTS, MOST_NODES, Place, Wrong};
use crate::material::CrackBand;

/// Meaning of the data lines that follow.
#[derive(Debug, Default)]
pub(super) enum Now {
    /// Data that is not read.
    #[default]
    Skipped,
    /// Nodes; in cylindrical coordinates if `cylindrical`, members of the last set if `named`.
    Nodes { cylindrical: bool, named: bool },
    /// Elements of a type that is read.
    Elements(Begun),
    /// Elements of a type that is not read; with the number of nodes of each, if known.
    Others {
        kind: Arc<str>,
        nodes: Option<usize>,
    },
    /// Members of the last set.
    Set { of_nodes: bool, generated: bool },
    /// Members of the last surface.
    Surface,
    /// Placement of the last instance.
    Instance,
    /// A table of the last material.
    Material(Table),
}

/// An element of which lines may be missing.
#[derive(Debug)]
pub(super) struct Begun {
    /// Its label and the labels of its nodes so far.
    numbers: Vec<u64>,
    /// Place of its first line.
    place: Place,
    /// Whether it is a member of the last set.
    named: bool,
}

/// Scope to which nodes, elements and sets are added.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
enum Within {
    #[default]
    Assembly,
    Part(String),
    Instance,
}

/// Reader of the lines of an `.inp`.
#[derive(Debug, Default)]
pub(super) struct Reader {
    pub(super) raw: Raw,
    pub(super) now: Now,
    within: Within,
    in_step: bool,
    /// Whether the rest of the current table is for another rate or temperature.
    pub(super) table_ended: bool,
    /// Number of elements of the whole file so far.
    elements: usize,
    nodes: usize,
}

/// Keywords that define parts of the mesh but are not supported.
const REFUSED: [(&str, &str); 8] = [
    ("NGEN", "nodes"),
    ("NFILL", "nodes"),
    ("NCOPY", "nodes"),
    ("NMAP", "nodes"),
    ("SYSTEM", "nodes"),
    ("ELGEN", "elements"),
    ("ELCOPY", "elements"),
    ("PARAMETER", "numbers"),
];

/// Returns whether elements of this type are read as hex8: C3D8, C3D8R, C3D8I, C3D8RH, C3D8T ….
fn is_hexahedron(kind: &str) -> bool {
    let rest = kind.strip_prefix("C3D8");
    rest.is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_uppercase()))
}

impl Reader {
    /// Contents of the file, at its end.
    ///
    /// # Errors
    /// An incomplete element.
    pub(super) fn end(mut self) -> Result<Raw, Wrong> {
        self.close()?;
        Ok(self.raw)
    }

    /// The current scope.
    pub(super) fn scope(&mut self) -> &mut Scope {
        match (&self.within, self.raw.instances.last_mut()) {
            (Within::Instance, Some(instance)) => &mut instance.own,
            (Within::Part(name), _) => self.raw.parts.entry(name.clone()).or_default(),
            _ => &mut self.raw.scope,
        }
    }

    /// Checks that the last element is complete.
    fn close(&mut self) -> Result<(), Wrong> {
        let now = std::mem::take(&mut self.now);
        let Now::Elements(Begun { numbers, place, .. }) = now else {
            return Ok(());
        };
        match numbers.first() {
            Some(label) => Err(Wrong::new(
                place,
                format!(
                    "element {label} has {} nodes, not 8",
                    numbers.len().saturating_sub(1)
                ),
                "a line is its label and the labels of its eight nodes",
            )),
            None => Ok(()),
        }
    }

    fn node_keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
        let system = keyword.get("SYSTEM").unwrap_or("R").to_uppercase();
        if !["R", "C"].contains(&system.as_str()) {
            return Err(Wrong::new(
                keyword.place,
                format!("*NODE, SYSTEM={system}: coordinates of this kind are not read"),
                "write the nodes in rectangular (R) or cylindrical (C) coordinates",
            ));
        }
        if let Some(name) = keyword.get("NSET") {
            let set = sets::of_what_follows(name, keyword.place);
            self.scope().node_sets.push(set);
        }
        self.now = Now::Nodes {
            cylindrical: system == "C",
            named: keyword.has("NSET"),
        };
        Ok(())
    }

    fn element_keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
        let kind = keyword.required("TYPE")?.to_uppercase();
        if let Some(name) = keyword.get("ELSET") {
            let set = sets::of_what_follows(name, keyword.place);
            self.scope().element_sets.push(set);
        }
        self.now = if is_hexahedron(&kind) {
            self.raw.types.entry(kind).or_default();
            Now::Elements(Begun {
                numbers: Vec::new(),
                place: keyword.place,
                named: keyword.has("ELSET"),
            })
        } else {
            let nodes = nodes_of(&kind);
            let kind = kind.into();
            Now::Others { kind, nodes }
        };
        Ok(())
    }

    fn set_keyword(&mut self, keyword: &Keyword, of_nodes: bool) -> Result<(), Wrong> {
        let set = sets::set(keyword, of_nodes)?;
        self.scope().sets(of_nodes).push(set);
        let generated = keyword.has("GENERATE");
        self.now = Now::Set {
            of_nodes,
            generated,
        };
        Ok(())
    }

    fn part_keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
        let part = keyword.required("NAME")?.to_uppercase();
        if self.raw.parts.contains_key(&part) {
            return Err(there_are_two("parts", &part, keyword.place));
        }
        self.raw.parts.insert(part.clone(), Scope::default());
        self.within = Within::Part(part);
        Ok(())
    }

    fn instance_keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
        self.within = Within::Instance;
        self.raw.instances.push(Instance {
            name: keyword.required("NAME")?,
            part: keyword.required("PART")?,
            moves: Vec::new(),
            own: Scope::default(),
            place: keyword.place,
        });
        self.now = Now::Instance;
        Ok(())
    }

    fn node(
        &mut self,
        fields: &[&str],
        place: Place,
        cylindrical: bool,
        named: bool,
    ) -> Result<(), Wrong> {
        let x = |i: usize| match fields.get(i).copied().unwrap_or("") {
            "" => Some(0.0),
            text => real(text),
        };
        let (Some(label), Some(a), Some(b), Some(z)) =
            (fields.first().and_then(|f| label(f)), x(1), x(2), x(3))
        else {
            return Err(Wrong::new(
                place,
                format!("`{}` is no node", fields.join(", ")),
                "a line is a label and x, y, z",
            ));
        };
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            return Err(too_many(place, "nodes"));
        }
        let x = if cylindrical {
            let (sin, cos) = b.to_radians().sin_cos();
            [a * cos, a * sin, z]
        } else {
            [a, b, z]
        };
        let scope = self.scope();
        scope.nodes.push(Node { label, x, place });
        if named {
            sets::follow(&mut scope.node_sets, label);
        }
        Ok(())
    }

    /// Reads the numbers of a line; an element may continue over several lines.
    fn element(&mut self, fields: &[&str], place: Place, mut begun: Begun) -> Result<(), Wrong> {
        if begun.numbers.is_empty() {
            begun.place = place;
        }
        for field in fields.iter().filter(|f| !f.is_empty()) {
            let Some(number) = label(field) else {
                return Err(Wrong::new(
                    place,
                    format!("`{field}` is no label of an element or a node"),
                    "a line is its label and the labels of its eight nodes",
                ));
            };
            begun.numbers.push(number);
        }
        if let [label, nodes @ ..] = &begun.numbers[..]
            && nodes.len() >= 8
        {
            // Some programs write more than eight labels: nodes of incompatible modes, or of a quadratic element.
            if nodes.len() > 8 {
                self.raw.long.get_or_insert((0, begun.place)).0 += 1;
            }
            let Ok(nodes) = <[u64; 8]>::try_from(&nodes[..8]) else {
                return Ok(()); // never: the slice has eight labels
            };
            let label = *label;
            self.count_element(place)?;
            let scope = self.scope();
            scope.elements.push(Element {
                label,
                nodes,
                place: begun.place,
            });
            if begun.named {
                sets::follow(&mut scope.element_sets, label);
            }
            begun.numbers.clear();
        }
        self.now = Now::Elements(begun);
        Ok(())
    }

    fn count_element(&mut self, place: Place) -> Result<(), Wrong> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(too_many(place, "elements"));
        }
        Ok(())
    }

    /// Reads a line of an element that is left out. Elements with more nodes than fit on a line continue over
    /// several.
    fn other(&mut self, fields: &[&str], place: Place, kind: &Arc<str>, nodes: Option<usize>) {
        let mut labels = fields.iter().filter_map(|f| label(f));
        let others = &mut self.scope().others;
        if let (Some(last), Some(wanted)) = (others.last_mut(), nodes)
            && last.kind == *kind
            && last.nodes.len() < wanted
        {
            last.nodes.extend(labels);
            return;
        }
        if let Some(label) = labels.next() {
            others.push(Other {
                kind: Arc::clone(kind),
                label,
                nodes: labels.collect(),
                place,
            });
        }
    }

    fn moved(&mut self, fields: &[&str], place: Place) -> Result<(), Wrong> {
        let fits = |numbers: &Vec<f64>| [1, 2, 3, 7].contains(&numbers.len());
        let numbers = numbers(fields, 0.0).filter(fits);
        let (Some(numbers), Some(instance)) = (numbers, self.raw.instances.last_mut()) else {
            return Err(Wrong::new(
                place,
                format!("`{}` places no instance", fields.join(", ")),
                "first x, y, z of a translation, then two points of an axis and an angle in degrees",
            ));
        };
        instance.moves.push(numbers);
        Ok(())
    }
}

impl Sink for Reader {
    fn keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
        self.close()?;
        self.table_ended = false;
        if self.in_step {
            self.in_step = keyword.name != "END STEP";
            return Ok(());
        }
        let name = keyword.name.as_str();
        if let Some((_, what)) = REFUSED.iter().find(|(refused, _)| *refused == name) {
            return Err(Wrong::new(
                keyword.place,
                format!("*{name} is not read, and the {what} depend on it"),
                "let Abaqus write the model with every node and element (Abaqus/CAE does)",
            ));
        }
        match name {
            "NODE" => self.node_keyword(keyword)?,
            "ELEMENT" => self.element_keyword(keyword)?,
            "NSET" | "ELSET" => self.set_keyword(keyword, name == "NSET")?,
            "SURFACE" => {
                let surface = sets::surface(keyword)?;
                if let Some(surface) = surface {
                    self.scope().surfaces.push(surface);
                    self.now = Now::Surface;
                } else {
                    self.skip(keyword);
                }
            }
            "SOLID SECTION" => {
                let section = SolidSection {
                    set: keyword.required("ELSET")?,
                    material: keyword.required("MATERIAL")?,
                    place: keyword.place,
                };
                self.scope().sections.push(section);
            }
            "PART" => self.part_keyword(keyword)?,
            "INSTANCE" => self.instance_keyword(keyword)?,
            "END PART" | "END INSTANCE" | "ASSEMBLY" | "END ASSEMBLY" => {
                self.within = Within::Assembly;
            }
            "STEP" => {
                self.in_step = true;
                self.skip(keyword);
            }
            "HEADING" | "PREPRINT" => {}
            _ => match self.material_keyword(keyword)? {
                Some(table) => self.now = Now::Material(table),
                None => self.skip(keyword),
            },
        }
        Ok(())
    }

    fn remark(&mut self, key: &str, value: &str) {
        if !self.in_step {
            self.remarked(key, value);
        }
    }

    fn data(&mut self, fields: &[&str], place: Place) -> Result<(), Wrong> {
        if self.in_step {
            return Ok(());
        }
        match &mut self.now {
            Now::Skipped => Ok(()),
            Now::Nodes { cylindrical, named } => {
                let (cylindrical, named) = (*cylindrical, *named);
                self.node(fields, place, cylindrical, named)
            }
            Now::Elements(Begun {
                numbers,
                place: begun,
                named,
            }) => {
                let begun = Begun {
                    numbers: std::mem::take(numbers),
                    place: *begun,
                    named: *named,
                };
                self.element(fields, place, begun)
            }
            Now::Others { kind, nodes } => {
                let (kind, nodes) = (Arc::clone(kind), *nodes);
                self.count_element(place)?;
                self.other(fields, place, &kind, nodes);
                Ok(())
            }
            Now::Set {
                of_nodes,
                generated,
            } => {
                let (of_nodes, generated) = (*of_nodes, *generated);
                let last = self.scope().sets(of_nodes).last_mut();
                last.map_or(Ok(()), |set| sets::members(set, fields, generated, place))
            }
            Now::Surface => {
                let last = self.scope().surfaces.last_mut();
                if let Some(surface) = last {
                    sets::sides(surface, fields, place);
                }
                Ok(())
            }
            Now::Instance => self.moved(fields, place),
            Now::Material(table) => {
                let table = *table;
                self.material_row(table, fields, place);
                Ok(())
            }
        }
    }
}

impl Reader {
    /// Reads material data that wythe writes in addition to Abaqus keywords.
    fn remarked(&mut self, key: &str, value: &str) {
        let Some(material) = self.raw.materials.last_mut() else {
            return;
        };
        match (key, real(value)) {
            ("reference_length", Some(length)) if length > 0.0 => {
                material.reference_length = Some(length);
            }
            ("crack_band", None) => {
                material.crack_band = match unquoted(value) {
                    "projected" => Some(CrackBand::Projected),
                    "volume" => Some(CrackBand::Volume),
                    _ => None,
                };
            }
            _ => {}
        }
    }

    /// Records a keyword that is not read.
    pub(super) fn skip(&mut self, keyword: &Keyword) {
        let skipped = &mut self.raw.skipped;
        skipped.entry(keyword.name.clone()).or_insert(keyword.place);
    }
}

pub(super) fn there_are_two(what: &str, name: &str, place: Place) -> Wrong {
    Wrong::new(
        place,
        format!("there are two {what} named {name}"),
        "give each a name of its own",
    )
}

fn too_many(place: Place, what: &str) -> Wrong {
    Wrong::new(
        place,
        format!("there are too many {what}"),
        "at most 1e7 elements: coarsen the mesh, or import a part of it",
    )
}

/// Advice about elements of a type that is not read.
pub(super) fn instead_of(kind: &str) -> &'static str {
    if kind.starts_with("COH") {
        "interfaces have no thickness: let the faces beside cohesive elements meet by [[contacts]]"
    } else if kind.starts_with("C3D") {
        "mesh solids with hexahedra of first order: C3D8"
    } else {
        "only solids are read"
    }
}

/// Number of nodes of a solid by its type, such as C3D20R or DC3D10; none for other types, which fit on a line.
fn nodes_of(kind: &str) -> Option<usize> {
    let (_, rest) = kind.split_once("3D")?;
    let digits = rest.trim_end_matches(|c: char| !c.is_ascii_digit());
    digits.parse().ok().filter(|&nodes: &usize| nodes > 8)
}

/// Parses a member of a set: a label or a name.
pub(super) fn member(field: &str) -> Member {
    let name = unquoted(field);
    label(name).map_or_else(|| Member::Name(name.to_owned()), Member::Label)
}
