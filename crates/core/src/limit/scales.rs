//! Sizes of the forces of a scene. Bodies that act on each other, over joints, ties or springs, are a group with a size
//! of its own: a program has numbers near 1 in each group, however heavy the bodies are that are held or stand elsewhere.

use super::actions::Actions;
use super::bodies::{Bodies, Motion, Wrench};
use super::joints::Joint;
use super::rods::Rod;
use super::unknowns::Unknowns;

/// Strengths above this multiple of the dead loads are not reached and set no size.
const STRONG: f64 = 100.0;
/// Part of the largest load on a body of its group below which a load is small for a program that is solved to 1e-9.
const LIGHT: f64 = 1e-6;
/// The same below which a load is rounding.
const ROUNDING: f64 = 1e-14;

/// Forces in a group [N].
#[derive(Clone, Copy, Debug, Default)]
struct Forces {
    /// Sum of the dead loads on its bodies.
    sum: f64,
    /// The largest one of these.
    largest: f64,
    /// Largest force that a bond, a tie or a joint without crushing carries.
    strength: f64,
}

/// Sizes of the forces in the groups.
#[derive(Clone, Debug)]
pub struct ForceScales {
    /// Group of each body; none of a body that is held. `[body]`
    groups: Vec<Option<usize>>,
    /// Size of the forces [N]. `[group]`
    sizes: Vec<f64>,
    /// Factor of the live loads for the unknown λ of 1: in one group they are as large as the forces, in none larger.
    pub live: f64,
    /// Body with the least dead load, and the part that this is of the largest one in its group [-]; none if no part is
    /// below a millionth.
    pub light: Option<(usize, f64)>,
}

impl ForceScales {
    /// Sizes for the dead and live loads of a scene. `strength`: compressive strength of the joints [MPa].
    pub fn of(
        bodies: &Bodies,
        (joints, rods): (&[Joint], &[Rod]),
        unknowns: &Unknowns,
        actions: &Actions,
        strength: Option<f64>,
    ) -> Self {
        let (groups, count) = groups(bodies, joints, rods, unknowns);
        let own = |b: usize| load(&bodies.all[b].motions, &actions.dead[b]);
        let loads: Vec<f64> = (0..bodies.all.len()).map(own).collect();
        let mut forces = vec![Forces::default(); count];
        for (group, load) in groups.iter().zip(&loads) {
            if let Some(group) = group {
                forces[*group].sum += load;
                forces[*group].largest = load.max(forces[*group].largest);
            }
        }
        let of_joints = joints.iter().map(|joint| {
            let bond = joint.strength.cohesion.max(joint.strength.tension);
            let force = bond.max(strength.unwrap_or(0.0)) * joint.area;
            (joint.bodies, force)
        });
        let of_rods = rods.iter().map(|rod| (rod.bodies(), rod.most));
        for (pair, force) in of_joints.chain(of_rods.filter(|(_, most)| most.is_finite())) {
            if let Some(group) = pair.into_iter().find_map(|body| groups[body]) {
                forces[group].strength = force.max(forces[group].strength);
            }
        }
        let mut scales = Self {
            light: light(&groups, &loads, &forces),
            sizes: sizes(&forces),
            groups,
            live: 1.0,
        };
        scales.live = scales.live(unknowns, &actions.live);
        scales
    }

    /// Size of the forces on a body [N]; 1 N if it is held.
    pub fn of_body(&self, body: usize) -> f64 {
        self.groups[body].map_or(1.0, |group| self.sizes[group])
    }

    /// Size of the force between two bodies; the largest of all if both are held [N].
    pub fn between(&self, pair: [usize; 2]) -> f64 {
        match pair.into_iter().find_map(|body| self.groups[body]) {
            Some(group) => self.sizes[group],
            None => self.sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max),
        }
    }

    /// Sums over the bodies of each group. `[group]`
    pub fn sums(&self, of: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.sizes.len()];
        for (body, group) in self.groups.iter().enumerate() {
            if let Some(group) = group {
                sums[*group] += of(body);
            }
        }
        sums
    }

    /// Group of a body; none if it is held.
    pub fn group(&self, body: usize) -> Option<usize> {
        self.groups[body]
    }

    /// Factor of the live loads that makes them as large as the forces of the group for which it is least.
    fn live(&self, unknowns: &Unknowns, live: &[Wrench]) -> f64 {
        let power = |b: usize| unknowns.stands_for(b) * load(&unknowns.motions[b], &live[b]);
        let powers = self.sums(power);
        let loaded = self
            .sizes
            .iter()
            .zip(&powers)
            .filter(|(_, sum)| **sum > 0.0);
        let factors = loaded.map(|(size, sum)| size / sum);
        let least = factors.fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { 1.0 }
    }
}

/// Load on the motions of a body: the sum of the powers on them [N].
fn load(motions: &[Motion], wrench: &Wrench) -> f64 {
    motions.iter().map(|m| m.power(wrench).abs()).sum()
}

