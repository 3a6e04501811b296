//! Wallettes bent by four lines: EN 1052-2.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{WallText, head, mm, point, wall, within};

/// Elements along, up and through a unit with its joints: a line of nodes at half the height of units.
const MESH: Option<[u32; 3]> = Some([5, 3, 3]);

/// A wallette bent between outer and inner bearings.
struct Bent {
    length: f64,
    courses: u32,
    /// Places of the outer bearings along the span [mm].
    outer: [f64; 2],
    /// Places of the inner bearings [mm].
    inner: [f64; 2],
    /// Whether the span is upright, so that beds open.
    upright: bool,
}

/// Both directions of EN 1052-2.
pub(super) fn both(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let parts = [
        ("parallel", across_beds(specimen)),
        ("normal", along_beds(specimen)),
    ];
    let deck = |(part, bent): (&str, Bent)| SpecimenDeck {
        part: part.to_owned(),
        text: deck(specimen, &bent),
    };
    parts.map(deck).into()
}

/// The upright strip alone.
pub(super) fn upright(specimen: &Specimen) -> Vec<SpecimenDeck> {
    SpecimenDeck::only(deck(specimen, &across_beds(specimen)))
}

/// Failure parallel to the beds: a strip of at least 400 mm between the bearings, with at least two beds between the
/// inner ones.
fn across_beds(specimen: &Specimen) -> Bent {
    let ([unit, _, height], joint) = (specimen.unit, specimen.joint);
    let bed = height + joint;
    let courses = (400.0 / bed).ceil().max(7.0) + 1.0;
    let middle = |course: f64| course * bed + 0.5 * height;
    // Inner bearings at about a third of the span, on the middle of a course.
    let third = ((courses - 1.0) / 3.0).round().max(1.0);
    Bent {
        length: 2.0 * unit + joint,
        courses: courses as u32,
        outer: [middle(0.0), middle(courses - 1.0)],
        inner: [middle(third), middle(courses - 1.0 - third)],
        upright: true,
    }
}

/// Failure normal to the beds: three and a half units long, at least four courses and 240 mm high.
fn along_beds(specimen: &Specimen) -> Bent {
    let ([unit, _, height], joint) = (specimen.unit, specimen.joint);
    let (pitch, bed) = (unit + joint, height + joint);
    let courses = (240.0 / bed).ceil().max(4.0);
    // Middles of units of the first course, and of head joints of the second one, half a unit from either end.
    let middle = |index: f64| index * pitch + 0.5 * unit;
    Bent {
        length: 4.0 * pitch - joint,
        courses: courses as u32,
        outer: [middle(0.0), middle(3.0)],
        inner: [middle(1.0), middle(2.0)],
        upright: false,
    }
}

fn deck(specimen: &Specimen, bent: &Bent) -> String {
    let [_, thickness, height] = specimen.unit;
    let up = f64::from(bent.courses) * (height + specimen.joint) - specimen.joint;
    let (title, how) = if bent.upright {
        (
            "Flexure, failure parallel to the beds",
            "The span is upright: beds open.",
        )
    } else {
        (
            "Flexure, failure normal to the beds",
            "The span is level: head joints open, beds slide or units tear.",
        )
    };
    let about = format!(
        "\n      v       v        inner bearings, pushed in -y\n┌─────────────────────┐\n└─────────────────────┘\n ^                   ^ outer bearings, held in y\n\nEN 1052-2: bending between four lines. {how} Without self-weight."
    );
    let mut text = head(specimen, title, &about);
    text.push_str(&wall(
        specimen,
        WallText {
            length: bent.length,
            courses: bent.courses,
            mesh: MESH,
            more: "clamped = false\n",
        },
    ));
    // Half of the width of a bearing: the lines of nodes at both sides of a head joint lie in it.
    let half = if bent.upright {
        0.5
    } else {
        0.5 * specimen.joint + 0.5
    };
    let line = |y: f64, at: f64, half: f64| {
        if bent.upright {
            [[0.0, y, at - half], [bent.length, y, at + half]]
        } else {
            [[at - half, y, 0.0], [at + half, y, up]]
        }
    };
    let bearing = |at: f64| {
        let [low, high] = line(0.0, at, half);
        format!(
            "\n[[supports]]\non = \"wall.front\"\nbox = {}\nfixed = [\"y\"]\n",
            within(low, high)
        )
    };
    text.push('\n');
    text.push_str(&test(bent, up, thickness));
    bent.outer
        .iter()
        .for_each(|at| text.push_str(&bearing(*at)));
    text.push_str(&holds(bent));
    text.push_str(&steps(bent, thickness, up, half));
    text
}

/// The table `[test]`: `length` is the width of the failure plane.
fn test(bent: &Bent, up: f64, thickness: f64) -> String {
    let width = if bent.upright { bent.length } else { up };
    let span = |at: [f64; 2]| mm(at[1] - at[0]);
    format!(
        "[test] # what `wythe evaluate` needs\nkind = \"en1052-2\"\nlength = \"{} mm\" # of the plane of failure\n\
         thickness = \"{} mm\"\nspans = [\"{} mm\", \"{} mm\"] # outer, inner\n",
        mm(width),
        mm(thickness),
        span(bent.outer),
        span(bent.inner)
    )
}

/// Supports that take no part in bending: against motion in the plane.
fn holds(bent: &Bent) -> String {
    let foot = within([0.0; 3], [bent.length, 0.0, 0.0]);
    let end = within([0.0; 3], [0.0, 0.0, 0.0]);
    format!(
        "\n[[supports]] # stands on its front edge\non = \"wall.bottom\"\nbox = {foot}\nfixed = [\"z\"]\n\n[[supports]]\non = \
         \"wall.bottom\"\nbox = {end}\nfixed = [\"x\"]\n"
    )
}

fn steps(bent: &Bent, thickness: f64, up: f64, half: f64) -> String {
    let middle = 0.5 * (bent.outer[0] + bent.outer[1]);
    let at = |along: f64, across: f64, y: f64| {
        point(if bent.upright {
            [across, y, along]
        } else {
            [along, y, across]
        })
    };
    let width = if bent.upright { bent.length } else { up };
    let mut text = format!(
        r#"
[[probes]]
name = "deflection"
near = {}
direction = "-y"

[[steps]]
kind = "load"
procedure = "displacement_control"
control = {{ probe = "deflection", displacement = "1 mm" }}
increments = {{ initial = 0.002, max = 0.02 }}
"#,
        at(middle, 0.5 * width, 0.0)
    );
    for (name, place) in ["first", "second"].into_iter().zip(bent.inner) {
        let (from, to) = (at(place, 0.0, thickness), at(place, width, thickness));
        text.push_str(&format!(
            "\n[[steps.loads]]\nname = \"{name}\"\non = \"wall.back\"\nfrom = {from}\nto = {to}\nwithin = \"{} mm\"\nforce = \
             [0, \"-1 kN\", 0]\n",
            mm(half + 0.01)
        ));
    }
    text
}
