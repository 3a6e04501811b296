//! Meshes of Abaqus and Gmsh: supported content is read, and invalid content is rejected with its line.

use std::path::{Path, PathBuf};

use wythe::deck::import::{ImportError, ImportedMesh, Lengths, Units};
use wythe::deck::quantity::{Density, Length, Number, Pressure};
use wythe::deck::schema::{Material, Row};

fn data(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data/import").join(name)
}

fn load(name: &str, units: &str) -> ImportedMesh {
    let units = Units::parse(units).unwrap();
    let mesh =
        ImportedMesh::load(&data(name), &units).unwrap_or_else(|e| panic!("{e}\n{}", e.help));
    mesh.check().unwrap_or_else(|e| panic!("{e}"));
    mesh
}

/// Reads a text as an `.inp` file without includes.
fn inp(text: &str) -> Result<ImportedMesh, ImportError> {
    let nothing = &mut |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let mesh = ImportedMesh::read("a.inp", text.as_bytes(), &Units::default(), nothing)?;
    mesh.check()?;
    Ok(mesh)
}

fn rows(table: &[Row]) -> Vec<[f64; 3]> {
    let row = |r: &Row| [r.0.get(), r.1.get(), r.2.get()];
    table.iter().map(row).collect()
}

fn material(mesh: &ImportedMesh, name: &str, length: f64) -> (Material, Vec<String>) {
    let found = mesh.materials.iter().find(|m| m.name == name).unwrap();
    let lengths = Lengths {
        least: length,
        median: length,
        most: length,
    };
    found.in_a_deck(Some(lengths)).unwrap()
}

#[test]
fn an_assembly_of_abaqus_cae_stands_where_its_instances_do() {
    let mesh = load("cae.inp", "");
    assert_eq!(mesh.elements.len(), 6);
    assert_eq!(mesh.nodes.len(), 36, "the reference point is left out");
    assert_eq!(mesh.instances, ["Brick-1", "Brick-2", "Brick-3"]);
    assert_eq!(mesh.bodies().names, mesh.instances);
    assert_eq!(mesh.bodies().of_element, [0, 0, 1, 1, 2, 2]);
    let node = |instance: usize, label: usize| mesh.nodes[12 * instance + label - 1];
    assert_eq!(node(1, 12), [250.0, 100.0, 100.0]);
    // Moved to (500, 0, 0) and then rotated by 90° about a vertical axis there: x goes to y, up to the rounding of
    // cos 90°.
    let [x, y, z] = node(2, 12);
    assert!(
        [x - 400.0, y - 200.0, z - 50.0]
            .iter()
            .all(|d| d.abs() < 1e-12)
    );
}

#[test]
fn sets_and_surfaces_of_instances_and_of_the_assembly_are_found() {
    let mesh = load("cae.inp", "");
    assert_eq!(mesh.node_sets["Ends"].len(), 8);
    assert_eq!(mesh.node_sets["_PickedSet9"], mesh.node_sets["Ends"]);
    assert!(mesh.node_sets["RP"].is_empty());
    assert_eq!(mesh.element_sets["Brick-2.Set-All"], [2, 3]);
    // A set is found by its name, in any case, or by its instance; not if several instances have it.
    assert_eq!(mesh.nodes_of("ends").unwrap().len(), 8);
    assert_eq!(mesh.nodes_of("Brick-3").unwrap().len(), 12);
    assert_eq!(mesh.nodes_of("Set-All"), None);
    assert_eq!(mesh.surfaces["Bed-Top"], [(2, 0), (3, 0)]);
    assert_eq!(mesh.surfaces["Bed-Base"], [(0, 1), (1, 1)]);
    // The ends in x of two bricks.
    assert_eq!(mesh.surfaces["Ends-Nodes"], [(0, 5), (3, 3)]);
    let facet = mesh.facet((0, 1));
    assert!(facet.iter().all(|n| mesh.nodes[*n as usize][2] == 50.0));
    let outside = mesh.exterior().unwrap();
    assert_eq!(outside.len(), 30);
    assert_eq!(
        mesh.facets_of("Brick-1.Set-All", &outside).unwrap().len(),
        10
    );
}

