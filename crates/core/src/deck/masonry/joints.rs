//! Joints of walls: contact between faces of units, with facets and laws of the interfaces.
//!
//! The mortar side is the slave (top of bed joints, far end of head joints, back of collar joints); in dry joints
//! the lower, left or front side. The opposite sides are masters.

use super::{Corner, Masonry, Unit};
use crate::deck::bodies::Bodies;
use crate::deck::body::Body;
use crate::deck::joint::law_between;
use crate::deck::meeting::Touching;
use crate::deck::pairing::TOUCHES;
use crate::deck::quantity::Quantity;
use crate::deck::schema::Deck;
use crate::element::hexahedron::{Face, range};
use crate::material::ElasticParameters;
use crate::model::Mesh;
use crate::model::scene::ContactSurfaces;
use crate::model::surfaces::JointSide;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use wythe_contact::{Aabb, Bvh};

/// Order of the slave faces of a body.
const SLAVES: [Face; 6] = [
    Face::Top,
    Face::Right,
    Face::Back,
    Face::Left,
    Face::Front,
    Face::Bottom,
];
/// Order of its master faces.
const MASTERS: [Face; 6] = [
    Face::Bottom,
    Face::Left,
    Face::Front,
    Face::Right,
    Face::Back,
    Face::Top,
];

/// Largest distance of faces that touch [mm].
const TOUCH: f64 = 1e-6;

/// Whether two ranges [mm] overlap by more than their ends may be rounded in a deck.
fn overlaps(a: [f64; 2], b: [f64; 2]) -> bool {
    let shorter = (a[1] - a[0]).min(b[1] - b[0]);
    overlap(a, b) > TOUCHES * shorter
}

/// Length that two ranges share [mm]; negative if they share none.
fn overlap(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[1].min(b[1]) - a[0].max(b[0])
}

/// A face of a unit as a rectangle.
struct Rectangle {
    wall: usize,
    body: usize,
    face: Face,
    plane: f64,
    /// Range along the two other axes [mm]. `[axis][low, high]`
    range: [[f64; 2]; 2],
    has_mortar: bool,
}

impl Rectangle {
    /// The face `own` of a unit, of which `all` is the box with its joints [mm]; it is the side `here` of this box.
    fn new(
        [wall, body]: [usize; 2],
        (own, here): (Face, Face),
        all: [[f64; 2]; 3],
        has_mortar: bool,
    ) -> Self {
        let (axis, high) = here.side();
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        Self {
            wall,
            body,
            face: own,
            plane: all[axis][usize::from(high)],
            range: others.map(|d| all[d]),
            has_mortar,
        }
    }

    /// Box around all faces that may touch this one.
    fn around(&self) -> Aabb {
        around(self.range, self.plane)
    }
}

/// Box around all rectangles that may touch this one, in a plane along its normal.
fn around([[a, b], [c, d]]: [[f64; 2]; 2], plane: f64) -> Aabb {
    let flat = Aabb {
        min: [a, c, plane],
        max: [b, d, plane],
    };
    flat.fattened(TOUCH)
}

/// Adds the joints of all walls to the surfaces; returns the bodies that touch.
pub(in crate::deck) fn joints(
    deck: &Deck,
    bodies: &Bodies<'_>,
    elastic: &[ElasticParameters],
    contact: &mut ContactSurfaces,
) -> Vec<Touching> {
    let pairs = touching(&bodies.walls);
    let mut masters: BTreeMap<(usize, usize), Vec<(usize, Face)>> = BTreeMap::new();
    let mut met: BTreeSet<(usize, usize)> = BTreeSet::new();
    let place = |order: &[Face; 6], face: Face| order.iter().position(|f| *f == face).unwrap_or(0);
    for (slave, master) in pairs {
        let key = (slave.0, place(&SLAVES, slave.1));
        masters.entry(key).or_default().push(master);
        met.insert((master.0, place(&MASTERS, master.1)));
    }
    let upright = upright(bodies);
    let mut joints = Joints {
        deck,
        bodies,
        mesh: &upright,
        elastic,
        contact,
        touching: Vec::new(),
    };
    for ((body, face), masters) in &mut masters {
        masters.sort_by_key(|(b, f)| (*b, *f as usize));
        joints.slaves(*body, SLAVES[*face], masters);
    }
    for (body, face) in met {
        let body = &bodies.all[body];
        for (_, facet) in &body.faces[MASTERS[face] as usize].facets {
            joints.contact.add_master(*facet, body.number);
        }
    }
    joints.mirrors();
    joints.touching
}

