//! Writes a first deck for a mesh: its materials as tables, its sets in comments.

use std::collections::BTreeMap;
use std::fmt::Write as _;

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
        let mut missing: Vec<(&str, String)> = Vec::new();
        let mut remarks = self.notes.clone();
        for own in &self.materials {
            let (made, notes) = match own.in_a_deck(self.lengths_of(&own.name)) {
                Ok(made) => made,
                Err(why) => {
                    missing.push((own.name.as_str(), why));
                    continue;
                }
            };
            remarks.extend(
                notes
                    .into_iter()
                    .map(|n| format!("material {}: {n}", own.name)),
            );
            materials.insert(&own.name, made);
        }
        let quoted = |text: &str| toml::Value::from(text).to_string();
        let mut text = format!(
            "#:schema ./{SCHEMA}\n# The mesh {file}: {} nodes, {} elements, {} bodies.\n",
            self.nodes.len(),
            self.elements.len(),
            self.bodies().names.len()
        );
        let mut say = |line: String| {
            let written = writeln!(text, "{line}");
            debug_assert!(written.is_ok(), "writing to a string does not fail");
        };
        for remark in remarks {
            say(format!("# {}", remark.replace('\n', " ")));
        }
        say(format!("\nformat = 1\ntitle = {}\n", quoted(name)));
        say(format!(
            "[[imports]]\nname = {}\nfile = {}\nunits = {}",
            quoted(name),
            quoted(file),
            quoted(units)
        ));
        if self.sections.is_empty() {
            let first = self.element_sets.keys().next();
            let set = first.map_or("SET", String::as_str);
            say(format!(
                "# The file has no sections: say which set is of which material.\n# materials = {{ {} = \
                 \"brick\" }}",
                quoted(set)
            ));
        }
        say("\n# Bodies, sets and surfaces, called by these names:".to_owned());
        for (what, names) in [
            ("bodies", self.bodies().names),
            ("surfaces", self.surfaces.keys().cloned().collect()),
            ("sets of nodes", self.node_sets.keys().cloned().collect()),
            (
                "sets of elements",
                self.element_sets.keys().cloned().collect(),
            ),
        ] {
            let some: Vec<String> = names
                .iter()
                .take(SOME)
                .map(|n| format!("{name}.{n}"))
                .collect();
            let rest = if names.len() > SOME { ", ..." } else { "" };
            if !some.is_empty() {
                say(format!(
                    "#   {what}: {}{rest}",
                    some.join(", ").replace('\n', " ")
                ));
            }
        }
        let tables: BTreeMap<&str, _> = [("materials", materials)].into();
        let tables = toml::to_string(&tables).map_err(|why| why.to_string())?;
        say(format!("\n{tables}"));
        for (name, why) in missing {
            let why = why.replace('\n', " ");
            say(format!(
                "# The material {} of the file cannot be taken: {why}. Write it yourself:",
                quoted(name)
            ));
            say(format!(
                "# [materials.{}]\n# E = \"10000 MPa\"\n# nu = 0.2\n# density = \"1800 kg/m^3\"\n",
                quoted(name)
            ));
        }
        let surface = self.surfaces.keys().next();
        let face = surface.map_or_else(|| format!("{name}.SURFACE"), |s| format!("{name}.{s}"));
        say(format!(
            "# What is left to say:\n\
             # [interfaces.joint]\n# f_t = \"0.2 MPa\"\n# c = \"0.22 MPa\"\n# tan_phi = 0.75\n# mu = 0.75\n\
             # zeta = 4.38\n# xi = 1.1\n# u_k = \"0.36 mm\"\n# delta_k = \"0.4 mm\"\n#\n\
             # [[contacts]]  # without slave and master: all that touches at rest\n# interface = \"joint\"\n#\n\
             # [[supports]]\n# on = {0}\n#\n\
             # [[steps]]\n# kind = \"drive\"\n# face = {0}\n# direction = \"x\"\n# displacement = \"1 mm\"",
            quoted(&face)
        ));
        Ok(text)
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

/// Largest number of names that are listed.
const SOME: usize = 20;
