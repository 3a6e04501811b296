//! Floors as masses at the faces that carry them (theory/ties.md). The springs between the faces are ties.

/// A floor: mass that hangs on nodes, weighs under gravity and resists accelerations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Floor {
    /// Name.
    pub name: String,
    /// Area in plan [mm²]; 0 if it is not known.
    pub area: f64,
    /// Nodes with the mass that each carries [tonne].
    pub masses: Vec<(u32, f64)>,
}

impl Floor {
    /// Mass of the floor [tonne].
    pub fn mass(&self) -> f64 {
        self.masses.iter().map(|(_, mass)| mass).sum()
    }
}
