//! Flat jacks in a wall under vertical stress: one slot, whose gauges are brought back (ASTM C1196, RILEM MDT.D.4), and
//! two, which press the masonry between them (ASTM C1197, RILEM MDT.D.5).
//!
//! Nothing can be cut while a run goes on, so the wall without a slot and the wall with it are two decks. The
//! difference of their gauges under the same stress is what cutting would do, as long as the wall is elastic.

use super::SpecimenDeck;
use super::options::Specimen;
use super::text::{FASTENED, WallText, head, mm, point, tables, wall};
use std::fmt::Write as _;

/// Units along the wall.
const UNITS: f64 = 4.0;
/// Length of a slot over that of a unit with its joint: RILEM MDT.D.5 wants at least 1.5 units.
const SLOT: f64 = 1.5;
/// Elements along a unit, as those of a wall.
const ALONG: f64 = 5.0;
/// Thickness of the skin of mortar that is left on either face of a slot, over that of the joint.
const SKIN: f64 = 0.2;
/// Part of the stress up to which the jack of one slot is pumped: beyond the cancellation, before the bed opens.
const PUMPED: f64 = 1.2;

/// Courses between two slots.
const BETWEEN: u32 = 5;
/// Courses that the gauges between two slots span, about half the height there.
const SPAN: f64 = 2.0;
/// Elements along, up and through a unit between two slots: nodes at half the height of units, and near the quarters of
/// the slot, beside which the stress changes fast.
const BETWEEN_MESH: [u32; 3] = [9, 3, 2];

/// Names of the parts of the wall between its slots, from below.
const ONE: &[&str] = &["lower", "upper"];
const TWO: &[&str] = &["lower", "middle", "upper"];

/// Parts of a wall with slots in the beds between them.
struct Parts {
    names: &'static [&'static str],
    courses: &'static [u32],
    /// Whether the beds have slots.
    slots: bool,
}

/// A bed between two parts.
struct Bed {
    index: usize,
    below: &'static str,
    above: &'static str,
    /// Height of its lower face [mm].
    low: f64,
}

/// The wall without and with a slot, for each precompression.
pub(super) fn single(specimen: &Specimen) -> Vec<SpecimenDeck> {
    let many = specimen.pressures.len() > 1;
    let deck = |pressure: f64, part: &str, slots: bool| {
        let parts = Parts {
            names: ONE,
            courses: &[7, 7],
            slots,
        };
        SpecimenDeck {
            part: if many {
                format!("{}-{part}", mm(pressure))
            } else {
                part.to_owned()
            },
            text: text(specimen, "flat-jack", pressure, &parts),
        }
    };
    let pressures = specimen.pressures.iter();
    pressures
        .flat_map(|&pressure| [deck(pressure, "whole", false), deck(pressure, "slot", true)])
        .collect()
}

/// Two slots five courses apart.
pub(super) fn double(specimen: &Specimen) -> Vec<SpecimenDeck> {
    SpecimenDeck::for_each_pressure(specimen, |pressure| {
        let parts = Parts {
            names: TWO,
            courses: &[6, BETWEEN, 6],
            slots: true,
        };
        text(specimen, "flat-jack-double", pressure, &parts)
    })
}

/// Begin of the deck, by its parts.
fn about(kind: &str, slots: bool, pressure: f64) -> (String, String) {
    let p = mm(pressure);
    let (title, drawing, words) = match (kind, slots) {
        ("flat-jack", false) => (
            format!("Flat jack at {p} MPa, before the cut"),
            "│  o  o  o   │\n│            │  gauges\n│  o  o  o   │",
            "ASTM C1196, RILEM MDT.D.4: the wall before the slot is cut. The deck with the slot is the other one.",
        ),
        ("flat-jack", true) => (
            format!("Flat jack at {p} MPa, with the slot"),
            "│  o  o  o   │\n│  ════════  │  slot; a jack presses its faces\n│  o  o  o   │",
            "ASTM C1196, RILEM MDT.D.4: the slot is there from the start. Its jack is pumped until the gauges are as long \
             as\nin the wall without a slot: the cancellation pressure is the stress of the wall.",
        ),
        _ => (
            format!("Double flat jack at {p} MPa"),
            "│  ════════  │\n│  o  o  o   │  gauges\n│  o  o  o   │\n│  ════════  │",
            "ASTM C1197, RILEM MDT.D.5: two jacks press the five courses between them. The modulus is that of the \
             gauges, which\nspan two whole courses, between middles of units.",
        ),
    };
    let about = format!(
        "\nv v v v v v v  {p} MPa\n┌────────────┐\n{drawing}\n└────────────┘\n//////////////\n\n{words}\nThe slot goes through \
         the wall, and a skin of mortar is left on its faces."
    );
    (title, about)
}

