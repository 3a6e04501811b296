//! A law of one's own: von Mises plasticity with linear hardening, checked and put into a model.
//! `cargo run --release --example own_law` runs it.
//!
//! ```text
//! F = q − (f_y + H κ) ≤ 0,   q = √(3/2 s:s),   Δκ = F_tr/(3G + H),   Δε_p = Δκ (3/2) s/q
//! ```
use nalgebra::Vector6;
use wythe::deck::Deck;
use wythe::material::{
    self as solid, LawOutput, MaterialHistory, MaterialParameters, Response, Slot, SolidLaw,
};
use wythe::model::Model;
use wythe::point::checks::{self, Paths};
use wythe::solve::Recorder;
use wythe::state::{Frame, HistoryRow};
use wythe::tensor::{UNIT, mean, norm_squared};

/// κ becomes a field of the elements and the column `max_hardening` of the history.
const KAPPA: LawOutput = LawOutput::new("hardening", "1", Slot::KappaT);

/// Elastic constants; yield stress f_y and hardening modulus H [MPa].
#[derive(Debug)]
struct VonMises(solid::ElasticParameters, [f64; 2]);

impl SolidLaw for VonMises {
    fn name(&self) -> &'static str {
        "von-mises"
    }
    fn elastic(&self) -> &solid::ElasticParameters {
        &self.0
    }
    /// One step: the history keeps the plastic strain and κ.
    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        _: solid::Increment,
    ) -> Result<Response, solid::LocalFailure> {
        let (g3, [f_y, h]) = (3.0 * self.0.shear_modulus(), self.1);
        let mut tangent = solid::elastic_stiffness(&self.0);
        let mut stress = solid::hooke(&self.0, &(strain - old.plastic_strain));
        let s = stress - UNIT * mean(&stress);
        let q = (1.5 * norm_squared(&s)).sqrt();
        let (kappa, mut history) = ((q - f_y - h * old.kappa_t).max(0.0) / (g3 + h), *old);
        if kappa > 0.0 {
            history.kappa_t += kappa;
            // Engineering shear strains are twice those of the tensor.
            let twice = Vector6::new(1.0, 1.0, 1.0, 2.0, 2.0, 2.0);
            history.plastic_strain += (1.5 * kappa / q) * s.component_mul(&twice);
            stress -= (g3 * kappa / q) * s;
            // dσ/dε: less of the deviator, and the change of its length.
            let volume = self.0.bulk_modulus() * UNIT * UNIT.transpose();
            let along = (g3 / q) * (g3 / q) * (kappa / q - 1.0 / (g3 + h));
            tangent -= (tangent - volume) * (g3 * kappa / q) - along * s * s.transpose();
        }
        Ok(Response::inviscid(strain, old, stress, tangent, history))
    }
    fn outputs(&self) -> &'static [LawOutput] {
        &[KAPPA]
    }
}

struct Last(HistoryRow);
impl Recorder for Last {
    fn take(&mut self, _: &Model, row: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        self.0 = row.clone();
        Ok(true)
    }
}

/// A cube of 100 mm, free to contract, is drawn out by 1 mm.
const DECK: &str = r#"
format = 1
materials.steel = { E = "20 GPa", nu = 0.3 }
blocks = [{ name = "cube", size = [100, 100, 100], material = "steel", mesh = [2, 2, 2] }]
supports = [
    { on = "cube.bottom", fixed = ["z"] }, { on = "cube.left", fixed = ["x"] },
    { on = "cube.front", fixed = ["y"] },
]
probes = [{ name = "top", near = [100, 100, 100], direction = "z" }]
[[steps]]
kind = "load"
procedure = "displacement_control"
control = { probe = "top", displacement = "1 mm" }
loads = [{ name = "pull", on = "cube.top", traction = [0, 0, "1 MPa"] }]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut model, _) = Model::from_deck(&Deck::from_str(DECK, "own_law")?)?;
    let law = VonMises(*model.materials[0].parameters.elastic(), [40.0, 500.0]);
    checks::all(&law, &Paths::of_step(5e-4))?;
    model.materials[0].parameters = MaterialParameters::custom(law);
    let mut last = Last(HistoryRow::default());
    wythe::solve::run(&model, &mut last)?;
    // Columns: the probe [mm], the traction [MPa], its force [kN], then the output of the law.
    println!("[kN, -] {:.6?}", &last.0.probes[2..]);
    // σ = f_y + H κ and ε = σ/E + κ = 0.01, for small strains.
    let stress = (40.0 + 500.0 * 0.01) / (1.0 + 500.0 / 20e3);
    println!("by hand {:.6?}", [10.0 * stress, 0.01 - stress / 20e3]);
    Ok(())
}
