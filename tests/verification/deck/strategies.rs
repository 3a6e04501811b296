//! Strategies `simplified` and `rigid`: expanded units, derived interfaces (docs/theory/strategies.md).

use crate::common::boxes::{bodies, volume};
use crate::common::examples;
use crate::common::scene::rows;
use wythe::contact::{InterfaceLaw, JointLaw};
use wythe::deck::{Deck, Strategy, check};
use wythe::model::Model;

/// Brick and mortar of the paper's shear walls.
const SOLIDS: &str = "format = 1
[materials.brick]
E = 16700
nu = 0.15
tension = [[3.5, 0, 0], [0.3, 0.002, 0.95]]
compression = [[11.0, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]
reference_length = 50
[materials.mortar]
E = 850
nu = 0.15
tension = [[1.5, 0, 0], [0.1, 0.002, 0.95]]
compression = [[7.8, 0, 0], [8.2, 0.002, 0], [0.4, 0.015, 0.95]]
reference_length = 31.4
[interfaces.joint]
f_t = 0.2
c = 0.22
tan_phi = 0.75
mu = 0.75
zeta = 4.38
xi = 1.1
u_k = 0.36
delta_k = 0.4
";

/// Joints of 12.5 mm between units of 204 × 98 × 50 mm.
fn wall(strategy: &str, keys: &str, steps: &str) -> Deck {
    let text = format!(
        "strategy = \"{strategy}\"\n{SOLIDS}[wall]\nunit = [204, 98, 50]\nbed_joint = 12.5\nhead_joint = 12.5\n\
         unit_material = \"brick\"\nmortar_material = \"mortar\"\ninterface = \"joint\"\n{keys}\n{steps}"
    );
    Deck::from_str(&text, "wall.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn built(deck: &Deck) -> Model {
    Model::from_deck(deck).unwrap_or_else(|e| panic!("{e}")).0
}

const PUSH: &str = "[[steps]]\nkind = \"drive\"\ndirection = \"x\"\ndisplacement = 1\n";

/// Expanded units fill walls of all bonds without gaps, and no two of them overlap. `full`: the wall is solid up to its
/// faces.
#[test]
fn expanded_units_fill_the_wall() {
    let bonds = [
        ("length = 990\ncourses = 6", 990.0 * 98.0),
        ("length = 990\ncourses = 6\nbond = \"stack\"", 990.0 * 98.0),
        (
            "length = 853.5\ncourses = 6\nbond = \"english\"",
            853.5 * 204.0,
        ),
        (
            "length = 853.5\ncourses = 6\nbond = \"flemish\"",
            853.5 * 204.0,
        ),
        (
            "length = 990\ncourses = 6\nalong = \"y\"\nopenings = [{ from = 300, to = 500, sill = 2, courses = 2 }]",
            990.0 * 98.0,
        ),
    ];
    for (keys, area) in bonds {
        let deck = wall("simplified", keys, PUSH);
        let units = bodies(&built(&deck).mesh);
        let filled: f64 = units.iter().copied().map(volume).sum();
        let height = 6.0 * 62.5 - 12.5;
        let hole = if keys.contains("openings") {
            // Sill and head of the opening are faces of units, its jambs ends of units or of joints.
            let open: f64 = 200.0 * (2.0 * 62.5 - 12.5) * 98.0;
            open..open + 98.0 * 4.0 * 62.5 * 12.5
        } else {
            0.0..1e-6 * area * height
        };
        let missing = area * height - filled;
        assert!(
            missing >= hole.start - 1e-3 && missing <= hole.end,
            "{keys}: {missing} of {hole:?}"
        );
    }
}

/// The stiffness of a pressed pier of n courses is that of its layers: Σ h/E.
#[test]
fn a_pressed_pier_has_the_stiffness_of_its_layers() {
    let press = "[[steps]]\nkind = \"drive\"\ndirection = \"z\"\ndisplacement = -0.005\n";
    let keys = "length = 204\ncourses = 5\nclamped = { bottom_courses = 0, top_courses = 0 }";
    let compliance = 5.0 * 50.0 / 16700.0 + 4.0 * 12.5 / 850.0;
    let exact = 204.0 * 98.0 / compliance * 0.005 * 1e-3;
    for strategy in ["simplified", "rigid"] {
        let rows = rows(&wall(strategy, keys, press));
        let found = rows.last().unwrap().force_kN;
        // Lateral strain of the units is held at both ends: 1 % at ν = 0.15. Rigid units also lack half a joint's depth of
        // unit at both ends, and add a hundredth.
        let tolerance = if strategy == "rigid" { 0.05 } else { 0.02 };
        println!("{strategy}: {found} of {exact} kN");
        assert!(
            (found.abs() / exact - 1.0).abs() < tolerance,
            "{strategy}: {found} {exact}"
        );
    }
}

/// k_n = E_u E_m/(t (E_u − E_m)), f_m by Hilsdorf, energies of the joint.
#[test]
fn joints_have_the_derived_values() {
    let model = built(&wall("simplified", "length = 990\ncourses = 6", PUSH));
    let bed = model
        .contact
        .law_names
        .iter()
        .position(|name| name == "joint (bed)");
    let InterfaceLaw::Cap(cap) = &model.contact.laws[bed.unwrap()] else {
        panic!("no cap");
    };
    let close = |found: f64, exact: f64| {
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    };
    let [normal, shear] = cap.stiffness();
    close(normal, 16700.0 * 850.0 / (12.5 * (16700.0 - 850.0)));
    close(shear, normal / (2.0 * 1.15));
    let alpha = 12.5 / (4.1 * 50.0);
    close(
        cap.curve.strength,
        11.5 * (3.5 + alpha * 8.2) / (3.5 + alpha * 11.5),
    );
    close(cap.curve.peak, 0.001 * 50.0 + 0.002 * 12.5);
    // C_ss of the principal stress at the friction of the joint.
    let t: f64 = 0.75;
    close(
        cap.c_ss,
        ((0.5 + (0.25 + t * t).sqrt()).powi(2) - 1.0) / (t * t),
    );
    let shape = |z: f64| 1.0 / z - 1.0 / (z.exp() - 1.0);
    close(cap.mode_1, 0.2 * 0.36 * shape(4.38));
    close(cap.mode_2, 0.22 * 0.4 * shape(1.1));
}

/// Values of `[simplified]` take the place of derived ones.
#[test]
fn values_of_the_deck_come_first() {
    let keys = "length = 990\ncourses = 6\n[simplified]\nmesh = [4, 2, 2]\nf_m = 9\nG_fc = 5\nkappa_p = 0.09\nC_ss = 4";
    let model = built(&wall("simplified", keys, PUSH));
    let InterfaceLaw::Cap(cap) = &model.contact.laws[0] else {
        panic!("no cap");
    };
    assert_eq!(cap.curve.strength, 9.0);
    assert_eq!(cap.curve.peak, 0.09);
    assert!((cap.curve.energy() - 5.0).abs() < 1e-12);
    assert_eq!(cap.c_ss, 4.0);
    let whole = model.mesh.unit.iter().filter(|unit| **unit == 0).count();
    assert_eq!(whole, 16);
}

/// The derived deck, written out and read again, is the same: nothing is expanded twice.
#[test]
fn a_derived_deck_reads_back() {
    for strategy in ["simplified", "rigid"] {
        let keys =
            "length = 990\ncourses = 6\nhead_filling = 0.6\n[simplified]\nunit_cracks = true";
        let deck = wall(strategy, keys, PUSH);
        let text = deck.to_toml().unwrap();
        let again = Deck::from_str(&text, "model.toml").unwrap_or_else(|e| panic!("{e}"));
        assert!(deck == again, "{text}");
        assert_eq!(built(&deck).mesh.nodes, built(&again).mesh.nodes);
    }
}

/// So does one whose rigid wall stands on a block with a joint that has no stiffness of its own.
#[test]
fn a_rigid_wall_on_a_block_reads_back() {
    let block = "[[blocks]]\nname = \"base\"\nsize = [990, 98, 60]\nat = [0, 0, -60]\nmaterial = \"brick\"\n\
                 [[contacts]]\nslave = \"base.top\"\nmaster = \"wall.bottom\"\ninterface = \"joint\"\n";
    let deck = wall(
        "rigid",
        "length = 990\ncourses = 6\nclamped = false",
        &format!("{block}[[supports]]\non = \"base\"\n[[steps]]\nkind = \"gravity\"\n"),
    );
    let text = deck.to_toml().unwrap();
    let again = Deck::from_str(&text, "model.toml").unwrap_or_else(|e| panic!("{e}"));
    assert!(deck == again, "{text}");
}

/// A unit pulled along the wall cracks in its middle at its tensile strength.
#[test]
fn a_pulled_unit_cracks_in_its_middle() {
    let text = format!(
        "strategy = \"simplified\"\n{SOLIDS}[wall]\nunit = [204, 98, 50]\nbed_joint = 12.5\nhead_joint = 12.5\nlength = 204\n\
         courses = 1\nunit_material = \"brick\"\nmortar_material = \"mortar\"\ninterface = \"joint\"\nclamped = false\n\
         [simplified]\nunit_cracks = true\n\
         [[supports]]\non = \"wall-0-0.left\"\n\
         [[steps]]\nkind = \"drive\"\nface = \"wall-0-0.right\"\ndirection = \"x\"\ndisplacement = 0.2\n"
    );
    let deck = Deck::from_str(&text, "unit.toml").unwrap_or_else(|e| panic!("{e}"));
    let model = built(&deck);
    assert_eq!(model.mesh.elements.len(), 2);
    assert_eq!(model.mesh.called(0), "wall-0-0-left");
    let rows = rows(&deck);
    let most = rows.iter().map(|row| row.force_kN).fold(0.0, f64::max);
    let exact = 3.5 * 98.0 * 50.0 * 1e-3;
    println!("{most} of {exact} kN");
    // Increments pass the peak by up to 1 % of the softening; clamped ends give lateral stress.
    assert!((most / exact - 1.0).abs() < 0.02, "{most} {exact}");
    let end = rows.last().unwrap().force_kN;
    assert!(end < 0.2 * exact, "{end}");
}

/// A window wall with both strategies: peak within 10 %, area within 20 % of the detailed model.
#[test]
fn a_window_wall_is_near_the_detailed_one() {
    let run = |strategy: &str| {
        let changes = [("strategy", strategy), ("steps.1.displacement", "2 mm")];
        let rows = rows(&examples::load("61_wall_with_opening.toml", &changes));
        let drive = || rows.iter().filter(|row| row.step == 1);
        let peak = drive().map(|row| row.force_kN.abs()).fold(0.0, f64::max);
        let points: Vec<[f64; 2]> = drive()
            .map(|row| [row.displacement_mm, row.force_kN])
            .collect();
        let area: f64 = points
            .windows(2)
            .map(|p| 0.5 * (p[1][0] - p[0][0]) * (p[0][1] + p[1][1]))
            .sum();
        [peak, area]
    };
    let [peak, area] = run("detailed");
    for strategy in ["simplified", "rigid"] {
        let found = run(strategy);
        println!("{strategy}: {found:?} of {:?}", [peak, area]);
        assert!(
            (found[0] / peak - 1.0).abs() < 0.1,
            "{strategy}: {found:?} {peak}"
        );
        assert!(
            (found[1] / area - 1.0).abs() < 0.2,
            "{strategy}: {found:?} {area}"
        );
    }
}

/// Mortar that cracks by shear before the joint slides is told where the top does not rise, weak mortar only.
#[test]
fn mortar_that_cracks_first_is_told() {
    let warned = |mortar: &str, step: &str| {
        let text = format!(
            "strategy = \"simplified\"\n{}[wall]\nunit = [204, 98, 50]\nbed_joint = 12.5\nhead_joint = 12.5\n\
             length = 990\ncourses = 6\nunit_material = \"brick\"\nmortar_material = \"mortar\"\n\
             interface = \"joint\"\n{step}",
            SOLIDS.replace("[[1.5, 0, 0]", mortar)
        );
        let deck = Deck::from_str(&text, "wall.toml").unwrap_or_else(|e| panic!("{e}"));
        let warnings = Model::from_deck(&deck).unwrap().1;
        warnings
            .iter()
            .filter(|w| w.to_string().contains("cracks by shear"))
            .count()
    };
    let weak = "[[0.5, 0, 0]";
    // Once, not for head joints again: beds carry the pressure.
    assert_eq!(warned(weak, PUSH), 1);
    assert_eq!(warned(weak, &format!("{PUSH}vertical = \"free\"\n")), 0);
    assert_eq!(warned("[[1.5, 0, 0]", PUSH), 0);
}

/// Expanded units weigh as much as the units and the mortar that they stand for.
#[test]
fn expanded_walls_weigh_as_much() {
    let mass = |strategy: &str| {
        let dense = |of: &str, density: f64| {
            let begin = format!("[materials.{of}]\n");
            (
                begin.clone(),
                format!("{begin}density = \"{density} kg/m^3\"\n"),
            )
        };
        let [brick, mortar] = [dense("brick", 600.0), dense("mortar", 1800.0)];
        let solids = SOLIDS
            .replace(&brick.0, &brick.1)
            .replace(&mortar.0, &mortar.1);
        let text = format!(
            "strategy = \"{strategy}\"\n{solids}[wall]\nunit = [204, 98, 50]\nbed_joint = 12.5\nhead_joint = 12.5\n\
             unit_material = \"brick\"\nmortar_material = \"mortar\"\ninterface = \"joint\"\nlength = 990\n\
             courses = 6\nhead_filling = 0.5\n{PUSH}"
        );
        let deck = Deck::from_str(&text, "wall.toml").unwrap_or_else(|e| panic!("{e}"));
        let model = built(&deck);
        let elements = 0..model.mesh.elements.len();
        let mass = elements.map(|e| {
            let material = &model.materials[usize::from(model.mesh.material[e])];
            material.parameters.elastic().density * model.mesh.volume(e)
        });
        mass.sum::<f64>()
    };
    let detailed = mass("detailed");
    for strategy in ["simplified", "rigid"] {
        // Six courses have five bed joints: a sixth less than the cells of their units, of 40 % of the mass.
        let ratio = mass(strategy) / detailed;
        assert!((ratio - 1.0).abs() < 0.07, "{strategy}: {ratio}");
    }
}

#[test]
fn derived_values_are_told_without_digits_of_rounding() {
    let text = wall("simplified", "length = 990\ncourses = 6", PUSH)
        .to_toml()
        .unwrap();
    // 3813 times 1e-4 is 0.38130000000000003.
    let deck = Deck::from_str(&text.replace("c = 0.22\n", "c = 0.3813\n"), "wall.toml").unwrap();
    let notes = check(&deck, &built(&deck)).notes;
    assert!(
        notes.iter().any(|note| note.contains("; c = 0.3813 MPa,")),
        "{notes:?}"
    );
}

#[test]
fn decks_of_two_strategies_differ() {
    let of = |strategy: &str| wall(strategy, "length = 990\ncourses = 6", PUSH);
    let all: Vec<Deck> = Strategy::ALL.map(|s| of(s.name())).into();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate() {
            assert_eq!(a == b, i == j, "{:?} {:?}", a.strategy, b.strategy);
        }
    }
    let cut = "length = 990\ncourses = 6\n[[sections]]\nname = \"foot\"\nthrough = [0, 0, 30]";
    assert!(of("detailed") != wall("detailed", cut, PUSH));
}

#[test]
fn contradictions_name_their_key() {
    let refused = |text: &str, key: &str| {
        let error = Deck::from_str(text, "wall.toml").unwrap_err();
        assert!(error.all().any(|e| e.key() == key), "{key}: {error}");
    };
    let plain = |strategy: &str, keys: &str| {
        format!(
            "strategy = \"{strategy}\"\n{SOLIDS}[wall]\nunit = [204, 98, 50]\nbed_joint = 12.5\nhead_joint = 12.5\n\
             length = 990\ncourses = 6\nunit_material = \"brick\"\ninterface = \"joint\"\n{keys}\n{PUSH}"
        )
    };
    refused(
        &plain(
            "simplified",
            "mortar_material = \"mortar\"\nexpanded = true",
        ),
        "wall.expanded",
    );
    refused(&plain("detailed", "expanded = true"), "wall.expanded");
    refused(&plain("rigid", "expanded = true"), "wall.expanded");
    refused(
        &plain(
            "detailed",
            "mortar_material = \"mortar\"\ncrack_interface = \"joint\"",
        ),
        "wall.crack_interface",
    );
    for key in [
        "f_m = -1",
        "mesh = [0, 1, 1]",
        "kappa_p = 0",
        "C_ss = 0",
        "G_fc = 0",
    ] {
        let name = key.split(' ').next().unwrap();
        refused(
            &plain(
                "detailed",
                &format!("mortar_material = \"mortar\"\n[simplified]\n{key}"),
            ),
            &format!("simplified.{name}"),
        );
    }
}
