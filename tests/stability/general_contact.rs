//! General contact: bodies that meet anywhere, from anywhere, at any speed.

#[path = "../common/mod.rs"]
mod common;

use common::inside::deepest;
use common::scene::{self, Block, DENSITY, G, Recording, gap};
use wythe::model::Model;
use wythe::model::scene::{Gravity, Procedure};
use wythe::results::HistoryRow;

const E: f64 = 1e4;

/// Positions of all nodes at a commit [mm].
fn positions(model: &Model, recording: &Recording, at: usize) -> Vec<[f64; 3]> {
    let u = &recording.frames[at].displacement;
    let nodes = model.mesh.nodes.iter().zip(u);
    nodes
        .map(|(x, u)| [0, 1, 2].map(|i| x[i] + u[i]))
        .collect()
}

/// Deepest point of a body in another at any commit [mm].
fn penetration(model: &Model, recording: &Recording) -> f64 {
    (0..recording.frames.len())
        .map(|k| deepest(&model.mesh, &positions(model, recording, k), 9))
        .fold(0.0, f64::max)
}

fn most(recording: &Recording, of: fn(&HistoryRow) -> f64) -> f64 {
    recording.rows.iter().map(of).fold(0.0, f64::max)
}

/// Worst gap of the energies over the most that was put in.
fn imbalance(recording: &Recording) -> f64 {
    most(recording, |r| gap(r).abs()) / most(recording, |r| r.external_work_J.abs())
}

/// Largest total of kinetic, elastic and dissipated energy beyond what was put in, over it.
fn gain(recording: &Recording) -> f64 {
    let of = |r: &HistoryRow| {
        r.kinetic_energy_J + r.elastic_energy_J + r.interface_dissipation_J - r.external_work_J
    };
    let gained = recording.rows.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    gained / most(recording, |r| r.external_work_J.abs())
}

fn velocity(model: &Model, recording: &Recording, block: &Block) -> [f64; 3] {
    let dofs = wythe::system::DofMap::new(model);
    let state = recording.states.last().unwrap();
    let nodes = block.nodes();
    [0, 1, 2].map(|i| {
        let of = |n: &u32| state.velocity[dofs.slot[*n as usize][i] as usize];
        nodes.iter().map(of).sum::<f64>() / nodes.len() as f64
    })
}

fn tell(model: &Model, recording: &Recording) -> f64 {
    let deep = penetration(model, recording);
    let last = recording.rows.last().unwrap();
    println!(
        "  deepest {deep:.2e} mm, balance {:.1e}, gain {:.1e}, kinetic {:.3e} of {:.3e} J, friction {:.2e}, numerical {:.2e}",
        imbalance(recording),
        gain(recording),
        last.kinetic_energy_J,
        most(recording, |r| r.external_work_J.abs()),
        last.interface_dissipation_J,
        last.numerical_dissipation_J,
    );
    deep
}

/// Two cubes of 100 mm in free flight; the second is turned, and comes with this velocity.
fn collide(at: [f64; 3], turns: &[([f64; 3], f64)], v: [f64; 3], increments: usize, time: f64) -> (Model, Recording, [Block; 2]) {
    let mut model = scene::empty();
    let solid = scene::heavy(E, 0.2, DENSITY);
    let first = scene::block(&mut model, [-50.0; 3], [100.0; 3], [1, 1, 1], &solid);
    let low = at.map(|x| x - 50.0);
    let second = scene::block(&mut model, low, [100.0; 3], [1, 1, 1], &solid);
    for (axis, angle) in turns {
        scene::turn(&mut model, &second, at, *axis, angle.to_radians());
    }
    scene::throw(&mut model, &second, v);
    scene::general(&mut model, 0.5);
    model.steps = vec![scene::set_free(Gravity::None, time, increments, 5e-3, -0.05)];
    let recording = scene::completed(&model);
    (model, recording, [first, second])
}

#[test]
fn cubes_collide_face_edge_and_corner_first() {
    let to_corner = (2.0_f64.sqrt()).atan().to_degrees();
    let x = [1.0, 0.0, 0.0];
    let y = [0.0, 1.0, 0.0];
    let z = [0.0, 0.0, 1.0];
    let cases: [(&str, [f64; 3], Vec<([f64; 3], f64)>); 7] = [
        ("face on face", [0.0, 0.0, 110.0], vec![]),
        ("face on face, half over", [47.0, 31.0, 110.0], vec![]),
        ("edge on face", [3.0, 5.0, 130.0], vec![(x, 45.0)]),
        ("corner on face", [3.0, 5.0, 145.0], vec![(z, 45.0), (x, to_corner)]),
        ("edge on edge, crossed", [0.0, 3.0, 130.0], vec![(x, 45.0), (z, 30.0)]),
        ("flat, crossed", [2.0, 3.0, 110.0], vec![(z, 40.0)]),
        ("corner on the rim", [49.0, 5.0, 145.0], vec![(z, 45.0), (x, to_corner)]),
    ];
    let _ = y;
    for (name, at, turns) in cases {
        for (v, increments, time) in [(-1000.0, 60, 0.06), (-1000.0, 600, 0.06), (-20000.0, 40, 0.02)] {
            println!("{name}, {v} mm/s, {increments} increments");
            let (model, recording, [a, b]) = collide(at, &turns, [0.0, 0.0, v], increments, time);
            let deep = tell(&model, &recording);
            let [va, vb] = [&a, &b].map(|b| velocity(&model, &recording, b)[2]);
            println!("  {va:.1} and {vb:.1} mm/s, restitution {:.3}", (va - vb) / v);
            if std::env::var("LOOK").is_ok() { continue; }
            assert!(deep < 0.1, "{name}: {deep}");
            assert!(imbalance(&recording) < 1e-2, "{name}");
            assert!(gain(&recording) < 1e-2, "{name}");
            // Momentum.
            assert!(((va + vb) / v - 1.0).abs() < 1e-3, "{name}: {va} {vb}");
        }
    }
}
