//! The kept half of a model: everything on one side of a plane, with the plane fixed across itself, and everything
//! across it, whose nodes beyond the plane are images of those before it (theory/symmetry.md, Algorithm).

use std::collections::{BTreeMap, BTreeSet};

use super::images::Images;
use crate::model::axis::Axis;
use crate::model::loads::{Load, LoadOn};
use crate::model::mesh::Reflected;
use crate::model::probes::Probe;
use crate::model::scene::{
    Beam, BeamMotion, ContactSurfaces, Gravity, HeldBy, Spring, Step, Support,
};
use crate::model::sections::Section;
use crate::model::{Mesh, Model};

/// Part of a vector's size that its component across the plane may have by rounding.
const ROUNDING: f64 = 1e-9;

/// A half of a model, and the numbers of its nodes, elements and facets.
#[derive(Clone, Debug)]
pub(crate) struct Half {
    pub model: Model,
    /// Number in the half. None for nodes beyond the plane, which are images of kept ones. `[node]`
    pub node: Vec<Option<u32>>,
    /// Nodes beyond the plane of elements across it, numbered after the others.
    pub beyond: Vec<u32>,
    /// Number in the half. `[element]`
    pub element: Vec<Option<u32>>,
    /// Number in the half. `[slave facet]`
    pub slave: Vec<Option<u32>>,
}

/// The half below the plane, if supports, loads and probes are mirrored like the mesh.
#[expect(clippy::too_many_lines, reason = "cuts each part of a model")]
pub(super) fn half(model: &Model, images: &Images) -> Option<Half> {
    let contact = &model.contact;
    // Ties and floors are tied to elements of both sides.
    let has_ties = !model.ties.is_empty() || !model.floors.is_empty();
    if contact.general.is_some() || has_ties {
        return None;
    }
    let node = numbered(images.side.iter().map(|side| *side <= 0));
    let mesh = &model.mesh;
    let element = numbered(mesh.elements.iter().map(|nodes| images.keeps(nodes)));
    let keeps = |facet: &[u32; 4]| images.keeps(facet) || images.lies_in(facet);
    let slave = numbered(contact.slave_facets.iter().map(keeps));
    let beyond = beyond(model, images);
    let kept = node.iter().flatten().count() as u32;
    let mut any = node.clone();
    for (number, n) in (kept..).zip(&beyond) {
        any[*n as usize] = Some(number);
    }
    let cut = Cut {
        images,
        node: &node,
        any: &any,
        beyond: &beyond,
    };
    let beams = model.beams.iter().map(|beam| cut.beam(beam));
    let supports = model.supports.iter().map(|support| cut.support(support));
    let mut supports = supports.collect::<Option<Vec<_>>>()?;
    supports.push(cut.plane());
    let probes = model.probes.iter().map(|probe| cut.probe(probe));
    let sections = model.sections.iter();
    let sections = sections.map(|section| cut.section(section, mesh, &element));
    let springs = model.springs.iter().map(|spring| cut.spring(spring));
    let loads = model.loads.iter().map(|load| cut.load(load));
    let steps = model.steps.iter().map(|step| cut.step(step, model));
    let half = Model {
        title: model.title.clone(),
        mesh: cut.mesh(mesh),
        materials: model.materials.clone(),
        formulation: model.formulation,
        contact: cut.contact(contact),
        beams: beams.collect::<Option<_>>()?,
        supports,
        initial_velocity: cut.velocity(&model.initial_velocity)?,
        springs: springs.collect::<Option<_>>()?,
        ties: Vec::new(),
        floors: Vec::new(),
        limit_only: model.limit_only,
        layers: model.layers.clone(),
        probes: probes.collect::<Option<_>>()?,
        sections: sections.collect::<Option<_>>()?,
        loads: loads.collect::<Option<_>>()?,
        steps: steps.collect::<Option<_>>()?,
        output: model.output.clone(),
        warnings: Vec::new(),
        assumed: Vec::new(),
        fidelity: model.fidelity,
    };
    Some(Half {
        model: half,
        node,
        beyond,
        element,
        slave,
    })
}

/// Nodes above the plane of elements and facets across it, and of facets in it. Ascending.
fn beyond(model: &Model, images: &Images) -> Vec<u32> {
    let contact = &model.contact;
    let elements = model.mesh.elements.iter();
    let across = elements.filter(|e| images.lies_across(*e)).flatten();
    let facets = contact.slave_facets.iter().chain(&contact.master_facets);
    let of_plane = |f: &&[u32; 4]| images.lies_across(*f) || images.lies_in(*f);
    let nodes = across.chain(facets.filter(of_plane).flatten());
    let beyond = nodes.filter(|n| images.side[**n as usize] > 0);
    let beyond: BTreeSet<u32> = beyond.copied().collect();
    beyond.into_iter().collect()
}

