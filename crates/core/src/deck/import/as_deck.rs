//! Writes a first deck for a mesh: its materials as tables, its sets in comments.

use std::collections::BTreeMap;

use super::{ImportedMesh, Lengths};
use crate::deck::imported::lengths;
use crate::deck::schema::Material;
use crate::deck::templates::SCHEMA;

impl ImportedMesh {
    /// Text of a deck that imports this mesh as `name` from `file`, with its materials written out. Comments list
    /// the decisions that are left to the author: materials that cannot be converted, interfaces, supports, steps.
    ///
    /// # Errors
    /// Values that TOML cannot represent; none are expected here.
    pub fn as_deck(&self, name: &str, file: &str, units: &str) -> Result<String, String> {
        let mut materials: BTreeMap<&str, Material> = BTreeMap::new();
        let mut missing = Vec::new();
        let mut lines = vec![format!(
            "#:schema ./{SCHEMA}\n# The mesh {file}: {} nodes, {} elements, {} bodies.",
            self.nodes.len(),
            self.elements.len(),
            self.bodies().names.len()
        )];
        let remark = |note: &str| format!("# {}", note.replace('\n', " "));
        lines.extend(self.notes.iter().map(|note| remark(note)));
        for own in &self.materials {
            let name = own.name.as_str();
            match own.in_a_deck(self.lengths_of(name)) {
                Ok((made, notes)) => {
                    let notes = notes
                        .iter()
                        .map(|n| remark(&format!("material {name}: {n}")));
                    lines.extend(notes);
                    materials.insert(name, made);
                }
                Err(why) => missing.push(not_taken(name, &why)),
            }
        }
        let [name_of_import, file, units] = [name, file, units].map(quoted);
        lines.push(format!(
            "\nformat = 1\ntitle = {name_of_import}\n\n[[imports]]\nname = {name_of_import}\nfile = {file}\n\
             units = {units}"
        ));
        if self.sections.is_empty() {
            let first = self.element_sets.keys().next();
            let set = quoted(first.map_or("SET", String::as_str));
            lines.push(format!(
                "# The file has no sections: say which set is of which material.\n# materials = {{ {set} = \
                 \"brick\" }}"
            ));
        }
        lines.push("\n# Bodies, sets and surfaces, called by these names:".to_owned());
        lines.extend(self.names_of_all(name));
        let tables: BTreeMap<&str, _> = [("materials", materials)].into();
        let tables = toml::to_string(&tables).map_err(|why| why.to_string())?;
        lines.push(format!("\n{tables}"));
        lines.extend(missing);
        let surface = self.surfaces.keys().next();
        let surface = surface.map_or("SURFACE", String::as_str);
        lines.push(left_to_say(&quoted(&format!("{name}.{surface}"))));
        lines.push(String::new());
        Ok(lines.join("\n"))
    }

    /// Comments with the first names of each kind, as a deck calls them.
    fn names_of_all(&self, import: &str) -> Vec<String> {
        let kinds: [(&str, Vec<String>); 4] = [
            ("bodies", self.bodies().names),
            ("surfaces", self.surfaces.keys().cloned().collect()),
            ("sets of nodes", self.node_sets.keys().cloned().collect()),
            (
                "sets of elements",
                self.element_sets.keys().cloned().collect(),
            ),
        ];
        let kinds = kinds.iter().filter(|(_, names)| !names.is_empty());
        let line = |(what, names): &(&str, Vec<String>)| {
            let some = names.iter().take(SOME).map(|n| format!("{import}.{n}"));
            let some = some.collect::<Vec<_>>().join(", ").replace('\n', " ");
            let rest = if names.len() > SOME { ", ..." } else { "" };
            format!("#   {what}: {some}{rest}")
        };
        kinds.map(line).collect()
    }

    /// Equivalent lengths of the elements whose sections name a material.
    pub(crate) fn lengths_of(&self, material: &str) -> Option<Lengths> {
        let sections = self.sections.iter();
        let of = sections.filter(|s| s.material.eq_ignore_ascii_case(material));
        lengths(
            self,
            of.flat_map(|s| s.elements.iter().map(|e| *e as usize)),
        )
    }
}

/// A name or text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// Comment on a material that a deck cannot have.
fn not_taken(name: &str, why: &str) -> String {
    let (name, why) = (quoted(name), why.replace('\n', " "));
    format!(
        "# The material {name} of the file cannot be taken: {why}. Write it yourself:\n\
         # [materials.{name}]\n# E = \"10000 MPa\"\n# nu = 0.2\n# density = \"1800 kg/m^3\"\n"
    )
}

/// Comment with the decisions that are left, for a face of the mesh.
fn left_to_say(face: &str) -> String {
    format!(
        "# What is left to say:\n\
         # [interfaces.joint]\n# f_t = \"0.2 MPa\"\n# c = \"0.22 MPa\"\n# tan_phi = 0.75\n# mu = 0.75\n\
         # zeta = 4.38\n# xi = 1.1\n# u_k = \"0.36 mm\"\n# delta_k = \"0.4 mm\"\n#\n\
         # [[contacts]]  # without slave and master: all that touches at rest\n# interface = \"joint\"\n#\n\
         # [[supports]]\n# on = {face}\n#\n\
         # [[steps]]\n# kind = \"drive\"\n# face = {face}\n# direction = \"x\"\n# displacement = \"1 mm\""
    )
}

/// Largest number of names that are listed.
const SOME: usize = 20;
