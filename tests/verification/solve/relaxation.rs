//! Relaxation: dashpots carry the structure over a snap to the next equilibrium, and their work is counted.

use crate::common::scene::completed;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::HistoryRow;
use wythe::state::Method;

/// Case 15 of the atlas: a brick of 3.5 MPa on 50 by 50 mm breaks in series with 0.8 m of elastic brickwork. Its
/// residual stress is 0.3 MPa.
#[test]
fn a_brick_that_snaps_is_relaxed_once_and_its_energy_is_counted() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/stability/cases/15-brick-snaps/deck.toml"
    );
    let deck = Deck::load(path, &[]).unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let rows = completed(&model).rows;
    let relaxed = |row: &HistoryRow| row.procedure == Method::Relaxation;
    assert_eq!(rows.iter().filter(|row| relaxed(row)).count(), 1);
    let at = rows.iter().position(relaxed).unwrap();
    let (before, after, last) = (&rows[at - 1], &rows[at], rows.last().unwrap());
    // The prescribed displacement continues and never turns back.
    assert!(after.displacement_mm > before.displacement_mm);
    // The peak is found (`increments.peak` is half a per cent), and the run continues in the equilibrium of the
    // residual stress (the tolerance is 2e-3 in the root mean square).
    let peak = rows.iter().map(|row| row.force_kN).fold(0.0, f64::max);
    assert!((peak / 8.75 - 1.0).abs() < 5e-3, "{peak} kN");
    assert!(
        (after.force_kN / 0.75 - 1.0).abs() < 5e-3,
        "{} kN",
        after.force_kN
    );
    // The dashpots dissipate the elastic energy that went neither into the crack nor into the drive, and nothing
    // before or after.
    let freed = before.elastic_energy_J - after.elastic_energy_J;
    let work = after.external_work_J - before.external_work_J;
    let crack = after.plastic_damage_dissipation_J - before.plastic_damage_dissipation_J;
    let dashpots = after.damping_dissipation_J - before.damping_dissipation_J;
    // The energy error may be at most 1 % of the work.
    let open = freed + work - crack - dashpots;
    assert!(open.abs() < 1e-2 * last.external_work_J, "{open} J");
    assert!(dashpots > 0.2, "{dashpots} J of 0.79");
    assert_eq!(before.damping_dissipation_J, 0.0);
    // At the end the dashpot forces are below the equilibrium tolerance, 2e-3, and act over less than 1 % of the
    // displacement of the snap.
    let rest = last.damping_dissipation_J - after.damping_dissipation_J;
    assert!(rest.abs() < 2e-5 * dashpots, "{rest} J");
}
