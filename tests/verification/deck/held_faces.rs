//! Loads on held nodes, and faces of which supports hold a part.

use crate::common::blocks::{HEAD, deck};
use crate::common::masonry::MATERIALS;
use wythe::model::Model;

/// A block of 2 × 2 × 2 elements.
const CUBE: &str =
    "[[blocks]]\nname = \"a\"\nsize = [100, 100, 100]\nmaterial = \"stone\"\nmesh = [2, 2, 2]\n";

fn warnings(text: &str) -> Vec<String> {
    let (_, warnings) = Model::from_deck(&deck(text)).unwrap_or_else(|e| panic!("{e}"));
    warnings.iter().map(ToString::to_string).collect()
}

/// Warnings about a load of this force on a place, in a step after those of `scene`.
fn of_load(scene: &str, on: &str, force: [f64; 3]) -> Vec<String> {
    warnings(&format!(
        "{scene}[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"push\"\non = \"{on}\"\nforce = {force:?}\n"
    ))
    .into_iter()
    .filter(|warning| warning.contains("push"))
    .collect()
}

#[track_caller]
fn one(warnings: &[String], parts: &[&str]) {
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    for part in parts {
        assert!(warnings[0].contains(part), "{part}: {warnings:?}");
    }
}

/// A load on nodes that a support holds moves nothing, and the support is named.
#[test]
fn loads_on_supports_are_named() {
    let held = format!("{HEAD}{CUBE}[[supports]]\non = \"a\"\n");
    one(
        &of_load(&held, "a.top", [1e3, 0.0, 0.0]),
        &[
            "steps.0.loads.0",
            "all of `push` along x acts on nodes that the support on a holds there: it moves nothing",
            "`fixed`",
        ],
    );
    // All six of nine nodes at the foot: their weights are three quarters of the face.
    let half = format!("{HEAD}{CUBE}[[supports]]\non = \"a.bottom\"\n");
    let part = format!("{half}box = [[0, 0, 0], [50, 100, 0]]\n");
    one(
        &of_load(&part, "a.bottom", [0.0, 1e3, 0.0]),
        &["75 % of `push` along y", "this part moves nothing"],
    );
    // One along z acts on nodes that are held along x and y only.
    let sideways =
        format!("{half}fixed = [\"x\", \"y\"]\n[[supports]]\non = \"a.top\"\nfixed = [\"z\"]\n");
    assert!(of_load(&sideways, "a.bottom", [0.0, 0.0, 1e3]).is_empty());
    assert!(of_load(&half, "a.top", [1e3, 1e3, -1e3]).is_empty());
    // A half of the body at most.
    assert!(of_load(&half, "a", [1e3, 0.0, 0.0]).is_empty());
}

/// A face that a preload has pressed is held sideways afterwards, unless the preload frees it.
#[test]
fn loads_on_faces_that_a_step_holds_are_named() {
    let press = |free: &str| {
        format!(
            "{HEAD}{CUBE}[[supports]]\non = \"a.bottom\"\n[[steps]]\nkind = \"preload\"\nface = \"a.top\"\npressure = \
             0.5\n{free}"
        )
    };
    one(
        &of_load(&press(""), "a.top", [1e3, 0.0, -1e3]),
        &[
            "steps.1.loads.0",
            "all of `push` along x acts on nodes that the face a.top of a step holds there: it moves nothing",
            "free = [\"x\"]",
        ],
    );
    assert!(of_load(&press("free = [\"x\"]\n"), "a.top", [1e3, 0.0, 0.0]).is_empty());
}

/// The level beam on a clamped wall moves sideways by drives only.
#[test]
fn loads_on_the_level_beam_are_named() {
    let wall = format!(
        "{MATERIALS}[wall]\nunit = [215, 102.5, 65]\nbed_joint = 10\nhead_joint = 10\nunit_material = \"brick\"\n\
         mortar_material = \"mortar\"\ninterface = \"joint\"\nlength = 440\ncourses = 4\nclamped = {{ bottom_courses = 1, \
         top_courses = 1 }}\n[[steps]]\nkind = \"preload\"\ntop_pressure = \"0.3 MPa\"\n"
    );
    for on in ["wall.top", "wall.course-3"] {
        one(
            &of_load(&wall, on, [3e7, 0.0, 0.0]),
            &["`push` along x", "the level beam on the wall holds there"],
        );
    }
    assert!(of_load(&wall, "wall.course-1", [1e3, 0.0, 0.0]).is_empty());
}

/// A drive of a face of which a support holds some nodes in its direction is an error.
#[test]
fn a_driven_face_has_no_held_nodes() {
    let drive = |on: &str, direction: &str| {
        format!(
            "{HEAD}{CUBE}[[supports]]\non = \"a.bottom\"\n{on}[[steps]]\nkind = \"drive\"\nface = \"a.left\"\ndirection = \
             {direction}\ndisplacement = 0.01\n"
        )
    };
    let error = Model::from_deck(&deck(&drive("", "\"x\""))).unwrap_err();
    assert_eq!(error.key(), "steps.0.face");
    assert!(
        error.message().contains(
            "the support on a.bottom holds 3 of the 9 nodes of a.left in x, in which step 0 (drive) drives it"
        ),
        "{error}"
    );
    assert!(error.advice().contains("`box`"), "{error}");
    // Not where the support holds other directions, or the face moves by rounding in its direction.
    for (on, direction) in [
        ("fixed = [\"y\", \"z\"]\n", "\"x\""),
        (
            "fixed = [\"x\", \"z\"]\n[[supports]]\non = \"a.right\"\n",
            "[1e-17, 1, 0]",
        ),
    ] {
        let text = drive(on, direction);
        Model::from_deck(&deck(&text)).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// A face that is free in a direction in which supports hold an edge of it: the edge stays.
#[test]
fn a_freed_face_with_held_nodes_is_a_warning() {
    let text = |free: &str| {
        format!(
            "{HEAD}{CUBE}[[supports]]\non = \"a.left\"\nfixed = [\"x\"]\n[[supports]]\non = \"a.front\"\nfixed = [\"y\"]\n\
             [[supports]]\non = \"a.bottom\"\nfixed = [\"z\"]\n[[steps]]\nkind = \"drive\"\nface = \"a.top\"\n{free}direction \
             = \"-z\"\ndisplacement = 0.1\n"
        )
    };
    let found = |free: &str| -> Vec<String> {
        let all = warnings(&text(free)).into_iter();
        all.filter(|warning| warning.contains("nodes of a.top"))
            .collect()
    };
    one(
        &found("free = [\"x\"]\n"),
        &[
            "steps.0.free",
            "the support on a.left holds 3 of the 9 nodes of a.top in x, in which step 0 (drive) leaves it free",
            "these nodes stay where they are, and the others move as one",
        ],
    );
    assert!(found("").is_empty());
    let pressed = text("").replace("kind = \"drive\"", "kind = \"preload\"\npressure = 1");
    let pressed = pressed.replace("direction = \"-z\"\ndisplacement = 0.1\n", "");
    let held = pressed.replace("on = \"a.left\"\nfixed = [\"x\"]", "on = \"a.left\"");
    let found: Vec<String> = warnings(&held)
        .into_iter()
        .filter(|warning| warning.contains("nodes of a.top"))
        .collect();
    one(
        &found,
        &[
            "steps.0.face",
            "3 of the 9 nodes of a.top in z",
            "presses it",
        ],
    );
}
