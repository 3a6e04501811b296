//! Loads with a name.

/// A load from outside with a name. Its value is of three numbers: of a pressure the first counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name in the deck.
    pub name: String,
    /// Columns of the history: its value, unless that is a force, and the force in all along `direction`
    /// [kN].
    pub columns: Vec<String>,
    /// Along which its columns are told: where a pressure pushes at rest, else that of the first value
    /// other than 0. A unit vector, or nothing of a pressure all around a body.
    pub direction: [f64; 3],
    /// What a value does.
    pub acts: LoadOn,
}

/// Forces of a load of given value.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadOn {
    /// Pressure p [MPa] on facets as they lie now: −p ∫ N n dA. Counter-clockwise seen from outside.
    /// `[facet][node]`
    Follower(Vec<[u32; 4]>),
    /// Pressure p [MPa] on facets as they lay at rest: −p times these area vectors [mm²].
    Pressure(Vec<(u32, [f64; 3])>),
    /// The value times the share of each node: areas [mm²] of a traction [MPa], lengths [mm] of a line
    /// force [N/mm], parts of 1 of a force [N].
    Shares(Vec<(u32, f64)>),
}

impl Load {
    /// The number that its first column tells of a value [MPa, N/mm; N].
    pub fn told(&self, value: [f64; 3]) -> f64 {
        if self.is_pressure() {
            value[0]
        } else {
            self.along(value)
        }
    }

    /// Whether its value is a pressure.
    pub fn is_pressure(&self) -> bool {
        !matches!(self.acts, LoadOn::Shares(_))
    }

    /// The part of a vector along its direction.
    pub fn along(&self, v: [f64; 3]) -> f64 {
        (0..3).map(|i| self.direction[i] * v[i]).sum()
    }
}
