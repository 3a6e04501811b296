//! Walls under an airbag.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{WallText, head, mm, point, tables, wall, within};

/// Strip held at foot and head.
pub(super) fn one_way(specimen: &Specimen) -> Vec<SpecimenDeck> {
    deck(specimen, false)
}

/// Wall held along its four edges.
pub(super) fn two_way(specimen: &Specimen) -> Vec<SpecimenDeck> {
    deck(specimen, true)
}

#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
fn deck(specimen: &Specimen, two_way: bool) -> Vec<SpecimenDeck> {
    let ([unit, thickness, height], joint) = (specimen.unit, specimen.joint);
    let (pitch, bed) = (unit + joint, height + joint);
    let default = if two_way {
        [2000.0, 1500.0]
    } else {
        [2.0 * pitch - joint, 1200.0]
    };
    let [length, up] = specimen.size.unwrap_or(default);
    let length = ((length + joint) / pitch).round().max(1.0) * pitch - joint;
    let courses = ((up + joint) / bed).round().max(2.0);
    // The bed joint of the last course is part of the wall.
    let up = courses * bed - joint;
    let (title, how) = if two_way {
        (
            "Wall under an airbag, held along four edges",
            "Its four edges are held across: it bends two ways.",
        )
    } else {
        (
            "Strip under an airbag",
            "Foot and head are held across, and the foot stands on its whole bed: it bends one way.",
        )
    };
    // Without its weight the units above a crack lie loose.
    let (weight, gravity) = if specimen.materials.have_mass {
        ("Under its own weight.", "[[steps]]\nkind = \"gravity\"\n\n")
    } else {
        (
            "Without self-weight, as its materials have no density.",
            "# No step of gravity, as units or mortar have no density. With `density` in both of them, begin with:\n# \
             [[steps]]\n# kind = \"gravity\"\n\n",
        )
    };
    let about = format!(
        "
   /|  ┌─┐
    |->│ │
air |->│ │ the deflection of the middle steers the pressure past its peak
bag |->│ │
   \\|  └─┘
       ///

{how} {weight}"
    );
    let mut text = head(specimen, title, &about);
    text.push_str(&wall(
        specimen,
        WallText {
            length,
            courses: courses as u32,
            mesh: None,
            more: "clamped = false\n",
        },
    ));
    let t = thickness;
    let mut edges = vec![
        ([0.0, t, 0.0], [length, t, 0.0]),
        ([0.0, t, up], [length, t, up]),
    ];
    if two_way {
        edges.extend([
            ([0.0, t, 0.0], [0.0, t, up]),
            ([length, t, 0.0], [length, t, up]),
        ]);
    }
    let sizes = [length, thickness, up].map(mm);
    let [l, through, h] = &sizes;
    tables(
        &mut text,
        &format!(
            "[test] # what `wythe evaluate` needs\nkind = \"out-of-plane\"\nlength = \"{l} mm\"\nthickness = \"{through} mm\"\n\
             height = \"{h} mm\""
        ),
    );
    for (low, high) in edges {
        let edge = within(low, high);
        tables(
            &mut text,
            &format!(
                "[[supports]] # an edge, held across\non = \"wall.back\"\nbox = {edge}\nfixed = [\"y\"]"
            ),
        );
    }
    tables(
        &mut text,
        &format!(
            r#"
[[supports]] # foot
on = "wall.bottom"
fixed = ["x", "z"]

[[probes]]
name = "middle"
near = {}
direction = "y"

{gravity}[[steps]]
kind = "load"
procedure = "displacement_control"
control = {{ probe = "middle", displacement = "{} mm" }}
increments = {{ initial = 0.001, max = 0.025 }}
viscosity = 0.0005 # of step time: carries the snap of a unit; the peak is up to 3 % higher by it
stop = {{ below_peak = 0.5 }}

[[steps.loads]]
name = "airbag"
on = "wall.front"
pressure = "1 kPa"
"#,
            point([0.5 * length, t, 0.5 * up]),
            mm(0.1 * thickness),
        ),
    );
    SpecimenDeck::only(text)
}
