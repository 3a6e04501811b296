//! Memory of a run, estimated before it.

use crate::deck::masonry;
use crate::deck::schema::{Deck, Wall};
use crate::material::MaterialHistory;
use crate::model::Model;
use crate::model::scene::{Step, Tangent};
use crate::model::sizes::sizes;

/// Estimated peak memory [MB] with factors in single and in double precision.
///
/// The sum has the program, two histories at 8 points of each element, matrices of elements and contact pairs, and
/// the linear solver, which counts `times` over. Unsymmetric factors are always in double precision and take a
/// fifth more.
///
/// The factor of a wall that is w unknowns thick grows as that of a plane grid: w log₂(n/w) bytes for each of n
/// unknowns in double precision. In single precision the factor is less than half of all memory, and the logarithm
/// is not noticeable. The constants are measured on walls of 12,000 to 1,430,000 unknowns and are within a sixth of
/// these. Scenes with blocks count as a cube, n^1.22 bytes, measured at 14,000 and 86,000 unknowns; flat scenes
/// take less.
pub(super) fn memory_mb(deck: &Deck, model: &Model, times: f64) -> [f64; 2] {
    let sizes = sizes(model);
    let element = 2 * 8 * size_of::<MaterialHistory>() + 24 * 24 * 8;
    let contact = 24 * 24 * 8 + 2 * size_of::<wythe_contact::InterfaceHistory>();
    let bodies = model.mesh.elements.len() * element + sizes.contact_points * contact;
    let n = sizes.dofs as f64;
    let planes = planes_through(deck, model);
    let [single, double] = match planes {
        Some(planes) if !deck.has_blocks() => {
            let thick = 3.0 * planes as f64;
            let levels = (n / thick).max(1.0).log2();
            [n * thick * 560.0, n * thick * (440.0 + 34.0 * levels)]
        }
        _ => [980.0 * n.powf(1.22), 1700.0 * n.powf(1.22)],
    };
    let unsymmetric = |s: &Step| s.tangent != Tangent::Secant;
    let solvers = if model.steps.iter().any(unsymmetric) {
        [1.2 * double; 2]
    } else {
        [single, double]
    };
    solvers.map(|solver| PROGRAM_MB + (bodies as f64 + times * solver) * 1e-6)
}

/// Number of node planes through the thickness of the walls: those of a unit times the number of units through the
/// thickness. None without walls.
pub(super) fn planes_through(deck: &Deck, model: &Model) -> Option<usize> {
    let walls = || deck.walls().map(|(_, _, wall)| wall);
    if walls().any(|wall| wall.rotate.is_some()) {
        // Planes of symmetry cut no turned wall, so that the deck has all planes.
        let of = |wall: &Wall| {
            let units = (masonry::thickness(wall) / wall.unit[1].get()).round();
            (wall.mesh.thickness as usize + 1) * units.clamp(1.0, MOST_LEAVES) as usize
        };
        return walls().map(of).max();
    }
    let thickness = walls().map(masonry::thickness).max_by(f64::total_cmp)?;
    let axes: Vec<usize> = [0, 1]
        .into_iter()
        .filter(|d| walls().any(|wall| wall.axes().1 == *d))
        .collect();
    let mesh = &model.mesh;
    // Only half of the thickness is present where a plane of symmetry cuts it.
    let laid = [0, 1].map(|d| {
        let [front, back] = mesh.extent(d);
        back - front
    });
    let planes = |unit: &[usize], d: usize| {
        let nodes = unit.iter().flat_map(|e| mesh.corners(*e));
        let mut x: Vec<f64> = nodes.map(|x| x[d]).collect();
        x.sort_by(f64::total_cmp);
        x.dedup_by(|b, a| *b - *a <= SAME_PLANE);
        let times = thickness.min(laid[d]) / (x[x.len() - 1] - x[0]);
        let times = times.round().clamp(1.0, MOST_LEAVES);
        x.len() * times as usize
    };
    let elements: Vec<usize> = (0..mesh.elements.len()).collect();
    let units = elements.chunk_by(|a, b| mesh.unit[*a] == mesh.unit[*b]);
    // Where walls run along both axes, the orientation of a unit is unknown: the smaller count is taken.
    units
        .filter_map(|unit| axes.iter().map(|d| planes(unit, *d)).min())
        .max()
}

/// Upper bound of the number of units through a wall [-].
const MOST_LEAVES: f64 = 100.0;

/// Nodes closer along an axis lie in one plane [mm].
const SAME_PLANE: f64 = 1e-6;

/// Memory of a run of two bricks [MB].
const PROGRAM_MB: f64 = 23.0;
