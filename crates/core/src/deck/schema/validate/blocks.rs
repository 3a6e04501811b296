//! Ranges of `[[blocks]]`, `[arch]`, `[[contacts]]`, `[[supports]]`, `[[springs]]`.

use super::Checks;
use crate::deck::import::Units;
use crate::deck::keys;
use crate::deck::quantity::{Length, Quantity};
use crate::deck::rigid;
use crate::deck::schema::{DeckArch, DeckBlock, Names, NotConvex};
use crate::error::{ErrorKind, ModelError};

/// Rounded rises may exceed half the span by this fraction.
const ROUNDED: f64 = 1e-9;

/// Largest number of copies of a block.
const MOST_COPIES: f64 = 5e4;

impl Checks<'_> {
    /// Checks the scene, and sections that need one.
    pub(super) fn scene(&mut self) {
        let deck = self.deck;
        for (name, given) in [
            ("contacts", !deck.contacts.is_empty()),
            ("supports", !deck.supports.is_empty()),
            ("springs", !deck.springs.is_empty()),
            ("symmetry", !deck.symmetry.is_empty()),
            ("beams", !deck.beams.is_empty()),
            ("settlements", !deck.settlements.is_empty()),
            ("ties", !deck.ties.is_empty()),
            ("floors", !deck.floors.is_empty()),
            ("layers", !deck.layers.is_empty()),
        ] {
            self.demand(
                deck.has_scene() || !given || !self.scene_is_known(),
                name,
                || format!("[[{name}]] belongs to a scene, and there is none"),
                "add [wall], [[walls]], [[blocks]] or [arch]",
            );
        }
        self.symmetry();
        self.beams();
        self.layers();
        for (i, block) in deck.blocks.iter().enumerate() {
            self.block(&format!("blocks.{i}"), block);
        }
        if let Some(arch) = &deck.arch {
            self.arch(arch);
        }
        self.contacts();
        self.supports();
        self.springs();
    }

    fn beams(&mut self) {
        let deck = self.deck;
        for (i, beam) in deck.beams.iter().enumerate() {
            let path = format!("beams.{i}");
            let mut letters = beam.name.chars();
            let plain = letters.next().is_some_and(char::is_alphabetic)
                && letters.all(|c| c.is_alphanumeric() || "-_".contains(c));
            self.demand(
                plain,
                &format!("{path}.name"),
                || format!("`{}` is no name for a beam", beam.name),
                "a letter, then letters, digits, - and _",
            );
            self.not_empty(&format!("{path}.on"), Some(&beam.on));
            self.positive(&format!("{path}.depth"), beam.depth);
            self.known_interface(&format!("{path}.interface"), &beam.interface);
            self.not_negative(&format!("{path}.density"), beam.density);
        }
    }

    fn layers(&mut self) {
        let deck = self.deck;
        for (i, layer) in deck.layers.iter().enumerate() {
            let path = format!("layers.{i}");
            self.demand(
                !layer.name.is_empty() && !layer.name.contains('.'),
                &format!("{path}.name"),
                || format!("`{}` is no name for a layer", layer.name),
                "letters, digits, - and _; a dot parts the layer from its face",
            );
            self.not_empty(&format!("{path}.on"), Some(&layer.on));
            self.positive(&format!("{path}.thickness"), layer.thickness);
            self.not_negative(&format!("{path}.unbonded"), layer.unbonded);
            self.known_material(&format!("{path}.material"), &layer.material);
            self.known_interface(&format!("{path}.interface"), &layer.interface);
        }
    }

    fn contacts(&mut self) {
        let deck = self.deck;
        for (i, contact) in deck.contacts.iter().enumerate() {
            let path = format!("contacts.{i}");
            let sides = [("slave", &contact.slave), ("master", &contact.master)];
            for (name, side) in sides {
                self.not_empty(&format!("{path}.{name}"), side.as_ref());
            }
            if let [Some(_), None] | [None, Some(_)] = sides.map(|(_, side)| side.as_ref()) {
                let missing = sides[usize::from(contact.slave.is_some())].0;
                self.require(
                    false,
                    &format!("{path}.{missing}"),
                    || format!("the key `{missing}` is missing"),
                    "give both sides, or neither: then all faces that touch at rest meet",
                );
            }
            self.known_interface(&format!("{path}.interface"), &contact.interface);
        }
        // The modulus of rigid bodies follows from the stiffness of joints, and not the reverse.
        if rigid::any(deck) {
            let of_contacts = deck.contacts.iter().map(|c| &c.interface);
            let of_beams = deck.beams.iter().map(|beam| &beam.interface);
            let of_layers = deck.layers.iter().map(|layer| &layer.interface);
            let named = of_contacts.chain(of_beams).chain(of_layers);
            for name in named.chain(&deck.contact.general) {
                self.stiffness_of_joints(name);
            }
        }
    }

    fn supports(&mut self) {
        let deck = self.deck;
        for (i, support) in deck.supports.iter().enumerate() {
            self.not_empty(&format!("supports.{i}.on"), Some(&support.on));
            self.demand(
                !support.fixed.is_empty(),
                &format!("supports.{i}.fixed"),
                || "a support that holds no direction".to_owned(),
                &keys::example("fixed"),
            );
        }
    }

    fn springs(&mut self) {
        let deck = self.deck;
        for (i, spring) in deck.springs.iter().enumerate() {
            self.not_empty(&format!("springs.{i}.on"), Some(&spring.on));
            for (d, stiffness) in spring.stiffness.into_iter().enumerate() {
                self.not_negative(&format!("springs.{i}.stiffness.{d}"), stiffness);
            }
            self.demand(
                spring.stiffness.iter().any(|k| k.get() > 0.0),
                &format!("springs.{i}.stiffness"),
                || "a spring without stiffness".to_owned(),
                &keys::example_at("springs.stiffness"),
            );
        }
    }

    /// Checks planes of symmetry: at most one normal to each axis.
    fn symmetry(&mut self) {
        let planes = &self.deck.symmetry;
        for (i, plane) in planes.iter().enumerate() {
            let path = format!("symmetry.{i}.normal");
            self.demand(
                !planes[..i].iter().any(|other| other.normal == plane.normal),
                &path,
                || "there are two planes of symmetry with this normal".to_owned(),
                "one plane for each of x, y and z; a second face may be held by [[supports]]",
            );
        }
    }

    fn block(&mut self, path: &str, block: &DeckBlock) {
        let key = |name: &str| format!("{path}.{name}");
        let plain = !block.name.is_empty() && !block.name.contains('.');
        self.demand(
            plain,
            &key("name"),
            || format!("`{}` is no name for a block", block.name),
            "letters, digits, - and _; a dot parts the block from its face",
        );
        self.shape(path, block);
        self.require(
            !block.rigid || block.nodes.is_none(),
            &key("rigid"),
            || "a grid of nodes is made to deform".to_owned(),
            "rigid blocks have a `size`, `corners` or a `file`",
        );
        self.column(path, block);
        self.known_material(&key("material"), &block.material);
        self.elements(&key("mesh"), block.mesh, "blocks.mesh");
        self.copies(path, block);
    }

    /// Checks that a block has one shape, and a sound one.
    fn shape(&mut self, path: &str, block: &DeckBlock) {
        let key = |name: &str| format!("{path}.{name}");
        let shapes = [
            ("size", block.size.is_some()),
            ("corners", block.corners.is_some()),
            ("nodes", block.nodes.is_some()),
            ("file", block.file.is_some()),
        ];
        let given: Vec<&str> = shapes.iter().filter(|s| s.1).map(|s| s.0).collect();
        match (&block.size, &block.corners) {
            _ if given.len() > 1 => self.require(
                false,
                &key(given[1]),
                || format!("both `{}` and `{}` are given", given[0], given[1]),
                "leave out one",
            ),
            (Some(size), _) => {
                for (d, size) in size.iter().enumerate() {
                    self.positive(&format!("{path}.size.{d}"), *size);
                }
            }
            (_, Some(corners)) => {
                let corners = corners.map(|x| x.map(Quantity::get));
                self.demand(
                    crate::element::hexahedron::is_upright(&corners),
                    &key("corners"),
                    || "the corners are not in order, or the block is flat or folded".to_owned(),
                    "(-,-,-) (+,-,-) (+,+,-) (-,+,-), then the same four above them",
                );
            }
            (None, None) => self.require(
                block.nodes.is_some() || block.file.is_some(),
                &key("size"),
                || "neither `size` nor `corners` nor `nodes` nor `file` is given".to_owned(),
                &keys::example("size"),
            ),
        }
        self.file(path, block);
    }

    /// Checks the keys of blocks of a file. The file is checked when the model is built.
    fn file(&mut self, path: &str, block: &DeckBlock) {
        let key = |name: &str| format!("{path}.{name}");
        let is_dxf = block
            .file
            .as_ref()
            .is_some_and(|file| file.to_lowercase().ends_with(".dxf"));
        for (name, given, wanted, of) in [
            (
                "units",
                block.units.is_some(),
                block.file.is_some(),
                "a `file`",
            ),
            (
                "not_convex",
                block.not_convex != NotConvex::Error,
                block.file.is_some(),
                "a `file`",
            ),
            (
                "thickness",
                block.thickness.is_some(),
                is_dxf,
                "a `file` of outlines, a DXF",
            ),
        ] {
            self.require(
                !given || wanted,
                &key(name),
                || format!("this key belongs to {of}"),
                &keys::example_at("blocks.file"),
            );
        }
        self.require(
            !is_dxf || block.thickness.is_some(),
            &key("thickness"),
            || "the key `thickness` is missing: outlines are extruded by it".to_owned(),
            &keys::example_at("blocks.thickness"),
        );
        self.positive(&key("thickness"), block.thickness);
        if let Some(Err(why)) = block.units.as_deref().map(Units::parse) {
            self.demand(
                false,
                &key("units"),
                || why,
                &keys::example_at("blocks.units"),
            );
        }
        self.require(
            block.file.is_none() || block.copies.is_none(),
            &key("copies"),
            || "the blocks of a file stand once".to_owned(),
            "name the file in several [[blocks]] with other `at`",
        );
    }

    fn copies(&mut self, path: &str, block: &DeckBlock) {
        let key = |name: &str| format!("{path}.{name}");
        let copies = block.copies.unwrap_or([1; 3]);
        let count: f64 = copies.iter().map(|n| f64::from(*n)).product();
        self.demand(
            (1.0..=MOST_COPIES).contains(&count),
            &key("copies"),
            || format!("{count} copies of a block"),
            "at least 1 along each axis, at most 5e4 in all",
        );
        self.require(
            block.copies.is_some() || block.pitch.is_none(),
            &key("pitch"),
            || "there are no copies that would stand at this distance".to_owned(),
            &keys::example("copies"),
        );
        if block.copies.is_some() {
            let pitch = block.pitch.map_or([0.0; 3], |p| p.map(Quantity::get));
            let apart = (0..3).all(|d| copies[d] < 2 || pitch[d] != 0.0);
            self.require(
                apart,
                &key("pitch"),
                || "copies would stand in the same place".to_owned(),
                &keys::example("pitch"),
            );
        }
    }

    /// Checks a column of blocks.
    fn column(&mut self, path: &str, block: &DeckBlock) {
        let key = |name: &str| format!("{path}.{name}");
        let Some(count) = block.stack else {
            self.require(
                block.interface.is_none(),
                &key("interface"),
                || "a single block has no joints".to_owned(),
                "stack = 6 makes a column of it; [[contacts]] join blocks",
            );
            return;
        };
        self.demand(
            (1.0..=MOST_COPIES).contains(&f64::from(count)),
            &key("stack"),
            || format!("{count} blocks are no column"),
            "at least 1, at most 5e4",
        );
        self.require(
            block.size.is_some() && block.copies.is_none(),
            &key("stack"),
            || "a column is of boxes, and stands once".to_owned(),
            "give `size`, and leave out `corners`, `nodes` and `copies`",
        );
        self.require(
            block.interface.is_some(),
            &key("interface"),
            || "the key `interface` is missing".to_owned(),
            "the interface of the joints of the column: interface = \"dry\"",
        );
        self.known_interface(&key("interface"), &block.interface);
        if block.rigid {
            self.stiffness_of_joints(&block.interface);
        }
    }

    fn arch(&mut self, arch: &DeckArch) {
        self.positive("arch.thickness", arch.thickness);
        self.positive("arch.width", arch.width);
        self.positive("arch.radius", arch.radius);
        self.positive("arch.span", arch.span);
        self.require(
            arch.radius.is_some() || arch.span.is_some(),
            "arch.radius",
            || "neither `radius` nor `span` is given".to_owned(),
            &keys::example("radius"),
        );
        self.require(
            arch.radius.is_none() || arch.span.is_none(),
            "arch.span",
            || "both `radius` and `span` are given".to_owned(),
            "each follows from the other: leave out one",
        );
        if let Some(rise) = arch.rise {
            self.rise(arch, rise);
        }
        let angle = arch.angle.map_or(180.0, Quantity::get);
        self.demand(
            angle > 0.0 && angle <= 180.0,
            "arch.angle",
            || format!("an arch over {angle} degrees"),
            "above 0, up to 180 (a semicircle)",
        );
        let (radius, thickness) = (arch.centre_line(), arch.thickness.get());
        self.require(
            angle <= 0.0 || thickness < radius || radius <= 0.0,
            "arch.thickness",
            || format!("{thickness} mm are no arch of {radius} mm radius"),
            "a ring is thinner than its radius",
        );
        let count = arch.voussoirs;
        self.demand(
            (2..=10_000).contains(&count),
            "arch.voussoirs",
            || format!("{count} voussoirs are no arch"),
            "2 to 10000",
        );
        self.known_material("arch.material", &arch.material);
        self.known_interface("arch.interface", &arch.interface);
        if arch.rigid {
            self.stiffness_of_joints(&arch.interface);
        }
        self.elements("arch.mesh", arch.mesh, "arch.mesh");
    }

    fn rise(&mut self, arch: &DeckArch, rise: Length) {
        self.positive("arch.rise", rise);
        self.require(
            arch.span.is_some(),
            "arch.rise",
            || "a rise belongs to a `span`".to_owned(),
            "give span and rise, or radius and angle",
        );
        self.require(
            arch.angle.is_none(),
            "arch.angle",
            || "both `rise` and `angle` are given".to_owned(),
            "each follows from the other: leave out one",
        );
        let (rise, span) = (rise.get(), arch.span.map_or(f64::INFINITY, Quantity::get));
        self.require(
            rise <= 0.5 * span * (1.0 + ROUNDED),
            "arch.rise",
            || format!("a rise of {rise} mm over a span of {span} mm is more than a semicircle's"),
            "at most half the span",
        );
    }

    fn elements(&mut self, path: &str, mesh: [u32; 3], example: &str) {
        self.demand(
            mesh.iter().all(|n| *n > 0),
            path,
            || format!("{mesh:?} leaves no element"),
            &keys::example_at(example),
        );
    }

    pub(super) fn not_empty(&mut self, path: &str, names: Option<&Names>) {
        self.demand(
            names.is_none_or(|names| !names.0.is_empty()),
            path,
            || "the list is empty".to_owned(),
            "name a block or a face",
        );
    }

    /// Returns whether it is known if the scene consists of walls or blocks.
    pub(super) fn scene_is_known(&self) -> bool {
        !["wall", "walls", "blocks", "arch"]
            .iter()
            .any(|name| self.broken.whole(name))
    }

    /// Requires that a material exists, if one is named.
    pub(super) fn known_material<'n>(&mut self, path: &str, name: impl Into<Option<&'n String>>) {
        let Some(name) = name.into() else { return };
        if !self.deck.materials.contains_key(name) && !self.is_full() {
            let error = self.deck.unknown(path, "material", name, "materials");
            self.refer("materials", path, error);
        }
    }

    /// Requires that an interface exists, if one is named.
    pub(super) fn known_interface<'n>(&mut self, path: &str, name: impl Into<Option<&'n String>>) {
        let Some(name) = name.into() else { return };
        if !self.deck.interfaces.contains_key(name) && !self.is_full() {
            let error = self.deck.unknown(path, "interface", name, "interfaces");
            self.refer("interfaces", path, error);
        }
    }

    /// Adds the error of an unknown name of the section `of` at `path`, unless the section could not be read.
    pub(super) fn refer(&mut self, of: &str, path: &str, error: ModelError) {
        if !self.broken.whole(of) && !self.broken.holds(path) {
            self.errors.push(error.of_kind(ErrorKind::UnknownName));
        }
    }
}
