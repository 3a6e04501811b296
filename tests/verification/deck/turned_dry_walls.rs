//! Dry walls of rigid units that meet at corners: their mesh, bond and stiffness do not depend on their orientation, nor
//! on the decimals of the deck.

use crate::common::blocks::deck_and_model;
use std::fmt::Write;
use wythe::limit::{LimitSettings, analyse};
use wythe::model::Model;
use wythe::solve::vibration::{About, modes};

const HEAD: &str = "format = 1
[materials.stone]
E = \"5 GPa\"
nu = 0.2
density = \"2000 kg/m^3\"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
normal_stiffness = \"100 N/mm^3\"
shear_stiffness = \"40 N/mm^3\"
[contact]
points = \"corner\"
";

/// Walls along these lines in plan, turned about the origin and written with so many decimals.
struct Plan<'a> {
    /// Begin, direction in degrees, length [mm]. `[wall]`
    walls: &'a [([f64; 2], f64, f64)],
    courses: u32,
    turn: f64,
    decimals: usize,
}

impl Plan<'_> {
    fn deck(&self) -> String {
        let (sine, cosine) = self.turn.to_radians().sin_cos();
        let (decimals, courses) = (self.decimals, self.courses);
        let mut text = HEAD.to_owned();
        let mut feet = Vec::new();
        for (i, ([x, y], direction, length)) in self.walls.iter().enumerate() {
            let table = if i == 0 { "[wall]" } else { "[[walls]]" };
            let at = [cosine * x - sine * y, sine * x + cosine * y];
            write!(
                text,
                "{table}\nname = \"w{i}\"\nat = [{:.decimals$}, {:.decimals$}, 0]\nrotate = {{ axis = \"z\", angle = {} }}\n\
                 unit = [400, 200, 200]\nbed_joint = 0\nhead_joint = 0\nlength = {length}\ncourses = {courses}\n\
                 unit_material = \"stone\"\ninterface = \"dry\"\nrigid = true\nclamped = false\n",
                at[0],
                at[1],
                direction + self.turn
            )
            .unwrap();
            feet.push(format!("\"w{i}.bottom\""));
        }
        let feet = feet.join(", ");
        format!("{text}[[supports]]\non = [{feet}]\n[[steps]]\nkind = \"gravity\"\n")
    }
}

/// Numbers of nodes, elements and facets of joints, which slivers would change, and the volume of the smallest element
/// [mm³].
fn mesh(model: &Model) -> ([usize; 3], f64) {
    let mesh = &model.mesh;
    let volumes = (0..mesh.elements.len()).map(|e| mesh.volume(e));
    let facets = model.contact.slave_facets.len();
    let sizes = [mesh.nodes.len(), mesh.elements.len(), facets];
    (sizes, volumes.fold(f64::INFINITY, f64::min))
}

/// Corners of two walls, of which the coordinates of the second one are rounded to 1e-9, 1e-6 and 1e-3 mm, have the mesh
/// of the straight corner.
#[test]
fn turned_corners_have_no_slivers() {
    for length in [1000.0, 2400.0, 2600.0] {
        let of = |turn: f64, decimals: usize| {
            let walls = [([0.0; 2], 0.0, length), ([length, 0.0], 90.0, 1000.0)];
            let plan = Plan {
                walls: &walls,
                courses: 3,
                turn,
                decimals,
            };
            deck_and_model(&plan.deck()).1
        };
        let (straight, smallest) = mesh(&of(0.0, 9));
        // Half a unit.
        assert!(smallest > 0.99 * 200.0_f64.powi(3), "{smallest}");
        for turn in [10.0, 30.0, 37.0, 45.0, 60.0, 90.0, 180.0, 271.0] {
            for decimals in [9, 6, 3] {
                let (turned, least) = mesh(&of(turn, decimals));
                let case = format!("{length} mm, {turn} degrees, {decimals}");
                assert_eq!(turned, straight, "{case}");
                // Units of 200 mm end by 1e-3 mm elsewhere.
                assert!((least / smallest - 1.0).abs() < 1e-4, "{least} {smallest}");
            }
        }
    }
}

/// Turned corners have the first modes of the straight one.
#[test]
fn turned_corners_have_the_modes_of_the_straight_one() {
    let walls = [([0.0; 2], 0.0, 1000.0), ([1000.0, 0.0], 90.0, 1000.0)];
    let of = |turn: f64, decimals: usize| {
        let plan = Plan {
            walls: &walls,
            courses: 3,
            turn,
            decimals,
        };
        let found = modes(&deck_and_model(&plan.deck()).1, About::Rest, 3).unwrap();
        let modes = found.modes.iter();
        modes.map(|mode| mode.frequency).collect::<Vec<f64>>()
    };
    let straight = of(0.0, 9);
    assert!(straight[0] > 0.0);
    for (turn, decimals) in [(90.0, 6), (30.0, 3), (30.0, 9), (45.0, 3), (60.0, 6)] {
        for (turned, straight) in of(turn, decimals).iter().zip(&straight) {
            // Points at the edge of two faces below them belong to either by rounding: 0.6 % in the second mode.
            assert!(
                (turned / straight - 1.0).abs() < 1e-2,
                "{turn} degrees, {decimals} decimals: {turned} {straight} Hz"
            );
        }
    }
}

/// Four walls around a room, of which several bonds are equally good: rounding does not choose among them.
#[test]
fn a_box_of_walls_has_one_bond_in_every_orientation() {
    let walls = [
        ([0.0, 0.0], 0.0, 2200.0),
        ([2200.0, 0.0], 90.0, 1400.0),
        ([2200.0, 1400.0], 180.0, 2200.0),
        ([0.0, 1400.0], 270.0, 1400.0),
    ];
    let of = |turn: f64| {
        let plan = Plan {
            walls: &walls,
            courses: 4,
            turn,
            decimals: 9,
        };
        let (deck, model) = deck_and_model(&plan.deck());
        let mut notes = wythe::deck::check(&deck, &model).notes;
        notes.retain(|note| note.contains("begins with course"));
        let (sine, cosine) = turn.to_radians().sin_cos();
        let settings = LimitSettings {
            along: Some([cosine, sine, 0.0]),
            associated: true,
            ..LimitSettings::default()
        };
        let factor = analyse(&model, &settings).unwrap().factor;
        (notes, mesh(&model).0, factor)
    };
    let (notes, sizes, factor) = of(0.0);
    for turn in [17.0, 45.0, 90.0, 137.0, 180.0] {
        let turned = of(turn);
        assert_eq!(turned.0, notes, "{turn} degrees");
        assert_eq!(turned.1, sizes, "{turn} degrees");
        // The tolerance of the programs.
        assert!(
            (turned.2 / factor - 1.0).abs() < 1e-5,
            "{turn} degrees: {} {factor}",
            turned.2
        );
    }
}
