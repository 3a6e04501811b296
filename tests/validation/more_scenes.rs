//! Examples 71 to 88: each runs, closes its energy balance, and shows its intended effect, compared with statics or a
//! closed form.

use crate::common::examples::completed;
use wythe::state::HistoryRow;

fn rows(name: &str, overrides: &[(&str, &str)]) -> Vec<HistoryRow> {
    completed(name, overrides).1.rows
}

fn last(name: &str, overrides: &[(&str, &str)]) -> HistoryRow {
    rows(name, overrides).pop().unwrap()
}

/// Largest value of a column.
fn peak<'r>(rows: impl IntoIterator<Item = &'r HistoryRow>, of: fn(&HistoryRow) -> f64) -> f64 {
    rows.into_iter().map(of).fold(f64::MIN, f64::max)
}

/// Checks that `measured` equals `known` within the relative `tolerance`.
fn near(measured: f64, known: f64, tolerance: f64) {
    println!(
        "{measured} of {known}, {:+.3} %",
        100.0 * (measured / known - 1.0)
    );
    assert!(
        (measured / known - 1.0).abs() < tolerance,
        "{measured} of {known}"
    );
}

/// Height [mm] and modulus of a column with bricks of 65 mm and beds of 10 mm: E = H/Σ(h/E) [MPa].
fn column(courses: f64) -> (f64, f64) {
    let (bricks, beds) = (65.0 * courses, 10.0 * (courses - 1.0));
    let h = bricks + beds;
    (h, h / (bricks / 16700.0 + beds / 850.0))
}

/// Mortar between bricks cannot expand laterally: up to (1−ν)/(1+ν)(1−2ν) = 1.056 times as stiff; plus 1 % for head
/// joints.
const CONFINED: f64 = 1.066;

#[test]
fn headers_make_one_section_of_two_leaves() {
    let (h, e) = column(12.0);
    let (load, eccentricity) = (5.0 * 552.5, 215.0 / 2.0);
    let inertia = 552.5 * 215.0_f64.powi(3) / 12.0;
    let u = load * eccentricity * h * h / (2.0 * e * inertia);
    for bond in ["flemish", "english", "english-cross", "header"] {
        let bends = -last("71_flemish_wall", &[("wall.bond", bond)]).probes[0];
        println!("{bond}: {bends} of {u} mm");
        assert!(
            bends < 1.01 * u && bends > u / CONFINED,
            "{bond}: {bends} of {u} mm"
        );
    }
}

#[test]
fn headers_hand_a_part_of_the_load_to_the_leaf_behind() {
    let settles = |o: &[(&str, &str)]| last("72_leaves_and_headers", o).probes[0];
    let (h, e) = column(7.0);
    let alone = 0.5 * h / e;
    let (with, without) = (
        settles(&[]),
        settles(&[("wall.pattern.3.leaves.0.headers", "[]")]),
    );
    println!("{with}, {without} of {alone} mm");
    assert!(without < 1.01 * alone && without > alone / CONFINED);
    // The blocks of 5,000 MPa and 140 mm are as stiff as the front leaf. Above the header they take nothing, below it
    // all that the header transfers: 0.85, not less than one half.
    assert!(with < 0.9 * without && with > 0.5 * without);
}

#[test]
fn a_low_ashlar_wall_slides_at_its_angle_of_friction() {
    let rows = rows("73_tilted_ashlar", &[]);
    let slid = rows.iter().find(|r| r.probes[0] > 0.1).expect("it slides");
    // The table waits while the wall slides.
    let angle = 31.1 * slid.load_factor;
    near(angle, 0.6_f64.atan().to_degrees(), 4e-3);
}

#[test]
fn walls_that_interlock_in_a_t_are_one_section() {
    let row = last("74_t_junction", &[]);
    let (h, e) = column(12.0);
    let (flange, web) = (552.5 * 102.5, 102.5 * 337.5);
    let area: f64 = flange + web;
    let centre: f64 = (flange * 51.25 + web * 271.25) / area;
    let inertia = 552.5 * 102.5_f64.powi(3) / 12.0
        + flange * (centre - 51.25).powi(2)
        + 102.5 * 337.5_f64.powi(3) / 12.0
        + web * (271.25 - centre).powi(2);
    let arm = 440.0 - centre;
    let turns = 1000.0 * arm * h / (e * inertia);
    let (web, flange) = (row.probes[0], row.probes[1]);
    let measured = (web - flange) / 440.0;
    println!("{measured} of {turns}");
    // 4 % above the column for the bond of the beam and the crossing head joints.
    assert!(measured < 1.01 * turns && measured > turns / (CONFINED + 0.04));
}

