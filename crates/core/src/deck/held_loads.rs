//! Loads on nodes that supports or faces of steps hold in their direction. They move nothing.

use super::schema::Deck;
use crate::element::facet;
use crate::error::Warning;
use crate::model::Model;
use crate::model::loads::{Load, LoadOn};
use crate::model::scene::{Beam, BeamMotion, HeldBy, Step, Support};

/// Part of a load on held nodes from which on the warning says "all".
const ALL: f64 = 0.99;
/// Part of a load on held nodes above which there is a warning. A half is that of a pressure on all sides of a body of
/// which one is held.
const MUCH: f64 = 0.501;
/// Part of a load below which its component along an axis is rounding.
const ROUNDING: f64 = 1e-6;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Warnings about loads of which more than half acts on held nodes in the first step in which they act.
pub(super) fn held_loads(deck: &Deck, model: &Model) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let mut seen = vec![false; model.loads.len()];
    for (s, step) in model.steps.iter().enumerate() {
        let mut held: Option<[Held<'_>; 3]> = None;
        for (k, load) in model.loads.iter().enumerate() {
            let value = step.loads.get(k).copied().flatten();
            let Some(value) = value.filter(|value| !seen[k] && *value != [0.0; 3]) else {
                continue;
            };
            seen[k] = true;
            let held = held.get_or_insert_with(|| [0, 1, 2].map(|d| Held::of(model, step, d)));
            let said = &deck.steps[s].loads;
            let Some(l) = said.iter().position(|said| said.name == load.name) else {
                continue;
            };
            let found = findings(deck, load, &forces(model, load, value), held);
            let path = format!("steps.{s}.loads.{l}");
            warnings.extend(found.into_iter().map(|text| deck.warning(&path, text)));
        }
    }
    warnings
}

/// Forces of a load of this value at rest [N]; a node may come more than once.
fn forces(model: &Model, load: &Load, value: [f64; 3]) -> Vec<(u32, [f64; 3])> {
    let pressed = |area: [f64; 3]| area.map(|a| -value[0] * a);
    match &load.acts {
        LoadOn::Shares(shares) => {
            let force = |(n, share): &(u32, f64)| (*n, value.map(|v| v * share));
            shares.iter().map(force).collect()
        }
        LoadOn::Pressure(areas) => areas.iter().map(|(n, a)| (*n, pressed(*a))).collect(),
        LoadOn::Follower(facets) => {
            let of = facets.iter().flat_map(|facet| {
                let x = facet.map(|n| model.mesh.nodes[n as usize]);
                facet.iter().copied().zip(facet::area_vectors(&x))
            });
            of.map(|(n, area)| (n, pressed(area))).collect()
        }
    }
}

/// A support or a face that holds nodes along an axis.
#[derive(Clone, Copy)]
enum Holder<'a> {
    Support(&'a Support),
    Face(usize, &'a Beam),
}

/// Nodes that are held along an axis during a step.
struct Held<'a> {
    holders: Vec<Holder<'a>>,
    /// Index of a holder, or [`NONE`]. `[node]`
    by: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl<'a> Held<'a> {
    fn of(model: &'a Model, step: &Step, axis: usize) -> Self {
        let mut held = Self {
            holders: Vec::new(),
            by: vec![NONE; model.mesh.nodes.len()],
        };
        for (b, (beam, motion)) in model.beams.iter().zip(&step.motion).enumerate() {
            if !matches!(motion[axis], BeamMotion::Force(_)) {
                held.add(Holder::Face(b, beam), beam.nodes.iter().copied());
                for (n, _) in beam.free.iter().filter(|(_, d)| *d == axis) {
                    held.by[*n as usize] = NONE;
                }
            }
        }
        for support in &model.supports {
            if support.fixed[axis] && matches!(support.by, HeldBy::Ground) {
                held.add(Holder::Support(support), support.nodes.iter().copied());
            }
        }
        held
    }

    fn add(&mut self, holder: Holder<'a>, nodes: impl Iterator<Item = u32>) {
        let index = self.holders.len() as u32;
        self.holders.push(holder);
        for n in nodes {
            self.by[n as usize] = index;
        }
    }

    /// Sum of the magnitudes of forces along an axis, the part of it on held nodes, and the holders of these.
    fn part(&self, forces: &[(u32, [f64; 3])], axis: usize) -> (f64, f64, Vec<Holder<'a>>) {
        let (mut sum, mut on_held) = (0.0, 0.0);
        let mut used = vec![false; self.holders.len()];
        for (n, force) in forces {
            let size = force[axis].abs();
            sum += size;
            if let Some(used) = used.get_mut(self.by[*n as usize] as usize)
                && size > 0.0
            {
                *used = true;
                on_held += size;
            }
        }
        let holders = self.holders.iter().zip(used);
        let holders = holders.filter_map(|(holder, used)| used.then_some(*holder));
        (sum, on_held / sum, holders.collect())
    }
}

/// Texts about a load with these forces, one for each axis along which much of it acts on held nodes.
fn findings(
    deck: &Deck,
    load: &Load,
    forces: &[(u32, [f64; 3])],
    held: &[Held<'_>; 3],
) -> Vec<String> {
    let parts = [0, 1, 2].map(|d| held[d].part(forces, d));
    let largest = parts.iter().map(|(sum, ..)| *sum).fold(0.0, f64::max);
    let axes = parts.iter().zip(AXES);
    let much = axes.filter(|((sum, part, _), _)| *sum > ROUNDING * largest && *part > MUCH);
    let text = |((_, part, holders), axis): (&(f64, f64, Vec<Holder<'_>>), &str)| {
        let (how_much, what) = if *part > ALL {
            ("all".to_owned(), "it")
        } else {
            (format!("{:.0} %", 100.0 * part), "this part")
        };
        let who: Vec<String> = holders.iter().map(|h| called(deck, *h)).collect();
        let verb = if who.len() == 1 { "holds" } else { "hold" };
        let mut advice: Vec<String> = holders.iter().map(|h| remedy(deck, *h, axis)).collect();
        advice.dedup();
        format!(
            "{how_much} of `{}` along {axis} acts on nodes that {} {verb} there: {what} moves nothing ({})",
            load.name,
            who.join(" and "),
            advice.join("; ")
        )
    };
    much.map(text).collect()
}

/// Whether a face is the top of the clamped wall.
fn is_level_beam(deck: &Deck, beam: usize) -> bool {
    beam == 0 && deck.clamped().is_some()
}

fn called(deck: &Deck, holder: Holder<'_>) -> String {
    match holder {
        Holder::Support(support) => format!("the support on {}", support.name),
        Holder::Face(b, _) if is_level_beam(deck, b) => "the level beam on the wall".to_owned(),
        Holder::Face(_, beam) if beam.settles() => format!("the settlement {}", beam.name),
        Holder::Face(_, beam) => format!("the face {} of a step", beam.name),
    }
}

fn remedy(deck: &Deck, holder: Holder<'_>, axis: &str) -> String {
    match holder {
        Holder::Support(_) => {
            format!("load other nodes, or leave {axis} out of `fixed` of the support")
        }
        Holder::Face(b, _) if is_level_beam(deck, b) => match axis {
            "z" => "a drive with vertical = \"free\" leaves the beam free in z".to_owned(),
            _ => "the beam moves sideways only where a step drives it".to_owned(),
        },
        Holder::Face(_, beam) if beam.settles() => "load other nodes".to_owned(),
        Holder::Face(_, beam) => format!(
            "the preload or drive of {} leaves it free with free = [\"{axis}\"]; or drive it",
            beam.name
        ),
    }
}
