//! Path following: the load is unknown, and equilibrium is followed where the load decreases.

use crate::common::scene::{self, Face, Recording, completed};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::probes::Probe;
use wythe::model::probes::ProbeQuantity;
use wythe::model::scene::{Control, Gravity, Increments, Procedure, Step, Tangent};
use wythe::state::{HistoryRow, Method, Status};

/// The bar of the atlas with other steps.
fn bar(steps: &str) -> Recording {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/stability/cases/01-snap-back-bar"
    );
    let text = std::fs::read_to_string(format!("{folder}/deck.toml")).unwrap();
    let (scene, _) = text.split_once("[[steps]]").unwrap();
    let deck = Deck::from_str(&format!("{scene}{steps}"), "bar.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    completed(&model)
}

/// Force of the interface as a function of its opening [mm], 100 × 100 mm of Table 1 [kN].
fn softened(opening: f64) -> f64 {
    let (f_t, u_k, zeta) = (0.28, 0.2, 4.38_f64);
    let q = (1.0 - (-zeta * opening / u_k).exp()) / (1.0 - (-zeta).exp());
    f_t * (1.0 - q) * 1e4 * 1e-3
}

const OPENING: &str = r#"
[[probes]]
name = "opening"
on = "right.left"
minus = "left.right"
direction = "x"
"#;

#[test]
fn the_opening_of_a_crack_controls_the_load_through_a_snap_back() {
    let recording = bar(&format!(
        r#"{OPENING}
        [[steps]]
        kind = "drive"
        face = "right.right"
        direction = "x"
        displacement = "0.094 mm"
        [[steps]]
        kind = "drive"
        face = "right.right"
        direction = "x"
        displacement = "0.1 mm"
        procedure = "displacement_control"
        control = {{ probe = "opening", displacement = "0.15 mm" }}
        "#
    ));
    let rows: Vec<_> = recording.rows.iter().filter(|r| r.step == 1).collect();
    assert!(
        rows.iter()
            .all(|r| r.procedure == Method::DisplacementControl)
    );
    for row in rows.iter().filter(|r| r.probes[0] > 1e-3) {
        let exact = softened(row.probes[0]);
        // Tolerance: the residual, for a force that is distributed over eight nodes.
        assert!(
            (row.force_kN - exact).abs() < 5e-3 * 2.8,
            "{} mm: {} {exact}",
            row.probes[0],
            row.force_kN
        );
        // The end follows from the opening and the elongation of the bar of 1000 mm with 2970 MPa.
        let end = row.probes[0] + row.force_kN * 1e3 / 1e4 * 1000.0 / 2970.0;
        assert!((row.displacement_mm - end).abs() < 1e-3 * 0.1, "{end}");
        assert!((0.094 + row.load_factor * 0.1 - row.displacement_mm).abs() < 1e-12);
    }
    // The displacement turns back and forward again: the opening increases steadily to its end.
    let turns = rows
        .windows(2)
        .filter(|w| w[1].load_factor < w[0].load_factor);
    assert!(turns.count() > 5);
    let before = recording.rows.iter().rfind(|r| r.step == 0);
    let way = rows.last().unwrap().probes[0] - before.unwrap().probes[0];
    assert!((way - 0.15).abs() < 1e-9, "{way}"); // rounding of increments that add up
}

#[test]
fn dissipation_traces_the_snap_back_and_static_takes_over_again() {
    for procedure in ["dissipation", "auto"] {
        let recording = bar(&format!(
            r#"{OPENING}
            [[steps]]
            kind = "drive"
            face = "right.right"
            direction = "x"
            displacement = "0.19 mm"
            procedure = "{procedure}"
            "#
        ));
        let rows = &recording.rows;
        let ends = rows.iter().map(|r| r.displacement_mm);
        let open = rows.iter().filter(|r| r.probes[0] > 0.02);
        // The turning point of snapback_bar.csv: 0.07814 mm at an opening of 0.0337 mm.
        let turn = open.map(|r| r.displacement_mm).fold(1.0, f64::min);
        assert!((turn / 0.07814 - 1.0).abs() < 5e-3, "{procedure}: {turn}");
        assert!(ends.fold(0.0, f64::max) > 0.189);
        let used = |method| rows.iter().any(|r| r.procedure == method);
        assert!(used(Method::Dissipation) && used(Method::Static));
        for row in rows.iter().filter(|r| r.probes[0] > 1e-3) {
            // Tolerance: the residual.
            let exact = softened(row.probes[0]);
            assert!((row.force_kN - exact).abs() < 1e-2 * 2.8, "{procedure}");
        }
    }
}

