//! Blocks from a file of closed shells: their names, division into elements, and faces.

use super::amount;
use super::body::{Body, BodyFace};
use super::import::Units;
use super::quantity::Quantity;
use super::schema::{Deck, DeckBlock};
use super::shells::hexes::{Division, Hexes, sides};
use super::shells::polyhedron::WARPED;
use super::shells::{Polyhedron, Reading, Shell, ShellError, Soup, split};
use crate::element::hexahedron::{Corners, range};
use crate::error::{ErrorKind, ModelError, Warning};
use crate::model::mesh::Mesh;
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

/// Smallest and largest plausible size of a stone, the cube root of its volume [mm].
const PLAUSIBLE: [f64; 2] = [5.0, 10_000.0];

/// Longest name of a stone that is taken from a file [characters].
const LONGEST_NAME: usize = 60;

/// Blocks of one file.
pub(super) struct FileStones {
    /// Blocks in the order of their names.
    pub(super) all: Vec<Stone>,
    /// Names of several blocks: those of parts of the file.
    pub(super) groups: Vec<(String, Range<usize>)>,
    /// Warnings for the author.
    pub(super) warnings: Vec<Warning>,
}

/// A block of a file.
pub(super) struct Stone {
    /// Name in the deck.
    pub(super) name: String,
    division: Division,
    /// Faces nearest to each of the six sides; none if it is a hexahedron, whose faces are these sides.
    pub(super) sides: Option<[Vec<usize>; 6]>,
}

impl FileStones {
    /// Reads the file of block `index`, if it has one.
    ///
    /// # Errors
    /// A file that cannot be read, shells that are open, inverted or not convex, too many blocks or elements, elements
    /// without a positive volume: file, line, name and advice.
    pub(super) fn read(deck: &Deck, index: usize) -> Result<Option<Self>, ModelError> {
        let block = &deck.blocks[index];
        let Some(file) = &block.file else {
            return Ok(None);
        };
        let source = Source {
            deck,
            block,
            index,
            file,
        };
        source.stones().map(Some)
    }

    /// Longest side of a box around a block of a file, for all files of rigid blocks [mm].
    pub(super) fn longest_side(all: &[Option<Self>], deck: &Deck) -> f64 {
        let of_rigid = all
            .iter()
            .zip(&deck.blocks)
            .filter(|(_, block)| block.rigid);
        let stones = of_rigid.filter_map(|(stones, _)| stones.as_ref());
        let sides = stones.flat_map(|stones| stones.all.iter().flat_map(Stone::extents));
        sides.fold(0.0, f64::max)
    }
}

/// A file that a block of the deck names.
struct Source<'a> {
    deck: &'a Deck,
    block: &'a DeckBlock,
    index: usize,
    file: &'a str,
}

