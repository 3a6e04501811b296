//! Width of the band in which softening localises (theory/crack-band.md, eq. 5): the energy of a crack depends on the
//! element's length across it, independently of its shape.

use std::path::Path;

use crate::common::blocks::deck_and_model;
use crate::common::scene::{completed, run};
use crate::common::{Random, brick};
use nalgebra::{Rotation3, Vector3, Vector6};
use wythe::deck::{Deck, check};
use wythe::element::extent;
use wythe::element::hex8::CORNERS;
use wythe::material::{
    CrackBand, Curves, DamagePlasticity, DamagePlasticityParameters, Extent, MaterialHistory,
    MaterialParameters,
};
use wythe::model::Model;
use wythe::state::Status;

/// Edges of a bed joint element in the paper's walls [mm].
const EDGES: [f64; 3] = [51.0, 49.0, 12.5];
/// Length for which the tables hold [mm].
const REFERENCE: f64 = 20.0;
/// Curves exist for widths in steps of half a per cent; a point uses the nearest one.
const RUNG: f64 = 0.0026;

fn parameters() -> DamagePlasticityParameters {
    DamagePlasticityParameters {
        reference_length: Some(REFERENCE),
        crack_band: CrackBand::Projected,
        ..brick()
    }
}

fn element(edges: [f64; 3]) -> Extent {
    let corners = CORNERS.map(|c| [0, 1, 2].map(|i| 0.5 * c[i] * edges[i]));
    extent(&corners, edges.iter().product()).expect("a sound block")
}

fn law(p: &DamagePlasticityParameters, of: Extent) -> DamagePlasticity {
    let (curves, warnings) = Curves::of_bands(p, of.widths).expect("sound tables");
    assert!(warnings.is_empty(), "{warnings:?}");
    DamagePlasticity::with(p, curves, of)
}

