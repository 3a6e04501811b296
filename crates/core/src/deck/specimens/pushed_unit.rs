//! A unit pushed along its beds in a wall under stress (ASTM C1531): both of its head joints are free from the start,
//! on one side there is room for the jack.

use super::SpecimenDeck;
use super::flat_jack::{Body, contact, length};
use super::options::Specimen;
use super::text::{FASTENED, WallText, head, mm, point, tables, wall};

/// Courses of the wall below and above that of the unit.
const COURSES: u32 = 4;
/// Room for the jack over the length of a unit.
const ROOM: f64 = 0.5;
/// Elements along the unit, which slides over the courses.
const ALONG: f64 = 10.0;
/// Way of the unit [mm], and at most this part of the head joint before it.
const WAY: [f64; 2] = [2.0, 0.5];

/// A deck for each stress of the wall.
pub(super) fn pushed(specimen: &Specimen) -> Vec<SpecimenDeck> {
    SpecimenDeck::for_each_pressure(specimen, |pressure| text(specimen, pressure))
}

#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
fn text(specimen: &Specimen, pressure: f64) -> String {
    let p = mm(pressure);
    let [unit, thickness, height] = specimen.unit;
    let joint = specimen.joint;
    let mut text = head(
        specimen,
        &format!("Unit pushed at {p} MPa"),
        &format!(
            r"
v v v v v v v  {p} MPa
┌────────────┐
├────────────┤
│───┐ ┌──┐┌──│
│   │>│  ││  │  the unit is pushed along its beds; its head joints are free
│───┘ └──┘└──│
├────────────┤
└────────────┘
//////////////

ASTM C1531, with an estimate of the stress: one unit of a wall is freed at both ends and pushed by a jack. What is
beside it in its course stands as one piece on either side."
        ),
    );
    text.push_str(FASTENED);
    let low = f64::from(COURSES) * (height + joint) - joint;
    for (table, name, at) in [
        ("[wall]", "lower", 0.0),
        ("[[walls]]", "upper", low + height + 2.0 * joint),
    ] {
        let more = format!(
            "name = \"{name}\"\nat = {}\nclamped = false\n",
            point([0.0, 0.0, at])
        );
        let own = wall(
            specimen,
            WallText {
                length: length(specimen),
                courses: COURSES,
                mesh: None,
                more: &more,
            },
        );
        text.push_str(&own.replace("[wall]", table));
    }
    tables(
        &mut text,
        &format!(
            "[test] # what `wythe evaluate` needs\nkind = \"astm-c1531\"\nlength = \"{} mm\"\nthickness = \"{} mm\"\n\
             pressure = \"{p} MPa\"\n\n[[supports]]\non = \"lower.bottom\"\n",
            mm(unit),
            mm(thickness)
        ),
    );
    course(&mut text, specimen, low);
    tables(
        &mut text,
        &format!(
            r#"
[[probes]]
name = "slip"
on = "unit-pushed.right"
direction = "x"

[[steps]]
kind = "load"

[[steps.loads]]
name = "weight"
on = "upper.top"
pressure = "{p} MPa"

[[steps]]
kind = "drive"
face = "unit-pushed.left"
direction = "x"
displacement = "{} mm"
free = ["z"]
"#,
            mm(WAY[0].min(WAY[1] * joint))
        ),
    );
    text
}

/// The course of the unit between its beds. The mortar of the beds is fastened to the walls; the units slide on it.
#[expect(
    clippy::too_many_lines,
    reason = "most lines are the lists of bodies and contacts"
)]
fn course(text: &mut String, specimen: &Specimen, low: f64) {
    let ([unit, _, height], joint) = (specimen.unit, specimen.joint);
    let from = 0.5 * (length(specimen) - unit);
    let materials = &specimen.materials;
    text.push_str("\n# The course of the unit and the mortar of its beds.\n");
    for (name, from, to) in [
        ("left", 0.0, from - ROOM * unit),
        ("pushed", from, from + unit),
        ("right", from + unit + joint, length(specimen)),
    ] {
        for (part, material, low, high, layers) in [
            ("below", &materials.mortar, low, low + joint, 1),
            (
                "unit",
                &materials.unit,
                low + joint,
                low + joint + height,
                2,
            ),
            (
                "above",
                &materials.mortar,
                low + joint + height,
                low + 2.0 * joint + height,
                1,
            ),
        ] {
            let name = format!("{part}-{name}");
            Body {
                name: &name,
                material,
                ends: [from, to],
                heights: [low, high],
                elements: [
                    if name.ends_with("pushed") { ALONG } else { 0.0 },
                    f64::from(layers),
                ],
            }
            .write(text, specimen);
        }
        for (slave, master, interface) in [
            (
                format!("below-{name}.bottom"),
                "lower.top".to_owned(),
                "fastened",
            ),
            (
                format!("below-{name}.top"),
                format!("unit-{name}.bottom"),
                &materials.joint[..],
            ),
            (
                format!("above-{name}.bottom"),
                format!("unit-{name}.top"),
                &materials.joint[..],
            ),
            (
                format!("above-{name}.top"),
                "upper.bottom".to_owned(),
                "fastened",
            ),
        ] {
            contact(text, &slave, &master, interface);
        }
    }
}
