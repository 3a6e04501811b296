//! The fields of one output increment.

use nalgebra::Vector6;
use serde::{Deserialize, Serialize};
use wythe_contact::{InterfaceHistory, InterfaceLaw, JointLaw};

use crate::tensor;

/// Fields of one output increment.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Frame {
    /// Accumulated step time [s].
    pub time: f64,
    /// Number of increments.
    pub increment: usize,
    /// Step, from 0.
    pub step: usize,
    /// Displacement [mm]. `[node][xyz]`
    pub displacement: Vec<[f64; 3]>,
    /// Velocity [mm/s]. Empty if no step can have inertia. `[node][xyz]`
    pub velocity: Vec<[f64; 3]>,
    /// Nominal stress, mean over the element's points [MPa]. `[element][xx,yy,zz,xy,yz,zx]`
    pub stress: Vec<[f64; 6]>,
    /// Tensile damage, largest over the element's points [-]. `[element]`
    pub tensile_damage: Vec<f64>,
    /// Compressive damage, largest over the element's points [-]. `[element]`
    pub compressive_damage: Vec<f64>,
    /// Plastic strain, mean over the element's points [-], engineering shear. `[element][xx,yy,zz,xy,yz,zx]`
    pub plastic_strain: Vec<[f64; 6]>,
    /// Whether any point of the element has plastic strain or damage. `[element]`
    pub yielded: Vec<bool>,
    /// Crack opening: the band width (l_eq, or the width of its own band) times the largest principal inelastic
    /// strain of tensile cracks, mean over the element's points [mm]. `[element]`
    pub crack_width: Vec<f64>,
    /// Outputs of the laws of the solids. See [`Model::outputs`](crate::model::Model::outputs).
    pub outputs: Vec<OutputField>,
    /// Fields of the joints.
    pub interfaces: InterfaceFrame,
    /// External forces on each beam, then on each support, then those of each load [N]. `[beam, support, load][xyz]`
    pub reactions: Vec<[f64; 3]>,
    /// Values of the model's probes, loads and outputs. See [`Model::columns`](crate::model::Model::columns).
    /// `[column]`
    pub probes: Vec<f64>,
}

/// Field of an output of a law.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OutputField {
    /// Its name.
    pub name: String,
    /// Solids: largest value over the element's points; 0 in elements whose law has no such output. `[element]`
    /// Joints: value of the point; NaN at points whose law has no such output. `[point]`
    pub values: Vec<f64>,
}

impl Frame {
    /// Principal nominal stresses, the largest first [MPa]. `[element][3]`
    pub fn principal_stresses(&self) -> Vec<[f64; 3]> {
        let of = |stress: &[f64; 6]| tensor::principal_values(&Vector6::from(*stress));
        self.stress.iter().map(of).collect()
    }
}

/// Fields of the joints at one output increment. `[slave facet][point]`, four points on each facet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceFrame {
    /// Opening u, negative when closed [mm].
    pub opening: Vec<f64>,
    /// Slip δ along the facet's two tangents [mm].
    pub slip: Vec<[f64; 2]>,
    /// Traction [σ, τ₁, τ₂], tension positive [MPa].
    pub traction: Vec<[f64; 3]>,
    /// Damage D [-].
    pub damage: Vec<f64>,
    /// State of the bond.
    pub state: Vec<InterfaceState>,
    /// Outputs of the joint laws; NaN at points of laws without this output. `[output]`
    pub outputs: Vec<OutputField>,
}

/// State of a contact point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum InterfaceState {
    /// No damage. For a dry joint: under pressure and not sliding.
    #[default]
    Intact = 0,
    /// Damaged, with cohesion left.
    Softening = 1,
    /// Without cohesion, and open.
    FailedOpen = 2,
    /// Without cohesion, under pressure: friction remains.
    FailedSliding = 3,
}

impl InterfaceState {
    /// State of a point with this history under `law`.
    pub fn of(law: &InterfaceLaw, history: &InterfaceHistory) -> Self {
        let open = history.traction[0] >= 0.0 && history.opening > 0.0;
        let failed = history.damage >= FAILED || law.is_dry();
        match (failed, open) {
            (true, true) => Self::FailedOpen,
            (true, false) if law.is_dry() && history.slip_max == 0.0 => Self::Intact,
            // In a plane of symmetry the other side slides equally, so there is no relative slip.
            (true, false) if law.is_dry() && law.is_half() => Self::Intact,
            (true, false) => Self::FailedSliding,
            (false, _) if history.damage > 0.0 => Self::Softening,
            (false, _) => Self::Intact,
        }
    }

    /// State with this number in the files.
    pub fn from_number(number: u8) -> Option<Self> {
        [
            Self::Intact,
            Self::Softening,
            Self::FailedOpen,
            Self::FailedSliding,
        ]
        .into_iter()
        .find(|state| *state as u8 == number)
    }
}

/// Damage from which a point counts as failed. Exponential softening reaches 1 only where it is cut off.
const FAILED: f64 = 0.99;

#[cfg(test)]
mod tests {
    use super::*;
    use wythe_contact::{CohesiveFrictional, Coupling};

    /// A joint cut at its middle opens and closes, and slides freely without damage.
    #[test]
    fn slip_along_a_plane_of_symmetry_leaves_the_bond() {
        for coupling in [Coupling::Max, Coupling::Additive] {
            let whole = CohesiveFrictional {
                f_t: 0.2,
                c: 0.3,
                u_k: 0.36,
                delta_k: 0.4,
                zeta: 4.38,
                xi: 1.1,
                coupling,
                ..CohesiveFrictional::dry(0.75, 100.0, 40.0)
            };
            let law = whole.half();
            let u_0 = law.f_t / law.normal_stiffness;
            let after = |opening: f64| {
                let first = law.update([0.5 * opening, 0.1, 0.0], &law.virgin()).history;
                law.update([opening, 0.3, 0.0], &first).history
            };
            for held in [-0.01, 0.5 * u_0] {
                let history = after(held);
                assert_eq!(history.damage, 0.0, "{coupling:?}");
                assert_eq!(
                    InterfaceState::of(&law.into(), &history),
                    InterfaceState::Intact
                );
            }
            let history = after(2.0 * u_0);
            let (expected, _) = law.opening_curve().evaluate(u_0);
            // Rounding of an exponential.
            assert!((history.damage - expected).abs() < 1e-14, "{coupling:?}");
            assert_eq!(
                InterfaceState::of(&law.into(), &history),
                InterfaceState::Softening
            );
        }
        let law = CohesiveFrictional::dry(0.6, 50.0, 20.0).half();
        let pressed = law.update([-0.01, 0.1, 0.0], &law.virgin()).history;
        assert!(pressed.slip_max > 0.0);
        assert_eq!(
            InterfaceState::of(&law.into(), &pressed),
            InterfaceState::Intact
        );
        let open = law.update([0.01, 0.1, 0.0], &law.virgin()).history;
        assert_eq!(
            InterfaceState::of(&law.into(), &open),
            InterfaceState::FailedOpen
        );
    }
}