/// Deck of a one-element block of [`EDGES`] whose face `far` is pulled by 0.03 mm in `direction`. `reference`: length
/// for which its tables hold [mm]; `increment`: fraction of the step.
fn pulled(reference: f64, band: &str, [direction, far]: [&str; 2], increment: f64) -> String {
    let [x, y, z] = EDGES;
    format!(
        r#"format = 1
[materials.brick]
E = "16700 MPa"
nu = 0.15
tension = [[3.5, 0, 0], [0.3, 0.002, 0.95]]
compression = [[11.0, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]
reference_length = {reference}
crack_band = "{band}"
[[blocks]]
name = "joint"
size = [{x}, {y}, {z}]
material = "brick"
[[supports]]
on = "joint.left"
fixed = ["x"]
[[supports]]
on = "joint.front"
fixed = ["y"]
[[supports]]
on = "joint.bottom"
fixed = ["z"]
[[probes]]
name = "end"
near = [{x}, {y}, {z}]
direction = "{direction}"
[[steps]]
name = "pull"
kind = "load"
procedure = "displacement_control"
control = {{ probe = "end", displacement = 0.03 }}
increments = {{ initial = {increment}, max = {increment} }}
tangent = "consistent"
tolerance = {{ residual = 1e-8 }}
[[steps.loads]]
name = "pull"
on = "joint.{far}"
pressure = -1.0
follower = false
"#
    )
}

/// A one-element block is pulled by 0.03 mm along each of its edges. Force over opening follows the table for l_ref,
/// although the edges differ by a factor of four. With the cube root of the volume it does not.
#[test]
fn crack_energy_does_not_depend_on_the_orientation_of_the_element() {
    for (band, exact) in [("projected", true), ("volume", false)] {
        for (axis, (direction, far)) in [("x", "right"), ("y", "back"), ("z", "top")]
            .into_iter()
            .enumerate()
        {
            let text = pulled(REFERENCE, band, [direction, far], 0.02);
            let (deck, model) = deck_and_model(&text);
            assert_eq!(
                deck.materials["brick"].band() == CrackBand::Projected,
                exact
            );
            let recording = completed(&model);
            let (mut worst, mut softening) = (0.0_f64, 0);
            for row in recording.rows.iter().skip(1) {
                let u = row.probes[0];
                let stress = row.load_factor;
                // u = L σ/E + l_ref ε_in(σ), where the table is a line
                let slope = 3.2 / 0.002;
                let by_stress = EDGES[axis] / 16700.0 - REFERENCE / slope;
                let peak = 3.5 * EDGES[axis] / 16700.0;
                let table = if u <= peak {
                    u * 16700.0 / EDGES[axis]
                } else {
                    softening += 1;
                    (u - REFERENCE * 3.5 / slope) / by_stress
                };
                worst = worst.max((stress - table.max(0.3)).abs() / 3.5);
            }
            println!("{band} {direction}: {worst:.2e}");
            assert!(softening > 5, "{softening} increments beyond the peak");
            if exact {
                // Tolerance: the step between curves, relative to the softened part.
                assert!(worst < 2.0 * RUNG, "{direction}: {worst}");
            } else {
                // l_eq is 31.5 mm: cracks across 51, 49 and 12.5 mm dissipate 1.6, 1.6 and 0.4 times the correct
                // energy.
                assert!(worst > 0.1, "{direction}: {worst}");
            }
        }
    }
}

/// Strain of uniaxial stress along `n` for ν = 0.
fn along(n: &Vector3<f64>, strain: f64) -> Vector6<f64> {
    let m = n * n.transpose() * strain;
    Vector6::new(
        m[(0, 0)],
        m[(1, 1)],
        m[(2, 2)],
        2.0 * m[(0, 1)],
        2.0 * m[(1, 2)],
        2.0 * m[(2, 0)],
    )
}

/// The band is as wide as the element across the first crack, and remains so when the strain rotates.
#[test]
fn the_width_of_a_band_is_fixed_at_the_onset() {
    let p = parameters();
    let of = element(EDGES);
    let law = law(&p, of);
    for degrees in [0.0_f64, 10.0, 40.0, 70.0, 90.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let n = Vector3::new(c, 0.0, s);
        let elastic = law
            .update(&along(&n, 1e-4), &MaterialHistory::default(), 1.0, false)
            .expect("an answer");
        assert_eq!(elastic.history.crack_band, 0.0);
        let cracked = law
            .update(&along(&n, 6e-4), &elastic.history, 1.0, false)
            .expect("an answer");
        let band = cracked.history.crack_band;
        // Principal directions are those of the strain, within the precision of the root of a cubic.
        let exact = 1.0 / (c / EDGES[0]).max(s / EDGES[2]);
        assert!(
            (band / exact - 1.0).abs() < 1e-9,
            "{degrees}: {band} {exact}"
        );
        let across = along(&Vector3::new(-s, 0.0, c), 9e-4);
        let turned = law
            .update(&(along(&n, 6e-4) + across), &cracked.history, 1.0, false)
            .expect("an answer");
        assert!(turned.history.kappa_t > cracked.history.kappa_t);
        assert_eq!(turned.history.crack_band, band);
    }
}

/// In a frame that rotates with the element strains and stresses are the same.
#[test]
fn bands_are_objective() {
    let p = parameters();
    let mut random = Random(7);
    for _ in 0..20 {
        let turn = Rotation3::new(Vector3::from_fn(|_, _| random.signed()));
        let there = element(EDGES);
        let here = Extent {
            gradient: there.gradient.map(|g| turn * g),
            ..there
        };
        let laws = [law(&p, there), law(&p, here)];
        let n = Vector3::from_fn(|_, _| random.signed()).normalize();
        let mut old = [MaterialHistory::default(); 2];
        for k in 1..=20 {
            let strain = 5e-5 * f64::from(k);
            let strains = [along(&n, strain), along(&(turn * n), strain)];
            for i in 0..2 {
                let answer = laws[i].update(&strains[i], &old[i], 1.0, false);
                old[i] = answer.expect("an answer").history;
            }
        }
        assert!(old[0].tensile_damage > 0.1);
        let bands = old.map(|h| h.crack_band);
        assert!((bands[0] / bands[1] - 1.0).abs() < 1e-9, "{bands:?}");
        let sizes = old.map(|h| h.stress.fixed_rows::<3>(0).sum());
        // Widths may lie on both sides of the border between two curves: half a per cent of the softened part.
        assert!((sizes[0] - sizes[1]).abs() < 2.0 * RUNG * 3.5, "{sizes:?}");
    }
}

/// Once a point softens, it has the tangent of its own curve.
#[test]
fn the_tangent_is_that_of_the_band() {
    let p = parameters();
    let law = law(&p, element(EDGES));
    let mut random = Random(11);
    let mut checked = 0;
    for _ in 0..20 {
        let n = Vector3::from_fn(|_, _| random.signed()).normalize();
        let mut old = MaterialHistory::default();
        for k in 1..=4 {
            let step = Vector6::from_fn(|_, _| 2e-5 * random.signed());
            let strain = along(&n, 1.5e-4 * f64::from(k)) + step;
            let answer = law.update(&strain, &old, 1.0, true).expect("an answer");
            if old.kappa_t > 0.0 {
                checked += 1;
                let h = 1e-9;
                for i in 0..6 {
                    let mut by = Vector6::zeros();
                    by[i] = h;
                    let at = |e: Vector6<f64>| {
                        law.update(&e, &old, 1.0, false).expect("an answer").stress
                    };
                    let slope = (at(strain + by) - at(strain - by)) / (2.0 * h);
                    let error = (answer.tangent.column(i) - slope).amax() / 16700.0;
                    // Tolerance: differences of 1e-9 of stresses of 3 MPa in double precision, and kinks of r within
                    // them.
                    assert!(error < 1e-4, "{i}: {error:.1e}");
                }
            }
            old = answer.history;
        }
    }
    assert!(checked > 20, "{checked}");
}

/// The small wall with two and with four elements through its thickness, without cracks normal to it. With
/// `projected` its curve does not change, with the cube root of the volume it does.
#[test]
fn elements_through_the_thickness_do_not_change_the_crack_energy() {
    let curve = |band: &str, thickness: usize| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stability");
        let set = [
            ("materials.brick.crack_band".into(), band.into()),
            ("materials.mortar.crack_band".into(), band.into()),
            ("wall.mesh".into(), format!("[5, 2, {thickness}]")),
        ];
        let deck = Deck::load(folder.join("small_wall.toml"), &set).unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let (recording, summary) = run(&model);
        assert_eq!(summary.status, Status::Completed, "{}", summary.message);
        let rows: Vec<_> = recording.rows.iter().filter(|r| r.step == 1).collect();
        let work = rows.windows(2).map(|pair| {
            0.5 * (pair[0].force_kN + pair[1].force_kN)
                * (pair[1].displacement_mm - pair[0].displacement_mm)
        });
        work.sum::<f64>()
    };
    let [projected, volume] =
        ["projected", "volume"].map(|band| curve(band, 4) / curve(band, 2) - 1.0);
    println!("energies: projected {projected:+.2e}, volume {volume:+.2e}");
    // Brittle peaks that fall between different increments account for this; measured: 0.2 and 3.0 %.
    assert!(projected.abs() < 0.005, "{projected}");
    assert!(volume.abs() > 0.02, "{volume}");
}

