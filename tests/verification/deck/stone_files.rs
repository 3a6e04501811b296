//! Blocks from files of closed shells.

use std::fs;
use std::path::Path;

use crate::common::blocks::{HEAD, norm, volume};
use crate::common::examples;
use crate::common::scene::completed;
use wythe::deck::Deck;
use wythe::error::{DeckError, Warning};
use wythe::limit::{LimitSettings, analyse};
use wythe::model::Model;
use wythe::results::export::shells::{obj, ply, stl};

/// A scene of the stones of a file, named `s`, which touch at rest and are held as `held` says.
fn scene(file: &str, keys: &str, held: &str) -> String {
    format!(
        "{HEAD}[[blocks]]\nname = \"s\"\nfile = \"{file}\"\nmaterial = \"stone\"\n{keys}\n\
         [[contacts]]\ninterface = \"dry\"\n[[supports]]\non = {held}\n[[steps]]\nkind = \"gravity\"\n"
    )
}

/// The model of a deck with a file beside it.
fn build(deck: &str, file: &str, contents: &[u8]) -> Result<(Model, Vec<Warning>), DeckError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(file), contents).unwrap();
    let path = folder.path().join("deck.toml");
    fs::write(&path, deck).unwrap();
    Ok(Model::from_deck(&Deck::load(&path, &[])?)?)
}

fn built(deck: &str, file: &str, contents: &str) -> Model {
    build(deck, file, contents.as_bytes())
        .unwrap_or_else(|e| panic!("{e}"))
        .0
}

/// Error of a file of one block on the ground, with its help.
fn refused(file: &str, contents: &[u8], keys: &str) -> String {
    match build(&scene(file, keys, "\"s\""), file, contents) {
        Ok(_) => panic!("{file} is read"),
        Err(error) => format!("{:?}", miette::Report::new(error)).replace(['\n', '│'], " "),
    }
}

