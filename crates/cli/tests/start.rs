//! The first steps of a user: templates, the schema, completions, manual pages.

mod common;

use std::path::Path;

use common::*;

/// Every template by name, with overrides that shorten its run.
const SHORT: [(&str, &[&str]); 6] = [
    ("couplet", &["steps.1.displacement=0.01 mm"]),
    ("shear-wall", &["steps.1.displacement=0.02 mm"]),
    ("out-of-plane", &["steps.1.displacement=0.02 mm"]),
    ("arch", &["steps.1.angle=0.5 deg"]),
    ("dry-wall", &["steps.1.angle=0.5 deg"]),
    ("column", &["steps.1.duration=5 ms"]),
];

fn text(path: &Path) -> String {
    path.display().to_string()
}

#[test]
fn every_template_is_listed_passes_check_and_runs() {
    let list = wythe(&["new", "--list"]);
    assert_eq!(code(&list), 0);
    let list = String::from_utf8(list.stdout).unwrap();
    let (templates, tests) = list.split_once("--test\n").unwrap();
    // A line says that these are templates.
    assert_eq!(templates.lines().count(), 1 + SHORT.len(), "{list}");
    assert!(tests.contains("en1052-3"), "{list}");
    let folder = tempfile::tempdir().unwrap();
    for (name, short) in SHORT {
        assert!(list.contains(name), "{name}");
        let stem = text(&folder.path().join(name));
        let made = wythe(&["new", &stem, "--template", name]);
        assert_eq!(code(&made), 0, "{}", stderr(&made));
        let deck = format!("{stem}.toml");
        let checked = wythe(&["check", &deck]);
        assert_eq!(code(&checked), 0, "{name}: {}", stderr(&checked));
        let said = String::from_utf8(checked.stdout).unwrap();
        assert!(!said.contains("warning"), "{name}: {said}");
        let set: Vec<&str> = short.iter().flat_map(|set| ["--set", set]).collect();
        let run = wythe(&[&["run", &deck, "--quiet"], &set[..]].concat());
        assert_eq!(code(&run), 0, "{name}: {}", stderr(&run));
        assert!(run.stdout.is_empty() && run.stderr.is_empty(), "{name}");
        assert!(Path::new(&format!("{stem}.out/summary.json")).is_file());
    }
    assert!(folder.path().join("deck.schema.json").is_file());
}

#[test]
fn a_deck_is_not_overwritten_unless_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("wall.toml");
    std::fs::write(&deck, "mine").unwrap();
    let refused = wythe(&["new", &text(&deck)]);
    assert_eq!(code(&refused), 4);
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    assert_eq!(std::fs::read_to_string(&deck).unwrap(), "mine");
    let forced = wythe(&["new", &text(&deck), "--force", "--template", "arch"]);
    assert_eq!(code(&forced), 0, "{}", stderr(&forced));
    assert!(std::fs::read_to_string(&deck).unwrap().contains("[arch]"));
    // An unknown template and a missing name are rejected.
    let unknown = wythe(&["new", "x", "--template", "arc"]);
    assert_eq!(code(&unknown), 2);
    assert!(stderr(&unknown).contains("arch"), "{}", stderr(&unknown));
    assert_eq!(code(&wythe(&["new"])), 2);
}

#[test]
fn the_schema_is_json_and_stands_beside_a_new_deck() {
    let printed = wythe(&["schema"]);
    assert_eq!(code(&printed), 0);
    let schema: serde_json::Value = serde_json::from_slice(&printed.stdout).unwrap();
    assert!(schema["properties"]["wall"].is_object(), "{schema}");
    let folder = tempfile::tempdir().unwrap();
    let made = wythe(&["new", &text(&folder.path().join("below/wall"))]);
    assert_eq!(code(&made), 0, "{}", stderr(&made));
    let beside = std::fs::read(folder.path().join("below/deck.schema.json")).unwrap();
    assert_eq!(beside, printed.stdout);
}

#[test]
fn shells_have_their_completions() {
    for (shell, parts) in [
        // The first three shells complete values too.
        ("bash", ["complete -F", "shear-wall"]),
        ("zsh", ["#compdef wythe", "shear-wall"]),
        ("fish", ["complete -c wythe", "shear-wall"]),
        ("powershell", ["Register-ArgumentCompleter", "salvage"]),
        ("elvish", ["edit:completion", "salvage"]),
    ] {
        let output = wythe(&["completions", shell]);
        assert_eq!(code(&output), 0, "{shell}");
        let script = String::from_utf8(output.stdout).unwrap();
        for part in parts {
            assert!(script.contains(part), "{shell}: {part}");
        }
    }
    assert_eq!(code(&wythe(&["completions", "cmd"])), 2);
}

