//! The command `wythe drive`.

mod common;

use std::path::Path;
use std::process::Output;

use common::*;

/// Drives a point of a model along the path of a file.
fn drive(what: [&str; 2], model: &str, path: &Path, options: &[&str]) -> Output {
    let path = path.display().to_string();
    let mut arguments = vec!["drive"];
    arguments.extend(what);
    arguments.extend(["--model", model, "--path", &path]);
    arguments.extend(options);
    wythe(&arguments)
}

const JOINT: [&str; 2] = ["interface", "joint"];
const BRICK: [&str; 2] = ["material", "brick"];

/// Drives the joint of the couplet.
fn joint(path: &Path, options: &[&str]) -> Output {
    let options = [options, &STIFFNESSES].concat();
    drive(JOINT, &couplet(), path, &options)
}

/// The shear wall with its bricks.
fn shear_wall() -> String {
    repository("examples/03_shear_wall_j7d.toml")
        .display()
        .to_string()
}

/// With one implicit step per row, the shear path at −0.5 MPa gives a stored curve (theory/joint.md, eqs 9 to 18).
#[test]
fn an_interface_point_follows_its_stored_curve() {
    let path = repository("tests/data/golden/itf_T1_mode2_sig0.5.csv");
    let golden = std::fs::read_to_string(&path).unwrap();
    let output = joint(&path, &[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let answer = String::from_utf8(output.stdout).unwrap();
    for (name, reference) in [
        ("sig_MPa", "sig_be_MPa"),
        ("tau1_MPa", "tau1_be_MPa"),
        ("tau2_MPa", "tau2_be_MPa"),
        ("D", "D_be"),
    ] {
        for (row, (a, b)) in column(&answer, name)
            .iter()
            .zip(column(&golden, reference))
            .enumerate()
        {
            // The file gives the stiffness with ten digits; the curve is accurate to 1e-12.
            assert!((a - b).abs() < 1e-9, "{name} in row {row}: {a} against {b}");
        }
    }
    // The output repeats the path.
    assert_eq!(column(&answer, "d1_mm"), column(&golden, "d1_mm"));
}

/// The same shear with the pressure prescribed by stress, so that the opening is solved for.
#[test]
fn a_component_is_driven_by_its_stress_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shear.csv");
    let rows: Vec<_> = (0..=40)
        .map(|i| format!("{},0,-0.5\n", 0.02 * f64::from(i)))
        .collect();
    let rows = rows.concat();
    std::fs::write(
        &path,
        format!("# pressure first\nd1_mm,d2_mm,sig_MPa\n{rows}"),
    )
    .unwrap();
    let out = folder.path().join("out.csv").display().to_string();
    let output = joint(&path, &["--out", &out, "--stress", "normal"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let answer = std::fs::read_to_string(&out).unwrap();
    for sigma in column(&answer, "sig_MPa") {
        assert!((sigma + 0.5).abs() < 1e-10, "{sigma}"); // the driver's tolerance
    }
    for u in column(&answer, "u_mm") {
        // u = σ/k_n; the tolerance over k_n is 1e-15.
        assert!((u + 0.5 / 99000.0).abs() < 1e-14, "{u}");
    }
    // Beyond delta_k only friction remains: μ·0.5.
    let tau = column(&answer, "tau1_MPa");
    assert!((tau.last().unwrap() - 0.73 * 0.5).abs() < 1e-9, "{tau:?}");
}

/// Uniaxial tension with free sides reproduces the table of the deck (theory/damage-plasticity.md, eq. 9, eff1).
#[test]
fn a_material_point_in_uniaxial_tension_follows_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tension.csv");
    let rows: Vec<_> = (1..=60)
        .map(|i| format!("{},0,0,0,0,0\n", 4e-5 * f64::from(i)))
        .collect();
    let rows = rows.concat();
    let header = "eps_xx,sig_yy_MPa,sig_zz_MPa,gam_xy,gam_yz,gam_zx\n";
    std::fs::write(&path, format!("{header}{rows}")).unwrap();
    // The table holds for the inviscid law.
    let inviscid = ["--set", "materials.brick.viscosity=0"];
    let options = [&["--stress", "yy", "--stress", "zz"][..], &inviscid].concat();
    let output = drive(BRICK, &shear_wall(), &path, &options);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let answer = String::from_utf8(output.stdout).unwrap();
    // (3.5 MPa, 0) and (0.3 MPa, 0.002) with E = 16700 MPa, constant afterwards.
    let table = |strain: f64| {
        let e = 16700.0;
        let elastic = e * strain;
        if elastic <= 3.5 {
            return elastic;
        }
        let end = 0.002 + 0.3 / e;
        let fraction = ((strain - 3.5 / e) / (end - 3.5 / e)).min(1.0);
        3.5 + fraction * (0.3 - 3.5)
    };
    let (strains, stresses) = (column(&answer, "eps_xx"), column(&answer, "sig_xx_MPa"));
    assert_eq!(strains.len(), 60);
    for (strain, stress) in strains.iter().zip(&stresses) {
        // The polyline is exact for eff1 if the lateral stress is zero; here it is zero to 1e-10 MPa.
        assert!(
            (stress - table(*strain)).abs() < 1e-9,
            "{stress} at {strain}"
        );
    }
    for name in ["sig_yy_MPa", "sig_zz_MPa"] {
        assert!(column(&answer, name).iter().all(|s| s.abs() <= 1e-10));
    }
}

#[test]
fn bad_paths_exit_with_2_and_name_file_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, expected) in [
        (
            "missing.csv",
            "u_mm,d1_mm\n0,0\n",
            "missing.csv:1: the column d2_mm is missing",
        ),
        (
            "nan.csv",
            "u_mm,d1_mm,d2_mm\n0,0,0\n0,NaN,0\n",
            "nan.csv:3, column d1_mm: NaN",
        ),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let out = folder.path().join("out.csv");
        let output = joint(&path, &["--out", &out.display().to_string()]);
        assert_eq!(code(&output), 2);
        // The folder's name may be wrapped in the middle; without blanks the words can be compared.
        let said = stderr(&output).replace(' ', "");
        assert!(said.contains(&expected.replace(' ', "")), "{said}");
        assert!(!out.exists());
    }
    let missing = Path::new("no/such.csv");
    assert_eq!(code(&joint(missing, &[])), 4);
    assert_eq!(
        code(&drive(JOINT, &couplet(), missing, &[])),
        2,
        "stiffnesses are missing: the model comes first"
    );
}

