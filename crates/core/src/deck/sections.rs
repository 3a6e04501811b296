//! Sections of a deck: those that it gives, and those of the piers and spandrels of walls.

use super::bodies::Bodies;
use super::keys;
use super::masonry::levels;
use super::quantity::Quantity;
use super::schema::{Deck, DeckOpening, DeckSection, Names, Rotation, Wall};
use crate::element::hexahedron::{difference, dot};
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::Mesh;
use crate::model::axis::along_axis;
use crate::model::sections::{Section, Sides};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// A section before its elements are known.
pub(super) struct Draft {
    /// Path in the deck.
    pub(super) path: String,
    /// Its name.
    pub(super) name: String,
    /// Normal and two directions of the plane.
    directions: [[f64; 3]; 3],
    /// A point of the plane [mm].
    through: [f64; 3],
    /// Bodies that are cut; all if none.
    of: Option<Names>,
    /// Box of the middles of elements that are cut [mm].
    within: Option<[[f64; 3]; 2]>,
    /// Point and rotation of a turned wall, in whose axes the box lies.
    turned: Option<([f64; 3], Rotation)>,
}

impl Draft {
    /// Columns of the history.
    pub(super) fn columns(&self) -> impl Iterator<Item = String> {
        Section::columns(&self.name, &self.directions).into_iter()
    }

    /// Section with a normal.
    fn plane(path: String, section: &DeckSection, through: [f64; 3]) -> Self {
        let corner = |corner: [crate::deck::quantity::Length; 3]| corner.map(Quantity::get);
        Self {
            path,
            name: section.name.clone().unwrap_or_default(),
            directions: Section::directions(section.unit_normal()),
            through,
            of: section.of.clone(),
            within: section.within.map(|within| within.map(corner)),
            turned: None,
        }
    }

    /// Whether an element with this middle is within the box.
    fn holds(&self, middle: [f64; 3]) -> bool {
        let Some([low, high]) = self.within else {
            return true;
        };
        let x = self.turned.map_or(middle, |(at, rotation)| {
            let turned = rotation.turn_back([0, 1, 2].map(|i| middle[i] - at[i]));
            [0, 1, 2].map(|i| at[i] + turned[i])
        });
        (0..3).all(|i| x[i] >= low[i] && x[i] <= high[i])
    }
}

impl Deck {
    /// All sections of the deck that can be told from its text, in order.
    pub(super) fn drafts(&self) -> Vec<Draft> {
        let mut drafts = Vec::new();
        for (i, section) in self.sections.iter().enumerate() {
            let path = format!("sections.{i}");
            if let Some(through) = section.through {
                drafts.push(Draft::plane(path, section, through.map(Quantity::get)));
            } else if let Some(piers) = &section.piers {
                let mut walls = self.walls();
                if let Some((_, name, wall)) = walls.find(|(_, name, _)| name == piers) {
                    let called = section.name.as_deref().unwrap_or(name);
                    drafts.extend(
                        Facade {
                            wall,
                            name,
                            called,
                            path,
                        }
                        .drafts(),
                    );
                }
            }
        }
        drafts
    }
}

/// A wall with openings.
struct Facade<'a> {
    wall: &'a Wall,
    /// Name of the wall.
    name: &'a str,
    /// Beginning of the names of its sections.
    called: &'a str,
    path: String,
}

impl Facade<'_> {
    fn drafts(&self) -> Vec<Draft> {
        let rows = rows(&self.wall.openings);
        let levels = levels(self.wall);
        let mut drafts = Vec::new();
        for (r, row) in rows.iter().enumerate() {
            let called = |what: &str, k: usize| match rows.len() {
                1 => format!("{}-{what}-{}", self.called, k + 1),
                _ => format!("{}-{what}-{}-{}", self.called, r + 1, k + 1),
            };
            for (k, span) in piers(self.wall, row).into_iter().enumerate() {
                drafts.extend(self.pier(called("pier", k), span, row, &levels));
            }
            for (k, opening) in row.iter().enumerate() {
                drafts.extend(self.spandrel(called("spandrel", k), opening, &levels));
            }
        }
        drafts
    }

    /// Level section of the masonry between two openings, in the middle of the courses that all of the row interrupt.
    fn pier(
        &self,
        name: String,
        span: [f64; 2],
        row: &[&DeckOpening],
        levels: &[(f64, f64)],
    ) -> Option<Draft> {
        let low = row.iter().map(|o| o.sill).max()?;
        let high = row.iter().map(|o| o.sill + o.courses).min()?;
        let (low, high) = (low as usize, high as usize);
        // A bed joint, if there is one between the courses.
        let level = if high > low + 1 {
            levels.get(usize::midpoint(low, high))?.0
        } else {
            let (bottom, top) = levels.get(low)?;
            0.5 * (bottom + top)
        };
        let (along, _) = self.wall.axes();
        let mut range = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
        range[0][along] = span[0];
        range[1][along] = span[1];
        let mut through = [0.0; 3];
        through[along] = 0.5 * (span[0] + span[1]);
        through[2] = level - self.wall.at[2].get();
        Some(self.draft(name, 2, through, range))
    }

    /// Section across the masonry above an opening, at its middle, up to the next opening or the top.
    fn spandrel(
        &self,
        name: String,
        opening: &DeckOpening,
        levels: &[(f64, f64)],
    ) -> Option<Draft> {
        let above = opening.sill + opening.courses;
        let over = |o: &&DeckOpening| {
            o.sill >= above && o.from.get() < opening.to.get() && opening.from.get() < o.to.get()
        };
        let next = self.wall.openings.iter().filter(over).map(|o| o.sill).min();
        let end = next.unwrap_or(self.wall.courses);
        if end <= above {
            return None;
        }
        let base = self.wall.at[2].get();
        let low = levels.get(above as usize)?.0 - base;
        let high = levels.get(end as usize).map(|level| level.0 - base);
        let (along, _) = self.wall.axes();
        let mut range = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
        range[0][2] = low;
        range[1][2] = high.unwrap_or(f64::INFINITY);
        let mut through = [0.0; 3];
        through[along] = 0.5 * (opening.from.get() + opening.to.get());
        through[2] = low;
        Some(self.draft(name, along, through, range))
    }

    /// Section with a normal along an axis of the wall; point and box in its axes, from its corner [mm].
    fn draft(&self, name: String, axis: usize, through: [f64; 3], within: [[f64; 3]; 2]) -> Draft {
        let at = self.wall.at.map(Quantity::get);
        let turn = |x: [f64; 3]| self.wall.rotate.map_or(x, |rotation| rotation.turn(x));
        let moved = |x: [f64; 3]| [0, 1, 2].map(|i| at[i] + x[i]);
        Draft {
            path: self.path.clone(),
            name,
            directions: Section::directions(turn(along_axis(axis))),
            through: moved(turn(through)),
            of: Some(Names(vec![self.name.to_owned()])),
            within: Some(within.map(moved)),
            turned: self.wall.rotate.map(|rotation| (at, rotation)),
        }
    }
}