#[test]
fn a_lintel_carries_the_wall_over_an_opening() {
    let opening = "[{ from = 337.5, to = 1002.5, sill = 2, courses = 3 }]";
    let with = last("75_window_with_lintel", &[]);
    let without = last("75_window_with_lintel", &[("wall.openings", opening)]);
    println!("{with:?}\n{without:?}");
    // A beam hinged at the edges of the opening would bend by 5 q l⁴/384 E I in addition to the settlement of the
    // piers.
    let inertia = 102.5 * 65.0_f64.powi(3) / 12.0;
    let beam = 5.0 * 0.1 * 102.5 * 665.0_f64.powi(4) / (384.0 * 3e4 * inertia);
    assert!(with.probes[0] > 0.0 && with.probes[0] < beam);
    assert!(without.probes[0] > 1.1 * with.probes[0]);
    assert!(without.max_interface_damage > 10.0 * with.max_interface_damage);
}

#[test]
fn a_wedge_rubs_on_both_sides_of_its_groove() {
    let row = last("76_wedge_in_a_groove", &[]);
    let weight = 0.5 * (40.0 + 240.0) * 100.0 * 100.0 * 2e-9 * 9810.0;
    // Tolerance: the residual of equilibrium.
    near(1e3 * row.force_kN, 0.3 * weight / 0.5_f64.sqrt(), 1e-3);
}

#[test]
fn springs_share_loads_by_the_lever_rule() {
    let row = last("77_slab_on_springs", &[]);
    // 1,000 N at (200, 100) and 1,200 N at (1,000, 300) over feet at (50, 50), (50, 550), (950, 250).
    let right = (200e3 + 1200e3 - 50.0 * 2200.0) / 900.0;
    let back = (100e3 + 360e3 - 50.0 * (2200.0 - right) - 250.0 * right) / 500.0;
    let front = 2200.0 - right - back;
    for (name, force, settles) in [
        ("front", front, row.probes[0]),
        ("back", back, row.probes[1]),
        ("right", right, row.probes[2]),
    ] {
        println!("{name}: {} of {force} N", 1e3 * settles);
        // The slab rotates by 1.5 mrad and moves 0.3 mm sideways above its feet: 2,200 N by 0.3 mm over 500 mm.
        assert!((1e3 * settles - force).abs() < 1.5, "{name}: {settles}");
    }
}

#[test]
fn drums_from_gmsh_turn_over_their_edge() {
    let rows = rows("78_gmsh_drums", &[]);
    let up = rows.iter().find(|r| r.probes[0] > 1.0).expect("it turns");
    let angle = 52.4 * (up.time - 1.0) / 262.0;
    let known = (200.0 * 15.0_f64.to_radians().cos() / 150.0).atan();
    // The fall takes half a second, 0.1°; dry joints of 100 N/mm³ deform.
    near(angle, known.to_degrees(), 5e-3);
}

#[test]
fn concrete_unloads_with_its_damaged_stiffness() {
    let rows = rows("79_concrete_to_and_fro", &[]);
    // Tolerance: chords between rows and increments.
    near(peak(&rows, |r| r.force_kN.abs()), 276.0, 5e-3);
    let mut unloadings = 0;
    for pair in rows.windows(2) {
        let [a, b] = pair else { unreachable!() };
        let way = b.probes[0] - a.probes[0];
        if way > 0.0 && a.max_compressive_damage == b.max_compressive_damage {
            let stiffness = (b.force_kN.abs() - a.force_kN.abs()) / -way;
            let left = 3170.0 * (1.0 - b.max_compressive_damage);
            assert!((stiffness / left - 1.0).abs() < 1e-4, "{stiffness} {left}");
            unloadings += 1;
        }
    }
    assert!(unloadings > 20);
    assert!(rows.last().unwrap().max_compressive_damage > 0.4);
}

#[test]
fn concrete_carries_more_in_two_directions() {
    let force = |o: &[(&str, &str)]| {
        peak(&rows("80_concrete_in_two_directions", o), |r| {
            r.force_kN.abs()
        })
    };
    // Increments of 3 µm cut the corner at the peak between two rows.
    near(force(&[]), 1.16 * 276.0, 2e-3);
    near(force(&[("steps.0.loads.1.pressure", "0")]), 276.0, 2e-3);
}

#[test]
fn a_prism_is_stronger_than_its_mortar_and_weaker_than_its_bricks() {
    let rows = rows("81_prism", &[]);
    let strength = peak(&rows, |r| 1e3 * r.force_kN) / (204.0 * 49.0);
    println!("{strength} MPa");
    // Strengths of the mortar and of the bricks.
    assert!(strength > 8.2 && strength < 11.5, "{strength} MPa");
    assert!(rows.last().unwrap().max_compressive_damage > 0.5);
}