#[test]
fn a_point_beyond_its_strength_exits_with_3_and_keeps_the_rows_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pull.csv");
    std::fs::write(&path, "sig_MPa,d1_mm,d2_mm\n0.1,0,0\n0.2,0,0\n0.9,0,0\n").unwrap();
    let output = joint(&path, &["--stress", "normal"]);
    assert_eq!(code(&output), 3, "{}", stderr(&output));
    let answer = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(column(&answer, "sig_MPa").len(), 2);
    let said = stderr(&output);
    // f_t = 0.28 MPa is reached at the fraction (0.28 - 0.2)/(0.9 - 0.2).
    for part in [
        "pull.csv:4",
        "row 3",
        "sig_MPa = 0.9 asked, 0.28 reached",
        "11.43 % of the way",
    ] {
        let joined = said.replace(' ', "");
        assert!(joined.contains(&part.replace(' ', "")), "{part}: {said}");
    }
}

/// Drives a brick of the shear wall through `rows` with the columns of `header`. Returns exit code, response and
/// errors.
fn brick(header: &str, rows: &[[f64; 6]], stress: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.csv");
    let mut text = format!("{header}\n");
    for row in rows {
        text += &row.map(|v| format!("{v:?}")).join(",");
        text.push('\n');
    }
    std::fs::write(&path, text).unwrap();
    let options: Vec<&str> = stress.iter().flat_map(|c| ["--stress", c]).collect();
    let output = drive(BRICK, &shear_wall(), &path, &options);
    let answer = String::from_utf8(output.stdout.clone()).unwrap();
    (code(&output), answer, stderr(&output))
}

