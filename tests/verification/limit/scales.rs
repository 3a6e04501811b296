//! Scenes whose bodies have very different weights, and springs that hold with any force.

use super::{EXACT, along, analyse, associated, both, near, near_both, scene};
use crate::common::blocks::GRAVITY;
use wythe::limit::{LimitError, LimitSettings};

/// A cuboid of one element.
fn cuboid(name: &str, size: [f64; 3], at: [f64; 3]) -> String {
    format!(
        "[[blocks]]\nname = \"{name}\"\nsize = {size:?}\nat = {at:?}\nmaterial = \"stone\"\nmesh = [1, 1, 1]\n"
    )
}

/// A base that is held, with its top at height 0 and its middle below the middle of a block of 200 × 100 mm.
fn base(length: f64, depth: f64) -> String {
    let at = [100.0 - 0.5 * length, 50.0 - 0.5 * length, -depth];
    cuboid("base", [length, length, depth], at)
}

const ALL_DRY: &str = "[[contacts]]\ninterface = \"dry\"\n";
const HELD: &str = "[[supports]]\non = \"base.bottom\"\n";

/// A block tips at its width over its height, however heavy the ground is: up to 2e8 of its mass.
#[test]
fn the_weight_of_held_bodies_does_not_matter() {
    // One support, and two that hold the same face in different directions.
    let apart = "[[supports]]\non = \"base.bottom\"\nfixed = [\"x\"]\n\
                 [[supports]]\non = \"base.bottom\"\nfixed = [\"y\", \"z\"]\n";
    for (length, depth) in [(600.0, 50.0), (4e4, 1e3), (4e5, 2e4)] {
        for supports in [HELD, apart] {
            let model = scene(&format!(
                "{}{}{ALL_DRY}{supports}{GRAVITY}",
                base(length, depth),
                cuboid("top", [200.0, 100.0, 800.0], [0.0; 3])
            ));
            near_both(both(&model, along(0)), 0.25, EXACT);
            let found = analyse(&model, &along(0)).unwrap();
            assert_eq!(found.sizes[0], 1, "the base cannot move");
            assert_eq!(found.light_body, None);
        }
    }
}

/// A stone of any size tips at a quarter of its weight beside a heavy block that slides at 0.4.
#[test]
fn a_tiny_stone_beside_a_heavy_block_fails_at_its_own_factor() {
    for height in [100.0, 1.0, 0.1] {
        let tiny = [0.25 * height, 0.5 * height, height];
        let model = scene(&format!(
            "{}{}{}{ALL_DRY}{HELD}{GRAVITY}",
            base(6000.0, 100.0),
            cuboid("heavy", [2000.0, 1000.0, 1000.0], [0.0; 3]),
            cuboid("tiny", tiny, [-500.0, 0.0, 0.0])
        ));
        near_both(both(&model, along(0)), 0.25, EXACT);
        let found = analyse(&model, &along(0)).unwrap();
        assert_eq!(found.light_body, None, "they do not touch");
        for unit in &found.mechanism {
            let moves = unit.velocity.iter().any(|v| v.abs() > 0.1);
            assert_eq!(moves, unit.name == "tiny", "{unit:?}");
        }
    }
}

/// A heavy block tips first; a tiny cube beside it, whose velocities in the program are rounding, is at rest.
#[test]
fn a_tiny_stone_beside_a_heavy_mechanism_is_at_rest() {
    let model = scene(&format!(
        "{}{}{}{ALL_DRY}{HELD}{GRAVITY}",
        base(6000.0, 100.0),
        cuboid("heavy", [500.0, 1000.0, 2000.0], [0.0; 3]),
        cuboid("tiny", [0.1; 3], [-500.0, 0.0, 0.0])
    ));
    near_both(both(&model, along(0)), 0.25, EXACT);
    let found = analyse(&model, &associated(along(0))).unwrap();
    let tiny = found.mechanism.iter().find(|unit| unit.name == "tiny");
    assert_eq!(tiny.unwrap().velocity, [0.0; 3]);
}

/// A light stone on a heavy block that can move is in one group with it, and is named if its part is below a
/// millionth.
#[test]
fn a_light_body_on_a_heavy_one_is_named() {
    let found = |height: f64| {
        let tiny = [0.25 * height, 0.5 * height, height];
        let model = scene(&format!(
            "{}{}{}{ALL_DRY}{HELD}{GRAVITY}",
            base(6000.0, 100.0),
            cuboid("heavy", [2000.0, 1000.0, 1000.0], [0.0; 3]),
            cuboid("tiny", tiny, [500.0, 400.0, 1000.0])
        ));
        near_both(both(&model, along(0)), 0.25, 1e-5);
        analyse(&model, &along(0)).unwrap().light_body
    };
    assert_eq!(found(40.0), None);
    let light = found(10.0).unwrap();
    assert_eq!(light.name, "tiny");
    near(light.part, 2.5 * 5.0 * 10.0 / 2e9, 1e-6);
}

/// The top of a block is loaded along a spring of the same face, or the block is held down by an elastic tie. Without
/// them it tips.
#[test]
fn springs_and_ties_that_hold_any_load_are_named() {
    let held = |more: &str| {
        let model = scene(&format!(
            "{}{}{ALL_DRY}{HELD}{more}",
            base(600.0, 50.0),
            cuboid("top", [200.0, 100.0, 800.0], [0.0; 3])
        ));
        analyse(&model, &associated(LimitSettings::default()))
    };
    let load = "[[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"p\"\n\
                on = \"top.top\"\nforce = [100, 0, 0]\n";
    let spring = "[[springs]]\nname = \"k\"\non = \"top.top\"\nstiffness = [100, 0, 0]\n";
    let tie = "[[ties]]\nname = \"rod\"\npoints = [[50, 50, -25], [50, 50, 300]]\narea = 1\nE = \"200 GPa\"\n";
    for (holders, names) in [
        (spring.to_owned(), "the spring `k`"),
        (tie.to_owned(), "the tie `rod`"),
        (format!("{spring}{tie}"), "the spring `k`, the tie `rod`"),
    ] {
        let why = held(&format!("{holders}{load}")).unwrap_err();
        assert_eq!(why, LimitError::Held(names.to_owned()));
        assert!(why.to_string().ends_with(names), "{why}");
        assert!(why.advice().contains("springs have no strength"));
    }
    // W b/2 = H h.
    let weight = 2e-9 * 9810.0 * 200.0 * 100.0 * 800.0;
    near(
        held(load).unwrap().factor,
        weight * 100.0 / 800.0 / 100.0,
        EXACT,
    );
    // A spring across the load leaves the factor.
    let across = spring.replace("[100, 0, 0]", "[0, 100, 0]");
    assert!(held(&format!("{across}{load}")).is_ok());
}
