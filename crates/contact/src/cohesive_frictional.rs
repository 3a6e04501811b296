//! The cohesive-frictional law (docs/contact.md) as a [`JointLaw`].

use std::sync::Arc;

use crate::joint::JointLaw;
use crate::law::{CohesiveFrictional, Coupling, InterfaceHistory, InterfaceResponse};
use crate::shifted::Shift;

impl CohesiveFrictional {
    /// The law of a joint that lies in a plane of symmetry, of which the half is modelled: between its middle and its
    /// mirror image lies half the opening. Slip is free: the other side slides along, so that it meets no friction and
    /// takes nothing from the bond (δ_k = ∞).
    ///
    /// ```text
    /// t(w) of the whole = t'(w/2) of the half:  k' = 2 k,  u_k' = u_k/2;  G' = ∫ t' dw' = G/2
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
            // Without slip in it both couplings are D = Q(w); the sum would look for H⁻¹.
            coupling: Coupling::Max,
            ..*self
        }
    }

    /// Whether it is the law of a joint cut at its middle, see [`half`](Self::half): no deck says an infinite δ_k.
    pub fn is_half(&self) -> bool {
        self.delta_k == f64::INFINITY
    }
}

/// Every method has a closed form of its own.
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
