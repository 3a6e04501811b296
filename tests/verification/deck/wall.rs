//! Geometry of generated walls: volumes, counts, interfaces, bats.

use std::collections::HashSet;

use crate::common::boxes::{bodies, element_box, volume};
use crate::common::examples::load;
use wythe::contact::JointLaw;
use wythe::model::{Mesh, Model};

fn example(name: &str, overrides: &[(&str, &str)]) -> Model {
    Model::from_deck(&load(name, overrides)).unwrap().0
}

fn j7d(overrides: &[(&str, &str)]) -> Model {
    example("03_shear_wall_j7d.toml", overrides)
}

/// Rectangle of an axis-parallel facet: axis and sign of its normal, its plane, and its extent along the other two
/// axes.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    axis: usize,
    sign: f64,
    plane: f64,
    low: [f64; 2],
    high: [f64; 2],
}

impl Rectangle {
    fn new(mesh: &Mesh, facet: [u32; 4]) -> Self {
        let p = facet.map(|n| mesh.nodes[n as usize]);
        let edge = |i: usize| [0, 1, 2].map(|d| p[i][d] - p[0][d]);
        let (a, b) = (edge(1), edge(3));
        let normal = [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ];
        let axis = (0..3)
            .max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))
            .unwrap();
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let (low, high) = (
            others.map(|d| p[0][d].min(p[2][d])),
            others.map(|d| p[0][d].max(p[2][d])),
        );
        Self {
            axis,
            sign: normal[axis].signum(),
            plane: p[0][axis],
            low,
            high,
        }
    }

    fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    /// Area over which it faces `other` without a gap.
    fn facing(&self, other: &Self) -> f64 {
        // coordinates are sums of a few lengths, with rounding of some 1e-13 mm
        if self.axis != other.axis
            || self.sign == other.sign
            || (self.plane - other.plane).abs() > 1e-9
        {
            return 0.0;
        }
        let overlap =
            |d: usize| (self.high[d].min(other.high[d]) - self.low[d].max(other.low[d])).max(0.0);
        overlap(0) * overlap(1)
    }
}

struct Surfaces {
    slave: Vec<(Rectangle, u32)>,
    master: Vec<(Rectangle, u32)>,
}

fn surfaces(model: &Model) -> Surfaces {
    let c = &model.contact;
    let side = |facets: &[[u32; 4]], body: &[u32]| {
        facets
            .iter()
            .zip(body)
            .map(|(&f, &b)| (Rectangle::new(&model.mesh, f), b))
            .collect()
    };
    Surfaces {
        slave: side(&c.slave_facets, &c.slave_body),
        master: side(&c.master_facets, &c.master_body),
    }
}

#[test]
fn the_coarse_wall_is_counted_by_hand() {
    let model = j7d(&[]);
    let mesh = &model.mesh;
    // 18 courses of 4 whole units and a bat.
    assert_eq!(bodies(mesh).len(), 90);
    // Bat on the right: 4 REs of 20, bat of round(4 × 124/204) = 2 by (1 + 1) by 2, no head joint: 88.
    // Bat on the left: bat with head joint 3 × 2 × 2, 3 of 20, one without head joint 16: 88.
    // The top course has no bed joints: 44.
    assert_eq!(mesh.elements.len(), 17 * 88 + 44);
    // Slave facets: beds 11 × 2 columns on 17 courses; heads 4 a course, 2 × 2 facets (top: 1 × 2).
    // A bed of 5 REs: either 4 × 5 + 2 or 3 + 3 × 5 + 4 = 22 columns.
    let facets = 17 * 22 * 2 + 17 * 4 * 2 * 2 + 4 * 2;
    assert_eq!(model.contact.slave_facets.len(), facets);
    assert_eq!(model.contact.slave_body.len(), facets);
    assert_eq!(model.contact.slave_law.len(), facets);
    assert_eq!(model.contact.law_names.len(), model.contact.laws.len());
}

