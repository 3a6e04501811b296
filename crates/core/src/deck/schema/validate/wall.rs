//! Ranges of `[wall]` and `[[walls]]`.

use super::Checks;
use crate::deck::keys;
use crate::deck::masonry;
use crate::deck::quantity::Length;
use crate::deck::schema::{Bond, Clamped, Clamping, DeckLeaf, Strategy, Subdivision, Wall};
use crate::model::axis::Axis;

impl Checks<'_> {
    pub(super) fn wall(&mut self, path: &str, wall: &Wall) {
        let key = |name: &str| format!("{path}.{name}");
        self.name_of_wall(path, wall);
        for (i, size) in wall.unit.into_iter().enumerate() {
            self.positive(&key(&format!("unit.{i}")), size);
        }
        let joints = [
            ("bed_joint", Some(wall.bed_joint)),
            ("head_joint", Some(wall.head_joint)),
            ("collar_joint", wall.collar_joint),
        ];
        for (name, joint) in joints {
            self.not_negative(&key(name), joint);
        }
        self.positive(&key("length"), wall.length);
        self.demand(
            wall.courses > 0,
            &key("courses"),
            || "a wall has at least one course".to_owned(),
            "courses = 18",
        );
        self.demand(
            wall.along != Axis::Z,
            &key("along"),
            || "a wall does not run upwards".to_owned(),
            &keys::example("along"),
        );
        self.rotation(path, wall);
        self.within(&key("head_filling"), wall.head_filling, 0.0..=1.0);
        self.require(
            !wall.rigid || wall.expanded || joints.iter().all(|(_, joint)| joint.is_none_or(|j| j.get() == 0.0)),
            &key("rigid"),
            || "mortar is no part of a rigid unit".to_owned(),
            "rigid units lie dry: bed_joint = 0, head_joint = 0, an interface with the stiffness of the joints",
        );
        if wall.rigid {
            self.stiffness_of_joints(&wall.interface);
            self.stiffness_of_joints(&wall.head_interface);
            self.stiffness_of_joints(&wall.collar_interface);
        } else {
            self.mesh_of_wall(path, wall);
        }
        self.clamping(path, wall);
        self.bond(path, wall);
        self.snap(path, wall);
        self.materials_of_wall(path, wall);
    }

    /// Rejects a turned wall whose courses would be clamped, or that a plane of symmetry would cut.
    fn rotation(&mut self, path: &str, wall: &Wall) {
        if wall.rotate.is_none() {
            return;
        }
        self.require(
            path != "wall" || self.deck.clamped().is_none(),
            &format!("{path}.rotate"),
            || {
                "a clamped wall stands upright: its courses are held and its top is a level beam"
                    .to_owned()
            },
            "clamped = false, with supports and steps that name faces of units or blocks",
        );
        self.require(
            self.deck.symmetry.is_empty(),
            &format!("{path}.rotate"),
            || "planes of symmetry cut walls along their axes, and this one is turned".to_owned(),
            "leave [[symmetry]] out: mirror halves are found where there are any",
        );
    }

    /// Requires an explicit stiffness of joints of rigid bodies, whose modulus follows from it.
    pub(super) fn stiffness_of_joints<'n>(&mut self, name: impl Into<Option<&'n String>>) {
        let named = name.into();
        let named = named.and_then(|name| self.deck.interfaces.get_key_value(name));
        let Some((name, interface)) = named else {
            return; // rejected where it is named
        };
        let path = format!("interfaces.{name}");
        let told = self.errors.iter().any(|error| error.key() == path);
        self.require(
            told || interface.normal_stiffness.is_some(),
            &path,
            || format!("`{name}` joins rigid bodies, and has no stiffness of its own"),
            "give both: normal_stiffness = \"10 N/mm^3\", shear_stiffness = \"4 N/mm^3\"; or leave `rigid` out",
        );
    }

    /// Checks names of walls: those of `[[walls]]` need one.
    fn name_of_wall(&mut self, path: &str, wall: &Wall) {
        let key = format!("{path}.name");
        let listed = path != "wall";
        self.require(
            !listed || wall.name.is_some(),
            &key,
            || "the key `name` is missing".to_owned(),
            "call it, so that supports and steps can: name = \"gable\"",
        );
        if let Some(name) = &wall.name {
            self.demand(
                !name.is_empty() && !name.contains('.'),
                &key,
                || format!("`{name}` is no name for a wall"),
                "letters, digits, - and _; a dot parts the wall from its face",
            );
        }
    }

    fn mesh_of_wall(&mut self, path: &str, wall: &Wall) {
        let m = wall.mesh;
        let named = [Subdivision::COARSE, Subdivision::FINE].contains(&m);
        let least = |joint: Length| 1 + u32::from(!wall.expanded && joint.get() > 0.0);
        let (length, height) = (least(wall.head_joint), least(wall.bed_joint));
        self.require(
            named || (m.length >= length && m.height >= height && m.thickness >= 1),
            &format!("{path}.mesh"),
            || {
                let [l, h, t] = [m.length, m.height, m.thickness];
                format!("the subdivision [{l}, {h}, {t}] leaves no element for the unit")
            },
            "length and height count one joint element each: at least [2, 2, 1]; the paper's coarse \
             mesh is [5, 2, 2]",
        );
    }

    fn clamping(&mut self, path: &str, wall: &Wall) {
        let key = format!("{path}.clamped");
        let clamped = match wall.clamped {
            Clamping::Courses(clamped) => clamped,
            Clamping::Unsaid if path == "wall" => Clamped::default(),
            Clamping::Unsaid | Clamping::Nothing => return,
        };
        self.demand(
            path == "wall",
            &key,
            || "only [wall] has a level beam".to_owned(),
            "clamped = false; [[supports]] and steps with `face` hold and move walls of a list",
        );
        let (bottom, top) = (clamped.bottom_courses, clamped.top_courses);
        let courses = wall.courses;
        if courses > 0 {
            // Held and driven nodes must be different, and neither may be all nodes.
            let apart = u64::from(bottom) + u64::from(top) <= u64::from(courses);
            self.require(
                apart && bottom < courses && top < courses,
                &key,
                || format!("{bottom} courses held and {top} driven are too many of {courses}"),
                "clamp fewer courses; 0 holds only the face",
            );
        }
    }

    /// Checks the length of the pieces that are joined to the units beside them.
    fn snap(&mut self, path: &str, wall: &Wall) {
        let key = |name: &str| format!("{path}.{name}");
        let half = 0.5 * wall.unit[0].get();
        self.require(
            wall.snap.is_none_or(|most| most.get() >= 0.0 && most.get() <= half),
            &key("snap"),
            || "not between 0 and half a unit".to_owned(),
            "snap = \"25 mm\": pieces shorter than this are joined to the units beside them; 0: none",
        );
    }

    /// Checks keys that belong to some bonds only.
    fn bond(&mut self, path: &str, wall: &Wall) {
        let key = |name: &str| format!("{path}.{name}");
        let bond = wall.bond;
        let written = bond == Bond::Pattern;
        self.require(
            written != wall.pattern.is_empty(),
            &key("pattern"),
            || {
                if written {
                    "the bond is a pattern, and there is none".to_owned()
                } else {
                    "the bond is not the pattern that is written out".to_owned()
                }
            },
            "say bond = \"pattern\" and [[wall.pattern]] with leaves = [{ units = [204] }], one for each course",
        );
        let plain = matches!(bond, Bond::Stretcher | Bond::Stack);
        let english = matches!(bond, Bond::English | Bond::EnglishCross);
        for (name, given, known) in [
            ("overlap", wall.overlap.is_some(), bond == Bond::Stretcher),
            ("leaves", wall.leaves != 1, plain || english),
            (
                "header_courses",
                wall.header_courses.is_some(),
                plain && wall.leaves == 2,
            ),
        ] {
            self.require(
                !given || known,
                &key(name),
                || format!("`{name}` says nothing in this bond"),
                "`overlap` is of the stretcher bond, `leaves` of stretchers, stacks and English bonds, `header_courses` \
                 of two leaves of the first two",
            );
        }
        self.demand(
            wall.leaves > 0 && wall.leaves <= 100,
            &key("leaves"),
            || format!("{} leaves", wall.leaves),
            "leaves = 2",
        );
        self.demand(
            wall.header_courses != Some(0) && wall.header_courses != Some(1),
            &key("header_courses"),
            || "courses of headers are every second one at least".to_owned(),
            "header_courses = 6",
        );
        for (k, course) in wall.pattern.iter().enumerate() {
            self.positive(&key(&format!("pattern.{k}.height")), course.height);
            self.require(
                !course.leaves.is_empty(),
                &key(&format!("pattern.{k}.leaves")),
                || "a course without leaves".to_owned(),
                "leaves = [{ units = [\"204 mm\"] }]",
            );
            for (l, leaf) in course.leaves.iter().enumerate() {
                self.leaf(&key(&format!("pattern.{k}.leaves.{l}")), leaf);
            }
        }
    }

    /// Checks a leaf of a course that is written out.
    fn leaf(&mut self, path: &str, leaf: &DeckLeaf) {
        let key = |name: &str| format!("{path}.{name}");
        self.positive(&key("thickness"), leaf.thickness);
        self.require(
            !leaf.units.is_empty() && leaf.units.iter().all(|u| u.get() > 0.0),
            &key("units"),
            || "a leaf without units, or with units of no length".to_owned(),
            "units = [\"204 mm\", \"96 mm\"]  # over and over again",
        );
        let headers = &leaf.headers;
        self.require(
            headers.iter().all(|h| (*h as usize) < leaf.units.len()),
            &key("headers"),
            || format!("{headers:?} are not all units of this leaf"),
            "places in `units`, from 0",
        );
        self.known_material(&key("material"), &leaf.material);
    }

    fn materials_of_wall(&mut self, path: &str, wall: &Wall) {
        let key = |name: &str| format!("{path}.{name}");
        self.known_material(&key("unit_material"), &wall.unit_material);
        self.known_material(&key("mortar_material"), &wall.mortar_material);
        let joints = [
            Some(wall.bed_joint),
            Some(wall.head_joint),
            wall.collar_joint,
        ];
        let mortar = joints.into_iter().flatten().any(|joint| joint.get() > 0.0);
        let lacks_mortar = mortar && wall.mortar_material.is_none() && !wall.expanded;
        self.missing(path, "mortar_material", lacks_mortar);
        self.known_interface(&key("interface"), &wall.interface);
        self.known_interface(&key("head_interface"), &wall.head_interface);
        self.known_interface(&key("collar_interface"), &wall.collar_interface);
        self.known_interface(&key("crack_interface"), &wall.crack_interface);
        self.require(
            !(wall.expanded && wall.mortar_material.is_some()),
            &key("expanded"),
            || "expanded units leave no room for mortar".to_owned(),
            "leave out mortar_material: the interface has the stiffness and the strength of the mortar; or \
             strategy = \"simplified\", which derives both",
        );
        let fits = match self.deck.strategy {
            Strategy::Simplified => !wall.rigid,
            Strategy::Rigid => wall.rigid,
            Strategy::Detailed | Strategy::Limit => false,
        };
        let strategy = self.deck.strategy.name();
        self.require(
            !wall.expanded || fits,
            &key("expanded"),
            || format!("these units are expanded, which does not go with strategy = \"{strategy}\""),
            "strategy = \"simplified\", or \"rigid\" with rigid = true; to change the strategy, begin with the deck of \
             the detailed model",
        );
        self.require(
            wall.crack_interface.is_none() || wall.expanded,
            &key("crack_interface"),
            || "only expanded units are divided in their middle".to_owned(),
            "expanded = true",
        );
        for (o, opening) in wall.openings.iter().enumerate() {
            let Some(lintel) = &opening.lintel else {
                continue;
            };
            let path = key(&format!("openings.{o}.lintel"));
            self.not_negative(&format!("{path}.bearing"), lintel.bearing);
            self.demand(
                lintel.courses > 0,
                &format!("{path}.courses"),
                || "a lintel of no course".to_owned(),
                "courses = 1",
            );
            self.known_material(&format!("{path}.material"), &lintel.material);
        }
    }

    /// Places the units of the walls, if their sizes allow it.
    pub(super) fn walls(&mut self) {
        let deck = self.deck;
        let mut sound = true;
        for (path, _, wall) in deck.walls() {
            let sizes = [wall.length, wall.unit[0], wall.unit[1], wall.unit[2]];
            let joints = [wall.bed_joint, wall.head_joint];
            sound &= sizes.iter().all(|s| s.get() > 0.0) && joints.iter().all(|s| s.get() >= 0.0);
            let written = wall.pattern.iter().flat_map(|course| {
                let of_leaves = course
                    .leaves
                    .iter()
                    .flat_map(|l| l.units.iter().chain(&l.thickness));
                of_leaves.chain(&course.height)
            });
            sound &= wall.collar_joint.is_none_or(|joint| joint.get() >= 0.0);
            sound &= written.into_iter().all(|size| size.get() > 0.0);
            sound = sound && self.proportions(&path, wall) && !self.broken.section(&path);
        }
        let known = self.errors.is_empty() || !deck.walls().any(|(path, _, _)| self.blamed(&path));
        if !sound || !known {
            return;
        }
        if let Err((path, refusal)) = masonry::lay_all(deck) {
            let at = format!("{path}.{}", refusal.key);
            self.require(false, &at, || refusal.message, &refusal.help);
        }
    }

    /// Returns whether an error of this section is known.
    fn blamed(&self, section: &str) -> bool {
        let within = |key: &str| {
            key.strip_prefix(section)
                .is_some_and(|rest| rest.starts_with('.'))
        };
        self.errors.iter().any(|error| within(error.key()))
    }

    /// Rejects sizes that would give elements of extreme shape, and then returns false. The error names the size
    /// farthest from the others.
    fn proportions(&mut self, path: &str, wall: &Wall) -> bool {
        let key = |name: &str| format!("{path}.{name}");
        let mut sizes = vec![
            (key("unit.0"), wall.unit[0].get()),
            (key("unit.1"), wall.unit[1].get()),
            (key("unit.2"), wall.unit[2].get()),
            (key("bed_joint"), wall.bed_joint.get()),
            (key("head_joint"), wall.head_joint.get()),
        ];
        sizes.extend(
            wall.collar_joint
                .map(|joint| (key("collar_joint"), joint.get())),
        );
        for (k, course) in wall.pattern.iter().enumerate() {
            let key = |name: &str| key(&format!("pattern.{k}.{name}"));
            sizes.extend(course.height.map(|height| (key("height"), height.get())));
            for (l, leaf) in course.leaves.iter().enumerate() {
                let thickness = leaf
                    .thickness
                    .map(|t| (key(&format!("leaves.{l}.thickness")), t.get()));
                sizes.extend(thickness);
                let units = leaf.units.iter().enumerate();
                sizes.extend(
                    units.map(|(u, size)| (key(&format!("leaves.{l}.units.{u}")), size.get())),
                );
            }
        }
        sizes.retain(|(_, size)| *size > 0.0); // dry joints have no thickness
        sizes.sort_by(|a, b| a.1.total_cmp(&b.1));
        let middle = sizes[sizes.len() / 2].1;
        let ((lowest, smallest), (highest, largest)) = (&sizes[0], &sizes[sizes.len() - 1]);
        // The two ratios are computed separately: their product may overflow.
        let (below, above) = (middle / smallest, largest / middle);
        let fine = below <= MOST_SLENDER && above <= MOST_SLENDER;
        let (path, size) = if below > above {
            (lowest, smallest)
        } else {
            (highest, largest)
        };
        self.require(
            fine,
            path,
            || {
                format!("{size} mm beside {middle} mm: no sound element can be made of these")
            },
            "see that the unit of length is right: units and joints differ by a factor of 1000 at most",
        );
        fine
    }
}

/// Largest ratio between the median size of units and joints and the smallest or largest one: thin joints between
/// stone blocks reach a hundred.
const MOST_SLENDER: f64 = 1e3;