fn text(specimen: &Specimen, kind: &str, pressure: f64, parts: &Parts) -> String {
    let (title, about) = about(kind, parts.slots, pressure);
    let mut text = head(specimen, &title, &about);
    text.push_str(FASTENED);
    let (beds, top) = walls(&mut text, specimen, parts);
    tables(
        &mut text,
        &format!(
            "[test] # what `wythe evaluate` needs\nkind = \"{kind}\"\nlength = \"{} mm\" # of the slot\n\
             thickness = \"{} mm\"\nheight = \"{} mm\"\npressure = \"{} MPa\"\n\n[[supports]]\non = \"lower.bottom\"",
            mm(slot(specimen)[1] - slot(specimen)[0]),
            mm(specimen.unit[1]),
            mm(top),
            mm(pressure)
        ),
    );
    for bed in &beds {
        bed.write(&mut text, specimen, parts.slots);
    }
    gauges(&mut text, specimen, &beds);
    steps(&mut text, pressure, parts.slots, &beds);
    text
}

/// Length of the wall [mm].
pub(super) fn length(specimen: &Specimen) -> f64 {
    UNITS * (specimen.unit[0] + specimen.joint) - specimen.joint
}

/// Ends of a slot along the wall [mm].
fn slot(specimen: &Specimen) -> [f64; 2] {
    let half = 0.5 * SLOT * (specimen.unit[0] + specimen.joint);
    let middle = 0.5 * length(specimen);
    [middle - half, middle + half]
}

/// Writes the walls, one above the other with a joint between them. Returns these beds and the height of all.
fn walls(text: &mut String, specimen: &Specimen, parts: &Parts) -> (Vec<Bed>, f64) {
    let (mut low, mut beds) = (0.0, Vec::new());
    for (i, (name, courses)) in parts.names.iter().zip(parts.courses).enumerate() {
        let more = format!(
            "name = \"{name}\"\nat = {}\nclamped = false\n",
            point([0.0, 0.0, low])
        );
        let own = wall(
            specimen,
            WallText {
                length: length(specimen),
                courses: *courses,
                mesh: (*name == "middle").then_some(BETWEEN_MESH),
                more: &more,
            },
        );
        text.push_str(&if i == 0 {
            own
        } else {
            own.replace("[wall]", "[[walls]]")
        });
        low += f64::from(*courses) * (specimen.unit[2] + specimen.joint) - specimen.joint;
        if let Some(above) = parts.names.get(i + 1) {
            beds.push(Bed {
                index: i,
                below: name,
                above,
                low,
            });
            low += specimen.joint;
        }
    }
    (beds, low)
}

impl Bed {
    /// Writes the mortar of the bed beside the slot and the skins on its faces; the whole bed without a slot.
    fn write(&self, text: &mut String, specimen: &Specimen, slots: bool) {
        let Self {
            index,
            below,
            above,
            low,
        } = *self;
        let ([from, to], joint) = (slot(specimen), specimen.joint);
        let mut pieces = vec![("left", 0.0, from), ("right", to, length(specimen))];
        if !slots {
            pieces.insert(1, ("middle", from, to));
        }
        text.push_str("\n# Mortar of the bed between the parts of the wall.\n");
        for (name, from, to) in pieces {
            let name = format!("bed-{index}-{name}");
            layer(specimen, &name, [from, to], [low, low + joint]).write(text, specimen);
            contact(
                text,
                &format!("{name}.bottom"),
                &format!("{below}.top"),
                "fastened",
            );
            let joint = specimen.materials.joint.clone();
            contact(
                text,
                &format!("{name}.top"),
                &format!("{above}.bottom"),
                &joint,
            );
        }
        if !slots {
            return;
        }
        text.push_str("\n# What is left of it on the faces of the slot, which the jack presses.\n");
        let skin = SKIN * joint;
        let skins = [
            ("below", low, low + skin, "bottom", format!("{below}.top")),
            (
                "above",
                low + joint - skin,
                low + joint,
                "top",
                format!("{above}.bottom"),
            ),
        ];
        for (name, low, high, face, on) in skins {
            let name = format!("jack-{index}-{name}");
            layer(specimen, &name, [from, to], [low, high]).write(text, specimen);
            contact(text, &format!("{name}.{face}"), &on, "fastened");
        }
    }
}

