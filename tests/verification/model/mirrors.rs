//! Mirror bodies: the rigid body that stands for the other half, where a plane of symmetry cuts joints, is not part
//! of the scene. Bodies that the plane holds are not moved across it.

use crate::common::blocks::{Bad, deck_and_model as model, refuses};
use wythe::deck::{Deck, check};

/// Half of a wall whose middle head joints lie in the plane.
const HALF: &str = "format = 1
[materials.brick]
E = 16700
nu = 0.15
density = \"1900 kg/m^3\"
[interfaces.joint]
f_t = 0.12
u_k = 0.36
zeta = 4.38
tan_phi = 0.58
c = 0.22
delta_k = 0.4
xi = 1.1
mu = 0.58
[wall]
unit = [200, 100, 80]
bed_joint = 0
head_joint = 0
length = 600
courses = 4
unit_material = \"brick\"
interface = \"joint\"
mesh = [4, 2, 2]
clamped = false
[[symmetry]]
normal = \"x\"
at = 300
[[supports]]
on = \"wall.bottom\"
";

const STEP: &str = "[[steps]]\nkind = \"gravity\"\n";

/// The joints at the mirror have random strengths like the others; the checker reports their stiffness.
#[test]
fn joints_in_the_plane_scatter_like_all_others() {
    let scatter = "[interfaces.joint.scatter]\ncv = 0.3\nseed = 1\n";
    let (deck, scattered) = model(&format!("{HALF}{scatter}{STEP}"));
    let contact = &scattered.contact;
    let mut count = 0;
    for (facet, law) in contact.slave_law.iter().enumerate() {
        let bond = |law: u16| {
            contact.laws[usize::from(law)]
                .as_cohesive_frictional()
                .unwrap()
        };
        let mirrored = bond(*law);
        if mirrored.mu != 0.0 {
            continue;
        }
        count += 1;
        // Another joint of the same unit has the same factor.
        let of = |f: &usize| contact.slave_body[*f] == contact.slave_body[facet];
        let laws = (0..contact.slave_law.len()).filter(of);
        let other = laws
            .map(|f| bond(contact.slave_law[f]))
            .find(|law| law.mu > 0.0);
        assert_ne!(mirrored.f_t, 0.12);
        assert!(other.is_none_or(|law| law.f_t == mirrored.f_t));
    }
    assert_eq!(count, 2 * 4); // two courses, 2 × 2 facets each
    let notes = check(&deck, &scattered).notes;
    let told = notes.iter().find(|n| n.contains("k_n / k_s")).unwrap();
    // 500 min E/h with h = 50 mm of head joints, and twice as much at half the opening.
    assert!(
        told.contains("167000 /") && told.contains("334000 /"),
        "{told}"
    );
}

/// The nearest node to a point belongs to the wall, however close the mirror's corners are.
#[test]
fn probes_and_loads_ignore_mirror_bodies() {
    let near = "near = [300, -200, -150]";
    let probe = format!("[[probes]]\nname = \"p\"\n{near}\ndirection = \"y\"\n");
    let load = format!("[[steps.loads]]\nname = \"f\"\n{near}\nforce = [0, 5, 0]\n");
    let (_, model) = model(&format!("{HALF}{probe}{STEP}{load}"));
    let node = model.probes[0].nodes[0];
    assert_eq!(model.mesh.nodes[node as usize], [300.0, 0.0, 0.0]);
    let wythe::model::loads::LoadOn::Shares(shares) = &model.loads[0].acts else {
        panic!("{:?}", model.loads[0]);
    };
    assert_eq!(shares, &[(node, 1.0)]);
}

/// A mesh without an element for the unit gives a single error for any planes.
#[test]
fn a_mesh_without_units_is_one_error() {
    for mesh in ["[0, 2, 2]", "[1, 0, 0]"] {
        let text = HALF
            .replace("[4, 2, 2]", mesh)
            .replace("head_joint = 0", "head_joint = 10");
        let text = text
            .replace("length = 600", "length = 620")
            .replace("at = 300", "at = 310");
        let text = text.replace(
            "unit_material",
            "mortar_material = \"brick\"\nunit_material",
        );
        let error = Deck::from_str(&format!("{text}{STEP}"), "wall.toml").unwrap_err();
        let keys: Vec<&str> = error.all().map(wythe::error::ModelError::key).collect();
        assert_eq!(keys, ["wall.mesh"], "{error}");
    }
}

/// A block beside the wall that ends at the plane.
const BLOCK: &str = "[[blocks]]
name = \"slab\"
size = [300, 100, 40]
at = [0, 0, 320]
material = \"brick\"
mesh = [3, 1, 1]
[[contacts]]
slave = \"wall.top\"
master = \"slab.bottom\"
interface = \"joint\"
[[springs]]
name = \"jack\"
on = \"slab\"
stiffness = [1000, 1000, 1000]
";

const ACROSS: &[Bad] = &[
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nspring = \"jack\"\ndirection = \"x\"\ndisplacement = 1",
        "steps.0.direction",
        "the spring jack is driven along x, across the plane of symmetry x = 300 mm",
        "the whole scene",
    ),
    (
        "mesh = [3, 1, 1]",
        "mesh = [3, 1, 1]\nvelocity = [100, 0, 0]",
        "blocks.0.velocity",
        "slab moves along x, across",
        "the whole scene",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"load\"\n[[steps.loads]]\nname = \"f\"\non = \"slab\"\nforce = [10, 0, 0]",
        "steps.0.loads.0",
        "the load f acts on nodes that are held along x, across",
        "the whole scene",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"load\"\n[[steps.loads]]\nname = \"p\"\non = \"slab.right\"\npressure = 1",
        "steps.0.loads.0",
        "the load p acts on nodes that are held along x, across",
        "the whole scene",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"load\"\n[[steps.loads]]\nname = \"p\"\non = \"slab.right\"\npressure = 1\nfollower = false",
        "steps.0.loads.0",
        "the load p acts",
        "the whole scene",
    ),
];

#[test]
fn bodies_held_by_the_plane_are_not_moved_across_it() {
    let good = format!("{HALF}{BLOCK}{STEP}");
    refuses(&good, ACROSS);
    // Motions along the plane, and of bodies that only touch it, are valid.
    for right in [
        "kind = \"drive\"\nspring = \"jack\"\ndirection = \"z\"\ndisplacement = 1",
        "kind = \"load\"\n[[steps.loads]]\nname = \"f\"\non = \"slab\"\nforce = [0, 10, 0]",
        "kind = \"load\"\n[[steps.loads]]\nname = \"p\"\non = \"slab.top\"\npressure = 1",
        "kind = \"load\"\n[[steps.loads]]\nname = \"t\"\non = \"slab.top\"\ntraction = [1, 0, 0]",
        "kind = \"load\"\n[[steps.loads]]\nname = \"p\"\non = \"slab.left\"\npressure = 1",
    ] {
        model(&good.replace("kind = \"gravity\"", right));
    }
    // A beam that rotates is moved by a jack of its own.
    let beam = "[[beams]]\nname = \"beam\"\non = \"wall.top\"\ndepth = 100\nrotation = \"free\"\ninterface = \"joint\"\n";
    let push =
        "[[steps]]\nkind = \"drive\"\nbeam = \"beam\"\ndirection = \"z\"\ndisplacement = 1\n";
    let text = format!("{HALF}{beam}{push}");
    refuses(
        &text,
        &[(
            "direction = \"z\"",
            "direction = \"x\"",
            "steps.0.direction",
            "the spring beam is driven along x",
            "the whole scene",
        )],
    );
}
