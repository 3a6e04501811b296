//! JSON of COMPAS: assemblies of compas_assembly, compas_cra and compas_dem, lists of meshes, single meshes.
//!
//! A mesh is any object with `vertex` and `face` (data of `compas.datastructures.Mesh`, old and new), or with
//! `vertices` and `faces` (polyhedra). They are found at any depth, so that the many forms of assemblies need no reader
//! of their own. Interfaces between blocks are passed over. The `transformation` of an element applies to the meshes
//! in it.

use std::collections::HashMap;

use nalgebra::{Matrix4, Point3, RowVector4};

use super::json::{Json, get};
use super::{Count, Part, Place, Polygon, ShellError, Soup};
use crate::deck::import::numbers::is_sound;

/// Keys below which there are no blocks.
const PASSED: [&str; 8] = [
    "edge",
    "edgedata",
    "halfedge",
    "adjacency",
    "interfaces",
    "interactions",
    "features",
    "params",
];

/// Names that COMPAS gives to all meshes.
const GENERIC: [&str; 4] = ["Mesh", "Block", "Box", "Polyhedron"];

/// Objects whose keys are those of blocks.
const NODES: [&str; 4] = ["node", "vertex", "blocks", "elements"];

/// A key of an object with its value.
type Entry = (Box<str>, Json);

/// Reads the contents of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Soup, ShellError> {
    let value: Json = serde_json::from_slice(bytes).map_err(|why| {
        let help = "write the assembly again by compas.json_dump";
        ShellError::new(
            Place::Line(why.line() as u32),
            format!("this is no JSON: {why}"),
            help,
        )
    })?;
    let mut finder = Finder {
        is_grouped: has_groups(&value),
        ..Finder::default()
    };
    finder.visit(&value, None)?;
    if finder.soup.parts.is_empty() {
        return Err(ShellError::new(
            Place::Whole,
            "there are no meshes in it",
            "blocks are objects with `vertex` and `face`, as compas.json_dump writes assemblies and lists of meshes",
        ));
    }
    Ok(finder.soup)
}

#[derive(Default)]
struct Finder {
    soup: Soup,
    count: Count,
    /// Whether elements are grouped below others, whose transformations would apply to them as well.
    is_grouped: bool,
    /// Product of the transformations of the objects around the present one; none if there is none.
    transformation: Option<Matrix4<f64>>,
}

impl Finder {
    /// Adds the meshes of a value. `name`: key of the node in which it is.
    fn visit(&mut self, value: &Json, name: Option<&str>) -> Result<(), ShellError> {
        match value {
            Json::List(items) => items.iter().try_for_each(|item| self.visit(item, name)),
            Json::Object(object) => self.object(object, name),
            _ => Ok(()),
        }
    }

    fn object(&mut self, object: &[Entry], name: Option<&str>) -> Result<(), ShellError> {
        let given = get(object, "transformation").filter(|t| !matches!(t, Json::Null));
        let Some(given) = given else {
            return self.parts(object, name);
        };
        if self.is_grouped {
            return Err(wrong(
                name,
                "it has a transformation in a tree of groups, whose transformations are not read",
                "apply the transformations before you write the file",
            ));
        }
        let own = matrix(given).ok_or_else(|| {
            let help = "a transformation is a matrix of four rows of four numbers, the last one 0, 0, 0, 1";
            wrong(name, "its transformation has no such matrix", help)
        })?;
        let around = self.transformation;
        self.transformation = Some(around.map_or(own, |around| around * own));
        let read = self.parts(object, name);
        self.transformation = around;
        read
    }

    fn parts(&mut self, object: &[Entry], name: Option<&str>) -> Result<(), ShellError> {
        let of = |key: &str| get(object, key);
        if let (Some(Json::Object(vertex)), Some(Json::Object(face))) = (of("vertex"), of("face")) {
            let own = of("attributes").and_then(|a| a.get("name"));
            let own = own.and_then(Json::text).filter(|n| !GENERIC.contains(n));
            let faces = sorted(face).into_iter().map(|(_, face)| face);
            return self.mesh(name.or(own), sorted(vertex).into_iter(), faces);
        }
        if let (Some(Json::List(vertices)), Some(Json::List(faces))) = (of("vertices"), of("faces"))
        {
            let keys: Vec<String> = (0..vertices.len()).map(|i| i.to_string()).collect();
            let points = keys.iter().map(String::as_str).zip(vertices);
            return self.mesh(name, points, faces.iter());
        }
        for (key, value) in sorted(object) {
            if PASSED.contains(&key) {
                continue;
            }
            match value {
                Json::Object(nodes) if NODES.contains(&key) => {
                    for (node, value) in sorted(nodes) {
                        // Elements of models have random keys of 36 characters.
                        let own = (node.len() < 36).then_some(node);
                        self.visit(value, own.or(name))?;
                    }
                }
                value => self.visit(value, name)?,
            }
        }
        Ok(())
    }

