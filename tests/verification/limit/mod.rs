//! Limit analysis against closed forms, and against linear programs of others.

mod files;
mod mirror;
mod polygons;
mod scales;

use crate::common::blocks::{HEAD, deck_and_model};
use wythe::deck::Deck;
use wythe::limit::{LimitAnalysis, LimitError, LimitSettings, Progress, analyse, analyse_told};
use wythe::model::Model;

fn read(path: &str) -> Model {
    let deck = Deck::load(path, &[]).unwrap_or_else(|e| panic!("{path}: {e}"));
    Model::from_deck(&deck)
        .unwrap_or_else(|e| panic!("{path}: {e}"))
        .0
}

fn scene(text: &str) -> Model {
    deck_and_model(&format!("{HEAD}{text}")).1
}

fn along(axis: usize) -> LimitSettings {
    let mut along = [0.0; 3];
    along[axis] = 1.0;
    LimitSettings {
        along: Some(along),
        ..LimitSettings::default()
    }
}

fn associated(settings: LimitSettings) -> LimitSettings {
    LimitSettings {
        associated: true,
        ..settings
    }
}

/// Both factors of a model, of which that without dilatancy is not larger; solutions must be certified.
fn both(model: &Model, settings: LimitSettings) -> [f64; 2] {
    let [bound, level] = [associated(settings), settings].map(|settings| {
        let found = analyse(model, &settings).unwrap();
        // The cone programs are solved to 1e-9.
        assert!(
            found.gap < 1e-6 && found.converged,
            "{} {}",
            found.gap,
            found.programs
        );
        found.factor
    });
    // The tolerance of the programs.
    assert!(level <= bound * (1.0 + 1e-6), "{level} {bound}");
    [bound, level]
}

/// The associated factor is told before the search without dilatancy, then each of its programs, the last of which has
/// the answer.
#[test]
fn a_search_tells_its_progress() {
    let model = block([200.0, 100.0, 100.0]);
    let mut told: Vec<Progress> = Vec::new();
    let found = analyse_told(&model, &along(0), &mut |progress| told.push(progress)).unwrap();
    let numbers: Vec<usize> = told.iter().map(|progress| progress.programs).collect();
    let expected: Vec<usize> = std::iter::once(0).chain(2..=found.programs).collect();
    assert_eq!(numbers, expected);
    // The same program.
    assert!((told[0].factor - found.associated_factor).abs() < 1e-6);
    assert!(told.iter().any(|told| told.factor == found.factor));
    // One body slides at any program by its friction, to the tolerance of the programs.
    near(told.last().unwrap().factor, found.factor, 1e-6);
}

/// A block on another one that is held. Friction is 0.4.
fn block(size: [f64; 3]) -> Model {
    let [x, y, z] = size;
    scene(&format!(
        "[[blocks]]\nname = \"base\"\nsize = [600, 200, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
         [[blocks]]\nname = \"top\"\nsize = [{x}, {y}, {z}]\nmaterial = \"stone\"\nmesh = [2, 1, 1]\n\
         [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
         [[supports]]\non = \"base.bottom\"\n[[steps]]\nkind = \"gravity\"\n"
    ))
}

/// Accuracy of a factor: the tolerance of the programs, much above rounding.
const EXACT: f64 = 1e-6;

fn near_both(found: [f64; 2], known: f64, tolerance: f64) {
    for factor in found {
        near(factor, known, tolerance);
    }
}

fn near(found: f64, known: f64, tolerance: f64) {
    assert!((found / known - 1.0).abs() < tolerance, "{found} {known}");
}

/// A slender block of several facets on a wide base tips about its short side at any angle of the block and of the load
/// in plan: b/h = 200/800.
#[test]
fn a_turned_block_tips_as_a_straight_one() {
    for degrees in [0.0, 10.0, 20.0, 37.0, 45.0, 70.0, 90.0, 150.0_f64] {
        let model = scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [4000, 4000, 50]\nat = [-2000, -2000, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"top\"\nsize = [400, 200, 800]\nmaterial = \"stone\"\nmesh = [4, 3, 1]\n\
             rotate = {{ axis = \"z\", angle = {degrees} }}\n\
             [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
             [[supports]]\non = \"base.bottom\"\n[[steps]]\nkind = \"gravity\"\n"
        ));
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let across = LimitSettings {
            along: Some([-sine, cosine, 0.0]),
            ..LimitSettings::default()
        };
        near_both(both(&model, across), 0.25, EXACT);
    }
}

