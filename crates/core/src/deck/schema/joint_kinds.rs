//! Kinds of joint laws in a deck, and the law of each: one line per kind.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use wythe_contact::InterfaceLaw;

use super::Interface;

/// Law of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum JointKind {
    /// Cohesion that softens to friction; pressure does not damage the joint.
    #[default]
    CohesiveFrictional,
    /// Tension cut-off, Coulomb friction and a compression cap, as plasticity: joints between expanded units.
    Cap,
}

impl JointKind {
    /// Name of the kind in a deck.
    pub fn name(self) -> &'static str {
        match self {
            Self::CohesiveFrictional => "cohesive-frictional",
            Self::Cap => "cap",
        }
    }

    /// The law of an interface with these stiffnesses [N/mm³].
    pub(super) fn law(self, interface: &Interface, normal: f64, shear: f64) -> InterfaceLaw {
        match self {
            Self::CohesiveFrictional => interface.cohesive_frictional(normal, shear).into(),
            Self::Cap => interface.cap(normal, shear).into(),
        }
    }
}
