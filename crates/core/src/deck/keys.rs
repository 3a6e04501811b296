//! An example of every key of a deck, shown by errors where the key is missing or cannot be read.

use strsim::levenshtein;

/// Examples of all keys, one a line, behind the last part of the path of its key and ` => ` where the line does not
/// begin with that.
const EXAMPLES: &str = r#"format = 1
title = "Wall J7D"
fidelity = "auto"  # or "full", "elastic"
strategy = "detailed"  # or "simplified", "rigid", "limit"
[simplified]
simplified.mesh => mesh = [2, 1, 1]
unit_cracks = true  # by an interface in the middle of each unit
[materials.brick]
materials.kind => kind = "damage-plasticity"  # the default; or "drucker-prager"
materials.name => name = "clay brick, solid"  # of the catalogue
f_b = "20 MPa"  # compressive strength of the unit by test, beside name
E = "16.7 GPa"
nu = 0.15
density = "1900 kg/m^3"
tension = [[3.5, 0, 0], [0.3, 0.002, 0.95]]  # stress, inelastic strain, damage
compression = [[11, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]
materials.f_t => f_t = "2 MPa"
G_ft = "0.06 N/mm"  # with f_t, instead of the table tension
f_c = "20 MPa"
materials.G_fc => G_fc = "22 N/mm"  # with f_c, instead of the table compression
dilation_angle = "10 deg"
eccentricity = 0.1
fb0_fc0 = 1.16
K_c = 0.6667
tension_recovery = 0
compression_recovery = 1
viscosity = "0.01 s"  # in step time
reference_length = "50 mm"
crack_band = "projected"  # or "volume"
interpolation = "eff1"  # or "lit"
[interfaces.joint]
interfaces.kind => kind = "cohesive-frictional"  # or "cap"
interfaces.name => name = "M5 on clay"  # of the catalogue
f_m = "8.5 MPa"
G_fc = "5 N/mm"
kappa_p = "0.09 mm"
C_nn = 1
C_ss = 9
closes = false
tan_psi = 0.3
sigma_u = "1.3 MPa"
interfaces.delta => delta = "5 1/mm"
f_t = "0.2 MPa"
c = "0.22 MPa"
phi = "35 deg"
psi = "15 deg"  # phi for associated flow
G_c = "20 N/mm"  # in compression
tan_phi = 0.75
mu = 0.75
zeta = 4.38
xi = 1.1
u_k = "0.36 mm"  # or G_I
G_I = "12 N/m"  # or u_k
delta_k = "0.4 mm"  # or G_II
G_II = "36 N/m"  # or delta_k
penalty_factor = 50
normal_stiffness = "34000 N/mm^3"
shear_stiffness = "14783 N/mm^3"
coupling = "max"  # or "additive"
scatter = { cv = 0.3, seed = 1 }  # of the bond, from unit to unit
cv = 0.3  # standard deviation over mean
seed = 1
[wall]
unit = ["204 mm", "98 mm", "50 mm"]  # length, thickness, height
bed_joint = "12.5 mm"
head_joint = "12.5 mm"
length = "990 mm"
courses = 18
[[walls]]
along = "x"  # or "y"
collar_joint = "10 mm"
head_filling = 0.5  # the part that is filled
filled_from = "front"  # or "back", "both"
rigid = true
bond = "stretcher"  # or "stack", "header", "english", "english-cross", "flemish", "pattern"
overlap = "70 mm"  # of the units of neighbouring courses
leaves = 2
header_courses = 6  # one of headers in every six
snap = "25 mm"  # shorter pieces join the units beside them; 0: none
storeys = ["2800 mm", "2700 mm"]  # heights from floor to floor
pattern => [[wall.pattern]]  # a course: leaves = [{ units = ["204 mm"], offset = 0 }]
height = "50 mm"
pattern.leaves => leaves = [{ units = ["204 mm"], offset = 0 }]
offset = "-108 mm"  # where the first unit begins
units = ["204 mm", "96 mm"]  # over and over again
headers = [1]  # units that go through all leaves
wall.corners => corners = "interlocked"  # or "butted": it ends at the other wall
walls.corners => corners = "butted"  # or "interlocked": both pass through in turn
openings = [{ from = "360 mm", to = "630 mm", sill = 6, courses = 6 }]
from = "360 mm"
to = "630 mm"
sill = 6  # courses below the opening
lintel = { bearing = "100 mm", material = "concrete" }
bearing = "100 mm"
head_interface = "joint"
collar_interface = "joint"
unit_material = "brick"
mortar_material = "mortar"
expanded = true  # units to the middle of their joints
crack_interface = "brick crack"
interface = "joint"
mesh = "coarse"  # or "fine", or [length, height, thickness] such as [5, 2, 2]
clamped = { bottom_courses = 1, top_courses = 1 }  # or false
bottom_courses = 1
top_courses = 1
[element]
formulation = "incompatible"  # or "full", "b-bar"
[contact]
points = "auto"  # or "gauss", "corner"
parts = [1, 3, 1]
search_radius = "5 mm"
general = "dry"  # an interface with f_t = 0 and c = 0
[[steps]]
name = "push"
kind = "preload"  # or "drive", "gravity", "tilt", "free", "load"
top_pressure = "2.12 MPa"
direction = "x"  # or "y", "z", "-x", "-y", "-z"
displacement = "4 mm"
cycles = { amplitudes = ["1 mm", "2 mm"], repeat = 2 }  # each forth and back
amplitudes = ["1 mm", "2 mm", "4 mm"]
repeat = 2
amplitude = [[0, 0], [0.25, 1], [0.75, -1], [1, 0]]  # or a file: "protocol.csv"
loads => [[steps.loads]]
steps.on => on = "wall.front"  # or a list of faces; a force may act on blocks, too
from = [0, 0, "500 mm"]  # a line begins
to = ["1 m", 0, "500 mm"]  # it ends
within = "1 mm"  # of the line
follower = true  # turns with the faces; false: as they were at rest
traction = [0, 0, "-0.1 MPa"]
force = ["1 kN", 0, 0]  # in all
line_force = [0, 0, "-2 kN/m"]
vertical = "locked"  # or "free"
increments = { initial = 0.005, max = 0.0125, min = 1e-6 }
initial = 0.005
max = 0.0125
min = 1e-6
peak = 0.005
duration = "1 s"
procedure = "auto"  # or "static", "implex", "quasi_static", "dynamic", "arc_length", "dissipation", "displacement_control"
tangent = "secant"  # or "consistent", "direct"
control = { probe = "crown", displacement = "-5 mm" }
stop = { below_peak = 0.8 }  # or displacement = "3 mm", or both
below_peak = 0.8  # of the step's largest force
tolerance = { residual = 5e-3, max_iterations = 25 }
residual = 5e-3
max_iterations = 25
every = 5
mcap = true
scene_every = 1
experiment = "test.csv"
alpha = -0.05  # -1/3 to 0
rayleigh = { mass = "0.5 s^-1", stiffness = "1e-5 s" }
mass = "0.5 s^-1"
stiffness = "1e-5 s"
ratio = 0.05  # of `rayleigh`, at its frequencies
frequencies = ["8 Hz", "40 Hz"]  # `wythe modes` finds those of the wall
ground = { x = "record.csv" }
ground_unit = "g"  # of 1 in the records; or such as "1 m/s^2"
ground_factor = { x = 1.2 }  # times the records
ground_start = "3 s"  # of the records, where the step begins
x = "record.csv"
y = "record.csv"
z = "record.csv"
face = "block.top"  # or a list of faces
pressure = "0.3 MPa"
free = ["z"]
spring = "pull"
gravity = "9.81 m/s^2"
angle = "30 deg"
axis = "y"  # or "-y", "x", "-x"
[[blocks]]
size = ["200 mm", "100 mm", "50 mm"]  # x, y, z
at = [0, 0, "50 mm"]  # of its lowest corner
rotate = { axis = "y", angle = "30 deg" }
corners = [[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0], [0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9]]
nodes = "cylinder.csv"  # x, y, z in mm a line
blocks.file => file = "stones.obj"  # or .ply, .stl, .json of COMPAS, .dxf with thickness
blocks.units => units = "m"  # of the lengths in the file
blocks.thickness => thickness = "200 mm"  # of outlines in a DXF file
not_convex = "error"  # or "hull"
material = "stone"
blocks.mesh => mesh = [4, 2, 2]  # elements along x, y, z
velocity = ["1 m/s", 0, 0]
stack = 6  # on each other
copies = [1, 1, 6]  # along x, y, z
pitch = [0, 0, "175 mm"]
[[contacts]]
slave = "block.bottom"  # the finer side
master = "base.top"
[[supports]]
on = "base"  # a block, or a face: "base.bottom"
fixed = ["x", "y", "z"]
box = [[0, 53, 0], [795, 53, 0]]  # only the nodes in it: lower and upper corner
[[springs]]
springs.stiffness => stiffness = ["20 N/mm", 0, 0]  # along x, y, z
[[ties]]
ties.points => points = [[0, "50 mm", "1 m"], ["2 m", "50 mm", "1 m"]]  # its ends; more where it is bonded
ties.along => along = "wall"  # whose bed joints have the bars
ties.courses => courses = [3, 6]  # from 0: bars in the bed joint on each
area = "314 mm^2"  # of all bars together
diameter = "20 mm"  # of a bar
bars = 2
ties.E => E = "210 GPa"
f_y = "355 MPa"
hardening = "2 GPa"  # slope over the plastic strain
rupture = 0.05  # strain at which it breaks
compression = true  # false: it becomes slack
prestress = "20 kN"  # of all bars together
ties.step => step = "stress"  # in which it is installed and stressed
ties.bond => bond = "anchored"  # at its ends; or "bonded" along its length
unbonded = "120 mm"  # free length of a bonded tie at each joint
[[floors]]
floors.on => on = ["front.storey-1.top", "back.storey-1.top"]  # faces that carry it
load = "3 kN/m^2"  # weight over its area in plan
mass = "4 tonne"  # in all
floors.rigid => rigid = true  # a concrete slab
axial = "10 kN/mm"  # E A of the joists over their distance
shear = "5 kN/mm"  # G t
spacing = "600 mm"  # of the springs that stand for joists
[[settlements]]
settlements.along => along = "x"  # the shape varies along it
trough = { centre = "3 m", inflection = "1.5 m" }  # 1 in its middle
tilt = { from = "0 m", to = "6 m" }  # 0 at the first, 1 at the second
table = { at = ["0 m", "2 m", "6 m"], values = [0, 1, 0.2] }
settlement = "ground"  # of [[settlements]]
[[beams]]
beam = "beam"  # of [[beams]]
depth = "200 mm"
rotation = "free"  # or "level"
beams.on => on = "wall.top"  # level faces
[[layers]]
layers.on => on = "wall.front"  # faces of one plane
layers.thickness => thickness = "10 mm"
[[symmetry]]
normal = "x"  # or "y", "z"
symmetry.at => at = "480 mm"  # along the normal: the middle of the wall
keep = "below"  # or "above": the side that is modelled
[[probes]]
near = ["100 mm", 0, "50 mm"]
minus = "base.top"  # or { near = [0, 0, "50 mm"] }
quantity = "displacement"  # or "velocity", "drift"
gauge = [[0, 0, 0], [0, 0, "100 mm"]]  # moving apart is positive
[[sections]]
through = [0, 0, "650 mm"]  # a point of the plane
sections.normal => normal = "z"  # or "-x" ..., or a vector
of = "wall"  # bodies that are cut
sections.box => box = [[0, 0, 0], ["400 mm", "120 mm", "2 m"]]  # lowest and highest corner
piers = "front"  # a wall with openings
[test]
test.kind => kind = "en1052-3"
test.length => length = "250 mm"
test.thickness => thickness = "120 mm"
test.height => height = "1200 mm"
spans = ["400 mm", "130 mm"]  # outer, inner
lever = "480 mm"  # from the load to the tension face
test.pressure => pressure = "0.2 MPa"
test.angle => angle = "45 deg"
[[imports]]
file = "wall.inp"  # of Abaqus, or a .msh of Gmsh
imports.units => units = "N, m, s"  # of force, length and time in the file
imports.materials => materials = { BRICKS = "brick", JOINTS = "mortar" }  # by sets of the file
[arch]
radius = "1 m"  # or span
span = "2 m"  # or radius
rise = "400 mm"  # with span, or angle
thickness = "110 mm"
width = "200 mm"
voussoirs = 11
arch.mesh => mesh = [1, 1, 1]  # along the arch, its width, its thickness"#;

/// Last part of the path of each key, and a valid line.
pub fn examples() -> impl Iterator<Item = (&'static str, &'static str)> {
    EXAMPLES.lines().map(|line| {
        let name = line.trim_start_matches('[').split([' ', '.', ']']).next();
        let own = (name.unwrap_or_default(), line);
        line.split_once(" => ").unwrap_or(own)
    })
}

/// Sections that may occur several times, each with a header of its own.
pub(super) const LISTS: [&str; 15] = [
    "walls",
    "blocks",
    "imports",
    "contacts",
    "supports",
    "springs",
    "settlements",
    "ties",
    "floors",
    "beams",
    "layers",
    "symmetry",
    "probes",
    "sections",
    "steps",
];

/// Tables that contain named tables.
pub(super) const NAMED: [&str; 2] = ["materials", "interfaces"];

/// Sections that occur once.
pub(super) const TABLES: [&str; 7] = [
    "wall",
    "arch",
    "element",
    "contact",
    "output",
    "test",
    "simplified",
];

/// Section of a path: `steps.1` of `steps.1.increments.max`, `wall` of `wall.unit.0`.
pub(super) fn section_of(path: &str) -> &str {
    let root = path.split('.').next().unwrap_or(path);
    if !LISTS.contains(&root) && !NAMED.contains(&root) {
        return root;
    }
    let end = path.match_indices('.').nth(1).map(|(i, _)| i);
    &path[..end.unwrap_or(path.len())]
}

/// Advice for the key `name`, the last part of a path: an example line.
pub(super) fn example(name: &str) -> String {
    example_at(name)
}

/// Advice for the key at `path`; some names have different meanings in different tables.
pub(super) fn example_at(path: &str) -> String {
    match line_at(path) {
        Some(line) => format!("write it like this: {line}"),
        None => "docs/reference/deck.md lists every key, its type, unit and range".to_owned(),
    }
}

/// An example line for the key at `path`.
pub(super) fn line_at(path: &str) -> Option<&'static str> {
    let mut parts = path.split('.').filter(|s| s.parse::<usize>().is_err());
    let first = parts.next().unwrap_or_default();
    let name = parts.next_back().unwrap_or(first);
    let in_table = format!("{first}.{name}");
    let found = |wanted: &str| examples().find(|(key, _)| *key == wanted);
    found(&in_table)
        .or_else(|| found(name))
        .map(|(_, line)| line)
}

/// The known name nearest to a misspelt one, if it is near enough.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let allowed = ((length + 1) / 3).max(1);
    if length > LONGEST_MEANT {
        return None;
    }
    known
        .filter(|k| k.chars().count().abs_diff(length) <= allowed)
        .take(MOST_MEANT)
        .map(|k| (levenshtein(&name.to_lowercase(), &k.to_lowercase()), k))
        .filter(|(distance, _)| *distance <= allowed)
        .min()
        .map(|(_, k)| k)
}

/// Longer names are not compared with others.
const LONGEST_MEANT: usize = 100;

/// Largest number of known names that are compared: advice must not take longer than the check.
const MOST_MEANT: usize = 2000;
