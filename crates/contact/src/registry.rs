//! Registry of the built-in joint laws, and the variant for user-defined laws.
//!
//! A law is added in nine places here, after its file:
//!
//! * an entry of [`KINDS`], a variant of [`InterfaceLaw`], an arm of [`for_law!`](crate::for_law), a `From`;
//! * an arm of `PartialEq`, for which the compiler does not ask: without it no two laws of the kind are equal;
//! * arms of `as_cohesive_frictional`, `scale_bond`, `is_half` and `half`, which the compiler asks for.
//!
//! `docs/how-to/add-a-joint-law.md` lists the other files, those of the deck among them.

use std::fmt;
use std::sync::Arc;

use crate::cap::Cap;
use crate::joint::{JointLaw, Output};
use crate::law::{CohesiveFrictional, InterfaceHistory, InterfaceResponse};
use crate::shifted::Shift;

/// Values of `kind` in `[interfaces.NAME]`; the first is the default.
pub const KINDS: [&str; 2] = ["cohesive-frictional", "cap"];

/// A joint law. Built-in laws are dispatched once per facet, user-defined laws by a virtual call.
#[derive(Clone)]
pub enum InterfaceLaw {
    /// `kind = "cohesive-frictional"`.
    CohesiveFrictional(CohesiveFrictional),
    /// `kind = "cap"`.
    Cap(Cap),
    /// A user-defined law, which costs a virtual call per point.
    Custom(Arc<dyn JointLaw>),
}

/// Evaluates an expression with the law of an [`InterfaceLaw`] bound to a name. A built-in law has its own type, any
/// other law is a `&dyn JointLaw`.
#[macro_export]
macro_rules! for_law {
    ($any:expr, $law:ident => $body:expr) => {
        match $any {
            $crate::InterfaceLaw::CohesiveFrictional($law) => $body,
            $crate::InterfaceLaw::Cap($law) => $body,
            $crate::InterfaceLaw::Custom(custom) => {
                let $law: &dyn $crate::JointLaw = &**custom;
                $body
            }
        }
    };
}

impl From<CohesiveFrictional> for InterfaceLaw {
    fn from(law: CohesiveFrictional) -> Self {
        Self::CohesiveFrictional(law)
    }
}

impl From<Cap> for InterfaceLaw {
    fn from(law: Cap) -> Self {
        Self::Cap(law)
    }
}

/// Prints the law that it contains.
impl fmt::Debug for InterfaceLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for_law!(self, law => write!(f, "{law:?}"))
    }
}

/// Built-in laws are equal if their parameters are; a user-defined law is equal only to itself.
impl PartialEq for InterfaceLaw {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::CohesiveFrictional(a), Self::CohesiveFrictional(b)) => a == b,
            (Self::Cap(a), Self::Cap(b)) => a == b,
            (Self::Custom(a), Self::Custom(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl InterfaceLaw {
    /// A user-defined law.
    pub fn custom(law: impl JointLaw + 'static) -> Self {
        Self::Custom(Arc::new(law))
    }

    /// A dry joint of the cohesive-frictional law, see [`CohesiveFrictional::dry`].
    pub fn dry(mu: f64, normal_stiffness: f64, shear_stiffness: f64) -> Self {
        CohesiveFrictional::dry(mu, normal_stiffness, shear_stiffness).into()
    }

    /// The parameters if this is the cohesive-frictional law.
    pub fn as_cohesive_frictional(&self) -> Option<&CohesiveFrictional> {
        match self {
            Self::CohesiveFrictional(law) => Some(law),
            Self::Cap(_) | Self::Custom(_) => None,
        }
    }

    /// Multiplies strengths and fracture energies of the bond by `factor`; a user-defined law does not change.
    pub fn scale_bond(&mut self, factor: f64) {
        match self {
            Self::CohesiveFrictional(law) => {
                law.f_t *= factor;
                law.c *= factor;
            }
            Self::Cap(law) => {
                for number in [&mut law.f_t, &mut law.c, &mut law.mode_1, &mut law.mode_2] {
                    *number *= factor;
                }
            }
            Self::Custom(_) => {}
        }
    }

    /// Whether this is the law of a joint cut at its middle, see [`half`](Self::half).
    pub fn is_half(&self) -> bool {
        match self {
            Self::CohesiveFrictional(law) => law.is_half(),
            Self::Cap(law) => law.is_half(),
            Self::Custom(_) => false,
        }
    }

    /// Law of one half of a joint, see [`JointLaw::halved`].
    pub fn half(&self) -> Option<Self> {
        match self {
            Self::CohesiveFrictional(law) => Some(law.half().into()),
            Self::Cap(law) => Some(law.half().into()),
            Self::Custom(law) => law.halved().map(Self::Custom),
        }
    }
}

impl JointLaw for InterfaceLaw {
    fn name(&self) -> &'static str {
        for_law!(self, law => law.name())
    }
    fn stiffness(&self) -> [f64; 2] {
        for_law!(self, law => law.stiffness())
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        for_law!(self, law => law.update(gap, old))
    }
    fn outputs(&self) -> &'static [Output] {
        for_law!(self, law => law.outputs())
    }
    fn virgin(&self) -> InterfaceHistory {
        for_law!(self, law => law.virgin())
    }
    fn lost(&self, old: &InterfaceHistory) -> InterfaceHistory {
        for_law!(self, law => law.lost(old))
    }
    fn is_dry(&self) -> bool {
        for_law!(self, law => law.is_dry())
    }
    fn opens_at(&self) -> f64 {
        for_law!(self, law => law.opens_at())
    }
    fn ultimate_opening(&self) -> f64 {
        for_law!(self, law => law.ultimate_opening())
    }
    fn free_energy(&self, history: &InterfaceHistory) -> f64 {
        for_law!(self, law => law.free_energy(history))
    }
    fn crossing_work(&self, old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
        for_law!(self, law => law.crossing_work(old, new))
    }
    fn utilisation(&self, traction: &[f64; 3], history: &InterfaceHistory) -> f64 {
        for_law!(self, law => JointLaw::utilisation(law, traction, history))
    }
    fn exertion(&self, traction: &[f64; 3], history: &InterfaceHistory) -> f64 {
        for_law!(self, law => JointLaw::exertion(law, traction, history))
    }
    fn within_bounds(&self, guess: [f64; 3], old: &InterfaceHistory) -> [f64; 3] {
        for_law!(self, law => law.within_bounds(guess, old))
    }
    fn softening_slopes(&self) -> [f64; 2] {
        for_law!(self, law => law.softening_slopes())
    }
    fn halved(&self) -> Option<Arc<dyn JointLaw>> {
        for_law!(self, law => law.halved())
    }
    fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        for_law!(self, law => law.update_shifted(gap, old, shift))
    }
}
