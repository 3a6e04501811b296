//! Laws of joints in a plane of symmetry.

use wythe_contact::{Coupling, InterfaceLaw};

/// Law of a joint in a plane of symmetry, of which one half is modelled.
///
/// Half the opening lies between the middle of the joint and the modelled body. Slip is free, because the other side
/// slides equally: there is no friction, and slip does not damage the bond (δ_k = ∞).
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
        // Without damage by slip both couplings give D = Q(w). The additive one would evaluate H⁻¹.
        coupling: Coupling::Max,
        ..*law
    }
}

/// Whether a law belongs to a joint cut at its middle (see [`mirrored`]). No deck gives an infinite δ_k.
pub(crate) fn is_mirrored(law: &InterfaceLaw) -> bool {
    law.delta_k == f64::INFINITY
}