/// The mesh of the bodies with the units of walls where they were laid: joints are found along the axes of their wall.
fn upright<'a>(bodies: &'a Bodies<'_>) -> Cow<'a, Mesh> {
    let mut mesh = Cow::Borrowed(&bodies.mesh);
    for wall in &bodies.walls {
        if wall.placement.is_identity() {
            continue;
        }
        let nodes = &mut mesh.to_mut().nodes;
        for n in wall
            .bodies
            .clone()
            .flat_map(|body| bodies.all[body].nodes.clone())
        {
            let node = &mut nodes[n as usize];
            *node = wall.placement.to_laid(*node);
        }
    }
    mesh
}

/// Joints of walls that are being built.
struct Joints<'a> {
    deck: &'a Deck,
    bodies: &'a Bodies<'a>,
    /// The mesh with all walls upright.
    mesh: &'a Mesh,
    /// Constants of the materials by index.
    elastic: &'a [ElasticParameters],
    contact: &'a mut ContactSurfaces,
    touching: Vec<Touching>,
}

impl<'a> Joints<'a> {
    /// One side of a joint: material of an element, and its size normal to the joint [mm].
    fn side(&self, element: usize, size: f64) -> JointSide<'a> {
        let material = self.bodies.mesh.material[element];
        JointSide {
            material: &self.elastic[usize::from(material)],
            size,
        }
    }

    /// Adds the joints that planes of symmetry cut at their middle, where units meet the mirrors.
    fn mirrors(&mut self) {
        let (bodies, mesh) = (self.bodies, self.mesh);
        for (number, mirror) in (0_u32..).zip(&bodies.mirrors) {
            // No body has this number, so that the mirror is another body for all of them.
            self.contact.add_master(mirror.facet, u32::MAX - number);
            let wall = &bodies.walls[mirror.wall];
            let name = interface_at(wall, mirror.axis);
            let Some(interface) = self.deck.interfaces.get(name) else {
                continue; // rejected when the deck was read
            };
            for (unit, body) in wall.units.iter().zip(wall.bodies.clone()) {
                if !unit.mirror[mirror.axis] {
                    continue;
                }
                let body = &bodies.all[body];
                let joint = 2.0 * unit.joint(mirror.axis, mirror.face.side().1);
                for facet in facets(mesh, body, mirror.face, mirror.axis) {
                    // In the whole wall the mortar meets the image of the element behind the mortar.
                    let inner = behind(mesh, body, &facet, mirror.face).filter(|_| joint > 0.0);
                    let [here, there] = match inner {
                        None => [self.side(facet.element, facet.size); 2],
                        Some((element, size)) => {
                            [self.side(facet.element, joint), self.side(element, size)]
                        }
                    };
                    let law = law_between(self.contact, name, interface, here, there);
                    let law = mirrored_law(self.contact, law);
                    self.contact.add_slave(facet.nodes, body.number, law);
                }
            }
        }
    }

    /// Facets of a master face in the coordinates in which the wall of its slave is laid.
    fn facing(&self, wall: &Masonry<'_>, body: usize, face: Face, axis: usize) -> Vec<Facet> {
        let is_of = |corner: &&Corner| self.bodies.walls[corner.with].bodies.contains(&body);
        let corner = wall.corners.iter().find(is_of);
        let body = &self.bodies.all[body];
        let Some(corner) = corner else {
            return facets(self.mesh, body, face, axis);
        };
        let at = |n: u32| corner.point(self.mesh.nodes[n as usize]);
        let mut facets = facets_at(self.mesh, &at, body, face, axis);
        for facet in &mut facets {
            facet.sine = corner.sine();
        }
        facets
    }

    /// The element behind the facet that a slave facet faces, and its size [mm].
    fn behind_facing(&self, masters: &[(usize, Face)], facing: &Facet) -> Option<(usize, f64)> {
        let is_of = |(b, _): &&(usize, Face)| self.bodies.all[*b].number == facing.body;
        let (body, face) = masters.iter().find(is_of)?;
        behind(self.mesh, &self.bodies.all[*body], facing, *face)
    }

    /// Adds facets and laws of one slave face, a unit of a wall.
    fn slaves(&mut self, slave: usize, face: Face, masters: &[(usize, Face)]) {
        let (bodies, mesh) = (self.bodies, self.mesh);
        let Some(wall) = bodies.wall_of(slave) else {
            return;
        };
        let (axis, _) = face.side();
        let halves = masters.first().is_some_and(|m| wall.are_halves(slave, m.0));
        let crack = wall.wall.crack_interface.as_deref().filter(|_| halves);
        let name = crack.unwrap_or_else(|| interface_at(wall, axis));
        let Some(interface) = self.deck.interfaces.get(name) else {
            return; // rejected when the deck was read
        };
        let body = &bodies.all[slave];
        let others: Vec<Facet> = masters
            .iter()
            .flat_map(|(b, f)| self.facing(wall, *b, *f, axis))
            .collect();
        let boxes: Vec<Aabb> = others.iter().map(Facet::around).collect();
        let tree = Bvh::build(&boxes);
        let (mut stack, mut near) = (Vec::new(), Vec::new());
        let unit = &wall.units[slave - wall.bodies.start];
        for facet in &facets_in_order(mesh, body, face) {
            near.clear();
            tree.query(&boxes, &facet.around(), &mut stack, |i| {
                near.push(i as usize);
            });
            near.sort_unstable();
            let Some(facing) = most_covering(facet, near.iter().map(|i| &others[*i])) else {
                continue; // above an opening
            };
            // Along a wall, joints and units of a wall at an angle are thicker than across.
            let sine = if axis == wall.wall.axes().0 {
                facing.sine
            } else {
                1.0
            };
            let thickness = joint_thickness(wall, unit, face, sine);
            let here = self.side(facet.element, thickness.unwrap_or(sine * facet.size));
            // In the middle of a collar joint the mortar meets mortar. The joint has the stiffness of one at the face
            // of the unit behind.
            let halved = axis == wall.wall.axes().1 && thickness.is_some();
            let behind = halved.then(|| self.behind_facing(masters, facing));
            let (element, size) = behind.flatten().unwrap_or((facing.element, facing.size));
            let there = self.side(element, sine * size);
            let law = law_between(self.contact, name, interface, here, there);
            self.contact.add_slave(facet.nodes, body.number, law);
            let bodies = (body.number, facing.body);
            if self.touching.last().is_none_or(|t| t.bodies != bodies) {
                self.touching.push(Touching {
                    bodies,
                    interface: name.to_owned(),
                });
            }
        }
    }
}