#[test]
fn tables_of_the_paper_are_imported_unchanged() {
    let mesh = load("cae.inp", "");
    assert_eq!(mesh.sections.len(), 3);
    assert_eq!(mesh.sections[1].elements, [2, 3]);
    let (brick, notes) = material(&mesh, "Fired Clay", 50.0);
    assert!(notes.is_empty(), "{notes:?}");
    assert_eq!(brick.density, Density::new(1.9e-9));
    assert_eq!(rows(&brick.tension), [[3.5, 0.0, 0.0], [0.3, 0.002, 0.95]]);
    assert_eq!(
        rows(&brick.compression),
        [[11.0, 0.0, 0.0], [11.5, 0.001, 0.0], [0.6, 0.007, 0.95]]
    );
    assert_eq!(brick.reference_length, None);
}

#[test]
fn unread_content_is_reported() {
    let mesh = load("cae.inp", "");
    let notes = mesh.notes.join("\n");
    for told in [
        "C3D8R are read as hex8",
        "*SURFACE INTERACTION (line 99)",
        "*STEP (line 107)",
        "*FRICTION (line 101)",
        "1 nodes belong to no element",
    ] {
        assert!(notes.contains(told), "{told}\n{notes}");
    }
    assert!(
        !notes.contains("BOUNDARY"),
        "what is in a step goes with it"
    );
}

#[test]
fn a_flat_file_in_metres_with_an_include_is_read_in_millimetres() {
    let mesh = load("flat.inp", "N, m, s");
    assert_eq!(mesh.files, ["flat.inp", "flat_mesh.inp"]);
    assert_eq!(mesh.nodes[6], [200.0, 100.0, 50.0]);
    assert_eq!(mesh.element_labels, [1, 2]);
    assert_eq!(mesh.element_places[1].line, 19);
    assert_eq!(mesh.element_sets["BOTH"], [0, 1]);
    assert_eq!(mesh.node_sets["GROUND"].len(), 8);
    assert_eq!(mesh.node_sets["LOW"], mesh.node_sets["LOWEST"]);
    assert_eq!(mesh.surfaces["BASE"], [(0, 0)]);
    assert_eq!(mesh.surfaces["SKIN"].len(), 10);
    assert_eq!(mesh.bodies().names, ["0"]);
}

#[test]
fn displacements_in_metres_become_strains_of_an_element() {
    let mesh = load("flat.inp", "N, m, s");
    let (lime, notes) = material(&mesh, "LIME", 100.0);
    assert!(notes.is_empty(), "{notes:?}");
    // Units are powers of ten: one or two rounding errors.
    let near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * b.abs();
    assert!(near(lime.E.get(), 1000.0) && near(lime.density.get(), 1.8e-9));
    assert_eq!(lime.compression_recovery, Number::new(0.5));
    assert_eq!(lime.reference_length, Some(Length::new(100.0)));
    let tension = rows(&lime.tension);
    // 0.1 mm and 0.2 mm over 100 mm; stress midway between 0.4 and 0.1 MPa.
    for (row, wanted) in
        tension
            .iter()
            .zip([[0.4, 0.0, 0.0], [0.25, 0.001, 0.8], [0.1, 0.002, 0.8]])
    {
        assert!((0..3).all(|i| near(row[i], wanted[i])), "{tension:?}");
    }
    let (clay, _) = material(&mesh, "CLAY", 100.0);
    assert!(near(clay.E.get(), 10_000.0) && clay.tension.is_empty());
    assert_eq!(clay.nu, Number::new(0.2));
    assert_eq!(Pressure::new(0.0), Pressure::default());
}

const NODES: &str =
    "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";
const CUBE: &str = "*ELEMENT, TYPE=C3D8, ELSET=ALL\n7, 1,2,3,4,5,6,7,8\n";

#[test]
fn bad_elements_are_named_with_their_line_and_place() {
    for (text, line, told) in [
        (
            "*ELEMENT, TYPE=C3D8\n7, 5,6,7,8,1,2,3,4\n",
            11,
            "element 7 near (0.5, 0.5, 0.5) mm has its nodes in the wrong order: it is turned inside out",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n7, 1,2,3,4,5,6,8,7\n",
            11,
            "element 7 near (0.5, 0.5, 0.5) mm has no positive volume at its node 8",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n7, 1,2,3,4,1,2,7,8\n",
            11,
            "element 7 near (0.5, 0.5, 0.25) mm has a node more than once",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n7, 1,2,3,4,5,6,7,9\n",
            11,
            "element 7 names the node 9, which is not there",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n7, 1,2,3,4,5,6,7\n",
            11,
            "element 7 has 7 nodes, not 8",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n7, 1,2,3,4,5,6,7,8\n7, 1,2,3,4,5,6,7,8\n",
            12,
            "element 7 is there twice",
        ),
        ("*NODE\n1, 0, 0, 0\n", 11, "node 1 is there twice"),
        ("*NGEN\n1, 8\n", 10, "*NGEN is not read"),
        ("*NODE\n9, x, 0, 0\n", 11, "`9, x, 0, 0` is no node"),
        (
            "*INCLUDE, INPUT=more.inp\n",
            10,
            "more.inp: entity not found",
        ),
    ] {
        let error = inp(&format!("{NODES}{text}")).expect_err(text);
        assert_eq!(
            (error.line, error.message.contains(told)),
            (Some(line), true),
            "{error}"
        );
        assert_eq!(error.file, "a.inp");
        assert!(!error.help.is_empty(), "{error}");
    }
    let error = inp(NODES).unwrap_err();
    assert!(error.message.ends_with("no hexahedra in it"), "{error}");
    let error = inp(&format!("{NODES}*ELEMENT, TYPE=C3D4\n3, 1,2,3,5\n")).unwrap_err();
    assert!(error.message.contains("1 of the type C3D4"), "{error}");
}

