//! Names of a point's components and results, in tables and on the command line.

use std::borrow::Cow;

use wythe_contact::JointLaw;

use crate::material::SolidLaw;

/// Names of the components of a point and of the columns of its results.
#[derive(Debug)]
pub struct Layout<const N: usize> {
    /// Names of the components, as in `--stress`.
    pub components: [&'static str; N],
    /// Columns of the strains or gaps.
    pub strains: [&'static str; N],
    /// Columns of the stresses or tractions.
    pub stresses: [&'static str; N],
    /// Columns of the state variables.
    pub state: Cow<'static, [&'static str]>,
}

/// A material point in engineering Voigt notation. Its state is [`material_state`](super::material_state).
pub const MATERIAL: Layout<6> = Layout {
    components: ["xx", "yy", "zz", "xy", "yz", "zx"],
    strains: ["eps_xx", "eps_yy", "eps_zz", "gam_xy", "gam_yz", "gam_zx"],
    stresses: [
        "sig_xx_MPa",
        "sig_yy_MPa",
        "sig_zz_MPa",
        "sig_xy_MPa",
        "sig_yz_MPa",
        "sig_zx_MPa",
    ],
    state: Cow::Borrowed(&["kt", "kc", "dt", "dc", "d"]),
};

/// An interface point: opening and two slips. Its state is [`interface_state`](super::interface_state).
pub const INTERFACE: Layout<3> = Layout {
    components: ["normal", "tau1", "tau2"],
    strains: ["u_mm", "d1_mm", "d2_mm"],
    stresses: ["sig_MPa", "tau1_MPa", "tau2_MPa"],
    state: Cow::Borrowed(&["D"]),
};

/// [`MATERIAL`] with the outputs of a law after the damage, as [`material_outputs`](super::material_outputs).
pub fn material_layout(law: &dyn SolidLaw) -> Layout<6> {
    let outputs = law.outputs().iter().map(|output| output.name);
    Layout {
        state: MATERIAL.state.iter().copied().chain(outputs).collect(),
        ..MATERIAL
    }
}

/// [`INTERFACE`] with the outputs of a law after the damage, as [`interface_outputs`](super::interface_outputs).
pub fn interface_layout(law: &(impl JointLaw + ?Sized)) -> Layout<3> {
    let outputs = law.outputs().iter().map(|output| output.name);
    Layout {
        state: INTERFACE.state.iter().copied().chain(outputs).collect(),
        ..INTERFACE
    }
}