    fn mesh<'a>(
        &mut self,
        name: Option<&str>,
        points: impl Iterator<Item = (&'a str, &'a Json)>,
        faces: impl Iterator<Item = &'a Json>,
    ) -> Result<(), ShellError> {
        let mut index = HashMap::new();
        for (key, point) in points {
            let message = || format!("vertex {key} has no finite x, y, z");
            let moved = |x: [f64; 3]| -> [f64; 3] {
                let by = self.transformation;
                by.map_or(x, |by| by.transform_point(&Point3::from(x)).into())
            };
            let x = coordinates(point).map(moved);
            let x = x
                .filter(|x| x.iter().all(|x| is_sound(*x)))
                .ok_or_else(|| wrong(name, &message(), "write the mesh again"))?;
            index.insert(key.to_owned(), self.soup.vertices.len() as u32);
            self.soup.vertices.push(x);
        }
        let mut part = Part {
            name: name.map(str::to_owned),
            faces: Vec::new(),
        };
        for face in faces {
            let corner = |key: &Json| match key {
                Json::Text(key) => index.get(&**key).copied(),
                // Whole numbers are written without a fraction.
                key => index.get(&key.number()?.to_string()).copied(),
            };
            let corners: Option<Vec<u32>> = match face {
                Json::List(corners) => corners.iter().map(corner).collect(),
                _ => None,
            };
            let corners = corners.filter(|c| !c.is_empty()).ok_or_else(|| {
                wrong(
                    name,
                    "a face has a corner that is no vertex of the mesh",
                    "write the mesh again",
                )
            })?;
            self.count.add(corners.len(), Place::Whole)?;
            part.faces.push(Polygon {
                corners,
                place: Place::Whole,
            });
        }
        self.soup.parts.push(part);
        Ok(())
    }
}

/// The matrix of a transformation: of the object or of its data.
fn matrix(of: &Json) -> Option<Matrix4<f64>> {
    let rows = of.get("matrix").or_else(|| of.get("data")?.get("matrix"))?;
    let Json::List(rows) = rows else {
        return None;
    };
    let mut matrix = Matrix4::zeros();
    for (i, row) in rows.iter().enumerate() {
        let Json::List(row) = row else {
            return None;
        };
        if row.len() != 4 {
            return None;
        }
        for (j, value) in row.iter().enumerate() {
            *matrix.get_mut((i, j))? = value.number().filter(|x| is_sound(*x))?;
        }
    }
    let last = matrix.row(3) == RowVector4::new(0.0, 0.0, 0.0, 1.0);
    (last && rows.len() == 4).then_some(matrix)
}

/// Whether a model has a tree in which elements stand below others.
fn has_groups(value: &Json) -> bool {
    let children = |node: &Json| match node.get("children") {
        Some(Json::List(children)) => !children.is_empty(),
        _ => false,
    };
    match value {
        Json::List(items) => items.iter().any(has_groups),
        Json::Object(entries) => entries.iter().any(|(key, value)| match &**key {
            "tree" => {
                let tree = value.get("data").unwrap_or(value);
                match tree.get("root").and_then(|root| root.get("children")) {
                    Some(Json::List(first)) => first.iter().any(children),
                    _ => false,
                }
            }
            _ => has_groups(value),
        }),
        _ => false,
    }
}

fn wrong(name: Option<&str>, message: &str, help: &str) -> ShellError {
    let of = name.map_or_else(|| "a mesh".to_owned(), |name| format!("block `{name}`"));
    ShellError::new(Place::Whole, format!("{of}: {message}"), help)
}

/// Entries in the order of the numbers of their keys, then the others by the alphabet.
fn sorted(object: &[Entry]) -> Vec<(&str, &Json)> {
    let mut entries: Vec<(&str, &Json)> =
        object.iter().map(|(key, value)| (&**key, value)).collect();
    entries.sort_by_cached_key(|(key, _)| (key.parse::<u64>().unwrap_or(u64::MAX), key.to_owned()));
    entries
}

/// Coordinates of a vertex: `{x, y, z}` or `[x, y, z]`.
fn coordinates(point: &Json) -> Option<[f64; 3]> {
    let of = |d: usize| {
        let value = match point {
            Json::List(items) => items.get(d)?,
            point => point.get(["x", "y", "z"][d])?,
        };
        value.number().filter(|x| is_sound(*x))
    };
    Some([of(0)?, of(1)?, of(2)?])
}

#[cfg(test)]
mod tests {
    use super::super::tests::{MM, error};
    use super::*;