#[test]
fn a_whole_representative_element_has_20_or_108_elements() {
    for (mesh, count) in [("coarse", 20), ("fine", 108)] {
        let model = j7d(&[("wall.mesh", mesh)]);
        // the first unit of the first course is whole and has both joints
        assert_eq!(
            model.mesh.unit.iter().filter(|&&u| u == 0).count(),
            count,
            "{mesh}"
        );
    }
}

#[test]
fn volumes_of_brick_and_mortar_are_those_of_the_wall() {
    for (length, whole, bat) in [("990 mm", 4.0, 124.0), ("961.75 mm", 4.0, 95.75)] {
        for mesh in ["coarse", "fine", "[5, 3, 2]"] {
            let model = j7d(&[("wall.length", length), ("wall.mesh", mesh)]);
            let mesh = &model.mesh;
            let of = |m: u16| -> f64 {
                (0..mesh.elements.len())
                    .filter(|&e| mesh.material[e] == m)
                    .map(|e| volume(element_box(mesh, e)))
                    .sum()
            };
            let wall = (whole * 216.5 + bat) * 98.0 * (18.0 * 50.0 + 17.0 * 12.5);
            let brick = 18.0 * (whole * 204.0 + bat) * 50.0 * 98.0;
            // thousands of products and sums in double precision
            assert!(
                (of(0) - brick).abs() < 1e-10 * brick,
                "{length}: brick {}",
                of(0)
            );
            assert!(
                (of(0) + of(1) - wall).abs() < 1e-10 * wall,
                "{length}: wall {}",
                of(0) + of(1)
            );
        }
    }
}

#[test]
fn bodies_share_no_node_and_do_not_overlap() {
    let model = j7d(&[]);
    let mesh = &model.mesh;
    let mut owner = vec![None; mesh.nodes.len()];
    for (e, nodes) in mesh.elements.iter().enumerate() {
        assert!(volume(element_box(mesh, e)) > 0.0);
        for &n in nodes {
            assert_eq!(*owner[n as usize].get_or_insert(mesh.unit[e]), mesh.unit[e]);
        }
    }
    assert!(
        owner.iter().all(Option::is_some),
        "a node belongs to no element"
    );
    let boxes = bodies(mesh);
    // The nodes of a body do not coincide: each body is connected.
    let places: HashSet<[u64; 4]> = (0..mesh.nodes.len())
        .map(|n| {
            let [x, y, z] = mesh.nodes[n].map(f64::to_bits);
            [x, y, z, u64::from(owner[n].unwrap())]
        })
        .collect();
    assert_eq!(places.len(), mesh.nodes.len());
    for (a, first) in boxes.iter().enumerate() {
        for second in &boxes[a + 1..] {
            // bodies touch; sums of lengths may differ by 1e-13 mm
            let apart = (0..3)
                .any(|d| first[1][d] <= second[0][d] + 1e-9 || second[1][d] <= first[0][d] + 1e-9);
            assert!(apart, "{first:?} and {second:?} overlap");
        }
    }
}

#[test]
fn node_order_is_vtks() {
    let model = j7d(&[]);
    for e in 0..model.mesh.elements.len() {
        let c = model.mesh.corners(e);
        let [a, b] = element_box(&model.mesh, e);
        let expected = [
            [a[0], a[1], a[2]],
            [b[0], a[1], a[2]],
            [b[0], b[1], a[2]],
            [a[0], b[1], a[2]],
            [a[0], a[1], b[2]],
            [b[0], a[1], b[2]],
            [b[0], b[1], b[2]],
            [a[0], b[1], b[2]],
        ];
        assert_eq!(c, expected);
    }
}

