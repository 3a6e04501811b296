//! Expansion of the results of a half to the whole (docs/theory/symmetry.md, eqs 5 and 6).

use nalgebra::Vector3;
use wythe_contact::{PointPair, frame_at};

use crate::assembly::System;
use crate::model::Model;
use crate::model::mirrored::{Half, Images};
use crate::model::sections::COLUMNS;
use crate::solve::Checkpoint;
use crate::solve::Recorder;
use crate::state::State;
use crate::state::{
    Fall, FallenBody, FirstDamage, Frame, HistoryRow, InterfaceFrame, Onset, OutputField,
};

/// Nodes, elements and points of the half from which those of the whole get their results; `true` marks images.
#[derive(Clone, Debug)]
pub(in crate::solve) struct Places {
    axis: usize,
    /// `[node]`
    node: Vec<(u32, bool)>,
    /// `[element]`
    element: Vec<(u32, bool)>,
    /// `[slave facet][point]`
    point: Vec<(u32, Turn)>,
}

/// Matrix from components along the tangents of a point of the half to those along the tangents of a point of the
/// whole.
type Turn = [[f64; 2]; 2];

const AS_IT_IS: Turn = [[1.0, 0.0], [0.0, 1.0]];

/// Largest difference of the weights of a facet's nodes that count as equal.
const SAME: f64 = 1e-6;

impl Places {
    /// Assignment of the whole to the half; none if a point of the half cannot be identified.
    pub fn of(model: &Model, images: &Images, half: &Half) -> Option<Self> {
        let either = |kept: &[Option<u32>], image: &[u32]| {
            let place = |(i, own): (usize, &Option<u32>)| match own {
                Some(own) => Some((*own, false)),
                None => Some((kept[image[i] as usize]?, true)),
            };
            kept.iter()
                .enumerate()
                .map(place)
                .collect::<Option<Vec<_>>>()
        };
        Some(Self {
            axis: images.axis,
            node: either(&half.node, &images.node)?,
            element: either(&half.element, &images.element)?,
            point: points(model, images, half)?,
        })
    }

    /// Mirrors Voigt components xx, yy, zz, xy, yz, zx: shear components across the plane change sign.
    fn tensor(&self, mut t: [f64; 6]) -> [f64; 6] {
        const ACROSS: [[usize; 2]; 3] = [[3, 5], [3, 4], [4, 5]];
        for i in ACROSS[self.axis] {
            t[i] = -t[i];
        }
        t
    }

    fn vectors(&self, half: &[[f64; 3]]) -> Vec<[f64; 3]> {
        if half.is_empty() {
            return Vec::new();
        }
        let of = |&(n, mirrored): &(u32, bool)| {
            let mut v = half[n as usize];
            if mirrored {
                v[self.axis] = -v[self.axis];
            }
            v
        };
        self.node.iter().map(of).collect()
    }

    fn elements<T: Clone>(&self, half: &[T], mirrored: impl Fn(T) -> T) -> Vec<T> {
        let of = |&(e, is_image): &(u32, bool)| {
            let own = half[e as usize].clone();
            if is_image { mirrored(own) } else { own }
        };
        self.element.iter().map(of).collect()
    }

    /// Expands a fall to the bodies of both halves and their energy.
    pub fn expand_fall(&self, whole: &Model, half: &Model, fall: &mut Fall) {
        fall.kinetic_energy_J *= 2.0;
        let mut images = Vec::new();
        for (e, (own, _)) in self.element.iter().enumerate() {
            let of = half.mesh.unit[*own as usize];
            images.push((of, whole.mesh.unit[e]));
        }
        images.sort_unstable();
        images.dedup();
        let both = fall.bodies.iter().flat_map(|body| {
            let images = images.iter().filter(|(of, _)| *of == body.unit);
            images.map(|(_, unit)| FallenBody {
                name: whole.mesh.called(*unit),
                unit: *unit,
                ..body.clone()
            })
        });
        fall.bodies = both.collect();
    }

    /// Names the places of first damage in the whole, with the force of both halves.
    pub fn expand_first_damage(&self, first: &mut FirstDamage) {
        let point = |place: u32| self.point.iter().position(|(own, _)| *own == place);
        let element = |place: u32| {
            let there = |image: bool| self.element.iter().position(|e| *e == (place, image));
            there(false).or_else(|| there(true))
        };
        let expand = |onset: &mut Onset, place: Option<usize>| {
            onset.force_kN *= 2.0;
            onset.place = place.map_or(onset.place, |place| place as u32);
        };
        if let Some(onset) = &mut first.joint {
            let place = point(onset.place);
            expand(onset, place);
        }
        for onset in [&mut first.crack, &mut first.crush].into_iter().flatten() {
            let place = element(onset.place);
            expand(onset, place);
        }
    }