/// Facets of a slave face. Those of bed joints run along the wall first, so that the points of a joint are
/// consecutive.
fn facets_in_order(mesh: &Mesh, body: &Body, face: Face) -> Vec<Facet> {
    let (axis, _) = face.side();
    let mut facets = facets(mesh, body, face, axis);
    if axis == 2 {
        let corner = |m: &Facet| (m.range[0][0], m.range[1][0]);
        facets.sort_by(|a, b| {
            corner(a)
                .partial_cmp(&corner(b))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
    }
    facets
}

/// The element of a body behind that of a facet, and its size normal to the facet [mm].
fn behind(mesh: &Mesh, body: &Body, facet: &Facet, face: Face) -> Option<(usize, f64)> {
    let (axis, _) = face.side();
    let opposite = Face::ALL[(face as usize) ^ 1].1.corners();
    let mut shared = opposite.map(|c| mesh.elements[facet.element][c]);
    shared.sort_unstable();
    let first = mesh.unit.partition_point(|u| *u < body.number);
    let own = (first..mesh.elements.len()).take_while(|e| mesh.unit[*e] == body.number);
    own.into_iter()
        .find(|e| {
            let mut corners = face.corners().map(|c| mesh.elements[*e][c]);
            corners.sort_unstable();
            corners == shared
        })
        .map(|e| {
            let x = mesh.elements[e].map(|n| mesh.nodes[n as usize][axis]);
            let [low, high] = range(x);
            (e, high - low)
        })
}

/// Index of the law of half a joint, see [`half`](wythe_contact::InterfaceLaw::half).
///
/// It keeps the name of the interface, so that its bond scatters like that of the others and `wythe check` reports
/// its stiffnesses.
fn mirrored_law(contact: &mut ContactSurfaces, law: u16) -> u16 {
    let whole = &contact.laws[usize::from(law)];
    // Every law of a deck has a half.
    let own = whole.half().unwrap_or_else(|| whole.clone());
    let name = contact.law_names[usize::from(law)].clone();
    let mut known = contact.laws.iter().zip(&contact.law_names);
    let found = known.position(|(l, n)| *n == name && *l == own);
    let index = found.unwrap_or_else(|| {
        contact.laws.push(own);
        contact.law_names.push(name);
        contact.laws.len() - 1
    });
    u16::try_from(index).unwrap_or(u16::MAX)
}

/// A face of a unit, by its body.
type UnitFace = (usize, Face);

/// Pairs of faces that touch: slave and master.
pub(super) fn touching(walls: &[Masonry<'_>]) -> Vec<(UnitFace, UnitFace)> {
    let mut pairs = Vec::new();
    for axis in 0..3 {
        let sides = |face: Face| -> Vec<Rectangle> {
            let sides = walls.iter().enumerate();
            sides
                .flat_map(|(w, wall)| sides_of(w, wall, face))
                .collect()
        };
        let faces = [2 * axis, 2 * axis + 1].map(|f| Face::ALL[f].1);
        let [lows, highs] = faces.map(sides);
        let is_joined = |low: &Rectangle, high: &Rectangle| {
            low.wall == high.wall || walls[low.wall].joined.contains(&high.wall)
        };
        pairs_of(&lows, &highs, is_joined, &mut pairs);
    }
    for (w, wall) in walls.iter().enumerate() {
        for corner in wall.corners.iter().filter(|corner| corner.with > w) {
            at_corner((w, wall), &walls[corner.with], corner, &mut pairs);
        }
    }
    pairs
}

/// Adds the pairs of faces of two walls that meet at an angle.
fn at_corner(
    (w, wall): (usize, &Masonry<'_>),
    other: &Masonry<'_>,
    corner: &Corner,
    pairs: &mut Vec<(UnitFace, UnitFace)>,
) {
    // The faces of the other wall in the coordinates in which the first one is laid.
    let turned = Face::ALL.map(|(_, face)| (corner.side(face), face));
    for axis in 0..3 {
        let faces = [2 * axis, 2 * axis + 1].map(|f| Face::ALL[f].1);
        let [lows, highs] = faces.map(|face| sides_of(w, wall, face));
        let of_other = |here: Face| -> Vec<Rectangle> {
            let faces = turned.iter().filter(|(side, _)| *side == here);
            let rectangle = |(unit, body): (&Unit, usize), own: Face| {
                let all = corner.of_box(unit.all);
                let (axis, high) = own.side();
                let has_mortar = unit.joint(axis, high) > 0.0;
                Rectangle::new([corner.with, body], (own, here), all, has_mortar)
            };
            let units = || other.units.iter().zip(other.bodies.clone());
            let of_face = |(_, own): &(Face, Face)| {
                let own = *own;
                units().map(move |unit| rectangle(unit, own))
            };
            faces.flat_map(of_face).collect()
        };
        let [facing_lows, facing_highs] = faces.map(of_other);
        pairs_of(&lows, &facing_highs, |_, _| true, pairs);
        pairs_of(&facing_lows, &highs, |_, _| true, pairs);
    }
}

/// Adds the pairs of low and high sides that touch and are joined.
fn pairs_of(
    lows: &[Rectangle],
    highs: &[Rectangle],
    is_joined: impl Fn(&Rectangle, &Rectangle) -> bool,
    pairs: &mut Vec<(UnitFace, UnitFace)>,
) {
    let boxes: Vec<Aabb> = lows.iter().map(Rectangle::around).collect();
    let tree = Bvh::build(&boxes);
    let (mut stack, mut near) = (Vec::new(), Vec::new());
    for high in highs {
        near.clear();
        tree.query(&boxes, &high.around(), &mut stack, |i| {
            near.push(i as usize);
        });
        for low in near.iter().map(|i| &lows[*i]) {
            if (low.plane - high.plane).abs() > TOUCH {
                continue;
            }
            let share = |d: usize| overlaps(high.range[d], low.range[d]);
            if low.body == high.body || !(share(0) && share(1)) {
                continue;
            }
            if !is_joined(low, high) {
                continue;
            }
            let (a, b) = ((high.body, high.face), (low.body, low.face));
            pairs.push(if low.has_mortar && !high.has_mortar {
                (b, a)
            } else {
                (a, b)
            });
        }
    }
}

/// This face of all units of wall number `w`, as they are laid.
fn sides_of(w: usize, wall: &Masonry<'_>, face: Face) -> Vec<Rectangle> {
    let (axis, high) = face.side();
    let units = wall.units.iter().zip(wall.bodies.clone());
    let of = |(unit, body): (&Unit, usize)| {
        let has_mortar = unit.joint(axis, high) > 0.0;
        Rectangle::new([w, body], (face, face), unit.all, has_mortar)
    };
    units.map(of).collect()
}

/// Interface of the joints normal to an axis.
fn interface_at<'a>(wall: &'a Masonry<'_>, axis: usize) -> &'a str {
    let (along, _) = wall.wall.axes();
    let own = match axis {
        2 => None,
        a if a == along => wall.wall.head_interface.as_ref(),
        _ => wall.wall.collar_interface.as_ref(),
    };
    own.unwrap_or(&wall.wall.interface)
}

/// Thickness of the joint at a face [mm], which is `sine` of what it is along the wall: the value of the deck if it agrees
/// to rounding, else the actual one; none without a joint. Units have half of a collar joint.
fn joint_thickness(wall: &Masonry<'_>, unit: &Unit, face: Face, sine: f64) -> Option<f64> {
    let (axis, high) = face.side();
    let wall = wall.wall;
    let whole = if axis == wall.axes().1 { 2.0 } else { 1.0 };
    let actual = whole * sine * unit.joint(axis, high);
    let collar = wall.collar_joint.unwrap_or(wall.head_joint);
    let said = [wall.bed_joint, wall.head_joint, collar].map(Quantity::get);
    let said = said.into_iter().find(|t| (t - actual).abs() <= 1e-9 * t);
    (actual > 0.0).then(|| said.unwrap_or(actual))
}

/// A facet of an axis-parallel face.
struct Facet {
    element: usize,
    nodes: [u32; 4],
    body: u32,
    material: u16,
    plane: f64,
    /// Range along the two other axes [mm], x before y before z. `[axis][low, high]`
    range: [[f64; 2]; 2],
    /// Size of the element normal to the face [mm].
    size: f64,
    /// Sine of the angle between its wall and that of the face which it faces.
    sine: f64,
}

impl Facet {
    /// Box around all facets that may touch this one.
    fn around(&self) -> Aabb {
        around(self.range, self.plane)
    }
}

/// Facets of a face normal to an axis.
fn facets(mesh: &Mesh, body: &Body, face: Face, axis: usize) -> Vec<Facet> {
    facets_at(mesh, &|n| mesh.nodes[n as usize], body, face, axis)
}

/// Facets of a face that is normal to an axis if the nodes are `at` these positions [mm].
fn facets_at(
    mesh: &Mesh,
    at: &dyn Fn(u32) -> [f64; 3],
    body: &Body,
    face: Face,
    axis: usize,
) -> Vec<Facet> {
    let others: [usize; 2] = match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    };
    let facets = body.faces[face as usize].facets.iter();
    let facets = facets.map(|(element, nodes)| {
        let extent = |nodes: &[u32], d: usize| range(nodes.iter().map(|n| at(*n)[d]));
        let depth = extent(&mesh.elements[*element], axis);
        Facet {
            element: *element,
            nodes: *nodes,
            body: body.number,
            material: mesh.material[*element],
            plane: at(nodes[0])[axis],
            range: others.map(|d| extent(nodes, d)),
            size: depth[1] - depth[0],
            sine: 1.0,
        }
    });
    facets.collect()
}

/// A facet of that body and material which cover the largest part of `facet`. None if no facet covers it.
fn most_covering<'a>(facet: &Facet, others: impl Iterator<Item = &'a Facet>) -> Option<&'a Facet> {
    let mut parts: Vec<(&'a Facet, f64)> = Vec::new();
    for other in others {
        let share = |d: usize| overlaps(facet.range[d], other.range[d]);
        if !(share(0) && share(1)) || (facet.plane - other.plane).abs() > TOUCH {
            continue;
        }
        let shared = [0, 1].map(|d| overlap(facet.range[d], other.range[d]));
        let area = shared[0] * shared[1];
        let alike = |m: &Facet| m.body == other.body && m.material == other.material;
        match parts.iter_mut().find(|(m, _)| alike(m)) {
            Some((_, sum)) => *sum += area,
            None => parts.push((other, area)),
        }
    }
    let mut best: Option<(&'a Facet, f64)> = None;
    for (part, area) in parts {
        if best.is_none_or(|(_, most)| area > most) {
            best = Some((part, area));
        }
    }
    best.map(|(part, _)| part)
}