#[test]
fn every_slave_faces_masters_of_other_bodies_over_its_whole_area() {
    for mesh in ["coarse", "fine"] {
        for length in ["990 mm", "961.75 mm", "853.5 mm"] {
            let model = j7d(&[
                ("wall.mesh", mesh),
                ("wall.length", length),
                ("wall.courses", "4"),
            ]);
            let s = surfaces(&model);
            let facing = |(a, body): &(Rectangle, u32), others: &[(Rectangle, u32)]| -> f64 {
                others
                    .iter()
                    .filter(|o| o.1 != *body)
                    .map(|o| a.facing(&o.0))
                    .sum()
            };
            for slave in &s.slave {
                // a dozen overlaps of exact lengths
                assert!((facing(slave, &s.master) - slave.0.area()).abs() < 1e-9 * slave.0.area());
            }
            for master in &s.master {
                assert!(
                    (facing(master, &s.slave) - master.0.area()).abs() < 1e-9 * master.0.area()
                );
            }
            // Normals point out of the bodies: slaves up or to +x, masters down or to −x.
            assert!(s.slave.iter().all(|(r, _)| r.sign > 0.0 && r.axis != 1));
            assert!(s.master.iter().all(|(r, _)| r.sign < 0.0 && r.axis != 1));
        }
    }
}

#[test]
fn interfaces_have_the_area_of_all_beds_and_heads() {
    let model = j7d(&[]);
    let s = surfaces(&model);
    let total = |side: &[(Rectangle, u32)]| side.iter().map(|f| f.0.area()).sum::<f64>();
    // 17 beds over the length; 4 heads in each of 18 courses, in 17 of them with the height of unit and bed.
    let area = 17.0 * 990.0 * 98.0 + 4.0 * 98.0 * (17.0 * 62.5 + 50.0);
    // thousands of sums in double precision
    assert!((total(&s.slave) - area).abs() < 1e-10 * area);
    assert!((total(&s.master) - area).abs() < 1e-10 * area);
}

/// Lengths of the units of a course from left to right, without their head joints.
fn unit_lengths(model: &Model, course: u16) -> Vec<f64> {
    let mesh = &model.mesh;
    let mut units: Vec<(f64, f64)> = Vec::new();
    let first = mesh.course.iter().position(|&c| c == course).unwrap();
    let last = mesh.course.iter().rposition(|&c| c == course).unwrap();
    for unit in mesh.unit[first]..=mesh.unit[last] {
        let bricks = (first..=last).filter(|&e| mesh.unit[e] == unit && mesh.material[e] == 0);
        let ends = bricks
            .map(|e| element_box(mesh, e))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |r, b| {
                (r.0.min(b[0][0]), r.1.max(b[1][0]))
            });
        units.push(ends);
    }
    units.iter().map(|(a, b)| b - a).collect()
}