#[test]
fn manual_pages_are_printed_and_written() {
    let page = wythe(&["man"]);
    assert_eq!(code(&page), 0);
    assert!(
        String::from_utf8(page.stdout)
            .unwrap()
            .contains(".TH wythe 1")
    );
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("man1");
    let written = wythe(&["man", "--out", &text(&out)]);
    assert_eq!(code(&written), 0, "{}", stderr(&written));
    for name in [
        "wythe",
        "wythe-run",
        "wythe-new",
        "wythe-drive-material",
        "wythe-study-stability",
        "wythe-study-validation",
    ] {
        let page = std::fs::read_to_string(out.join(format!("{name}.1"))).unwrap();
        assert!(page.contains("Example"), "{name}");
    }
}

/// Every help text shows an example of the command.
#[test]
fn every_help_text_has_an_example() {
    for command in [
        &["new"][..],
        &["run"],
        &["check"],
        &["drive"],
        &["drive", "material"],
        &["drive", "interface"],
        &["study"],
        &["study", "stability"],
        &["study", "validation"],
        &["schema"],
        &["completions"],
        &["man"],
        &[],
    ] {
        let help = wythe(&[command, &["--help"]].concat());
        let help = String::from_utf8(help.stdout).unwrap();
        assert!(
            help.contains("Example") && help.contains("  wythe "),
            "{command:?}: {help}"
        );
    }
}

#[test]
fn a_deck_is_written_around_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/import/");
    for name in ["flat.inp", "flat_mesh.inp"] {
        std::fs::copy(format!("{data}{name}"), folder.path().join(name)).unwrap();
    }
    let at = |name: &str| folder.path().join(name).display().to_string();
    let new = |rest: &[&str]| wythe(&[&["new", &at("lime")][..], rest].concat());
    let output = new(&["--from", &at("flat.inp"), "--units", "N, m, s"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = std::fs::read_to_string(folder.path().join("lime.toml")).unwrap();
    for part in [
        "file = \"flat.inp\"",
        "units = \"N, m, s\"",
        "surfaces: lime.BASE, lime.SKIN, lime.TOP",
        "[materials.CLAY]",
        "reference_length = 100.0",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    // With the missing tables added, the deck can be checked.
    let more = "\n[[supports]]\non = \"lime.BASE\"\n[[steps]]\nkind = \"drive\"\nface = \"lime.TOP\"\n\
                direction = \"x\"\ndisplacement = \"0.1 mm\"\n";
    std::fs::write(folder.path().join("lime.toml"), text + more).unwrap();
    let output = wythe(&["check", &at("lime.toml")]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    // Contents of the file that a deck cannot express are left to the user.
    let odd = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
               *ELEMENT,TYPE=C3D8,ELSET=E\n1,1,2,3,4,5,6,7,8\n*SURFACE,NAME=S,TYPE=NODE\n1\n\
               *MATERIAL,NAME=WOOD\n*ELASTIC,TYPE=ORTHO\n1,2,3,4,5,6,7,8\n9\n\
               *SOLID SECTION,ELSET=E,MATERIAL=WOOD\n";
    std::fs::write(at("odd.inp"), odd).unwrap();
    let output = new(&["--from", &at("odd.inp"), "--force"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = std::fs::read_to_string(at("lime.toml")).unwrap();
    for part in [
        "# surface S of nodes is read as a set of nodes",
        "# The material \"WOOD\" of the file cannot be taken: *ELASTIC (line 15): its elasticity is not isotropic",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let check = || wythe(&["check", &at("lime.toml")]);
    assert!(stderr(&check()).contains("write the material in the deck"));
    let wood = text
        .replace("# [materials.", "[materials.")
        .replace("\n# E = ", "\nE = ");
    let wood = wood
        .replace("\n# nu = ", "\nnu = ")
        .replace("\n# density = ", "\ndensity = ");
    let more = "\n[[supports]]\non = \"lime.S\"\n[[supports]]\non = \"lime.E\"\n[[steps]]\nkind = \"gravity\"\n";
    std::fs::write(at("lime.toml"), wood + more).unwrap();
    assert_eq!(code(&check()), 0, "{}", stderr(&check()));

    for (rest, part) in [
        (&["--from", &at("no.inp"), "--force"][..], "no.inp"),
        (
            &["--from", &at("flat.inp"), "--units", "kg", "--force"],
            "no unit of length",
        ),
    ] {
        let output = new(rest);
        assert_eq!(code(&output), 2, "{}", stderr(&output));
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
}
