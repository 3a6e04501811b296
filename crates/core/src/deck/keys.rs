//! An example of every key of a deck, shown by errors where the key is missing or cannot be read.

use strsim::levenshtein;

/// Last part of the path of a key, and a valid line.
pub const EXAMPLES: &[(&str, &str)] = &[
    ("format", "format = 1"),
    ("title", "title = \"Wall J7D\""),
    (
        "fidelity",
        "fidelity = \"auto\"  # or \"full\", \"elastic\"",
    ),
    ("materials", "[materials.brick]"),
    (
        "materials.kind",
        "kind = \"damage-plasticity\"  # the default; or \"drucker-prager\"",
    ),
    ("E", "E = \"16.7 GPa\""),
    ("nu", "nu = 0.15"),
    ("density", "density = \"1900 kg/m^3\""),
    (
        "tension",
        "tension = [[3.5, 0, 0], [0.3, 0.002, 0.95]]  # stress, inelastic strain, damage",
    ),
    (
        "compression",
        "compression = [[11, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]",
    ),
    ("dilation_angle", "dilation_angle = \"10 deg\""),
    ("eccentricity", "eccentricity = 0.1"),
    ("fb0_fc0", "fb0_fc0 = 1.16"),
    ("K_c", "K_c = 0.6667"),
    ("tension_recovery", "tension_recovery = 0"),
    ("compression_recovery", "compression_recovery = 1"),
    ("viscosity", "viscosity = \"0.01 s\"  # in step time"),
    ("reference_length", "reference_length = \"50 mm\""),
    ("crack_band", "crack_band = \"projected\"  # or \"volume\""),
    ("interpolation", "interpolation = \"eff1\"  # or \"lit\""),
    ("interfaces", "[interfaces.joint]"),
    (
        "interfaces.kind",
        "kind = \"cohesive-frictional\"  # or \"cap\"",
    ),
    ("f_m", "f_m = \"8.5 MPa\""),
    ("G_fc", "G_fc = \"5 N/mm\""),
    ("kappa_p", "kappa_p = \"0.09 mm\""),
    ("C_nn", "C_nn = 1"),
    ("C_ss", "C_ss = 9"),
    ("tan_psi", "tan_psi = 0.3"),
    ("sigma_u", "sigma_u = \"1.3 MPa\""),
    ("interfaces.delta", "delta = \"5 1/mm\""),
    ("f_t", "f_t = \"0.2 MPa\""),
    ("c", "c = \"0.22 MPa\""),
    ("phi", "phi = \"35 deg\""),
    ("psi", "psi = \"15 deg\"  # phi for associated flow"),
    ("G_c", "G_c = \"20 N/mm\"  # in compression"),
    ("tan_phi", "tan_phi = 0.75"),
    ("mu", "mu = 0.75"),
    ("zeta", "zeta = 4.38"),
    ("xi", "xi = 1.1"),
    ("u_k", "u_k = \"0.36 mm\"  # or G_I"),
    ("G_I", "G_I = \"12 N/m\"  # or u_k"),
    ("delta_k", "delta_k = \"0.4 mm\"  # or G_II"),
    ("G_II", "G_II = \"36 N/m\"  # or delta_k"),
    ("penalty_factor", "penalty_factor = 50"),
    ("normal_stiffness", "normal_stiffness = \"34000 N/mm^3\""),
    ("shear_stiffness", "shear_stiffness = \"14783 N/mm^3\""),
    ("coupling", "coupling = \"max\"  # or \"additive\""),
    (
        "scatter",
        "scatter = { cv = 0.3, seed = 1 }  # of the bond, from unit to unit",
    ),
    ("cv", "cv = 0.3  # standard deviation over mean"),
    ("seed", "seed = 1"),
    ("wall", "[wall]"),
    (
        "unit",
        "unit = [\"204 mm\", \"98 mm\", \"50 mm\"]  # length, thickness, height",
    ),
    ("bed_joint", "bed_joint = \"12.5 mm\""),
    ("head_joint", "head_joint = \"12.5 mm\""),
    ("length", "length = \"990 mm\""),
    ("courses", "courses = 18"),
    ("walls", "[[walls]]"),
    ("along", "along = \"x\"  # or \"y\""),
    ("collar_joint", "collar_joint = \"10 mm\""),
    (
        "head_filling",
        "head_filling = 0.5  # the part that is filled",
    ),
    (
        "filled_from",
        "filled_from = \"front\"  # or \"back\", \"both\"",
    ),
    ("rigid", "rigid = true"),
    (
        "bond",
        "bond = \"stretcher\"  # or \"stack\", \"header\", \"english\", \"english-cross\", \"flemish\", \"pattern\"",
    ),
    (
        "overlap",
        "overlap = \"70 mm\"  # of the units of neighbouring courses",
    ),
    ("leaves", "leaves = 2"),
    (
        "header_courses",
        "header_courses = 6  # one of headers in every six",
    ),
    (
        "pattern",
        "[[wall.pattern]]  # a course: leaves = [{ units = [\"204 mm\"], offset = 0 }]",
    ),
    ("height", "height = \"50 mm\""),
    (
        "pattern.leaves",
        "leaves = [{ units = [\"204 mm\"], offset = 0 }]",
    ),
    (
        "offset",
        "offset = \"-108 mm\"  # where the first unit begins",
    ),
    (
        "units",
        "units = [\"204 mm\", \"96 mm\"]  # over and over again",
    ),
    (
        "headers",
        "headers = [1]  # units that go through all leaves",
    ),
    (
        "openings",
        "openings = [{ from = \"360 mm\", to = \"630 mm\", sill = 6, courses = 6 }]",
    ),
    ("from", "from = \"360 mm\""),
    ("to", "to = \"630 mm\""),
    ("sill", "sill = 6  # courses below the opening"),
    (
        "lintel",
        "lintel = { bearing = \"100 mm\", material = \"concrete\" }",
    ),
    ("bearing", "bearing = \"100 mm\""),
    ("head_interface", "head_interface = \"joint\""),
    ("collar_interface", "collar_interface = \"joint\""),
    ("unit_material", "unit_material = \"brick\""),
    ("mortar_material", "mortar_material = \"mortar\""),
    ("interface", "interface = \"joint\""),
    (
        "mesh",
        "mesh = \"coarse\"  # or \"fine\", or [length, height, thickness] such as [5, 2, 2]",
    ),
    (
        "clamped",
        "clamped = { bottom_courses = 1, top_courses = 1 }  # or false",
    ),
    ("bottom_courses", "bottom_courses = 1"),
    ("top_courses", "top_courses = 1"),
    ("element", "[element]"),
    (
        "formulation",
        "formulation = \"incompatible\"  # or \"full\", \"b-bar\"",
    ),
    ("contact", "[contact]"),
    ("points", "points = \"gauss\"  # or \"corner\""),
    ("parts", "parts = [1, 3, 1]"),
    ("search_radius", "search_radius = \"5 mm\""),
    (
        "general",
        "general = \"dry\"  # an interface with f_t = 0 and c = 0",
    ),
    ("steps", "[[steps]]"),
    ("name", "name = \"push\""),
    (
        "kind",
        "kind = \"preload\"  # or \"drive\", \"gravity\", \"tilt\", \"free\", \"load\"",
    ),
    ("top_pressure", "top_pressure = \"2.12 MPa\""),
    (
        "direction",
        "direction = \"x\"  # or \"y\", \"z\", \"-x\", \"-y\", \"-z\"",
    ),
    ("displacement", "displacement = \"4 mm\""),
    (
        "cycles",
        "cycles = { amplitudes = [\"1 mm\", \"2 mm\"], repeat = 2 }  # each forth and back",
    ),
    ("amplitudes", "amplitudes = [\"1 mm\", \"2 mm\", \"4 mm\"]"),
    ("repeat", "repeat = 2"),
    (
        "amplitude",
        "amplitude = [[0, 0], [0.25, 1], [0.75, -1], [1, 0]]  # or a file: \"protocol.csv\"",
    ),
    ("loads", "[[steps.loads]]"),
    (
        "steps.on",
        "on = \"wall.front\"  # or a list of faces; a force may act on blocks, too",
    ),
    ("from", "from = [0, 0, \"500 mm\"]  # a line begins"),
    ("to", "to = [\"1 m\", 0, \"500 mm\"]  # it ends"),
    ("within", "within = \"1 mm\"  # of the line"),
    (
        "follower",
        "follower = true  # turns with the faces; false: as they were at rest",
    ),
    ("traction", "traction = [0, 0, \"-0.1 MPa\"]"),
    ("force", "force = [\"1 kN\", 0, 0]  # in all"),
    ("line_force", "line_force = [0, 0, \"-2 kN/m\"]"),
    ("vertical", "vertical = \"locked\"  # or \"free\""),
    (
        "increments",
        "increments = { initial = 0.005, max = 0.0125, min = 1e-6 }",
    ),
    ("initial", "initial = 0.005"),
    ("max", "max = 0.0125"),
    ("min", "min = 1e-6"),
    ("peak", "peak = 0.005"),
    ("duration", "duration = \"1 s\""),
    (
        "procedure",
        "procedure = \"auto\"  # or \"static\", \"implex\", \"quasi_static\", \"dynamic\", \"arc_length\", \
         \"dissipation\", \"displacement_control\"",
    ),
    (
        "tangent",
        "tangent = \"secant\"  # or \"consistent\", \"direct\"",
    ),
    (
        "control",
        "control = { probe = \"crown\", displacement = \"-5 mm\" }",
    ),
    (
        "stop",
        "stop = { below_peak = 0.8 }  # or displacement = \"3 mm\", or both",
    ),
    (
        "below_peak",
        "below_peak = 0.8  # of the step's largest force",
    ),
    (
        "tolerance",
        "tolerance = { residual = 5e-3, max_iterations = 25 }",
    ),
    ("residual", "residual = 5e-3"),
    ("max_iterations", "max_iterations = 25"),
    ("every", "every = 5"),
    ("mcap", "mcap = true"),
    ("scene_every", "scene_every = 1"),
    ("experiment", "experiment = \"test.csv\""),
    ("alpha", "alpha = -0.05  # -1/3 to 0"),
    (
        "rayleigh",
        "rayleigh = { mass = \"0.5 s^-1\", stiffness = \"1e-5 s\" }",
    ),
    ("mass", "mass = \"0.5 s^-1\""),
    ("stiffness", "stiffness = \"1e-5 s\""),
    ("ground", "ground = { x = \"record.csv\" }"),
    (
        "ground_unit",
        "ground_unit = \"g\"  # of 1 in the records; or such as \"1 m/s^2\"",
    ),
    (
        "ground_factor",
        "ground_factor = { x = 1.2 }  # times the records",
    ),
    (
        "ground_start",
        "ground_start = \"3 s\"  # of the records, where the step begins",
    ),
    ("x", "x = \"record.csv\""),
    ("y", "y = \"record.csv\""),
    ("z", "z = \"record.csv\""),
    ("face", "face = \"block.top\"  # or a list of faces"),
    ("pressure", "pressure = \"0.3 MPa\""),
    ("free", "free = [\"z\"]"),
    ("spring", "spring = \"pull\""),
    ("gravity", "gravity = \"9.81 m/s^2\""),
    ("angle", "angle = \"30 deg\""),
    ("axis", "axis = \"y\"  # or \"-y\", \"x\", \"-x\""),
    ("blocks", "[[blocks]]"),
    (
        "size",
        "size = [\"200 mm\", \"100 mm\", \"50 mm\"]  # x, y, z",
    ),
    ("at", "at = [0, 0, \"50 mm\"]  # of its lowest corner"),
    ("rotate", "rotate = { axis = \"y\", angle = \"30 deg\" }"),
    (
        "corners",
        "corners = [[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0], [0, 0, 9], [9, 0, 9], [9, 9, 9], \
         [0, 9, 9]]",
    ),
    ("nodes", "nodes = \"cylinder.csv\"  # x, y, z in mm a line"),
    ("material", "material = \"stone\""),
    ("blocks.mesh", "mesh = [4, 2, 2]  # elements along x, y, z"),
    ("velocity", "velocity = [\"1 m/s\", 0, 0]"),
    ("stack", "stack = 6  # on each other"),
    ("copies", "copies = [1, 1, 6]  # along x, y, z"),
    ("pitch", "pitch = [0, 0, \"175 mm\"]"),
    ("contacts", "[[contacts]]"),
    ("slave", "slave = \"block.bottom\"  # the finer side"),
    ("master", "master = \"base.top\""),
    ("supports", "[[supports]]"),
    ("on", "on = \"base\"  # a block, or a face: \"base.bottom\""),
    ("fixed", "fixed = [\"x\", \"y\", \"z\"]"),
    (
        "box",
        "box = [[0, 53, 0], [795, 53, 0]]  # only the nodes in it: lower and upper corner",
    ),
    ("springs", "[[springs]]"),
    (
        "springs.stiffness",
        "stiffness = [\"20 N/mm\", 0, 0]  # along x, y, z",
    ),
    ("beams", "[[beams]]"),
    ("beam", "beam = \"beam\"  # of [[beams]]"),
    ("depth", "depth = \"200 mm\""),
    ("rotation", "rotation = \"free\"  # or \"level\""),
    ("beams.on", "on = \"wall.top\"  # level faces"),
    ("symmetry", "[[symmetry]]"),
    ("normal", "normal = \"x\"  # or \"y\", \"z\""),
    ("symmetry.at", "at = \"480 mm\"  # along the normal"),
    (
        "keep",
        "keep = \"below\"  # or \"above\": the side that is modelled",
    ),
    ("probes", "[[probes]]"),
    ("near", "near = [\"100 mm\", 0, \"50 mm\"]"),
    (
        "minus",
        "minus = \"base.top\"  # or { near = [0, 0, \"50 mm\"] }",
    ),
    ("quantity", "quantity = \"displacement\"  # or \"velocity\""),
    ("imports", "[[imports]]"),
    (
        "file",
        "file = \"wall.inp\"  # of Abaqus, or a .msh of Gmsh",
    ),
    (
        "imports.units",
        "units = \"N, m, s\"  # of force, length and time in the file",
    ),
    (
        "imports.materials",
        "materials = { BRICKS = \"brick\", JOINTS = \"mortar\" }  # by sets of the file",
    ),
    ("arch", "[arch]"),
    ("radius", "radius = \"1 m\"  # or span"),
    ("span", "span = \"2 m\"  # or radius"),
    ("rise", "rise = \"400 mm\"  # with span, or angle"),
    ("thickness", "thickness = \"110 mm\""),
    ("width", "width = \"200 mm\""),
    ("voussoirs", "voussoirs = 11"),
    (
        "arch.mesh",
        "mesh = [1, 1, 1]  # along the arch, its width, its thickness",
    ),
];

/// Sections that may occur several times, each with a header of its own.
pub(super) const LISTS: [&str; 10] = [
    "walls", "blocks", "imports", "contacts", "supports", "springs", "beams", "symmetry", "probes",
    "steps",
];

/// Tables that contain named tables.
pub(super) const NAMED: [&str; 2] = ["materials", "interfaces"];

/// Sections that occur once.
pub(super) const TABLES: [&str; 5] = ["wall", "arch", "element", "contact", "output"];

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
    let found = |wanted: &str| EXAMPLES.iter().find(|(key, _)| *key == wanted);
    found(&in_table)
        .or_else(|| found(name))
        .map(|(_, line)| *line)
}

/// The known name nearest to a misspelt one, if it is near enough.
pub(super) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
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
