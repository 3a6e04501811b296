//! Materials and joint of a specimen: from the catalogue, or from a file of the user.

use super::SpecimenError;
use toml::{Table, Value};

/// Tables of materials and joints, and the names that the specimen uses.
#[derive(Clone, Debug)]
pub(super) struct Materials {
    /// Tables `[materials.X]` and `[interfaces.X]` as TOML.
    pub text: String,
    /// Material of the units.
    pub unit: String,
    /// Material of the mortar.
    pub mortar: String,
    /// Interface of the joints.
    pub joint: String,
    /// Whether units and mortar have a density.
    pub have_mass: bool,
}

/// Materials of a specimen if no file is given: a clay brick and a mortar of the catalogue.
const BY_NAME: &str = r#"# Values by name, from the catalogue; `wythe check` prints them with their sources. Replace what you know better.
[materials.unit]
name = "clay brick, solid"

[materials.mortar]
name = "M5"

[interfaces.joint]
name = "M5 on clay"
"#;

/// Materials of a dry specimen if no file is given.
const DRY: &str = r#"[materials.unit]
name = "clay brick, solid"

[interfaces.joint] # dry
f_t = 0
c = 0
tan_phi = 0.7
mu = 0.7
normal_stiffness = "100 N/mm^3"
shear_stiffness = "40 N/mm^3"
"#;

/// Names that the material of the units may have, in order of preference.
const UNITS: [&str; 4] = ["unit", "brick", "block", "stone"];

impl Materials {
    /// Reads a file with the tables `[materials]` and `[interfaces]`; without one the catalogue serves.
    ///
    /// # Errors
    /// Text that is no TOML, or without the names that the specimen needs.
    pub(super) fn new(file: Option<&str>, dry: bool) -> Result<Self, SpecimenError> {
        let Some(file) = file else {
            return Ok(Self {
                text: (if dry { DRY } else { BY_NAME }).to_owned(),
                unit: "unit".to_owned(),
                mortar: "mortar".to_owned(),
                joint: "joint".to_owned(),
                have_mass: true,
            });
        };
        let wrong = |message: String, help: &str| SpecimenError::new("--materials", message, help);
        let mut root: Table = file
            .parse()
            .map_err(|why: toml::de::Error| wrong(why.to_string(), "mend the file first"))?;
        let mut tables = Table::new();
        let mut names = |section: &str| -> Vec<String> {
            let Some(Value::Table(table)) = root.remove(section) else {
                return Vec::new();
            };
            let names = table.keys().cloned().collect();
            tables.insert(section.to_owned(), Value::Table(table));
            names
        };
        let (materials, interfaces) = (names("materials"), names("interfaces"));
        let find = |all: &[String], wanted: &[&str], what: &str| {
            let found = wanted
                .iter()
                .find(|name| all.iter().any(|own| own == *name));
            found.map(|name| (*name).to_owned()).ok_or_else(|| {
                let message = format!("there is no {what}; the file has: {}", all.join(", "));
                wrong(message, "name [materials.unit] (or brick, block, stone), [materials.mortar], [interfaces.joint]")
            })
        };
        let mortar = if dry {
            Ok(String::new())
        } else {
            find(&materials, &["mortar"], "material mortar")
        };
        let mut taken = Self {
            have_mass: false,
            unit: find(&materials, &UNITS, "material of the units")?,
            mortar: mortar?,
            joint: find(&interfaces, &["joint", "dry"], "interface joint")?,
            text: String::new(),
        };
        let has_mass = |name: &String| {
            let material = tables.get("materials").and_then(|all| all.get(name));
            // A material of the catalogue has a density.
            material
                .is_some_and(|material| material.get("density").or(material.get("name")).is_some())
        };
        taken.have_mass = has_mass(&taken.unit) && (dry || has_mass(&taken.mortar));
        let text = toml::to_string(&tables)
            .map_err(|why| wrong(why.to_string(), "mend the file first"))?;
        Ok(Self { text, ..taken })
    }
}
