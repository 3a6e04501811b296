//! Seconds and counts by phase of a run.

/// Wall time spent in each phase [s], and how often the dear ones were done.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Clock {
    /// Solids.
    pub elements: f64,
    /// Interfaces, with the search.
    pub contact: f64,
    /// Gather.
    pub assembly: f64,
    /// Analysis and factorisation.
    pub factorise: f64,
    /// Triangular solves.
    pub solve: f64,
    /// How many factorisations.
    pub factorisations: usize,
    /// How many of them their branches without a change of the matrix saved, by their operations.
    pub reused: f64,
    /// How many solves of regions by themselves.
    pub local_solves: usize,
    /// How many evaluations of all forces.
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