/// A layer of mortar.
fn layer<'a>(specimen: &'a Specimen, name: &'a str, ends: [f64; 2], heights: [f64; 2]) -> Body<'a> {
    Body {
        name,
        material: &specimen.materials.mortar,
        ends,
        heights,
        elements: [0.0, 1.0],
    }
}

/// A block through the wall.
pub(super) struct Body<'a> {
    pub name: &'a str,
    pub material: &'a str,
    /// Ends along the wall [mm].
    pub ends: [f64; 2],
    /// Lower and upper face [mm].
    pub heights: [f64; 2],
    /// Elements along and up; 0 along: as long as those of the wall.
    pub elements: [f64; 2],
}

impl Body<'_> {
    pub(super) fn write(&self, text: &mut String, specimen: &Specimen) {
        let ([from, to], [low, high]) = (self.ends, self.heights);
        let element = (specimen.unit[0] + specimen.joint) / ALONG;
        let along = match self.elements[0] {
            0.0 => ((to - from) / element).round().max(1.0),
            along => along,
        };
        let size = [to - from, specimen.unit[1], high - low];
        let _ = write!(
            text,
            "[[blocks]]\nname = \"{}\"\nsize = {}\nat = {}\nmaterial = \"{}\"\nmesh = [{along}, 2, {}]\n\n",
            self.name,
            point(size),
            point([from, 0.0, low]),
            self.material,
            self.elements[1]
        );
    }
}

pub(super) fn contact(text: &mut String, slave: &str, master: &str, interface: &str) {
    let _ = write!(
        text,
        "[[contacts]]\nslave = \"{slave}\"\nmaster = \"{master}\"\ninterface = \"{interface}\"\n\n"
    );
}

/// Three gauges along the slot. Across one slot they reach from the second bed below to the second bed above: only their
/// changes count. Between two slots they span whole courses, between middles of units.
fn gauges(text: &mut String, specimen: &Specimen, beds: &[Bed]) {
    let ([from, to], joint) = (slot(specimen), specimen.joint);
    let course = specimen.unit[2] + joint;
    let [low, high] = match beds {
        [bed] => [bed.low - course, bed.low + joint + course],
        [first, ..] => {
            let below = 0.5 * (f64::from(BETWEEN - 1) - SPAN);
            let low = first.low + joint + below * course + 0.5 * specimen.unit[2];
            [low, low + SPAN * course]
        }
        [] => return,
    };
    for (name, part) in [("left", 0.25), ("middle", 0.5), ("right", 0.75)] {
        let x = from + part * (to - from);
        tables(
            text,
            &format!(
                "[[probes]]\nname = \"{name}\"\ngauge = [{}, {}]",
                point([x, 0.0, low]),
                point([x, 0.0, high])
            ),
        );
    }
}

fn steps(text: &mut String, pressure: f64, slots: bool, beds: &[Bed]) {
    tables(
        text,
        &format!(
            "[[steps]]\nname = \"weight\"\nkind = \"load\"\n\n[[steps.loads]]\nname = \"weight\"\non = \"upper.top\"\n\
             pressure = \"{} MPa\"",
            mm(pressure)
        ),
    );
    if !slots {
        return;
    }
    let faces = |bed: &Bed| {
        let i = bed.index;
        format!("\"jack-{i}-below.top\", \"jack-{i}-above.bottom\"")
    };
    let faces: Vec<String> = beds.iter().map(faces).collect();
    let pumped = if beds.len() == 1 { PUMPED } else { 1.0 };
    tables(
        text,
        &format!(
            "[[steps]]\nname = \"jack\"\nkind = \"load\"\nincrements = {{ initial = 0.05, max = 0.05 }}\n\n[[steps.loads]]\n\
             name = \"jack\"\non = [{}]\npressure = \"{} MPa\"",
            faces.join(", "),
            mm(pumped * pressure)
        ),
    );
}
