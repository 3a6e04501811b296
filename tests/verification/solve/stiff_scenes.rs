//! Beams that rotate or stay level, nearly rigid bodies and columns against rigid-body mechanics.

use crate::common::blocks::{Bad, deck as parsed, refuses};
use crate::common::examples::load;
use crate::common::scene::{rows, run};
use wythe::deck::{Deck, check};
use wythe::model::Model;
use wythe::state::Status;

const PIER: &str = include_str!("../../../examples/66_rocking_pier.toml");

/// Force of the push at the deflection u: load N and weight W act about the toe of a pier of width b.
#[test]
fn a_pier_below_a_beam_rocks_as_a_rigid_body() {
    let (load, weight) = (0.5 * 400.0 * 200.0, 0.4 * 0.2 * 1.0 * 2300.0 * 9.81);
    let (b, height, depth) = (400.0, 1000.0, 100.0);
    let level = PIER
        .replace("rotation = \"free\"", "rotation = \"level\"")
        .replace("direction = \"x\"", "direction = \"x\"\nfree = [\"z\"]");
    for (text, exact) in [
        // Pushed at half the depth of the beam; N acts in the middle.
        (PIER, (load + weight) * 0.5 * b / (height + 0.5 * depth)),
        // The beam's load moves to the other end; moment about the toe at the height of the joint below the beam.
        (level.as_str(), (load + 0.5 * weight) * b / height),
    ] {
        let rows = rows(&parsed(text));
        let push = rows.iter().filter(|r| r.step == 2);
        let peak = 1e3 * push.map(|r| r.force_kN).fold(0.0, f64::max);
        // The result may only be smaller: the pier leans by 0.15 mm of 200 mm at the peak, and the joints at the toe
        // deform.
        assert!(
            peak < exact && peak > 0.998 * exact,
            "{peak} N of {exact} N"
        );
        // Beyond the peak the load moves towards the toe: the moment decreases by N u.
        let last = &rows[rows.len() - 1];
        let fallen = 1.0 - 1e3 * last.force_kN / peak;
        assert!(fallen > 0.005 && fallen < 0.03, "{fallen}");
    }
}

#[test]
fn the_checker_reports_rigid_bodies_and_beams() {
    let deck = parsed(PIER);
    let (model, _) = Model::from_deck(&deck).unwrap();
    let report = check(&deck, &model);
    let told = |part: &str| report.notes.iter().any(|note| note.contains(part));
    assert!(told("rigid: 11 bodies of 11 hex8"), "{:?}", report.notes);
    assert!(told("beam beam: a block 100 mm deep"), "{:?}", report.notes);
    assert!(told("it turns freely"), "{:?}", report.notes);
    // A hundred times the stiffness of the stiffest joint over the longest side: 100 × 100 N/mm³ × 600 mm.
    let stone = model
        .materials
        .iter()
        .find(|m| m.name == "stone (rigid)")
        .unwrap();
    let elastic = stone.parameters.elastic();
    assert!((elastic.E / 6e6 - 1.0).abs() < 1e-12 && elastic.density > 0.0);
    // A deck written with its defaults is the same deck.
    let again = parsed(&deck.to_toml().unwrap());
    assert!(again == deck);
}

/// Rigid units have mesh lines at the joints above and below, and no others.
#[test]
fn rigid_units_have_points_of_contact_at_all_corners() {
    let wall = PIER
        .replace("unit = [\"400 mm\"", "unit = [\"160 mm\"")
        .replace("rotation = \"free\"", "");
    let model = Model::from_deck(&parsed(&wall)).unwrap().0;
    // 2½ units of 160 mm per course, mirrored in every other course: courses of 160, 160, 80 and 80, 160, 160. Whole
    // units are cut at the joint of the next course: 2 + 2 + 1 elements.
    let units = model.mesh.course.iter().filter(|c| **c == 3).count();
    assert_eq!(units, 5);
    let lines: Vec<f64> = (0..model.mesh.elements.len())
        .filter(|e| model.mesh.course[*e] == 3)
        .map(|e| model.mesh.corners(e)[1][0])
        .collect();
    assert_eq!(lines, [80.0, 160.0, 240.0, 320.0, 400.0]);
}

