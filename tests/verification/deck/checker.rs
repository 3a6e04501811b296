//! Findings of `check` before a run: sizes, energies, warnings, and limits.

use crate::common::examples::{load, path};
use crate::common::scene::completed;
use wythe::deck::{Deck, check};
use wythe::model::Model;

/// Two elements through the thickness are too few for a wall in bending, and enough for a wall in shear.
#[test]
fn the_checker_reports_walls_with_too_few_elements_for_bending() {
    let told = |name: &str, overrides: &[(&str, &str)]| {
        let deck = load(name, overrides);
        let (model, _) = Model::from_deck(&deck).unwrap();
        let mut notes = check(&deck, &model).notes.into_iter();
        notes.find(|note| note.contains("bent out of its plane"))
    };
    let pressed = told("62_out_of_plane_wall", &[("wall.mesh", "coarse")]).unwrap();
    assert!(pressed.contains("wall.mesh = [5, 2, 3]"), "{pressed}");
    assert_eq!(
        told("62_out_of_plane_wall", &[("wall.mesh", "[5, 2, 3]")]),
        None
    );
    let across = ("steps.1.direction", "y");
    assert_eq!(told("03_shear_wall_j7d", &[]), None);
    assert!(told("03_shear_wall_j7d", &[across, ("wall.mesh", "coarse")]).is_some());

    // The default is three elements.
    let text = std::fs::read_to_string(path("03_shear_wall_j7d")).unwrap();
    let silent = Deck::from_str(&text.replace("mesh = \"coarse\"", ""), "wall.toml").unwrap();
    assert_eq!(silent.wall.unwrap().mesh.thickness, 2);
    let mesh =
        |overrides: &[(&str, &str)]| load("62_out_of_plane_wall", overrides).wall.unwrap().mesh;
    assert_eq!(mesh(&[]).thickness, 3);
    assert_eq!(mesh(&[("wall.mesh", "coarse")]).thickness, 2);
    // A part of the wall, and a wall along y, whose faces are left and right.
    let along = |axis: &'static str, face: &'static str| {
        mesh(&[("wall.along", axis), ("steps.1.loads.0.on", face)]).thickness
    };
    assert_eq!(along("x", "wall.course-3.front"), 3);
    assert_eq!(along("y", "wall.right"), 3);
    assert_eq!(along("y", "wall.front"), 2);
    // The default stiffness of joints in walls with mortar is a tenth of that of other joints.
    let factor = |name: &str, overrides: &[(&str, &str)]| {
        load(name, overrides).interfaces["joint"].penalty()
    };
    let said = ("interfaces.joint.penalty_factor", "500");
    assert_eq!(factor("62_out_of_plane_wall", &[]), 50.0);
    assert_eq!(factor("62_out_of_plane_wall", &[said]), 500.0);
    assert_eq!(factor("03_shear_wall_j7d", &[]), 50.0);
    assert_eq!(factor("03_shear_wall_j7d", &[said]), 500.0);
    // In general contact a stiff joint stops flying bodies; a dry wall has the stiffness of theory/joint.md, eq. 32.
    assert_eq!(factor("90_falling_wall", &[]), 500.0);
    let text = std::fs::read_to_string(path("63_dry_stone_wall")).unwrap();
    let silent = |line: &&str| !line.contains("_stiffness = ");
    let text: Vec<&str> = text.lines().filter(silent).collect();
    let dry = Deck::from_str(&text.join("\n"), "wall.toml").unwrap();
    assert!(dry.interfaces["dry"].normal_stiffness.is_none());
    assert_eq!(dry.interfaces["dry"].penalty(), 500.0);
    let none = [("wall.leaves".to_owned(), "0".to_owned())];
    assert!(Deck::load(path("62_out_of_plane_wall"), &none).is_err());
}

