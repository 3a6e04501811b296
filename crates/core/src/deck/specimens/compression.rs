//! The wallette in compression of EN 1052-1.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{WallText, head, mm, point, tables, wall};

/// A wallette between platens: two units long and at least five courses high.
#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
pub(super) fn wallette(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let ([unit, thickness, height], joint) = (specimen.unit, specimen.joint);
    let bed = height + joint;
    let [length, up] = specimen.size.unwrap_or([2.0 * unit + joint, 0.0]);
    let units = ((length + joint) / (unit + joint)).round().max(2.0);
    let length = units * (unit + joint) - joint;
    // EN 1052-1: at least five courses, at least as high as long and as three times as thick.
    let least = up.max(length).max(3.0 * thickness);
    let courses = ((least + joint) / bed).ceil().max(5.0);
    let up = courses * bed - joint;
    let mut text = head(
        specimen,
        "Wallette in compression",
        r"
  v v v v v  driven down; the platen stays level
┌───────────┐
├──┬──────┬─┤
├──┴──┬───┴─┤ o
├──┬──┴───┬─┤ |  gauge over whole courses, about a third of the height
├──┴──┬───┴─┤ o
└─────┴─────┘
/////////////

EN 1052-1: strength and modulus of masonry at right angles to its beds. The gauge spans whole courses, from the top of a
unit to that of another one, so that it measures units and beds in their proportion.",
    );
    text.push_str(&wall(
        specimen,
        WallText {
            length,
            courses: courses as u32,
            mesh: None,
            more: "clamped = { bottom_courses = 0, top_courses = 0 }\n",
        },
    ));
    let sizes = [length, thickness, up].map(mm);
    let [low, high] = gauge(specimen, up);
    // Beside the middle by a quarter of a unit, where head joints of all courses are equally far.
    let x = 0.5 * length + 0.25 * (unit + joint);
    let gauge = |y: f64| format!("[{}, {}]", point([x, y, low]), point([x, y, high]));
    // Far beyond the strain at the strength of masonry, some thousandths.
    let way = mm(0.02 * up);
    tables(
        &mut text,
        &format!(
            r#"
[test] # what `wythe evaluate` needs
kind = "en1052-1"
length = "{} mm"
thickness = "{} mm"
height = "{} mm"

[[probes]]
name = "front"
gauge = {}
direction = "z"

[[probes]]
name = "back"
gauge = {}
direction = "z"

[[steps]]
kind = "drive"
direction = "-z"
displacement = "{way} mm"
stop = {{ below_peak = 0.6 }}
"#,
            sizes[0],
            sizes[1],
            sizes[2],
            gauge(0.0),
            gauge(thickness),
        ),
    );
    SpecimenDeck::only(text)
}

/// Ends of the gauge [mm]: whole courses apart, as near to a third of the height `up` as that allows, in the middle of
/// it. Both are tops of units, where every mesh has nodes.
fn gauge(specimen: &Specimen, up: f64) -> [f64; 2] {
    let (height, bed) = (specimen.unit[2], specimen.unit[2] + specimen.joint);
    let span = (up / 3.0 / bed).round().max(1.0);
    let first = ((0.5 * up - height) / bed - 0.5 * span).round().max(0.0);
    [first, first + span].map(|course| course * bed + height)
}
