//! Strategies `simplified` and `rigid`: derives the walls of a coarser model from those of a detailed one
//! (theory/strategies.md).
//!
//! Units grow to the middle of their joints and keep their material, or become rigid. Interfaces without thickness take
//! over the stiffness, strength and energy of mortar and units. The derived deck has explicit values and could be written
//! by hand.

mod joints;
mod shares;
mod typical;
mod units;

use super::quantity::Quantity;
use super::schema::{
    Deck, DeckStep, Interface, Material, StepKind, Strategy, Subdivision, Vertical, Wall,
};
use super::wall_defaults;
use crate::model::scene::ContactPoints;
use joints::{Joint, Layers};
use shares::Shares;
use std::collections::BTreeSet;
use typical::Typical;
use units::Solid;

/// Mesh of an expanded unit [length, height, thickness].
const MESH: Subdivision = Subdivision {
    length: 2,
    height: 1,
    thickness: 1,
};

/// Parts of a facet along a wall, each with its own contact points: expanded units have large facets, whose Gauss points
/// would move pivots far inwards.
const PARTS_ALONG: u32 = 2;

/// Part of the units from which their material is that of all but for rounding.
const WHOLE: f64 = 1.0 - 1e-9;

/// Part of a density by which that of unit and mortar may differ from it unnoticed.
const SAME_DENSITY: f64 = 1e-9;

/// Elements, or parts of a facet, through a wall that is bent out of its plane. One element there carries too much: 17 %
/// in a free-standing wall under wind.
const THROUGH: u32 = 3;

/// Replaces the walls of a deck by those of its strategy. Walls that are rigid or expanded stay.
pub(super) fn derive(deck: &mut Deck) {
    if !matches!(deck.strategy, Strategy::Simplified | Strategy::Rigid) {
        return;
    }
    let walls = deck.walls().filter(|(.., w)| !w.rigid && !w.expanded);
    let walls = walls.map(|(path, name, wall)| (path, name.to_owned(), wall.clone()));
    let walls: Vec<(String, String, Wall)> = walls.collect();
    let mut parts = [1; 3];
    let first = walls.first().map(|(.., wall)| wall.clone());
    for (path, name, wall) in walls {
        // Dry joints have points on the edges of their facets.
        let dry = deck.interfaces.get(&wall.interface);
        let dry = dry.is_some_and(Interface::is_dry) && deck.contact.points == ContactPoints::Auto;
        let [along, through] = axes(&wall);
        if !dry {
            parts[along] = parts[along].max(PARTS_ALONG);
        }
        let mut steps = deck.steps.iter();
        let bends = steps.any(|step| wall_defaults::bends(step, &name, &wall));
        let said = deck.simplified.as_ref().and_then(|said| said.mesh);
        deck.cautions.extend(mixed(&path, &wall));
        let mut derived = Derivation::of(deck, &wall).wall();
        if bends && said.is_none() && !derived.rigid {
            derived.mesh.thickness = THROUGH;
        } else if bends && !dry {
            parts[through] = parts[through].max(THROUGH);
        }
        if let Some(wall) = deck.wall_mut(&path) {
            *wall = derived;
        }
    }
    if let Some(wall) = first.filter(|_| deck.strategy == Strategy::Rigid) {
        Derivation::of(deck, &wall).give_stiffness();
    }
    let given = deck.contact.parts;
    deck.contact.parts = [0, 1, 2].map(|d| given[d].max(parts[d]));
}

/// Axes nearest to the directions along and through a wall, as parts of facets follow them.
fn axes(wall: &Wall) -> [usize; 2] {
    let (along, through) = wall.axes();
    [along, through].map(|axis| {
        let mut way = [0.0; 3];
        way[axis] = 1.0;
        let way = wall.rotate.map_or(way, |rotate| rotate.turn(way));
        let nearest = (0..3).max_by(|a, b| way[*a].abs().total_cmp(&way[*b].abs()));
        nearest.unwrap_or(axis)
    })
}

/// A caution about a wall whose units differ in their material: its joints have the stiffness and strength of one.
fn mixed(path: &str, wall: &Wall) -> Option<(String, String)> {
    let typical = Typical::of(wall);
    (typical.share < WHOLE).then(|| {
        let message = format!(
            "its joints are derived as between units of {}, which are {:.0} % of them; those of other units are not told \
             apart",
            typical.material,
            100.0 * typical.share
        );
        (format!("{path}.pattern"), message)
    })
}

