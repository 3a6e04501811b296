//! Block scenes with rejected decks.

use crate::common::blocks::{Bad, GRAVITY, HEAD, PAIR, deck, refuses};
use wythe::model::Model;

/// Replaced text of the valid scene, its replacement, the key of the error, part of it, part of the advice.
const BAD: &[Bad] = &[
    (
        "name = \"top\"",
        "name = \"a.b\"",
        "blocks.1.name",
        "is no name",
        "a dot parts",
    ),
    (
        "name = \"top\"",
        "name = \"base\"",
        "blocks.1.name",
        "two blocks named `base`",
        "of its own",
    ),
    (
        "size = [200, 100, 80]",
        "size = [200, 0, 80]",
        "blocks.1.size.1",
        "0 is not positive",
        "above 0",
    ),
    (
        "size = [200, 100, 80]",
        "size = [200, \"1 s\", 80]",
        "blocks.1.size.1",
        "expected a length",
        "size = [",
    ),
    (
        "size = [200, 100, 80]\n",
        "",
        "blocks.1.size",
        "neither `size` nor `corners`",
        "size = [",
    ),
    (
        "size = [200, 100, 80]",
        "sise = [200, 100, 80]",
        "blocks.1.sise",
        "not a known key",
        "`size`",
    ),
    (
        "points = \"corner\"",
        "points = \"corner\"\nparts = [1, 0, 1]",
        "contact.parts",
        "1 to 16 parts",
        "six points",
    ),
    (
        "points = \"corner\"",
        "points = \"corner\"\nparts = [1, 2]",
        "contact.parts",
        "",
        "parts = [1, 3, 1]",
    ),
    (
        "mesh = [4, 2, 1]",
        "mesh = [4, 0, 1]",
        "blocks.1.mesh",
        "leaves no element",
        "along x, y, z",
    ),
    (
        "mesh = [4, 2, 1]",
        "mesh = \"coarse\"",
        "blocks.1.mesh",
        "expected an array",
        "along x, y, z",
    ),
    (
        "mesh = [4, 2, 1]",
        "mesh = [4000, 4000, 4000]",
        "blocks.1.mesh",
        "too many",
        "coarsen",
    ),
    (
        "mesh = [4, 2, 1]",
        "copies = [2, 1, 1]",
        "blocks.1.pitch",
        "the same place",
        "pitch =",
    ),
    (
        "mesh = [4, 2, 1]",
        "copies = [0, 1, 1]",
        "blocks.1.copies",
        "0 copies",
        "at least 1",
    ),
    (
        "mesh = [4, 2, 1]",
        "pitch = [1, 1, 1]",
        "blocks.1.pitch",
        "no copies",
        "copies =",
    ),
    (
        "size = [200, 100, 80]",
        "corners = [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]]",
        "blocks.1.corners",
        "not in order",
        "above them",
    ),
    (
        "mesh = [4, 2, 1]",
        "rotate = { axis = \"up\", angle = 3 }",
        "blocks.1.rotate.axis",
        "`up` is not a known choice",
        "x, y, z",
    ),
    (
        "mesh = [4, 2, 1]",
        "rotate = { axis = 3, angle = 3 }",
        "blocks.1.rotate.axis",
        "expected one of the choices, in quotes",
        "axis = ",
    ),
    (
        "velocity = [\"1 m/s\"",
        "velocity = [\"1 m\"",
        "blocks.1.velocity.0",
        "expected a velocity",
        "velocity =",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"topp.bottom\"",
        "contacts.0.slave",
        "no block named `topp`",
        "did you mean `top`?",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"top.under\"",
        "contacts.0.slave",
        "no face `under`",
        "bottom (-z)",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"top\"",
        "contacts.0.slave",
        "`top` is no face",
        "top.top",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"top.top\"",
        "contacts.0",
        "no master faces it",
        "look at each other",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = []",
        "contacts.0.slave",
        "the list is empty",
        "name a block",
    ),
    (
        "slave = \"top.bottom\"\n",
        "",
        "contacts.0.slave",
        "`slave` is missing",
        "neither",
    ),
    (
        "master = \"base.top\"",
        "master = \"top.top\"",
        "contacts.0",
        "meet itself",
        "different blocks",
    ),
    (
        "interface = \"dry\"",
        "interface = \"dri\"",
        "contacts.0.interface",
        "no interface named `dri`",
        "`dry`",
    ),
    (
        "interface = \"dry\"",
        "interface = \"smooth\"",
        "interfaces.smooth",
        "neither bond nor friction",
        "give mu",
    ),
    (
        "on = \"base\"",
        "on = \"bass\"",
        "supports.0.on",
        "no block named `bass`",
        "did you mean `base`?",
    ),
    (
        "on = \"base\"",
        "on = \"base\"\nfixed = []",
        "supports.0.fixed",
        "holds no direction",
        "fixed =",
    ),
    (
        "on = \"base\"",
        "on = \"base\"\nfixed = [\"up\"]",
        "supports.0.fixed.0",
        "not a known choice",
        "known here: x, y, z",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\ngravity = \"9.81 m/s\"",
        "steps.0.gravity",
        "expected an acceleration",
        "m/s^2",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\ngravity = 0",
        "steps.0.gravity",
        "0 is not positive",
        "above 0",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"tilt\"\nangle = 3",
        "steps.0.kind",
        "no gravity yet",
        "a step before",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"tilt\"",
        "steps.0.angle",
        "`angle` is missing",
        "angle =",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\nangle = 500",
        "steps.0.angle",
        "half a turn",
        "angle =",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\naxis = \"z\"",
        "steps.0.axis",
        "tilts nothing",
        "axis =",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\nface = \"top.top\"",
        "steps.0.face",
        "belongs to a preload or drive",
        "of its own",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"preload\"\ntop_pressure = 1",
        "steps.0.top_pressure",
        "of a clamped wall",
        "`pressure`",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"preload\"\nface = \"top.top\"\npressure = -1",
        "steps.0.pressure",
        "pulls",
        "compression",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nface = \"base.top\"\ndirection = \"x\"\ndisplacement = 1",
        "steps.0.face",
        "holds all of base.top in x, in which step 0 (drive) drives it",
        "another face",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nspring = \"s\"\ndirection = \"x\"\ndisplacement = 1",
        "steps.0.spring",
        "no spring named `s`",
        "[[springs]]",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nface = \"top.top\"\ndirection = \"x\"\ndisplacement = 1\nfree = [\"x\"]",
        "steps.0.free",
        "cannot be free",
        "other directions",
    ),
    (
        "density = \"2000 kg/m^3\"",
        "",
        "materials.stone.density",
        "has no mass",
        "density =",
    ),
];

