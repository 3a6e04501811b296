//! The command as a user meets it: exit codes, messages, files.

use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A file of the repository.
fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

fn wythe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(arguments)
        .output()
        .unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stderr(output: &Output) -> String {
    // miette wraps lines and draws boxes: compare words only.
    let text = String::from_utf8_lossy(&output.stderr);
    text.split(|c: char| c.is_whitespace() || "│×╭─╰▶╮╯·".contains(c))
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

/// A column of a CSV text.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let index = header
        .iter()
        .position(|h| *h == name)
        .unwrap_or_else(|| panic!("{name}"));
    rows.map(|row| row.split(',').nth(index).unwrap().parse().unwrap())
        .collect()
}

/// A couplet whose joint has the explicit stiffnesses that a single point needs.
fn couplet() -> String {
    repository("examples/01_couplet_tension.toml")
        .display()
        .to_string()
}

const STIFFNESSES: [&str; 4] = [
    "--set",
    "interfaces.joint.normal_stiffness=99000",
    "--set",
    "interfaces.joint.shear_stiffness=43043.47826",
];

#[test]
fn usage_errors_exit_with_2() {
    assert_eq!(code(&wythe(&[])), 2);
    assert_eq!(code(&wythe(&["run"])), 2);
    assert_eq!(code(&wythe(&["run", "a.toml", "--threads", "0"])), 2);
    assert_eq!(code(&wythe(&["check", "a.toml", "--set", "novalue"])), 2);
    assert_eq!(code(&wythe(&["--version"])), 0);
    assert_eq!(code(&wythe(&["drive", "material", "--help"])), 0);
}

#[test]
fn a_missing_model_exits_with_4_and_a_bad_one_with_2() {
    let missing = wythe(&["check", "no/such/model.toml"]);
    assert_eq!(code(&missing), 4);
    assert!(stderr(&missing).contains("no/such/model.toml"));
    let bad = repository("tests/data/bad/negative_modulus.toml");
    let bad = wythe(&["check", &bad.display().to_string()]);
    assert_eq!(code(&bad), 2);
    assert!(
        stderr(&bad).contains("materials.brick.E"),
        "{}",
        stderr(&bad)
    );
    let set = wythe(&["check", &couplet(), "--set", "wall.courses=0"]);
    assert_eq!(code(&set), 2);
    assert!(
        stderr(&set).contains("--set wall.courses"),
        "{}",
        stderr(&set)
    );
}

/// A run is refused before its folder is made, with the file, the place and a fix.
#[test]
fn every_bad_deck_exits_with_2_and_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out").display().to_string();
    let mut tried = 0;
    for entry in std::fs::read_dir(repository("tests/data/bad")).unwrap() {
        let deck = entry.unwrap().path();
        let name = deck.file_name().unwrap().to_string_lossy().into_owned();
        let output = wythe(&["run", &deck.display().to_string(), "--out", &out]);
        assert_eq!(code(&output), 2, "{name}: {}", stderr(&output));
        let said = stderr(&output);
        // The path may be wrapped in the middle.
        assert!(
            said.replace(' ', "").contains(&format!("{name}:")),
            "{name}: {said}"
        );
        assert!(said.contains("help:"), "{name}: {said}");
        assert!(!Path::new(&out).exists(), "{name}");
        tried += 1;
    }
    assert!(tried > 30);
}

#[test]
fn check_prints_the_sizes() {
    let output = wythe(&["check", &couplet()]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("2 units") && text.contains("contact points"),
        "{text}"
    );
}

#[test]
fn results_that_cannot_be_written_exit_with_4() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    std::fs::write(&out, "mine").unwrap();
    let output = wythe(&["run", &couplet(), "--out", &out.display().to_string()]);
    assert_eq!(code(&output), 4);
    assert!(
        stderr(&output).contains("this is a file"),
        "{}",
        stderr(&output)
    );
}