/// The words of a report without its line breaks.
fn squeezed(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Four boxes in a running bond, with common edges and a common bed, as blocks of a deck.
fn wall() -> String {
    let boxes = [
        ("a", [200, 100, 60], [0, 0, 0]),
        ("b", [200, 100, 60], [200, 0, 0]),
        ("c", [100, 100, 60], [0, 0, 60]),
        ("d", [200, 100, 60], [100, 0, 60]),
    ];
    let blocks = boxes.map(|(name, size, at)| {
        format!(
            "[[blocks]]\nname = \"s-{name}\"\nsize = {size:?}\nat = {at:?}\nmaterial = \"stone\"\nmesh = [2, 1, 1]\n"
        )
    });
    format!(
        "{HEAD}{}[[contacts]]\ninterface = \"dry\"\n[[supports]]\non = [\"s-a.bottom\", \"s-b.bottom\"]\n\
         [[steps]]\nkind = \"gravity\"\n",
        blocks.concat()
    )
}

/// Along +x, without dilatancy.
fn along_x() -> LimitSettings {
    LimitSettings {
        along: Some([1.0, 0.0, 0.0]),
        ..LimitSettings::default()
    }
}

#[test]
fn a_wall_of_boxes_is_the_same_model_from_every_format() {
    let blocks = Model::from_deck(&Deck::from_str(&wall(), "wall.toml").unwrap())
        .unwrap()
        .0;
    let wanted = analyse(&blocks, &along_x()).unwrap().factor;
    assert!(wanted > 0.1, "{wanted}");
    let named = "[\"s-a.bottom\", \"s-b.bottom\"]";
    for (file, text, held) in [
        ("wall.obj", obj(&blocks.mesh).replace("o s-", "o "), named),
        (
            "wall.stl",
            stl(&blocks.mesh).replace("solid s-", "solid "),
            named,
        ),
        // A PLY has no names: all stones are one part, whose faces meet in fours along the edges.
        (
            "wall.ply",
            ply(&blocks.mesh),
            "[\"s-0.bottom\", \"s-1.bottom\"]",
        ),
    ] {
        let model = built(&scene(file, "mesh = [2, 1, 1]", held), file, &text);
        assert_eq!(model.mesh.nodes, blocks.mesh.nodes, "{file}");
        assert_eq!(model.mesh.elements, blocks.mesh.elements, "{file}");
        assert_eq!(model.mesh.unit, blocks.mesh.unit, "{file}");
        let surfaces = |m: &Model| {
            format!(
                "{:?} {:?}",
                m.contact,
                m.supports.iter().map(|s| &s.nodes).collect::<Vec<_>>()
            )
        };
        assert_eq!(surfaces(&model), surfaces(&blocks), "{file}");
        assert_eq!(
            analyse(&model, &along_x()).unwrap().factor,
            wanted,
            "{file}"
        );
    }
}

#[test]
fn a_wall_of_triangles_settles_as_one_of_blocks() {
    let blocks = Model::from_deck(&Deck::from_str(&wall(), "wall.toml").unwrap())
        .unwrap()
        .0;
    let text = stl(&blocks.mesh).replace("solid s-", "solid ");
    let held = "[\"s-a.bottom\", \"s-b.bottom\"]";
    let model = built(
        &scene("wall.stl", "mesh = [2, 1, 1]", held),
        "wall.stl",
        &text,
    );
    let last = |model: &Model| completed(model).states.last().unwrap().q.clone();
    let (own, other) = (last(&model), last(&blocks));
    assert!(own.iter().any(|u| *u != 0.0));
    assert_eq!(own, other);
}

#[test]
fn an_arch_from_a_file_carries_as_much_as_the_arch_of_a_deck() {
    let arch = format!(
        "{HEAD}[arch]\nspan = 2000\nrise = 500\nthickness = 250\nwidth = 200\nvoussoirs = 9\nmaterial = \"stone\"\n\
         interface = \"dry\"\n[[steps]]\nkind = \"gravity\"\n"
    )
    .replace("0.4", "0.7");
    let model = Model::from_deck(&Deck::from_str(&arch, "arch.toml").unwrap())
        .unwrap()
        .0;
    let wanted = analyse(&model, &along_x()).unwrap().factor;
    let held = "[\"s-springing-left\", \"s-springing-right\"]";
    for (file, text) in [
        ("arch.obj", obj(&model.mesh)),
        ("arch.stl", stl(&model.mesh)),
    ] {
        let deck = scene(file, "", held).replace("0.4", "0.7");
        let read = built(&deck, file, &text);
        assert_eq!(read.mesh.elements.len(), model.mesh.elements.len());
        let found = analyse(&read, &along_x()).unwrap().factor;
        // The stones are equal; only the order of their corners may differ.
        assert!(
            (found / wanted - 1.0).abs() < 1e-5,
            "{file}: {found} {wanted}"
        );
    }
}

/// A regular prism of `n` sides of inner radius `r` between z = 0 and `h`, or a pyramid with its apex at `h`, as OBJ.
fn regular(n: usize, r: f64, h: f64, is_pyramid: bool) -> String {
    let outer = r / (std::f64::consts::PI / n as f64).cos();
    let on = |i: usize, z: f64| {
        // A side faces +x.
        let angle = std::f64::consts::TAU * (i as f64 + 0.5) / n as f64;
        format!("v {} {} {z}\n", outer * angle.cos(), outer * angle.sin())
    };
    let mut text: String = (0..n).map(|i| on(i, 0.0)).collect();
    let list = |of: &mut dyn Iterator<Item = usize>| {
        let words: Vec<String> = of.map(|i| (i + 1).to_string()).collect();
        format!("f {}\n", words.join(" "))
    };
    let bottom = list(&mut (0..n).rev());
    if is_pyramid {
        text += &format!("v 0 0 {h}\n");
        text += &bottom;
        for i in 0..n {
            text += &list(&mut [i, (i + 1) % n, n].into_iter());
        }
        return text;
    }
    text.extend((0..n).map(|i| on(i, h)));
    text += &bottom;
    text += &list(&mut (n..2 * n));
    for i in 0..n {
        let j = (i + 1) % n;
        text += &list(&mut [i, j, n + j, n + i].into_iter());
    }
    text
}

/// A file of one stone on a block of ground.
fn on_ground(keys: &str) -> String {
    let ground = "[[blocks]]\nname = \"ground\"\nsize = [400, 400, 50]\nat = [-200, -200, -50]\nmaterial = \"stone\"\n";
    scene("stone.obj", keys, "\"ground\"").replacen(
        "[[contacts]]",
        &format!("{ground}[[contacts]]"),
        1,
    )
}

#[test]
fn prisms_and_pyramids_tip_over_their_edge() {
    for (n, is_pyramid, mesh, elements) in [
        (6, false, 1, 12),
        (6, false, 2, 96),
        (5, true, 1, 40),
        (3, true, 2, 32),
    ] {
        // The centroid of a pyramid lies at a quarter of its height.
        let (r, h, middle) = if is_pyramid {
            (20.0, 320.0, 80.0)
        } else {
            (40.0, 320.0, 160.0)
        };
        let text = regular(n, r, h, is_pyramid);
        let model = built(
            &on_ground(&format!("mesh = [{mesh}, {mesh}, {mesh}]")),
            "stone.obj",
            &text,
        );
        assert_eq!(model.mesh.elements.len(), elements + 1);
        let area = n as f64 * r * r * (std::f64::consts::PI / n as f64).tan();
        let known = area * h / if is_pyramid { 3.0 } else { 1.0 };
        // Rounding of sums of a hundred volumes.
        assert!((volume(&model, 0) / known - 1.0).abs() < 1e-12);
        let found = analyse(&model, &along_x()).unwrap().factor;
        // Friction is 0.4, and tipping begins at r over the height of the centroid: the accuracy of the programs.
        assert!((found / (r / middle) - 1.0).abs() < 1e-6, "{n}: {found}");
    }
}

#[test]
fn a_pyramid_sinks_by_the_closing_of_its_joint() {
    let deck = on_ground("").replace(
        "mu = 0.4",
        "mu = 0.4\nnormal_stiffness = 100\nshear_stiffness = 40",
    );
    for rigid in ["", "rigid = true"] {
        let deck = deck.replacen("file =", &format!("{rigid}\nfile ="), 1);
        let model = built(&deck, "stone.obj", &regular(5, 40.0, 100.0, true));
        let recording = completed(&model);
        let frame = recording.frames.last().unwrap();
        let top = model.mesh.nodes.iter().position(|x| x[2] == 100.0).unwrap();
        // The apex sinks by the closing of the joint and the shortening of the stone, and moves along no other axis.
        let sinks = frame.displacement[top];
        assert!(sinks[2] < 0.0 && sinks[2] > -0.01, "{sinks:?}");
    }
}

/// An L of unit squares, extruded by 2: its hull adds half a square.
fn ell() -> String {
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    let mut text = "o ell\n".to_owned();
    for y in [0, 2] {
        for [x, z] in outline {
            text += &format!("v {} {} {}\n", 100 * x, 100 * y, 100 * z);
        }
    }
    text += "f 1 2 3 4 5 6\nf 12 11 10 9 8 7\n";
    for i in 0..6 {
        let j = (i + 1) % 6;
        text += &format!("f {} {} {} {}\n", j + 1, i + 1, i + 7, j + 7);
    }
    text
}

#[test]
fn open_inverted_and_concave_stones_are_named() {
    let base = obj(
        &Model::from_deck(&Deck::from_str(&wall(), "wall.toml").unwrap())
            .unwrap()
            .0
            .mesh,
    );
    let said = |text: &str, keys: &str| squeezed(&refused("s.obj", text.as_bytes(), keys));
    let last = base.lines().rfind(|line| line.starts_with('f')).unwrap();
    let open = said(&base.replace(last, ""), "");
    assert!(
        open.contains("s.obj line")
            && open.contains("`s-d` is open: one face only lies at the edge"),
        "{open}"
    );
    // The last stone alone is turned inside out.
    let (others, turned) = base.split_at(base.rfind("o s-d").unwrap());
    let reversed: String = turned
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(rest) => format!(
                "f {}\n",
                rest.split(' ').rev().collect::<Vec<_>>().join(" ")
            ),
            None => format!("{line}\n"),
        })
        .collect();
    let inverted = said(&format!("{others}{reversed}"), "");
    assert!(
        inverted.contains("`s-d` near (200, 50, 90) mm is turned inside out"),
        "{inverted}"
    );
    let concave = said(&ell(), "");
    assert!(
        concave.contains("`ell` near (100, 100, 100) mm is not convex: its corner"),
        "{concave}"
    );
    assert!(concave.contains("not_convex = \"hull\""), "{concave}");
    // The hull has the volume of the L and half a square: 3.5 times 2.
    let deck = on_ground("not_convex = \"hull\"").replace("stone.obj", "ell.obj");
    let (model, warnings) = build(&deck, "ell.obj", ell().as_bytes()).unwrap();
    assert!(
        (volume(&model, 0) / 7e6 - 1.0).abs() < 1e-12,
        "{}",
        volume(&model, 0)
    );
    let warning = warnings
        .iter()
        .map(ToString::to_string)
        .find(|w| w.contains("hull"));
    let warning = warning.unwrap();
    assert!(
        warning.contains("1.0000e6 mm^3, 14.286 percent") && warning.contains("s-ell"),
        "{warning}"
    );
}

