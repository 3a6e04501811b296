//! Geometry of a driven model: direction and height of the drive, bed and head joints, courses.

use std::collections::BTreeMap;

use crate::model::Model;
use crate::model::scene::BeamMotion;
use crate::results::Snapshot;
use crate::results::comparison::clear_height;

/// Direction of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lie {
    /// Its normal is closest to the vertical.
    Bed,
    /// Its normal is closest to the direction of the drive.
    Head,
    /// Its normal is closest to the third direction.
    Other,
}

/// A contact point at rest.
#[derive(Clone, Copy, Debug)]
pub struct JointPoint {
    /// Position [mm].
    pub at: [f64; 3],
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

/// Geometry that the mode of failure refers to.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Horizontal direction of the drive: 0 or 1 for x or y.
    pub axis: usize,
    /// Height of the support and of the top [mm]: the ends of the clear height, or of the solids if there is none.
    pub levels: [f64; 2],
    /// Contact points. `[point]`
    pub points: Vec<JointPoint>,
    /// Courses that lie in the middle half of the height.
    pub inner: Vec<Course>,
    /// Bed joints from below: indices of their contact points. Joints with less than half of the area of the largest
    /// one are left out.
    pub beds: Vec<Vec<usize>>,
}

/// Relative tolerance of heights that are the same [-].
const SAME: f64 = 1e-6;
/// Part of the area of the largest bed joint from which one counts as a joint through the wall.
const THROUGH: f64 = 0.5;

impl Scene {
    /// Geometry of a model, with its joints at a frame; `None` if nothing moves it sideways.
    pub fn of(model: &Model, snapshot: &Snapshot) -> Option<Self> {
        let axis = axis_of(model, snapshot)?;
        let levels = levels(model);
        let points = points(snapshot, axis);
        let size = (levels[1] - levels[0]).abs();
        Some(Self {
            axis,
            levels,
            inner: inner(model, levels),
            beds: beds(&points, SAME * size),
            points,
        })
    }
}

/// Horizontal direction of the drive of a beam, else of a spring, else of a load, else of the largest displacement of
/// a model that nothing drives. `None` for a vertical one.
fn axis_of(model: &Model, snapshot: &Snapshot) -> Option<usize> {
    let steps = || model.steps.iter();
    let of_beam = steps().find_map(|step| {
        let (beam, axis) = step.driven?;
        matches!(step.motion.get(beam)?[axis], BeamMotion::Driven(_)).then_some(axis)
    });
    let of_spring = || {
        let mut ends = steps().flat_map(|step| &step.springs);
        ends.find_map(|by| (0..3).find(|i| by[*i] != 0.0))
    };
    let largest = |v: [f64; 3]| {
        let size = |i: &usize| v[*i].abs();
        let axis = (0..3).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        (v[axis] != 0.0).then_some(axis)
    };
    let of_load = || {
        let mut changed = steps().filter_map(|step| step.loads.iter().position(Option::is_some));
        largest(model.loads.get(changed.next()?)?.direction)
    };
    let moved = || {
        let size = |u: &[f64; 3]| u[0].hypot(u[1]);
        let all = snapshot.frame.displacement.iter();
        let most = all.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        largest([most[0], most[1], 0.0])
    };
    let driven = of_beam.or_else(of_spring).or_else(of_load);
    driven.or_else(moved).filter(|axis| *axis != 2)
}

/// Heights of support and top [mm].
fn levels(model: &Model) -> [f64; 2] {
    let all = model.mesh.extent(2);
    let held = model.supports.iter().flat_map(|s| &s.nodes);
    let held = held.map(|n| model.mesh.nodes[*n as usize][2]);
    let bottom = held.fold(f64::NEG_INFINITY, f64::max);
    match clear_height(model) {
        Some(height) => [bottom, bottom + height],
        None => all,
    }
}

fn points(snapshot: &Snapshot, axis: usize) -> Vec<JointPoint> {
    let surface = &snapshot.surface;
    let of = |quad: &[u32; 4]| {
        let x = quad.map(|n| surface.points[n as usize]);
        let way = |a: usize, b: usize| [0, 1, 2].map(|i| x[b][i] - x[a][i]);
        let (p, q) = (way(0, 2), way(1, 3));
        let normal = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            0.5 * (p[j] * q[k] - p[k] * q[j])
        });
        let size = normal.map(f64::abs);
        let lie = if size[2] >= size[0].max(size[1]) {
            Lie::Bed
        } else if size[axis] >= size[1 - axis] {
            Lie::Head
        } else {
            Lie::Other
        };
        JointPoint {
            at: [0, 1, 2].map(|i| 0.25 * x.iter().map(|x| x[i]).sum::<f64>()),
            area: normal.iter().map(|n| n * n).sum::<f64>().sqrt(),
            lie,
        }
    };
    surface.quads.iter().map(of).collect()
}

/// Bed joints: points at one height.
fn beds(points: &[JointPoint], near: f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|p| points[*p].lie == Lie::Bed)
        .collect();
    order.sort_by(|a, b| points[*a].at[2].total_cmp(&points[*b].at[2]));
    let mut beds: Vec<Vec<usize>> = Vec::new();
    for p in order {
        let height = |q: usize| points[q].at[2];
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

/// Courses within the middle half of the height.
fn inner(model: &Model, [bottom, top]: [f64; 2]) -> Vec<Course> {
    let mesh = &model.mesh;
    let of_unit = unit_materials(model);
    let mut courses: BTreeMap<u16, Course> = BTreeMap::new();
    for (e, number) in mesh.course.iter().enumerate() {
        let course = courses.entry(*number).or_insert_with(|| Course {
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
    courses.into_values().filter(within).collect()
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
