//! Pivots of joints: bodies turn about the edges of their dry joints, and joints that are pressed deep keep their points.

use crate::common::blocks::deck_and_model;
use crate::common::scene::{completed, run};
use wythe::state::Status;

const STONE: &str = r#"format = 1
[materials.stone]
E = "20 GPa"
nu = 0.2
density = "2400 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.8
mu = 0.8
normal_stiffness = "100 N/mm^3"
shear_stiffness = "50 N/mm^3"
[[blocks]]
name = "table"
size = [700, 400, 100]
at = [-100, -100, -100]
material = "stone"
[[supports]]
on = "table"
[[contacts]]
interface = "dry"
"#;

/// A wall of dry stones 200 mm thick and 500 mm high tips over the edge of its lowest joint, at 0.4 of its weight, with
/// the contact points that a deck has by default.
#[test]
fn a_dry_wall_tips_over_its_edge() {
    let scene = "[wall]\nunit = [250, 200, 125]\nbed_joint = 0\nhead_joint = 0\nlength = 500\ncourses = 4\n\
                 unit_material = \"stone\"\ninterface = \"dry\"\nclamped = false\n[[steps]]\nkind = \"gravity\"\n\
                 [[steps]]\nkind = \"tilt\"\naxis = \"x\"\nangle = \"27 deg\"\n";
    for strategy in ["detailed", "rigid", "simplified"] {
        let text = STONE.replacen(
            "format = 1",
            &format!("format = 1\nstrategy = \"{strategy}\""),
            1,
        );
        let (_, model) = deck_and_model(&format!("{text}{scene}"));
        let (recording, summary) = run(&model);
        assert_eq!(summary.status, Status::Collapsed, "{}", summary.message);
        let stood = recording
            .rows
            .iter()
            .filter(|row| row.step == 1 && row.kinetic_energy_J < 1e-6);
        let factor = stood.map(|row| row.load_factor).fold(0.0, f64::max);
        let exact = 0.4_f64.atan().to_degrees() / 27.0;
        // The joints of 100 N/mm^3 give by some thousandths of the thickness at the edge, and the load at which a body
        // comes loose is found to 0.5 %.
        assert!(
            (factor / exact - 1.0).abs() < 8e-3,
            "{strategy}: {factor} {exact}"
        );
    }
}

/// A block that stands in the middle of a single facet of the table turns over its own edge, on whichever side the contact
/// points are.
#[test]
fn a_block_tips_over_its_edge_within_a_facet() {
    for (slave, master) in [("table.top", "block.bottom"), ("block.bottom", "table.top")] {
        let contact =
            format!("[[contacts]]\nslave = \"{slave}\"\nmaster = \"{master}\"\ninterface");
        let text = STONE.replace("[[contacts]]\ninterface", &contact);
        let scene = "[[blocks]]\nname = \"block\"\nsize = [150, 200, 300]\nat = [130, 0, 0]\nmaterial = \"stone\"\n\
                     [[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"tilt\"\naxis = \"y\"\nangle = \"40 deg\"\n";
        let (_, model) = deck_and_model(&format!("{text}{scene}"));
        let (_, summary) = run(&model);
        assert_eq!(summary.status, Status::Collapsed, "{}", summary.message);
        let factor = summary.fall.unwrap().load_factor;
        let exact = 0.5_f64.atan().to_degrees() / 40.0;
        // As above; the block is lighter on its joint.
        assert!(
            (factor / exact - 1.0).abs() < 8e-3,
            "{slave}: {factor} {exact}"
        );
    }
}

/// A joint softer than its blocks carries k u A, also where it is pressed deeper than the search radius of 3 mm.
#[test]
fn a_joint_that_is_pressed_deep_keeps_its_points() {
    let text = STONE
        .replace("\"100 N/mm^3\"", "0.5")
        .replace("\"50 N/mm^3\"", "0.2");
    let text = format!(
        "{text}[[blocks]]\nname = \"b\"\nsize = [100, 100, 100]\nmesh = [2, 2, 1]\nmaterial = \"stone\"\n[[steps]]\nkind = \
         \"drive\"\nface = \"b.top\"\ndirection = \"-z\"\ndisplacement = 8\nfree = [\"x\", \"y\"]\n"
    );
    for points in ["auto", "gauss"] {
        let (_, model) = deck_and_model(&format!("{text}[contact]\npoints = \"{points}\"\n"));
        let recording = completed(&model);
        let last = recording.rows.last().unwrap();
        // The stone gives by E/k = 40,000 mm for its 200 mm: half a per cent.
        assert!(
            (last.force_kN / 40.0 - 1.0).abs() < 6e-3,
            "{points}: {}",
            last.force_kN
        );
    }
}
