//! The energies of a run balance, and one whose energies do not says so and where.

use wythe::model::{Deck, Model};
use wythe::results::{EnergyBalance, Frame, HistoryRow, Recorder, Summary};
use wythe::solve;

#[derive(Default)]
struct Energies {
    balance: EnergyBalance,
    last: HistoryRow,
}

impl Recorder for Energies {
    fn take(&mut self, _: &Model, row: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        self.balance.push(row);
        self.last = row.clone();
        Ok(true)
    }
}

fn run(text: &str, set: &[(&str, &str)]) -> (Energies, Summary) {
    let set: Vec<(String, String)> = set
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let deck = Deck::from_str_with(text, "deck.toml", &set).unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let mut energies = Energies::default();
    let summary = solve::run(&model, &mut energies).unwrap();
    (energies, summary)
}

/// A bond that is weak and long in tension still carries shear where it gapes by millimetres: the joint turns about its edge,
/// and the work of its shear tractions on the turning was not counted, 16 % of all at every size of the increments.
#[test]
fn shear_in_a_joint_that_gapes_and_turns_is_counted() {
    let path = format!("{}/examples/40_airbag.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let (energies, summary) = run(&text, &[("interfaces.joint.f_t", "0.001 MPa")]);
    let error = energies.balance.error();
    // What the tolerance of forces and the size of the increments leave.
    assert!(error < 0.01, "{error}");
    // The term is there at all: without it the balance would be out by this much.
    let numerical = energies.last.numerical_dissipation_J / energies.balance.work();
    assert!(numerical.abs() > 0.05, "{numerical}");
    assert!(
        !summary
            .warnings
            .iter()
            .any(|w| w.contains("do not balance"))
    );
}

/// A block of 50 km that stands on a joint: its stiffness drowns the forces in rounding. It is refused by its material.
#[test]
fn a_block_whose_forces_drown_in_rounding_is_refused() {
    let deck = Deck::from_str(include_str!("../data/scenes/tall_block.toml"), "deck.toml").unwrap();
    let told = Model::from_deck(&deck).unwrap_err().to_string();
    assert!(told.contains("stone is too stiff for step 0"), "{told}");
}