/// Half of a fixed shallow arch of 1 m with a thickness of 10 mm and a rise of 40 mm; its weight increases.
fn shallow_arch(how: Procedure, increments: Increments) -> Model {
    let mut model = scene::empty();
    let solid = scene::heavy(1e4, 0.0, 1e-7);
    let strip = scene::block(
        &mut model,
        [0.0; 3],
        [500.0, 10.0, 10.0],
        [16, 1, 2],
        &solid,
    );
    for x in &mut model.mesh.nodes {
        let s = x[0] / 1000.0;
        x[2] += 160.0 * s * (1.0 - s);
    }
    scene::hold(&mut model, strip.face(Face::Left), [true; 3]);
    scene::hold(&mut model, strip.face(Face::Right), [true, false, false]);
    scene::hold(&mut model, strip.nodes(), [false, true, false]);
    model.probes.push(Probe {
        column: "crown_mm".to_owned(),
        nodes: strip.face(Face::Right),
        minus: Vec::new(),
        direction: [0.0, 0.0, -1.0],
        quantity: ProbeQuantity::Displacement,
        over: 1.0,
    });
    model.steps = vec![Step {
        procedure: how,
        tangent: Tangent::Consistent,
        control: (how == Procedure::DisplacementControl).then_some(Control {
            probe: 0,
            displacement: 90.0,
        }),
        increments,
        ..scene::left_alone(Gravity::Growing([0.0, 0.0, -4e4]), 1.0, 100, 1e-3)
    }];
    model
}

/// Increments that grow from `initial` to `max`.
fn increments(initial: f64, max: f64, peak: f64) -> Increments {
    Increments {
        initial,
        max,
        min: 1e-6,
        peak,
    }
}

#[test]
fn an_arch_snaps_through_and_both_controls_of_its_weight_agree() {
    let curve = |how| {
        let model = shallow_arch(how, increments(0.01, 0.01, 1.0));
        let rows = completed(&model).rows;
        let points = rows.iter().map(|r| [r.probes[0], r.load_factor]);
        points.collect::<Vec<_>>()
    };
    let [controlled, followed] = [Procedure::DisplacementControl, Procedure::ArcLength].map(curve);
    let limit = |curve: &[[f64; 2]]| {
        let early = curve.iter().filter(|p| p[0] < 40.0);
        early.map(|p| p[1]).fold(0.0, f64::max)
    };
    let trough = |curve: &[[f64; 2]]| {
        let late = curve.iter().filter(|p| p[0] > 30.0 && p[0] < 80.0);
        late.map(|p| p[1]).fold(f64::INFINITY, f64::min)
    };
    println!(
        "limit {} {}, trough {} {}",
        limit(&controlled),
        limit(&followed),
        trough(&controlled),
        trough(&followed)
    );
    // The arch snaps: the load decreases strongly.
    assert!(trough(&controlled) < 0.5 * limit(&controlled));
    // Each curve has the extreme within the spacing of its points.
    assert!((limit(&followed) / limit(&controlled) - 1.0).abs() < 1e-2);
    let scale = limit(&controlled);
    assert!((trough(&followed) - trough(&controlled)).abs() < 2e-2 * scale);
    // Arc length reaches the full load.
    assert!((followed.last().unwrap()[1] - 1.0).abs() < 1e-9);
}