/// Two blocks without weight that a drive presses down carry the strength times the area, in both ways: their joints are
/// pressed by the live load alone.
#[test]
fn blocks_that_only_the_live_load_presses_carry_it() {
    let model = scene(
        "[[blocks]]\nname = \"base\"\nsize = [400, 200, 50]\nat = [0, 0, -50]\nmaterial = \"stone\"\n\
         [[blocks]]\nname = \"one\"\nsize = [400, 200, 400]\nmaterial = \"stone\"\n\
         [[blocks]]\nname = \"two\"\nsize = [400, 200, 400]\nat = [0, 0, 400]\nmaterial = \"stone\"\n\
         [[contacts]]\ninterface = \"dry\"\n[[supports]]\non = \"base\"\n\
         [[steps]]\nkind = \"drive\"\nface = \"two.top\"\ndirection = \"-z\"\ndisplacement = 1\n",
    );
    let crushed = LimitSettings {
        strength: Some(5.0),
        ..LimitSettings::default()
    };
    // 5 MPa on 400 by 200 mm; the search ends within a hundredth of the work.
    near_both(both(&model, crushed), 400e3, 1e-2);
}

#[test]
fn a_block_slides_or_tips() {
    for axis in [0, 1] {
        // Low: it slides at the friction. High: it tips about its edge at its width over its height.
        near_both(both(&block([200.0, 100.0, 50.0]), along(axis)), 0.4, EXACT);
        let width = [200.0, 100.0][axis];
        near_both(
            both(&block([200.0, 100.0, 800.0]), along(axis)),
            width / 800.0,
            EXACT,
        );
    }
    let found = analyse(&block([200.0, 100.0, 800.0]), &along(0)).unwrap();
    let top = found
        .mechanism
        .iter()
        .find(|unit| unit.name == "top")
        .unwrap();
    // It turns about its lower edge at x = 200: the top corner at x = 0 moves fastest, by 1.
    let spin = 1.0 / 800f64.hypot(200.0);
    assert!((top.spin[1] - spin).abs() < 1e-6 * spin, "{top:?}");
    let base = found
        .mechanism
        .iter()
        .find(|unit| unit.name == "base")
        .unwrap();
    assert_eq!((base.velocity, base.spin), ([0.0; 3], [0.0; 3]));
    // All of the weight stands on that edge.
    let weight = 2e-9 * 9810.0 * 200.0 * 100.0 * 800.0;
    near(found.joints[0].normal, weight, EXACT);
    near(found.joints[0].at_mm[0], 200.0, EXACT);
}

/// Two blocks on each other: the lower joint tips both, or the upper one slides.
#[test]
fn two_blocks_fail_at_their_weaker_joint() {
    let stack = |upper: f64| {
        scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [600, 200, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"low\"\nsize = [300, 100, 400]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"high\"\nsize = [{upper}, 100, 400]\nat = [0, 0, 400]\nmaterial = \"stone\"\n\
             [[contacts]]\ninterface = \"dry\"\n[[supports]]\non = \"base.bottom\"\n[[steps]]\nkind = \"gravity\"\n"
        ))
    };
    // Equal blocks tip as one: 300 over 800.
    near_both(both(&stack(300.0), along(0)), 300.0 / 800.0, EXACT);
    // A thin upper block tips first: 100 over 400.
    near_both(both(&stack(100.0), along(0)), 100.0 / 400.0, EXACT);
}

