//! Curves from strengths and fracture energies (theory/crack-band.md, eqs 10 to 13): bars of several lengths give the
//! energies back, and each misuse is an error with its key and its fix.

use crate::common::blocks::deck_and_model;
use crate::common::scene::completed;
use wythe::deck::{Deck, check};
use wythe::error::ModelError;
use wythe::material::{
    ByEnergy, CrackBand, DamagePlasticityParameters, ElasticParameters, MaterialParameters,
};
use wythe::model::Model;

const E: f64 = 6000.0;
const TENSILE: ByEnergy = ByEnergy {
    strength: 2.0,
    energy: 0.06,
};
const CRUSHED: ByEnergy = ByEnergy {
    strength: 20.0,
    energy: 22.0,
};

/// Keys of a material by energies.
const BRICK: &str = r#"E = "6 GPa"
nu = 0.15
f_t = "2 MPa"
G_ft = "60 N/m"
f_c = "20 MPa"
G_fc = "22 N/mm""#;

/// A bar of one element, `length` mm long, driven along its axis by `end` mm with free sides.
fn bar(material: &str, length: f64, end: f64) -> String {
    format!(
        r#"format = 1
[materials.brick]
{material}
[[blocks]]
name = "bar"
size = [{length}, 30, 40]
material = "brick"
[[supports]]
on = "bar.left"
fixed = ["x"]
[[supports]]
on = "bar.front"
fixed = ["y"]
[[supports]]
on = "bar.bottom"
fixed = ["z"]
[[probes]]
name = "end"
near = [{length}, 30, 40]
direction = "x"
[[steps]]
name = "drive"
kind = "load"
procedure = "displacement_control"
control = {{ probe = "end", displacement = {end} }}
increments = {{ initial = 0.002, max = 0.002 }}
tangent = "consistent"
tolerance = {{ residual = 1e-8 }}
[[steps.loads]]
name = "drive"
on = "bar.right"
pressure = {pressure}
follower = false
"#,
        pressure = -end.signum()
    )
}

/// Work per area [N/mm] beyond the peak, without the elastic energy that is given back, up to the opening at which
/// the last row ends; and the peak [MPa].
fn energy_of(material: &str, length: f64, of: ByEnergy, last: f64, sign: f64) -> [f64; 2] {
    let (_, model) = deck_and_model(&bar(material, length, sign * last));
    let rows = completed(&model).rows;
    let path: Vec<[f64; 2]> = rows
        .iter()
        .map(|row| [sign * row.probes[0], row.load_factor])
        .collect();
    let peak = path.iter().map(|p| p[1]).fold(0.0, f64::max);
    let top = path.iter().position(|p| p[1] == peak).unwrap();
    let lines = path[top..].windows(2);
    let work: f64 = lines
        .map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0]))
        .sum();
    let end = path[path.len() - 1][1];
    assert!(end < 0.2 * of.strength, "softened to {end} MPa");
    // From the peak to the end the elastic part gives back L (f² − σ²)/2E.
    let elastic = length * (peak * peak - end * end) / (2.0 * E);
    [work + elastic, peak]
}

/// Work per area of bars of one element, 5, 20 and 80 mm long, up to the last row, which is where the curves end.
#[test]
fn bars_of_several_lengths_give_the_energies_back() {
    for length in [5.0, 20.0, 80.0] {
        // Opening of the last row: G_ft/f_t ln 50, stretched by 0.6 %, and the strain of 2 % f_t.
        let last = 0.03 * 50.0_f64.ln() * 1.0057 + length * 0.02 * TENSILE.strength / E;
        let [energy, peak] = energy_of(BRICK, length, TENSILE, last, 1.0);
        println!("tension, {length} mm: {energy:.5} N/mm, {peak:.4} MPa");
        // Tolerances: steps between curves of 1/400, increments of 1/500 of the way that cut off the peak and the
        // corners of the rows.
        assert!((energy / TENSILE.energy - 1.0).abs() < 0.005, "{energy}");
        assert!((peak / TENSILE.strength - 1.0).abs() < 0.01, "{peak}");

        // Closing of the last row: 1.5 G_fc/f_c √0.95, stretched by 1 %, and the strain at the peak.
        let last = 1.1 * 1.5144 * 0.95_f64.sqrt() + length * 5.0 / 3.0 * CRUSHED.strength / E;
        let [energy, peak] = energy_of(BRICK, length, CRUSHED, last, -1.0);
        println!("compression, {length} mm: {energy:.4} N/mm, {peak:.4} MPa");
        // The same, and the curve as it deforms: areas and lengths are those of the bar at rest, and a short bar is
        // shortened by a third.
        assert!((energy / CRUSHED.energy - 1.0).abs() < 0.01, "{energy}");
        assert!((peak / CRUSHED.strength - 1.0).abs() < 0.01, "{peak}");
    }
}

/// A deck and the constructor of Rust give the same parameters; the band is projected unless the deck says otherwise.
#[test]
fn a_deck_gives_the_parameters_of_the_constructor() {
    let read = |more: &str| {
        let (deck, model) = deck_and_model(&bar(&format!("{BRICK}\n{more}"), 20.0, 0.1));
        let MaterialParameters::DamagePlasticity(p) = model.materials[0].parameters.clone() else {
            panic!("not damage plasticity")
        };
        (deck, p)
    };
    let elastic = ElasticParameters {
        E,
        nu: 0.15,
        density: 0.0,
    };
    let (deck, p) = read("");
    assert_eq!(
        p,
        DamagePlasticityParameters::by_energy(elastic, TENSILE, CRUSHED)
    );
    // What a run writes is read again as it is.
    let again = Deck::from_str(&deck.to_toml().unwrap(), "model.toml").unwrap();
    assert_eq!(again.materials["brick"], deck.materials["brick"]);
    let (_, volume) = read("crack_band = \"volume\"");
    assert_eq!(volume.crack_band, CrackBand::Volume);
    // A reference length is that of a single point; elements do not notice.
    let (_, longer) = read("reference_length = 50");
    let ends = [&p, &longer].map(|p| p.tension[8].inelastic_strain * p.reference_length.unwrap());
    assert!((ends[0] - ends[1]).abs() < 1e-15);
}

