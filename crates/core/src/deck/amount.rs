//! Size of the scene that a deck asks for.
//!
//! It is counted before any body is built, so that a mistake in the deck costs neither time nor memory.

use super::masonry::Refusal;
use super::quantity::Quantity;
use super::schema::{Bond, Deck, DeckArch, DeckBlock, Wall};
use crate::error::{ErrorKind, ModelError};

/// Largest number of elements of a scene: 2e6 unknowns, which need more than 30 GB. `wythe check` takes some 5 s
/// and 1 GB for it.
pub(super) const MOST_ELEMENTS: f64 = 5e5;

/// Largest number of bodies: units, blocks, voussoirs.
pub(super) const MOST_BODIES: f64 = 5e4;

/// Largest number of contact points.
pub(super) const MOST_POINTS: f64 = 1e7;

/// Largest number of steps, and of the changes that they make to faces, springs and loads together.
const MOST_STEPS: usize = 10_000;
const MOST_CHANGES: usize = 2_000_000;

/// Longest list of a deck whose entries are compared with all others.
const MOST_ENTRIES: usize = 20_000;

/// Number of elements and of bodies.
#[derive(Clone, Copy, Default)]
struct Amount {
    elements: f64,
    bodies: f64,
}

fn product(n: [u32; 3]) -> f64 {
    n.iter().map(|n| f64::from(*n)).product()
}

fn of_block(block: &DeckBlock) -> Amount {
    let bodies = product(block.copies.unwrap_or([1; 3])) * f64::from(block.stack.unwrap_or(1));
    Amount {
        elements: product(block.mesh) * bodies,
        bodies,
    }
}

fn of_arch(arch: &DeckArch) -> Amount {
    let bodies = f64::from(arch.voussoirs) + 2.0;
    Amount {
        elements: product(arch.mesh) * bodies,
        bodies,
    }
}

/// Approximate number of elements and bodies of a wall with positive sizes.
fn of_wall(wall: &Wall) -> Amount {
    let [length, width, _] = wall.unit.map(Quantity::get);
    let head = wall.head_joint.get();
    let in_row = |unit: f64| ((wall.length.get() + head) / (unit + head)).ceil();
    let a_course = match wall.bond {
        Bond::Stretcher | Bond::Stack => f64::from(wall.leaves) * in_row(length),
        Bond::Header => in_row(width),
        // Headers, or two leaves of stretchers, whichever are more.
        Bond::English | Bond::EnglishCross | Bond::Flemish => {
            let halves = f64::from(wall.leaves.max(2));
            (0.5 * halves).ceil() * in_row(width).max(2.0 * in_row(length))
        }
        Bond::Pattern => {
            let of_course = |course: &crate::deck::schema::DeckCourse| -> f64 {
                course.leaves.iter().map(|l| units_of(wall, l)).sum()
            };
            wall.pattern.iter().map(of_course).fold(0.0, f64::max)
        }
    };
    let m = wall.mesh;
    let each = if wall.rigid {
        1.0
    } else {
        product([m.length, m.height, m.thickness])
    };
    let bodies = a_course * f64::from(wall.courses);
    Amount {
        elements: bodies * each,
        bodies,
    }
}

/// Number of units of a leaf of a written bond, from its first unit to the end of the wall.
pub(super) fn units_of(wall: &Wall, leaf: &crate::deck::schema::DeckLeaf) -> f64 {
    let round: f64 = leaf
        .units
        .iter()
        .map(|u| u.get() + wall.head_joint.get())
        .sum();
    let rounds = (wall.length.get() - leaf.offset.get()) / round;
    (rounds.max(0.0).ceil() + 1.0) * leaf.units.len() as f64
}