/// Whether a step drives the level beam without letting it rise, so that the wall is pressed as it is driven.
fn keeps_top_down(step: &DeckStep) -> bool {
    let beam = step.face.is_none() && step.spring.is_none() && step.beam.is_none();
    let beam = beam && step.settlement.is_none();
    step.kind == StepKind::Drive && beam && step.vertical != Some(Vertical::Free)
}

/// The name of something derived, with a number if it is taken by another.
fn free_name(kind: &str, taken: impl Fn(&str) -> bool) -> String {
    let mut name = kind.to_owned();
    let mut number = 1;
    while taken(&name) {
        number += 1;
        name = format!("{kind} {number}");
    }
    name
}

/// Derivation of one wall.
struct Derivation<'a> {
    deck: &'a mut Deck,
    wall: &'a Wall,
    /// Sizes of its units.
    typical: Typical,
    unit: Solid,
    /// The mortar; none in a dry wall.
    mortar: Option<Solid>,
}

impl<'a> Derivation<'a> {
    /// Materials that are unknown were rejected when the deck was read.
    fn of(deck: &'a mut Deck, wall: &'a Wall) -> Self {
        let solid = |name: &String| deck.materials.get(name).map(|m| Solid::of(name, m));
        let typical = Typical::of(wall);
        let unit = solid(&typical.material).unwrap_or_default();
        let mortar = wall.mortar_material.as_ref().and_then(solid);
        Self {
            deck,
            wall,
            typical,
            unit,
            mortar,
        }
    }

    /// The wall with expanded units, whose materials and interfaces are added to the deck.
    fn wall(mut self) -> Wall {
        let is_rigid = self.deck.strategy == Strategy::Rigid;
        let said = self.deck.simplified.clone().unwrap_or_default();
        let Typical {
            along,
            through,
            height,
            ..
        } = self.typical;
        let bed = self.wall.bed_joint.get();
        let head = self.wall.head_joint.get();
        let collar = self.wall.collar_joint.map_or(head, Quantity::get);
        let filled = self.wall.head_filling.get();
        let interface = &self.wall.interface;
        let of = |name: &Option<String>| name.clone().unwrap_or_else(|| interface.clone());
        let (heads, collars) = (
            of(&self.wall.head_interface),
            of(&self.wall.collar_interface),
        );
        let joints = [
            (interface.clone(), "bed", [height, bed], 1.0),
            (heads, "head", [along, head], filled),
            (collars, "collar", [through, collar], 1.0),
        ];
        let [bed, head, collar] = joints.map(|(name, place, [unit, joint], filled)| {
            let layers = Layers {
                unit,
                joint,
                filled,
            };
            self.interface(&name, place, layers)
        });
        let mut wall = self.wall.clone();
        wall.expanded = true;
        wall.mortar_material = None;
        wall.head_filling = Quantity::new(1.0);
        wall.head_interface = (head != bed).then_some(head);
        wall.collar_interface = (collar != bed).then_some(collar);
        wall.interface = bed;
        wall.mesh = said.mesh.unwrap_or(MESH);
        wall.rigid = is_rigid;
        wall.unit_material = self.with_mortar();
        if !is_rigid && said.unit_cracks.unwrap_or(false) {
            wall.crack_interface = self.crack();
            if wall.crack_interface.is_some() {
                self.make_elastic(&mut wall);
            }
        }
        wall
    }

    /// Adds the material of the units with the density that unit and mortar have together, and returns its name: that of
    /// a unit with half of the joints around it.
    fn with_mortar(&mut self) -> String {
        let name = &self.wall.unit_material;
        let materials = &self.deck.materials;
        let mortar = self.wall.mortar_material.as_ref();
        let mortar = mortar.and_then(|mortar| materials.get(mortar));
        let (Some(unit), Some(mortar)) = (materials.get(name), mortar) else {
            return name.clone();
        };
        let shares = Shares::of(self.wall);
        let density = shares.units * unit.density.get() + shares.mortar * mortar.density.get();
        if (density - unit.density.get()).abs() <= SAME_DENSITY * density {
            return name.clone();
        }
        let expanded = Material {
            density: Quantity::new(density),
            ..unit.clone()
        };
        let (kind, path) = (format!("{name} (with mortar)"), format!("materials.{name}"));
        let taken = |name: &str| materials.get(name).is_some_and(|known| *known != expanded);
        let name = free_name(&kind, taken);
        let note = format!("material {name}: density {:.0} kg/m^3", 1e12 * density);
        if !self.deck.derived.contains(&note) {
            self.deck.derived.push(note);
        }
        self.deck.stands_for(format!("materials.{name}"), path);
        self.deck.materials.insert(name.clone(), expanded);
        name
    }

