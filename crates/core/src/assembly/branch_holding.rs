//! Branch holding for points on branches of the shifted law without stiffness.
//!
//! In a growing crack, a point that has just reached its envelope has no stiffness, and Newton's method moves it
//! far along the envelope. Its neighbours unload; they return by another branch with full stiffness, and the next
//! iterate moves back. Points at their shear limit and opening points without bond behave alike. A point that has
//! changed twice between such a branch and another is held there to the end of the increment: its tangent becomes a
//! secant. Its forces stay those of the law.

use wythe_contact::FlatBranches;

/// Branches of all points since the increment began.
#[derive(Clone, Debug, Default)]
pub struct HeldBranches {
    /// Branches without stiffness that each point is on. `[point]`
    pub now: Vec<FlatBranches>,
    /// Branches without stiffness to or from which each point has changed at least twice in this increment.
    /// `[point]`
    pub held: Vec<FlatBranches>,
    /// The same, once. `[point]`
    changed: Vec<FlatBranches>,
    /// Branches at the last iterate. Empty before the first iterate. `[point]`
    before: Vec<FlatBranches>,
}

impl HeldBranches {
    /// Begins an increment, without any change so far.
    pub fn start(&mut self) {
        self.before.clear();
        self.changed.fill(FlatBranches::default());
        self.held.fill(FlatBranches::default());
    }

    /// Makes room for `n` points.
    pub fn resize(&mut self, n: usize) {
        self.now.resize(n, FlatBranches::default());
        self.changed.resize(n, FlatBranches::default());
        self.held.resize(n, FlatBranches::default());
    }

    /// Compares this iterate with the last one. A second change of a branch holds the point on it.
    pub fn keep(&mut self) {
        for (p, before) in self.before.iter().enumerate() {
            for (i, before) in before.iter().enumerate() {
                if self.now[p][i] != *before {
                    self.held[p][i] |= self.changed[p][i];
                    self.changed[p][i] = true;
                }
            }
        }
        self.before.clone_from(&self.now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_that_changes_branch_twice_is_held_for_the_increment() {
        let mut points = HeldBranches::default();
        points.resize(2);
        // The first iterate of an increment counts no change.
        points.now = vec![[true, false, false], [false; 3]];
        points.keep();
        // Point 0 stays on its envelope. Point 1 reaches its shear limit for the first time.
        points.now[1][1] = true;
        points.keep();
        assert_eq!(points.held, [[false; 3]; 2]);
        // Point 1 leaves its shear limit, point 0 its envelope.
        points.now = vec![[false; 3]; 2];
        points.keep();
        assert_eq!(points.held, [[false; 3], [false, true, false]]);
        // Point 0 returns to its envelope. Point 1 stays held.
        points.now[0][0] = true;
        points.keep();
        assert_eq!(points.held, [[true, false, false], [false, true, false]]);
        points.start();
        points.keep();
        points.now[0][0] = false;
        points.keep();
        assert_eq!(points.held, [[false; 3]; 2]);
    }
}
