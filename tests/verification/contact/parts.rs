//! Facets divided into parts: more than four points per element in a joint that bends.

use crate::common::blocks::deck_and_model;
use crate::common::scene::{completed, run};
use wythe::assembly::Contact;
use wythe::model::Model;
use wythe::state::Status;

/// A block of one element on another element, compressed and then pushed at its top.
///
/// The blocks are nearly rigid, so that only the dry joint deforms: k = 1,000 N/mm³ compared with E/h = 1e6.
fn pushed(points: &str, parts: u32, push: f64) -> Model {
    let text = format!(
        r#"format = 1
[materials.stone]
E = 1e8
nu = 0
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 2
mu = 2
normal_stiffness = 1000
shear_stiffness = 1000
[contact]
points = "{points}"
parts = [{parts}, 1, 1]
[[blocks]]
name = "base"
size = [100, 100, 100]
at = [0, 0, -100]
material = "stone"
mesh = [1, 1, 1]
[[blocks]]
name = "block"
size = [100, 100, 100]
material = "stone"
mesh = [1, 1, 1]
[[contacts]]
slave = "block.bottom"
master = "base.top"
interface = "dry"
[[supports]]
on = "base.bottom"
[[probes]]
name = "heel"
near = [0, 0, 100]
direction = "z"
[[probes]]
name = "toe"
near = [100, 0, 100]
direction = "z"
[[steps]]
kind = "load"
procedure = "static"
loads = [{{ name = "weight", on = "block.top", pressure = 1.0 }}]
[[steps]]
kind = "load"
procedure = "static"
loads = [{{ name = "weight", on = "block.top", pressure = 1.0 }}, {{ name = "push", on = "block.top", traction = [{push}, 0, 0] }}]
increments = {{ initial = 0.1, max = 0.1 }}
tolerance = {{ residual = 1e-6 }}
"#
    );
    deck_and_model(&text).1
}

/// Rotation of a rigid block of 100 × 100 mm on rows of springs without tension, each with its share of the area, under
/// 1 MPa at an eccentricity [mm].
/// The compressed rows are those beyond a certain one; for each such set the two equilibrium equations are solved.
fn rotation_on_rows(rows: &[(f64, f64)], eccentricity: f64) -> f64 {
    let whole = 1000.0 * 100.0 * 100.0;
    let force = 1.0 * 100.0 * 100.0;
    for pressed in (1..=rows.len()).rev() {
        let rows = &rows[rows.len() - pressed..];
        let sum = |power: i32| {
            whole
                * rows
                    .iter()
                    .map(|(y, share)| share * y.powi(power))
                    .sum::<f64>()
        };
        let (s0, s1, s2) = (sum(0), sum(1), sum(2));
        // Springs with a + θ y > 0 are compressed: Σ = N, Σ y = N e.
        let determinant = s0 * s2 - s1 * s1;
        if pressed == 1 {
            break;
        }
        let sink = force * (s2 - eccentricity * s1) / determinant;
        let turn = force * (eccentricity * s0 - s1) / determinant;
        if sink + turn * rows[0].0 >= 0.0 {
            return turn;
        }
    }
    f64::NAN
}