/// The energies of tables and of energies, as the checker prints them.
#[test]
fn the_checker_prints_energies() {
    let notes = |material: &str| {
        let (deck, model) = deck_and_model(&bar(material, 20.0, 0.1));
        let report = check(&deck, &model);
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
        report.notes.join("\n")
    };
    let told = notes(BRICK);
    for part in [
        "f_t = 2 MPa, G_ft = 0.0600 N/mm beyond the peak; no snap-back below 102.2 mm, 1.14 E G_ft/f_t^2",
        "f_c = 20 MPa, G_fc = 22.0000 N/mm beyond the peak, 0.0389 N/mm^2 up to it; no snap-back below 267.3 mm, 0.81 \
         E G_fc/f_c^2",
    ] {
        assert!(told.contains(part), "{part} is not in {told}");
    }
    // The paper's tables: 0.19 and 1.82 N/mm (50 mm times areas of 0.0038 and 0.0363 N/mm²).
    let told = notes(
        "E = 16700\nnu = 0.15\ntension = [[3.5, 0, 0], [1.5, 0.001, 0.6], [0.3, 0.002, 0.95]]\n\
         compression = [[11.0, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]\nreference_length = 50",
    );
    for part in [
        "f_t = 3.5 MPa, G_ft = 0.1700 N/mm beyond the peak (0.1250 to row 2, 0.1700 to row 3); no snap-back",
        "f_c = 11.5 MPa, G_fc = 1.8150 N/mm beyond the peak, 0.0112 N/mm^2 up to it; no snap-back",
    ] {
        assert!(told.contains(part), "{part} is not in {told}");
    }
}

fn error_of(material: &str) -> ModelError {
    let text = bar(material, 20.0, 0.1);
    let read = Deck::from_str(&text, "bar.toml").and_then(|deck| Model::from_deck(&deck));
    read.expect_err("the deck is bad")
}

/// Changes of the material, the key and the line of the error, a part of its message, a part of the advice.
#[test]
fn misuse_is_an_error_with_key_line_and_fix() {
    let without = |key: &str| -> String {
        let lines = BRICK.lines().filter(|line| !line.starts_with(key));
        lines.collect::<Vec<_>>().join("\n")
    };
    let with = |more: &str| format!("{BRICK}\n{more}");
    let table = "tension = [[2, 0, 0], [0.1, 0.01, 0.9]]";
    let cases: [(String, &str, usize, &str, &str); 9] = [
        (
            without("G_ft"),
            "f_t",
            5,
            "`f_t` is given, `G_ft` is missing",
            "G_ft = \"0.06 N/mm\"",
        ),
        (
            without("f_c"),
            "G_fc",
            7,
            "`G_fc` is given, `f_c` is missing",
            "f_c = \"20 MPa\"",
        ),
        (
            with(table),
            "G_ft",
            6,
            "`G_ft` is given beside the table `tension`",
            "leave out the table",
        ),
        (
            format!(
                "{}\n{table}",
                without("f_t").replace("G_ft = \"60 N/m\"\n", "")
            ),
            "reference_length",
            2,
            "needs `reference_length`",
            "reference_length = \"50 mm\"",
        ),
        (
            BRICK.replace("60 N/m", "0 N/m"),
            "G_ft",
            6,
            "0 is not positive",
            "above 0",
        ),
        (
            BRICK.replace("22 N/mm", "-1 N/mm"),
            "G_fc",
            8,
            "-1 is not positive",
            "above 0",
        ),
        (
            BRICK.replace("20 MPa", "5 MPa"),
            "f_c",
            7,
            "5 MPa is below 7.655 MPa",
            "a larger f_c",
        ),
        (
            format!(
                "{}\ncrack_band = \"volume\"",
                BRICK.replace("60 N/m", "6 N/m")
            ),
            "G_ft",
            6,
            "elements of 28.8 mm (cube root of the volume) are over the limit of 10.2 mm",
            "refine the mesh",
        ),
        (
            with("kind = \"drucker-prager\"\nc = 5\nphi = 30"),
            "G_ft",
            6,
            "`G_ft` is not read by kind = \"drucker-prager\"",
            "\"damage-plasticity\"",
        ),
    ];
    for (material, key, line, message, help) in cases {
        let error = error_of(&material);
        assert_eq!(error.key(), format!("materials.brick.{key}"), "{material}");
        assert_eq!(error.line(), Some(line), "{material}");
        assert!(error.message().contains(message), "{}", error.message());
        assert!(error.advice().contains(help), "{}", error.advice());
    }
    // Either curve alone leaves the other one out.
    let error = error_of(&without("f_c").replace("G_fc = \"22 N/mm\"", ""));
    assert!(
        error.message().contains("`f_t` and `G_ft` are given"),
        "{error}"
    );
}

/// Elements beyond the limit of snap-back: projected bands are narrowed, with a note.
#[test]
fn wide_bands_are_narrowed_with_a_note() {
    let brittle = BRICK.replace("60 N/m", "6 N/m");
    let (deck, model) = deck_and_model(&bar(&brittle, 20.0, 0.1));
    let notes = check(&deck, &model).notes.join("\n");
    let told = "beyond 10.1 mm the softening with this G_ft would snap back";
    assert!(notes.contains(told), "{notes}");
}