    /// Replaces the material of the units by an elastic one.
    fn make_elastic(&mut self, wall: &mut Wall) {
        if let Some(of) = self.deck.materials.get(&wall.unit_material) {
            let elastic = Material::elastic(of.E, of.nu, of.density);
            let name = format!("{} (elastic)", wall.unit_material);
            self.deck.materials.insert(name.clone(), elastic);
            wall.unit_material = name;
        }
    }

    /// Adds the interface of a kind of joints to the deck and returns its name.
    fn interface(&mut self, name: &str, place: &str, layers: Layers) -> String {
        let Some(of) = self.deck.interfaces.get(name).cloned() else {
            return name.to_owned(); // rejected when the deck was read
        };
        let said = self.deck.simplified.clone().unwrap_or_default();
        let joint = Joint {
            of: &of,
            unit: &self.unit,
            mortar: self.mortar.as_ref(),
            layers,
            said: &said,
            is_rigid: self.deck.strategy == Strategy::Rigid,
        };
        let (derived, notes) = joint.derive();
        let rises_not = self.deck.steps.iter().any(keeps_top_down);
        let caution = joint
            .caution(&derived)
            .filter(|_| place == "bed" && rises_not);
        let cautions = caution.map(|message| (format!("interfaces.{name}"), message));
        self.deck.cautions.extend(cautions);
        let kind = format!("{name} ({place})");
        for note in notes {
            let note = format!("interface {kind}: {note}");
            if !self.deck.derived.contains(&note) {
                self.deck.derived.push(note);
            }
        }
        self.add(&kind, derived, &format!("interfaces.{name}"))
    }

    /// Gives joints of the rigid units with blocks, beams and layers a stiffness as a bed joint of the wall has it, where
    /// the deck gives none.
    fn give_stiffness(&mut self) {
        let unit = self.typical.height;
        let joint = self.wall.bed_joint.get();
        let deck = &self.deck;
        let named = deck.contacts.iter().map(|contact| &contact.interface);
        let named = named.chain(deck.beams.iter().map(|beam| &beam.interface));
        let named = named.chain(deck.layers.iter().map(|layer| &layer.interface));
        let named = named.chain(&deck.contact.general);
        let lacks = |name: &&String| {
            let known = deck.interfaces.get(*name);
            known.is_some_and(|interface| interface.normal_stiffness.is_none())
        };
        let lacking: BTreeSet<String> = named.filter(lacks).cloned().collect();
        for name in lacking {
            let layers = Layers {
                unit,
                joint,
                filled: 1.0,
            };
            let derived = self.interface(&name, "bed", layers);
            let deck = &mut *self.deck;
            let contacts = deck.contacts.iter_mut().map(|c| &mut c.interface);
            let named = contacts.chain(deck.beams.iter_mut().map(|beam| &mut beam.interface));
            let named = named.chain(deck.layers.iter_mut().map(|layer| &mut layer.interface));
            for own in named.chain(&mut deck.contact.general) {
                if *own == name {
                    own.clone_from(&derived);
                }
            }
        }
    }

    /// Adds the interface in the middle of units to the deck; none if they cannot crack.
    fn crack(&mut self) -> Option<String> {
        let of = self.deck.interfaces.get(&self.wall.interface)?;
        let derived = self.unit.crack(of, self.typical.along)?;
        let (kind, path) = (
            format!("{} (crack)", self.wall.unit_material),
            format!("materials.{}", self.wall.unit_material),
        );
        Some(self.add(&kind, derived, &path))
    }

    /// Adds an interface under this name, or a similar one if it is taken by another. Errors refer to `path`.
    fn add(&mut self, kind: &str, derived: Interface, path: &str) -> String {
        let interfaces = &self.deck.interfaces;
        let taken = |name: &str| interfaces.get(name).is_some_and(|known| *known != derived);
        let name = free_name(kind, taken);
        self.deck
            .stands_for(format!("interfaces.{name}"), path.to_owned());
        self.deck.interfaces.insert(name.clone(), derived);
        name
    }
}