/// A block on a slope of 10°: pushed up it slides at tan(φ + α), pushed down at tan(φ − α).
#[test]
fn a_block_slides_up_and_down_a_slope() {
    let slope = "
[[blocks]]
name = \"base\"
size = [600, 200, 50]
at = [0, 0, 0]
rotate = { axis = \"y\", angle = \"-10 deg\" }
material = \"stone\"
[[blocks]]
name = \"top\"
size = [300, 100, 60]
at = [89.798366, 50, 66.605206]
rotate = { axis = \"y\", angle = \"-10 deg\" }
material = \"stone\"
[[contacts]]
slave = \"top.bottom\"
master = \"base.top\"
interface = \"dry\"
[[supports]]
on = \"base\"
[[steps]]
kind = \"gravity\"
";
    let model = scene(slope);
    let angles = [
        0.4f64.atan() + 10f64.to_radians(),
        0.4f64.atan() - 10f64.to_radians(),
    ];
    near_both(both(&model, along(0)), angles[0].tan(), 1e-5);
    let down = LimitSettings {
        along: Some([-1.0, 0.0, 0.0]),
        ..LimitSettings::default()
    };
    near_both(both(&model, down), angles[1].tan(), 1e-5);
}

/// Critical states without dilatancy of dry walls, in parts of the weight: those of runs in increments, validation page 6.
#[test]
fn dry_walls_slide_without_opening() {
    for (wall, known) in [
        ("wall-06-half", 0.64003),
        ("wall-08-half", 0.59485),
        ("wall-11-half", 0.55003),
        ("bricks", 0.7090),
        ("wall-11-window", 0.35588),
        ("wall-11-windows", 0.26382),
    ] {
        let model = read(&format!("docs/validation/06-dry-blocks/{wall}.toml"));
        let found = analyse(&model, &along(0)).unwrap();
        assert!(found.converged && found.opening_work <= 0.02, "{wall}");
        // The work of the pressures is within 2 %, the factor of a critical state within a fifth of it.
        near(found.factor, known, 0.004);
    }
}

/// Walls of dry blocks on a tilted table, `dry_block_wall_limit_multiplier.csv` beside the decks: linear programs with
/// associated friction, given to six digits.
#[test]
fn dry_walls_have_the_factors_of_linear_programs() {
    for (wall, known) in [
        ("wall-04-whole", 0.65),
        ("wall-06-half", 0.642859),
        ("wall-08-whole", 0.622299),
        ("wall-08-half", 0.606961),
        ("wall-11-whole", 0.577722),
        ("wall-11-half", 0.56814),
        ("wall-06-short", 0.65),
        ("column", 0.380952),
        ("bricks", 0.721986),
    ] {
        let model = read(&format!("docs/validation/06-dry-blocks/{wall}.toml"));
        let [bound, level] = both(&model, along(0));
        near(bound, known, 2e-6);
        // The difference is a few per cent at most in the literature (Ferris and Tin-Loi 2001).
        assert!(level > 0.95 * bound, "{wall}: {level}");
    }
}

/// A wall of six polygonal stones, which falls in increments near its associated factor.
#[test]
fn a_note_tells_where_runs_may_carry_much_more() {
    let model = read("tests/data/import/polygonal-stones.toml");
    let found = analyse(&model, &along(0)).unwrap();
    assert!(found.factor < 0.6 * found.associated_factor, "{found:?}");
    let note = found.note.unwrap();
    for factor in [found.factor, found.associated_factor] {
        assert!(note.contains(&format!("{factor:.4}")), "{note}");
    }
    let bound = analyse(&model, &associated(along(0))).unwrap();
    assert_eq!(bound.note, None);
    let level = read("docs/validation/06-dry-blocks/wall-04-whole.toml");
    assert_eq!(analyse(&level, &along(0)).unwrap().note, None);
}

/// Arches of flat-faced voussoirs, `arch_flat_faced.csv` beside the decks.
#[test]
fn arches_have_the_factors_of_linear_programs() {
    let tilted = read("docs/validation/05-arches/tilted-27-12.toml");
    near_both(both(&tilted, LimitSettings::default()), 0.048431, 2e-5);
    for (arch, known) in [
        ("sideways-27-11", 0.012287),
        ("sideways-27-15", 0.145338),
        ("sideways-27-20", 0.284337),
        ("sideways-07-12", 0.092304),
        ("sideways-35-20", 0.284723),
    ] {
        let model = read(&format!("docs/validation/05-arches/{arch}.toml"));
        near_both(both(&model, LimitSettings::default()), known, 2e-4);
        near_both(both(&model, along(0)), known, 1e-4);
    }
    // 1.01 and 0.99 of the least thickness.
    for voussoirs in ["07", "11", "19", "27", "35"] {
        let arch = |which| {
            read(&format!(
                "docs/validation/05-arches/{which}-{voussoirs}.toml"
            ))
        };
        assert!(analyse(&arch("stands"), &along(0)).unwrap().factor > 0.0);
        let falls = analyse(&arch("falls"), &along(0)).unwrap_err();
        assert!(matches!(falls, LimitError::FallsAt(_)), "{falls}");
    }
}

/// Driven walls: the force in kN.
#[test]
fn a_pier_below_a_beam_rocks_at_its_closed_form() {
    let model = read("examples/66_rocking_pier.toml");
    let found: LimitAnalysis = analyse(&model, &LimitSettings::default()).unwrap();
    // The weight and the jack act at half of the length of 400 mm, below the height of 1.05 m.
    let weight = 0.2 * 0.4 * 2300.0 * 9.81e-3 + 0.4 * 0.2 * 0.1 * 1.2 * 9.81e-3;
    near(found.force.unwrap(), (40.0 + weight) * 200.0 / 1050.0, 1e-4);
    // A couplet in tension carries its strength over its area.
    let model = read("examples/01_couplet_tension.toml");
    let bonded = LimitSettings {
        bonded: true,
        ..LimitSettings::default()
    };
    let pulled = analyse(&model, &bonded).unwrap().force.unwrap();
    let law = &model.contact.laws[0];
    let wythe::contact::InterfaceLaw::CohesiveFrictional(law) = law else {
        panic!("{law:?}");
    };
    let joint = &analyse(&model, &bonded).unwrap().joints[0];
    let corners = joint.corners_mm.iter();
    let size = |axis: usize| {
        let x = corners.clone().map(|x| x[axis]);
        x.clone().fold(f64::NEG_INFINITY, f64::max) - x.fold(f64::INFINITY, f64::min)
    };
    near(pulled, 1e-3 * law.f_t * size(0) * size(1), EXACT);
    assert_eq!(
        analyse(&model, &LimitSettings::default()).unwrap().force,
        Some(0.0)
    );
}

/// A block under its weight, pushed to tip: the block of stress f_c moves its hinge back by N/(2 f_c b).
#[test]
fn crushing_sets_the_hinge_back() {
    let (size, strength) = ([200.0, 100.0, 800.0], 0.05);
    let model = block(size);
    let stress = 2e-9 * 9810.0 * 800.0;
    let crushed = |strength| {
        let settings = LimitSettings {
            strength: Some(strength),
            ..along(0)
        };
        both(&model, settings)
    };
    near_both(crushed(strength), 0.25 * (1.0 - stress / strength), EXACT);
    // A strength of sixty times the stress sets a larger scale, and so a larger error.
    near_both(crushed(1.0), 0.25 * (1.0 - stress), 10.0 * EXACT);
    // Below the stress of its weight it is crushed as it stands.
    let settings = LimitSettings {
        strength: Some(0.9 * stress),
        ..along(0)
    };
    assert!(matches!(
        analyse(&model, &settings),
        Err(LimitError::FallsAt(_))
    ));
}

#[test]
fn what_has_no_factor_says_why() {
    let settings = LimitSettings::default();
    let block = block([200.0, 100.0, 50.0]);
    assert_eq!(
        analyse(&block, &settings).unwrap_err(),
        LimitError::NothingLive
    );
    // The top of J7D is locked: struts carry any force.
    let wall = read("examples/03_shear_wall_j7d.toml");
    assert_eq!(
        analyse(&wall, &settings).unwrap_err(),
        LimitError::Unbounded
    );
    let crushed = LimitSettings {
        strength: Some(5.0),
        ..settings
    };
    assert!(analyse(&wall, &associated(crushed)).unwrap().force.unwrap() > 100.0);
    let held = scene(
        "[[blocks]]\nname = \"pier\"\nsize = [200, 100, 800]\nmaterial = \"stone\"\n\
         [[supports]]\non = \"pier.bottom\"\n[[steps]]\nkind = \"gravity\"\n",
    );
    assert_eq!(analyse(&held, &along(0)).unwrap_err(), LimitError::AllHeld);
    let quarter = read("examples/65_quarter_wall.toml");
    assert_eq!(
        analyse(&quarter, &settings).unwrap_err(),
        LimitError::Symmetry
    );
    for why in [
        LimitError::NothingLive,
        LimitError::Unbounded,
        LimitError::AllHeld,
        LimitError::Symmetry,
    ] {
        assert!(!why.advice().is_empty());
    }
}

/// A block that tips about its edge, held down by a rod at 150 mm from it: λ W h/2 = W b/2 + T a.
#[test]
fn a_tie_carries_up_to_its_yield_force() {
    let tied = |more: &str| {
        scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [600, 200, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"top\"\nsize = [200, 100, 800]\nmaterial = \"stone\"\nmesh = [2, 2, 2]\n\
             [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
             [[supports]]\non = \"base.bottom\"\n\
             [[ties]]\nname = \"rod\"\npoints = [[50, 50, -25], [50, 50, 300]]\narea = 1\nE = \"200 GPa\"\n{more}\n\
             [[steps]]\nkind = \"gravity\"\n"
        ))
    };
    let weight = 2e-9 * 9810.0 * 200.0 * 100.0 * 800.0;
    let model = tied("f_y = \"50 MPa\"");
    let known = (weight * 100.0 + 50.0 * 150.0) / (weight * 400.0);
    near_both(both(&model, along(0)), known, EXACT);
    let found = analyse(&model, &along(0)).unwrap();
    assert_eq!(found.ties[0].name, "rod");
    near(found.ties[0].force, 50.0, EXACT);
    // It holds only the side on which it is stretched: from the other edge it is at 50 mm.
    let back = LimitSettings {
        along: Some([-1.0, 0.0, 0.0]),
        ..LimitSettings::default()
    };
    let known = (weight * 100.0 + 50.0 * 50.0) / (weight * 400.0);
    near_both(both(&model, back), known, EXACT);
}

/// A block whose centre lies beyond the edge of its base falls by itself, though a push back would hold it.
#[test]
fn a_scene_that_falls_without_its_live_load_has_no_factor() {
    let overhanging = |by: f64| {
        scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [200, 100, 50]\nat = [0, 0, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"top\"\nsize = [200, 100, 80]\nat = [{by}, 0, 0]\nmaterial = \"stone\"\n\
             mesh = [2, 1, 1]\n[[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\n\
             interface = \"dry\"\n[[supports]]\non = \"base.bottom\"\n[[steps]]\nkind = \"gravity\"\n"
        ))
    };
    let back = |along: [f64; 3]| LimitSettings {
        along: Some(along),
        ..LimitSettings::default()
    };
    let along = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for along in along {
        let falls = analyse(&overhanging(110.0), &back(along)).unwrap_err();
        assert_eq!(falls, LimitError::FallsAt("top".to_owned()), "{along:?}");
        assert!(analyse(&overhanging(90.0), &back(along)).is_ok());
    }
}