/// One folder would lie below a file; in the other a full disk stands for the history.
#[test]
#[cfg(target_os = "linux")]
fn folders_and_disks_that_refuse_exit_with_4_and_leave_nothing_that_looks_whole() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").unwrap();
    let below = file.join("wall.out");
    let full = folder.path().join("full.out");
    std::fs::create_dir(&full).unwrap();
    std::os::unix::fs::symlink("/dev/full", full.join("history.csv")).unwrap();
    for (out, said) in [
        (&below, "cannot be created"),
        (&full, "No space left on device"),
    ] {
        let output = wythe(&["run", &couplet(), "--out", &out.display().to_string()]);
        assert_eq!(code(&output), 4, "{}", stderr(&output));
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
        assert!(!out.join("summary.json").exists());
    }
}

/// A device is written to as it is, never replaced by a file.
#[test]
#[cfg(target_os = "linux")]
fn answers_go_to_devices_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    std::fs::write(
        &path,
        "eps_xx,eps_yy,eps_zz,gam_xy,gam_yz,gam_zx\n1e-5,0,0,0,0,0\n",
    )
    .unwrap();
    let (path, model) = (path.display().to_string(), couplet());
    let drive = [
        "drive", "material", "brick", "--model", &model, "--path", &path, "--out",
    ];
    let output = wythe(&[&drive[..], &["/dev/full"]].concat());
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert!(
        stderr(&output).contains("the disk is full"),
        "{}",
        stderr(&output)
    );
    // The device is still one: nothing was moved over it.
    use std::os::unix::fs::FileTypeExt;
    let device = std::fs::metadata("/dev/full").unwrap().file_type();
    assert!(device.is_char_device());
    let output = wythe(&[&drive[..], &["/dev/stdout"]].concat());
    assert_eq!(
        column(&String::from_utf8(output.stdout).unwrap(), "d"),
        [0.0]
    );
}

/// The second step cannot converge: one iteration for a tolerance below rounding, and no cut.
#[test]
fn lost_convergence_exits_with_3_keeps_what_was_and_says_what_to_try() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let model = repository("examples/02_couplet_shear.toml")
        .display()
        .to_string();
    let output = wythe(&[
        "run",
        &model,
        "--out",
        &out.display().to_string(),
        "--set",
        "steps.1.tolerance = { residual = 1e-15, max_iterations = 1 }",
        "--set",
        "steps.1.increments = { initial = 0.1, max = 0.1, min = 0.1 }",
    ]);
    assert_eq!(code(&output), 3, "{}", stderr(&output));
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let steps = column(&history, "step");
    assert!(
        !steps.is_empty() && steps.iter().all(|s| *s == 0.0),
        "{steps:?}"
    );
    let times = column(&history, "time");
    assert_eq!(times.last(), Some(&1.0)); // the preload is whole
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "not_converged");
    assert_eq!(summary["increments"].as_f64(), Some(steps.len() as f64));
    let message = summary["message"].as_str().unwrap();
    for part in [
        "step 1 (drive), 0.00 % of it done",
        "no equilibrium within 1 iterations",
        "worst at node ",
        " of unit ",
        "try steps.1.tolerance.max_iterations",
        "steps.1.increments.min below 1e-1",
    ] {
        assert!(message.contains(part), "{part} is not in {message}");
    }
    // The command says the same.
    assert!(
        stderr(&output).contains("steps.1.increments.min below"),
        "{}",
        stderr(&output)
    );
    for name in [
        "results.vtkhdf",
        "load_displacement.svg",
        "crack_pattern.svg",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

/// One implicit step a row of the shear path at −0.5 MPa is a stored curve of theory C.
#[test]
fn an_interface_point_follows_its_stored_curve() {
    let path = repository("tests/data/golden/itf_T1_mode2_sig0.5.csv");
    let golden = std::fs::read_to_string(&path).unwrap();
    let (path, model) = (path.display().to_string(), couplet());
    let mut arguments = vec![
        "drive",
        "interface",
        "joint",
        "--model",
        &model,
        "--path",
        &path,
    ];
    arguments.extend(STIFFNESSES);
    let output = wythe(&arguments);
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
            // The stiffness has ten digits in the file, and the curve is good to 1e-12.
            assert!((a - b).abs() < 1e-9, "{name} in row {row}: {a} against {b}");
        }
    }
    // The path is repeated.
    assert_eq!(column(&answer, "d1_mm"), column(&golden, "d1_mm"));
}

