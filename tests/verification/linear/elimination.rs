//! Local equilibrium iterations: a residual in a few places is reduced there first, without other changes to a run.

use crate::common::blocks::deck_and_model;
use crate::common::scene;
use wythe::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use wythe::linear::Backend;
use wythe::model::scene::Fidelity;
use wythe::state::Clock;
use wythe::state::HistoryRow;

/// A wall whose ground separates below its middle: one crack grows, and the rest is hardly affected.
const PARTED: &str = include_str!("../../../benches/facade.toml");

/// If only a few nodes move, only their neighbourhood is evaluated. Forces, stiffness and histories are bitwise equal
/// to a full evaluation.
#[test]
fn elements_away_from_moving_nodes_are_not_evaluated() {
    let (_, mut model) = deck_and_model(PARTED);
    for fidelity in [Fidelity::Full, Fidelity::Auto] {
        model.fidelity = fidelity;
        let mut system = System::new(&model).unwrap();
        let state = system.initial_state(&model);
        let equations = Equations::new(&system.dofs, &model.steps[0]);
        let mut setting = Evaluation {
            dt: 0.1,
            solids: Solids::Secant,
            shifted: true,
            tangent: true,
            turning: Turning::Ignored,
        };
        let mut clock = Clock::default();
        let rest: Vec<f64> = (0..system.dofs.slots)
            .map(|slot| 1e-4 * (0.7 * slot as f64).sin())
            .collect();
        // A node in the middle of the wall and its neighbours open their joints.
        let slots: Vec<u32> = (0..12).map(|i| system.dofs.slots as u32 / 2 + i).collect();
        let mut q = rest.clone();
        for &slot in &slots {
            q[slot as usize] += 0.01 * f64::from(slot).cos();
        }
        let mut run = |system: &mut System, watches: bool| {
            let mut trial = Trial::default();
            system.start(&model, &mut trial, &state);
            for (at, tangent, alone) in [(&rest, true, false), (&q, false, true), (&q, true, true)]
            {
                if watches && alone {
                    system.watch(&mut trial, slots.iter().copied());
                }
                setting.tangent = tangent;
                let done = system.evaluate(&model, &state, &mut trial, at, setting, &mut clock);
                done.unwrap();
            }
            trial
        };
        let (mut trial, all) = (run(&mut system, true), run(&mut system, false));

        // The message omits the numbers, since there are thousands.
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same(&trial.force, &all.force));
        assert!(trial.joints.status == all.joints.status);
        assert!(trial.solids.history == all.solids.history);
        assert!(trial.joints.history == all.joints.history);
        let (entries, _) = system
            .analyse(&equations, Backend::MultifrontalLlt)
            .unwrap();
        let (mut some, mut whole) = (vec![0.0; entries], vec![0.0; entries]);
        system.fill(&trial, &mut some);
        system.fill(&all, &mut whole);
        assert!(same(&some, &whole));
        // Some joints are damaged, but not all.
        let damaged = all.joints.history.iter().filter(|h| h.damage > 0.0).count();
        assert!(
            damaged > 0 && damaged < all.joints.history.len() / 4,
            "{damaged}"
        );
        // Distant elements are not evaluated: their old values remain.
        let marked = [[f64::NAN; 3]; 8];
        trial.cells.force[..model.mesh.elements.len()].fill(marked);
        let done = system.evaluate(&model, &state, &mut trial, &q, setting, &mut clock);
        done.unwrap();
        let elements = trial.cells.force[..model.mesh.elements.len()].iter();
        let stayed = elements.filter(|force| force[0][0].is_nan()).count();
        let of = model.mesh.elements.len();
        assert!(stayed > of / 2 && stayed < of, "{stayed} of {of}");
    }
}

/// The crack takes fewer global solves, and the result is the same.
#[test]
fn a_crack_is_equilibrated_locally() {
    let (_, mut model) = deck_and_model(PARTED);
    let mut run = |fidelity| {
        model.fidelity = fidelity;
        scene::run(&model)
    };
    let (whole, all) = run(Fidelity::Full);
    let (auto, some) = run(Fidelity::Auto);
    println!(
        "{} and {} solves, {} local",
        all.iterations, some.iterations, some.local_solves
    );
    assert_eq!(all.local_solves, 0);
    assert!(some.local_solves > 0);
    // 0.57 of them; symmetry and stiffness reuse alone take 0.74 (115 of 156).
    assert!((some.iterations as f64) < 0.65 * all.iterations as f64);
    assert!(some.factorisations <= some.iterations);
    let last = |rows: &[HistoryRow]| rows[rows.len() - 1].clone();
    let (a, b) = (last(&whole.rows), last(&auto.rows));
    // The documented accuracy of `auto` (docs/solver.md); different increments account for up to 2e-3.
    let apart = |a: f64, b: f64| (a - b).abs() / a.abs();
    assert!(apart(a.force_kN, b.force_kN) < 5e-3, "{a:?} {b:?}");
    assert!(
        apart(a.elastic_energy_J, b.elastic_energy_J) < 5e-3,
        "{a:?} {b:?}"
    );
}
