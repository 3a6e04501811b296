//! Files that a mesh includes, found without reading the mesh.

use std::path::{Path, PathBuf};

/// Largest depth of inclusion.
const DEEPEST: usize = 16;

/// Files that an `.inp` includes, directly and indirectly, found by the INPUT= of their keywords. Unreadable files,
/// and meshes other than `.inp`, give none.
pub fn included(mesh: &Path) -> Vec<PathBuf> {
    let is_inp = mesh
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("inp"));
    let folder = mesh.parent().unwrap_or(Path::new(""));
    let mut found: Vec<PathBuf> = Vec::new();
    let mut level = if is_inp {
        vec![mesh.to_owned()]
    } else {
        Vec::new()
    };
    for _ in 0..DEEPEST {
        let named = level.iter().flat_map(|file| inputs_of(file, folder));
        let new: Vec<PathBuf> = named.filter(|file| !found.contains(file)).collect();
        found.extend_from_slice(&new);
        level = new;
    }
    found
}

fn inputs_of(file: &Path, folder: &Path) -> Vec<PathBuf> {
    let is_file = std::fs::metadata(file).is_ok_and(|it| it.is_file());
    let bytes = if is_file {
        std::fs::read(file)
    } else {
        Ok(Vec::new())
    };
    let text = bytes.unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    // A keyword may continue on the next lines, so that INPUT= may stand on any line.
    let parameters = text.lines().flat_map(|line| line.split(','));
    let inputs = parameters.filter_map(|parameter| {
        let (key, name) = parameter.split_once('=')?;
        let name = name.trim().trim_matches(['"', '\'']);
        (key.trim().eq_ignore_ascii_case("input") && !name.is_empty()).then(|| folder.join(name))
    });
    inputs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_files_of_a_mesh_are_found_once() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(
            at("wall.inp"),
            "*NODE, Input = nodes.inp\n*ELEMENT, TYPE=C3D8,\nINPUT=\"elements.inp\"\n",
        )
        .unwrap();
        std::fs::write(at("nodes.inp"), "*INCLUDE, INPUT=more.inp\n").unwrap();
        std::fs::write(at("more.inp"), "*include, input=wall.inp\n").unwrap();
        let names = ["nodes.inp", "elements.inp", "more.inp", "wall.inp"].map(at);
        assert_eq!(included(&at("wall.inp")), names);
        assert_eq!(included(&at("wall.msh")), [] as [PathBuf; 0]);
        assert_eq!(included(&at("absent.inp")), [] as [PathBuf; 0]);
    }
}