#[test]
fn increments_are_short_where_the_load_has_its_peak() {
    // Elastic, so that the error of the peak comes from the increments alone: (limit, number of increments to 30 mm).
    let limit = |sizes| {
        let rows = completed(&shallow_arch(Procedure::DisplacementControl, sizes)).rows;
        let early: Vec<_> = rows.iter().filter(|r| r.probes[0] < 30.0).collect();
        let most = early.iter().map(|r| r.load_factor).fold(0.0, f64::max);
        (most, early.len())
    };
    let (exact, _) = limit(increments(0.002, 0.002, 1.0));
    for size in [0.039, 0.041] {
        let (passed_over, few) = limit(increments(size, size, 1.0));
        let (seen, more) = limit(increments(size, size, 0.005));
        println!(
            "{size}: {} in {few}, {} in {more}",
            passed_over / exact,
            seen / exact
        );
        assert!(passed_over < 0.991 * exact, "{size}");
        // Tolerance: the required accuracy and the residual.
        assert!(
            seen > (1.0 - 0.005 - 1e-3) * exact,
            "{size}: {seen} {exact}"
        );
        // An increment that passed the peak is repeated in parts, and the following increments are short at first.
        assert!(more <= few + 3, "{size}: {few} {more}");
    }
}

/// A bond that breaks within 3 µm is pulled and sheared over millimetres: the first increment ends beyond its peak.
#[test]
fn a_peak_within_the_first_increments_is_seen() {
    let most = |name: &str, step: &str, way: &str, peak: &str| {
        let way = (format!("{step}.displacement"), way.to_owned());
        let peak = (format!("{step}.increments.peak"), peak.to_owned());
        let set = [way, peak];
        let set: Vec<(&str, &str)> = set.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        let (model, _) = Model::from_deck(&crate::common::examples::load(name, &set)).unwrap();
        let rows = completed(&model).rows;
        rows.iter().map(|r| r.force_kN).fold(0.0, f64::max)
    };
    let (torn, sheared) = ("01_couplet_tension", "02_couplet_shear");
    // f_t A, of which nonuniform stress takes half a per cent; the peak control allows another half.
    let bond = 0.28e-3 * 204.0 * 98.0;
    for way in ["0.2 mm", "0.4 mm", "1 mm", "5 mm", "50 mm"] {
        let seen = most(torn, "steps.0", way, "0.005");
        println!("{way}: {:.4} of the bond", seen / bond);
        assert!(seen > 0.99 * bond && seen < bond, "{way}: {seen}");
    }
    assert!(most(torn, "steps.0", "5 mm", "1") < 0.7 * bond);
    let slowly = most(sheared, "steps.1", "0.6 mm", "0.005");
    for way in ["3 mm", "6 mm", "20 mm", "50 mm"] {
        let seen = most(sheared, "steps.1", way, "0.005");
        println!("{way}: {:.4} of that over 0.6 mm", seen / slowly);
        assert!((seen / slowly - 1.0).abs() < 0.01, "{way}: {seen} {slowly}");
    }
    assert!(most(sheared, "steps.1", "6 mm", "1") < 0.95 * slowly);
}

/// The peak of a strong joint lies within one increment of a step, or within the first of a later one: the same peak
/// is found.
#[test]
fn no_increment_hides_a_peak_however_the_drive_is_divided() {
    let torn = |first: Option<f64>, way: f64| {
        let path = crate::common::examples::path("01_couplet_tension");
        let mut text = std::fs::read_to_string(path).unwrap();
        if let Some(first) = first {
            let whole = "displacement = \"0.25 mm\"";
            assert!(text.contains(whole));
            text = text.replace(whole, &format!("displacement = \"{first} mm\""));
            text += "\n[[steps]]\nkind = \"drive\"\ndirection = \"z\"\ndisplacement = 1\n";
        }
        let last = usize::from(first.is_some());
        let set = [
            ("interfaces.joint.f_t".to_owned(), "2".to_owned()),
            ("interfaces.joint.c".to_owned(), "5".to_owned()),
            (format!("steps.{last}.displacement"), way.to_string()),
        ];
        let deck = Deck::from_str_with(&text, "couplet.toml", &set).unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let rows = completed(&model).rows;
        rows.iter().map(|r| r.force_kN).fold(0.0, f64::max)
    };
    // Nonuniform stress takes two per cent of f_t A = 39.98 kN; increments of 6e-5 mm give 39.17 kN.
    let exact = 39.17;
    let runs = [
        (None, 0.2),
        (None, 1.0),
        (None, 20.0),
        (Some(0.003), 5.0),
        (Some(0.01), 0.25),
        (Some(0.01), 50.0),
    ];
    for (first, way) in runs {
        let seen = torn(first, way);
        println!("{first:?} {way}: {:.4}", seen / exact);
        // Half a per cent is required; the estimate may err by as much again.
        assert!((seen / exact - 1.0).abs() < 0.01, "{first:?} {way}: {seen}");
    }
}