fn assert_lengths(model: &Model, course: u16, expected: &[f64]) {
    let found = unit_lengths(model, course);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        // differences of coordinates below 1000 mm
        assert!((a - b).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn bats_are_cut_to_the_length_and_mirrored() {
    let wall = j7d(&[]);
    for course in 0..18 {
        let mut lengths = vec![204.0, 204.0, 204.0, 204.0, 124.0];
        if course % 2 == 1 {
            lengths.reverse();
        }
        assert_lengths(&wall, course, &lengths);
    }
    // n + ½ units: the bat is a half unit, (204 − 12.5)/2
    let half_bond = j7d(&[("wall.length", "961.75 mm")]);
    assert_lengths(&half_bond, 0, &[204.0, 204.0, 204.0, 204.0, 95.75]);
    assert_lengths(&half_bond, 1, &[95.75, 204.0, 204.0, 204.0, 204.0]);
    // whole units: halves at both ends of the odd courses
    let whole = j7d(&[("wall.length", "853.5 mm")]);
    assert_lengths(&whole, 0, &[204.0; 4]);
    assert_lengths(&whole, 1, &[95.75, 204.0, 204.0, 204.0, 95.75]);
    // one unit: a prism
    let prism = j7d(&[("wall.length", "204 mm"), ("wall.courses", "5")]);
    assert_lengths(&prism, 0, &[204.0]);
    assert_lengths(&prism, 1, &[204.0]);
}

#[test]
fn clamped_courses_are_held_without_their_beds() {
    let model = j7d(&[]);
    let z = |n: &u32| model.mesh.nodes[*n as usize][2];
    let support = &model.supports[0];
    assert_eq!(support.fixed, [true; 3]);
    assert!(support.nodes.iter().all(|n| z(n) <= 50.0));
    let beam = &model.beams[0];
    let top = 18.0 * 50.0 + 17.0 * 12.5;
    assert!(beam.nodes.iter().all(|n| z(n) >= top - 50.0 - 1e-9));
    // exact products
    assert_eq!(beam.area, 990.0 * 98.0);
    // all nodes of the course: 22 columns and 5 ends along x, 3 through, 2 up (the beds of the bottom course are
    // free)
    assert_eq!(support.nodes.len(), (22 + 5) * 3 * 2);
    assert_eq!(beam.nodes.len(), (22 + 5) * 3 * 2);
    let free = model.mesh.nodes.len() - 2 * (22 + 5) * 6;
    // during the preload the beam moves freely only in the vertical direction
    assert_eq!(wythe::model::sizes::sizes(&model).dofs, 3 * free + 1);
}

#[test]
fn a_couplet_is_held_by_its_faces() {
    let model = example("01_couplet_tension.toml", &[]);
    let z = |n: &u32| model.mesh.nodes[*n as usize][2];
    assert_eq!(bodies(&model.mesh).len(), 2);
    assert!(model.supports[0].nodes.iter().all(|n| z(n) == 0.0));
    // 50 + 15 + 50 mm, exact in double precision
    assert!(model.beams[0].nodes.iter().all(|n| z(n) == 115.0));
    assert_eq!(model.supports[0].nodes.len(), 15);
    assert_eq!(model.beams[0].nodes.len(), 15);
    let area: f64 = surfaces(&model).slave.iter().map(|f| f.0.area()).sum();
    // a sum of eight exact areas
    assert!((area - 204.0 * 98.0).abs() < 1e-9);
}

#[test]
fn penalties_follow_the_softer_side_of_each_face() {
    let model = j7d(&[]);
    let s = surfaces(&model);
    let law = |f: usize| &model.contact.laws[model.contact.slave_law[f] as usize];
    // 50 for joints of walls with mortar, instead of 500 of theory/joint.md, eq. 32
    // (docs/decisions/penalty-of-mortar-joints.md)
    let expected = |stiffness: f64| [50.0 * stiffness, 50.0 * stiffness / 2.3];
    let mut corners = 0;
    for (f, (r, _)) in s.slave.iter().enumerate() {
        let [normal, shear] = law(f).stiffness();
        // Bed joint, or head joint against brick: 850/12.5 (here no bed facet lies mostly below a head joint). A
        // corner against the next bed joint: an element of 51 mm, or of 62 mm in a bat.
        let height = r.high[1] - r.low[1];
        let candidates = if r.axis == 0 && (height - 12.5).abs() < 1e-9 {
            corners += 1;
            [850.0 / 51.0, 850.0 / 62.0, f64::NAN]
        } else {
            [850.0 / 12.5, f64::NAN, f64::NAN]
        };
        let hit = candidates.iter().any(|&c| {
            let [n, s] = expected(c);
            // element sizes are differences of coordinates near 1000 mm
            (normal - n).abs() < 1e-9 * n && (shear - s).abs() < 1e-9 * s
        });
        assert!(hit, "facet {f} {r:?}: {normal}, {shear}");
    }
    assert_eq!(corners, 17 * 4 * 2);
    // in-plane values for 500: 34000 and 14783 N/mm³ (the latter rounded)
    let theory = j7d(&[("interfaces.joint.penalty_factor", "500")]);
    assert!(
        theory
            .contact
            .laws
            .iter()
            .map(JointLaw::stiffness)
            .any(|[normal, shear]| normal == 34000.0 && shear.round() == 14783.0)
    );
    // each law is stored once: mortar bed or head, corner against a whole unit's bed, against a bat's
    assert_eq!(model.contact.laws.len(), 3);
}

#[test]
fn explicit_stiffnesses_are_taken_as_they_are() {
    let model = j7d(&[
        ("interfaces.joint.normal_stiffness", "200"),
        ("interfaces.joint.shear_stiffness", "100 N/mm^3"),
    ]);
    assert_eq!(model.contact.laws.len(), 1);
    assert_eq!(model.contact.laws[0].stiffness(), [200.0, 100.0]);
}
