//! Conditions that a mesh must fulfil before it can be used.

use super::{ImportError, ImportedMesh};
use crate::element::hex8::CORNERS;
use crate::element::hexahedron::{PLACES, cross, difference, dot, is_upright};

/// Number of elements that a note names when there are more.
const NAMED: usize = 5;

impl ImportedMesh {
    /// Checks that every element has eight different nodes, a positive Jacobian determinant at each integration
    /// point, and no side in common with more than one other element.
    ///
    /// # Errors
    /// A mesh without hexahedra; the first element that fails, with file, line and position, and the others that fail.
    pub fn check(&self) -> Result<(), ImportError> {
        if self.elements.is_empty() {
            let others = self.left_out.iter();
            let others = others.map(|(kind, count)| format!("{count} of the type {kind}"));
            let others: Vec<String> = others.collect();
            let but = match others.as_slice() {
                [] => String::new(),
                others => format!(", only elements that are not read: {}", others.join(", ")),
            };
            return Err(ImportError {
                file: self.files.first().cloned().unwrap_or_default(),
                line: None,
                message: format!("there are no hexahedra in it{but}"),
                help: "elements of 8 nodes are read: C3D8 of Abaqus, type 5 of Gmsh".to_owned(),
            });
        }
        self.refuse(
            |e| has_repeated(&self.elements[e]),
            |_| "has a node more than once".to_owned(),
            "a hexahedron has eight nodes: wedges and pyramids must be meshed as hexahedra",
        )?;
        self.refuse(
            |e| !has_volume(&self.corners(e)),
            |e| self.fold(e),
            "nodes 1 to 4 run counter-clockwise seen from 5 to 8; let no corner be pushed through",
        )?;
        if let Err(e) = self.exterior() {
            return Err(self.wrong_element(
                e as usize,
                "has a side in common with two other elements",
                "take out elements that are there twice",
            ));
        }
        Ok(())
    }

    /// Adds a note about elements that are folded at a corner but have positive volume at their integration points.
    /// They can be used, with loss of accuracy.
    pub(super) fn note_folded(&mut self) {
        let folded = |e: &usize| {
            let corners = self.corners(*e);
            !is_upright(&corners) && has_volume(&corners)
        };
        let folded: Vec<usize> = (0..self.elements.len()).filter(folded).collect();
        if let Some(first) = folded.first() {
            self.notes.push(format!(
                "{} elements have a corner that is flat or folded, and a volume at their integration points (the first is {})",
                folded.len(),
                self.name_of(*first)
            ));
        }
    }

    fn corners(&self, e: usize) -> [[f64; 3]; 8] {
        self.elements[e].map(|n| self.nodes[n as usize])
    }

    fn refuse(
        &self,
        wrong: impl Fn(usize) -> bool,
        message: impl Fn(usize) -> String,
        help: &str,
    ) -> Result<(), ImportError> {
        let mut found = (0..self.elements.len()).filter(|e| wrong(*e));
        let Some(first) = found.next() else {
            return Ok(());
        };
        let others: Vec<u64> = found.map(|e| self.element_labels[e]).collect();
        let mut message = message(first);
        if !others.is_empty() {
            let some: Vec<String> = others.iter().take(NAMED).map(u64::to_string).collect();
            let rest = if others.len() > NAMED { ", ..." } else { "" };
            message += &format!(
                "; so have {} others: {}{rest}",
                others.len(),
                some.join(", ")
            );
        }
        Err(self.wrong_element(first, &message, help))
    }

    /// Describes the wrong volume of an element.
    fn fold(&self, e: usize) -> String {
        let x = self.corners(e);
        let volumes = PLACES.map(|place| corner_volume(&x, place));
        if volumes.iter().all(|v| *v < 0.0) {
            return "has its nodes in the wrong order: it is turned inside out, with a negative volume"
                .to_owned();
        }
        // `PLACES` has the order of the nodes.
        let n = volumes.iter().position(|v| v.is_nan() || *v <= 0.0);
        let n = n.unwrap_or_default();
        let label = self.node_labels[self.elements[e][n] as usize];
        format!("has no positive volume at its node {label}: it is flat or folded there")
    }
}

/// Returns whether the determinant of the Jacobian is positive at all eight points of 2 × 2 × 2 Gauss integration.
pub(in crate::deck) fn has_volume(x: &[[f64; 3]; 8]) -> bool {
    let g = 1.0 / 3.0_f64.sqrt();
    CORNERS.iter().all(|at| {
        let at = at.map(|s| g * s);
        let mut edges = [[0.0; 3]; 3];
        for (x, c) in x.iter().zip(&CORNERS) {
            let factor = [0, 1, 2].map(|d| 1.0 + c[d] * at[d]);
            for (d, edge) in edges.iter_mut().enumerate() {
                let slope = 0.125 * c[d] * factor[(d + 1) % 3] * factor[(d + 2) % 3];
                for (edge, x) in edge.iter_mut().zip(x) {
                    *edge += slope * x;
                }
            }
        }
        dot(cross(edges[0], edges[1]), edges[2]) > 0.0
    })
}

/// Triple product of the three edges along ξ, η, ζ that meet in a corner.
fn corner_volume(x: &[[f64; 3]; 8], place: [usize; 3]) -> f64 {
    let sign = |high: usize| if high == 1 { 1.0 } else { -1.0 };
    let at = |place: [usize; 3]| {
        let corner = CORNERS.iter().position(|c| *c == place.map(sign));
        x[corner.unwrap_or_default()]
    };
    let edge = |d: usize| {
        let (mut from, mut to) = (place, place);
        (from[d], to[d]) = (0, 1);
        difference(at(to), at(from))
    };
    dot(cross(edge(0), edge(1)), edge(2))
}

fn has_repeated(nodes: &[u32; 8]) -> bool {
    let mut sorted = *nodes;
    sorted.sort_unstable();
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}
