//! Ties of a deck: their points in the elements, and the steps in which they are installed.
//!
//! A bar in a bed joint lies on the common face of two courses, and the joint may open there. It is therefore two
//! strands of half the area, one bound to the course below and one to the course above.

use super::bodies::Bodies;
use super::keys;
use super::masonry::{Masonry, Unit, thickness};
use super::quantity::Quantity;
use super::schema::{Deck, DeckTie};
use super::symmetry::Plane;
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::scene::Step;
use crate::model::ties::{self, Bonded, Tie, TieFault, TieLaw, TiePoint, TieStage};

/// Distance from a plane of symmetry within which a point counts as in it [mm].
const IN_PLANE: f64 = 0.01;

impl Deck {
    /// Index of the step in which a tie is installed; none if there is no such step.
    pub(super) fn step_of_tie(&self, tie: &DeckTie) -> Option<usize> {
        match &tie.step {
            None => Some(0),
            Some(name) => self.steps.iter().position(|step| step.name() == name),
        }
    }
}

/// Builds the ties of a deck and tells the steps when they are installed and stressed.
///
/// # Errors
/// Points outside all solids, ties within one element or in the common face of bodies, ties at a plane of symmetry.
pub(super) fn ties(
    deck: &Deck,
    bodies: &Bodies<'_>,
    steps: &mut [Step],
) -> Result<Vec<Tie>, ModelError> {
    let mut ties: Vec<Tie> = Vec::new();
    let mut errors = Errors::default();
    for (i, tie) in deck.ties.iter().enumerate() {
        let Some(made) = errors.keep(tie_of(deck, bodies, i, tie)) else {
            continue;
        };
        let installed = deck.step_of_tie(tie).unwrap_or_default();
        for one in made {
            let prestress = tie.prestress.map_or(0.0, Quantity::get);
            for (s, step) in steps.iter_mut().enumerate() {
                step.ties.push(match prestress {
                    _ if s < installed => TieStage::Absent,
                    force if s == installed && force > 0.0 => TieStage::Stressed(force),
                    _ => TieStage::Fixed,
                });
            }
            ties.push(one);
        }
    }
    errors.end(ties)
}

/// The ties of entry `i`: one, or one for each bed joint.
fn tie_of(
    deck: &Deck,
    bodies: &Bodies<'_>,
    i: usize,
    tie: &DeckTie,
) -> Result<Vec<Tie>, ModelError> {
    let law = TieLaw {
        area: tie.whole_area(),
        E: tie.E.get(),
        f_y: tie.f_y.map_or(f64::INFINITY, Quantity::get),
        hardening: tie.hardening.map_or(0.0, Quantity::get),
        rupture: tie.rupture.map_or(f64::INFINITY, Quantity::get),
        compression: tie.takes_compression(),
    };
    let Some(points) = &tie.points else {
        return bed_joints(deck, bodies, i, tie, law);
    };
    let line: Vec<[f64; 3]> = points.iter().map(|x| x.map(Quantity::get)).collect();
    let path = format!("ties.{i}.points");
    clear_of_planes(deck, &path, &line)?;
    let mesh = &bodies.mesh;
    let points = if tie.is_bonded() {
        let unbonded = tie.free_length();
        ties::bonded(
            mesh,
            &line,
            &Bonded {
                unbonded,
                only: None,
            },
        )
    } else {
        ties::anchored(mesh, [line[0], line[1]])
    };
    let points = points.map_err(|fault| refused(deck, &path, &fault))?;
    Ok(vec![Tie {
        name: tie.name.clone(),
        law,
        strands: vec![points],
        shares: Vec::new(),
    }])
}

/// Rejects points in planes of symmetry: the tie would go on beyond them.
fn clear_of_planes(deck: &Deck, path: &str, line: &[[f64; 3]]) -> Result<(), ModelError> {
    for plane in Plane::all(deck) {
        if line.iter().any(|x| plane.beyond(x[plane.axis]) > -IN_PLANE) {
            return Err(deck
                .error(
                    path,
                    format!("the tie reaches the plane of symmetry {}", plane.called()),
                    "a tie of a mirror half lies within it, and its image in the other half; model the whole scene \
                     for a tie through the plane",
                )
                .of_kind(ErrorKind::Geometry));
        }
    }
    Ok(())
}