    fn frame(&self, half: &Frame, reactions: Vec<[f64; 3]>, probes: Vec<f64>) -> Frame {
        Frame {
            time: half.time,
            increment: half.increment,
            step: half.step,
            displacement: self.vectors(&half.displacement),
            velocity: self.vectors(&half.velocity),
            stress: self.elements(&half.stress, |t| self.tensor(t)),
            tensile_damage: self.elements(&half.tensile_damage, |d| d),
            compressive_damage: self.elements(&half.compressive_damage, |d| d),
            plastic_strain: self.elements(&half.plastic_strain, |t| self.tensor(t)),
            yielded: self.elements(&half.yielded, |y| y),
            crack_width: self.elements(&half.crack_width, |w| w),
            outputs: self.outputs(&half.outputs),
            interfaces: self.interfaces(&half.interfaces),
            reactions,
            probes,
        }
    }

    fn outputs(&self, half: &[OutputField]) -> Vec<OutputField> {
        let field = |of: &OutputField| OutputField {
            name: of.name.clone(),
            values: self.elements(&of.values, |v| v),
        };
        half.iter().map(field).collect()
    }

    fn interfaces(&self, half: &InterfaceFrame) -> InterfaceFrame {
        let turned = |turn: &Turn, [a, b]: [f64; 2]| turn.map(|row| row[0] * a + row[1] * b);
        let mut whole = InterfaceFrame::default();
        for (p, turn) in &self.point {
            let p = *p as usize;
            let [normal, a, b] = half.traction[p];
            let [a, b] = turned(turn, [a, b]);
            whole.opening.push(half.opening[p]);
            whole.slip.push(turned(turn, half.slip[p]));
            whole.traction.push([normal, a, b]);
            whole.damage.push(half.damage[p]);
            whole.state.push(half.state[p]);
        }
        // Scalars: they do not turn.
        for OutputField { name, values } in &half.outputs {
            let of_point = |(p, _): &(u32, Turn)| values[*p as usize];
            whole.outputs.push(OutputField {
                name: name.clone(),
                values: self.point.iter().map(of_point).collect(),
            });
        }
        whole
    }
}

/// Points of the half, for all points of the whole: a point beyond the plane takes the results of its image.
fn points(model: &Model, images: &Images, half: &Half) -> Option<Vec<(u32, Turn)>> {
    let facets = &model.contact.slave_facets;
    // Slip is given along the tangents of the facet that a point faces at rest.
    let mut system = System::deformable(model).ok()?;
    let pairs = system.initial_state(model).pairs;
    let weights = |point: usize| system.contact.points[point].weights;
    let tangents = |pair: &PointPair| {
        let facet = model.contact.master_facets[pair.facet? as usize];
        let corners = facet.map(|n| model.mesh.nodes[n as usize]);
        let [_, a, b] = frame_at(&corners, pair.xi);
        Some([a, b])
    };
    let mut points = Vec::with_capacity(4 * facets.len());
    for (f, facet) in facets.iter().enumerate() {
        let own = half.slave[f].filter(|_| !images.lies_across(facet));
        if let Some(own) = own {
            points.extend((0..4).map(|k| (4 * own + k, AS_IT_IS)));
            continue;
        }
        // In a facet across the plane, points beyond the plane take the results of those before it.
        let image = images.slave[f];
        let own = half.slave[image as usize]?;
        let corners = &facets[image as usize];
        for p in 0..4 {
            let here = weights(4 * f + p);
            // If the facet is its own image, the weights of its nodes tell on which side the point lies.
            let sides = facet.map(|n| f64::from(images.side[n as usize]));
            let side: f64 = sides.iter().zip(here).map(|(side, w)| side * w).sum();
            if images.lies_across(facet) && side <= 0.0 {
                points.push((4 * half.slave[f]? + p as u32, AS_IT_IS));
                continue;
            }
            let weight = |corner: u32, weights: [f64; 4]| {
                let is = |n: &u32| images.node[*n as usize] == corner;
                facet.iter().position(is).map(|a| weights[a])
            };
            let k = (0..4).find(|k| {
                let there = weights(4 * image as usize + k);
                let same = |(corner, w): (&u32, f64)| {
                    weight(*corner, here).is_some_and(|own| (own - w).abs() < SAME)
                };
                corners.iter().zip(there).all(same)
            })?;
            let along = tangents(&pairs[4 * f + p]);
            let turn = match (along, tangents(&pairs[4 * image as usize + k])) {
                (Some(here), Some(there)) => {
                    let there = there.map(|t| Vector3::from(images.of_vector(t.into())));
                    here.map(|t| [t.dot(&there[0]), t.dot(&there[1])])
                }
                _ => AS_IT_IS,
            };
            points.push((4 * own + k as u32, turn));
        }
    }
    Some(points)
}

