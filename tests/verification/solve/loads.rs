//! Named loads: nodal forces, tangents, beams under large rotation, energies, history.

use crate::common::Random;
use crate::common::scene::{self, Recording, completed};
use wythe::assembly::{Evaluation, Solids, System, Trial, Turning};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::Clock;

fn model(text: &str) -> Model {
    let deck = Deck::from_str(text, "scene.toml").unwrap_or_else(|e| panic!("{e}"));
    let (model, warnings) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    model
}

/// A block of 2 × 3 × 2 elements, fixed at its left face, with a pressure on these faces.
fn cube(on: &str, rotate: &str) -> String {
    format!(
        "format = 1\n[materials.stone]\nE = 1000\nnu = 0.2\n\
         [[blocks]]\nname = \"cube\"\nsize = [20, 30, 10]\nmaterial = \"stone\"\nmesh = [2, 3, 2]\n{rotate}\n\
         [[supports]]\non = \"cube.left\"\n\
         [[steps]]\nkind = \"load\"\nincrements = {{ initial = 1, max = 1 }}\n\
         [[steps.loads]]\nname = \"bag\"\non = {on}\npressure = 2\n"
    )
}

const ALL: &str =
    "[\"cube.left\", \"cube.right\", \"cube.front\", \"cube.back\", \"cube.top\", \"cube.bottom\"]";

/// Forces of the only load, with the given value, for nodes at `x`.
fn forces(system: &System, value: f64, x: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut force = vec![[0.0; 3]; x.len()];
    system.outside.add(0, [value, 0.0, 0.0], x, &mut force);
    force
}

fn sums(x: &[[f64; 3]], force: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let mut sums = [[0.0; 3]; 2];
    for (x, f) in x.iter().zip(force) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sums[0][i] += f[i];
            sums[1][i] += x[j] * f[k] - x[k] * f[j];
        }
    }
    sums
}

#[test]
fn a_pressure_all_around_a_body_has_no_resultant_however_it_is_deformed() {
    let model = model(&cube(ALL, ""));
    let system = System::new(&model).unwrap();
    let mut random = Random(7);
    let mut x = model.mesh.nodes.clone();
    for x in x.iter_mut().flatten() {
        *x += 2.0 * random.signed();
    }
    let [force, moment] = sums(&x, &forces(&system, 3.0, &x));
    // Tolerance: rounding of sums of some thousand N and N mm.
    assert!(force.iter().all(|f| f.abs() < 1e-10), "{force:?}");
    assert!(moment.iter().all(|m| m.abs() < 1e-8), "{moment:?}");
}

/// p A n of a flat face, at its original place and rotated by 40° about y as a whole.
#[test]
fn a_pressure_on_a_flat_face_pushes_against_its_normal() {
    let (p, area) = (2.0, 600.0);
    for angle in [0.0_f64, 40.0] {
        let rotate = format!("rotate = {{ axis = \"y\", angle = {angle} }}");
        let model = model(&cube("\"cube.top\"", &rotate));
        let system = System::new(&model).unwrap();
        let x = &model.mesh.nodes;
        let [force, _] = sums(x, &forces(&system, p, x));
        let (sin, cos) = angle.to_radians().sin_cos();
        let exact = [-p * area * sin, 0.0, -p * area * cos];
        for i in 0..3 {
            assert!((force[i] - exact[i]).abs() < 1e-10, "{force:?} {exact:?}"); // rounding
        }
        let direction = model.loads[0].direction;
        assert!((direction[2] + cos).abs() < 1e-12, "{direction:?}");
    }
}

