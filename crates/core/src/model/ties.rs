//! Ties: bars and rods that carry a force along their length only (theory/ties.md).
//!
//! A tie is one strand of points or several. Each point moves with the element that holds it, u = Σ N_a u_a, so that
//! ties add no unknowns. Between two points the tie is straight.
//!
//! ```text
//!    anchored                           bonded: points in each unit, free over the length ℓ_u at a joint
//!   ┌─────┐         ┌─────┐             ┌───────────┐┌───────────┐
//!   │   o─┼─────────┼─o   │             │ o────o────┼┼────o────o │
//!   └─────┘         └─────┘             └───────────┘└───────────┘
//!                                                 |←ℓ_u→|
//! ```

mod embedding;

pub use embedding::{Bonded, TieFault, anchored, bonded};

/// A tie.
#[derive(Clone, Debug, PartialEq)]
pub struct Tie {
    /// Name; its columns of the history begin with it.
    pub name: String,
    /// Cross-section and material of each strand.
    pub law: TieLaw,
    /// Points of each strand, two at least. `[strand][point]`
    pub strands: Vec<Vec<TiePoint>>,
    /// Area of each strand over that of the law; empty if all have that of the law. `[strand]`
    pub shares: Vec<f64>,
}

/// Cross-section and material of a tie: elastic-plastic with linear isotropic hardening, until it breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(non_snake_case, reason = "the symbol of Young's modulus")]
pub struct TieLaw {
    /// Area A [mm²].
    pub area: f64,
    /// Young's modulus E [MPa].
    pub E: f64,
    /// Yield stress f_y [MPa]; infinite for an elastic tie.
    pub f_y: f64,
    /// Slope H of the yield stress over the plastic strain [MPa].
    pub hardening: f64,
    /// Strain at which the tie breaks, that of its prestress included [-]; infinite if it never does.
    pub rupture: f64,
    /// Whether it carries compression. Otherwise it becomes slack.
    pub compression: bool,
}

/// A point of a tie.
#[derive(Clone, Debug, PartialEq)]
pub struct TiePoint {
    /// Position at rest [mm]. `[xyz]`
    pub at: [f64; 3],
    /// Element that holds it.
    pub element: u32,
    /// Nodes of the element and their weights N_a [-].
    pub nodes: Vec<(u32, f64)>,
}

/// State of a tie during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TieStage {
    /// It carries its law.
    #[default]
    Fixed,
    /// It is not there yet. When it is installed it is free of stress, as long as the distance of its points is then.
    Absent,
    /// It is stressed: its force grows in proportion to the loads of the step, to this one at the end [N].
    Stressed(f64),
}

/// When a tie was installed, seen from a later state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Installed<'a> {
    /// At rest.
    #[default]
    AtRest,
    /// Free of stress at these displacements [mm]. `[node][xyz]`
    At(&'a [[f64; 3]]),
    /// It is not there yet.
    Later,
}

impl TieStage {
    /// Stage at a load factor.
    pub(crate) fn at(&self, factor: f64) -> Self {
        match *self {
            Self::Stressed(force) => Self::Stressed(factor * force),
            other => other,
        }
    }
}

impl Tie {
    /// Names of its columns in the history: its force and its stretch.
    pub fn columns(name: &str) -> [String; 2] {
        [format!("{name}_kN"), format!("{name}_stretch_mm")]
    }

    /// Pairs of neighbouring points.
    pub fn segments(&self) -> impl Iterator<Item = [&TiePoint; 2]> {
        let pairs = |strand: &'_ Vec<TiePoint>| strand.len().saturating_sub(1);
        self.strands
            .iter()
            .flat_map(move |strand| (0..pairs(strand)).map(move |i| [&strand[i], &strand[i + 1]]))
    }
}