/// Example 68: tan α = b/h, with and without the lintel.
#[test]
fn columns_below_a_lintel_fall_at_the_angle_of_one_block() {
    let deck = load(
        "68_trilithon",
        &[("steps.1.angle", "17.1"), ("steps.1.procedure", "static")],
    );
    rows(&deck); // stands
    let exact = (500.0_f64 / 1600.0).atan().to_degrees();
    let deck = load(
        "68_trilithon",
        &[("steps.1.angle", "20"), ("steps.1.procedure", "static")],
    );
    let (model, _) = Model::from_deck(&deck).unwrap();
    let (recording, summary) = run(&model);
    assert_eq!(summary.status, Status::NotConverged, "{}", summary.message);
    let last = recording.rows.last().unwrap();
    let angle = 20.0 * (last.time - 1.0);
    // Increments before the fall are cut to 1e-6 of the step. Equilibrium holds to 2e-3 of a nodal force, which
    // determines the moments that hold the columns: 2e-4 measured.
    assert!((angle / exact - 1.0).abs() < 2e-3, "{angle} of {exact}");
}

#[test]
fn rotated_columns_are_blocks_on_each_other_too() {
    let text = include_str!("../../../examples/68_trilithon.toml");
    let model = Model::from_deck(&parsed(text)).unwrap().0;
    // Three joints in each column, two feet, two heads.
    assert_eq!(model.contact.slave_facets.len(), 3 * 2 + 2 + 2);
    let turned = text.replace(
        "name = \"left\"",
        "name = \"left\"\nrotate = { axis = \"z\", angle = 90 }\nat = [\"600 mm\", 0, 0]",
    );
    let model = Model::from_deck(&parsed(&turned)).unwrap().0;
    let foot = &model.mesh.corners(1);
    assert!(foot.iter().all(|x| x[0] > -1e-9 && x[1] < 500.0 + 1e-9));
    let leaning = text
        .replace(
            "name = \"left\"",
            "name = \"left\"\nrotate = { axis = \"x\", angle = 90 }",
        )
        .replace("slave = [\"left-0.bottom\", ", "slave = [")
        .replace("slave = [\"left-3.top\", ", "slave = [");
    let leaning = format!("{leaning}[[supports]]\non = \"left\"\n");
    let model = Model::from_deck(&parsed(&leaning)).unwrap().0;
    // Right-handed about x: the upper body lies at −y.
    let top = model.mesh.corners(4);
    assert!(top.iter().all(|x| x[1] < -1200.0 + 1e-9), "{top:?}");
}

const BAD: &[Bad] = &[
    (
        "on = \"wall.top\"",
        "on = \"wall.left\"",
        "beams.0.on",
        "no level face",
        "wall.top",
    ),
    (
        "on = \"wall.top\"",
        "on = \"wall\"",
        "beams.0.on",
        "`wall` is no face",
        "wall.top",
    ),
    (
        "on = \"wall.top\"",
        "on = [\"wall.top\", \"ground.top\"]",
        "beams.0.on",
        "no level face",
        "one height",
    ),
    (
        "name = \"beam\"",
        "name = \"wall\"",
        "beams.0.name",
        "two blocks named `wall`",
        "of its own",
    ),
    (
        "name = \"beam\"",
        "name = \"stone\"",
        "beams.0.name",
        "called `stone`, too",
        "otherwise",
    ),
    (
        "depth = \"100 mm\"",
        "depth = 0",
        "beams.0.depth",
        "0 is not positive",
        "above 0",
    ),
    (
        "rotation = \"free\"",
        "rotation = \"fixed\"",
        "beams.0.rotation",
        "not a known choice",
        "free, level",
    ),
    (
        "beam = \"beam\"\ndirection",
        "beam = \"bean\"\ndirection",
        "steps.2.beam",
        "no beam named `bean`",
        "`beam`",
    ),
    (
        "direction = \"x\"",
        "direction = \"x\"\nfree = [\"z\"]",
        "steps.2.free",
        "turns and moves freely",
        "stay level",
    ),
    (
        "direction = \"x\"",
        "direction = \"z\"",
        "steps.2.direction",
        "cannot be driven vertically",
        "rotation =",
    ),
    (
        "direction = \"x\"",
        "direction = \"x\"\nface = \"beam.top\"",
        "steps.2.beam",
        "either a beam, a face",
        "of its own",
    ),
    (
        "normal_stiffness = \"100 N/mm^3\"\nshear_stiffness = \"40 N/mm^3\"",
        "",
        "interfaces.dry",
        "joins rigid bodies",
        "give both: normal_stiffness",
    ),
    (
        "bed_joint = 0",
        "bed_joint = 10",
        "wall.rigid",
        "mortar is no part",
        "lie dry",
    ),
    (
        "interface = \"dry\"\nrigid = true",
        "interface = \"dry\"\nrigid = \"very\"",
        "wall.rigid",
        "expected a boolean",
        "rigid = true",
    ),
];

