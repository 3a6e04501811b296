//! Joints that lie in a plane of symmetry.

use wythe_contact::{Coupling, InterfaceLaw};

/// The law of a joint that lies in a plane of symmetry, of which the half is modelled: between its middle and its
/// mirror image lies half the opening. Slip is free: the other side slides along, so that it meets no friction and
/// takes nothing from the bond (δ_k = ∞).
///
/// ```text
/// t(w) of the whole = t'(w/2) of the half:  k' = 2 k,  u_k' = u_k/2;  G' = ∫ t' dw' = G/2
/// ```
pub(crate) fn mirrored(law: &InterfaceLaw) -> InterfaceLaw {
    InterfaceLaw {
        c: 0.0,
        tan_phi: 0.0,
        mu: 0.0,
        u_k: 0.5 * law.u_k,
        delta_k: f64::INFINITY,
        normal_stiffness: 2.0 * law.normal_stiffness,
        shear_stiffness: 2.0 * law.shear_stiffness,
        // Without slip in it both couplings are D = Q(w); the sum would look for H⁻¹.
        coupling: Coupling::Max,
        ..*law
    }
}

/// Whether a law is that of a joint cut at its middle, see [`mirrored`]: no deck says an infinite δ_k.
pub(crate) fn is_mirrored(law: &InterfaceLaw) -> bool {
    law.delta_k == f64::INFINITY
}
