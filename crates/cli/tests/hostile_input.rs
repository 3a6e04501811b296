//! Inputs that are not regular files, never end, or contain control characters of the terminal.

mod common;

use std::path::Path;
use std::time::{Duration, Instant};

use common::*;

/// Far more time than a rejection takes, on a busy machine.
const LIMIT: Duration = Duration::from_secs(20);

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let zero = folder.path().join("zero.toml");
    std::os::unix::fs::symlink("/dev/zero", &zero).unwrap();
    let pipe = folder.path().join("pipe.toml");
    let made = std::process::Command::new("mkfifo")
        .arg(&pipe)
        .status()
        .unwrap();
    assert!(made.success());
    for path in [&zero, &pipe] {
        let begun = Instant::now();
        let told = wythe(&["check", &path.display().to_string()]);
        assert_eq!(code(&told), 4, "{}", stderr(&told));
        assert!(
            stderr(&told).contains("no regular file"),
            "{}",
            stderr(&told)
        );
        assert!(begun.elapsed() < LIMIT);
    }
    // Files that a deck names are read with the same checks.
    std::fs::rename(&zero, folder.path().join("zero.stl")).unwrap();
    let deck = folder.path().join("stones.toml");
    std::fs::write(&deck, STONES.replace("FILE", "zero.stl")).unwrap();
    let told = wythe(&["check", &deck.display().to_string()]);
    assert!(
        stderr(&told).contains("no regular file"),
        "{}",
        stderr(&told)
    );
    std::fs::rename(folder.path().join("zero.stl"), &zero).unwrap();
    for (key, name) in [
        ("output.experiment", "zero.toml"),
        ("steps.1.amplitude", "pipe.toml"),
    ] {
        let told = check_beside(folder.path(), &[&format!("{key}={name}")]);
        assert_eq!(code(&told), 2, "{}", stderr(&told));
        assert!(
            stderr(&told).contains("no regular file"),
            "{}",
            stderr(&told)
        );
    }
}

/// A deck of the stones of a file.
const STONES: &str = "format = 1\n[materials.stone]\nE = 5000\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n[[blocks]]\n\
                      name = \"s\"\nfile = \"FILE\"\nmaterial = \"stone\"\n[[supports]]\non = \"s\"\n[[steps]]\n\
                      kind = \"gravity\"\n";

#[test]
fn files_of_stones_with_wrong_counts_end_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
               property float z\nelement face 4000000000\nproperty list uint int vertex_indices\nend_header\n";
    let mut stl = vec![b'x'; 84];
    stl[80..].fill(0xff);
    let objects = format!("[{}0]", "{\"a\":{}},".repeat(3_000_000));
    for (name, contents, part) in [
        (
            "a.ply",
            ply.as_bytes(),
            "4000000000 elements `vertex` are announced",
        ),
        ("a.stl", &stl, "4294967295 triangles are announced"),
        ("a.json", objects.as_bytes(), "no meshes"),
        ("b.json", "[".repeat(1 << 20).as_bytes(), "no JSON"),
        ("a.obj", &vec![0xff; 1 << 20], "is no statement"),
    ] {
        std::fs::write(folder.path().join(name), contents).unwrap();
        let deck = folder.path().join("deck.toml");
        std::fs::write(&deck, STONES.replace("FILE", name)).unwrap();
        let begun = Instant::now();
        let told = wythe(&["check", &deck.display().to_string()]);
        assert_eq!(code(&told), 2, "{}", stderr(&told));
        let said = stderr(&told).replace('│', " ");
        let said: Vec<&str> = said.split_whitespace().collect();
        assert!(said.join(" ").contains(part), "{said:?}");
        assert!(begun.elapsed() < LIMIT, "{name}");
    }
}

fn check_beside(folder: &Path, set: &[&str]) -> std::process::Output {
    let deck = folder.join("wall.toml");
    std::fs::copy(couplet(), &deck).unwrap();
    let deck = deck.display().to_string();
    let mut arguments = vec!["check", deck.as_str()];
    for set in set {
        arguments.extend(["--set", set]);
    }
    wythe(&arguments)
}

#[test]
fn what_a_deck_says_does_not_reach_the_terminal_as_commands() {
    let folder = tempfile::tempdir().unwrap();
    let escape = "\u{1b}]0;owned\u{7}\u{1b}[2J";
    // A title is printed with its control characters escaped.
    let told = check_beside(folder.path(), &["title=\"wall \\u001b[31m\\u0007\""]);
    assert_eq!(code(&told), 0, "{}", stderr(&told));
    let shown = stdout(&told);
    assert!(
        !shown.contains('\u{1b}') && shown.contains("\\u{1b}[31m"),
        "{shown}"
    );
    // Control characters in other names are rejected, and the message shows them escaped.
    for set in [
        "steps.0.name=\"\\u001b[31m\"".to_owned(),
        "wall.unit_material=\"\\u001b[31m\"".to_owned(),
        format!("wall.bond={escape}"),
        format!("{escape}=1"),
    ] {
        let told = check_beside(folder.path(), &[&set]);
        assert_eq!(code(&told), 2, "{set:?}");
        assert!(
            !stderr(&told).contains("\u{1b}]") && !stderr(&told).contains("\u{1b}[2J"),
            "{}",
            stderr(&told)
        );
    }
    let broken = folder.path().join("broken.toml");
    std::fs::write(&broken, format!("format = 1\ntitle = \"{escape}\"\n")).unwrap();
    let told = wythe(&["check", &broken.display().to_string()]);
    assert_eq!(code(&told), 2);
    assert!(!stderr(&told).contains('\u{7}'), "{}", stderr(&told));
}