/// In the undeformed state follower pressure, dead pressure and a traction against the normal are equal.
#[test]
fn a_dead_pressure_is_that_of_the_faces_at_rest() {
    let follower = cube("\"cube.top\"", "");
    let dead = follower.replace("pressure = 2", "pressure = 2\nfollower = false");
    let traction = follower.replace("pressure = 2", "traction = [0, 0, -2]");
    let mut random = Random(5);
    let rest = model(&follower).mesh.nodes;
    let mut x = rest.clone();
    for x in x.iter_mut().flatten() {
        *x += random.signed();
    }
    let of = |text: &str, value: [f64; 3], x: &[[f64; 3]]| {
        let system = System::new(&model(text)).unwrap();
        let mut force = vec![[0.0; 3]; x.len()];
        system.outside.add(0, value, x, &mut force);
        force
    };
    let at_rest = of(&follower, [2.0, 0.0, 0.0], &rest);
    for (text, value) in [(dead, [2.0, 0.0, 0.0]), (traction, [0.0, 0.0, -2.0])] {
        for (found, exact) in of(&text, value, &x).iter().zip(&at_rest) {
            for i in 0..3 {
                assert!((found[i] - exact[i]).abs() < 1e-11, "{found:?} {exact:?}"); // rounding
            }
        }
    }
}

/// The assembled stiffness is minus the derivative of the forces, and is symmetric for a closed surface.
#[test]
fn the_stiffness_of_a_follower_pressure_is_that_of_central_differences() {
    const H: f64 = 1e-3;
    for (on, closed) in [("[\"cube.top\", \"cube.right\"]", false), (ALL, true)] {
        // Nothing holds it along y and z, as a warning says.
        let held = "on = \"cube.left\"\nfixed = [\"x\"]";
        let text = cube(on, "").replace("on = \"cube.left\"", held);
        let deck = Deck::from_str(&text, "cube.toml").unwrap();
        let (model, warnings) = Model::from_deck(&deck).unwrap();
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        let mut system = System::new(&model).unwrap();
        let state = system.initial_state(&model);
        let mut random = Random(3);
        let q: Vec<f64> = state.q.iter().map(|_| random.signed()).collect();
        let n = q.len();
        let mut trial = Trial::default();
        system.start(&model, &mut trial, &state);
        trial.loads = vec![[5.0, 0.0, 0.0]];
        let columns = |turning: Turning, system: &mut System, trial: &mut Trial| -> Vec<Vec<f64>> {
            let setting = Evaluation {
                dt: 1.0,
                solids: Solids::Implicit,
                shifted: false,
                tangent: true,
                turning,
            };
            system
                .evaluate(&model, &state, trial, &q, setting, &mut Clock::default())
                .unwrap();
            let column = |j: usize| {
                let mut direction = vec![0.0; n];
                direction[j] = 1.0;
                system.multiply(trial, &direction)
            };
            (0..n).map(column).collect()
        };
        let without = columns(Turning::Ignored, &mut system, &mut trial);
        let exact = columns(Turning::Exact, &mut system, &mut trial);
        let at = |q: &[f64], system: &System| {
            let mut u = vec![[0.0; 3]; model.mesh.nodes.len()];
            system.dofs.spread(q, &mut u);
            let nodes = model.mesh.nodes.iter().zip(&u);
            let x: Vec<[f64; 3]> = nodes.map(|(x, u)| [0, 1, 2].map(|i| x[i] + u[i])).collect();
            system.follower_loads(&[[5.0, 0.0, 0.0]], &x)
        };
        let mut skew = 0.0_f64;
        for j in 0..n {
            let mut moved = q.clone();
            moved[j] = q[j] + H;
            let above = at(&moved, &system);
            moved[j] = q[j] - H;
            let below = at(&moved, &system);
            for i in 0..n {
                // The forces are quadratic in each coordinate: exact up to rounding of forces of 500 N over H, and of
                // stiffnesses of 1e5 N/mm that are subtracted.
                let slope = -(above[i] - below[i]) / (2.0 * H);
                let added = exact[j][i] - without[j][i];
                assert!((added - slope).abs() < 1e-9, "{i} {j}: {added} {slope}");
                let other = exact[i][j] - without[i][j];
                skew = skew.max((added - other).abs());
            }
        }
        assert_eq!(skew < 1e-8, closed, "{skew:e}");
    }
}

