//! Walls in their plane: diagonal compression, and shear under compression.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{FASTENED, STEEL, WallText, head, mm, point, tables, wall};

/// Whole units and courses nearest to a size [mm]: length, number of courses, height up to the last unit.
fn fitted(specimen: &Specimen, default: [f64; 2]) -> (f64, u32, f64) {
    let ([unit, _, height], joint) = (specimen.unit, specimen.joint);
    let (pitch, bed) = (unit + joint, height + joint);
    let [length, up] = specimen.size.unwrap_or(default);
    // Half units end every second course.
    let length = (2.0 * (length + joint) / pitch).round().max(2.0) * 0.5 * pitch - joint;
    let courses = ((up + joint) / bed).round().max(2.0);
    (length, courses as u32, courses * bed - joint)
}

/// A square wall pressed along its diagonal: it stands on a corner.
#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
pub(super) fn diagonal(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let (length, courses, height) = fitted(specimen, [1200.0, 1200.0]);
    let thickness = specimen.unit[1];
    // The corners loaded lie one above the other.
    let angle = length.atan2(height);
    let turned = |[x, y, z]: [f64; 3]| {
        let (sin, cos) = angle.sin_cos();
        [x * cos - z * sin, y, x * sin + z * cos]
    };
    let title = if specimen.name == "astm-e519" {
        "ASTM E519"
    } else {
        "RILEM LUM B6"
    };
    let mut text = head(
        specimen,
        &format!("Diagonal compression, {title}"),
        r"
      | driven down
     \v/  shoe
     / \
    /   \     the gauges lie along both diagonals
    \   /
     \ /
     / \  shoe
    /////

A square wall on one of its corners, pressed along its diagonal by steel shoes. Without self-weight.",
    );
    text.push_str(STEEL);
    text.push_str(FASTENED);
    text.push_str(&wall(
        specimen,
        WallText {
            length,
            courses,
            mesh: None,
            more: &format!(
                "clamped = false\nrotate = {{ axis = \"-y\", angle = \"{:.6} deg\" }}\n",
                angle.to_degrees()
            ),
        },
    ));
    let sizes = [length, thickness, height].map(mm);
    tables(
        &mut text,
        &format!(
            "[test] # what `wythe evaluate` needs\nkind = \"astm-e519\"\nlength = \"{} mm\"\nthickness = \"{} mm\"\nheight = \"{} mm\"",
            sizes[0], sizes[1], sizes[2]
        ),
    );
    // Length of bearing along each edge: 152 mm on a wall of 1.2 m in ASTM E519.
    let bearing = 152.0 / 1200.0 * length.min(height);
    let shoes = Shoes {
        bearing,
        length,
        height,
        thickness,
        angle,
    };
    text.push_str(&shoes.text(turned));
    let half = 0.25 * (length * length + height * height).sqrt();
    let middle = turned([0.5 * length, 0.0, 0.5 * height]);
    let end = |x: f64, z: f64| point([middle[0] + x, 0.5 * thickness, middle[2] + z]);
    tables(
        &mut text,
        &format!(
            r#"
[[probes]] # half of the diagonal that is pressed; shorter is negative
name = "vertical"
gauge = [{}, {}]

[[probes]] # half of the other one
name = "horizontal"
gauge = [{}, {}]

[[steps]]
kind = "drive"
face = ["shoe-right.right", "shoe-top.top"]
direction = "-z"
displacement = "{} mm"
stop = {{ below_peak = 0.5 }}
"#,
            end(0.0, -half),
            end(0.0, half),
            end(-half, 0.0),
            end(half, 0.0),
            mm(0.006 * length.min(height)),
        ),
    );
    SpecimenDeck::only(text)
}

/// Loading shoes: two plates at each of the two corners.
struct Shoes {
    bearing: f64,
    length: f64,
    height: f64,
    thickness: f64,
    /// Rotation of the wall [rad].
    angle: f64,
}

impl Shoes {
    /// Blocks, contacts and supports; `turned` places a point of the wall.
    #[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
    fn text(&self, turned: impl Fn([f64; 3]) -> [f64; 3]) -> String {
        let Self {
            bearing: b,
            length: l,
            height: h,
            thickness: t,
            angle,
        } = *self;
        let plate = 0.2 * b;
        // Name, face on the wall, face of the wall, place in the wall's axes, size.
        let plates = [
            (
                "shoe-left",
                "right",
                "left",
                [-plate, 0.0, 0.0],
                [plate, t, b],
            ),
            (
                "shoe-bottom",
                "top",
                "bottom",
                [0.0, 0.0, -plate],
                [b, t, plate],
            ),
            (
                "shoe-right",
                "left",
                "right",
                [l, 0.0, h - b],
                [plate, t, b],
            ),
            ("shoe-top", "bottom", "top", [l - b, 0.0, h], [b, t, plate]),
        ];
        let mut text = String::new();
        for (name, own, other, at, size) in plates {
            let mesh = size.map(|s| {
                if s == plate {
                    1
                } else {
                    (s / (0.13 * b)).round().clamp(2.0, 8.0) as u32
                }
            });
            let size = size.map(|x| format!("\"{} mm\"", mm(x))).join(", ");
            tables(
                &mut text,
                &format!(
                    r#"
[[blocks]]
name = "{name}"
size = [{size}]
at = {}
rotate = {{ axis = "-y", angle = "{:.6} deg" }}
material = "steel"
mesh = [{}, {}, {}]

[[contacts]]
slave = "{name}.{own}"
master = "wall.{other}"
interface = "fastened"
"#,
                    point(turned(at)),
                    angle.to_degrees(),
                    mesh[0],
                    mesh[1],
                    mesh[2],
                ),
            );
        }
        tables(
            &mut text,
            "[[supports]] # lower shoe\non = [\"shoe-left.left\", \"shoe-bottom.bottom\"]",
        );
        text
    }
}

