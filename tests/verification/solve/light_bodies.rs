//! Bodies and displacements that are small beside the largest forces of a scene.

use crate::common::blocks::deck_and_model;
use crate::common::scene::{self, G};
use wythe::state::Status;

/// A stone of 16 kg is pushed beside a pier under 2,000 kN. It slides when the push exceeds μ times its weight, whatever
/// stands beside it.
#[test]
fn a_light_stone_slides_beside_a_loaded_pier() {
    let text = "format = 1\n[materials.stone]\nE = \"20 GPa\"\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n\
                [interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = 0.5\nmu = 0.5\nnormal_stiffness = 100\n\
                shear_stiffness = 40\n[[blocks]]\nname = \"ground\"\nsize = [3000, 1000, 100]\n\
                at = [-350, -350, -100]\nmaterial = \"stone\"\nmesh = [3, 1, 1]\n[[supports]]\n\
                on = \"ground.bottom\"\n[[blocks]]\nname = \"pier\"\nsize = [500, 400, 1000]\n\
                material = \"stone\"\nmesh = [2, 2, 4]\n[[blocks]]\nname = \"small\"\n\
                size = [200, 200, 200]\nat = [1000, 0, 0]\nmaterial = \"stone\"\n[[contacts]]\n\
                interface = \"dry\"\n[[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"load\"\n\
                [[steps.loads]]\nname = \"N\"\non = \"pier.top\"\nforce = [0, 0, -2e6]\n[[steps]]\n\
                kind = \"load\"\n[[steps.loads]]\nname = \"H\"\non = \"small.left\"\n\
                force = [100, 0, 0]\n";
    let (_, model) = deck_and_model(text);
    let (_, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Collapsed, "{}", summary.message);
    let force = 100.0 * summary.fall.expect("a fall").load_factor;
    let friction = 0.5 * 0.2 * 0.2 * 0.2 * 2000.0 * 9.81;
    // The resultant on the stone is found to 0.4 % of the forces on it, four times its friction. The load of a fall is
    // found to 2 % (increments.peak).
    assert!(
        (force / friction - 1.0).abs() < 0.036,
        "{force} N for {friction} N"
    );
}

/// A flat stone of 8 kg beside a pier under 10 MPa, whose energy is 10,000 times that of the stone in motion: the loads
/// wait for it, and its fall is that at which it began to slide.
#[test]
fn the_fall_of_a_light_stone_is_found_beside_a_pressed_pier() {
    let text = "format = 1\n[materials.stone]\nE = \"5 GPa\"\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n\
                [interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = 0.5\nmu = 0.5\n[[blocks]]\nname = \"floor\"\n\
                size = [3000, 400, 200]\nmaterial = \"stone\"\nmesh = [8, 2, 1]\n[[supports]]\non = \"floor.bottom\"\n\
                [[blocks]]\nname = \"pier\"\nsize = [400, 400, 600]\nat = [0, 0, 200]\nmaterial = \"stone\"\n\
                mesh = [2, 2, 3]\n[[blocks]]\nname = \"loose\"\nsize = [200, 200, 100]\nat = [1200, 100, 200]\n\
                material = \"stone\"\nmesh = [1, 1, 1]\n[[contacts]]\nslave = [\"pier.bottom\", \"loose.bottom\"]\n\
                master = \"floor.top\"\ninterface = \"dry\"\n[[steps]]\nkind = \"gravity\"\n[[steps]]\n\
                kind = \"load\"\n[[steps.loads]]\nname = \"press\"\non = \"pier.top\"\n\
                traction = [0, 0, \"-10 MPa\"]\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"push\"\n\
                on = \"loose.left\"\nforce = [78.48, 0, 0]\n";
    let (_, model) = deck_and_model(text);
    let (_, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Collapsed, "{}", summary.message);
    let factor = summary.fall.expect("a fall").load_factor;
    // As above: 4 times 0.4 % and 2 %. By the energy of the whole scene it was 0.5475.
    assert!((factor / 0.5 - 1.0).abs() < 0.036, "{factor} for 0.5");
}