/// A strip of 400 × 10 × 4 mm fixed at x = 0, loaded in 20 increments.
fn strip(procedure: &str, loads: &str) -> Model {
    model(&format!(
        "format = 1\n[materials.steel]\nE = 2000\nnu = 0\ndensity = 1e-9\n\
         [[blocks]]\nname = \"strip\"\nsize = [400, 10, 4]\nmaterial = \"steel\"\nmesh = [80, 1, 1]\n\
         [[supports]]\non = \"strip.left\"\n\
         [[probes]]\nname = \"tip\"\non = \"strip.right\"\ndirection = \"z\"\n\
         [[probes]]\nname = \"end\"\non = \"strip.right\"\ndirection = \"x\"\n\
         [[steps]]\nkind = \"load\"\n{procedure}\n{loads}"
    ))
}

const SMALL: &str = "increments = { initial = 0.05, max = 0.05 }\ntolerance = { residual = 1e-6 }";

/// Final position of the strip's tip: [outwards, up] [mm].
fn tip(recording: &Recording) -> [f64; 2] {
    let last = recording.rows.last().unwrap();
    [last.probes[1], last.probes[0]]
}

/// An elastica of length L and bending stiffness B under q N/mm normal to its deformed axis. From the tip inwards,
/// with the axes of the tip: θ' = −M/B, M' = −t × P, P' = q n. Returns [outwards, up] of the tip.
fn elastica(length: f64, bending: f64, q: f64) -> [f64; 2] {
    // [x, y, θ, M, Px, Py]
    let rate = |y: [f64; 6]| {
        let (sin, cos) = y[2].sin_cos();
        [
            cos,
            sin,
            -y[3] / bending,
            -(cos * y[5] - sin * y[4]),
            -q * sin,
            q * cos,
        ]
    };
    let steps = 4000;
    let h = length / f64::from(steps);
    let mut y = [0.0; 6];
    let add = |y: [f64; 6], k: [f64; 6], by: f64| -> [f64; 6] {
        std::array::from_fn(|i| y[i] + by * k[i])
    };
    for _ in 0..steps {
        let k1 = rate(y);
        let k2 = rate(add(y, k1, 0.5 * h));
        let k3 = rate(add(y, k2, 0.5 * h));
        let k4 = rate(add(y, k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    let (sin, cos) = y[2].sin_cos();
    // From the root to the tip in the axes of the root: outwards is −t, up is n.
    let (dx, dy) = (-y[0], -y[1]);
    [-(cos * dx + sin * dy) - length, -sin * dx + cos * dy]
}

/// The same under a load of constant direction: the angle of the tip is found so that the root is level.
fn elastica_dead(length: f64, bending: f64, q: f64) -> [f64; 2] {
    let shoot = |angle: f64| {
        // θ'' B = q s cos θ from the tip (s = 0, θ = −angle, θ' = 0) to the root.
        let steps = 4000;
        let h = length / f64::from(steps);
        let rate =
            |s: f64, y: [f64; 4]| [y[2].cos(), y[2].sin(), y[3], q * s * y[2].cos() / bending];
        let mut y = [0.0, 0.0, -angle, 0.0];
        let add = |y: [f64; 4], k: [f64; 4], by: f64| -> [f64; 4] {
            std::array::from_fn(|i| y[i] + by * k[i])
        };
        for n in 0..steps {
            let s = h * f64::from(n);
            let k1 = rate(s, y);
            let k2 = rate(s + 0.5 * h, add(y, k1, 0.5 * h));
            let k3 = rate(s + 0.5 * h, add(y, k2, 0.5 * h));
            let k4 = rate(s + h, add(y, k3, h));
            y = std::array::from_fn(|i| {
                y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            });
        }
        y
    };
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shoot(middle)[2] > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let y = shoot(low);
    // s runs inwards: x decreases along it.
    [y[0] - length, -y[1]]
}

/// q L³/B = 6: the tip rotates by 56° under follower pressure, less under dead pressure.
#[test]
fn a_strip_under_pressure_bends_as_the_elastica() {
    let bending = 2000.0 * 10.0 * 64.0 / 12.0;
    let q = 6.0 * bending / 400.0_f64.powi(3);
    let pressure = q / 10.0;
    let (follower, dead) = (
        elastica(400.0, bending, q),
        elastica_dead(400.0, bending, q),
    );
    assert!(follower[1] > 1.05 * dead[1], "{follower:?} {dead:?}");
    // A dead load acts half above and half below the axis; otherwise its lever arm would increase with the rotation.
    let half = 0.5 * pressure;
    let traction = format!("on = [\"strip.bottom\", \"strip.top\"]\ntraction = [0, 0, {half}]");
    let bag = format!("on = \"strip.bottom\"\npressure = {pressure}");
    for (follows, exact, load) in [(true, follower, bag), (false, dead, traction)] {
        let loads = format!("[[steps.loads]]\nname = \"bag\"\n{load}\n");
        for tangent in ["secant", "consistent", "direct"] {
            let rules = format!("{SMALL}\nprocedure = \"static\"\ntangent = \"{tangent}\"");
            let recording = completed(&strip(&rules, &loads));
            let found = tip(&recording);
            println!("{follows} {tangent}: {found:?} exact {exact:?}");
            // Elements of 5 mm, and the pressure on the face below the axis: 0.5 % each.
            for i in 0..2 {
                assert!(
                    (found[i] / exact[i] - 1.0).abs() < 5e-3,
                    "{found:?} {exact:?}"
                );
            }
            let last = recording.rows.last().unwrap();
            assert!(
                scene::gap(last).abs() < 1e-3 * last.external_work_J,
                "{last:?}"
            );
            // Displacement and force of the load give its work.
            let mut work = 0.0;
            let mut before = [0.0; 2];
            for row in &recording.rows {
                work += 0.5 * (before[1] + row.force_kN) * (row.displacement_mm - before[0]);
                before = [row.displacement_mm, row.force_kN];
            }
            if !follows {
                let done = last.external_work_J;
                assert!((work / done - 1.0).abs() < 1e-9, "{work} {done}"); // the same sums
            }
        }
    }
}

/// Columns of a support that holds all directions: base shear and three reactions.
const OF_SUPPORT: usize = 4;

/// Three ways of loading the end of the strip by 0.01 N: deflection P L³/(3 B).
#[test]
fn forces_at_points_and_along_lines_bend_a_strip_as_a_beam() {
    let bending = 2000.0 * 10.0 * 64.0 / 12.0;
    let exact = 1e-2 * 400.0_f64.powi(3) / (3.0 * bending);
    for load in [
        "on = \"strip.right\"\nforce = [0, 0, \"10 mN\"]",
        "from = [400, 0, 0]\nto = [400, 10, 0]\nline_force = [0, 0, 1e-3]",
        "from = [400, 0, 2]\nto = [400, 10, 2]\nwithin = \"2.1 mm\"\nforce = [0, 0, \"10 mN\"]",
        "on = \"strip.right\"\ntraction = [0, 0, 2.5e-4]",
    ] {
        let loads = format!("[[steps.loads]]\nname = \"pull\"\n{load}\n");
        let recording = completed(&strip(SMALL, &loads));
        let last = recording.rows.last().unwrap();
        // Tolerance: shear and discretisation, a thousandth.
        assert!(
            (last.probes[0] / exact - 1.0).abs() < 2e-3,
            "{load}: {last:?}"
        );
        // The column of the force is the last before those of the support.
        let force = last.probes[last.probes.len() - 1 - OF_SUPPORT];
        assert!((force / 1e-5 - 1.0).abs() < 1e-12, "{load}: {force}");
        // The reaction of the support is opposite to the load.
        let support = last.reactions[0];
        assert!((support[2] + 1e-2).abs() < 1e-5, "{load}: {support:?}");
    }
    // A point load acts on the nearest node.
    let loads =
        "[[steps.loads]]\nname = \"pull\"\nnear = [399, 0.1, 0]\nforce = [0, 0, \"10 mN\"]\n";
    let last = completed(&strip(SMALL, loads)).rows.last().unwrap().clone();
    assert!((last.probes[0] / exact - 1.0).abs() < 2e-3, "{last:?}");
}

/// A load remains in later steps, changes if its name is repeated, and is removed by 0.
#[test]
fn a_load_remains_until_its_name_is_repeated() {
    let loads = "[[steps.loads]]\nname = \"a\"\non = \"strip.right\"\nforce = [0, 0, 0.01]\n\
         [[steps.loads]]\nname = \"b\"\non = \"strip.right\"\nforce = [0, 0.02, 0]\n\
         [[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"a\"\nforce = [0, 0, 0.03]\n\
         [[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"a\"\nforce = [0, 0, 0]\n";
    let recording = completed(&strip(SMALL, loads));
    let last_of = |step: usize| recording.rows.iter().rfind(|r| r.step == step).unwrap();
    for (step, [a, b]) in [[1e-5, 2e-5], [3e-5, 2e-5], [0.0, 2e-5]]
        .into_iter()
        .enumerate()
    {
        let row = last_of(step);
        // Those of the support follow.
        let [_, _, force_a, force_b, ..] = row.probes[..] else {
            panic!("{row:?}")
        };
        assert!(
            (force_a - a).abs() < 1e-18 && (force_b - b).abs() < 1e-18,
            "{row:?}"
        );
    }
    // Without `a` the strip is level again: 0.02 N sideways leave only the tolerance.
    let up = last_of(2).probes[0];
    assert!(up.abs() < 1e-3 * last_of(1).probes[0], "{up}");
}

/// A pressure that is controlled by the tip's displacement, or by time with inertia, ends at the same place.
#[test]
fn an_airbag_is_controlled_by_a_displacement_or_by_inertia() {
    let loads = |p: f64| {
        format!("[[steps.loads]]\nname = \"bag\"\non = \"strip.bottom\"\npressure = {p}\n")
    };
    let steered = "procedure = \"displacement_control\"\ncontrol = { probe = \"tip\", displacement = 100 }\n\
         increments = { initial = 0.05, max = 0.05 }\ntolerance = { residual = 1e-6 }";
    let recording = completed(&strip(steered, &loads(1e-3)));
    let last = recording.rows.last().unwrap();
    assert!((last.probes[0] - 100.0).abs() < 1e-9, "{last:?}"); // the constraint is exact
    let pressure = last.probes[2];
    assert!((pressure / (last.load_factor * 1e-3) - 1.0).abs() < 1e-12);
    // The history has columns for probe and force.
    assert_eq!(last.displacement_mm, last.probes[0]);
    for procedure in ["static", "implex", "quasi_static", "dynamic"] {
        let rules = format!("{SMALL}\nprocedure = \"{procedure}\"\nduration = 200");
        let text = loads(pressure);
        let found = completed(&strip(&rules, &text)).rows.last().unwrap().probes[0];
        println!("{procedure}: {found}");
        // Slow enough for inertia of a thousandth; the rest is the tolerance.
        assert!((found / 100.0 - 1.0).abs() < 2e-3, "{procedure}: {found}");
    }
}

/// The example: beyond the peak secant and consistent tangents follow the same path and end where the rocking strip
/// is in equilibrium.
#[test]
fn a_strip_under_an_airbag_goes_past_its_peak() {
    let mut curves = Vec::new();
    for tangent in ["secant", "consistent"] {
        let deck = crate::common::examples::load("40_airbag", &[("steps.1.tangent", tangent)]);
        let (model, warnings) = Model::from_deck(&deck).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        let recording = completed(&model);
        let work = recording
            .rows
            .iter()
            .map(|r| r.external_work_J)
            .fold(0.0, f64::max);
        let open = recording
            .rows
            .iter()
            .map(|r| scene::gap(r).abs())
            .fold(0.0, f64::max);
        println!("{tangent}: balance {:.1e}", open / work);
        assert!(open < 5e-3 * work, "{tangent}: {open} of {work}");
        // Columns: the probe, the roof's force, the airbag's pressure and force.
        let rows = recording.rows.iter().filter(|r| r.step == 1);
        let curve: Vec<[f64; 2]> = rows.map(|r| [r.displacement_mm, r.probes[2]]).collect();
        for row in &recording.rows {
            assert_eq!(row.displacement_mm, row.probes[0]);
        }
        let held = recording.rows.last().unwrap().probes[1];
        assert!((held - 1.0).abs() < 1e-12, "the roof stays: {held}");
        curves.push(curve);
    }
    let peak = |curve: &[[f64; 2]]| curve.iter().map(|p| p[1]).fold(0.0, f64::max);
    let [secant, consistent] = [peak(&curves[0]), peak(&curves[1])];
    println!("peaks {secant} {consistent} MPa");
    // 4/3 (f_t + N/A) (t/H)² = 6.25 kPa opens the joint; its softening doubles that. Both tangents solve the same
    // equations with tolerances of 5e-2 and 5e-3 of a nodal force.
    assert!(secant > 6.25e-3 && (secant / consistent - 1.0).abs() < 1e-2);
    for curve in &curves {
        let [u, p] = *curve.last().unwrap();
        // A rigid strip on its edge: 8 N (t/2 - u)/(b H²). The contact of Gauss points lies 0.21 · 25 mm inside the
        // edge.
        let arm = 50.0 - 0.211 * 25.0 - u;
        let exact = 8.0 * 1e3 * arm / (100.0 * 800.0 * 800.0);
        println!("{p} {exact}");
        assert!((p / exact - 1.0).abs() < 3e-2, "{p} {exact}");
    }
}

/// A point load on a wall, at a node without prescribed displacement, and on its beam.
#[test]
fn a_wall_takes_point_and_line_loads() {
    let steps = "[[steps]]\nkind = \"preload\"\ntop_pressure = 0.5\n\
         [[steps]]\nkind = \"load\"\n\
         [[steps.loads]]\nname = \"jack\"\nnear = [210, 49, 125]\nforce = [0, 500, 0]\n\
         [[steps.loads]]\nname = \"kerb\"\nfrom = [0, 0, 50]\nto = [203, 0, 50]\nwithin = 1\nline_force = [0, 1, 0]\n";
    let text = std::fs::read_to_string(crate::common::examples::path("03_shear_wall_j7d")).unwrap();
    let (head, _) = text.split_once("[[steps]]").unwrap();
    let overrides = [
        ("wall.courses", "4"),
        ("wall.length", "420.5 mm"),
        ("wall.unit", "[204, 49, 50]"),
        ("wall.mesh", "[5, 2, 1]"),
    ];
    let overrides = overrides.map(|(k, v)| (k.to_owned(), v.to_owned()));
    let deck = Deck::from_str_with(&format!("{head}{steps}"), "wall.toml", &overrides).unwrap();
    let model = Model::from_deck(&deck).unwrap().0;
    let recording = completed(&model);
    let last = recording.rows.last().unwrap();
    let [beam, support, jack, kerb] = last.reactions[..] else {
        panic!("{:?}", last.reactions)
    };
    assert!(
        (jack[1] - 500.0).abs() < 1e-9 && kerb[1] > 100.0,
        "{jack:?} {kerb:?}"
    );
    let sum = beam[1] + support[1] + jack[1] + kerb[1];
    assert!(sum.abs() < 1.0, "out of balance by {sum} N"); // of 700 N; the tolerance of forces
    assert!(scene::gap(last).abs() < 5e-3 * last.external_work_J.abs());
}