/// How the top of a wall in shear moves.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Top {
    Level,
    Turning,
    ToAndFro,
}

/// Double bending: the top stays level under its load.
pub(super) fn double_bending(specimen: &Specimen) -> Vec<SpecimenDeck> {
    shear(specimen, Top::Level)
}

/// Cantilever: the top turns freely under its load.
pub(super) fn cantilever(specimen: &Specimen) -> Vec<SpecimenDeck> {
    shear(specimen, Top::Turning)
}

/// Double bending, to and fro.
pub(super) fn cyclic(specimen: &Specimen) -> Vec<SpecimenDeck> {
    shear(specimen, Top::ToAndFro)
}

fn shear(specimen: &Specimen, top: Top) -> Vec<SpecimenDeck> {
    let (length, courses, height) = fitted(specimen, [1000.0, 1300.0]);
    let deck = |pressure: f64| {
        let p = mm(pressure);
        let how = match top {
            Top::Level => "Double bending: the top stays level under its load.",
            Top::Turning => "Cantilever: the beam on top may turn.",
            Top::ToAndFro => {
                "Double bending, to and fro: drifts of 0.05, 0.1, 0.2, 0.3, 0.4 and 0.6 %, each twice."
            }
        };
        let mut text = head(
            specimen,
            &format!("Shear under {p} MPa"),
            &format!(
                "
 v v v v v  {p} MPa, constant
═══════════──> x
┌─┬───┬───┐
├─┴─┬─┴─┬─┤
├─┬─┴─┬─┴─┤
└─┴───┴───┘
/////////// held

{how} Without self-weight."
            ),
        );
        let more = if top == Top::Turning {
            "clamped = false\n".to_owned()
        } else {
            "clamped = { bottom_courses = 0, top_courses = 0 }\n".to_owned()
        };
        text.push_str(&wall(
            specimen,
            WallText {
                length,
                courses,
                mesh: None,
                more: &more,
            },
        ));
        text.push_str(&steps(specimen, top, &p, [length, height]));
        text
    };
    SpecimenDeck::for_each_pressure(specimen, deck)
}

/// Depth of the beam of a cantilever [mm].
const BEAM_DEPTH: f64 = 200.0;

/// Drifts of the cyclic protocol [%].
const DRIFTS: [f64; 6] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.6];

/// The table `[test]`, the beam and the steps.
#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
fn steps(specimen: &Specimen, top: Top, p: &str, [length, height]: [f64; 2]) -> String {
    // The middle of a beam that turns is what moves.
    let driven_at = if top == Top::Turning {
        height + 0.5 * BEAM_DEPTH
    } else {
        height
    };
    let sizes = [length, specimen.unit[1], driven_at].map(mm);
    let mut text = String::new();
    tables(
        &mut text,
        &format!(
            "[test] # what `wythe evaluate` needs\nkind = \"shear-compression\"\nlength = \"{} mm\"\nthickness = \"{} mm\"\nheight = \
             \"{} mm\"\npressure = \"{p} MPa\"",
            sizes[0], sizes[1], sizes[2]
        ),
    );
    let way = mm(0.01 * height);
    if top == Top::Turning {
        tables(
            &mut text,
            &format!(
                r#"
[[supports]]
on = "wall.bottom"

[[beams]]
name = "beam"
on = "wall.top"
depth = "{BEAM_DEPTH} mm"
rotation = "free"
interface = "{}"

[[steps]]
kind = "preload"
beam = "beam"
pressure = "{p} MPa"

[[steps]]
kind = "drive"
beam = "beam"
direction = "x"
displacement = "{way} mm"
stop = {{ below_peak = 0.6 }}
"#,
                specimen.materials.joint
            ),
        );
        return text;
    }
    let drive = if top == Top::Level {
        format!("displacement = \"{way} mm\"\nstop = {{ below_peak = 0.6 }}")
    } else {
        let drifts = DRIFTS
            .map(|d| format!("\"{} mm\"", mm(0.01 * d * height)))
            .join(", ");
        format!("cycles = {{ amplitudes = [{drifts}], repeat = 2 }}")
    };
    tables(
        &mut text,
        &format!(
            r#"
[[steps]]
kind = "preload"
top_pressure = "{p} MPa"

[[steps]]
kind = "drive"
direction = "x"
{drive}
vertical = "free"
"#
        ),
    );
    text
}
