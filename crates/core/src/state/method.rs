//! Method that solves one increment.

use crate::model::scene::Procedure;

/// Method of an increment: the procedure of its step, or one chosen by the procedure fallback.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Newton's method for equilibrium.
    #[default]
    Static,
    /// The same with extrapolated solids.
    Implex,
    /// Newton's method with the exact laws, whatever the tangents of the step.
    Direct,
    /// Backward Euler.
    QuasiStatic,
    /// HHT-α.
    Dynamic,
    /// At a prescribed distance along the path.
    ArcLength,
    /// At a prescribed amount of dissipated energy.
    Dissipation,
    /// At a prescribed displacement.
    DisplacementControl,
    /// Dashpots carry the scene over a snap, at constant loads.
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

    /// Name in the history.
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

    /// Whether a constraint along the path, not the load, determines the size of an increment.
    pub fn follows_path(self) -> bool {
        matches!(self, Self::ArcLength | Self::Dissipation)
    }
}
