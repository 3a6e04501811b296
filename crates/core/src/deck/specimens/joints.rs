//! Specimens of one or two bed joints: couplets and triplets.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{FASTENED, STEEL, WallText, head, mm, point, tables, wall, within};

/// Elements of a unit with its joints: length, height, thickness.
const MESH: Option<[u32; 3]> = Some([5, 4, 2]);

/// Only the faces are held and driven.
const FACES: &str = "bond = \"stack\"\nclamped = { bottom_courses = 0, top_courses = 0 }\n";

const LOOSE: &str = "bond = \"stack\"\nclamped = false\n";

fn courses(specimen: &Specimen, courses: u32, more: &str) -> String {
    let length = specimen.unit[0];
    wall(
        specimen,
        WallText {
            length,
            courses,
            mesh: MESH,
            more,
        },
    )
}

/// The table `[test]`, with the sizes of the bed.
fn test(specimen: &Specimen, kind: &str, more: &str) -> String {
    let [length, thickness, _] = specimen.unit.map(mm);
    format!(
        "[test] # what `wythe evaluate` needs\nkind = \"{kind}\"\nlength = \"{length} mm\"\nthickness = \"{thickness} mm\"\n{more}"
    )
}

/// Couplet pulled apart between platens that stay parallel.
pub(super) fn tension(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let mut text = head(
        specimen,
        "Couplet in tension",
        r"
   ^ z, driven; the platen stays parallel
┌──┴───┐
│ unit │
╞══════╡ the joint opens and softens
│ unit │
└──────┘
//////// held

Tensile strength and fracture energy of a bed joint, after van der Pluijm (1997).",
    );
    text.push_str(&courses(specimen, 2, FACES));
    tables(&mut text, &test(specimen, "couplet-tension", ""));
    tables(
        &mut text,
        r#"
[[steps]] # finely over the peak
name = "peak"
kind = "drive"
direction = "z"
displacement = "0.02 mm"

[[steps]]
name = "softening"
kind = "drive"
direction = "z"
displacement = "0.4 mm"
"#,
    );
    SpecimenDeck::only(text)
}

/// Couplets sheared at constant pressure between platens that stay parallel.
pub(super) fn direct_shear(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let deck = |pressure: f64| {
        let p = mm(pressure);
        let mut text = head(
            specimen,
            &format!("Direct shear at {p} MPa"),
            &format!(
                r"
 v v v v  {p} MPa, constant
┌───────┐
│  unit │──> x, driven; the platen stays parallel and may rise
╞═══════╡
│  unit │
└───────┘
///////// held

Cohesion, friction, residual friction and fracture energy of a bed joint in shear, after van der Pluijm (1993)."
            ),
        );
        text.push_str(&courses(specimen, 2, FACES));
        let of = format!("pressure = \"{p} MPa\"\n");
        tables(&mut text, &test(specimen, "direct-shear", &of));
        tables(
            &mut text,
            &format!(
                r#"
[[probes]] # uplift by dilatancy
name = "uplift"
on = "wall-1-0"
minus = "wall-0-0"
direction = "z"

[[steps]]
kind = "preload"
top_pressure = "{p} MPa"

[[steps]]
kind = "drive"
direction = "x"
displacement = "2 mm"
vertical = "free"
"#
            ),
        );
        text
    };
    SpecimenDeck::for_each_pressure(specimen, deck)
}

