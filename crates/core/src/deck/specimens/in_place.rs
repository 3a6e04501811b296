//! The in-place shear test of ASTM C1531: one unit of a wall is pushed along its beds.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{WallText, head, mm, part, tables, wall};

/// Course of the unit that is pushed, from 0; even courses begin with whole units.
const COURSE: f64 = 4.0;

/// Walls of five units and nine courses. The unit in the middle has lost its left neighbour, where the jack stands,
/// and its right head joint.
pub(super) fn shear(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let deck = |pressure: f64| SpecimenDeck {
        part: part(specimen, pressure),
        text: deck(specimen, pressure),
    };
    specimen.pressures.iter().copied().map(deck).collect()
}

#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
fn deck(specimen: &Specimen, pressure: f64) -> String {
    let ([unit, thickness, _], joint) = (specimen.unit, specimen.joint);
    let p = mm(pressure);
    let pitch = unit + joint;
    let mut text = head(
        specimen,
        &format!("In-place shear at {p} MPa"),
        &format!(
            "
 v v v v v v v v  {p} MPa, constant
┌───┬────┬────┬─┐
├─┬─┴──┬─┴──┬─┴─┤
│ │jack│unit  │ │  pushed away from the jack; its other head joint is empty
├─┴─┬──┴─┬──┴─┬─┤
└───┴────┴────┴─┘
/////////////////

ASTM C1531: a unit is pushed along its beds by a jack in place of its neighbour."
        ),
    );
    let course = COURSE as u32;
    // The unit itself lies between both openings.
    let [jack, test] = [pitch, 2.0 * pitch];
    let more = format!(
        "openings = [ # of one course: the jack, and the empty head joint\n  {{ from = \"{} mm\", to = \"{} mm\", sill = {course}, \
         courses = 1 }},\n  {{ from = \"{} mm\", to = \"{} mm\", sill = {course}, courses = 1 }},\n]\nclamped = {{ bottom_courses = \
         0, top_courses = 0 }}\n",
        mm(jack),
        mm(test),
        mm(test + unit),
        mm(test + pitch),
    );
    text.push_str(&wall(
        specimen,
        WallText {
            length: 5.0 * pitch - joint,
            courses: 9,
            mesh: Some([5, 3, 2]),
            more: &more,
        },
    ));
    tables(
        &mut text,
        &format!(
            r#"
[test] # what `wythe evaluate` needs
kind = "astm-c1531"
length = "{} mm"
thickness = "{} mm"
pressure = "{p} MPa"

[[springs]] # the jack, on the end of the unit
name = "jack"
on = "wall-{course}-1.left"
stiffness = ["1 MN/mm", 0, 0]

[[probes]] # against the courses below and above
name = "slip"
on = "wall-{course}-1"
minus = ["wall-{}-2", "wall-{}-2"]
direction = "x"

[[steps]]
kind = "preload"
top_pressure = "{p} MPa"

[[steps]]
kind = "drive"
spring = "jack"
direction = "x"
displacement = "1 mm"
"#,
            mm(unit),
            mm(thickness),
            course - 1,
            course + 1,
        ),
    );
    text
}
