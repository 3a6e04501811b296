//! Amplitudes: turning points, hysteresis of friction, inertia, rejected input.

use crate::common::scene::{completed, gap, run};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::{HistoryRow, Status};

fn built(text: &str) -> Result<Model, wythe::error::ModelError> {
    Deck::from_str(text, "scene.toml")
        .and_then(|deck| Model::from_deck(&deck))
        .map(|m| m.0)
}

fn model(text: &str) -> Model {
    built(text).unwrap_or_else(|e| panic!("{e}"))
}

const MU: f64 = 0.6;
/// Pressure [MPa] on 100 × 100 mm.
const PRESSURE: f64 = 0.24;
/// k_s over the area [N/mm].
const STIFFNESS: f64 = 2e2 * 1e4;

/// A nearly rigid block of 100 × 100 × 50 mm on a base, compressed and driven in x.
fn slider(step: &str) -> String {
    format!(
        "format = 1\n[materials.stone]\nE = 1e8\nnu = 0\ndensity = \"2000 kg/m^3\"\n\
         [interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = {MU}\nmu = {MU}\nnormal_stiffness = 400\nshear_stiffness = 200\n\
         [[blocks]]\nname = \"base\"\nsize = [200, 100, 50]\nat = [-50, 0, -50]\nmaterial = \"stone\"\n\
         [[blocks]]\nname = \"block\"\nsize = [100, 100, 50]\nmaterial = \"stone\"\n\
         [[contacts]]\nslave = \"block.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
         [[supports]]\non = \"base\"\n\
         [[steps]]\nkind = \"preload\"\nface = \"block.top\"\npressure = {PRESSURE}\n\
         [[steps]]\nkind = \"drive\"\nface = \"block.top\"\ndirection = \"x\"\nfree = [\"z\"]\n{step}\n"
    )
}

/// The dissipation is 4 μN (a − u) per cycle of amplitude a with the elastic slip u = μN/k, and μN u less on the
/// first loading branch.
#[test]
fn a_cyclically_driven_block_dissipates_the_area_of_its_loops() {
    let force = MU * PRESSURE * 1e4;
    let elastic = force / STIFFNESS;
    for procedure in ["auto", "static", "implex", "quasi_static", "dynamic"] {
        for drive in [
            "cycles = { amplitudes = [\"1 mm\", \"2 mm\"], repeat = 2 }",
            "displacement = 2\namplitude = [[0, 0], [0.05, 0.5], [0.15, -0.5], [0.25, 0.5], [0.35, -0.5], [0.4, 0], \
             [0.5, 1], [0.65, -1], [0.8, 1], [0.95, -1], [1, 0]]",
        ] {
            // Slow: the block has a mass of one kilogram and a period of a millisecond.
            let text = slider(&format!(
                "{drive}\nprocedure = \"{procedure}\"\nduration = 100\nincrements = {{ initial = 1e-4, max = 2e-3 }}"
            ));
            let model = model(&text);
            let recording = completed(&model);
            let rows: Vec<&HistoryRow> = recording.rows.iter().filter(|r| r.step == 1).collect();
            // Every turning point is reached; the block is at rest at the end.
            let tips = |way: f64| {
                let met = |r: &&&HistoryRow| (r.displacement_mm - way).abs() < 1e-12;
                rows.iter().filter(met).count()
            };
            for way in [1.0, -1.0, 2.0, -2.0] {
                assert!(
                    tips(way) >= 2,
                    "{procedure}: {way} mm is met {} times",
                    tips(way)
                );
            }
            let last = rows.last().unwrap();
            assert!(last.displacement_mm.abs() < 1e-12, "{last:?}");
            let cycles = 2.0 * (1.0 - elastic) + 2.0 * (2.0 - elastic);
            let exact = 1e-3 * force * (4.0 * cycles - elastic);
            let error = last.interface_dissipation_J / exact - 1.0;
            let open = gap(last) / last.external_work_J;
            println!(
                "{procedure}: {} rows, loops {error:.1e}, balance {open:.1e}",
                rows.len()
            );
            // By the trapezoidal rule the first increment after each of eight turning points does no work: 2.4 µm
            // minus 2u, of 24 mm. The rest is the equilibrium tolerance and inertia.
            assert!(error.abs() < 1e-3, "{procedure}: {error:e}");
            assert!(open.abs() < 1e-3, "{procedure}: {open:e}");
            let most = rows.iter().map(|r| r.force_kN.abs()).fold(0.0, f64::max);
            assert!(
                (most / (1e-3 * force) - 1.0).abs() < 5e-3,
                "{procedure}: {most}"
            );
        }
    }
}

