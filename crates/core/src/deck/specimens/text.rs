//! Parts of the text of a deck.

use super::options::Specimen;
use crate::deck::templates::SCHEMA;
use std::fmt::Write as _;

/// A length as the deck writes it [mm]: at most four decimals.
pub(super) fn mm(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    // Rounding may leave a zero with a sign.
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// A point as the deck writes it [mm].
pub(super) fn point(x: [f64; 3]) -> String {
    format!("[{}, {}, {}]", mm(x[0]), mm(x[1]), mm(x[2]))
}

/// A box as the deck writes it: lower and upper corner [mm].
pub(super) fn within(low: [f64; 3], high: [f64; 3]) -> String {
    format!("[{}, {}]", point(low), point(high))
}

/// Begin of a deck: drawing and words of the test as comments, title, materials.
pub(super) fn head(specimen: &Specimen, title: &str, about: &str) -> String {
    let mut text = format!("#:schema ./{SCHEMA}\n#\n");
    for line in about.trim_matches('\n').lines() {
        text.push_str(if line.is_empty() { "#" } else { "# " });
        text.push_str(line);
        text.push('\n');
    }
    let _ = write!(
        text,
        "#\n# Run it, then `wythe evaluate` its folder, with those of the other decks of the test, if there are any.\n\
         # docs/reference/standard-tests.md has the definitions.\n\n\
         format = 1\ntitle = \"{title}\"\n\n{}\n",
        specimen.materials.text.trim_end()
    );
    text
}

/// Steel of platens, shoes and levers.
pub(super) const STEEL: &str = r#"
[materials.steel] # platens
E = "210 GPa"
nu = 0.3
"#;

/// The bond that fastens one part to another.
pub(super) const FASTENED: &str = r#"
[interfaces.fastened] # strong
f_t = "100 MPa"
c = "200 MPa"
tan_phi = 1
mu = 1
u_k = "1 mm"
delta_k = "1 mm"
zeta = 4.38
xi = 1.1
"#;

/// A wall of the specimen.
#[derive(Clone, Copy, Debug)]
pub(super) struct WallText<'a> {
    /// Length [mm].
    pub length: f64,
    /// Number of courses.
    pub courses: u32,
    /// Elements along, up and through a unit with its joints; the default of a wall without.
    pub mesh: Option<[u32; 3]>,
    /// Further keys, a line each.
    pub more: &'a str,
}

/// The table `[wall]`.
pub(super) fn wall(specimen: &Specimen, wall: WallText<'_>) -> String {
    let unit = specimen
        .unit
        .map(|size| format!("\"{} mm\"", mm(size)))
        .join(", ");
    let joint = mm(specimen.joint);
    let materials = &specimen.materials;
    let mut text = format!(
        "\n[wall]\nunit = [{unit}] # length, thickness, height\nbed_joint = \"{joint} mm\"\nhead_joint = \"{joint} mm\"\n\
         length = \"{} mm\"\ncourses = {}\nunit_material = \"{}\"\n",
        mm(wall.length),
        wall.courses,
        materials.unit
    );
    if specimen.joint > 0.0 {
        let _ = writeln!(text, "mortar_material = \"{}\"", materials.mortar);
    }
    let _ = writeln!(text, "interface = \"{}\"", materials.joint);
    if let Some([l, h, t]) = wall.mesh {
        let _ = writeln!(text, "mesh = [{l}, {h}, {t}] # length, height, thickness");
    }
    text.push_str(wall.more.trim_start_matches('\n'));
    text
}

/// Appends further tables, with an empty line before them.
pub(super) fn tables(text: &mut String, more: &str) {
    text.push('\n');
    text.push_str(more.trim_matches('\n'));
    text.push('\n');
}
