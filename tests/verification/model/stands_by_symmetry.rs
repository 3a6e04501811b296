//! Whether a model that is solved as a half is stable only because of its symmetry.

use crate::common::blocks::deck_and_model;
use crate::common::scene;
use wythe::state::Status;

/// A column that buckles would be stable as a half, which is held in its plane. The run ends when it detects this,
/// from Euler's load on: π² E I/4 L² = 10,280 N, 0.514 MPa. Twenty elements along it, shear and the compression
/// before it buckles change that by less than the tolerance of a tenth.
#[test]
fn a_column_that_buckles_is_not_solved_as_a_half() {
    let column_with = |pressure: f64, mesh: &str, more: &str| {
        let text = format!(
            r#"format = 1
[materials.stone]
E = 1000
nu = 0
[[blocks]]
name = "column"
size = [200, 100, 2000]
material = "stone"
mesh = {mesh}
[[supports]]
on = "column.bottom"
[[steps]]
kind = "load"
loads = [{{ name = "weight", on = "column.top", traction = [0, 0, -{pressure}] }}]
{more}
"#
        );
        let (_, model) = deck_and_model(&text);
        let summary = scene::run(&model).1;
        assert_eq!(summary.mirror_planes.len(), 2);
        (summary.status, summary.message)
    };
    let column = |pressure, mesh: &str| column_with(pressure, mesh, "");
    let falls = |more: &str| column_with(0.565, "[1, 1, 20]", more).0 == Status::NotConverged;
    // A load that is removed again has acted nevertheless.
    assert!(falls("amplitude = [[0, 0], [0.5, 1], [1, 0]]"));
    // A prop at its head carries 8 times as much; a prop along it, or across the other plane, has no effect.
    let prop = |stiffness: &str| {
        format!("[[springs]]\nname = \"prop\"\non = \"column.top\"\nstiffness = {stiffness}")
    };
    assert!(!falls(&prop("[0, 1e4, 0]")));
    assert!(falls(&prop("[1e4, 0, 0]")));
    assert!(falls(&prop("[0, 0, 100]")));
    // Far beyond Euler's load, where several modes have a negative stiffness.
    for times in [5.0, 12.0, 25.0] {
        let (status, _) = column(times * 0.514, "[2, 2, 10]");
        assert_eq!(status, Status::NotConverged, "{times}");
    }
    // One, two and three elements across the plane out of which it buckles, and as many across the other.
    for mesh in ["[1, 1, 20]", "[2, 2, 20]", "[2, 3, 20]", "[3, 1, 20]"] {
        assert_eq!(column(0.46, mesh).0, Status::Completed, "{mesh}");
        let (status, told) = column(0.565, mesh);
        assert_eq!(status, Status::NotConverged, "{mesh}");
        let plane = "nothing but its symmetry holds the scene in the plane y = 50 mm";
        assert!(told.contains(plane), "{told}");
    }
}

/// A prism that slides freely on its bed may rotate about its axis. This motion is neutral, with or without pressure.
#[test]
fn a_neutral_rotation_does_not_count_as_instability() {
    let text = r#"format = 1
[materials.stone]
E = 1000
nu = 0.2
[[blocks]]
name = "prism"
size = [100, 100, 200]
material = "stone"
mesh = [2, 1, 3]
[[supports]]
on = "prism.bottom"
fixed = ["z"]
[[steps]]
kind = "load"
loads = [{ name = "weight", on = "prism.top", traction = [0, 0, -20] }]
"#;
    let (_, model) = deck_and_model(text);
    let summary = scene::run(&model).1;
    assert_eq!(summary.mirror_planes.len(), 2);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
}

/// A slender prism that is crushed as a half, far beyond its Euler load of 1.03 MPa, has lost its symmetry before.
#[test]
fn a_column_that_would_buckle_is_not_crushed_as_a_half() {
    let text = r#"format = 1
[materials.stone]
E = "2 GPa"
nu = 0.2
density = "2000 kg/m^3"
f_t = "1 MPa"
G_ft = "0.05 N/mm"
f_c = "8 MPa"
G_fc = "8 N/mm"
[[blocks]]
name = "column"
size = [200, 100, 2000]
material = "stone"
mesh = [2, 2, 20]
[[supports]]
on = "column.bottom"
[[steps]]
kind = "load"
loads = [{ name = "weight", on = "column.top", traction = [0, 0, -12] }]
"#;
    let (_, model) = deck_and_model(text);
    let summary = scene::run(&model).1;
    assert!(!summary.mirror_planes.is_empty());
    assert!(summary.lost_symmetry, "{}", summary.message);
}