/// Triplets of EN 1052-3, lying: the beds are level, the middle unit is pushed along them.
#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
pub(super) fn triplets(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let [length, thickness, height] = specimen.unit;
    let bed = height + specimen.joint;
    let top = 2.0 * bed;
    let third = height / 3.0;
    let lower = within([length, 0.0, height - third], [length, thickness, height]);
    let upper = within([length, 0.0, top], [length, thickness, top + third]);
    let deck = |pressure: f64| {
        let p = mm(pressure);
        let mut text = head(
            specimen,
            &format!("Triplet at {p} MPa"),
            &format!(
                r"
    v v v v v  {p} MPa, constant
    ┌───────┐
    │  unit │|/ held near the joint
    ╞═══════╡
x ─>│  unit │     driven
    ╞═══════╡
    │  unit │|/ held near the joint
    └───────┘
    /////////

EN 1052-3, procedure A: the middle unit of three is pushed out under a constant precompression. The specimen lies
here, its joints level; the standard has it upright. Without self-weight that is the same."
            ),
        );
        text.push_str(&courses(specimen, 3, LOOSE));
        let of = format!("pressure = \"{p} MPa\"\n");
        tables(&mut text, &test(specimen, "en1052-3", &of));
        tables(
            &mut text,
            &format!(
                r#"
[[supports]] # lower platen
on = "wall.bottom"
fixed = ["y", "z"]

[[supports]] # ends of the outer units, in the third of their height nearest to the joint
on = "wall-0-0.right"
box = {lower}
fixed = ["x"]

[[supports]]
on = "wall-2-0.right"
box = {upper}
fixed = ["x"]

[[probes]]
name = "slip"
on = "wall-1-0"
minus = ["wall-0-0", "wall-2-0"]
direction = "x"

[[steps]]
kind = "preload"
face = "wall.top"
pressure = "{p} MPa"
free = ["x"]

[[steps]]
kind = "drive"
face = "wall-1-0.left"
direction = "x"
displacement = "2 mm"
free = ["z"]
"#
            ),
        );
        text
    };
    SpecimenDeck::for_each_pressure(specimen, deck)
}

/// The bond wrench of EN 1052-5: a lever clamped to the upper of two units.
#[expect(clippy::too_many_lines, reason = "most lines are the text of a deck")]
pub(super) fn wrench(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let [length, thickness, height] = specimen.unit;
    let bed = height + specimen.joint;
    // Arm of the load from the tension face.
    let lever = 4.0 * thickness;
    let arm = lever - thickness;
    let mut text = head(
        specimen,
        "Bond wrench",
        r"
 F, down
 v            ┌──────┐
 └────lever───┤ unit │
              ╞══════╡ opens at its far face
           //┤ unit │
           // └──────┘
           ///////// clamped

EN 1052-5: the load on a lever tears the upper unit off. The lever has no weight here, nor has the unit.",
    );
    text.push_str(STEEL);
    text.push_str(FASTENED);
    text.push_str(&courses(specimen, 2, LOOSE));
    let of = format!(
        "lever = \"{} mm\" # from the load to the tension face\n",
        mm(lever)
    );
    tables(&mut text, &test(specimen, "en1052-5", &of));
    let held = within([0.0; 3], [length, thickness, 0.5 * height]);
    let [end, tip] = [0.0, length].map(|x| point([x, -arm, bed + height]));
    let ends = [
        point([0.5 * length, thickness, 0.5 * height]),
        point([0.5 * length, thickness, bed + 0.5 * height]),
    ];
    let size = [length, arm, height]
        .map(|x| format!("\"{} mm\"", mm(x)))
        .join(", ");
    tables(
        &mut text,
        &format!(
            r#"
[[blocks]]
name = "lever"
size = [{size}]
at = [0, "-{arm} mm", "{bed} mm"]
material = "steel"
mesh = [4, 3, 3]

[[contacts]]
slave = "lever.back"
master = "wall-1-0.front"
interface = "fastened"

[[supports]] # the frame around the lower half of the lower unit
on = "wall-0-0"
box = {held}

[[probes]] # across the joint at the tension face
name = "opening"
gauge = [{}, {}]

[[steps]]
kind = "load"
procedure = "displacement_control"
control = {{ probe = "opening", displacement = "0.1 mm" }}
increments = {{ initial = 0.005, max = 0.02 }}

[[steps.loads]]
name = "load"
on = "lever"
from = {end}
to = {tip}
force = [0, 0, "-100 N"]
"#,
            ends[0],
            ends[1],
            arm = mm(arm),
            bed = mm(bed),
        ),
    );
    SpecimenDeck::only(text)
}
