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

/// Keys of a joint that are kept when it is laid dry.
const DRY_KEYS: [&str; 5] = [
    "name",
    "tan_phi",
    "mu",
    "normal_stiffness",
    "shear_stiffness",
];

/// Stiffnesses of a dry joint whose file gives none, as in [`DRY`].
const STIFFNESSES: [(&str, &str); 2] = [
    ("normal_stiffness", "100 N/mm^3"),
    ("shear_stiffness", "40 N/mm^3"),
];

/// Density of units whose file gives none, on a tilting table.
const DENSITY: &str = "1800 kg/m^3";

fn wrong(message: String, help: &str) -> SpecimenError {
    SpecimenError::new("--materials", message, help)
}

impl Materials {
    /// Reads a file with the tables `[materials]` and `[interfaces]`; without one the catalogue serves. The joint of a
    /// dry specimen loses its bond.
    ///
    /// # Errors
    /// Text that is no TOML, or without the names that the specimen needs; a dry joint without friction.
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
        let mut tables: Table = file.parse().map_err(|why| unread(file, &why))?;
        tables.retain(|section, value| {
            matches!(section, "materials" | "interfaces") && value.is_table()
        });
        let unit = find(&tables, "materials", &UNITS, "material of the units")?;
        let mortar = if dry {
            String::new()
        } else {
            find(&tables, "materials", &["mortar"], "material mortar")?
        };
        let joint = find(&tables, "interfaces", &["joint", "dry"], "interface joint")?;
        let notes = if dry {
            lay_dry(&mut tables, &unit, &joint)?
        } else {
            String::new()
        };
        let have_mass = has_mass(&tables, &unit) && (dry || has_mass(&tables, &mortar));
        let text = toml::to_string(&tables)
            .map_err(|why| wrong(why.to_string(), "mend the file first"))?;
        Ok(Self {
            text: format!("{notes}{text}"),
            unit,
            mortar,
            joint,
            have_mass,
        })
    }
}

/// The error of a file that is no TOML, with its line.
fn unread(file: &str, why: &toml::de::Error) -> SpecimenError {
    let start = why.span().map_or(0, |span| span.start);
    let before = file.get(..start).unwrap_or_default();
    let line = 1 + before.matches('\n').count();
    wrong(
        format!("line {line}: {}", why.message()),
        "mend the file first",
    )
}

/// The first of the wanted names that a section has.
fn find(
    tables: &Table,
    section: &str,
    wanted: &[&str],
    what: &str,
) -> Result<String, SpecimenError> {
    let all = tables.get(section).and_then(Value::as_table);
    let has = |name: &&&str| all.is_some_and(|all| all.contains_key(**name));
    let found = wanted.iter().find(has);
    found.map(|name| (*name).to_owned()).ok_or_else(|| {
        let names: Vec<&str> = all.into_iter().flat_map(Table::keys).map(String::as_str).collect();
        wrong(
            format!("there is no {what}; the file has: {}", names.join(", ")),
            "name [materials.unit] (or brick, block, stone), [materials.mortar], [interfaces.joint]",
        )
    })
}

/// Whether a material has a density, of its own or of the catalogue.
fn has_mass(tables: &Table, material: &str) -> bool {
    let found = tables.get("materials").and_then(|all| all.get(material));
    found.is_some_and(|found| found.get("density").or(found.get("name")).is_some())
}

/// Takes the bond off the joint, and adds stiffnesses and a density where the file has none. Returns these changes as
/// comments of the deck.
fn lay_dry(tables: &mut Table, unit: &str, joint: &str) -> Result<String, SpecimenError> {
    let mut notes = format!(
        "# The wall is dry: [interfaces.{joint}] keeps the friction of the file, and no bond (f_t = c = 0).\n"
    );
    let missing_mass = !has_mass(tables, unit);
    if let Some(joint_table) = table(tables, "interfaces", joint) {
        joint_table.retain(|key, _| DRY_KEYS.contains(&key));
        add_friction(joint_table, joint)?;
        if add_stiffnesses(joint_table, joint)? {
            notes += "# The file gives it no stiffness: that of the deck without --materials is taken.\n";
        }
        for key in ["f_t", "c"] {
            joint_table.insert(key.to_owned(), Value::Integer(0));
        }
    }
    if missing_mass && let Some(unit_table) = table(tables, "materials", unit) {
        unit_table.insert("density".to_owned(), DENSITY.into());
        notes += &format!(
            "# The file gives [materials.{unit}] no density: {DENSITY} is taken. The angle does not depend on it.\n"
        );
    }
    Ok(notes)
}

fn table<'a>(tables: &'a mut Table, section: &str, name: &str) -> Option<&'a mut Table> {
    let all = tables.get_mut(section)?.as_table_mut()?;
    all.get_mut(name)?.as_table_mut()
}

/// Adds `tan_phi` to a dry joint without it: only `mu` counts, but the deck needs both.
///
/// # Errors
/// A joint without `mu`.
fn add_friction(table: &mut Table, joint: &str) -> Result<(), SpecimenError> {
    // The catalogue has both.
    if table.contains_key("name") {
        return Ok(());
    }
    let Some(mu) = table.get("mu").cloned() else {
        return Err(wrong(
            format!("[interfaces.{joint}] has no mu, the friction of dry joints"),
            "add it, such as mu = 0.7",
        ));
    };
    table.entry("tan_phi").or_insert(mu);
    Ok(())
}

/// Adds the stiffnesses of [`DRY`] to a joint without any; returns whether it did.
///
/// # Errors
/// A joint with one of the two.
fn add_stiffnesses(table: &mut Table, joint: &str) -> Result<bool, SpecimenError> {
    let given = STIFFNESSES.map(|(key, _)| table.contains_key(key));
    match given {
        [true, true] => Ok(false),
        [false, false] => {
            for (key, value) in STIFFNESSES {
                table.insert(key.to_owned(), value.into());
            }
            Ok(true)
        }
        _ => Err(wrong(
            format!("[interfaces.{joint}] has one of normal_stiffness and shear_stiffness"),
            "give both or neither",
        )),
    }
}