impl Source<'_> {
    fn key(&self, name: &str) -> String {
        format!("blocks.{}.{name}", self.index)
    }

    fn wrong(&self, error: &ShellError) -> ModelError {
        let message = format!("{}{error}", self.file);
        self.deck
            .error(&self.key("file"), message, &error.help)
            .of_kind(ErrorKind::Mesh)
    }

    fn warning(&self, note: &str) -> Warning {
        self.deck
            .warning(&self.key("file"), format!("{}: {note}", self.file))
    }

    fn stones(&self) -> Result<FileStones, ModelError> {
        let units = self.block.units.as_deref().map(Units::parse);
        let reading = Reading {
            unit: units.and_then(Result::ok).unwrap_or_default().length,
            thickness: self.block.thickness.map(Quantity::get),
        };
        let wrong = |error: ShellError| self.wrong(&error);
        let soup = Soup::load(&self.deck.folder().join(self.file), reading).map_err(wrong)?;
        let mut notes = soup.notes.clone();
        let mut shells = split(&soup, &mut notes).map_err(wrong)?;
        drop(soup);
        self.require_few(shells.len() as f64, 0.0)?;
        let (names, groups) = names(&self.block.name, &mut shells);
        let polyhedra = self.polyhedra(&shells, &names, &mut notes)?;
        notes.extend(implausible(&polyhedra, reading.unit));
        notes.extend(warped(&polyhedra, &names));
        let mut all = Vec::with_capacity(names.len());
        let mut elements = 0.0;
        for (name, of) in names.into_iter().zip(&polyhedra) {
            let stone = self.stone(name, of)?;
            elements += stone.elements(self.block.mesh);
            self.require_few(all.len() as f64, elements)?;
            all.push(stone);
        }
        Ok(FileStones {
            all,
            groups,
            warnings: notes.iter().map(|note| self.warning(note)).collect(),
        })
    }

    /// Convex polyhedra of the shells.
    fn polyhedra(
        &self,
        shells: &[Shell],
        names: &[String],
        notes: &mut Vec<String>,
    ) -> Result<Vec<Polyhedron>, ModelError> {
        let mut polyhedra = Vec::with_capacity(shells.len());
        let (mut more, mut hulls) = (0.0, Vec::new());
        for (shell, name) in shells.iter().zip(names) {
            let (of, added) =
                Polyhedron::of(shell, self.block.not_convex).map_err(|error| self.wrong(&error))?;
            if added > 0.0 {
                more += added;
                hulls.push(name.as_str());
            }
            polyhedra.push(of);
        }
        if !hulls.is_empty() {
            let volume: f64 = polyhedra.iter().map(Polyhedron::volume).sum();
            notes.push(format!(
                "{} of {} stones are not convex: their hulls add {more:.4e} mm^3, {:.3} percent of the volume of all \
                 ({})",
                hulls.len(),
                names.len(),
                100.0 * more / volume,
                some(&hulls)
            ));
        }
        Ok(polyhedra)
    }

    fn require_few(&self, stones: f64, elements: f64) -> Result<(), ModelError> {
        if stones <= amount::MOST_BODIES && elements <= amount::MOST_ELEMENTS {
            return Ok(());
        }
        let (key, message) = if stones > amount::MOST_BODIES {
            (
                "file",
                format!("{}: {stones} stones are too many", self.file),
            )
        } else {
            (
                "mesh",
                format!(
                    "{}: the stones have more than {elements} elements",
                    self.file
                ),
            )
        };
        let help =
            "at most 5e4 blocks and 5e5 elements: coarsen `mesh`, or write stones with fewer faces";
        Err(self
            .deck
            .error(&self.key(key), message, help)
            .of_kind(ErrorKind::TooMany))
    }

    /// Divides a stone into elements.
    fn stone(&self, name: String, of: &Polyhedron) -> Result<Stone, ModelError> {
        let [x, y, z] = self.block.mesh;
        let most = of.most_hexes() as f64 * [x, y, z].map(f64::from).iter().product::<f64>();
        if most > 100.0 * amount::MOST_ELEMENTS {
            self.require_few(0.0, most)?;
        }
        let folded = || {
            let message = format!(
                "{}: `{name}` has an element that is flat or folded",
                self.file
            );
            let help = "write the stone without slivers: faces should be plane, and edges not far shorter than others";
            self.deck
                .error(&self.key("file"), message, help)
                .of_kind(ErrorKind::Mesh)
        };
        match of.divided() {
            Division::One(corners) => Ok(Stone {
                name,
                division: Division::One(corners),
                sides: None,
            }),
            Division::Several(hexes) => {
                if hexes.first_folded().is_some() {
                    return Err(folded());
                }
                if x != y || y != z {
                    let message = format!(
                        "`{name}` is no hexahedron, so that its elements have no directions"
                    );
                    let help = "three equal numbers: mesh = [2, 2, 2]";
                    let error = self.deck.error(&self.key("mesh"), message, help);
                    return Err(error.of_kind(ErrorKind::Value));
                }
                Ok(Stone {
                    name,
                    sides: Some(sides(of)),
                    division: Division::Several(hexes),
                })
            }
        }
    }
}

/// Names of the blocks of `block`, and of groups of them; shells of one part of the file are put side by side.
///
/// A part with a name and one shell is `BLOCK-PART`; with several shells these are `BLOCK-PART-0`, … and `BLOCK-PART`
/// means all of them. Shells without a name are `BLOCK-0`, ….
fn names(block: &str, shells: &mut [Shell]) -> (Vec<String>, Vec<(String, Range<usize>)>) {
    let mut first: HashMap<Option<String>, usize> = HashMap::new();
    for (i, shell) in shells.iter_mut().enumerate() {
        shell.part = shell.part.take().as_deref().and_then(plain);
        first.entry(shell.part.clone()).or_insert(i);
    }
    shells.sort_by_key(|shell| first[&shell.part]);
    let (mut names, mut groups) = (Vec::with_capacity(shells.len()), Vec::new());
    for same in shells.chunk_by(|a, b| a.part == b.part) {
        let begin = names.len();
        match &same[0].part {
            None => names.extend((0..same.len()).map(|i| format!("{block}-{i}"))),
            Some(part) if same.len() == 1 => names.push(format!("{block}-{part}")),
            Some(part) => {
                names.extend((0..same.len()).map(|i| format!("{block}-{part}-{i}")));
                groups.push((format!("{block}-{part}"), begin..names.len()));
            }
        }
    }
    (names, groups)
}

/// A name of a file as a part of a name in a deck: letters, digits, - and _ remain.
fn plain(name: &str) -> Option<String> {
    let letter = |c: char| {
        if c.is_alphanumeric() || c == '-' || c == '_' {
            c
        } else {
            '_'
        }
    };
    let name: String = name.trim().chars().take(LONGEST_NAME).map(letter).collect();
    (!name.is_empty()).then_some(name)
}