/// Group of each body that can move, and the number of groups. A body and its mirror image, which share their unknowns,
/// are in one group.
fn groups(
    bodies: &Bodies,
    joints: &[Joint],
    rods: &[Rod],
    unknowns: &Unknowns,
) -> (Vec<Option<usize>>, usize) {
    let count = bodies.all.len();
    let moves = |body: usize| !bodies.all[body].motions.is_empty();
    let mut parents: Vec<usize> = (0..count).collect();
    let mut join = |[a, b]: [usize; 2]| {
        if moves(a) && moves(b) {
            let roots = [root(&mut parents, a), root(&mut parents, b)];
            parents[roots[0].max(roots[1])] = roots[0].min(roots[1]);
        }
    };
    for joint in joints {
        join(joint.bodies);
    }
    for rod in rods {
        join(rod.bodies());
    }
    for reaction in &bodies.reactions {
        let own = reaction.iter().map(|(body, _)| *body);
        let mut moving = own.filter(|body| moves(*body));
        if let Some(first) = moving.next() {
            moving.for_each(|other| join([first, other]));
        }
    }
    if let Some(mirror) = &unknowns.mirror {
        (0..count).for_each(|body| join([body, mirror.image_of(body)]));
    }
    let mut numbers = vec![None; count];
    let mut next = 0;
    let groups = (0..count).map(|body| {
        moves(body).then(|| {
            *numbers[root(&mut parents, body)].get_or_insert_with(|| {
                next += 1;
                next - 1
            })
        })
    });
    (groups.collect(), next)
}

/// First body of a group, with shorter ways to it from now on.
fn root(parents: &mut [usize], mut body: usize) -> usize {
    while parents[body] != body {
        parents[body] = parents[parents[body]];
        body = parents[body];
    }
    body
}

/// Sizes of the forces: the sum of the dead loads of a group, or the largest strength; 1 N if it has neither. In all
/// groups with dead loads it is the same multiple of the largest load on a body, so that all are solved as exactly.
fn sizes(groups: &[Forces]) -> Vec<f64> {
    let heaviest = groups
        .iter()
        .fold(0.0, |most: f64, own| most.max(own.largest));
    let is_loaded = |own: &Forces| own.largest > ROUNDING * heaviest;
    let size = |own: &Forces| own.strength.clamp(own.sum, STRONG * own.sum);
    let loaded = groups.iter().filter(|own| is_loaded(own));
    let multiple = loaded.fold(0.0, |most: f64, own| most.max(size(own) / own.largest));
    let strengths = groups.iter().map(|own| own.strength);
    let other = strengths.fold(multiple * heaviest, f64::max);
    let of_group = |own: &Forces| {
        if is_loaded(own) {
            multiple * own.largest
        } else if own.strength > 0.0 {
            own.strength
        } else if other > 0.0 {
            other
        } else {
            1.0
        }
    };
    groups.iter().map(of_group).collect()
}

/// Body with the least load, as a part of the largest one in its group, if this part is small.
fn light(groups: &[Option<usize>], loads: &[f64], forces: &[Forces]) -> Option<(usize, f64)> {
    let bodies = groups.iter().zip(loads).enumerate();
    let parts =
        bodies.filter_map(|(body, (group, load))| Some((body, load / forces[(*group)?].largest)));
    let small = parts.filter(|(_, part)| (ROUNDING..LIGHT).contains(part));
    small.min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forces(sum: f64, largest: f64, strength: f64) -> Forces {
        Forces {
            sum,
            largest,
            strength,
        }
    }

    #[test]
    fn a_group_has_the_size_of_its_loads_or_strengths() {
        for (sum, strength, size) in [
            (8.0, 0.0, 8.0),
            (8.0, 20.0, 20.0),
            // Far above the loads, and alone.
            (8.0, 1e6, 800.0),
            (0.0, 20.0, 20.0),
            (0.0, 0.0, 1.0),
        ] {
            assert_eq!(sizes(&[forces(sum, sum, strength)]), [size]);
        }
    }

    #[test]
    fn a_light_group_has_a_size_of_its_own() {
        // A wall of four bodies, a stone beside it, a body without load, and one that only a bond holds.
        let wall = forces(8.0, 2.0, 0.0);
        let groups = [
            wall,
            forces(1e-9, 1e-9, 0.0),
            forces(0.0, 0.0, 0.0),
            forces(0.0, 0.0, 3.0),
        ];
        assert_eq!(sizes(&groups), [8.0, 4e-9, 8.0, 3.0]);
    }

    #[test]
    fn a_light_body_is_found_in_its_own_group() {
        let groups = [Some(0), None, Some(1), Some(0), Some(1)];
        let own = [forces(1e3, 1e3, 0.0), forces(1.0, 1.0, 0.0)];
        // The second body is held, and the last one has no load.
        assert_eq!(light(&groups, &[1e3, 1e9, 1.0, 1.0, 0.0], &own), None);
        let found = light(&groups, &[1e3, 1e9, 1.0, 1e-5, 0.0], &own);
        assert_eq!(found, Some((3, 1e-5 / 1e3)));
    }
}