#[test]
fn the_checker_reports_sizes_energies_and_warnings() {
    // Memory was measured without the symmetry reduction.
    let deck = load("03_shear_wall_j7d", &[("fidelity", "full")]);
    let (model, warnings) = Model::from_deck(&deck).unwrap();
    let report = check(&deck, &model);
    assert_eq!(report.warnings, warnings);
    assert_eq!((report.sizes.units, report.sizes.elements), (90, 1540));
    assert_eq!(
        report.sizes.contact_points,
        4 * model.contact.slave_facets.len()
    );
    // Measured peak of a run: 124 MB; 443 MB with the fine mesh. A quarter is allowed for differences between runs
    // and for the simplicity of the estimate.
    let of_fine = |d: Deck| check(&d, &Model::from_deck(&d).unwrap().0).memory_mb;
    let full = ("fidelity", "full");
    let fine = of_fine(load("03_shear_wall_j7d", &[("wall.mesh", "fine"), full]));
    for (estimate, measured) in [(report.memory_mb, 124.0), (fine, 443.0)] {
        let ratio = estimate / measured;
        assert!(
            ratio < 1.25 && ratio > 1.0 / 1.25,
            "{estimate} MB for {measured} MB"
        );
    }
    // Halves, with the check of stability by symmetry: 92 and 323 MB. A large wall: 427 MB.
    for (estimate, measured) in [
        (of_fine(load("03_shear_wall_j7d", &[])), 92.0),
        (
            of_fine(load("03_shear_wall_j7d", &[("wall.mesh", "fine")])),
            323.0,
        ),
        (of_fine(load("70_large_wall", &[full])), 427.0),
    ] {
        let ratio: f64 = estimate / measured;
        assert!((ratio - 1.0).abs() < 0.1, "{estimate} MB for {measured} MB");
    }
    // With a million unknowns the factors need double precision: 11,086 MB, a tenth as above.
    let huge = [full, ("wall.length", "43287.5"), ("wall.courses", "100")];
    let deck = load("70_large_wall", &huge);
    let told = check(&deck, &Model::from_deck(&deck).unwrap().0);
    let note = told.notes.iter().find(|note| note.starts_with("memory"));
    let said = note.unwrap().split(' ').find_map(|word| word.parse().ok());
    let ratio: f64 = said.unwrap_or(0.0) / 11_086.0;
    assert!((ratio - 1.0).abs() < 0.1, "{note:?}");
    assert!(report.notes.iter().all(|note| !note.starts_with("memory")));
    let text = report.to_string();
    for part in [
        "G_I = 15.53 N/m",
        "G_II = 36.09 N/m",
        "90 units, 1540 elements",
        "pivots",
        "lap 80.00 mm",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }

    let key_of = |overrides: &[(&str, &str)]| -> Vec<String> {
        let deck = load("02_couplet_shear", overrides);
        let (_, warnings) = Model::from_deck(&deck).unwrap();
        warnings.into_iter().map(|w| w.key).collect()
    };
    assert!(key_of(&[]).is_empty());
    assert_eq!(
        key_of(&[("interfaces.joint.mu", "1.1")]),
        ["interfaces.joint.mu"]
    );
    assert_eq!(
        key_of(&[("interfaces.joint.f_t", "0.9")]),
        ["interfaces.joint.f_t"]
    );
    // theory/joint.md, eq. 23: Table 1 snaps back below k_n = .28 × 4.38/(.2 (1 − e^−4.38)) = 6.21, k_s = 3.59
    let soft = |n: &str, s: &str| {
        key_of(&[
            ("interfaces.joint.normal_stiffness", n),
            ("interfaces.joint.shear_stiffness", s),
        ])
    };
    assert!(soft("6.22", "3.60").is_empty());
    assert_eq!(
        soft("6.20", "3.58"),
        [
            "interfaces.joint.normal_stiffness",
            "interfaces.joint.shear_stiffness"
        ]
    );
    // With explicit stiffnesses a penalty factor has no effect, including the default.
    let explicit = [
        ("interfaces.joint.normal_stiffness", "100"),
        ("interfaces.joint.shear_stiffness", "50"),
    ];
    assert!(key_of(&explicit).is_empty());
    for factor in ["500", "50"] {
        let both = [
            &explicit[..],
            &[("interfaces.joint.penalty_factor", factor)],
        ]
        .concat();
        assert_eq!(key_of(&both), ["interfaces.joint.penalty_factor"]);
    }
    let text = std::fs::read_to_string(path("03_shear_wall_j7d")).unwrap();
    let unscaled = text.replace("reference_length = \"50 mm\"\n", "");
    let (_, warnings) =
        Model::from_deck(&Deck::from_str(&unscaled, "unscaled.toml").unwrap()).unwrap();
    assert!(
        warnings[0].message.contains("scaling is off"),
        "{}",
        warnings[0]
    );
    assert_eq!(warnings[0].key, "materials.brick");
    let line = unscaled
        .lines()
        .position(|l| l == "[materials.brick]")
        .unwrap()
        + 1;
    assert_eq!(warnings[0].line, Some(line));
}