/// Number of notes with this text for a mesh that is read successfully.
fn noted(text: &str, told: &str) -> (ImportedMesh, usize) {
    let mesh = inp(text).unwrap_or_else(|e| panic!("{text}: {e}"));
    let count = mesh.notes.iter().filter(|n| n.contains(told)).count();
    (mesh, count)
}

#[test]
fn unneeded_content_is_omitted_and_reported_once() {
    let shells = "*NODE\n11,5,0,0\n12,6,0,0\n13,6,1,0\n14,5,1,0\n";
    let spring = "*ELEMENT, TYPE=SPRINGA, ELSET=SPRINGS\n30, 1, 2\n*SPRING, ELSET=SPRINGS\n\n10.\n";
    for (text, told) in [
        // Elements of other types, with their sections, sets and surfaces.
        (
            format!(
                "{shells}*ELEMENT, TYPE=S4, ELSET=FLOOR\n20, 11,12,13,14\n21, 14,13,12,11\n\
                 *SHELL SECTION, ELSET=FLOOR, MATERIAL=M\n0.1\n*SURFACE, NAME=TOP\nFLOOR, SPOS\n"
            ),
            "2 elements of the type S4 are left out (the first is 20, line 18)",
        ),
        (
            format!("{shells}*ELEMENT, TYPE=S4\n20, 11,12,13,14\n*SURFACE, NAME=TOP\n20, SNEG\n"),
            "surface TOP is left out: none of its elements is a hexahedron",
        ),
        (
            spring.to_owned(),
            "1 elements of the type SPRINGA are left out, 1 of them with nodes of hexahedra",
        ),
        (
            format!("{spring}*ELSET, ELSET=BOTH\n7, 30\n"),
            "1 elements of the type SPRINGA",
        ),
        (
            "*ELEMENT, TYPE=COH3D8\n3, 1,2,3,4,5,6,7,8\n".to_owned(),
            "meet by [[contacts]]",
        ),
        // Twenty nodes take two lines, however the lines end.
        (
            "*ELEMENT, TYPE=C3D20R\n3, 1,2,3,4,5,6,7,8,1,2,3,4,5,6,7,\n8,1,2,3,4\n4, 1,2,3,4,5,6,7,8,1,2,3,4,5,6,7\n8,1,2,3,4\n"
                .to_owned(),
            "2 elements of the type C3D20R are left out, 2 of them",
        ),
        // More labels than corners.
        (
            "*ELEMENT, TYPE=C3D8I\n9, 1,2,3,4,5,6,7,8,9,10,11\n".to_owned(),
            "1 hexahedra have more labels on their line",
        ),
        // Surfaces of nodes or of missing items.
        (
            "*SURFACE, NAME=S, TYPE=NODE\n1\n".to_owned(),
            "surface S of nodes is read as a set of nodes",
        ),
        (
            "*SURFACE, NAME=S\n7, S1\n70, S1\n71, S1\n".to_owned(),
            "surface S: 2 of its elements are not there (the first is 70)",
        ),
        (
            "*TRANSFORM, NSET=N\n1, 0, 0, 0, 1, 0\n".to_owned(),
            "not read: *TRANSFORM",
        ),
        // Materials with another law.
        (
            "*MATERIAL, NAME=M\n*ELASTIC, TYPE=ORTHO\n1,2,3,4,5,6,7,8\n9\n".to_owned(),
            "material M is left out: *ELASTIC (line 13): its elasticity is not isotropic",
        ),
        (
            "*MATERIAL, NAME=M\n*ELASTIC\nE, 0.2\n".to_owned(),
            "material M is left out: `E, 0.2` (line 14) is no row of numbers",
        ),
    ] {
        // The element with too many labels replaces the cube.
        let cube = if text.contains("C3D8I") { "" } else { CUBE };
        let (mesh, count) = noted(&format!("{NODES}{cube}{text}"), told);
        assert_eq!(count, 1, "{told}: {:?}", mesh.notes);
        assert_eq!((mesh.elements.len(), mesh.nodes.len()), (1, 8), "{text}");
        let labels = mesh.notes.iter().any(|n| n.contains("of its labels"));
        assert!(!labels, "left out, and told already: {:?}", mesh.notes);
        assert!(mesh.element_sets.values().all(|set| !set.is_empty()));
    }
    let (mesh, _) = noted(
        &format!("{NODES}{CUBE}*SURFACE, NAME=S, TYPE=NODE\n1\n3\n"),
        "",
    );
    assert_eq!(mesh.node_sets["S"], [0, 2]);
    assert!(mesh.surfaces.is_empty());
}

