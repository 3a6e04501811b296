//! Wall time and counts by phase of a run.

/// Wall time of each phase [s], and how often the expensive operations were done.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Clock {
    /// Solids.
    pub elements: f64,
    /// Joints, with the search of contact.
    pub contact: f64,
    /// Assembly of the matrix.
    pub assembly: f64,
    /// Analysis and factorisation.
    pub factorise: f64,
    /// Triangular solves.
    pub solve: f64,
    /// Number of factorisations.
    pub factorisations: usize,
    /// Number of factorisations saved by reusing branches of the tree, measured by their operations.
    pub reused: f64,
    /// Number of solves of regions.
    pub local_solves: usize,
    /// Number of evaluations of all forces.
    pub evaluations: usize,
}

impl std::ops::Add for Clock {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            elements: self.elements + other.elements,
            contact: self.contact + other.contact,
            assembly: self.assembly + other.assembly,
            factorise: self.factorise + other.factorise,
            solve: self.solve + other.solve,
            factorisations: self.factorisations + other.factorisations,
            reused: self.reused + other.reused,
            local_solves: self.local_solves + other.local_solves,
            evaluations: self.evaluations + other.evaluations,
        }
    }
}