/// No peak control is reported without a prescribed or controlled displacement, or if inertia or path following sets
/// the size of the increments.
#[test]
fn peak_control_needs_a_drive_or_a_controlled_displacement() {
    let keys = |name: &str, set: &[(&str, &str)]| -> Vec<String> {
        let (_, warnings) = Model::from_deck(&load(name, set)).unwrap();
        let keys = warnings.into_iter().map(|w| w.key);
        keys.filter(|key| key.ends_with("peak")).collect()
    };
    let (couplet, bent) = ("02_couplet_shear", "62_out_of_plane_wall");
    let [preload, drive] = [0, 1].map(|i| format!("steps.{i}.increments.peak"));
    let set = [(preload.as_str(), "0.01"), (drive.as_str(), "0.01")];
    assert_eq!(keys(couplet, &set), [preload.as_str()]);
    assert_eq!(keys(bent, &set), [preload.as_str()]);
    let swings = [&set[1..], &[("steps.1.procedure", "dissipation")]].concat();
    assert_eq!(keys(couplet, &swings), [drive.as_str()]);
}

#[test]
fn the_checker_reports_the_solved_part_and_rounds_large_numbers() {
    let told = |set: &[(&str, &str)]| {
        let deck = load("03_shear_wall_j7d", set);
        let (model, _) = Model::from_deck(&deck).unwrap();
        check(&deck, &model).to_string()
    };
    let text = told(&[]);
    assert!(text.contains("11908 unknowns"), "{text}");
    assert!(
        text.contains("one half of it, 6616 unknowns, is solved"),
        "{text}"
    );
    let text = told(&[
        ("fidelity", "full"),
        ("interfaces.joint.penalty_factor", "1e15"),
    ]);
    assert!(
        text.contains("\"auto\" one half of it, 6616 unknowns"),
        "{text}"
    );
    assert!(text.lines().all(|line| line.len() < 300), "{text}");
    assert!(text.contains("k_n / k_s = 6.800e16 / "), "{text}");
}

/// The in-plane mortar table is inadmissible as printed: damage 0.93865 at most (theory/damage-plasticity.md,
/// Decisions, "Inadmissible damage"). In a band of another width the strains beyond the peak differ, and so does the
/// cap.
#[test]
fn capped_damage_names_its_row() {
    let deck = load("03_shear_wall_j7d", &[]);
    let (_, warnings) = Model::from_deck(&deck).unwrap();
    let keys: Vec<&str> = warnings.iter().map(|w| w.key.as_str()).collect();
    assert_eq!(keys, ["materials.mortar.tension.1.2"]);
    let message = &warnings[0].message;
    for part in [
        "row 2: the damage 0.95 is inadmissible",
        "in bands of 37.8 mm",
    ] {
        assert!(message.contains(part), "{part} is not in {message}");
    }
    // A point has no size, so that the table is used as given.
    let (_, warnings) = deck.law("mortar", None).unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].message.contains("capped to 0.9387"),
        "{}",
        warnings[0]
    );
    // With the out-of-plane modulus the same table is admissible.
    let stiff = load("03_shear_wall_j7d", &[("materials.mortar.E", "2300")]);
    let (_, warnings) = Model::from_deck(&stiff).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn through_joints_and_slivers_are_reported() {
    let warned = |length: &str| -> Vec<String> {
        let deck = load("03_shear_wall_j7d", &[("wall.length", length)]);
        let (_, warnings) = Model::from_deck(&deck).unwrap();
        warnings.into_iter().map(|w| w.message).collect()
    };
    assert!(
        warned("990 mm")
            .iter()
            .all(|w| !w.contains("sliver") && !w.contains("bond"))
    );
    // 4 whole units and 22 mm: slivers whose head joints nearly coincide, 34.5 mm apart
    assert!(
        warned("888 mm")
            .iter()
            .any(|w| w.contains("slivers of 22.00 mm"))
    );
    // 4 whole units and 200 mm
    assert!(
        warned("1066 mm")
            .iter()
            .any(|w| w.contains("4.00 mm apart"))
    );
}