#[test]
fn parts_without_an_instance_are_omitted() {
    let text = format!(
        "*PART, NAME=WALL\n{NODES}{CUBE}*END PART\n*PART, NAME=PLATE\n*NODE\n1,0,0,0\n\
         *ELEMENT, TYPE=S4\n1, 1,2,3,4\n*ELEMENT, TYPE=C3D8\n2, 1,2,3,4,5,6,7,8\n*END PART\n\
         *ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=WALL\n*END INSTANCE\n*END ASSEMBLY\n"
    );
    let (mesh, count) = noted(&text, "these parts are left out: PLATE");
    assert_eq!((count, mesh.elements.len()), (1, 1));
    assert!(mesh.left_out.is_empty(), "{:?}", mesh.left_out);
}

/// MacNeal and Harder's patch of seven elements (1985) has an element with an inverted corner. Its Jacobian is
/// positive at all Gauss points.
#[test]
fn an_element_is_valid_if_its_gauss_points_are() {
    let patch = "*NODE\n1,0.249,0.342,0.192\n2,0.826,0.288,0.288\n5,0.32,0.186,0.643\n6,0.677,0.305,0.683\n\
                 9,0,0,0\n12,1,0,0\n13,0,0,1\n14,1,0,1\n*ELEMENT, TYPE=C3D8I\n4,1,2,6,5,9,12,14,13\n";
    let (mesh, count) = noted(patch, "1 elements have a corner that is flat or folded");
    assert_eq!((mesh.elements.len(), count), (1, 1), "{:?}", mesh.notes);
}

#[test]
fn a_side_of_three_elements_is_rejected() {
    // The second and the third body lie on the first, with separate nodes at the same places above.
    let above =
        "*NODE\n11,0,0,2\n12,1,0,2\n13,1,1,2\n14,0,1,2\n21,0,0,3\n22,1,0,3\n23,1,1,3\n24,0,1,3\n";
    let more = "*ELEMENT, TYPE=C3D8\n8, 5,6,7,8,11,12,13,14\n9, 5,6,7,8,21,22,23,24\n";
    let error = inp(&format!("{NODES}{above}{CUBE}{more}")).unwrap_err();
    assert!(
        error
            .message
            .contains("element 9 near (0.5, 0.5, 2) mm has a side in common"),
        "{error}"
    );
}

#[test]
fn unknown_names_are_reported_with_a_suggestion() {
    for (text, told, help) in [
        (
            "*ELSET, ELSET=B\nALLL\n",
            "there is no ELSET named ALLL",
            "did you mean ALL?",
        ),
        (
            "*NSET, NSET=B\nC\n",
            "there is no NSET named C",
            "did you mean B?",
        ),
        ("*SURFACE, NAME=S\nALL, S7\n", "`S7` is no side", "S1 to S6"),
        (
            "*SOLID SECTION, ELSET=AL, MATERIAL=M\n",
            "no ELSET named AL",
            "did you mean ALL?",
        ),
        (
            "*ELSET, ELSET=A\nB\n*ELSET, ELSET=B\nA\n",
            "made of sets",
            "in a circle",
        ),
        (
            "*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n",
            "no part named P",
            "the file has",
        ),
        (
            "*NSET, NSET=N, INSTANCE=I\n1\n",
            "no instance named I",
            "at all",
        ),
        ("*MATERIAL\n", "*MATERIAL without NAME=", "name it"),
        (
            "*MATERIAL, NAME=M\n*MATERIAL, NAME=m\n",
            "two materials named m",
            "own",
        ),
    ] {
        let error = inp(&format!("{NODES}{CUBE}{text}")).expect_err(text);
        assert!(error.message.contains(told), "{error}");
        assert!(error.help.contains(help), "{error}: {}", error.help);
    }
    let mesh = inp(&format!("{NODES}{CUBE}*ELSET, ELSET=B\n7, 8, 9\n")).unwrap();
    assert!(
        mesh.notes
            .iter()
            .any(|n| n.contains("ELSET B: 2 of its labels are not there (the first is 8)"))
    );
}

