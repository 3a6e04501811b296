//! Points on branches of the shifted law that have no stiffness.
//!
//! Where a crack runs, Newton's method sends a point that has just come to its envelope far along it, for there
//! it has no stiffness; its neighbours unload, come back by another branch with all of theirs, and the next
//! iterate goes the other way. So do points at their shear limit, and what has no bond and opens. A point that has
//! changed twice between such a branch and another is held on it to the end of the increment: by its tangent, the
//! forces stay those of the law.

use wythe_contact::Loose;

/// The branches of all points since an increment began.
#[derive(Clone, Debug, Default)]
pub struct HeldBranches {
    /// On which of them each point is. `[point]`
    pub now: Vec<Loose>,
    /// Those between which and another it has changed twice since the increment began. `[point]`
    pub held: Vec<Loose>,
    /// The same, once. `[point]`
    changed: Vec<Loose>,
    /// Where it was at the last iterate, none at the first. `[point]`
    before: Vec<Loose>,
}

impl HeldBranches {
    /// Begins an increment: nothing has changed yet.
    pub fn start(&mut self) {
        self.before.clear();
        self.changed.fill(Loose::default());
        self.held.fill(Loose::default());
    }

    /// Makes room for `n` points.
    pub fn resize(&mut self, n: usize) {
        self.now.resize(n, Loose::default());
        self.changed.resize(n, Loose::default());
        self.held.resize(n, Loose::default());
    }

    /// This iterate becomes the last: what has changed its branch twice is held on it.
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
    fn what_goes_forth_and_back_is_held_to_the_end_of_the_increment() {
        let mut points = HeldBranches::default();
        points.resize(2);
        // The first iterate of an increment changes nothing.
        points.now = vec![[true, false, false], [false; 3]];
        points.keep();
        // One stays on its envelope; the other comes to its shear limit, for the first time.
        points.now[1][1] = true;
        points.keep();
        assert_eq!(points.held, [[false; 3]; 2]);
        // Now it leaves it, and the first its envelope.
        points.now = vec![[false; 3]; 2];
        points.keep();
        assert_eq!(points.held, [[false; 3], [false, true, false]]);
        // The first comes back, the other stays held.
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
