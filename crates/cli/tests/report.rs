//! The command `wythe report`: its page, its output and its exit codes.

mod common;

use std::path::Path;

use common::*;

/// Runs the couplet of the examples with a small displacement. Returns its folder.
fn run(folder: &Path) -> String {
    let out = folder.join("couplet.out").display().to_string();
    let set = "steps.1.displacement=0.01 mm";
    let run = wythe(&["run", &couplet(), "--out", &out, "--set", set]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    out
}

#[test]
fn a_page_is_written_into_the_folder_or_elsewhere_and_its_size_told() {
    let folder = tempfile::tempdir().unwrap();
    let out = run(folder.path());
    let report = wythe(&["report", &out]);
    assert_eq!(code(&report), 0, "{}", stderr(&report));
    let said = String::from_utf8_lossy(&report.stdout).into_owned();
    assert!(
        said.contains("report.html: ") && said.contains(" MB, "),
        "{said}"
    );
    let page = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(page.contains("<title>Couplet in tension</title>"));
    assert!(page.len() < 2_000_000);

    let measured = folder.path().join("measured.csv");
    std::fs::write(
        &measured,
        "# of mine\ndisplacement_mm,force_kN\n0,0\n0.01,7\n",
    )
    .unwrap();
    let page = folder.path().join("page.html");
    let (page, measured) = (page.display().to_string(), measured.display().to_string());
    let report = wythe(&["report", &out, "--experiment", &measured, "--out", &page]);
    assert_eq!(code(&report), 0, "{}", stderr(&report));
    assert!(
        std::fs::read_to_string(&page)
            .unwrap()
            .contains("measured 7.000 kN")
    );

    // The next run removes the page of the last one.
    run(folder.path());
    assert!(!Path::new(&out).join("report.html").exists());

    // For a killed run the page is written and the missing parts are reported.
    std::fs::remove_file(Path::new(&out).join("summary.json")).unwrap();
    std::fs::remove_file(Path::new(&out).join("results.vtkhdf")).unwrap();
    let report = wythe(&["report", &out]);
    assert_eq!(code(&report), 0, "{}", stderr(&report));
    assert!(
        stderr(&report).contains("has no results.vtkhdf"),
        "{}",
        stderr(&report)
    );
}

#[test]
fn what_cannot_be_read_or_written_is_named_and_exits_as_other_commands_do() {
    let folder = tempfile::tempdir().unwrap();
    let out = run(folder.path());
    let measured = folder.path().join("measured.csv").display().to_string();
    let told = |arguments: &[&str], exit: i32, said: &str| {
        let report = wythe(&[&["report"], arguments].concat());
        assert_eq!(code(&report), exit, "{arguments:?}: {}", stderr(&report));
        assert!(stderr(&report).contains(said), "{}", stderr(&report));
    };
    told(
        &[&folder.path().display().to_string()],
        4,
        "no results of a run",
    );
    told(&[&out, "--experiment", &measured], 4, "check the path");
    std::fs::write(&measured, "displacement_mm,force_kN\n0,zero\n").unwrap();
    told(
        &[&out, "--experiment", &measured],
        2,
        "`zero` in the column",
    );
    told(&[&out, "--experiment", &measured], 2, "put # before lines");
    let nowhere = folder.path().join("not/there.html").display().to_string();
    told(&[&out, "--out", &nowhere], 4, "there.html");
    told(&[], 2, "DIR");
}