/// Compressed across its beds the wallette tears through bricks, otherwise its joints slide.
#[test]
fn a_pressed_wallette_tears_through_its_bricks() {
    let run = |o: &[(&str, &str)]| {
        let rows = rows("82_wallette_pulled", o);
        let pulled: Vec<HistoryRow> = rows.into_iter().filter(|r| r.step == 1).collect();
        let force = 1e3 * peak(&pulled, |r| r.force_kN);
        (force, peak(&pulled, |r| r.max_tensile_damage))
    };
    // Upper bound: bricks in two of four courses, head joints in the others, mortar of three beds.
    let most = 49.0 * (2.0 * 50.0 * 3.5 + 2.0 * 50.0 * 0.2 + 3.0 * 12.5 * 1.5);
    let (force, damage) = run(&[]);
    println!("{force} of {most} N, {damage}");
    // The bricks and the joints reach their strengths one after the other: 0.78 of the bound.
    assert!(force < most && force > 0.75 * most);
    assert!(damage > 0.9);
    let (slides, whole) = run(&[("steps.0.loads.0.pressure", "0.1")]);
    println!("{slides} N, {whole}");
    // The friction of the beds is 0.37 of that force.
    assert!(slides < 0.4 * force && whole < 0.1);
}

#[test]
fn a_wallette_cracks_along_its_diagonal() {
    let rows = rows("83_wallette_in_shear", &[]);
    let last = rows.last().unwrap();
    // Upper bound: bond and friction of a whole bed, which no diagonal crack can reach.
    let most = 1e-3 * 420.5 * 49.0 * (0.22 + 0.75 * 1.5);
    let force = peak(&rows, |r| r.force_kN);
    println!("{force} of {most} kN");
    // The crack goes down in steps, with bricks torn between them: 0.78 of the bound.
    assert!(force < most && force > 0.75 * most);
    assert!(last.max_interface_damage > 0.99 && last.max_tensile_damage > 0.5);
}

#[test]
fn a_push_in_the_plane_weakens_a_wall_out_of_it() {
    let pressure = |o: &[(&str, &str)]| {
        let rows = rows("84_pushed_then_pressed", o);
        peak(rows.iter().filter(|r| r.step == 2), |r| {
            10.0 * r.load_factor
        })
    };
    let (pushed, alone) = (
        pressure(&[]),
        pressure(&[("steps.1.displacement", "0.001")]),
    );
    println!("{pushed}, {alone} kPa");
    // The joints that slid have lost their bond: 0.86 of the wall that was not pushed.
    assert!(pushed > 0.8 * alone && pushed < 0.9 * alone);
}

/// Limit analysis of rigid voussoirs with flat faces (docs/validation/05-arches).
#[test]
fn an_arch_is_pushed_sideways_until_four_hinges_open() {
    let rows = rows("85_arch_sideways", &[]);
    let pushed = rows.iter().filter(|r| r.step == 1);
    // Joints deform by 0.01 mm before the last hinge opens: 0.05 % less.
    near(peak(pushed, |r| r.load_factor), 0.16134, 2e-3);
}

#[test]
fn a_block_rocks_in_housners_time() {
    let rows = rows("86_rocking_block", &[]);
    let height = 200.0 * 5.65496_f64.to_radians().sin();
    let impact = rows.iter().find(|r| r.probes[0] > height - 0.01).unwrap();
    // The linearised solution is 0.03 to 0.27 % too short; increments of half a millisecond are
    // 0.14 %.
    near(impact.time, 1.38679 / 4.0, 4e-3);
    // The block leaves more slowly than it arrived.
    let before = impact.probes[1].abs();
    assert!(rows.last().unwrap().probes[1].abs() < before);
    assert!(rows.last().unwrap().kinetic_energy_J < impact.kinetic_energy_J);
}

#[test]
fn a_wall_is_shaken_to_collapse() {
    let falls = last("87_shaken_wall", &[]);
    // Three times its thickness: return is impossible.
    assert!(falls.probes[0].abs() > 300.0, "{falls:?}");
    assert_eq!(falls.max_interface_damage, 1.0);
    // Below t/H = 98/612.5 of gravity the wall cannot rock, even without bond.
    let stands = last("87_shaken_wall", &[("steps.1.ground_factor.y", "0.15")]);
    assert!(stands.probes[0].abs() < 0.01, "{stands:?}");
}

#[test]
fn an_english_bond_spans_from_foot_to_top() {
    let rows = rows("88_english_bond_pressed", &[]);
    let unit = 0.2e3 * (215.0_f64 / 890.0).powi(2); // f_t (t/H)² [kPa]
    let pressed = || rows.iter().filter(|r| r.step == 1);
    let pressure = peak(pressed(), |r| 10.0 * r.load_factor);
    println!(
        "{pressure} kPa of {} to {}",
        8.0 / 6.0 * unit,
        11.66 / 2.0 * unit
    );
    assert!(pressure > 8.0 / 6.0 * unit && pressure < 11.66 / 2.0 * unit);
    assert!(10.0 * rows.last().unwrap().load_factor < 0.6 * pressure);
}