/// A bar of two elements that crack together, 1 MPa on 50 by 50 mm: peaks in solids are found as well as those in
/// joints.
#[test]
fn no_increment_hides_the_strength_of_a_bar() {
    for way in [0.1, 0.5, 2.0, 10.0] {
        let deck = format!(
            "format = 1\n[materials.mortar]\nE = 3000\nnu = 0\n\
             tension = [[1, 0, 0], [0.1, 0.02, 0.9]]\n\
             compression = [[8, 0, 0], [10, 0.002, 0], [1, 0.02, 0.9]]\n\
             [[blocks]]\nname = \"bar\"\nsize = [50, 50, 100]\nmaterial = \"mortar\"\nmesh = [1, 1, 2]\n\
             [[supports]]\non = \"bar.bottom\"\n\
             [[steps]]\nkind = \"drive\"\nface = \"bar.top\"\ndirection = \"z\"\ndisplacement = {way:?}\n"
        );
        let deck = Deck::from_str(&deck, "bar.toml").unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let rows = completed(&model).rows;
        let seen = rows.iter().map(|r| r.force_kN).fold(0.0, f64::max);
        println!("{way}: {seen}");
        // `increments.peak` is half a per cent.
        assert!((seen / 2.5 - 1.0).abs() < 0.005, "{way}: {seen}");
    }
}

