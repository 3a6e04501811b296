//! How one increment is solved.

use crate::model::scene::Procedure;

/// What solves an increment: the procedure of its step, or a choice of the fallback.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Newton's method on equilibrium.
    #[default]
    Static,
    /// The same with extrapolated solids.
    Implex,
    /// Newton's method on the laws themselves, whatever the tangents of the step.
    Direct,
    /// Backward Euler.
    QuasiStatic,
    /// HHT-α.
    Dynamic,
    /// At a distance along the path.
    ArcLength,
    /// At an amount of dissipated energy.
    Dissipation,
    /// At a displacement.
    DisplacementControl,
    /// Over a snap with dashpots, at held loads.
    Relaxation,
}

impl Method {
    /// The first method of a procedure.
    pub fn of(procedure: Procedure) -> Self {
        match procedure {
            Procedure::Auto | Procedure::Static => Self::Static,
            Procedure::Implex => Self::Implex,
            Procedure::QuasiStatic => Self::QuasiStatic,
            Procedure::Dynamic { .. } => Self::Dynamic,
            Procedure::ArcLength => Self::ArcLength,
            Procedure::Dissipation => Self::Dissipation,
            Procedure::DisplacementControl => Self::DisplacementControl,
        }
    }

    /// As the history spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Implex => "implex",
            Self::Direct => "direct",
            Self::QuasiStatic => "quasi_static",
            Self::Dynamic => "dynamic",
            Self::ArcLength => "arc_length",
            Self::Dissipation => "dissipation",
            Self::DisplacementControl => "displacement_control",
            Self::Relaxation => "relaxation",
        }
    }

    /// Whether inertia acts.
    pub fn has_inertia(self) -> bool {
        matches!(self, Self::QuasiStatic | Self::Dynamic)
    }

    /// Whether the path says how far an increment goes, and not the load.
    pub fn follows_path(self) -> bool {
        matches!(self, Self::ArcLength | Self::Dissipation)
    }
}