/// Up to five names.
fn some(names: &[&str]) -> String {
    let more = if names.len() > 5 { ", ..." } else { "" };
    format!("{}{more}", names[..names.len().min(5)].join(", "))
}

/// Note on stones whose size is that of no masonry: a wrong unit.
fn implausible(polyhedra: &[Polyhedron], unit: f64) -> Option<String> {
    let mut sizes: Vec<f64> = polyhedra.iter().map(|of| of.volume().cbrt()).collect();
    sizes.sort_by(f64::total_cmp);
    let median = *sizes.get(sizes.len() / 2)?;
    let [low, high] = PLAUSIBLE;
    if (low..=high).contains(&median) {
        return None;
    }
    let known = [("mm", 1.0), ("cm", 10.0), ("m", 1e3)];
    let fits =
        |(_, length): &&(&str, f64)| (10.0 * low..=0.1 * high).contains(&(median * length / unit));
    let meant = known.iter().rev().find(fits);
    let meant = meant.map_or(String::new(), |(name, _)| {
        format!("; if the file is in {name}: units = \"{name}\"")
    });
    Some(format!(
        "the size of its stones (cube root of the volume) is {median:.4} mm at the median{meant}"
    ))
}

/// Note on faces that are not plane.
fn warped(polyhedra: &[Polyhedron], names: &[String]) -> Option<String> {
    let warps = polyhedra.iter().map(Polyhedron::warp).zip(names);
    let warped: Vec<(f64, &String)> = warps.filter(|(warp, _)| *warp > WARPED).collect();
    let (most, name) = warped.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "{} of {} stones have faces that are not plane: most in `{name}`, a corner {most:.3} of the stone's size off; \
         they may touch their neighbours at some places only",
        warped.len(),
        polyhedra.len()
    ))
}

impl Stone {
    /// Sides of the box around it [mm].
    fn extents(&self) -> [f64; 3] {
        let nodes: &[[f64; 3]] = match &self.division {
            Division::One(corners) => corners,
            Division::Several(hexes) => &hexes.nodes,
        };
        [0, 1, 2].map(|d| {
            let [low, high] = range(nodes.iter().map(|x| x[d]));
            high - low
        })
    }

    /// Number of elements with this mesh.
    fn elements(&self, mesh: [u32; 3]) -> f64 {
        let each: f64 = mesh.iter().map(|n| f64::from(*n)).product();
        match &self.division {
            Division::One(_) => each,
            Division::Several(hexes) => each * hexes.elements.len() as f64,
        }
    }

    /// Appends the body to the mesh; `laid` gives the place of a point.
    pub(super) fn append(
        &self,
        mesh: &mut Mesh,
        cells: [u32; 3],
        material: u16,
        laid: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Body {
        match &self.division {
            Division::One(corners) => {
                let corners: Corners = corners.map(laid);
                Body::hexahedron(
                    mesh,
                    self.name.clone(),
                    &corners,
                    cells.map(|n| n as usize),
                    material,
                )
            }
            Division::Several(hexes) => {
                let finer = (cells[0] > 1).then(|| hexes.refined(cells[0]));
                let hexes = finer.as_ref().unwrap_or(hexes);
                let nodes = hexes.nodes.iter().map(|x| laid(*x));
                let first_node = mesh.nodes.len() as u32;
                mesh.nodes.extend(nodes);
                appended(hexes, mesh, first_node, (self.name.clone(), material))
            }
        }
    }
}

/// Appends elements, whose nodes are there from `first_node` on, as one body whose faces are `side-0`, ….
fn appended(
    hexes: &Hexes,
    mesh: &mut Mesh,
    first_node: u32,
    (name, material): (String, u16),
) -> Body {
    let number = mesh.unit.last().map_or(0, |u| u + 1);
    let first = mesh.elements.len();
    for element in &hexes.elements {
        mesh.elements.push(element.map(|n| first_node + n));
        mesh.material.push(material);
        mesh.unit.push(number);
        mesh.course.push(0);
    }
    let face = |(f, facets): (usize, &Vec<_>)| {
        let facet = |(e, side): &(u32, crate::element::hexahedron::Face)| {
            let element = first + *e as usize;
            (element, side.corners().map(|c| mesh.elements[element][c]))
        };
        let facets: Vec<(usize, [u32; 4])> = facets.iter().map(facet).collect();
        let outline = |f: &(usize, [u32; 4])| f.1.map(|n| mesh.nodes[n as usize]);
        BodyFace {
            name: Cow::Owned(format!("side-{f}")),
            outlines: facets.iter().map(outline).collect(),
            facets,
            nodes: None,
        }
    };
    let faces: Vec<BodyFace> = hexes.faces.iter().enumerate().map(face).collect();
    Body {
        name,
        number,
        nodes: first_node..mesh.nodes.len() as u32,
        skin: faces.len(),
        faces,
        curved: false,
    }
}
