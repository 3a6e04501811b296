//! Sides of walls: the areas on which loads act, and the nodes that supports hold.

use crate::common::blocks::deck_and_model;
use wythe::model::Model;
use wythe::model::loads::LoadOn;

const KINDS: &str = "format = 1
[materials.brick]
E = 6000
nu = 0.2
[materials.mortar]
E = 1500
nu = 0.2
[interfaces.joint]
f_t = 0.2
c = 0.3
tan_phi = 0.7
mu = 0.7
zeta = 4.38
xi = 1.1
G_I = 0.01
G_II = 0.05
";

/// A wall of blocks of 440 × 215 × 215 mm with joints of 10 mm.
fn wall(name: &str, keys: &str) -> String {
    format!(
        "[[walls]]\nname = \"{name}\"\nunit = [440, 215, 215]\nbed_joint = 10\nhead_joint = 10\ncourses = 4\n\
         unit_material = \"brick\"\nmortar_material = \"mortar\"\ninterface = \"joint\"\nmesh = [2, 2, 1]\n{keys}\n"
    )
}

/// A scene whose wall `a` is held at its bottom, with a pressure on these faces.
fn scene(walls: &str, on: &str) -> Model {
    let load = format!(
        "[[supports]]\non = \"a.bottom\"\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"p\"\non = {on}\n\
         pressure = 1\nfollower = false\n"
    );
    deck_and_model(&format!("{KINDS}{walls}{load}")).1
}

/// Area of the pressure on these faces [mm²].
fn pressed(walls: &str, on: &str) -> f64 {
    let model = scene(walls, on);
    let LoadOn::Pressure(areas) = &model.loads[0].acts else {
        panic!("{:?}", model.loads[0].acts)
    };
    let sum = areas
        .iter()
        .fold([0.0; 3], |sum, (_, a)| [0, 1, 2].map(|i| sum[i] + a[i]));
    sum.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A wall that ends at another, or passes through it in every second course, covers its face there.
#[test]
fn a_wall_that_another_meets_is_pressed_beside_it() {
    let a = wall("a", "length = 2240");
    let b = wall("b", "at = [900, 0, 0]\nalong = \"y\"\nlength = 1790");
    let height = 4.0 * 225.0 - 10.0;
    let free = pressed(&a, "\"a.back\"") / (2240.0 * height);
    assert!((free - 1.0).abs() < 1e-12, "{free}");
    for (mesh, told) in [("[2, 2, 1]", true), ("[9, 2, 1]", false)] {
        let walls = format!("{a}{b}").replace("[2, 2, 1]", mesh);
        let model = scene(&walls, "\"a.back\"");
        let beside = pressed(&walls, "\"a.back\"") / ((2240.0 - 215.0) * height);
        // A facet counts if no more than half of it is covered.
        let warned = model
            .warnings
            .iter()
            .any(|w| w.to_string().contains("not covered by other walls"));
        assert!(
            warned == told && ((beside - 1.0).abs() < 0.01) != told,
            "{mesh}: {beside} {:?}",
            model.warnings
        );
    }
}

/// Heights of the nodes of the first support [mm].
fn held(model: &Model) -> Vec<f64> {
    let nodes = model.supports[0].nodes.iter();
    nodes.map(|n| model.mesh.nodes[*n as usize][2]).collect()
}

/// Head joints that are filled in part lay faces of units and of the bed joint above them bare, which do not lie in the
/// side of the wall.
#[test]
fn faces_within_head_joints_belong_to_no_side() {
    let filled = |part: f64| wall("a", &format!("length = 2240\nhead_filling = {part}"));
    let heights = held(&scene(&filled(0.4), "\"a.front\""));
    assert!(heights.iter().all(|z| *z == 0.0), "{heights:?}");
    // Filled from both faces, the mortar at the back has a face within the joint that looks to the front.
    let whole = 2240.0 * 890.0;
    let front = pressed(&filled(0.4), "\"a.front\"");
    assert!((front / whole - 1.0).abs() < 1e-12, "{}", front / whole);
    // Filled from the front, the mortar lies deep in the head joints at the back: four and five of 10 × 215 mm by turns.
    let back = format!("{}filled_from = \"front\"\n", filled(0.4));
    let back = pressed(&back, "\"a.back\"");
    let bare = 2.0 * (4.0 + 5.0) * 10.0 * 215.0;
    assert!(
        (back / (whole - bare) - 1.0).abs() < 1e-12,
        "{}",
        back / whole
    );
}
