//! A joint law of one's own: Mohr-Coulomb with dilatancy, checked alone, then between two blocks.
//! Run it by `cargo run --release --example own_joint`.

use nalgebra::{Matrix3, Vector3};
use wythe::contact::checks::{Path, dissipation, objectivity, tangent};
use wythe::contact::{InterfaceHistory, InterfaceLaw, InterfaceResponse, JointLaw, Output};
use wythe::state::{Frame, HistoryRow};
use wythe::{deck::Deck, model::Model, solve::Recorder};

/// Cohesion c [MPa], friction tan φ and dilatancy tan ψ.
const C: f64 = 0.2;
const TAN_PHI: f64 = 0.7;
const TAN_PSI: f64 = 0.1;

/// |τ| ≤ c − tan φ σ with perfect plasticity: slip by λ lifts the joint by λ tan ψ. Stiffnesses in N/mm³.
#[derive(Debug)]
struct MohrCoulomb([f64; 2]);

impl JointLaw for MohrCoulomb {
    fn name(&self) -> &'static str {
        "Mohr-Coulomb with dilatancy"
    }
    fn stiffness(&self) -> [f64; 2] {
        self.0
    }
    /// The plastic opening is the first of the law's own numbers, and a field of the results by this name.
    fn outputs(&self) -> &'static [Output] {
        const { &[Output::new("uplift", "mm", 0)] }
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let [k_n, k_s] = self.0;
        let stiffness = Vector3::new(k_n, k_s, k_s);
        let before = [old.slots[0], old.plastic_slip[0], old.plastic_slip[1]];
        // The elastic trial, and how far it is beyond the Coulomb line.
        let mut t = stiffness.component_mul(&(Vector3::from(gap) - Vector3::from(before)));
        let mut tangent = Matrix3::from_diagonal(&stiffness);
        let tau = t.yz().norm();
        let beyond = tau + TAN_PHI * t.x - C;
        if beyond > 0.0 {
            // Slip along the shear traction, with its uplift, leads back to the line.
            let n = Vector3::new(0.0, t.y, t.z) / tau.max(f64::MIN_POSITIVE);
            let [line, flow] =
                [TAN_PHI, TAN_PSI].map(|tan| stiffness.component_mul(&(n + tan * Vector3::x())));
            let hardness = TAN_PHI * flow.x + k_s;
            let slip = beyond / hardness;
            if k_s * slip < tau {
                t -= slip * flow;
                let across = Matrix3::from_diagonal(&[0.0, 1.0, 1.0].into()) - n * n.transpose();
                tangent -= flow * line.transpose() / hardness + slip * k_s * k_s / tau * across;
            } else {
                // Nothing resists beyond the apex of the line.
                (t, tangent) = (C / TAN_PHI * Vector3::x(), Matrix3::zeros());
            }
        }
        let plastic: [f64; 3] = (Vector3::from(gap) - t.component_div(&stiffness)).into();
        let (plastic, slots) = ([before, plastic], [plastic[0], 0.0, 0.0, 0.0]);
        InterfaceResponse::new(
            old,
            gap,
            t.into(),
            tangent,
            plastic,
            0.0,
            slots,
            self.0,
            0.0,
        )
    }
}

/// The largest force of a run [kN].
struct Largest(f64);

impl Recorder for Largest {
    fn take(&mut self, _: &Model, row: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        self.0 = self.0.max(row.force_kN);
        Ok(true)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The law alone: derivatives, directions, energies on random paths.
    let law = MohrCoulomb([400.0, 160.0]);
    let path = Path::random(7, 60, 1e-3, 1e-3);
    tangent(&law, &path, 1e-8, 1e-5)?;
    objectivity(&law, &path, 1.0, 1e-9)?;
    dissipation(&law, &path.divided(50), 1e-9)?;

    // Two blocks under 0.5 MPa on 200 × 100 mm are sheared: c + tan φ 0.5 MPa = 0.55 MPa, 11 kN.
    let deck = Deck::load("examples/08_block_couplet.toml", &[])?;
    let (mut model, _) = Model::from_deck(&deck)?;
    for own in &mut model.contact.laws {
        *own = InterfaceLaw::custom(MohrCoulomb(own.stiffness()));
    }
    let mut largest = Largest(0.0);
    wythe::solve::run(&model, &mut largest)?;
    println!("largest shear force {:.3} kN, 11 by hand", largest.0);
    Ok(())
}
