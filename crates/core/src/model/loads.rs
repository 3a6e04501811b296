//! Named loads.

/// An external load with a name. Its value has three numbers. For a pressure only the first counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name in the deck.
    pub name: String,
    /// Columns of the history: its value, unless that is a force, and the total force along `direction` [kN].
    pub columns: Vec<String>,
    /// Unit vector to which its columns refer: the direction of a pressure at rest, else that of the first value
    /// other than 0. Zero for a pressure on a closed surface.
    pub direction: [f64; 3],
    /// Action of its value.
    pub acts: LoadOn,
}

/// Forces of a load of given value.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadOn {
    /// Follower pressure p [MPa] on facets at their present positions: −p ∫ N n dA. Nodes run counter-clockwise seen
    /// from outside. `[facet][node]`
    Follower(Vec<[u32; 4]>),
    /// Pressure p [MPa] on facets at rest: −p times these area vectors of nodes [mm²].
    Pressure(Vec<(u32, [f64; 3])>),
    /// Value times the share of each node: areas [mm²] for a traction [MPa], lengths [mm] for a line force [N/mm],
    /// parts of 1 for a force [N].
    Shares(Vec<(u32, f64)>),
}

impl Load {
    /// Number in its first column for a value [MPa, N/mm; N].
    pub fn told(&self, value: [f64; 3]) -> f64 {
        if self.is_pressure() {
            value[0]
        } else {
            self.along(value)
        }
    }

    /// Nodes on which it acts; a node may come more than once.
    pub fn nodes(&self) -> Vec<u32> {
        match &self.acts {
            LoadOn::Follower(facets) => facets.as_flattened().to_vec(),
            LoadOn::Pressure(areas) => areas.iter().map(|(n, _)| *n).collect(),
            LoadOn::Shares(shares) => shares.iter().map(|(n, _)| *n).collect(),
        }
    }

    /// Whether its value is a pressure.
    pub fn is_pressure(&self) -> bool {
        !matches!(self.acts, LoadOn::Shares(_))
    }

    /// Component of a vector along its direction.
    pub fn along(&self, v: [f64; 3]) -> f64 {
        (0..3).map(|i| self.direction[i] * v[i]).sum()
    }
}