/// The golden path of the law in mode II under 0.5 MPa, one increment per row, for a joint of 100 × 100 mm between
/// two blocks.
#[test]
fn a_joint_follows_the_golden_cyclic_path() {
    let golden = crate::common::csv("golden/itf_T1_mode2_cyclic.csv");
    let (ways, shear) = (&golden["d1_mm"], &golden["tau1_be_MPa"]);
    let law = "f_t = 0.28\nc = 0.87\ntan_phi = 1.01\nmu = 0.73\nzeta = 4.38\nxi = 1.1\nu_k = 0.2\ndelta_k = 0.4\n\
         normal_stiffness = 99000\nshear_stiffness = 43043.47826086957\n";
    let most = ways.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
    // The path starts at rest; rows without a change are omitted.
    let mut rows = vec![[0.0, 0.0]];
    let mut places = Vec::new();
    for (way, shear) in ways.iter().zip(shear) {
        let factor = way / most;
        if factor != rows[rows.len() - 1][1] {
            rows.push([rows.len() as f64, factor]);
            places.push(*shear);
        }
    }
    let last = rows.len() as f64 - 1.0;
    let table: Vec<String> = rows
        .iter()
        .map(|[t, f]| format!("[{}, {f}]", t / last))
        .collect();
    let step = format!(
        "displacement = {most}\namplitude = [{}]\nincrements = {{ initial = 1, max = 1, peak = 1 }}\n\
         procedure = \"static\"\ntangent = \"direct\"\ntolerance = {{ residual = 1e-5 }}",
        table.join(", ")
    );
    let text = slider(&step);
    let (head, tail) = text.split_once("[interfaces.dry]").unwrap();
    let (_, tail) = tail.split_once("[[blocks]]").unwrap();
    let text = format!("{head}[interfaces.dry]\n{law}[[blocks]]{tail}");
    let text = text.replace(&format!("pressure = {PRESSURE}"), "pressure = 0.5");
    let recording = completed(&model(&text));
    let found: Vec<&HistoryRow> = recording.rows.iter().filter(|r| r.step == 1).collect();
    assert_eq!(found.len(), places.len(), "an increment a row");
    let mut worst = 0.0_f64;
    for (row, shear) in found.iter().zip(&places) {
        worst = worst.max((row.force_kN * 1e3 / 1e4 - shear).abs());
    }
    println!("{} rows, off by {worst:.1e} MPa", places.len());
    // The blocks deform by 2e-6 mm, which softening turns into 1e-5 MPa; the rest is the equilibrium tolerance.
    assert!(worst < 5e-5, "{worst:e}");
}

#[test]
fn along_a_path_an_amplitude_must_rise() {
    for procedure in ["arc_length", "dissipation"] {
        let rules = format!("displacement = 1\nprocedure = \"{procedure}\"\n");
        let turning = format!("{rules}amplitude = [[0, 0], [0.5, 1], [1, 0]]");
        let error = built(&slider(&turning)).unwrap_err();
        assert_eq!(error.key(), "steps.1.amplitude");
        assert!(error.message().contains("turns back"), "{error}");
        let rising = format!("{rules}amplitude = [[0, 0], [0.5, 0.2], [1, 1]]");
        assert!(built(&slider(&rising)).is_ok());
    }
}

/// Half of the displacement in the first tenth of the time, and a constant part at the end.
#[test]
fn rows_are_reached_at_their_times() {
    let rows =
        "displacement = 2\namplitude = [[0, 0], [0.1, 0.5], [0.9, 1], [1, 1]]\nduration = 10";
    let recording = completed(&model(&slider(rows)));
    for (time, way) in [(1.0, 1.0), (9.0, 2.0), (10.0, 2.0)] {
        // After the preload, which takes 1 s.
        let row = recording
            .rows
            .iter()
            .find(|r| (r.time - 1.0 - time).abs() < 1e-9);
        let row = row.unwrap_or_else(|| panic!("no increment ends at {time} s"));
        assert!((row.displacement_mm - way).abs() < 1e-12, "{row:?}");
    }
}

/// A step that stops at a displacement counts it in both directions.
#[test]
fn cycles_stop_at_the_given_displacement() {
    let stop = "cycles = { amplitudes = [1, 2] }\nstop = { displacement = 1.5 }";
    let (recording, summary) = run(&model(&slider(stop)));
    assert_eq!(summary.status, Status::Completed);
    let last = recording.rows.last().unwrap().displacement_mm;
    // Tolerance: rounding of sums.
    assert!((1.5 - 1e-12..1.6).contains(&last), "{last}");
}