#[test]
fn bad_beams_and_rigid_walls_name_the_key_and_the_fix() {
    refuses(PIER, BAD);
}

#[test]
fn bad_columns_name_the_key_and_the_fix() {
    let text = include_str!("../../../examples/68_trilithon.toml");
    refuses(
        text,
        &[
            (
                "stack = 4",
                "stack = 0",
                "blocks.2.stack",
                "0 blocks are no column",
                "at least 1",
            ),
            (
                "stack = 4\ninterface = \"dry\"",
                "stack = 4",
                "blocks.2.interface",
                "is missing",
                "interface =",
            ),
            (
                "stack = 4\n",
                "",
                "blocks.2.interface",
                "has no joints",
                "stack = 6",
            ),
            (
                "stack = 4",
                "stack = 4\ncopies = [1, 1, 2]",
                "blocks.2.stack",
                "stands once",
                "copies",
            ),
        ],
    );
}

/// If a body is rigid, the stiffness of its joints must be given explicitly, also below beams.
#[test]
fn joints_of_rigid_bodies_need_an_explicit_stiffness() {
    let soft = "[interfaces.soft]\nf_t = 0\nc = 0\ntan_phi = 0.7\nmu = 0.7\n[contact]";
    // Only the wall is rigid.
    let good = PIER.replace("[contact]", soft).replace(
        "at = [\"-100 mm\", 0, \"-50 mm\"]\nmaterial = \"stone\"\nrigid = true",
        "at = [\"-100 mm\", 0, \"-50 mm\"]\nmaterial = \"stone\"",
    );
    let changes: [Bad; 2] = [
        (
            "rotation = \"free\"\ninterface = \"dry\"",
            "rotation = \"free\"\ninterface = \"soft\"",
            "interfaces.soft",
            "joins rigid bodies",
            "give both",
        ),
        (
            "master = \"ground.top\"\ninterface = \"dry\"",
            "master = \"ground.top\"\ninterface = \"soft\"",
            "interfaces.soft",
            "joins rigid bodies",
            "give both",
        ),
    ];
    refuses(&good, &changes);
}

#[test]
fn keys_without_effect_are_reported() {
    let keys = |text: &str| -> Vec<String> {
        let (_, warnings) = Model::from_deck(&parsed(text)).unwrap_or_else(|e| panic!("{e}"));
        warnings.into_iter().map(|w| w.key).collect()
    };
    let said = |key: &str| PIER.replace("clamped = false", &format!("clamped = false\n{key}"));
    assert!(!keys(PIER).iter().any(|key| key.starts_with("wall.")));
    assert!(keys(&said("mesh = [3, 3, 3]")).contains(&"wall.mesh".to_owned()));
    let filled = said("filled_from = \"front\"");
    assert!(keys(&filled).contains(&"wall.filled_from".to_owned()));
}

/// A step of gravity has no beam, and no message about a face that it does not name.
#[test]
fn an_absent_key_is_not_reported() {
    let text = PIER.replace("kind = \"gravity\"", "kind = \"gravity\"\nbeam = \"beam\"");
    let error = Deck::from_str(&text, "scene.toml").unwrap_err();
    let keys: Vec<&str> = error.all().map(wythe::error::ModelError::key).collect();
    assert_eq!(keys, ["steps.0.beam"], "{error}");
}
