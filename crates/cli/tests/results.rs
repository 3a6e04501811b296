//! Commands that read results: pictures, comparisons, descriptions, and the formats of other programs.

mod common;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use common::*;

/// The couplet pulled to 0.8 of the peak of its second step, run once for all tests.
fn run() -> &'static Path {
    static RUN: OnceLock<PathBuf> = OnceLock::new();
    RUN.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("read/couplet.out");
        let out = folder.display().to_string();
        let stop = "steps.1.stop={ below_peak = 0.8 }";
        let sets = ["--set", "steps.1.displacement=0.014", "--set", stop];
        let output = wythe(&[&["run", &couplet(), "--out", &out][..], &sets].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        folder
    })
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn said(output: &std::process::Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_step_stops_below_its_peak_completed_and_says_so() {
    let summary = std::fs::read_to_string(run().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "completed");
    let log = summary["log"].to_string();
    assert!(
        log.contains("step 1 (drive) ends at") && log.contains("stop.below_peak is 0.8"),
        "{log}"
    );
    let history = std::fs::read_to_string(run().join("history.csv")).unwrap();
    let (steps, forces) = (column(&history, "step"), column(&history, "force_kN"));
    let second: Vec<f64> = steps
        .iter()
        .zip(&forces)
        .filter(|p| *p.0 == 1.0)
        .map(|p| *p.1)
        .collect();
    let peak = second.iter().copied().fold(0.0, f64::max);
    let (last, before) = second.split_last().unwrap();
    assert!(*last <= 0.8 * peak && before.iter().all(|f| *f > 0.8 * peak));
    // The last increment has a frame.
    let output = wythe(&["info", &text(run())]);
    assert!(said(&output).contains("ends at"), "{}", said(&output));
}

/// If a step ends early, the next begins from its end.
#[test]
fn a_step_stops_at_a_displacement_and_the_next_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("couplet.out");
    let set = [
        "--set",
        "steps.0.stop.displacement='0.0015 mm'",
        "--set",
        "steps.1.displacement=0.002",
    ];
    let output = wythe(&[&["run", &couplet(), "--out", &text(&out)][..], &set].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let (steps, moved) = (
        column(&history, "step"),
        column(&history, "displacement_mm"),
    );
    let first = steps.iter().filter(|s| **s == 0.0).count();
    // The step ends at the first increment that reaches the displacement, which is no larger than 0.0125 of 0.006
    // mm.
    assert!(
        (0.0015..0.0015 + 0.0125 * 0.006 + 1e-12).contains(&moved[first - 1]),
        "{}",
        moved[first - 1]
    );
    assert!((moved[moved.len() - 1] - moved[first - 1] - 0.002).abs() < 1e-12);
}

#[test]
fn stops_that_cannot_be_are_refused_with_their_key() {
    for (set, key) in [
        ("steps.0.stop={}", "steps.0.stop:"),
        ("steps.0.stop={ below_peak = 1 }", "steps.0.stop.below_peak"),
        (
            "steps.0.stop={ displacement = '9 mm' }",
            "steps.0.stop.displacement",
        ),
    ] {
        let output = wythe(&["check", &couplet(), "--set", set]);
        assert_eq!(code(&output), 2, "{set}");
        assert!(stderr(&output).contains(key), "{set}: {}", stderr(&output));
        assert!(stderr(&output).contains("help:"), "{set}");
    }
    let wall = text(&repository("examples/03_shear_wall_j7d.toml"));
    let output = wythe(&["check", &wall, "--set", "steps.0.stop={ below_peak = 0.8 }"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("`stop` belongs to a drive"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn pictures_are_drawn_beside_experiments_and_other_runs() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one.csv", "two.csv"].map(|name| folder.path().join(name));
    std::fs::write(&one, "displacement_mm,force_kN\n0,0\n0.003,5\n0.02,3\n").unwrap();
    std::fs::write(
        &two,
        "# softer\ndeflection [mm];load [N]\n0;0\n0,004;4500\n0,02;2500\n",
    )
    .unwrap();
    let out = folder.path().join("pictures");
    let output = wythe(&[
        "plot",
        &text(run()),
        "--compare",
        &text(&one),
        &text(&two),
        "--against",
        &text(run()),
        "--frame",
        "peak",
        "--png",
        "--out",
        &text(&out),
    ]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let curves = std::fs::read_to_string(out.join("curves.svg")).unwrap();
    for part in [
        "couplet",
        "one",
        "two",
        "from lowest to highest",
        "force [kN]",
    ] {
        assert!(curves.contains(part), "{part}");
    }
    assert!(out.join("deflection_height.svg").is_file());
    for line in said(&output).lines() {
        let bytes = std::fs::read(line).unwrap();
        let begins: &[u8] = if line.ends_with("png") {
            b"\x89PNG\r\n\x1a\n"
        } else {
            b"<svg"
        };
        assert!(bytes.starts_with(begins), "{line}");
    }
    for name in ["curves", "cracks_", "deflection_height"] {
        let of_name = |line: &&str| line.contains(name);
        assert_eq!(said(&output).lines().filter(of_name).count(), 2, "{name}");
    }
}

/// Columns over each other, either face, a section and an oblique view, each with its own file.
#[test]
fn columns_faces_and_sections_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let out = text(folder.path());
    let drawn = |more: &[&str]| {
        let output = wythe(&[&["plot", &text(run()), "--out", &out], more].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        said(&output).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let read = |name: &str| std::fs::read_to_string(name).unwrap();
    let of = ["--x", "time", "--y", "force_kN", "--y", "external_work_J"];
    let columns = drawn(&of);
    assert_eq!(columns.len(), 1, "{columns:?}");
    assert!(columns[0].ends_with("force_kN_and_more_over_time.svg"));
    let svg = read(&columns[0]);
    assert!(svg.contains("time [s]") && svg.contains("external work [J]"));
    // Curves have hundredths of a pixel.
    let line = svg.split("<polyline points=\"").nth(1).unwrap();
    assert!(line.split(' ').take(20).any(|point| !point.contains(".00")));
    let wall = |more: &[&str], ending: &str| {
        let files = drawn(more).into_iter();
        let cracks: Vec<String> = files.filter(|f| f.contains("cracks_")).collect();
        assert!(cracks[0].ends_with(ending), "{cracks:?}");
        read(&cracks[0])
    };
    let front = wall(&["--scale", "50"], ".svg");
    let back = wall(&["--face", "back", "--scale", "50"], "_back.svg");
    assert!(front.contains("displacements × 50") && front.contains("class=\"support\""));
    assert!(back.contains("seen from +y") && back != front);
    wall(&["--view", "iso"], "_iso.svg");
    wall(&["--view=-20,30"], "_-20_30.svg");
    let section = wall(&["--section", "y=25"], "_y25.svg");
    assert!(section.contains("section y = 25 mm"));
}

#[test]
fn an_animation_has_a_frame_for_each_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let [gif, pictures] = ["a.gif", "pictures"].map(|name| text(&folder.path().join(name)));
    let small = ["animate", &text(run()), "--width", "120", "--most", "4"];
    let output = wythe(&[&small[..], &["--out", &gif]].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(std::fs::read(&gif).unwrap().starts_with(b"GIF89a"));
    let output = wythe(&[&small[..], &["--png", "--out", &pictures, "--view", "iso"]].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(said(&output).lines().count(), 4);
    assert_eq!(std::fs::read_dir(&pictures).unwrap().count(), 4);
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let run = text(run());
    for (arguments, wanted) in [
        (&["plot", &run, "--y", "force_kn"][..], "`force_kN`"),
        (&["plot", &run, "--x", "procedure"], "no column `procedure`"),
        (
            &["plot", &run, "--section", "z=9999"],
            "no part of the model lies at z = 9999",
        ),
        (
            &["animate", &run, "--section", "x=-5"],
            "the model reaches from x =",
        ),
        (&["plot", &run, "--section", "5"], "expected an axis and mm"),
        (&["plot", &run, "--face", "iso"], "expected front, back"),
        (
            &["plot", &run, "--face", "back", "--view", "iso"],
            "cannot be used with",
        ),
        (&["animate", &run, "--frame", "1"], "--frame"),
    ] {
        let output = wythe(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(
            stderr(&output).contains(wanted),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
}

#[test]
fn a_run_is_its_own_equal_in_text_and_json() {
    let history = text(&run().join("history.csv"));
    let output = wythe(&["compare", &text(run()), &history, "--json"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["ratio"]["peak_force_kN"], 1.0);
    assert_eq!(found["rms_difference_kN"], 0.0);
    // The couplet is pulled upwards, so there is no drift.
    assert!(found["height_mm"].is_null());
    let output = wythe(&["compare", &text(run()), &history, "--height", "50"]);
    for part in [
        "largest force [kN]",
        "1.000",
        "drift over 50.0 mm",
        "rms difference 0.00 kN",
    ] {
        assert!(said(&output).contains(part), "{part}: {}", said(&output));
    }
}

#[test]
fn a_bad_experiment_is_told_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.csv");
    std::fs::write(&path, "# a\ndisplacement_mm,force_kN\n0,0\n1,many\n").unwrap();
    for command in [
        &["compare", &text(run()), &text(&path)][..],
        &["plot", &text(run()), "--compare", &text(&path)],
    ] {
        let output = wythe(command);
        assert_eq!(code(&output), 2);
        let said = stderr(&output).replace(' ', "");
        assert!(
            said.contains("bad.csv:4:") && said.contains("`many`") && said.contains("help:"),
            "{said}"
        );
    }
    let output = wythe(&["compare", &text(run()), "no/such.csv"]);
    assert_eq!(code(&output), 4);
}

#[test]
fn info_tells_of_folders_fields_and_models() {
    let of = |path: &str| {
        let output = wythe(&["info", path]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert!(said(&output).lines().count() <= 40);
        said(&output)
    };
    let folder = of(&text(run()));
    for part in [
        "Couplet",
        "completed",
        "2 units",
        "peak",
        "frames",
        "history.csv",
        "balance closes",
    ] {
        assert!(folder.contains(part), "{part}: {folder}");
    }
    let fields = of(&text(&run().join("results.vtkhdf")));
    assert!(
        fields.contains("contact points") && fields.contains("brick"),
        "{fields}"
    );
    let model = of(&couplet());
    assert!(
        model.contains("1: drive") && model.contains("unknowns"),
        "{model}"
    );
    for (path, exit) in [
        ("no/such", 4),
        ("Cargo.toml", 2),
        ("src", 4),
        ("src/main.rs", 2),
    ] {
        assert_eq!(code(&wythe(&["info", path])), exit, "{path}");
    }
}

#[test]
fn a_model_is_exported_without_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = text(folder.path());
    let model = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/08_block_couplet.toml"
    );
    for (format, files) in [
        ("inp", &["model.inp"][..]),
        ("vtu", &["model.vtu", "model_surfaces.vtu"]),
    ] {
        let set = "steps.1.displacement=0.5";
        let output = wythe(&["export", model, "--to", format, "--out", &out, "--set", set]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        for file in files {
            assert!(said(&output).contains(file));
        }
    }
    let inp = std::fs::read_to_string(folder.path().join("model.inp")).unwrap();
    for part in [
        "*SURFACE, TYPE=ELEMENT, NAME=SLAVE_JOINT\n_SLAVE_JOINT_S1, S1\n",
        "*SURFACE, TYPE=ELEMENT, NAME=MASTER\n_MASTER_S2, S2\n",
        "*FRICTION\n0.73\n",
        "SLAVE_JOINT, MASTER, JOINT\n",
        "*RIGID BODY, REF NODE=43, TIE NSET=BEAM_UPPER_TOP\n",
        "REFERENCE_UPPER_TOP, 3, -10000.0\n",
        "REFERENCE_UPPER_TOP, 1, 1, 0.5\n",
    ] {
        assert!(inp.contains(part), "{part}\n{inp}");
    }
    for (rest, part) in [
        (&["--to", "csv"][..], "nothing has moved yet"),
        (
            &["--to", "vtu", "--frame", "last"][..],
            "nothing has moved yet",
        ),
    ] {
        let output = wythe(&[&["export", model][..], rest].concat());
        assert_eq!(code(&output), 2);
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
}

#[test]
fn a_run_of_an_imported_mesh_is_exported_wherever_it_lies() {
    let folder = tempfile::tempdir().unwrap();
    let out = text(&folder.path().join("moved"));
    let model = text(&repository("examples/50_imported_mesh.toml"));
    let output = wythe(&[
        "run",
        &model,
        "--out",
        &out,
        "-q",
        "--set",
        "steps.1.displacement=0.01",
    ]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    // The mesh lies beside the original deck, not in the folder of the run.
    let output = wythe(&["export", &out, "--to", "inp"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let written = std::fs::read_to_string(folder.path().join("moved/export/model.inp")).unwrap();
    assert!(written.contains("BEAM_COUPLET_UPPER_TOP"), "{written}");
}

#[test]
fn exports_are_written_and_damaged_files_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = text(folder.path());
    for (format, frame, files) in [
        ("csv", Some("peak"), 3),
        ("vtu", None, 2),
        ("inp", None, 1),
        ("obj", None, 1),
    ] {
        let mut command = vec![
            "export",
            run().to_str().unwrap(),
            "--to",
            format,
            "--out",
            &out,
        ];
        command.extend(frame.into_iter().flat_map(|f| ["--frame", f]));
        let output = wythe(&command);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert_eq!(said(&output).lines().count(), files);
    }
    let inp = std::fs::read_to_string(folder.path().join("model.inp")).unwrap();
    assert!(inp.contains("*NSET, NSET=BEAM_TOP") && inp.contains("*NSET, NSET=SUPPORT_BOTTOM"));
    let run_folder = text(run());
    for (rest, exit, part) in [
        (&["--to", "vtu", "--frame", "999"][..], 2, "no frame 999"),
        (&["--to", "inp", "--frame", "peak"][..], 2, "at rest"),
        (&["--to", "step"][..], 2, "invalid value"),
    ] {
        let output = wythe(&[&["export", &run_folder][..], rest].concat());
        assert_eq!(code(&output), exit);
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    // For half a file of fields the error names the file and is not a bug.
    let half = folder.path().join("half.out");
    std::fs::create_dir(&half).unwrap();
    std::fs::copy(run().join("history.csv"), half.join("history.csv")).unwrap();
    let fields = std::fs::read(run().join("results.vtkhdf")).unwrap();
    std::fs::write(half.join("results.vtkhdf"), &fields[..fields.len() / 2]).unwrap();
    let half_run = text(&half);
    for command in [&["export", "--to", "vtu"][..], &["plot"]] {
        let output = wythe(&[command, &[half_run.as_str()]].concat());
        assert_eq!(code(&output), 4, "{}", stderr(&output));
        assert!(
            stderr(&output).replace(' ', "").contains("results.vtkhdf"),
            "{}",
            stderr(&output)
        );
    }
    let output = wythe(&["info", &text(&half)]);
    assert!(said(&output).contains("no summary") && said(&output).contains("cannot be resumed"));
}

#[test]
fn answers_are_in_the_summary_and_in_what_info_says() {
    let summary = std::fs::read_to_string(run().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let answers = &summary["answers"];
    // A couplet that is pulled: nothing is driven sideways.
    assert!(answers["height_mm"].is_null() && answers["failure_mode"].is_null());
    let bilinear = &answers["bilinear"];
    assert_eq!(bilinear["reached_80_percent"], true);
    let at = |key: &str| bilinear[key].as_f64().unwrap();
    let yields = at("ultimate_force_kN") / at("stiffness_kN_per_mm");
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12; // a few operations
    assert!(close(yields, at("yield_displacement_mm")), "{bilinear}");
    let ductility = at("ultimate_displacement_mm") / yields;
    assert!(close(ductility, at("ductility")), "{bilinear}");
    let first = &answers["first_damage"]["joint"];
    assert_eq!(first["place"]["interface"], "joint");
    assert_eq!(first["place"]["bodies"].as_array().unwrap().len(), 2);
    let history = std::fs::read_to_string(run().join("history.csv")).unwrap();
    let damage = column(&history, "max_interface_damage");
    let row = damage.iter().position(|d| *d > 0.0).unwrap();
    assert_eq!(first["increment"], row + 1);
    assert_eq!(first["force_kN"], column(&history, "force_kN")[row]);
    let info = said(&wythe(&["info", &text(run())]));
    for part in ["bilinear ", "first ", "joint softens at", "cracks "] {
        assert!(info.contains(part), "{part} in {info}");
    }
    // The opening at the end, from the fields of the run.
    let output = wythe(&[
        "export",
        &text(run()),
        "--to",
        "csv",
        "--out",
        &text(&run().join("t")),
    ]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let table = std::fs::read_dir(run().join("t")).unwrap();
    let table = table.map(|entry| entry.unwrap().path());
    let table = table.filter(|path| text(path).ends_with("_interfaces.csv"));
    let table = std::fs::read_to_string(table.last().unwrap()).unwrap();
    let widest = column(&table, "opening_mm").into_iter().fold(0.0, f64::max);
    assert_eq!(answers["cracks_at_end"]["joint"]["width_mm"], widest);
    std::fs::remove_dir_all(run().join("t")).unwrap();
}

#[test]
fn drifts_of_the_user_are_told_and_wrong_ones_refused() {
    let info = |more: &[&str]| wythe(&[&["info", &text(run())], more].concat());
    let output = info(&["--drifts", "0.01 %, 0.0001", "--height", "100"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    // Both are 0.01 mm; the force is that of the curve there.
    let lines: Vec<String> = said(&output)
        .lines()
        .filter(|line| line.contains("0.010 mm"))
        .map(|line| line.trim_start_matches("  drifts").trim().to_owned())
        .collect();
    assert_eq!(lines.len(), 2, "{}", said(&output));
    assert_eq!(lines[0], lines[1]);
    assert!(lines[0].contains("kN"), "{}", lines[0]);
    for (arguments, why) in [
        (&["--drifts", "0.1 %"][..], "no clear height"),
        (&["--drifts", "none"], "`none` is no number above 0"),
        (&["--drifts=-1 %"], "no number above 0"),
        (&["--height", "100"], "--drifts"),
    ] {
        let output = info(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(stderr(&output).contains(why), "{}", stderr(&output));
    }
    let output = wythe(&["info", &couplet(), "--drifts", "1 %"]);
    assert_eq!(code(&output), 2);
}
