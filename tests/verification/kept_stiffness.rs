//! What hardly turns keeps its stiffness, and nothing else of a run.

#[path = "../common/mod.rs"]
mod common;

use common::blocks::deck_and_model;
use common::scene;
use wythe::model::mirrored::{MirrorPlane, mirror_planes};
use wythe::model::scene::Fidelity;
use wythe::results::HistoryRow;

/// A wall whose ground parts below its middle: one crack climbs, and the rest hardly knows of it.
const PARTED: &str = include_str!("../../benches/facade.toml");

/// What hardly turns keeps its stiffness, and the factorisation what it made of it. Forces follow the law all the
/// same: those of the run with nothing kept, within the half per cent that is promised (which increments were taken,
/// and where in its tolerance each ended, makes up to 2e-3 in either).
#[test]
fn what_is_far_from_a_crack_is_not_factorised_again() {
    let (_, mut model) = deck_and_model(PARTED);
    assert_eq!(mirror_planes(&model), [MirrorPlane { axis: 1, at: 49.0 }]);
    let mut run = |fidelity| {
        model.fidelity = fidelity;
        scene::run(&model)
    };
    let (whole, all) = run(Fidelity::Full);
    let (kept, some) = run(Fidelity::Auto);
    assert_eq!(all.reused, 0.0);
    let share = some.reused / some.factorisations as f64;
    assert!(share > 0.3, "{share}");
    let last = |rows: &[HistoryRow]| rows[rows.len() - 1].clone();
    let (a, b) = (last(&whole.rows), last(&kept.rows));
    assert!(a.max_interface_damage > 0.2, "{a:?}");
    let apart = |a: f64, b: f64| (a - b).abs() / a.abs();
    assert!(apart(a.force_kN, b.force_kN) < 5e-3, "{a:?} {b:?}");
    assert!(
        apart(a.elastic_energy_J, b.elastic_energy_J) < 5e-3,
        "{a:?} {b:?}"
    );
}