#[test]
fn all_shells_inside_out_are_reversed_with_a_warning() {
    let text: String = regular(6, 40.0, 100.0, false)
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(rest) => format!(
                "f {}\n",
                rest.split(' ').rev().collect::<Vec<_>>().join(" ")
            ),
            None => format!("{line}\n"),
        })
        .collect();
    let (model, warnings) = build(&on_ground(""), "stone.obj", text.as_bytes()).unwrap();
    assert!(volume(&model, 0) > 0.0);
    assert!(
        warnings
            .iter()
            .any(|w| w.to_string().contains("look inwards")),
        "{warnings:?}"
    );
}

#[test]
fn units_scale_and_a_wrong_unit_is_noticed() {
    let text = regular(6, 0.04, 0.1, false);
    let of = |keys: &str| {
        let (model, warnings) = build(&on_ground(keys), "stone.obj", text.as_bytes()).unwrap();
        (
            volume(&model, 0),
            warnings.iter().map(ToString::to_string).collect::<String>(),
        )
    };
    let (small, warned) = of("");
    assert!(
        warned.contains("if the file is in m: units = \"m\""),
        "{warned}"
    );
    let (large, silent) = of("units = \"m\"");
    assert!(!silent.contains("size of its stones"), "{silent}");
    // One factor a coordinate, rounded.
    assert!((large / small / 1e9 - 1.0).abs() < 1e-12);
    let moved = "units = \"m\"\nat = [10, 20, 0]\nrotate = { axis = \"z\", angle = 90 }";
    let model = built(&on_ground(moved), "stone.obj", &text);
    let [x, y] = [0, 1].map(|d| {
        let own = model.mesh.nodes[..model.mesh.nodes.len() - 8].iter();
        let (low, high) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x[d]), b.max(x[d]))
        });
        [low, high]
    });
    // Sides of inner radius 40 face +x before the turn, and +y after it.
    assert!(norm([y[0] + 20.0, y[1] - 60.0, 0.0]) < 1e-9, "{y:?}");
    assert!(norm([x[0] + x[1] - 20.0, 0.0, 0.0]) < 1e-9, "{x:?}");
}