/// The same shear, the pressure held by stress: its opening is solved for.
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
    let (path, model) = (path.display().to_string(), couplet());
    let out = folder.path().join("out.csv").display().to_string();
    let mut arguments = vec![
        "drive",
        "interface",
        "joint",
        "--model",
        &model,
        "--path",
        &path,
        "--out",
        &out,
        "--stress",
        "normal",
    ];
    arguments.extend(STIFFNESSES);
    let output = wythe(&arguments);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let answer = std::fs::read_to_string(&out).unwrap();
    for sigma in column(&answer, "sig_MPa") {
        assert!((sigma + 0.5).abs() < 1e-10, "{sigma}"); // the driver's tolerance
    }
    for u in column(&answer, "u_mm") {
        // u = σ/k_n; the tolerance over k_n is 1e-15.
        assert!((u + 0.5 / 99000.0).abs() < 1e-14, "{u}");
    }
    // Beyond delta_k nothing but friction: μ·0.5.
    let tau = column(&answer, "tau1_MPa");
    assert!((tau.last().unwrap() - 0.73 * 0.5).abs() < 1e-9, "{tau:?}");
}

/// Uniaxial tension with free sides gives back the table of the deck (theory A.5, eff1).
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
    let model = repository("examples/03_shear_wall_j7d.toml")
        .display()
        .to_string();
    let path = path.display().to_string();
    let output = wythe(&[
        "drive",
        "material",
        "brick",
        "--model",
        &model,
        "--path",
        &path,
        "--stress",
        "yy",
        "--stress",
        "zz",
        // The table is that of the inviscid law.
        "--set",
        "materials.brick.viscosity=0",
    ]);
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
        // The polyline is exact for eff1 where the lateral stress is zero; it is so to 1e-10 MPa.
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
    let model = couplet();
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
        let (path, out_text) = (path.display().to_string(), out.display().to_string());
        let mut arguments = vec![
            "drive",
            "interface",
            "joint",
            "--model",
            &model,
            "--path",
            &path,
            "--out",
            &out_text,
        ];
        arguments.extend(STIFFNESSES);
        let output = wythe(&arguments);
        assert_eq!(code(&output), 2);
        // The folder's name may be wrapped in the middle: joined words lose nothing else.
        let said = stderr(&output).replace(' ', "");
        assert!(said.contains(&expected.replace(' ', "")), "{said}");
        assert!(!out.exists());
    }
    let missing = [
        "drive",
        "interface",
        "joint",
        "--model",
        &model,
        "--path",
        "no/such.csv",
    ];
    assert_eq!(code(&wythe(&[&missing[..], &STIFFNESSES[..]].concat())), 4);
    let output = wythe(&missing);
    assert_eq!(
        code(&output),
        2,
        "stiffnesses are missing: the model comes first"
    );
}

#[test]
fn a_point_beyond_its_strength_exits_with_3_and_keeps_the_rows_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pull.csv");
    std::fs::write(&path, "sig_MPa,d1_mm,d2_mm\n0.1,0,0\n0.2,0,0\n0.9,0,0\n").unwrap();
    let (path, model) = (path.display().to_string(), couplet());
    let mut arguments = vec![
        "drive",
        "interface",
        "joint",
        "--model",
        &model,
        "--path",
        &path,
        "--stress",
        "normal",
    ];
    arguments.extend(STIFFNESSES);
    let output = wythe(&arguments);
    assert_eq!(code(&output), 3, "{}", stderr(&output));
    let answer = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(column(&answer, "sig_MPa").len(), 2);
    let said = stderr(&output);
    // f_t = 0.28 MPa: (0.28 - 0.2)/(0.9 - 0.2) of the way.
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