/// A pier of 400 mm that is 100 mm wide at its top, 600 mm higher, is pushed at its centroid at 240 mm: W 200/240.
#[test]
fn a_force_on_a_tapered_block_acts_at_its_centroid() {
    for mesh in ["[1, 1, 1]", "[2, 1, 3]"] {
        let model = scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [600, 400, 50]\nat = [-100, -100, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"top\"\nmaterial = \"stone\"\nmesh = {mesh}\n\
             corners = [[0, 0, 0], [400, 0, 0], [400, 200, 0], [0, 200, 0], [150, 0, 600], [250, 0, 600], \
             [250, 200, 600], [150, 200, 600]]\n\
             [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"rough\"\n\
             [[supports]]\non = \"base.bottom\"\n[interfaces.rough]\nf_t = 0\nc = 0\ntan_phi = 5\nmu = 5\n\
             [[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"H\"\n\
             on = \"top\"\nforce = [100, 0, 0]\n"
        ));
        let weight = 2e-9 * 9810.0 * 250.0 * 200.0 * 600.0;
        let known = weight * 200.0 / 240.0 / 100.0;
        near_both(both(&model, LimitSettings::default()), known, EXACT);
    }
}

/// The load of a step before the live one is what its amplitude leaves of it.
#[test]
fn dead_loads_end_as_their_amplitude_does() {
    let pressed = |end: f64| {
        let model = scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [600, 200, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"top\"\nsize = [400, 100, 80]\nmaterial = \"stone\"\nmesh = [2, 2, 2]\n\
             [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
             [[supports]]\non = \"base.bottom\"\n[[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"load\"\n\
             amplitude = [[0, 0], [0.5, 1], [1, {end}]]\n[[steps.loads]]\nname = \"N\"\non = \"top.top\"\n\
             force = [0, 0, -1000]\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"H\"\n\
             on = \"top.left\"\nforce = [1, 0, 0]\n"
        ));
        analyse(&model, &LimitSettings::default()).unwrap().factor
    };
    let weight = 2e-9 * 9810.0 * 400.0 * 100.0 * 80.0;
    for end in [0.0, 0.25, 1.0] {
        near(pressed(end), 0.4 * (weight + 1000.0 * end), EXACT);
    }
}