#[test]
fn names_mean_stones_parts_and_faces() {
    let outline = |layer: &str, x: f64| {
        let corners = [
            [0.0, 0.0],
            [100.0, 0.0],
            [120.0, 50.0],
            [50.0, 90.0],
            [0.0, 60.0],
        ];
        let points: String = corners
            .iter()
            .map(|[u, v]| format!("10\n{}\n20\n{v}\n", x + u))
            .collect();
        format!("0\nLWPOLYLINE\n8\n{layer}\n70\n1\n{points}")
    };
    let file = format!(
        "0\nSECTION\n2\nENTITIES\n{}{}{}0\nENDSEC\n0\nEOF\n",
        outline("pier one", 0.0),
        outline("0", 300.0),
        outline("pier one", 600.0)
    );
    let model = |held: &str| {
        let deck = scene("a.dxf", "thickness = 100", held)
            .replace("[[contacts]]\ninterface = \"dry\"\n", "");
        build(&deck, "a.dxf", file.as_bytes())
    };
    let nodes = |held: &str| {
        let (model, _) = model(held).unwrap_or_else(|e| panic!("{held}: {e}"));
        (
            model.mesh.names.clone(),
            model
                .supports
                .iter()
                .map(|s| s.nodes.len())
                .collect::<Vec<_>>(),
        )
    };
    // A prism of five sides: 10 corners, 15 edges, 7 faces, one middle; a face of four corners has nine nodes. The
    // largest face, side-0, is the one below.
    let (names, all) = nodes("\"s\"");
    assert_eq!(names, ["s-pier_one-0", "s-pier_one-1", "s-0"]);
    assert_eq!(all, [3 * 33]);
    assert_eq!(nodes("[\"s-pier_one\", \"s-0\"]").1, [3 * 33]);
    assert_eq!(nodes("[\"s.bottom\"]").1, [3 * 9]);
    assert_eq!(nodes("[\"s-pier_one\", \"s-0.side-0\"]").1, [2 * 33 + 9]);
    for (held, wanted) in [
        ("\"s-pier_two\"", "there is no block named `s-pier_two`"),
        ("\"s-0.side-7\"", "`s-0` has no face `side-7`"),
        ("\"s-0.lid\"", "a block has no face `lid`"),
    ] {
        let error = model(held).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

#[test]
fn bodies_survive_the_way_through_each_format() {
    let [text, again] = [1, 2].map(|mesh| (regular(5, 40.0, 90.0, true), mesh));
    for (stone, mesh) in [text, again] {
        let keys = format!("mesh = [{mesh}, {mesh}, {mesh}]");
        let model = built(&on_ground(&keys), "stone.obj", &stone);
        let wanted = analyse(&model, &along_x()).unwrap().factor;
        for (file, text, held) in [
            ("stone.obj", obj(&model.mesh), "\"s-ground\""),
            ("stone.stl", stl(&model.mesh), "\"s-ground\""),
            ("stone.ply", ply(&model.mesh), "\"s-1\""),
        ] {
            let read = built(&scene(file, "", held), file, &text);
            for body in 0..2 {
                let (a, b) = (volume(&model, body), volume(&read, body));
                assert!((a / b - 1.0).abs() < 1e-12, "{file}: {a} {b}");
            }
            let found = analyse(&read, &along_x()).unwrap().factor;
            // The accuracy of the programs.
            assert!(
                (found / wanted - 1.0).abs() < 1e-6,
                "{file}: {found} {wanted}"
            );
        }
    }
}

#[test]
fn damaged_files_are_errors() {
    let model = Model::from_deck(&Deck::from_str(&wall(), "wall.toml").unwrap())
        .unwrap()
        .0;
    let dxf = "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\nA\n70\n1\n10\n0\n20\n0\n10\n90\n20\n0\n10\n0\n20\n80\n0\nENDSEC\n0\nEOF\n";
    let json = r#"{"node": {"0": {"block": {"vertex": {"0": {"x": 0, "y": 0, "z": 0}, "1": {"x": 90, "y": 0, "z": 0},
        "2": {"x": 0, "y": 90, "z": 0}, "3": {"x": 0, "y": 0, "z": 90}}, "face": {"0": [0, 2, 1], "1": [0, 1, 3],
        "2": [1, 2, 3], "3": [2, 0, 3]}}}}}"#;
    let files = [
        ("a.obj", obj(&model.mesh), ""),
        ("a.ply", ply(&model.mesh), ""),
        ("a.stl", stl(&model.mesh), ""),
        ("a.dxf", dxf.to_owned(), "thickness = 50"),
        ("a.json", json.to_owned(), ""),
    ];
    let mut seed = 12345_u64;
    let mut random = move |below: usize| {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as usize % below
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.toml");
    for (file, text, keys) in &files {
        let deck = scene(file, keys, "\"s\"").replace("[[contacts]]\ninterface = \"dry\"\n", "");
        fs::write(&path, deck).unwrap();
        let read = |bytes: &[u8]| {
            fs::write(folder.path().join(file), bytes).unwrap();
            Model::from_deck(&Deck::load(&path, &[]).unwrap())
        };
        assert!(read(text.as_bytes()).is_ok(), "{file}");
        let mut refused = 0;
        for _ in 0..60 {
            let mut bytes = text.clone().into_bytes();
            bytes.truncate(random(bytes.len()));
            refused += usize::from(read(&bytes).is_err());
            let mut bytes = text.clone().into_bytes();
            for _ in 0..3 {
                let at = random(bytes.len());
                bytes[at] = random(256) as u8;
            }
            refused += usize::from(read(&bytes).is_err());
        }
        // Some changes are harmless: a name, a comment, a digit of a normal.
        assert!(refused > 50, "{file}: {refused}");
    }
}