/// Drives a brick of the shear wall by `rows` of the columns in `header`; exit code, answer, errors.
fn brick(header: &str, rows: &[[f64; 6]], stress: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.csv");
    let mut text = format!("{header}\n");
    for row in rows {
        text += &row.map(|v| format!("{v:?}")).join(",");
        text.push('\n');
    }
    std::fs::write(&path, text).unwrap();
    let model = repository("examples/03_shear_wall_j7d.toml")
        .display()
        .to_string();
    let path = path.display().to_string();
    let mut arguments = vec![
        "drive", "material", "brick", "--model", &model, "--path", &path,
    ];
    for component in stress {
        arguments.extend(["--stress", component]);
    }
    let output = wythe(&arguments);
    let answer = String::from_utf8(output.stdout.clone()).unwrap();
    (code(&output), answer, stderr(&output))
}

const STRESSES: &str = "sig_xx_MPa,sig_yy_MPa,sig_zz_MPa,sig_xy_MPa,sig_yz_MPa,sig_zx_MPa";
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Every component driven by stress, in proportion: the strengths are those of the input. Uniaxial:
/// the table's peaks (11.5 MPa, 3.5 MPa); biaxial: f_b0/f_c0 = 1.16 times the compressive peak.
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
        // Seven digits are printed.
        assert!(
            (reached - direction[0] * strength).abs() < 1e-5,
            "{reached} for {direction:?}"
        );
        assert!(said.contains("row 40"), "{said}");
    }
}

/// Shear at constant compression, the sides free: a peak, then softening, the pressure held all the
/// way. More pressure, more shear.
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

/// Sends a signal to a process, as a terminal does.
#[cfg(unix)]
fn signal(name: &str, child: &std::process::Child) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

/// A couplet in so many increments that there is time to interrupt it, once it has written a few.
#[cfg(unix)]
fn long_run(out: &Path) -> std::process::Child {
    use std::process::Stdio;
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(["run", &couplet(), "--threads", "1", "--out"])
        .arg(out)
        .args(["--set", "steps.0.increments.max=0.0002"])
        .args(["--set", "steps.0.increments.initial=0.0002"])
        .args(["--set", "steps.0.increments.min=1e-9"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let rows = || {
        let text = std::fs::read_to_string(out.join("history.csv")).unwrap_or_default();
        text.lines().count()
    };
    while rows() < 12 {
        assert!(
            child.try_wait().unwrap().is_none(),
            "ended before it could be interrupted"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child
}

#[test]
#[cfg(unix)]
fn an_interrupt_finishes_the_increment_writes_everything_and_exits_with_130() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = long_run(&out);
    signal("-INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "interrupted");
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    assert!(history.ends_with('\n'));
    let increments = column(&history, "increment");
    assert_eq!(increments.last().copied(), summary["increments"].as_f64());
    assert!(out.join("load_displacement.svg").is_file());
}

/// The first increment of a fine wall takes long enough to be asked twice.
#[test]
#[cfg(unix)]
fn a_second_interrupt_stops_at_once() {
    use std::process::Stdio;
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .arg("run")
        .arg(repository("examples/03_shear_wall_j7d.toml"))
        .args(["--threads", "1", "--set", "wall.mesh=fine", "--out"])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The files are begun after the command has begun to listen.
    while !out.join("results.vtkhdf").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended before it began");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    signal("-INT", &child);
    let mut said = std::io::BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(said.any(|line| line.unwrap().contains("Ctrl-C again stops at once")));
    signal("-INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    // No increment was finished, and nothing says that the run is whole.
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    assert_eq!(history.lines().count(), 1, "{history}");
    assert!(!out.join("summary.json").exists());
}

#[test]
#[cfg(unix)]
fn a_killed_run_leaves_whole_rows_and_no_summary() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = long_run(&out);
    signal("-KILL", &child);
    assert_eq!(child.wait().unwrap().code(), None);
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    assert!(history.ends_with('\n'));
    // Every row parses, to the last cell.
    assert!(column(&history, "out_of_balance").len() >= 11);
    assert!(!out.join("summary.json").exists());
}