/// Rejects a scene with more elements or bodies than can be built. Walls must have positive sizes.
///
/// # Errors
/// Path and key of the wall or block that has most of them.
pub(super) fn require_countable(deck: &Deck) -> Result<(), (String, Refusal)> {
    let mut parts: Vec<(String, Amount)> = Vec::new();
    for (path, _, wall) in deck.walls() {
        parts.push((path, of_wall(wall)));
    }
    let blocks = deck.blocks.iter().enumerate();
    parts.extend(blocks.map(|(i, block)| (format!("blocks.{i}"), of_block(block))));
    parts.extend(
        deck.arch
            .iter()
            .map(|arch| ("arch".to_owned(), of_arch(arch))),
    );
    let elements: f64 = parts.iter().map(|part| part.1.elements).sum();
    let bodies: f64 = parts.iter().map(|part| part.1.bodies).sum();
    if elements <= MOST_ELEMENTS && bodies <= MOST_BODIES {
        return Ok(());
    }
    let too_fine = elements > MOST_ELEMENTS;
    let most = |a: &&(String, Amount), b: &&(String, Amount)| {
        let count = |of: &Amount| if too_fine { of.elements } else { of.bodies };
        count(&a.1).total_cmp(&count(&b.1))
    };
    let Some((path, amount)) = parts.iter().max_by(most) else {
        return Ok(());
    };
    let each = amount.elements / amount.bodies;
    let key = match path.as_str() {
        "arch" if too_fine => "mesh",
        "arch" => "voussoirs",
        _ if too_fine && each > 1e3 => "mesh",
        path if path.starts_with("blocks") => {
            let block = path
                .strip_prefix("blocks.")
                .and_then(|i| i.parse::<usize>().ok());
            match block.and_then(|i| deck.blocks.get(i)) {
                Some(block) if block.stack.is_some() => "stack",
                Some(block) if block.copies.is_some() => "copies",
                _ => "mesh",
            }
        }
        path => {
            let wall = deck.walls().find(|(of, ..)| of == path);
            let long = wall.is_some_and(|(_, _, w)| {
                amount.bodies / f64::from(w.courses) > f64::from(w.courses)
            });
            if long { "length" } else { "courses" }
        }
    };
    let refusal = Refusal::new(
        key,
        format!("{bodies} units and blocks of {elements} elements in all are too many"),
        format!(
            "at most {MOST_BODIES:e} units and blocks, {MOST_ELEMENTS:e} elements: coarsen `mesh`, build a part, or see \
             that the unit of length is right"
        ),
    );
    Err((path.clone(), refusal))
}

/// Rejects lists of a deck that are too long to be checked.
///
/// # Errors
/// The first list that is too long.
pub(super) fn require_few(deck: &Deck) -> Result<(), ModelError> {
    let loads: usize = deck.steps.iter().map(|step| step.loads.len()).sum();
    let faces = deck.steps.iter().filter(|step| step.face.is_some()).count();
    let lists = [
        ("steps", deck.steps.len(), MOST_STEPS),
        ("materials", deck.materials.len(), MOST_ENTRIES),
        ("interfaces", deck.interfaces.len(), MOST_ENTRIES),
        ("walls", deck.walls.len(), MOST_ENTRIES),
        ("contacts", deck.contacts.len(), MOST_ENTRIES),
        ("supports", deck.supports.len(), MOST_ENTRIES),
        ("springs", deck.springs.len(), MOST_ENTRIES),
        ("beams", deck.beams.len(), MOST_ENTRIES),
        ("settlements", deck.settlements.len(), MOST_ENTRIES),
        ("ties", deck.ties.len(), MOST_ENTRIES),
        ("floors", deck.floors.len(), MOST_ENTRIES),
        ("layers", deck.layers.len(), MOST_ENTRIES),
        ("probes", deck.probes.len(), MOST_ENTRIES),
        ("sections", deck.sections.len(), MOST_ENTRIES),
        ("imports", deck.imports.len(), MOST_ENTRIES),
    ];
    for (name, count, most) in lists {
        if count > most {
            let message = format!("{count} entries are too many");
            return Err(deck
                .error(name, message, &format!("at most {most}"))
                .of_kind(ErrorKind::TooMany));
        }
    }
    let changed = 1
        + deck.springs.len()
        + deck.beams.len()
        + deck.settlements.len()
        + loads.min(MOST_ENTRIES)
        + faces;
    if deck.steps.len().saturating_mul(changed) > MOST_CHANGES {
        let count = deck.steps.len();
        return Err(deck.error(
            "steps",
            format!("{count} steps are too many for {changed} faces, springs, beams and loads"),
            &format!("at most {MOST_CHANGES} of both, multiplied: `amplitude` and `cycles` go to and fro in one step"),
        ).of_kind(ErrorKind::TooMany));
    }
    Ok(())
}
