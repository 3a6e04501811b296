//! Imported meshes in scenes, and scenes that are exported to Abaqus and imported again.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::examples;
use crate::common::scene::completed;
use wythe::deck::Deck;
use wythe::deck::import::{ImportedMesh, SIDES, Units};
use wythe::error::DeckError;
use wythe::model::Model;
use wythe::results::export::inp::inp;

fn data(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data/import").join(name)
}

const HEAD: &str = r#"
format = 1

[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2000 kg/m^3"

[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6

[[steps]]
kind = "gravity"
"#;

/// Reads a scene with these files beside it.
fn build(scene: &str, files: &[(&str, &str)]) -> Result<Model, DeckError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    for name in ["cae.inp", "flat.inp", "flat_mesh.inp", "two_blocks_41b.msh"] {
        fs::copy(data(name), folder.path().join(name)).unwrap();
    }
    let path = folder.path().join("deck.toml");
    fs::write(&path, format!("{HEAD}{scene}")).unwrap();
    let deck = Deck::load(&path, &[])?;
    Ok(Model::from_deck(&deck)?.0)
}

/// The single error of a scene.
fn refused(scene: &str, files: &[(&str, &str)]) -> (String, String, String) {
    match build(scene, files) {
        Err(DeckError::Model(error)) => {
            let all: Vec<String> = error.all().map(ToString::to_string).collect();
            // A wrong name also makes the reference to it wrong.
            assert!(
                all.len() == 1 || error.key() == "imports.0.name",
                "{all:#?}"
            );
            let key = error.key().to_owned();
            (key, error.message().to_owned(), error.advice().to_owned())
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("nothing is wrong with {scene}"),
    }
}

const GMSH: &str = r#"
[[imports]]
name = "pair"
file = "two_blocks_41b.msh"
materials = { lower = "stone", upper = "stone" }

[[supports]]
on = "pair.base"

[[contacts]]
slave = "pair.bed of upper"
master = "pair.bed of lower"
interface = "dry"
"#;

/// Facets by their nodes, in any order.
fn facets(of: &[[u32; 4]]) -> BTreeSet<[u32; 4]> {
    let sorted = of.iter().map(|facet| {
        let mut nodes = *facet;
        nodes.sort_unstable();
        nodes
    });
    sorted.collect()
}

#[test]
fn a_mesh_of_gmsh_stands_on_its_base() {
    let model = build(GMSH, &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(model.mesh.elements.len(), 16);
    assert_eq!(model.contact.whole_slaves().count(), 4);
    assert_eq!(model.contact.master_facets.len(), 4);
    assert!(model.contact.slave_body.iter().all(|body| *body == 1));
    assert_eq!(model.supports[0].nodes.len(), 9);
    completed(&model);
}

#[test]
fn touching_imports_without_names_get_one_contact() {
    let any = GMSH.replace(
        "slave = \"pair.bed of upper\"\nmaster = \"pair.bed of lower\"\n",
        "",
    );
    let model = build(&any, &[]).unwrap_or_else(|e| panic!("{e}"));
    let named = build(GMSH, &[]).unwrap();
    // The upper block has the finer mesh.
    assert_eq!(
        facets(&model.contact.slave_facets),
        facets(&named.contact.slave_facets)
    );
    assert_eq!(
        facets(&model.contact.master_facets),
        facets(&named.contact.master_facets)
    );
    // Contact that is given explicitly is not generated a second time from touching faces.
    let both = build(&format!("{GMSH}\n[[contacts]]\ninterface = \"dry\"\n"), &[]);
    let both = both.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(both.contact.slave_facets, named.contact.slave_facets);
    assert_eq!(both.contact.master_facets, named.contact.master_facets);
}

#[test]
fn imports_stand_where_the_deck_says_beside_blocks_and_each_other() {
    let scene = r#"
[[imports]]
name = "a"
file = "flat.inp"
units = "N, m, s"
materials = { BRICKS = "stone", MORTAR = "stone" }
at = [0, 0, "10 mm"]
rotate = { axis = "z", angle = "90 deg" }

[[imports]]
name = "b"
file = "flat.inp"
units = "N, m, s"
materials = { BOTH = "stone" }
at = [-150, 0, 110]

[[blocks]]
name = "table"
size = [500, 500, 10]
at = [-200, -100, 0]
material = "stone"

[[contacts]]
interface = "dry"

[[supports]]
on = "table"

[[probes]]
name = "sinks"
on = ["b.LOWEST", "a.TOP"]
direction = "z"
"#;
    let model = build(scene, &[]).unwrap_or_else(|e| panic!("{e}"));
    let mesh = &model.mesh;
    // The block comes first, then twelve nodes each. (200, 100, 50) mm goes to (−100, 200, 60).
    let at = mesh.nodes[8 + 6];
    let off = [at[0] + 100.0, at[1] - 200.0, at[2] - 60.0];
    assert!(off.iter().all(|d| d.abs() < 1e-12), "{at:?}");
    assert_eq!(mesh.unit, [0, 1, 1, 2, 2]);
    assert_eq!(model.probes[0].nodes.len(), 8);
    // The table supports a, and a supports b: each contact has a slave face of one facet.
    assert_eq!(model.contact.whole_slaves().count(), 2);
}

#[test]
fn materials_of_the_file_stand_in_the_deck_unless_it_has_its_own() {
    let scene = |more: &str| {
        format!(
            "{more}\n[[imports]]\nname = \"a\"\nfile = \"flat.inp\"\nunits = \"N, m, s\"\n\
             [[supports]]\non = \"a.BASE\"\n"
        )
    };
    // CLAY has no density, but gravity needs one.
    let (key, message, _) = refused(&scene(""), &[]);
    assert_eq!(key, "materials.CLAY.density");
    assert!(message.contains("CLAY has no mass"), "{message}");
    let clay = "[materials.clay]\nE = \"9 GPa\"\nnu = 0.1\ndensity = \"1900 kg/m^3\"\n";
    let model = build(&scene(clay), &[]).unwrap_or_else(|e| panic!("{e}"));
    let names: Vec<&str> = model.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["clay", "LIME"]);
    let lime = &model.materials[1].parameters;
    assert!((lime.elastic().E - 1000.0).abs() < 1e-9, "1e9 Pa");
    let told: Vec<String> = model.warnings.iter().map(ToString::to_string).collect();
    assert!(
        told.iter()
            .any(|w| w.contains("flat.inp: C3D8, C3D8I are read as hex8")),
        "{told:#?}"
    );
}

#[test]
fn errors_name_element_line_and_place_or_the_likely_name() {
    let cube = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                *ELEMENT, TYPE=C3D8, ELSET=ALL\n7, 1,2,3,4,5,6,7,8\n";
    let turned = cube.replace("7, 1,2,3,4,5,6,7,8", "7, 5,6,7,8,1,2,3,4");
    let scene = "[[imports]]\nname = \"a\"\nfile = \"a.inp\"\nmaterials = { ALL = \"stone\" }\n\
                 [[supports]]\non = \"a\"\n";
    for (scene, file, key, told, help) in [
        (
            scene.to_owned(),
            turned.as_str(),
            "imports.0.file",
            "a.inp line 11: element 7 near (0.5, 0.5, 0.5) mm has its nodes in the wrong order",
            "counter-clockwise",
        ),
        (
            scene.replace("a.inp", "b.inp"),
            cube,
            "imports.0.file",
            "b.inp: ",
            "name a mesh",
        ),
        (
            scene.replace("ALL =", "AL ="),
            cube,
            "imports.0.materials.AL",
            "no set of elements named `AL`",
            "did you mean `ALL`?",
        ),
        (
            scene.replace("materials = { ALL = \"stone\" }", ""),
            cube,
            "imports.0.file",
            "line 11: element 7 near (0.5, 0.5, 0.5) mm has no material",
            "materials = {",
        ),
        (
            scene.replace("on = \"a\"", "on = \"a.AL\""),
            cube,
            "supports.0.on",
            "the file of a has no set named `AL`",
            "did you mean `a.ALL`?",
        ),
        (
            scene.replace("\"stone\"", "\"stoen\""),
            cube,
            "imports.0.materials.ALL",
            "no material named `stoen`",
            "did you mean `stone`?",
        ),
        (
            scene.replace("name = \"a\"", "name = \"a.b\""),
            cube,
            "imports.0.name",
            "is no name for an import",
            "a dot parts",
        ),
        (
            scene.replace("file", "units = \"N, kg\"\nfile"),
            cube,
            "imports.0.units",
            "`kg` is no unit of length",
            "of force, length and time",
        ),
        (
            format!(
                "{scene}[[contacts]]\nslave = \"a\"\nmaster = \"a.ALL\"\ninterface = \"dry\"\n"
            ),
            cube,
            "contacts.0.slave",
            "`a` is no face",
            "which of its sets: ALL",
        ),
        (
            format!(
                "{scene}[[contacts]]\nslave = \"a.ALL\"\nmaster = \"a.ALL\"\ninterface = \"dry\"\n"
            ),
            cube,
            "contacts.0",
            "would meet itself",
            "different",
        ),
    ] {
        let (at, message, advice) = refused(&scene, &[("a.inp", file)]);
        assert_eq!(at, key, "{message}");
        assert!(message.contains(told), "{message}");
        assert!(advice.contains(help), "{message}: {advice}");
    }
}

#[test]
fn an_imported_couplet_is_sheared_as_its_joint_allows() {
    let deck = examples::load("50_imported_mesh", &[]);
    let (model, _) = Model::from_deck(&deck).unwrap();
    let named = |name: &str| model.materials.iter().any(|m| m.name == name);
    assert!(named("CLAY") && named("stone"));
    let rows = completed(&model).rows;
    let peak = rows.iter().map(|r| r.force_kN).fold(0.0, f64::max);
    // Half a brick of 100 mm x 100 mm under the pressure on a whole one: c + 1.01 x 1.0 MPa for uniform stress in the
    // joint. An eccentric load and softening reduce it: 10 %.
    let even = (0.87 + 1.01 * 1.0) * 100.0 * 100.0 * 1e-3;
    assert!(peak < even && peak > 0.9 * even, "{peak} kN of {even}");
}

/// A wall of four courses with two materials, suitable for Abaqus.
fn wall() -> (Deck, Model) {
    let deck = examples::load("03_shear_wall_j7d", &[("wall.courses", "4")]);
    let (model, _) = Model::from_deck(&deck).unwrap();
    (deck, model)
}

#[test]
fn a_wall_comes_back_from_abaqus_as_it_went() {
    let set = [
        ("wall.courses", "4"),
        ("materials.brick.crack_band", "volume"),
    ];
    let deck = examples::load("03_shear_wall_j7d", &set);
    let (model, _) = Model::from_deck(&deck).unwrap();
    let text = inp(&model);
    let mesh = ImportedMesh::read("wall.inp", text.as_bytes(), &Units::default(), &mut |_| {
        Err(std::io::ErrorKind::NotFound.into())
    })
    .unwrap_or_else(|e| panic!("{e}"));
    mesh.check().unwrap();
    // All digits are written.
    assert_eq!(mesh.nodes, model.mesh.nodes);
    assert_eq!(mesh.elements, model.mesh.elements);
    assert_eq!(mesh.bodies().of_element, model.mesh.unit);
    for (m, material) in model.materials.iter().enumerate() {
        let name = material.name.to_uppercase();
        let set = &mesh.element_sets[&format!("MATERIAL_{name}")];
        let of = |e: &u32| usize::from(model.mesh.material[*e as usize]) == m;
        assert!(set.iter().all(of) && !set.is_empty(), "{name}");
        let section = mesh.sections.iter().find(|s| s.material == name).unwrap();
        assert_eq!(&section.elements, set);
        let back = mesh.materials.iter().find(|m| m.name == name).unwrap();
        let (back, _) = back.in_a_deck(None).unwrap();
        let there = &deck.materials[&material.name];
        // Abaqus has no keyword for it, nor for the crack band: both are stored in comments.
        assert!(there.reference_length.is_some());
        assert_eq!(&back, there, "{name}");
    }
    let bottom = &model.supports[0];
    assert_eq!(mesh.node_sets["SUPPORT_BOTTOM"], bottom.nodes);
    assert_eq!(mesh.node_sets["BEAM_TOP"].len(), model.beams[0].nodes.len());
    let sides = |name: &str| -> BTreeSet<[u32; 4]> {
        let of: Vec<[u32; 4]> = mesh.surfaces[name].iter().map(|s| mesh.facet(*s)).collect();
        facets(&of)
    };
    assert_eq!(sides("MASTER"), facets(&model.contact.master_facets));
    let slaves = mesh.surfaces.keys().filter(|n| n.starts_with("SLAVE_"));
    let slaves: BTreeSet<[u32; 4]> = slaves.flat_map(|name| sides(name)).collect();
    assert_eq!(slaves, facets(&model.contact.slave_facets));
    assert_eq!(SIDES.len(), 6);
}

#[test]
fn a_wall_that_came_back_is_the_same_scene() {
    let (deck, model) = wall();
    let names: Vec<String> = {
        let mut names = BTreeSet::new();
        for line in inp(&model).lines() {
            if let Some(name) = line.strip_prefix("*SURFACE, TYPE=ELEMENT, NAME=SLAVE_") {
                names.insert(format!("\"wall.SLAVE_{name}\""));
            }
        }
        names.into_iter().collect()
    };
    let materials = toml::to_string(&toml::Table::from_iter([(
        "materials".to_owned(),
        toml::Value::try_from(&deck.materials).unwrap(),
    )]))
    .unwrap();
    let interfaces = toml::to_string(&toml::Table::from_iter([(
        "interfaces".to_owned(),
        toml::Value::try_from(&deck.interfaces).unwrap(),
    )]))
    .unwrap();
    let text = format!(
        "format = 1\n{materials}\n{interfaces}\n\
         [[imports]]\nname = \"wall\"\nfile = \"wall.inp\"\n\
         [[contacts]]\nslave = [{}]\nmaster = \"wall.MASTER\"\ninterface = \"joint\"\n\
         [[supports]]\non = \"wall.SUPPORT_BOTTOM\"\n\
         [[steps]]\nkind = \"drive\"\nface = \"wall.BEAM_TOP\"\ndirection = \"x\"\ndisplacement = 1\n",
        names.join(", ")
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("wall.inp"), inp(&model)).unwrap();
    fs::write(folder.path().join("wall.toml"), text).unwrap();
    let deck = Deck::load(folder.path().join("wall.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    let (back, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(back.mesh.nodes, model.mesh.nodes);
    assert_eq!(back.mesh.elements, model.mesh.elements);
    assert_eq!(back.mesh.unit, model.mesh.unit);
    let name = |model: &Model, e: usize| {
        let material = &model.materials[usize::from(model.mesh.material[e])];
        (material.name.clone(), material.parameters.clone())
    };
    for e in 0..model.mesh.elements.len() {
        assert_eq!(name(&back, e), name(&model, e));
    }
    assert_eq!(back.supports[0].nodes, model.supports[0].nodes);
    assert_eq!(back.beams[0].nodes, model.beams[0].nodes);
    let (there, here) = (&model.contact, &back.contact);
    assert_eq!(facets(&here.slave_facets), facets(&there.slave_facets));
    assert_eq!(facets(&here.master_facets), facets(&there.master_facets));
    assert_eq!(here.slave_facets.len(), there.slave_facets.len());
}
