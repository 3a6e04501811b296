//! Dry walls on a tilting table.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{WallText, head, mm, tables, wall};

/// A dry wall on a table that tilts about an axis along its thickness.
#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
pub(super) fn table(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let [unit, thickness, height] = specimen.unit;
    let [length, up] = specimen.size.unwrap_or([4.0 * unit, 8.0 * height]);
    // Half units at the ends of every second course: whole units fill the length.
    let length = (length / unit).round().max(1.0) * unit;
    let courses = (up / height).round().max(1.0);
    let mut text = head(
        specimen,
        "Dry wall on a tilting table",
        r"
  ┌┬───┬───┬┐
  ├┴─┬─┴─┬─┴┤
  ├┬─┴─┬─┴─┬┤   the table turns about y until the wall falls
 ─┴┴───┴───┴┴─
     o

The tangent of the angle is the horizontal load factor that the wall carries.",
    );
    text.push_str(&wall(
        specimen,
        WallText {
            length,
            courses: courses as u32,
            mesh: None,
            more: "rigid = true # as stiff as the joints need\nclamped = false\n",
        },
    ));
    let ground = [length + unit, thickness, height]
        .map(|x| format!("\"{} mm\"", mm(x)))
        .join(", ");
    let sizes = [length, thickness, courses * height].map(mm);
    tables(
        &mut text,
        &format!(
            r#"
[[blocks]]
name = "table"
size = [{ground}]
at = ["-{} mm", 0, "-{} mm"]
material = "{}"
rigid = true

[[contacts]]
slave = "wall.bottom"
master = "table.top"
interface = "{}"

[[supports]]
on = "table"

[contact]
points = "corner" # blocks turn about their edges

[test] # what `wythe evaluate` needs
kind = "tilting-table"
length = "{} mm"
thickness = "{} mm"
height = "{} mm"
angle = "45 deg"

[[steps]]
kind = "gravity"

[[steps]]
kind = "tilt"
angle = "45 deg"
"#,
            mm(0.5 * unit),
            mm(height),
            specimen.materials.unit,
            specimen.materials.joint,
            sizes[0],
            sizes[1],
            sizes[2],
        ),
    );
    SpecimenDeck::only(text)
}