#[test]
fn keys_of_files_belong_to_files() {
    for (keys, file, wanted) in [
        ("units = \"furlong\"", "a.obj", "furlong"),
        (
            "thickness = 5",
            "a.obj",
            "this key belongs to a `file` of outlines",
        ),
        ("", "a.dxf", "the key `thickness` is missing"),
        (
            "copies = [2, 1, 1]\npitch = [9, 0, 0]",
            "a.obj",
            "the blocks of a file stand once",
        ),
        (
            "size = [1, 1, 1]",
            "a.obj",
            "both `size` and `file` are given",
        ),
    ] {
        let said = squeezed(&refused(file, b"", keys));
        assert!(said.contains(wanted), "{said}");
    }
    let plain = scene("a.obj", "not_convex = \"hull\"", "\"s\"")
        .replace("file = \"a.obj\"", "size = [1, 1, 1]");
    let error = Deck::from_str(&plain, "a.toml").unwrap_err().to_string();
    assert!(error.contains("this key belongs to a `file`"), "{error}");
    assert!(squeezed(&refused("missing.step", b"", "")).contains("the ending says no format"));
}

#[test]
fn the_dome_of_the_examples_stands_and_has_its_stones() {
    assert!(Path::new("examples/95_dome_of_stones.obj").is_file());
    let (model, _) = examples::completed("95_dome_of_stones", &[]);
    assert_eq!(model.mesh.names.len(), 26);
    // The keystone has 16 corners.
    assert_eq!(model.mesh.elements.len(), 24 + 16 + 1);
    // It stands at 25 degrees, as the limit analysis says.
    let factor = analyse(&model, &LimitSettings::default()).unwrap().factor;
    assert!(factor > 25.0_f64.to_radians().tan(), "{factor}");
}