#[test]
fn absurd_sizes_are_rejected_before_they_are_built() {
    let text = std::fs::read_to_string(path("03_shear_wall_j7d")).unwrap();
    for (key, value, at) in [
        ("wall.length", "1e300", "wall.length"),
        ("wall.head_joint", "1e300", "wall.head_joint"),
        ("wall.bed_joint", "\"12.5 um\"", "wall.bed_joint"),
        ("wall.unit.1", "1e-300", "wall.unit.1"),
        ("wall.courses", "4000000000", "wall.courses"),
        (
            "wall.mesh",
            "[4000000000, 4000000000, 4000000000]",
            "wall.mesh",
        ),
    ] {
        let error = Deck::from_str_with(&text, "j7d.toml", &[(key.into(), value.into())])
            .and_then(|deck| Model::from_deck(&deck))
            .unwrap_err();
        assert_eq!(error.key(), at, "{error}");
        assert_eq!(error.file(), format!("--set {key}"));
    }
}

/// The thickness of a wall for the solver is its number of node planes. A wall of two leaves, or in English bond,
/// needs more memory per unknown than one leaf; rigid units need less.
#[test]
fn memory_depends_on_the_node_planes_through_the_thickness() {
    let wall = |more: &str| {
        format!(
            "format = 1\nfidelity = \"full\"\n[materials.brick]\nE = 10000\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n[interfaces.joint]\nf_t = 0\nc = 0\nmu = 0.7\n\
             tan_phi = 0.7\nnormal_stiffness = 100\nshear_stiffness = 40\n[wall]\nunit = [200, 100, 50]\n\
             bed_joint = 0\nhead_joint = 0\nlength = 4000\ncourses = 40\nunit_material = \"brick\"\n\
             interface = \"joint\"\nclamped = false\n{more}\n[[supports]]\non = \"wall.bottom\"\n\
             [[steps]]\nkind = \"gravity\"\n"
        )
    };
    // Memory of the solver per unknown [kB], including the program and the bodies.
    let each = |more: &str| {
        let deck = Deck::from_str(&wall(more), "wall.toml").unwrap_or_else(|e| panic!("{e}"));
        let report = check(
            &deck,
            &Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}")).0,
        );
        1e3 * report.memory_mb / report.sizes.dofs as f64
    };
    let one = each("mesh = [4, 2, 2]");
    for more in [
        "leaves = 2\nmesh = [4, 2, 2]",
        "bond = \"english\"\nmesh = [4, 2, 2]",
    ] {
        // 6 planes instead of 3: nearly twice the part that depends on the thickness.
        let two = each(more);
        assert!(two > 1.3 * one && two < 2.2 * one, "{more}: {two}, {one}");
    }
    // Half of the unknowns, in two planes instead of three, but as much again for the check of stability by symmetry:
    // two thirds of the part that depends on the thickness, and half of the rest.
    let auto = Deck::from_str(
        &wall("mesh = [4, 2, 2]").replace("full", "auto"),
        "wall.toml",
    )
    .unwrap();
    let half = check(&auto, &Model::from_deck(&auto).unwrap().0);
    let each_of_half = 1e3 * half.memory_mb / half.sizes.dofs as f64;
    assert!(
        each_of_half > 0.5 * one && each_of_half < 2.0 / 3.0 * one,
        "{each_of_half}, {one}"
    );
    // Two planes, independently of `mesh`.
    let rigid = [each("rigid = true"), each("rigid = true\nmesh = [4, 2, 9]")];
    assert_eq!(rigid[0], rigid[1]);
}

/// A couplet of elastic blocks 200 by 100 mm under 0.5 MPa, sheared by 1 mm.
fn sheared_couplet(young: f64, depth: f64, along: u32) -> String {
    let block = |name: &str, z: f64| {
        format!(
            "[[blocks]]\nname = \"{name}\"\nsize = [200, 100, {depth}]\nat = [0, 0, {z}]\nmaterial = \"stone\"\nmesh = \
             [{along}, {}, 1]\n",
            along / 2
        )
    };
    format!(
        "format = 1\n[materials.stone]\nE = {young}\nnu = 0.2\ndensity = 0\n[interfaces.joint]\nf_t = 0.5\nc = \
         1\ntan_phi = 0.8\nmu = 0.6\nzeta = 4.38\nxi = 3\nG_I = 0.015\nG_II = 0.05\n{}{}[[contacts]]\nslave = \
         \"upper.bottom\"\nmaster = \"lower.top\"\ninterface = \"joint\"\n[[supports]]\non = \"lower.bottom\"\n[[steps]]\n\
         kind = \"preload\"\nface = \"upper.top\"\npressure = 0.5\n[[steps]]\nkind = \"drive\"\nface = \"upper.top\"\n\
         direction = \"x\"\ndisplacement = 1\nfree = [\"z\"]\n",
        block("lower", 0.0),
        block("upper", depth)
    )
}

