//! The interfaces: points on slave facets against master facets, in parallel by slave facet.
//!
//! A contact cell is one slave facet with one of its candidate master facets: 4 + 4 nodes. The
//! candidates stay fixed while surfaces move less than the skin, and the matrix pattern with them.

use rayon::prelude::*;
use wythe_contact::{
    Candidates, InterfaceHistory, Kinematics, PointPair, PointStatus, Shift, SlavePoint, Surface,
    corner_points, gauss_points, pair_point, to_frame,
};

use super::pattern::CELL;
use super::{Evaluation, Trial};
use crate::model::Model;
use crate::model::scene::ContactPoints;
use crate::solve::State;

/// The numerical stiffness of the shifted penalty over the representative stiffness of the
/// elements: soft enough for the tangents, stiff enough for few iterations (docs/decisions.md).
const NUMERICAL_PENALTY: f64 = 2.0;
/// The paper's penalty factor: the physical stiffness over the representative one.
const PHYSICAL_PENALTY: f64 = 500.0;

/// Surfaces, points and candidates.
#[derive(Clone, Debug)]
pub struct Contact {
    slave: Surface,
    master: Surface,
    law_of: Vec<u16>,
    /// Sampling points. `[slave facet][point]`
    pub points: Vec<SlavePoint>,
    candidates: Candidates,
    cells: Vec<[u32; 8]>,
    version: usize,
    skin: f64,
    radius: f64,
    /// Positions at the last search of candidates.
    searched_at: Vec<[f64; 3]>,
}