/// The example completes with the documented hysteresis loops.
#[test]
fn the_cyclic_example_dissipates_its_documented_energy() {
    let deck = crate::common::examples::load("41_cyclic_block", &[]);
    let (model, warnings) = Model::from_deck(&deck).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let last = completed(&model)
        .rows
        .last()
        .unwrap()
        .interface_dissipation_J;
    // 4 · 1440 N (2 · 1 mm + 2 · 2 mm) = 34.6 J, minus a hundredth for elastic slip and the increments.
    assert!((last / 34.56 - 1.0).abs() < 2e-2, "{last}");
}

/// A probe moves out and back: the required load is found.
#[test]
fn a_controlled_displacement_may_turn_back() {
    let amplitude = ("steps.1.amplitude", "[[0, 0], [0.5, 1], [1, 0.2]]");
    for tangent in ["secant", "consistent"] {
        let deck = crate::common::examples::load(
            "40_airbag",
            &[
                ("steps.1.control.displacement", "2"),
                ("steps.1.tangent", tangent),
                amplitude,
            ],
        );
        let recording = completed(&Model::from_deck(&deck).unwrap().0);
        let rows: Vec<&HistoryRow> = recording.rows.iter().filter(|r| r.step == 1).collect();
        let before = recording
            .rows
            .iter()
            .rfind(|r| r.step == 0)
            .unwrap()
            .displacement_mm;
        let farthest = rows.iter().map(|r| r.displacement_mm).fold(0.0, f64::max);
        let last = rows.last().unwrap();
        assert!((farthest - before - 2.0).abs() < 1e-9, "{farthest}");
        assert!(
            (last.displacement_mm - before - 0.4).abs() < 1e-9,
            "{last:?}"
        );
        let work = rows.iter().map(|r| r.external_work_J).fold(0.0, f64::max);
        assert!(
            gap(last).abs() < 5e-3 * work,
            "{tangent}: {}",
            gap(last) / work
        );
    }
}

/// The wallette of the example: turning points are reached, energies balance, loops are wide.
#[test]
fn a_wallette_is_sheared_cyclically() {
    let deck = crate::common::examples::load("42_cyclic_wall", &[]);
    let recording = completed(&Model::from_deck(&deck).unwrap().0);
    let rows: Vec<&HistoryRow> = recording.rows.iter().filter(|r| r.step == 1).collect();
    for way in [0.3, -0.3, 0.6, -0.6, 0.0] {
        assert!(
            rows.iter().any(|r| (r.displacement_mm - way).abs() < 1e-12),
            "{way} mm"
        );
    }
    let last = rows.last().unwrap();
    let open = recording
        .rows
        .iter()
        .map(|r| gap(r).abs())
        .fold(0.0, f64::max);
    println!("open {:.1e}", open / last.external_work_J);
    assert!(open < 1e-2 * last.external_work_J); // theory/energies.md, eq. 18
    // The area of the loops is the dissipation, up to the remaining elastic energy.
    let ends = recording.rows.windows(2).filter(|pair| pair[1].step == 1);
    let strip = |pair: &[HistoryRow]| {
        let way = pair[1].displacement_mm - pair[0].displacement_mm;
        0.5 * (pair[0].force_kN + pair[1].force_kN) * way
    };
    let area: f64 = ends.map(strip).sum();
    let begin = recording.rows.iter().rfind(|r| r.step == 0).unwrap();
    let lost = |r: &HistoryRow| r.taken_J() - r.elastic_energy_J;
    let stored = last.elastic_energy_J - begin.elastic_energy_J;
    let dissipated = lost(last) - lost(begin);
    println!("loops {area} J, dissipated {dissipated} J, stored {stored} J");
    assert!((area - stored - dissipated).abs() < 1e-2 * dissipated); // theory/energies.md, eq. 18
    // The only resistance is friction of at most μ N: 0.75 · 2.12 MPa on 420.5 × 49 mm, plus the bond at first.
    let friction = 1e-3 * 0.75 * 2.12 * 420.5 * 49.0;
    let tip = |way: f64| {
        let at = rows
            .iter()
            .find(|r| (r.displacement_mm - way).abs() < 1e-12);
        at.unwrap().force_kN.abs() / friction
    };
    for way in [0.3, -0.3, 0.6, -0.6] {
        assert!((0.7..1.2).contains(&tip(way)), "{way} mm: {}", tip(way));
    }
}