#[test]
fn bad_scenes_name_the_key_and_the_fix() {
    refuses(&format!("{HEAD}{PAIR}{GRAVITY}"), BAD);
}

/// A load on the upper block.
const LOAD: &str =
    "[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"a\"\non = \"top.top\"\npressure = 1\n";

const BAD_LOADS: &[Bad] = &[
    (
        "name = \"a\"",
        "name = \"a b\"",
        "steps.1.loads.0.name",
        "no name for a column",
        "a letter",
    ),
    (
        "name = \"a\"",
        "name = \"force\"\n# ",
        "steps.1.loads.0.name",
        "two columns named `force_kN`",
        "of its own",
    ),
    (
        "name = \"a\"\n",
        "",
        "steps.1.loads.0.name",
        "missing",
        "name = ",
    ),
    ("pressure = 1", "", "steps.1.loads.0", "no value", "one of"),
    (
        "pressure = 1",
        "pressure = 1\nforce = [1, 0, 0]",
        "steps.1.loads.0",
        "2 values",
        "one of",
    ),
    (
        "pressure = 1",
        "pressure = \"1 N\"",
        "steps.1.loads.0.pressure",
        "expected a pressure",
        "pressure =",
    ),
    (
        "pressure = 1",
        "force = [\"1 MPa\", 0, 0]",
        "steps.1.loads.0.force.0",
        "expected a force",
        "force =",
    ),
    (
        "on = \"top.top\"",
        "on = \"top\"",
        "steps.1.loads.0.on",
        "is no face",
        "top.top",
    ),
    (
        "on = \"top.top\"",
        "on = \"tip.top\"",
        "steps.1.loads.0.on",
        "no block named `tip`",
        "`top`",
    ),
    (
        "on = \"top.top\"\n",
        "",
        "steps.1.loads.0.on",
        "missing",
        "on =",
    ),
    (
        "on = \"top.top\"",
        "on = \"top.top\"\nnear = [0, 0, 0]",
        "steps.1.loads.0",
        "acts on faces",
        "force = [..]",
    ),
    (
        "on = \"top.top\"\npressure = 1",
        "force = [1, 0, 0]",
        "steps.1.loads.0.on",
        "neither `on`, `near`",
        "near =",
    ),
    (
        "on = \"top.top\"\npressure = 1",
        "near = [1e5, 0, 0]\nforce = [1, 0, 0]",
        "steps.1.loads.0.near",
        "farther than the model",
        "unit of length",
    ),
    (
        "on = \"top.top\"\npressure = 1",
        "on = [\"top\", \"top.left\"]\nforce = [1, 0, 0]",
        "steps.1.loads.0.on",
        "faces and blocks",
        "alone",
    ),
    (
        "on = \"top.top\"\npressure = 1",
        "from = [0, 0, 0]\nline_force = [1, 0, 0]",
        "steps.1.loads.0.to",
        "two ends",
        "to =",
    ),
    (
        "on = \"top.top\"\npressure = 1",
        "from = [0, 3, 0]\nto = [200, 3, 0]\nline_force = [1, 0, 0]",
        "steps.1.loads.0.from",
        "0 nodes lie within",
        "within =",
    ),
    (
        "pressure = 1",
        "pressure = 1\n[[steps.loads]]\nname = \"a\"\npressure = 2",
        "steps.1.loads.1.name",
        "two loads named `a`",
        "one value",
    ),
    (
        "pressure = 1",
        "pressure = 1\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"a\"\nforce = [1, 0, 0]",
        "steps.2.loads.0",
        "another kind of load in steps.1.loads.0",
        "name of its own",
    ),
    (
        "pressure = 1",
        "pressure = 1\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"a\"\non = \"top.left\"\npressure = 1",
        "steps.2.loads.0",
        "acts elsewhere",
        "stays where it is",
    ),
    (
        "[[steps.loads]]\nname = \"a\"\non = \"top.top\"\npressure = 1\n",
        "",
        "steps.1.loads",
        "loads nothing",
        "[[steps.loads]]",
    ),
    (
        "kind = \"load\"",
        "kind = \"load\"\namplitude = [[0, 0], [0.5, 1], [0.5, 0], [1, 1]]",
        "steps.1.amplitude.2",
        "does not ascend",
        "rows of",
    ),
    (
        "kind = \"load\"",
        "kind = \"load\"\namplitude = [[0, 0], [0.5, 1]]",
        "steps.1.amplitude.1",
        "ends at 0.5",
        "rows of",
    ),
    (
        "kind = \"load\"",
        "kind = \"load\"\namplitude = 3",
        "steps.1.amplitude",
        "expected rows",
        "amplitude =",
    ),
    (
        "kind = \"load\"",
        "kind = \"load\"\namplitude = \"nowhere.csv\"",
        "steps.1.amplitude",
        "nowhere.csv",
        "CSV file",
    ),
    (
        "kind = \"load\"",
        "kind = \"load\"\nprocedure = \"arc_length\"\namplitude = [[0, 0], [0.5, 1], [1, 0]]",
        "steps.1.amplitude",
        "turns back",
        "displacement_control",
    ),
    (
        "kind = \"load\"",
        "kind = \"load\"\ncycles = { amplitudes = [1] }",
        "steps.1.cycles",
        "belongs to a drive",
        "leave it out",
    ),
];

