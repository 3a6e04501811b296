//! Axis-aligned boxes of elements and bodies.

use wythe::model::Mesh;

/// Lower and upper corner [mm].
pub type Box3 = [[f64; 3]; 2];

/// The box of an element whose edges are parallel to the axes.
pub fn element_box(mesh: &Mesh, e: usize) -> Box3 {
    let c = mesh.corners(e);
    [c[0], c[6]]
}

/// Volume [mm³].
pub fn volume([a, b]: Box3) -> f64 {
    (0..3).map(|d| b[d] - a[d]).product()
}

/// Boxes around the bodies. `[body]`
pub fn bodies(mesh: &Mesh) -> Vec<Box3> {
    let count = mesh.unit.iter().max().map_or(0, |u| *u as usize + 1);
    let mut boxes = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; count];
    for (e, &unit) in mesh.unit.iter().enumerate() {
        let [low, high] = &mut boxes[unit as usize];
        for corner in mesh.corners(e) {
            for d in 0..3 {
                low[d] = low[d].min(corner[d]);
                high[d] = high[d].max(corner[d]);
            }
        }
    }
    boxes
}