/// Openings with courses in common, from below; within a row from the start of the wall.
fn rows(openings: &[DeckOpening]) -> Vec<Vec<&DeckOpening>> {
    let mut sorted: Vec<&DeckOpening> = openings.iter().collect();
    sorted.sort_by_key(|o| o.sill);
    let mut rows: Vec<Vec<&DeckOpening>> = Vec::new();
    for opening in sorted {
        // All of a row share courses, so that a level section crosses each of its piers.
        let shares = |row: &Vec<&DeckOpening>| {
            let top = row.iter().map(|o| o.sill + o.courses).min();
            top.is_some_and(|top| opening.sill < top)
        };
        match rows.last_mut().filter(|row| shares(row)) {
            Some(row) => row.push(opening),
            None => rows.push(vec![opening]),
        }
    }
    for row in &mut rows {
        row.sort_by(|a, b| a.from.get().total_cmp(&b.from.get()));
    }
    rows
}

/// Ranges of masonry along a wall beside and between the openings of a row [mm].
fn piers(wall: &Wall, row: &[&DeckOpening]) -> Vec<[f64; 2]> {
    let edges = || row.iter().map(|o| wall.edges(o));
    let starts = std::iter::once(0.0).chain(edges().map(|[_, to]| to));
    let ends = edges().map(|[from, _]| from);
    let ends = ends.chain(std::iter::once(wall.length.get()));
    let spans = starts.zip(ends).map(|(start, end)| [start, end]);
    spans.filter(|[start, end]| end > start).collect()
}

/// Sections of a deck with their elements.
///
/// # Errors
/// Unknown bodies; planes that cut nothing.
pub(super) fn sections(deck: &Deck, bodies: &Bodies<'_>) -> Result<Vec<Section>, ModelError> {
    let mut errors = Errors::default();
    let drafts = deck.drafts();
    let mut sections = Vec::with_capacity(drafts.len());
    for draft in drafts {
        sections.extend(errors.keep(section(deck, bodies, draft)));
    }
    errors.end(sections)
}

fn section(deck: &Deck, bodies: &Bodies<'_>, draft: Draft) -> Result<Section, ModelError> {
    let mesh = &bodies.mesh;
    let units = match &draft.of {
        None => None,
        Some(names) => {
            let places = bodies.places(&format!("{}.of", draft.path), names, false)?;
            let numbers = places.iter().map(|place| bodies.all[place.body].number);
            Some(numbers.collect::<BTreeSet<u32>>())
        }
    };
    let elements = (0..mesh.elements.len() as u32).filter(|e| {
        let e = *e as usize;
        let is_of = units
            .as_ref()
            .is_none_or(|units| units.contains(&mesh.unit[e]));
        let corners = mesh.corners(e);
        is_of && draft.holds([0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / 8.0))
    });
    let elements: Vec<u32> = elements.collect();
    let middles = extent(mesh, &elements, draft.directions[0], draft.through);
    let [normal, ..] = draft.directions;
    let Some(sides) = Sides::of(mesh, elements.into_iter(), normal, draft.through) else {
        let mut message = format!("the section `{}` cuts no solid", draft.name);
        let help = if let Some([low, high]) = middles {
            let _ = write!(
                message,
                " between the middles of elements, which lie from {low:.1} to {high:.1} mm from it along its normal"
            );
            let advice = "move `through` by more than the first and less than the second; at a support, the columns \
                          of its reaction have the force";
            advice.to_owned()
        } else {
            keys::example("through")
        };
        let error = deck.error(&format!("{}.through", draft.path), message, &help);
        return Err(error.of_kind(ErrorKind::Geometry));
    };
    Ok(Section {
        name: draft.name,
        directions: draft.directions,
        centre: sides.centre,
        area: sides.area,
        above: sides.above,
        below: sides.below,
    })
}

/// Least and largest distance of the middles of elements from the plane through a point, along its normal [mm]; none
/// without elements.
fn extent(mesh: &Mesh, elements: &[u32], normal: [f64; 3], through: [f64; 3]) -> Option<[f64; 2]> {
    let distances = elements.iter().map(|e| {
        let corners = mesh.corners(*e as usize);
        let middle = [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / 8.0);
        dot(difference(middle, through), normal)
    });
    distances.fold(None, |extent, x| {
        let [low, high] = extent.unwrap_or([x, x]);
        Some([low.min(x), high.max(x)])
    })
}