#[test]
fn bad_loads_name_the_key_and_the_fix() {
    refuses(&format!("{HEAD}{PAIR}{GRAVITY}{LOAD}"), BAD_LOADS);
}

#[test]
fn bad_cycles_name_the_key_and_the_fix() {
    let drive = "[[steps]]\nkind = \"drive\"\nface = \"top.top\"\ndirection = \"x\"\ncycles = { amplitudes = [1, 2] }\n";
    refuses(
        &format!("{HEAD}{PAIR}{GRAVITY}{drive}"),
        &[
            (
                "amplitudes = [1, 2]",
                "amplitudes = []",
                "steps.1.cycles",
                "above 0",
                "amplitudes =",
            ),
            (
                "amplitudes = [1, 2]",
                "amplitudes = [1, -2]",
                "steps.1.cycles",
                "above 0",
                "amplitudes =",
            ),
            (
                "amplitudes = [1, 2]",
                "amplitudes = [1], repeat = 0",
                "steps.1.cycles",
                "once at least",
                "repeat =",
            ),
            (
                "cycles =",
                "displacement = 1\ncycles =",
                "steps.1.displacement",
                "how far",
                "leave out",
            ),
            (
                "cycles =",
                "amplitude = [[0, 0], [1, 1]]\ncycles =",
                "steps.1.cycles",
                "`amplitude` is given",
                "one of them",
            ),
            (
                "cycles =",
                "procedure = \"dissipation\"\ncycles =",
                "steps.1.cycles",
                "cannot turn it round",
                "static",
            ),
        ],
    );
}

#[test]
fn faces_that_share_nodes_cannot_be_driven_apart() {
    let steps = "[[steps]]\nkind = \"drive\"\nface = \"top.top\"\ndirection = \"x\"\ndisplacement = 1\n\
                 [[steps]]\nkind = \"drive\"\nface = \"top.right\"\ndirection = \"x\"\ndisplacement = 1\n";
    let error = Model::from_deck(&deck(&format!("{HEAD}{PAIR}{steps}"))).unwrap_err();
    assert_eq!(error.key(), "steps.1.face");
    assert!(
        error.message().contains("in common with top.top"),
        "{error}"
    );
}