/// Bands go across the crack unless the deck says otherwise. Without a reference length they are rejected. `check`
/// notes those that would snap back and count as narrower, and the damage that is inadmissible in wide bands only.
#[test]
fn crack_bands_of_a_deck_are_checked() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stability");
    let text = std::fs::read_to_string(folder.join("small_wall.toml")).unwrap();
    let (deck, model) = deck_and_model(&text);
    for material in &model.materials {
        let MaterialParameters::DamagePlasticity(p) = &material.parameters else {
            panic!("{}", material.name)
        };
        assert!(p.has_bands(), "{}", material.name);
    }
    let told: Vec<&str> = model.warnings.iter().map(|w| w.key.as_str()).collect();
    // The table as printed is inadmissible there (theory/damage-plasticity.md, Decisions).
    assert_eq!(told, ["materials.mortar.tension.1.2"]);
    let notes = check(&deck, &model).notes.join("\n");
    for part in [
        // E Δε_in/Δσ l_ref/1.01 = 1.214 · 31.4/1.01 and 1.417 · 31.4/1.01 (theory/crack-band.md, eq. 6).
        "in tension; beyond 37.8 mm",
        "in compression; beyond 44.0 mm",
        "capped to 0.9466 in bands of 44.0 mm",
    ] {
        assert!(notes.contains(part), "{part} is not in {notes}");
    }
    let bare = text.replace(
        "reference_length = \"31.4 mm\"\n",
        "crack_band = \"projected\"\n",
    );
    let error = Deck::from_str(&bare, "bare.toml").unwrap_err().to_string();
    assert!(error.contains("materials.mortar.crack_band"), "{error}");
    assert!(error.contains("needs `reference_length`"), "{error}");
}

/// A run warns where bands that count as narrower than they are dissipated too much, and of how much.
#[test]
fn the_excess_of_narrowed_bands_is_reported() {
    let reported = |reference: f64| {
        let text = pulled(reference, "projected", ["x", "right"], 0.004);
        let (_, summary) = run(&deck_and_model(&text).1);
        assert_eq!(summary.status, Status::Completed, "{}", summary.message);
        let told = summary.warnings.into_iter();
        told.into_iter().find(|w| w.contains("too wide"))
    };
    assert_eq!(reported(REFERENCE), None);
    // E Δε_in/Δσ l_ref/1.01 = 16700 · 0.002/3.2 · 2/1.01 = 20.7 mm are less than the 51 mm across the crack.
    let told = reported(2.0).expect("a narrowed band cracked");
    let percent = told
        .split(" % ")
        .next()
        .and_then(|t| t.split(' ').next_back());
    let percent: f64 = percent.and_then(|t| t.parse().ok()).unwrap();
    let exact = 100.0 * (1.0 - 16700.0 * 0.002 / 3.2 * 2.0 / 1.01 / EDGES[0]);
    // The whole fall lies within one or two increments of 1.1 % of the way to the peak.
    assert!((percent - exact).abs() < 1.5, "{told}, exact {exact:.1}");
}