#[test]
fn all_formats_of_gmsh_give_the_same_mesh() {
    let [a, b, c, d] = ["41", "41b", "22", "22b"].map(|v| load(&format!("two_blocks_{v}.msh"), ""));
    assert_eq!(a.nodes.len(), 54);
    assert_eq!(a.elements.len(), 16);
    assert_eq!(a.bodies().names, ["0", "1"]);
    for other in [&b, &c, &d] {
        assert_eq!(a.node_labels, other.node_labels);
        assert_eq!(a.element_labels.len(), other.element_labels.len());
        assert_eq!(a.elements, other.elements);
        assert_eq!(a.nodes, other.nodes);
        assert_eq!(a.node_sets, other.node_sets);
        assert_eq!(a.element_sets, other.element_sets);
        assert_eq!(a.surfaces, other.surfaces);
    }
    assert_eq!(a.element_sets["lower"].len(), 8);
    assert_eq!(a.surfaces["bed of upper"].len(), 4);
    assert_eq!(a.surfaces["surface-40"].len(), 4, "a group without a name");
    assert_eq!(a.node_sets["edge"].len(), 3);
    assert_eq!(a.node_sets["corner"].len(), 1);
    for facet in &a.surfaces["bed of upper"] {
        assert!(
            a.facet(*facet)
                .iter()
                .all(|n| a.nodes[*n as usize][2] == 50.0)
        );
        assert!(a.element_sets["upper"].contains(&facet.0));
    }
    // 200 x 100 x 50 and 160 x 100 x 80 mm in metres.
    let metres = load("two_blocks_41.msh", "m");
    assert_eq!(metres.nodes[4], a.nodes[4].map(|x| 1e3 * x));
}

#[test]
fn invalid_files_of_gmsh_are_rejected() {
    let text = std::fs::read_to_string(data("two_blocks_22.msh")).unwrap();
    let nothing = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let read = |text: &str| {
        ImportedMesh::read(
            "a.msh",
            text.as_bytes(),
            &Units::default(),
            &mut nothing.clone(),
        )
    };
    let line = |from: &str| text.lines().position(|l| l == from).unwrap() + 1;
    let hexahedron = text.lines().find(|l| l.contains(" 5 2 7 ")).unwrap();
    let nodes: Vec<&str> = hexahedron.split(' ').skip(5).take(4).collect();
    let [number, ..] = hexahedron.split(' ').collect::<Vec<_>>()[..] else {
        panic!()
    };
    let tetrahedron = format!("{number} 4 2 7 1 {}", nodes.join(" "));
    let error = read(&text.replace(hexahedron, &tetrahedron)).unwrap_err();
    assert_eq!(error.line, Some(line(hexahedron)));
    assert!(
        error
            .message
            .starts_with(&format!("element {number} near (")),
        "{error}"
    );
    assert!(error.help.contains("recombine"), "{}", error.help);
    for (from, to, told) in [
        ("2.2 0 8", "1 0 8", "version 1 of Gmsh's format"),
        ("2.2 0 8", "4 0 8", "version 4 of Gmsh's format"),
        ("$Nodes", "$Knots", "$Knots does not end"),
        ("2 0 0 0", "1 0 0 0", "node 1 is there twice"),
        (
            "2 0 0 0",
            "2 0 0 zero",
            "`zero` stands where a number belongs",
        ),
        ("$MeshFormat\n", "$Format\n", "no $MeshFormat comes first"),
    ] {
        let error = read(&text.replacen(from, to, 1)).expect_err(to);
        assert!(error.message.contains(told), "{error}");
    }
    let cut = std::fs::read(data("two_blocks_41b.msh")).unwrap();
    let cut = &cut[..cut.len() / 2];
    let error = ImportedMesh::read("a.msh", cut, &Units::default(), &mut nothing.clone());
    let error = error.unwrap_err();
    assert!(error.message.contains("ends within a section"), "{error}");
    assert_eq!(error.line, None);
}
