//! Geometry of a driven model: direction and height of the drive, bed and head joints, courses.

use std::collections::{BTreeMap, BTreeSet};

use super::place::middle;
use crate::element::hexahedron::{area_vector, range};
use crate::model::Model;
use crate::model::drive::{Drive, largest};
use crate::model::mesh::WallOfUnits;
use crate::results::Snapshot;
use crate::results::comparison::clear_height;

/// Direction of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lie {
    /// Its normal is closest to the vertical.
    Bed,
    /// Its normal is closest to the direction of the drive.
    Head,
    /// Its normal is closest to the third direction, or it is a joint of another wall.
    Other,
}

/// A contact point at rest.
#[derive(Clone, Copy, Debug)]
pub struct JointPoint {
    /// Where the law acts [mm].
    pub at: [f64; 3],
    /// Middle of its quarter of the facet [mm].
    pub middle: [f64; 3],
    /// Area [mm²].
    pub area: f64,
    /// Direction.
    pub lie: Lie,
}

/// A course of units between the support and the top.
#[derive(Clone, Debug)]
pub struct Course {
    /// Lowest and highest height [mm].
    pub levels: [f64; 2],
    /// Elements of the units, without their mortar.
    pub units: Vec<usize>,
}

/// Geometry that the mode of failure refers to: of the whole model, or of one of its walls.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Horizontal direction of the drive: 0 or 1 for x or y.
    pub axis: usize,
    /// Height of the support and of the top [mm]: the ends of the clear height, or of the solids if there is none.
    pub levels: [f64; 2],
    /// Elements.
    pub solids: Vec<usize>,
    /// Contact points, those of other walls too. `[point]`
    pub points: Vec<JointPoint>,
    /// Courses in the middle half of the height.
    pub inner: Vec<Course>,
    /// Bed joints from below: indices of their contact points. Joints with less than half of the area of the largest
    /// one are left out.
    pub beds: Vec<Vec<usize>>,
    /// Ends of the lowest bed joint along the drive [mm].
    pub ends_of_base: [f64; 2],
}

/// Relative tolerance of heights that are the same [-].
const SAME: f64 = 1e-6;
/// Part of the area of the largest bed joint from which one counts as a joint through the wall.
const THROUGH: f64 = 0.5;

impl Scene {
    /// Geometry of a model, with its joints at a frame; `None` if nothing moves it sideways.
    pub fn of(model: &Model, snapshot: &Snapshot) -> Option<Self> {
        let axis = axis_of(model, snapshot)?;
        let solids = (0..model.mesh.elements.len()).collect();
        let points = points(model, axis);
        Some(Self::of_part(model, axis, levels(model), (solids, points)))
    }

    /// Geometry of one wall of this scene, if its longer side runs along the drive.
    pub fn of_wall(&self, model: &Model, wall: &WallOfUnits) -> Option<Self> {
        let is_of_wall = |unit: u32| wall.units.binary_search(&unit).is_ok();
        let (mesh, axis) = (&model.mesh, self.axis);
        let mut solids = self.solids.clone();
        solids.retain(|e| is_of_wall(mesh.unit[*e]));
        let nodes: BTreeSet<u32> = solids.iter().flat_map(|e| mesh.elements[*e]).collect();
        let extent = |axis: usize| range(nodes.iter().map(|n| mesh.nodes[*n as usize][axis]));
        let [along, across] = [axis, 1 - axis].map(|axis| extent(axis)[1] - extent(axis)[0]);
        if along <= across {
            return None;
        }
        let [lowest, top] = extent(2);
        let held = model.supports.iter().filter(|s| s.fixed[2]);
        let held = held.flat_map(|s| &s.nodes).filter(|n| nodes.contains(n));
        let bottom = held.fold(lowest, |z, n| z.max(mesh.nodes[*n as usize][2]));
        let mut points = self.points.clone();
        for (p, point) in points.iter_mut().enumerate() {
            if !is_of_wall(model.contact.slave_body[p / 4]) {
                point.lie = Lie::Other;
            }
        }
        Some(Self::of_part(model, axis, [bottom, top], (solids, points)))
    }

    fn of_part(
        model: &Model,
        axis: usize,
        levels: [f64; 2],
        (solids, points): (Vec<usize>, Vec<JointPoint>),
    ) -> Self {
        let size = (levels[1] - levels[0]).abs();
        let beds = beds(&points, SAME * size);
        let base = beds.first().map_or(&[][..], |bed| bed);
        Self {
            axis,
            levels,
            inner: inner(model, levels, &solids),
            solids,
            ends_of_base: ends(model, base, axis),
            beds,
            points,
        }
    }
}

/// Horizontal direction of the drive, else that of the largest displacement of a model that nothing drives. `None` for
/// a vertical one.
fn axis_of(model: &Model, snapshot: &Snapshot) -> Option<usize> {
    let moved = || {
        let size = |u: &[f64; 3]| u[0].hypot(u[1]);
        let all = snapshot.frame.displacement.iter();
        let most = all.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        Some(largest([most[0], most[1], 0.0])?.axis)
    };
    let driven = Drive::of(model).map(|drive| drive.axis);
    driven.or_else(moved).filter(|axis| *axis != 2)
}