/// A rod through the joint presses a squat block on its base, so that it slides at μ (W + P).
#[test]
fn a_prestressed_tie_presses_the_joint() {
    let model = scene(
        "[[blocks]]\nname = \"base\"\nsize = [600, 200, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
         [[blocks]]\nname = \"top\"\nsize = [400, 100, 80]\nmaterial = \"stone\"\nmesh = [2, 2, 2]\n\
         [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
         [[supports]]\non = \"base.bottom\"\n\
         [[ties]]\nname = \"rod\"\npoints = [[200, 50, -25], [200, 50, 60]]\narea = 1\nE = \"200 GPa\"\n\
         f_y = \"50 MPa\"\nprestress = \"20 N\"\n[[steps]]\nkind = \"gravity\"\n",
    );
    let weight = 2e-9 * 9810.0 * 400.0 * 100.0 * 80.0;
    let found = analyse(&model, &along(0)).unwrap();
    near(found.factor, 0.4 * (weight + 20.0) / weight, EXACT);
    near(found.ties[0].force, 20.0, EXACT);
}

/// Faces that only general contact pairs have their area once, whichever body is first.
#[test]
fn loose_faces_are_joined_once() {
    let scene = |contact: &str| {
        scene(&format!(
            "[[blocks]]\nname = \"base\"\nsize = [600, 200, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
             [[blocks]]\nname = \"top\"\nsize = [200, 100, 800]\nmaterial = \"stone\"\n{contact}\
             [[supports]]\non = \"base.bottom\"\n[[steps]]\nkind = \"gravity\"\n"
        ))
    };
    let planned =
        scene("[[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n");
    let mut loose =
        scene("[[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n");
    let stiffness = wythe::model::general::DryStiffness::Penalty(50.0);
    let general = wythe::model::general::GeneralContact::new(
        "dry",
        &loose.mesh,
        &loose.materials,
        0.4,
        stiffness,
    );
    loose.contact = wythe::model::scene::ContactSurfaces::default();
    loose.contact.general = Some(general);
    let crushed = LimitSettings {
        strength: Some(0.05),
        ..along(0)
    };
    let [a, b] = [&planned, &loose].map(|model| analyse(model, &crushed).unwrap());
    assert_eq!((a.joints.len(), b.joints.len()), (1, 1));
    near(b.factor, a.factor, EXACT);
}

/// Its steps would be run as those of the detailed model.
#[test]
fn a_deck_for_limit_analysis_is_not_run() {
    use crate::common::scene::Recording;
    use wythe::solve::{RunError, run};
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/08_block_couplet.toml"
    );
    for (strategy, refused) in [("limit", true), ("detailed", false)] {
        let set = [("strategy".to_owned(), format!("\"{strategy}\""))];
        let deck = Deck::load(path, &set).unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let ran = run(&model, &mut Recording::default());
        assert_eq!(
            matches!(ran, Err(RunError::LimitOnly)),
            refused,
            "{strategy}"
        );
    }
}