    const VERTEX: &str = r#""vertex": {"10": {"x": 1.5, "y": 0, "z": 0}, "2": {"x": 0, "y": 0, "z": 0},
        "7": {"x": 0, "y": 2, "z": -1}}"#;

    fn names(text: &str) -> Vec<(Option<String>, Vec<u32>)> {
        let soup = Soup::read("json", text.as_bytes(), MM).unwrap();
        let part = |p: Part| (p.name, p.faces[0].corners.clone());
        soup.parts.into_iter().map(part).collect()
    }

    #[test]
    fn old_and_new_assemblies_and_lists_are_read() {
        let mesh = format!(
            "{{{VERTEX}, \"face\": {{\"0\": [2, 10, \"7\"]}}, \"attributes\": {{\"name\": \"Mesh\"}}}}"
        );
        // Vertices in the order 2, 7, 10.
        let corners = vec![0, 2, 1];
        let old = format!(
            r#"{{"assembly": {{"vertex": {{"0": {{"x": 1}}}}}}, "blocks": {{"3": {mesh}}}}}"#
        );
        assert_eq!(names(&old), [(Some("3".into()), corners.clone())]);
        let new = format!(
            r#"{{"dtype": "compas_assembly.datastructures/Assembly", "data": {{"graph": {{"data": {{"node": {{"5":
            {{"block": {{"dtype": "Block", "data": {mesh}}}}}}}, "edge": {{"5": {{"6": {{"interfaces": [{mesh}]}}}}}}}}}}}}}}"#
        );
        assert_eq!(names(&new), [(Some("5".into()), corners.clone())]);
        let list = format!(
            r#"[{{"dtype": "Mesh", "data": {mesh}}}, {}]"#,
            mesh.replace("\"Mesh\"", "\"key\"")
        );
        let shifted: Vec<u32> = corners.iter().map(|c| c + 3).collect();
        assert_eq!(
            names(&list),
            [(None, corners), (Some("key".into()), shifted)]
        );
        let polyhedron = r#"{"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}"#;
        assert_eq!(names(polyhedron), [(None, vec![0, 1, 2])]);
    }

    /// A quarter turn about z and a shift.
    const TURNED: &str = r#""transformation": {"dtype": "compas.geometry/Transformation", "data": {"matrix":
        [[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]]}}"#;

    #[test]
    fn transformations_of_elements_apply_to_their_meshes() {
        let mesh = format!("{{{VERTEX}, \"face\": {{\"0\": [2, 10, 7]}}}}");
        let read = |element: &str| {
            let text = format!("[{element}, {mesh}]");
            Soup::read("json", text.as_bytes(), MM).unwrap().vertices
        };
        // Vertices in the order 2, 7, 10; the mesh after the element stays where it is.
        let points = read(&format!("{{{TURNED}, \"geometry\": {mesh}}}"));
        let turned = [[10.0, 20.0, 30.0], [8.0, 20.0, 29.0], [10.0, 21.5, 30.0]];
        let rest = [[0.0, 0.0, 0.0], [0.0, 2.0, -1.0], [1.5, 0.0, 0.0]];
        assert_eq!(points, [turned, rest].concat());
        // An element in another one has both transformations: half a turn.
        let points = read(&format!(
            "{{{TURNED}, \"parts\": {{{TURNED}, \"geometry\": {mesh}}}}}"
        ));
        assert_eq!(points[2], [-11.5, 30.0, 60.0]);
    }

    #[test]
    fn bad_transformations_are_refused() {
        for (from, to) in [
            ("[0, 0, 0, 1]]", "[0, 0, 1]]"),
            ("[0, 0, 0, 1]]", "[0, 0, 1, 1]]"),
            (", [0, 0, 0, 1]]", "]"),
            ("[0, 0, 1, 30]", "[0, 0, 1, \"30\"]"),
            ("[0, 0, 1, 30]", "[0, 0, 1, 1e300]"),
        ] {
            let bad = TURNED.replace(from, to);
            assert_ne!(bad, TURNED);
            let text = format!("{{{bad}, {VERTEX}, \"face\": {{}}}}");
            let said = error("json", text.as_bytes());
            assert!(
                said.contains("its transformation has no such matrix"),
                "{said}"
            );
        }
    }

    #[test]
    fn bad_files_name_the_block() {
        let node = |of: &str| format!(r#"{{"node": {{"8": {{"block": {{{of}}}}}}}}}"#);
        for (text, wanted) in [
            ("[1, 2".to_owned(), " line 1: this is no JSON"),
            ("{}".to_owned(), "no meshes"),
            ("[".repeat(100_000), "this is no JSON"),
            (
                node(&format!("{VERTEX}, \"face\": {{\"0\": [2, 10, 9]}}")),
                "block `8`: a face has a corner that is no vertex",
            ),
            (
                node(r#""vertex": {"0": {"x": 0, "y": 0}}, "face": {}"#),
                "block `8`: vertex 0 has no finite x, y, z",
            ),
            (
                node(&format!(
                    "\"transformation\": [1], {VERTEX}, \"face\": {{}}"
                )),
                "block `8`: its transformation has no such matrix",
            ),
            (
                format!(
                    "{{\"tree\": {{\"root\": {{\"children\": [{{\"children\": [{{}}]}}]}}}}, \
                     \"elements\": [{{{TURNED}, {VERTEX}, \"face\": {{}}}}]}}"
                ),
                "it has a transformation in a tree of groups",
            ),
        ] {
            let said = error("json", text.as_bytes());
            assert!(said.contains(wanted), "{said}");
        }
    }
}