/// A strip under six tenths of its critical load N and N/10,000 across it, which grow together, bends 2.5 times as far
/// as without N: u = u₁/(1 − N/N_cr).
#[test]
fn a_pressed_strip_bends_more_than_in_first_order() {
    let (e, height, thickness, width) = (5000.0_f64, 3000.0_f64, 100.0_f64, 800.0_f64);
    let second_moment = width * thickness.powi(3) / 12.0;
    let critical = std::f64::consts::PI.powi(2) * e * second_moment / (4.0 * height * height);
    let (pressure, across) = (0.6 * critical, 0.6e-4 * critical);
    // Spread over the height, the force across bends by F h³/(8 E I).
    let first = across * height.powi(3) / (8.0 * e * second_moment);
    let text = format!(
        "format = 1\nfidelity = \"full\"\n[materials.elastic]\nE = {e}\nnu = 0.0\n[[blocks]]\nname = \"w\"\n\
         size = [{width}, {thickness}, {height}]\nmaterial = \"elastic\"\nmesh = [1, 2, 30]\n[[supports]]\n\
         on = \"w.bottom\"\n[[probes]]\nname = \"top\"\non = \"w.top\"\ndirection = \"y\"\n[[steps]]\n\
         kind = \"load\"\n[[steps.loads]]\nname = \"N\"\non = \"w.top\"\nforce = [0, 0, {}]\n\
         [[steps.loads]]\nname = \"H\"\non = \"w.front\"\npressure = {}\nfollower = false\n",
        -pressure,
        across / (width * height)
    );
    let (_, model) = deck_and_model(&text);
    let recording = scene::completed(&model);
    let found = recording.rows.last().expect("a row").probes[0];
    let exact = first / (1.0 - 0.6);
    // What is left of the displacement is at most half a hundredth of the largest over 1 − 0.6, here 4 %.
    assert!(
        (found / exact - 1.0).abs() < 0.05,
        "{found} mm for {exact} mm"
    );
}

/// A stone beside a pier of 1,200 times its mass slides down a slope as it does alone: its forces, far below those of the
/// pier, balance by themselves.
#[test]
fn a_light_stone_beside_a_pier_slides_as_it_does_alone() {
    let block = |name: &str, size: &str, at: &str, mesh: &str| {
        format!(
            "[[blocks]]\nname = \"{name}\"\nsize = {size}\nat = {at}\nmaterial = \"stone\"\nmesh = {mesh}\n"
        )
    };
    let deck = format!(
        "format = 1\n[materials.stone]\nE = \"20 GPa\"\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n[interfaces.dry]\nf_t = 0\n\
         c = 0\ntan_phi = 0.5\nmu = 0.5\n{}{}{}[[supports]]\non = [\"ground\", \"pier.bottom\"]\n[[contacts]]\n\
         slave = \"stone.bottom\"\nmaster = \"ground.top\"\ninterface = \"dry\"\n[[probes]]\nname = \"way\"\non = \"stone\"\n\
         direction = \"x\"\n[[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"free\"\nprocedure = \"dynamic\"\n\
         duration = 0.5\nangle = 30\n",
        block(
            "ground",
            "[4000, 3000, 100]",
            "[-1000, -1500, -100]",
            "[4, 2, 1]"
        ),
        block("stone", "[100, 100, 100]", "[0, -50, 0]", "[1, 1, 1]"),
        block("pier", "[1000, 400, 3000]", "[1200, -200, 0]", "[4, 2, 12]"),
    );
    let (_, model) = deck_and_model(&deck);
    let recording = scene::completed(&model);
    let way = recording.rows.last().unwrap().probes[0];
    let slope = 30.0_f64.to_radians();
    let exact = 0.5 * G * (slope.sin() - 0.5 * slope.cos()) * 0.25;
    // The tolerance of a body is 0.4 % of its forces, four times the difference that accelerates it.
    assert!((way / exact - 1.0).abs() < 0.02, "{way} for {exact} mm");
}

/// A block that slides fast and drops by 1 mm does not rebound higher: the energy that HHT may make is measured by the blow,
/// not by the motion of the block.
#[test]
fn a_block_that_slides_fast_does_not_hop() {
    let deck = "format = 1\n[materials.stone]\nE = \"20 GPa\"\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n[interfaces.dry]\nf_t = 0\n\
                c = 0\ntan_phi = 0.3\nmu = 0.3\n[contact]\ngeneral = \"dry\"\n[[blocks]]\nname = \"ground\"\n\
                size = [8000, 1000, 100]\nat = [-500, -500, -100]\nmaterial = \"stone\"\n[[supports]]\non = \"ground\"\n\
                [[blocks]]\nname = \"b\"\nsize = [150, 120, 120]\nat = [0, 0, 1]\nmaterial = \"stone\"\nmesh = [1, 1, 1]\n\
                velocity = [8000, 0, 0]\n[[probes]]\nname = \"up\"\non = \"b\"\ndirection = \"z\"\n[[steps]]\nkind = \"free\"\n\
                procedure = \"dynamic\"\nduration = 0.5\ngravity = 9810\n";
    let (_, model) = deck_and_model(deck);
    let recording = scene::completed(&model);
    let highest = recording
        .rows
        .iter()
        .map(|row| row.probes[0])
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(highest < 0.0, "{highest} mm above its start");
}
