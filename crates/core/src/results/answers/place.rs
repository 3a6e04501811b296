//! Places in a model, by the names and courses of its parts.

use serde::{Deserialize, Serialize};

use crate::model::Model;
use crate::results::quarters::{QUARTERS, WEIGHTS};

/// Where something happens.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Place {
    /// Name of the interface; `None` in a solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<String>,
    /// Name of the material; `None` in a joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Names of the bodies: that of a solid, or those on both sides of a joint.
    pub bodies: Vec<String>,
    /// Course of the first of them, from 0 below.
    pub course: Option<u16>,
    /// Position at rest [mm]. `[xyz]`
    pub at_mm: [f64; 3],
}

impl Place {
    /// Place of a contact point, `4 facet + point`: the middle of its quarter of the facet. `None` if the model has
    /// no such point.
    pub fn of_point(model: &Model, point: usize) -> Option<Self> {
        let contact = &model.contact;
        let facet = point / 4;
        let body = *contact.slave_body.get(facet)?;
        let law = *contact.slave_law.get(facet)?;
        let at = middle(model, point);
        let other = facing(model, at, body);
        let bodies = [Some(body), other].into_iter().flatten();
        Some(Self {
            interface: contact.law_names.get(usize::from(law)).cloned(),
            material: None,
            bodies: bodies.map(|body| model.mesh.called(body)).collect(),
            course: course_of(model, body),
            at_mm: at,
        })
    }

    /// Place of an element: its centre. `None` if the model has no such element.
    pub fn of_element(model: &Model, element: usize) -> Option<Self> {
        let mesh = &model.mesh;
        let material = usize::from(*mesh.material.get(element)?);
        Some(Self {
            interface: None,
            material: model.materials.get(material).map(|m| m.name.clone()),
            bodies: vec![mesh.body_of(element)],
            course: mesh.course.get(element).copied(),
            at_mm: centre(model, element),
        })
    }

    /// In words: `joint between unit 3 and unit 7, course 2, at (120, 49, 130) mm`.
    pub fn told(&self) -> String {
        let of = |name: &Option<String>| name.clone().unwrap_or_default();
        let what = match (&self.interface, &self.bodies[..]) {
            (Some(name), [one]) => format!("{name} of {one}"),
            (Some(name), [a, b]) => format!("{name} between {a} and {b}"),
            (_, [one, ..]) => format!("{} of {one}", of(&self.material)),
            _ => of(&self.interface),
        };
        let course = self
            .course
            .map_or(String::new(), |course| format!(", course {course}"));
        let [x, y, z] = self.at_mm;
        format!("{what}{course}, at ({x:.0}, {y:.0}, {z:.0}) mm")
    }
}

/// Middle of the quarter of the facet around a contact point at rest [mm].
pub(super) fn middle(model: &Model, point: usize) -> [f64; 3] {
    let corners = model.contact.outline(point / 4, &model.mesh.nodes);
    let mut middle = [0.0; 3];
    for corner in QUARTERS[point % 4] {
        for (weight, corner) in WEIGHTS[corner as usize].iter().zip(corners) {
            for (sum, x) in middle.iter_mut().zip(corner) {
                *sum += 0.25 * weight * x;
            }
        }
    }
    middle
}

/// Centre of an element at rest [mm].
fn centre(model: &Model, element: usize) -> [f64; 3] {
    let corners = model.mesh.corners(element);
    [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / 8.0)
}

/// Body of the master facet nearest to a point of another body, by the distance to the box around the facet and then
/// to its centre.
fn facing(model: &Model, at: [f64; 3], body: u32) -> Option<u32> {
    let contact = &model.contact;
    let others = contact.master_facets.iter().zip(&contact.master_body);
    let distance = |facet: &[u32; 4]| {
        let corners = facet.map(|n| model.mesh.nodes[n as usize]);
        let (mut outside, mut off) = (0.0, 0.0);
        for i in 0..3 {
            let along = corners.map(|x| x[i]);
            let low = along.into_iter().fold(f64::INFINITY, f64::min);
            let high = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
            outside += (low - at[i]).max(at[i] - high).max(0.0).powi(2);
            off += (0.5 * (low + high) - at[i]).powi(2);
        }
        (outside, off)
    };
    let others = others.filter(|(_, other)| **other != body);
    let nearest = others.min_by(|a, b| {
        let (a, b) = (distance(a.0), distance(b.0));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    nearest.map(|(_, other)| *other)
}

fn course_of(model: &Model, body: u32) -> Option<u16> {
    let element = model.mesh.unit.iter().position(|unit| *unit == body)?;
    model.mesh.course.get(element).copied()
}