/// Recorder that receives results of the half and passes on those of the whole.
pub(super) struct Expand<'a> {
    pub whole: &'a Model,
    pub places: &'a Places,
    pub recorder: &'a mut dyn Recorder,
}

impl Expand<'_> {
    /// Sum of the forces of both halves; components across the plane cancel.
    fn both(&self, force: &[f64; 3]) -> [f64; 3] {
        let mut both = force.map(|f| 2.0 * f);
        both[self.places.axis] = 0.0;
        both
    }

    fn reactions(&self, half: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (beams, supports) = (self.whole.beams.len(), self.whole.supports.len());
        let own = half.iter().enumerate();
        // The last support is the symmetry plane, which the whole does not have.
        own.filter(|(i, _)| *i != beams + supports)
            .map(|(_, force)| self.both(force))
            .collect()
    }

    /// Columns of probes, of loads, whose last one is the resultant, of outputs, of supports and of sections. The half
    /// has one support more, the plane. `reactions`: those of the whole.
    fn columns(&self, half: &[f64], reactions: &[[f64; 3]]) -> Vec<f64> {
        let whole = self.whole;
        let mut columns = half.to_vec();
        let mut next = whole.probes.len();
        for load in &whole.loads {
            next += load.columns.len();
            columns[next - 1] *= 2.0;
        }
        let sections = columns.split_off(half.len() - COLUMNS * whole.sections.len());
        columns.truncate(next + whole.outputs().len());
        columns.extend(whole.reaction_values(reactions));
        for (section, values) in whole.sections.iter().zip(sections.chunks(COLUMNS)) {
            let factors = section.of_both_halves(self.places.axis);
            columns.extend(values.iter().zip(factors).map(|(value, both)| both * value));
        }
        columns
    }

    fn row(&self, half: &HistoryRow) -> HistoryRow {
        let reactions = self.reactions(&half.reactions);
        HistoryRow {
            force_kN: 2.0 * half.force_kN,
            reaction_kN: 2.0 * half.reaction_kN,
            external_work_J: 2.0 * half.external_work_J,
            elastic_energy_J: 2.0 * half.elastic_energy_J,
            plastic_damage_dissipation_J: 2.0 * half.plastic_damage_dissipation_J,
            interface_dissipation_J: 2.0 * half.interface_dissipation_J,
            viscous_dissipation_J: 2.0 * half.viscous_dissipation_J,
            kinetic_energy_J: 2.0 * half.kinetic_energy_J,
            damping_dissipation_J: 2.0 * half.damping_dissipation_J,
            numerical_dissipation_J: 2.0 * half.numerical_dissipation_J,
            open_points: 2 * half.open_points,
            sliding_points: 2 * half.sliding_points,
            contact_area_mm2: 2.0 * half.contact_area_mm2,
            probes: self.columns(&half.probes, &reactions),
            reactions,
            ..half.clone()
        }
    }
}

impl Recorder for Expand<'_> {
    fn take(
        &mut self,
        _half: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        let row = self.row(row);
        let frame = frame.map(|frame| {
            self.places
                .frame(frame, row.reactions.clone(), row.probes.clone())
        });
        self.recorder.take(self.whole, &row, frame.as_ref())
    }

    fn wants_fields(&self) -> bool {
        self.recorder.wants_fields()
    }

    fn keep(&mut self, _half: &Model, fields: Frame) {
        let reactions = self.reactions(&fields.reactions);
        let columns = self.columns(&fields.probes, &reactions);
        let whole = self.places.frame(&fields, reactions, columns);
        self.recorder.keep(self.whole, whole);
    }

    fn observe(&mut self, state: &State) {
        self.recorder.observe(state);
    }

    fn checkpoint(&mut self, last: bool, make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        self.recorder.checkpoint(last, make)
    }

    fn note(&mut self, text: &str) {
        self.recorder.note(text);
    }

    fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        self.recorder.progress(step, time, iterations);
    }
}
