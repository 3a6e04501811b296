//! The solved part of the model shown, and the numbers of its nodes and elements there.

use crate::model::Model;
use crate::model::mirrored::{Half, MirrorPlane, part};
use crate::model::scene::BeamMotion;

/// The solved part of the model shown; by default all of it.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Part {
    /// Planes in which it is held, in the order in which halves were taken.
    pub planes: Vec<MirrorPlane>,
    /// Whether a beam of the model shown may move across a plane in a step. `[plane][step][beam]`
    pub free: Vec<Vec<Vec<bool>>>,
    /// Stiffness of the springs on this part, including that across planes [N/mm]. `[spring][xyz]`
    pub springs: Vec<[f64; 3]>,
    /// Numbers of its nodes and elements in the model shown; none if they are the same.
    node: Option<Vec<u32>>,
    element: Option<Vec<u32>>,
}

impl Part {
    /// A half of a whole model.
    pub fn of(whole: &Model, half: &Half, plane: MirrorPlane) -> Self {
        let is_free = |motion: &[BeamMotion; 3]| matches!(motion[plane.axis], BeamMotion::Force(_));
        let steps = whole.steps.iter();
        let free = steps.map(|step| step.motion.iter().map(is_free).collect());
        Self {
            planes: vec![plane],
            free: vec![free.collect()],
            springs: springs(whole.springs.iter().map(|spring| spring.stiffness)),
            node: Some([kept(&half.node), half.beyond.clone()].concat()),
            element: Some(kept(&half.element)),
        }
    }

    /// A half whose whole is itself the part `whole` of the model shown.
    pub fn within(&self, whole: &Self) -> Self {
        let of = |own: &Option<Vec<u32>>, name: &dyn Fn(usize) -> usize| {
            let own = own.as_ref()?.iter();
            Some(own.map(|n| name(*n as usize) as u32).collect())
        };
        Self {
            planes: [&whole.planes[..], &self.planes].concat(),
            free: [&whole.free[..], &self.free].concat(),
            springs: match whole.planes[..] {
                [] => self.springs.clone(),
                _ => springs(whole.springs.iter().copied()),
            },
            node: of(&self.node, &|n| whole.node(n)),
            element: of(&self.element, &|e| whole.element(e)),
        }
    }

    /// Forces and energies of the whole over those of this part.
    pub fn wholes(&self) -> f64 {
        f64::from(1_u32 << self.planes.len().min(3))
    }

    /// Number of a node in the model shown.
    pub fn node(&self, n: usize) -> usize {
        self.node.as_ref().map_or(n, |node| node[n] as usize)
    }

    /// Number of an element in the model shown.
    pub fn element(&self, e: usize) -> usize {
        let element = self.element.as_ref();
        element.map_or(e, |element| element[e] as usize)
    }

    /// Message of a run that lost its symmetry about some of its planes in a step.
    pub fn symmetry_message(&self, planes: &[usize], step: &str) -> String {
        let planes: Vec<String> = planes.iter().map(|p| self.planes[*p].to_string()).collect();
        format!(
            "in step {step} nothing but its symmetry holds the scene in the plane {} any more: it buckles or bows to \
             one side, which the part that is solved cannot; try fidelity = \"full\", which solves all of it",
            planes.join(" and ")
        )
    }

    /// Message about the part solved; none if it is the whole.
    pub fn told(&self) -> Option<String> {
        let part = part(self.planes.len())?;
        let planes: Vec<String> = self.planes.iter().map(ToString::to_string).collect();
        Some(format!(
            "the scene is its own mirror image in the plane {}: {part} of it is solved",
            planes.join(" and ")
        ))
    }
}

/// Springs of half the stiffness.
fn springs(whole: impl Iterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
    whole.map(|stiffness| stiffness.map(|k| 0.5 * k)).collect()
}

/// Indices of the entries that are kept, in order.
fn kept(number: &[Option<u32>]) -> Vec<u32> {
    let all = number.iter().enumerate();
    all.filter_map(|(i, own)| own.map(|_| i as u32)).collect()
}
