//! Reuse of element stiffness while the rotation is small: results do not change.

use crate::common::blocks::deck_and_model;
use crate::common::scene;
use wythe::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use wythe::linear::Backend;
use wythe::model::mirrored::{MirrorPlane, mirror_planes};
use wythe::model::scene::Fidelity;
use wythe::state::Clock;
use wythe::state::HistoryRow;

/// A wall whose ground separates below its middle: one crack grows, and the rest is hardly affected.
const PARTED: &str = include_str!("../../../benches/facade.toml");

/// Stiffness and partial factorisations of elements that hardly rotate are reused. Forces follow the law in any case:
/// they agree with those of a run without reuse within the documented 0.5 %. Different increments, and the place
/// within the tolerance where each ends, account for up to 2e-3 in either run.
#[test]
fn elements_far_from_a_crack_are_not_factorised_again() {
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

/// Only changed cells are summed again. The matrix is bitwise equal to one that is summed as a whole.
#[test]
fn only_changed_cells_are_summed_again() {
    let (_, mut model) = deck_and_model(PARTED);
    model.fidelity = Fidelity::Auto;
    let mut system = System::new(&model).unwrap();
    let state = system.initial_state(&model);
    let equations = Equations::new(&system.dofs, &model.steps[0]);
    let mut trial = Trial::default();
    let mut clock = Clock::default();
    let setting = Evaluation {
        dt: 0.1,
        solids: Solids::Secant,
        shifted: true,
        tangent: true,
        turning: Turning::Ignored,
    };
    trial.start(&state);
    let (entries, _) = {
        system.search(&mut trial, &state.q);
        system
            .analyse(&equations, Backend::MultifrontalLlt)
            .unwrap()
    };
    let (mut values, mut last) = (vec![f64::NAN; entries], None);
    let mut stayed = 0;
    // The bodies at one end are moved further and further, then back.
    for part in [0.0, 0.01, 0.02, 0.02, 0.05, 0.0] {
        let mut q = state.q.clone();
        for (slot, q) in q.iter_mut().enumerate().take(system.dofs.beam_start) {
            let (node, axis) = system.dofs.node_of(slot);
            let [x, _, z] = model.mesh.nodes[node];
            *q = if axis == 0 {
                -part * (1.0 - x / 500.0).max(0.0) * z / 400.0
            } else {
                0.0
            };
        }
        system.search(&mut trial, &q);
        system
            .evaluate(&model, &state, &mut trial, &q, setting, &mut clock)
            .unwrap();
        let mut whole = vec![0.0; entries];
        system.fill(&trial, &mut whole);
        // Entries that are not summed again keep their previous values.
        let before = values.clone();
        if last.is_some() {
            values.fill(f64::NAN);
        }
        system.refill(&mut trial, &mut last, &mut values);
        for ((now, whole), before) in values.iter_mut().zip(&whole).zip(&before) {
            if now.is_nan() {
                stayed += 1;
                *now = *before;
            }
            assert_eq!(now.to_bits(), whole.to_bits());
        }
    }
    // Of 5 assemblies after the first; a chunk has 20,000 entries.
    assert!(stayed > entries, "{stayed} of {entries}");
    assert!(stayed < 5 * entries);
    // A different matrix, or a trial state that is discarded, is assembled as a whole.
    let mut other = vec![f64::NAN; entries];
    system.refill(&mut trial, &mut None, &mut other);
    assert!(
        other
            .iter()
            .zip(&values)
            .all(|(a, b)| a.to_bits() == b.to_bits())
    );
    values.fill(f64::NAN);
    system.refill(&mut trial, &mut last, &mut values);
    assert!(
        other
            .iter()
            .zip(&values)
            .all(|(a, b)| a.to_bits() == b.to_bits())
    );
}