/// Ties in the bed joints of a wall.
fn bed_joints(
    deck: &Deck,
    bodies: &Bodies<'_>,
    i: usize,
    tie: &DeckTie,
    law: TieLaw,
) -> Result<Vec<Tie>, ModelError> {
    let path = format!("ties.{i}.courses");
    let named = |wall: &&Masonry<'_>| Some(wall.name.as_str()) == tie.along.as_deref();
    let Some(wall) = bodies.walls.iter().find(named) else {
        let help = keys::example("ties.along");
        return Err(deck
            .error(&format!("ties.{i}.along"), "there is no such wall", &help)
            .of_kind(ErrorKind::UnknownName));
    };
    let law = TieLaw {
        area: 0.5 * law.area / f64::from(tie.bars.max(1)),
        ..law
    };
    let courses = tie.courses.iter().flatten().zip(tie.names());
    let mut made = Vec::new();
    for (course, name) in courses {
        let mut strands = Vec::new();
        for line in lines(wall, *course, tie.bars) {
            clear_of_planes(deck, &path, &line)?;
            for k in [*course, course + 1] {
                let points = strand(bodies, wall, k, &line, tie.free_length());
                match points {
                    Ok(points) => strands.push(points),
                    // A part of the joint in one element alone needs no bar.
                    Err(TieFault::OneElement { .. }) => {}
                    Err(fault) => return Err(refused(deck, &path, &fault)),
                }
            }
        }
        if strands.is_empty() {
            let message = format!("no bar fits in the bed joint on course {course}");
            let help = "bars lie where a course has units on it, in two elements at least";
            return Err(deck
                .error(&path, message, help)
                .of_kind(ErrorKind::Geometry));
        }
        made.push(Tie {
            name,
            law,
            strands,
            shares: Vec::new(),
        });
    }
    Ok(made)
}

/// A bar along `line` that is bound to the units of course `k`.
fn strand(
    bodies: &Bodies<'_>,
    wall: &Masonry<'_>,
    k: u32,
    line: &[[f64; 3]],
    unbonded: f64,
) -> Result<Vec<TiePoint>, TieFault> {
    let of_course: Vec<u32> = (wall.units.iter().zip(wall.bodies.clone()))
        .filter(|(unit, _)| u32::from(unit.course) == k)
        .map(|(_, body)| bodies.all[body].number)
        .collect();
    let only = |unit: u32| of_course.contains(&unit);
    let of = Bonded {
        unbonded,
        only: Some(&only),
    };
    ties::bonded(&bodies.mesh, line, &of)
}

/// Lines of the bars in the bed joint on a course: as many over the thickness as there are bars, each where both
/// courses have units.
fn lines(wall: &Masonry<'_>, course: u32, bars: u32) -> Vec<Vec<[f64; 3]>> {
    let (along, through) = wall.wall.axes();
    let tolerance = 1e-3 * wall.wall.unit[0].get();
    let of = |k: u32| -> Vec<&Unit> {
        let units = wall.units.iter();
        units.filter(|unit| u32::from(unit.course) == k).collect()
    };
    let parts = |k: u32| {
        let mut parts: Vec<[f64; 2]> = of(k).iter().map(|unit| unit.all[along]).collect();
        parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for part in parts {
            match joined.last_mut() {
                Some(last) if part[0] <= last[1] + tolerance => last[1] = last[1].max(part[1]),
                _ => joined.push(part),
            }
        }
        joined
    };
    let Some(height) = of(course).first().map(|unit| unit.all[2][1]) else {
        return Vec::new();
    };
    let at = wall.wall.at.map(Quantity::get);
    let depth = thickness(wall.wall);
    let mut lines = Vec::new();
    let above = parts(course + 1);
    for below in parts(course) {
        for above in &above {
            let both = [below[0].max(above[0]), below[1].min(above[1])];
            if both[1] - both[0] <= tolerance {
                continue;
            }
            for bar in 0..bars {
                let across = at[through] + depth * (f64::from(bar) + 0.5) / f64::from(bars);
                let point = |s: f64| {
                    let mut x = [0.0; 3];
                    (x[along], x[through], x[2]) = (s, across, height);
                    wall.placement.to_scene(x)
                };
                lines.push(both.map(point).to_vec());
            }
        }
    }
    lines
}

/// An error about the points of a tie.
fn refused(deck: &Deck, path: &str, fault: &TieFault) -> ModelError {
    let help = match fault {
        TieFault::Outside { .. } => {
            "points lie in a body or on its face, at rest; an anchor plate is a block of its own"
        }
        TieFault::NoLength { .. } => "move one of them",
        TieFault::OneElement { .. } => {
            "move an end into another element, or divide the body by `mesh`"
        }
        TieFault::InJoint { .. } => {
            "move it off the joint, into one of the bodies; along = \"wall\" with courses = [..] puts bars into bed joints"
        }
    };
    deck.error(path, fault.to_string(), help)
        .of_kind(ErrorKind::Geometry)
}