const STRESSES: &str = "sig_xx_MPa,sig_yy_MPa,sig_zz_MPa,sig_xy_MPa,sig_yz_MPa,sig_zx_MPa";
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// All components are prescribed by stress, in proportion. The strengths must equal those of the input. Uniaxial:
/// the peaks of the tables (11.5 MPa, 3.5 MPa); biaxial: f_b0/f_c0 = 1.16 times the compressive peak.
#[test]
fn a_point_driven_by_stress_alone_ends_at_its_strength() {
    for (direction, strength) in [
        ([-1.0, 0.0], 11.5),
        ([1.0, 0.0], 3.5),
        ([-1.0, -1.0], 1.16 * 11.5),
    ] {
        // 39 of 40 rows are below the strength, the last is just above it.
        let rows: Vec<[f64; 6]> = (1..=40)
            .map(|k| {
                let s = strength * f64::from(k) / 39.9;
                [s * direction[0], s * direction[1], 0.0, 0.0, 0.0, 0.0]
            })
            .collect();
        let (code, answer, said) = brick(STRESSES, &rows, &COMPONENTS);
        assert_eq!(code, 3, "{said}");
        let stresses = column(&answer, "sig_xx_MPa");
        assert_eq!(stresses.len(), 39, "{said}");
        for (row, stress) in rows.iter().zip(&stresses) {
            assert!((stress - row[0]).abs() <= 1e-10); // the driver's tolerance
        }
        let reached = said
            .split("asked, ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next())
            .unwrap()
            .parse::<f64>()
            .unwrap();
        // The message has seven digits.
        assert!(
            (reached - direction[0] * strength).abs() < 1e-5,
            "{reached} for {direction:?}"
        );
        assert!(said.contains("row 40"), "{said}");
    }
}

/// Shear at constant compression with free sides gives a peak, then softening, while the pressure remains
/// constant. A higher pressure gives a higher shear strength.
#[test]
fn a_material_point_is_sheared_at_constant_compression() {
    let header = "sig_xx_MPa,sig_yy_MPa,sig_zz_MPa,gam_xy,gam_yz,gam_zx";
    let mut last = 0.0;
    for pressure in [0.0, 1.0, 2.0] {
        let pressed = (1..=5).map(|k| [0.0, -pressure * f64::from(k) / 5.0, 0.0, 0.0, 0.0, 0.0]);
        let sheared = (1..=60).map(|k| [0.0, -pressure, 0.0, 1e-4 * f64::from(k), 0.0, 0.0]);
        let rows: Vec<[f64; 6]> = pressed.chain(sheared).collect();
        let (code, answer, said) = brick(header, &rows, &["xx", "yy", "zz"]);
        assert_eq!(code, 0, "{said}");
        for (name, asked) in [
            ("sig_xx_MPa", 0.0),
            ("sig_yy_MPa", -pressure),
            ("sig_zz_MPa", 0.0),
        ] {
            for stress in &column(&answer, name)[5..] {
                assert!((stress - asked).abs() <= 1e-10, "{name}: {stress}"); // the driver's tolerance
            }
        }
        let shear = column(&answer, "sig_xy_MPa");
        let peak = shear.iter().copied().fold(0.0, f64::max);
        assert!(
            peak > last + 0.1 && shear[64] < 0.9 * peak,
            "{peak}, {}",
            shear[64]
        );
        last = peak;
    }
}

/// The law of a point follows its `kind`, and its own outputs follow the columns that every law has.
#[test]
fn a_material_of_another_kind_follows_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("stone.toml");
    let keys = "kind = \"drucker-prager\"\nE = 8000\nnu = 0.2\nc = 3\nphi = 40\npsi = 15\nf_t = 1";
    std::fs::write(&deck, format!("format = 1\n[materials.stone]\n{keys}\n")).unwrap();
    let path = folder.path().join("path.csv");
    let rows = "t,eps_xx,sig_yy_MPa,sig_zz_MPa,gam_xy,gam_yz,gam_zx\n\
        1,1e-4,0,0,0,0,0\n2,1e-3,0,0,0,0,0\n";
    std::fs::write(&path, rows).unwrap();
    let deck = deck.display().to_string();
    let free = ["--stress", "yy", "--stress", "zz"];
    let output = drive(["material", "stone"], &deck, &path, &free);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let answer = String::from_utf8(output.stdout).unwrap();
    assert!(
        answer
            .lines()
            .next()
            .unwrap()
            .ends_with(",kt,kc,dt,dc,d,kappa_t,kappa_c")
    );
    let stress = column(&answer, "sig_xx_MPa");
    // The search for stress-free sides ends at 1e-10 MPa.
    assert!(
        (stress[0] - 0.8).abs() < 1e-9 && (stress[1] - 1.0).abs() < 1e-9,
        "{stress:?}"
    );
    // In uniaxial tension κ_t is the axial plastic strain.
    assert!((column(&answer, "kappa_t")[1] - (1e-3 - 1.0 / 8000.0)).abs() < 1e-9);
}