#[test]
fn a_displacement_finds_its_pressure() {
    let deck = r#"
        format = 1
        [materials.stone]
        E = 5000
        nu = 0
        [[blocks]]
        name = "block"
        size = [100, 100, 200]
        material = "stone"
        mesh = [2, 2, 2]
        [[supports]]
        on = "block.bottom"
        [[probes]]
        name = "top"
        on = "block.top"
        direction = "-z"
        [[steps]]
        kind = "preload"
        face = "block.top"
        pressure = 2
        procedure = "displacement_control"
        control = { probe = "top", displacement = 0.2 }
    "#;
    let deck = Deck::from_str(deck, "block.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let rows = completed(&model).rows;
    // E ε = 5 MPa, out of 2 MPa; ε/2 of geometric stiffness and the tolerance.
    let factor = rows.last().unwrap().load_factor;
    assert!((factor / 2.5 - 1.0).abs() < 2e-3, "{factor}");
}

#[test]
fn a_control_must_be_a_probe_of_displacement() {
    let deck = |control: &str| {
        let text = format!(
            "format = 1\n[materials.stone]\nE = 5000\nnu = 0\n[[blocks]]\nname = \"block\"\n\
             size = [100, 100, 200]\nmaterial = \"stone\"\n[[supports]]\non = \"block.bottom\"\n\
             [[probes]]\nname = \"top\"\non = \"block.top\"\ndirection = \"z\"\n\
             [[probes]]\nname = \"speed\"\non = \"block.top\"\ndirection = \"z\"\n\
             quantity = \"velocity\"\n[[steps]]\nkind = \"preload\"\nface = \"block.top\"\n\
             pressure = 2\n{control}\n"
        );
        match Deck::from_str(&text, "block.toml") {
            Ok(deck) => Model::from_deck(&deck).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        }
    };
    let steer = |probe: &str| {
        format!(
            "procedure = \"displacement_control\"\ncontrol = {{ probe = \"{probe}\", displacement = 1 }}"
        )
    };
    assert!(deck(&steer("tip")).contains("no probe named `tip`"));
    assert!(deck(&steer("speed")).contains("measures a velocity"));
    assert!(deck("procedure = \"displacement_control\"").contains("which displacement"));
    assert!(
        deck("control = { probe = \"top\", displacement = 1 }")
            .contains("belongs to the procedure")
    );
    assert!(deck("procedure = \"implex\"\ntangent = \"direct\"").contains("secant stiffness"));
}

/// A cantilever with a cap, whose end is pushed sideways by a load that its displacement steers. A brick hangs from it by
/// its bond; a post beside the brick stops it, so that the bond breaks and the brick falls.
const HANGING_BRICK: &str = r#"
format = 1

[materials.elastic]
E = "1000 MPa"
nu = 0.0
density = "2000 kg/m^3"

[interfaces.bond]
f_t = "0.05 MPa"
c = "0.05 MPa"
tan_phi = 0.5
mu = 0.0
zeta = 4.38
xi = 1.1
G_I = "0.002 N/mm"
G_II = "0.002 N/mm"

[[blocks]]
name = "beam"
size = [300, 50, 50]
at = [0, 0, 100]
mesh = [6, 1, 1]
material = "elastic"

[[blocks]]
name = "brick"
size = [50, 50, 50]
at = [250, 0, 50]
mesh = [1, 1, 1]
material = "elastic"

[[blocks]]
name = "post"
size = [50, 50, 50]
at = [250, 50, 50]
mesh = [1, 1, 1]
material = "elastic"

[[blocks]]
name = "cap"
size = [200, 50, 50]
at = [100, 0, 150]
mesh = [1, 1, 1]
material = "elastic"

[[contacts]]
slave = "brick.top"
master = "beam.bottom"
interface = "bond"

[[contacts]]
slave = "cap.bottom"
master = "beam.top"
interface = "mortar"

[[contacts]]
slave = "brick.back"
master = "post.front"
interface = "smooth"

[interfaces.mortar]
f_t = "1 MPa"
c = "1 MPa"
tan_phi = 0.5
mu = 0.5
zeta = 4.38
xi = 1.1
G_I = "0.1 N/mm"
G_II = "0.5 N/mm"

[interfaces.smooth]
f_t = "0 MPa"
c = "0 MPa"
tan_phi = 0.0
mu = 0.0

[[supports]]
on = "beam.left"
[[supports]]
on = "post"

[[probes]]
name = "tip"
on = "beam.right"
direction = "y"

[[steps]]
kind = "gravity"

[[steps]]
kind = "load"
procedure = "displacement_control"
control = { probe = "tip", displacement = 2 }
[[steps.loads]]
name = "push"
on = "beam.right"
force = [0, "10 N", 0]
"#;

#[test]
fn inertia_carries_a_brick_that_falls_while_a_displacement_steers_the_load() {
    let deck = Deck::from_str(HANGING_BRICK, "brick.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let (recording, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let used = |method| recording.rows.iter().any(|r| r.procedure == method);
    assert!(used(Method::DisplacementControl) && used(Method::QuasiStatic));
    let fallen = &summary.fall.as_ref().unwrap().bodies;
    assert_eq!(fallen.len(), 1);
    assert_eq!(fallen[0].name, "brick");
    // The cantilever is elastic: after the brick has gone the load is proportional to the displacement.
    let after: Vec<_> = recording
        .rows
        .iter()
        .filter(|r| r.probes[0] > 1.0)
        .collect();
    let stiffness = |row: &HistoryRow| row.load_factor / row.probes[0];
    let last = after[after.len() - 1];
    let before = recording.rows.iter().rfind(|r| r.step == 0).unwrap();
    let way = last.probes[0] - before.probes[0];
    assert!((way - 2.0).abs() < 1e-9, "{way}"); // rounding of increments that add up
    for row in after {
        // Waves of the blow by which the brick left the post.
        let ratio = stiffness(row) / stiffness(last);
        assert!((ratio - 1.0).abs() < 5e-3, "{ratio}");
    }
}

#[test]
fn a_brick_on_which_the_steered_load_acts_ends_the_run_where_it_falls() {
    let pulled =
        "[[steps.loads]]\nname = \"pull\"\non = \"brick.bottom\"\nforce = [0, 0, \"-0.01 N\"]\n";
    let deck = Deck::from_str(&format!("{HANGING_BRICK}{pulled}"), "brick.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let (recording, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Collapsed, "{}", summary.message);
    let fallen = summary.fall.as_ref().unwrap();
    assert_eq!(fallen.bodies.len(), 1);
    assert_eq!(fallen.bodies[0].name, "brick");
    // It has moved by a tenth of its edge at least, and the drive is not at its end.
    assert!(fallen.bodies[0].moved_mm > 5.0);
    let end = 2.0; // mm, of the drive
    assert!(recording.rows.last().unwrap().probes[0] < 0.95 * end);
}
