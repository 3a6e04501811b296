//! The cohesive-frictional law (theory/joint.md) as a [`JointLaw`].

use std::sync::Arc;

use crate::joint::JointLaw;
use crate::law::{CohesiveFrictional, Coupling, InterfaceHistory, InterfaceResponse};
use crate::shifted::Shift;

impl CohesiveFrictional {
    /// Law of a joint in a plane of symmetry, of which one half is modelled.
    ///
    /// The modelled half takes half of the opening, measured from the middle of the joint. Slip is free, because the
    /// other half slides equally: there is no friction, and slip does not damage the bond (δ_k = ∞).
    ///
    /// ```text
    ///  t(w) of the whole = t'(w/2) of the half:  k' = 2 k,  u_k' = u_k/2;  G' = ∫ t' dw' = G/2
    /// ```
    #[must_use]
    pub fn half(&self) -> Self {
        Self {
            c: 0.0,
            tan_phi: 0.0,
            mu: 0.0,
            u_k: 0.5 * self.u_k,
            delta_k: f64::INFINITY,
            normal_stiffness: 2.0 * self.normal_stiffness,
            shear_stiffness: 2.0 * self.shear_stiffness,
            // Without damage by slip both coupling rules give D = Q(w), but the additive rule would evaluate H⁻¹.
            coupling: Coupling::Max,
            ..*self
        }
    }

    /// Whether this is the law of a joint cut at its middle (see [`half`](Self::half)). No deck gives an infinite
    /// δ_k.
    pub fn is_half(&self) -> bool {
        self.delta_k == f64::INFINITY
    }
}

/// All methods are overridden by closed forms.
impl JointLaw for CohesiveFrictional {
    #[inline(always)]
    fn name(&self) -> &'static str {
        "cohesive-frictional"
    }
    #[inline(always)]
    fn stiffness(&self) -> [f64; 2] {
        [self.normal_stiffness, self.shear_stiffness]
    }
    #[inline(always)]
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        self.update(gap, old)
    }
    fn virgin(&self) -> InterfaceHistory {
        self.virgin()
    }
    fn is_dry(&self) -> bool {
        self.is_dry()
    }
    fn opens_at(&self) -> f64 {
        self.elastic_opening()
    }
    fn ultimate_opening(&self) -> f64 {
        self.u_k
    }
    fn free_energy(&self, history: &InterfaceHistory) -> f64 {
        self.free_energy(history)
    }
    fn crossing_work(&self, old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
        self.crossing_work(old, new)
    }
    #[inline(always)]
    fn utilisation(&self, traction: &[f64; 3], history: &InterfaceHistory) -> f64 {
        self.utilisation(traction, history.damage)
    }
    #[inline(always)]
    fn exertion(&self, traction: &[f64; 3], history: &InterfaceHistory) -> f64 {
        self.exertion(traction, history.damage)
    }
    fn within_bounds(&self, guess: [f64; 3], old: &InterfaceHistory) -> [f64; 3] {
        self.within_bounds(guess, old)
    }
    fn softening_slopes(&self) -> [f64; 2] {
        self.softening_slopes()
    }
    fn halved(&self) -> Option<Arc<dyn JointLaw>> {
        Some(Arc::new(self.half()))
    }
    #[inline(always)]
    fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        self.update_shifted(gap, old, shift)
    }
}