/// Flat elements whose stiffness against shear that varies along them, 4 E h/L², is below 0.4 of the slope of the joint
/// (17.7 N/mm³) get a warning, others have the right friction.
#[test]
fn flat_elements_at_a_joint_that_softens_are_told() {
    let told = |text: &str| {
        let deck = Deck::from_str(text, "couplet.toml").unwrap();
        let (model, warnings) = Model::from_deck(&deck).unwrap();
        let flat = warnings
            .into_iter()
            .find(|w| w.message.contains("are flat"));
        (model, flat)
    };
    for (young, depth, along) in [(1000.0, 5.0, 2), (1000.0, 10.0, 2), (1000.0, 20.0, 2)] {
        let text = sheared_couplet(young, depth, along);
        let (_, flat) = told(&text);
        let flat = flat.unwrap_or_else(|| panic!("{young} {depth} {along}"));
        assert_eq!(flat.key, "blocks.1.mesh");
        assert!(flat.line.is_some(), "{flat}");
        let sizes =
            format!("`upper` at its joint are flat, 100.0 mm along it and {depth:.1} mm deep");
        assert!(flat.message.contains(&sizes), "{flat}");
        for formulation in ["full", "b-bar"] {
            let other = format!("{text}[element]\nformulation = \"{formulation}\"\n");
            assert!(told(&other).1.is_none(), "{formulation}");
        }
    }
    for (young, depth, along) in [(4000.0, 10.0, 2), (1000.0, 10.0, 4), (8000.0, 5.0, 2)] {
        let (model, flat) = told(&sheared_couplet(young, depth, along));
        assert!(flat.is_none(), "{flat:?}");
        let rows = completed(&model).rows;
        // The bond is gone after a slip of 0.178 mm.
        let slid = rows.iter().filter(|row| row.displacement_mm > 0.25);
        for row in slid {
            // 0.6 times 10 kN; forces of equilibrium have 2e-3.
            assert!((row.force_kN / 6.0 - 1.0).abs() < 1e-2, "{}", row.force_kN);
        }
    }
}

/// Mortar in bed joints is flat, but stiffer than its joints soften.
#[test]
fn mortar_of_the_examples_is_not_too_flat() {
    for name in ["01_couplet_tension", "03_shear_wall_j7d", "71_flemish_wall"] {
        let (_, warnings) = Model::from_deck(&load(name, &[])).unwrap();
        let flat = warnings.iter().find(|w| w.message.contains("are flat"));
        assert!(flat.is_none(), "{name}: {flat:?}");
    }
}

/// A scene that may move as a whole along an axis has a warning for it, and one that anything holds there has none.
#[test]
fn the_checker_tells_of_scenes_that_nothing_holds_along_an_axis() {
    let loose = |supports: &str, more: &str| {
        let text = format!(
            "format = 1\nmaterials.stone = {{ E = \"5 GPa\", nu = 0.2, density = \"2000 kg/m^3\" }}\n\
             [[blocks]]\nname = \"block\"\nsize = [400, 300, 200]\nmaterial = \"stone\"\n{supports}\n\
             [[steps]]\nkind = \"gravity\"\n{more}"
        );
        let deck = Deck::from_str(&text, "block.toml").unwrap();
        let (_, warnings) = Model::from_deck(&deck).unwrap();
        let told = warnings.iter().filter_map(|warning| {
            let rest = warning
                .message
                .strip_prefix("nothing holds the scene along ")?;
            rest.chars().next()
        });
        told.collect::<String>()
    };
    let bed = "[[supports]]\non = \"block.bottom\"\nfixed = [\"z\"]";
    let spring = "[[springs]]\nname = \"s\"\non = \"block.left\"\nstiffness = [100, 0, 0]";
    let drive = "[[steps]]\nkind = \"drive\"\nface = \"block.top\"\ndirection = \"y\"\ndisplacement = 1\n\
                 free = [\"x\"]\n";
    let flies = "procedure = \"dynamic\"\n";
    assert_eq!(loose("[[supports]]\non = \"block.bottom\"", ""), "");
    assert_eq!(loose(bed, ""), "xy");
    assert_eq!(loose(&format!("{bed}\n{spring}"), ""), "y");
    assert_eq!(loose(bed, drive), "x");
    assert_eq!(loose(bed, flies), "");
}