/// Numbers of the kept items.
fn numbered(kept: impl Iterator<Item = bool>) -> Vec<Option<u32>> {
    let mut next = 0;
    let number = |keeps: bool| {
        keeps.then(|| {
            next += 1;
            next - 1
        })
    };
    kept.map(number).collect()
}

struct Cut<'a> {
    images: &'a Images,
    node: &'a [Option<u32>],
    /// The same, with numbers of nodes beyond the plane.
    any: &'a [Option<u32>],
    beyond: &'a [u32],
}

impl Cut<'_> {
    /// Numbers of those nodes that are kept, or beyond the plane in elements across it.
    fn kept(&self, nodes: &[u32]) -> Vec<u32> {
        let kept = nodes.iter().filter_map(|n| self.any[*n as usize]);
        kept.collect()
    }

    /// Numbers of the nodes of a kept element or facet.
    fn cell<const N: usize>(&self, nodes: &[u32; N]) -> Option<[u32; N]> {
        let kept = self.images.keeps(nodes);
        kept.then(|| <[u32; N]>::try_from(self.kept(nodes)).ok())?
    }

    /// Numbers of the nodes of a kept facet of a joint. Of a joint in the plane both faces are kept.
    fn facet(&self, nodes: &[u32; 4]) -> Option<[u32; 4]> {
        if self.images.lies_in(nodes) {
            return <[u32; 4]>::try_from(self.kept(nodes)).ok();
        }
        self.cell(nodes)
    }

    /// Number of a kept node, or of the image of another.
    fn either(&self, n: u32) -> Option<u32> {
        self.node[n as usize].or_else(|| self.node[self.images.node[n as usize] as usize])
    }

    /// Whether a vector lies in the plane.
    fn stays(&self, v: [f64; 3]) -> bool {
        let size = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        v[self.images.axis].abs() <= ROUNDING * size
    }

    /// Kept facets, with their numbers in the whole.
    fn facets(&self, facets: &[[u32; 4]]) -> Vec<(usize, [u32; 4])> {
        let all = facets.iter().enumerate();
        all.filter_map(|(f, nodes)| Some((f, self.cell(nodes)?)))
            .collect()
    }

    fn mesh(&self, mesh: &Mesh) -> Mesh {
        let mut half = Mesh {
            names: mesh.names.clone(),
            walls: mesh.walls.clone(),
            ..Mesh::default()
        };
        for (n, x) in mesh.nodes.iter().enumerate() {
            if self.node[n].is_some() {
                half.nodes.push(*x);
            }
        }
        half.reflected = self.reflected(mesh);
        let beyond = self.beyond.iter();
        half.nodes.extend(beyond.map(|n| mesh.nodes[*n as usize]));
        for (e, nodes) in mesh.elements.iter().enumerate() {
            if let Some(nodes) = self.cell(nodes) {
                half.elements.push(nodes);
                half.material.push(mesh.material[e]);
                half.unit.push(mesh.unit[e]);
                half.course.push(mesh.course[e]);
            }
        }
        half
    }

    /// Images in earlier planes and in this one.
    fn reflected(&self, mesh: &Mesh) -> Vec<Reflected> {
        let kept = mesh.reflected.iter().filter_map(|image| {
            Some(Reflected {
                node: self.node[image.node as usize]?,
                of: self.node[image.of as usize]?,
                ..*image
            })
        });
        let beyond = self.beyond.iter().filter_map(|n| {
            let own = self.images.node[*n as usize];
            let before = mesh.reflected(own);
            let mut sign = before.map_or([1.0; 3], |image| image.sign);
            sign[self.images.axis] = -1.0;
            Some(Reflected {
                node: self.any[*n as usize]?,
                of: self.node[before.map_or(own, |image| image.of) as usize]?,
                sign,
            })
        });
        kept.chain(beyond).collect()
    }

    fn contact(&self, contact: &ContactSurfaces) -> ContactSurfaces {
        let mut half = ContactSurfaces {
            laws: contact.laws.clone(),
            law_names: contact.law_names.clone(),
            points: contact.points,
            search_radius: contact.search_radius,
            ..ContactSurfaces::default()
        };
        let axis = self.images.axis;
        let mut planes = Vec::new();
        for (f, facet) in contact.slave_facets.iter().enumerate() {
            let Some(nodes) = self.facet(facet) else {
                continue;
            };
            half.add_slave(nodes, contact.slave_body[f], contact.slave_law[f]);
            half.slave_part.extend(contact.slave_part.get(f));
            half.slave_points.extend(contact.slave_points.get(f));
            let mut lies_in = contact.planes(f);
            lies_in[axis] |= self.images.lies_in(facet);
            planes.push(lies_in);
        }
        if planes.as_flattened().contains(&true) {
            half.slave_planes = planes;
        }
        for (facet, body) in contact.master_facets.iter().zip(&contact.master_body) {
            if let Some(nodes) = self.facet(facet) {
                half.add_master(nodes, *body);
            }
        }
        half
    }

    fn beam(&self, beam: &Beam) -> Option<Beam> {
        // The shape of a settlement may be any.
        let mirrored =
            self.images.hold_together(&beam.nodes) && self.stays(beam.normal) && !beam.settles();
        mirrored.then(|| Beam {
            name: beam.name.clone(),
            nodes: self.kept(&beam.nodes),
            area: 0.5 * beam.area,
            normal: beam.normal,
            shape: Vec::new(),
            free: Vec::new(),
            depth: beam.depth,
        })
    }

    fn support(&self, support: &Support) -> Option<Support> {
        let mirrored = self.images.hold_together(&support.nodes);
        mirrored.then(|| Support {
            nodes: self.kept(&support.nodes),
            ..support.clone()
        })
    }

    /// Spring of half the stiffness on the mean of all nodes, where images stand for nodes that are not kept. Across
    /// the plane it has no stiffness.
    fn spring(&self, spring: &Spring) -> Option<Spring> {
        let mut stiffness = spring.stiffness.map(|k| 0.5 * k);
        stiffness[self.images.axis] = 0.0;
        let nodes = spring.nodes.iter().map(|n| self.either(*n));
        let mirrored = self.images.hold_together(&spring.nodes);
        mirrored.then_some(Spring {
            name: spring.name.clone(),
            nodes: nodes.collect::<Option<_>>()?,
            stiffness,
        })
    }

    /// Support of the plane.
    fn plane(&self) -> Support {
        let Images { axis, at, .. } = *self.images;
        let mut fixed = [false; 3];
        fixed[axis] = true;
        let nodes = (0..self.node.len()).filter(|n| self.images.side[*n] == 0);
        Support {
            name: format!("symmetry-{}", Axis::NAMES[axis]),
            nodes: nodes.filter_map(|n| self.node[n]).collect(),
            fixed,
            by: HeldBy::Plane { axis, at },
        }
    }

    /// Images stand for nodes that are not kept. Their motion across the plane has the opposite sign.
    fn probe(&self, probe: &Probe) -> Option<Probe> {
        let across = probe.direction[self.images.axis] != 0.0;
        let all = || probe.nodes.iter().chain(&probe.minus);
        let is_kept = |n: &u32| self.node[*n as usize].is_some();
        let turned = across && !all().any(is_kept);
        if across && !turned && !all().all(is_kept) {
            return None;
        }
        let place = |nodes: &[u32]| {
            let place: Vec<u32> = nodes.iter().filter_map(|n| self.either(*n)).collect();
            let mut times = BTreeMap::new();
            for n in &place {
                *times.entry(*n).or_insert(0) += 1;
            }
            let mut counts = times.values();
            let first = counts.next();
            // A node in the plane counts once. A node beside it counts again for its image.
            let evenly = counts.all(|count| Some(count) == first);
            if evenly {
                times.into_keys().collect()
            } else {
                place
            }
        };
        let mut direction = probe.direction;
        if turned {
            direction[self.images.axis] *= -1.0;
        }
        Some(Probe {
            nodes: place(&probe.nodes),
            minus: place(&probe.minus),
            direction,
            ..probe.clone()
        })
    }

    /// The kept elements of both sides, if each side is its own image. `element`: numbers in the half.
    fn section(&self, section: &Section, mesh: &Mesh, element: &[Option<u32>]) -> Option<Section> {
        let half = |elements: &[u32]| {
            let mut nodes: Vec<u32> = elements
                .iter()
                .flat_map(|e| mesh.elements[*e as usize])
                .collect();
            nodes.sort_unstable();
            nodes.dedup();
            let kept = elements.iter().filter_map(|e| element[*e as usize]);
            let mirrored = self.images.hold_together(&nodes);
            mirrored.then(|| kept.collect())
        };
        let lies_along = section.directions[0][self.images.axis] == 0.0;
        lies_along.then_some(Section {
            above: half(&section.above)?,
            below: half(&section.below)?,
            ..section.clone()
        })
    }

    fn load(&self, load: &Load) -> Option<Load> {
        let images = self.images;
        let is_in_plane = |n: u32| images.side[n as usize] == 0;
        let part = |n: u32| if is_in_plane(n) { 0.5 } else { 1.0 };
        let acts = match &load.acts {
            LoadOn::Follower(facets) => {
                let mut all: Vec<[u32; 4]> = facets.clone();
                for facet in &mut all {
                    facet.sort_unstable();
                }
                all.sort_unstable();
                let mirrored = facets.iter().all(|facet| {
                    let mut image = facet.map(|n| images.node[n as usize]);
                    image.sort_unstable();
                    let lies_in = facet.iter().all(|n| is_in_plane(*n));
                    all.binary_search(&image).is_ok() && !lies_in
                });
                mirrored.then(|| {
                    LoadOn::Follower(self.facets(facets).into_iter().map(|(_, f)| f).collect())
                })
            }
            LoadOn::Pressure(areas) => {
                let areas = self.shares(areas, |area, other| {
                    let size = area.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
                    let image = images.of_vector(other);
                    (0..3).all(|i| (area[i] - image[i]).abs() <= ROUNDING * size)
                })?;
                let halved = |(n, area): &(u32, [f64; 3])| {
                    (
                        self.node[*n as usize].unwrap_or(*n),
                        area.map(|a| part(*n) * a),
                    )
                };
                Some(LoadOn::Pressure(areas.iter().map(halved).collect()))
            }
            LoadOn::Shares(shares) => {
                let shares = self.shares(shares, |a, b| (a - b).abs() <= ROUNDING * a.abs())?;
                let halved = |(n, share): &(u32, f64)| {
                    (self.node[*n as usize].unwrap_or(*n), part(*n) * share)
                };
                Some(LoadOn::Shares(shares.iter().map(halved).collect()))
            }
        }?;
        Some(Load {
            acts,
            ..load.clone()
        })
    }

    /// Shares of kept nodes, if those of their images are equal. Node numbers are still those of the whole.
    fn shares<T: Copy>(
        &self,
        shares: &[(u32, T)],
        alike: impl Fn(T, T) -> bool,
    ) -> Option<Vec<(u32, T)>> {
        let mut by_node = shares.to_vec();
        by_node.sort_by_key(|(n, _)| *n);
        if by_node.windows(2).any(|pair| pair[0].0 == pair[1].0) {
            return None;
        }
        let of = |n: u32| {
            let k = by_node.binary_search_by_key(&n, |(n, _)| *n).ok()?;
            Some(by_node[k].1)
        };
        let mirrored = |(n, share): &(u32, T)| {
            of(self.images.node[*n as usize]).is_some_and(|image| alike(*share, image))
        };
        let is_kept = |(n, _): &&(u32, T)| self.node[*n as usize].is_some();
        let kept = || shares.iter().filter(is_kept).copied().collect();
        shares.iter().all(mirrored).then(kept)
    }

    fn velocity(&self, velocity: &[[f64; 3]]) -> Option<Vec<[f64; 3]>> {
        let images = self.images;
        let mirrored =
            |(n, v): (usize, &[f64; 3])| images.of_vector(velocity[images.node[n] as usize]) == *v;
        let kept = || {
            let kept = velocity.iter().zip(self.node);
            let kept = kept.filter_map(|(v, n)| n.map(|_| *v));
            if velocity.is_empty() {
                return Vec::new();
            }
            let beyond = self.beyond.iter().map(|n| velocity[*n as usize]);
            kept.chain(beyond).collect()
        };
        velocity.iter().enumerate().all(mirrored).then(kept)
    }

    /// Step of the half: forces are halved, and nothing moves or acts across the plane.
    fn step(&self, step: &Step, model: &Model) -> Option<Step> {
        let d = self.images.axis;
        let gravity = match step.gravity {
            Gravity::None => true,
            Gravity::Constant(g) | Gravity::Growing(g) => self.stays(g),
            // Rotation about the normal keeps gravity in the plane.
            Gravity::Turning { from, axis, .. } => {
                self.stays(from) && axis[d].abs() > 1.0 - ROUNDING
            }
        };
        let across =
            |l: usize, value: &[f64; 3]| !model.loads[l].is_pressure() && value[d].abs() > 0.0;
        let mut loads = step.loads.iter().enumerate();
        let loaded = loads.any(|(l, value)| value.is_some_and(|value| across(l, &value)));
        let driven = step.springs.iter().any(|end| end[d] != 0.0);
        if !gravity || !step.ground.acceleration[d].is_empty() || loaded || driven {
            return None;
        }
        let motion = step.motion.iter().map(|motion| {
            let mut half = *motion;
            for (i, motion) in half.iter_mut().enumerate() {
                match *motion {
                    BeamMotion::Force(force) if i != d => *motion = BeamMotion::Force(0.5 * force),
                    BeamMotion::Force(0.0) => *motion = BeamMotion::Locked,
                    BeamMotion::Locked | BeamMotion::Driven(_) if i != d => {}
                    BeamMotion::Locked => {}
                    BeamMotion::Force(_) | BeamMotion::Driven(_) => return None,
                }
            }
            Some(half)
        });
        Some(Step {
            motion: motion.collect::<Option<_>>()?,
            ..step.clone()
        })
    }
}