/// For a load outside the middle third the joint opens. With two rows of points the outer row lies 28.9 mm from the
/// middle, and a load beyond it overturns the block. With sixteen rows the block rotates as on a bed of springs
/// without tension: 60 of its 100 mm are compressed under a load 20 mm from the toe.
#[test]
fn the_rotation_of_an_open_joint_converges_with_its_rows_of_points() {
    const E: f64 = 30.0;
    // The compressed length is c = 3 (b/2 − e), the compression at the toe 2 N / (k b c).
    let along = 3.0 * (50.0 - E);
    let exact = 2.0 * 1e4 / (1000.0 * 100.0 * along) / along;
    let g = 1.0 / 3.0_f64.sqrt();
    let gauss = [(-g, 0.5), (g, 0.5)];
    // Lobatto points with their weights, which dry joints have.
    let (inner, outer) = (1.0 / 5.0_f64.sqrt(), 1.0 - 5e-7);
    let lobatto =
        [(-outer, 1.0), (-inner, 5.0), (inner, 5.0), (outer, 1.0)].map(|(y, w)| (y, w / 12.0));
    let cases = [
        ("gauss", 2, &gauss[..], 0.05),
        ("gauss", 4, &gauss, 0.02),
        ("gauss", 8, &gauss, 0.006),
        ("auto", 1, &lobatto, 0.03),
        ("auto", 2, &lobatto, 0.03),
        ("auto", 4, &lobatto, 0.006),
    ];
    for (points, parts, rule, off) in cases {
        let model = pushed(points, parts, E / 100.0);
        let recording = completed(&model);
        let probes = &recording.rows.last().unwrap().probes;
        let turned = (probes[0] - probes[1]) / 100.0;
        let half = 50.0 / f64::from(parts);
        let at = |i: u32, (y, share): (f64, f64)| {
            (
                -50.0 + half * (f64::from(2 * i + 1) + y),
                share / f64::from(parts),
            )
        };
        let rows: Vec<(f64, f64)> = (0..parts)
            .flat_map(|i| rule.iter().map(move |point| at(i, *point)))
            .collect();
        let on_rows = rotation_on_rows(&rows, E);
        println!("{points} {parts}: {turned:e}, on rows {on_rows:e}, exact {exact:e}");
        // The block tilts by 6e-5, which moves its load by 0.006 of 30 mm; the blocks deform by 1e-3 of the joint.
        assert!(
            (turned / on_rows - 1.0).abs() < 3e-3,
            "{points} {parts}: {turned:e} {on_rows:e}"
        );
        // Errors of composite quadrature for a line with a kink: 3.7, 1.6 and 0.5 %, and 2.9, 2.8 and 0.6 % of
        // Lobatto points, by the equations above.
        assert!(
            (on_rows / exact - 1.0).abs() < off,
            "{points} {parts}: {on_rows:e} {exact:e}"
        );
    }
    let (_, falls) = run(&pushed("gauss", 1, E / 100.0));
    assert_ne!(falls.status, Status::Completed);
}

/// The points of parts lie where those of elements of the same size would be, with the same areas.
#[test]
fn parts_are_sampled_as_elements_of_their_size() {
    let text = |mesh: &str, parts: &str| {
        let text = include_str!("../../../examples/01_couplet_tension.toml");
        let text = text.replace("[wall]\n", &format!("[wall]\nmesh = {mesh}\n"));
        format!("{text}\n[contact]\nparts = {parts}\n")
    };
    let sampled = |mesh: &str, parts: &str| {
        let (_, model) = deck_and_model(&text(mesh, parts));
        let contact = Contact::new(&model);
        let mut points: Vec<[f64; 4]> = (contact.points.iter().enumerate())
            .map(|(p, point)| {
                let nodes = model.contact.slave_facets[p / 4];
                let at = |d: usize| {
                    let x = nodes.map(|n| model.mesh.nodes[n as usize][d]);
                    x.iter().zip(point.weights).map(|(x, w)| x * w).sum::<f64>()
                };
                [at(0), at(1), at(2), point.area]
            })
            .collect();
        // Sorted in an order that rounding does not change.
        points.sort_by_key(|point| point.map(|x| (1e6 * x).round() as i64));
        (points, contact.reach())
    };
    let (elements, _) = sampled("[4, 2, 3]", "[1, 1, 1]");
    let (parts, reach) = sampled("[4, 2, 1]", "[1, 3, 1]");
    assert_eq!(elements.len(), parts.len());
    for (a, b) in elements.iter().zip(&parts) {
        for i in 0..4 {
            assert!((a[i] - b[i]).abs() < 1e-9, "{a:?} {b:?}"); // rounding of 100 mm
        }
    }
    // The search radius depends on the mesh, not on the parts.
    assert_eq!(reach, sampled("[4, 2, 1]", "[1, 1, 1]").1);
}