/// Heights of support and top [mm].
fn levels(model: &Model) -> [f64; 2] {
    let all = model.mesh.extent(2);
    let vertical = model.supports.iter().filter(|s| s.fixed[2]);
    let held = vertical.flat_map(|s| &s.nodes);
    let held = held.map(|n| model.mesh.nodes[*n as usize][2]);
    let bottom = held.fold(f64::NEG_INFINITY, f64::max);
    match clear_height(model) {
        Some(height) => [bottom, bottom + height],
        None => all,
    }
}

/// All contact points at rest.
fn points(model: &Model, axis: usize) -> Vec<JointPoint> {
    let contact = &model.contact;
    let of = |facet: usize| {
        let corners = contact.slave_facets[facet].map(|n| model.mesh.nodes[n as usize]);
        let sampled = contact.sampled(facet, &model.mesh.nodes);
        let outline = contact.outline(facet, &model.mesh.nodes);
        let size = area_vector(&outline).map(f64::abs);
        let lie = if size[2] >= size[0].max(size[1]) {
            Lie::Bed
        } else if size[axis] >= size[1 - axis] {
            Lie::Head
        } else {
            Lie::Other
        };
        let blend = |weights: &[f64; 4]| {
            [0, 1, 2].map(|i| (0..4).map(|a| weights[a] * corners[a][i]).sum::<f64>())
        };
        [0, 1, 2, 3].map(|k| JointPoint {
            at: blend(&sampled[k].weights),
            middle: middle(model, 4 * facet + k),
            area: sampled[k].area,
            lie,
        })
    };
    (0..contact.slave_facets.len()).flat_map(of).collect()
}

/// Lowest and highest coordinate along an axis of the facets of these points [mm].
fn ends(model: &Model, points: &[usize], axis: usize) -> [f64; 2] {
    let corners = points
        .iter()
        .flat_map(|p| model.contact.outline(p / 4, &model.mesh.nodes));
    corners.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x[axis]), high.max(x[axis])]
    })
}

/// Bed joints: points at one height.
fn beds(points: &[JointPoint], near: f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|p| points[*p].lie == Lie::Bed)
        .collect();
    order.sort_by(|a, b| points[*a].middle[2].total_cmp(&points[*b].middle[2]));
    let mut beds: Vec<Vec<usize>> = Vec::new();
    for p in order {
        let height = |q: usize| points[q].middle[2];
        match beds.last_mut() {
            Some(bed) if (height(bed[0]) - height(p)).abs() <= near => bed.push(p),
            _ => beds.push(vec![p]),
        }
    }
    let area = |bed: &Vec<usize>| bed.iter().map(|p| points[*p].area).sum::<f64>();
    let most = beds.iter().map(area).fold(0.0, f64::max);
    beds.retain(|bed| area(bed) >= THROUGH * most);
    beds
}

/// Courses within the middle half of the height; of a wall so low that it has none, those whose middle lies there.
fn inner(model: &Model, [bottom, top]: [f64; 2], solids: &[usize]) -> Vec<Course> {
    let mesh = &model.mesh;
    let of_unit = unit_materials(model);
    let mut courses: BTreeMap<u16, Course> = BTreeMap::new();
    for &e in solids {
        let course = courses.entry(mesh.course[e]).or_insert_with(|| Course {
            levels: [f64::INFINITY, f64::NEG_INFINITY],
            units: Vec::new(),
        });
        for x in mesh.corners(e) {
            course.levels = [course.levels[0].min(x[2]), course.levels[1].max(x[2])];
        }
        if of_unit.get(&mesh.unit[e]) == Some(&mesh.material[e]) {
            course.units.push(e);
        }
    }
    let height = top - bottom;
    let rounding = SAME * height;
    let (low, high) = (bottom + 0.25 * height, top - 0.25 * height);
    let within = |c: &Course| c.levels[0] >= low - rounding && c.levels[1] <= high + rounding;
    let whole: Vec<Course> = courses.values().filter(|c| within(c)).cloned().collect();
    if !whole.is_empty() {
        return whole;
    }
    let middle = |c: &Course| 0.5 * (c.levels[0] + c.levels[1]);
    let about = |c: &Course| middle(c) >= low && middle(c) <= high && c.levels[1] <= top + rounding;
    courses.into_values().filter(about).collect()
}

/// Material of each unit: the one with the largest volume; its other materials are mortar. `[unit]`
fn unit_materials(model: &Model) -> BTreeMap<u32, u16> {
    let mesh = &model.mesh;
    let mut volumes: BTreeMap<(u32, u16), f64> = BTreeMap::new();
    for (e, (unit, material)) in mesh.unit.iter().zip(&mesh.material).enumerate() {
        *volumes.entry((*unit, *material)).or_default() += mesh.volume(e);
    }
    let mut largest: BTreeMap<u32, (u16, f64)> = BTreeMap::new();
    for ((unit, material), volume) in volumes {
        let best = largest.entry(unit).or_insert((material, volume));
        if volume > best.1 {
            *best = (material, volume);
        }
    }
    largest
        .into_iter()
        .map(|(unit, (material, _))| (unit, material))
        .collect()
}
