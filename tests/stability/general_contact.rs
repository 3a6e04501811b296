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
    let frames = recording.frames.len();
    let every = frames / 200 + 1;
    (0..frames)
        .filter(|k| (frames - 1 - k).is_multiple_of(every))
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

/// Where a body was first this deep in another.
fn first_deep(model: &Model, recording: &Recording, limit: f64) {
    for k in 0..recording.frames.len() {
        let x = positions(model, recording, k);
        let (deep, e, at, o) = common::inside::deepest_point(&model.mesh, &x, 5);
        if deep > limit {
            println!("  frame {k} {:?}: {deep} mm, element {e} at {at:?} in {o}", recording.rows[k].time);
            for j in k.saturating_sub(3)..=k {
                let x = positions(model, recording, j);
                println!("   {:?} {:?}", recording.rows[j].time, common::inside::deepest_point(&model.mesh, &x, 5));
                println!("   e {:?}\n   o {:?}", model.mesh.elements[e].map(|n| x[n as usize].map(|v| (v * 1e3).round() * 1e-3)), model.mesh.elements[o].map(|n| x[n as usize].map(|v| (v * 1e3).round() * 1e-3)));
                let of = |t: &&wythe::system::Touch| { let g = model.contact.general.as_ref().unwrap(); let b = t.facets.map(|f| g.skin.body[f as usize] as usize); b == [e, o] || b == [o, e] };
                for t in recording.states[j].touches.iter().filter(of) {
                    println!("     {:?} {} {} facets {:?} at {:?} o {:.2e} g {:.2e} t {:?}", t.kind, t.first, t.second, t.facets, t.at, t.offset, t.history.opening, t.history.traction);
                }
            }
            return;
        }
    }
}

fn tell(model: &Model, recording: &Recording) -> f64 {
    let deep = penetration(model, recording);
    if deep > 0.15 {
        first_deep(model, recording, 0.15);
    }
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

fn rows(recording: &Recording) {
    if std::env::var("ROWS").is_err() {
        return;
    }
    for r in &recording.rows {
        println!("    {:.6} {:?} solves {} cuts {} T {:.3e} E {:.3e} open {} slide {} area {:.0} res {:.1e} fr {:.2e} num {:.3e}", r.time, r.procedure, r.iterations, r.cutbacks, r.kinetic_energy_J, r.elastic_energy_J, r.open_points, r.sliding_points, r.contact_area_mm2, r.residual, r.interface_dissipation_J, r.numerical_dissipation_J);
    }
}

/// A floor of 100 mm thickness, held.
fn floor(model: &mut Model, size: f64) -> Block {
    let solid = scene::heavy(E, 0.2, DENSITY);
    let low = [-0.5 * size, -0.5 * size, -100.0];
    let block = scene::block(model, low, [size, size, 100.0], [1, 1, 1], &solid);
    scene::hold(model, block.nodes(), [true; 3]);
    block
}

const DOWN: [f64; 3] = [0.0, 0.0, -G];

#[test]
fn a_block_falls_on_the_floor_and_comes_to_rest() {
    for (name, turns) in [
        ("flat", vec![]),
        ("on an edge", vec![([0.0, 1.0, 0.0], 20.0_f64)]),
        ("on a corner", vec![([0.0, 1.0, 0.0], 20.0), ([1.0, 0.0, 0.0], 15.0)]),
    ] {
        for procedure in ["dynamic", "quasi_static", "auto"] {
            let mut model = scene::empty();
            floor(&mut model, 1000.0);
            let solid = scene::heavy(E, 0.2, DENSITY);
            let block = scene::block(&mut model, [-50.0, -50.0, 60.0], [100.0; 3], [1, 1, 1], &solid);
            for (axis, angle) in &turns {
                scene::turn(&mut model, &block, [0.0, 0.0, 110.0], *axis, angle.to_radians());
            }
            scene::general(&mut model, 0.5);
            let mut step = scene::set_free(Gravity::Constant(DOWN), 1.0, 400, 5e-3, -0.05);
            match procedure {
                "quasi_static" => step.procedure = Procedure::QuasiStatic,
                "auto" => step.procedure = Procedure::Auto,
                _ => {}
            }
            model.steps = vec![step];
            println!("{name}, {procedure}");
            let recording = scene::completed(&model);
            rows(&recording);
            let deep = tell(&model, &recording);
            let x = positions(&model, &recording, recording.frames.len() - 1);
            let top = block.nodes().iter().map(|&n| x[n as usize][2]).fold(f64::MIN, f64::max);
            println!("  top at {top}");
        }
    }
}

fn by(step: &mut wythe::model::scene::Step, procedure: &str) {
    match procedure {
        "quasi_static" => step.procedure = Procedure::QuasiStatic,
        "auto" => step.procedure = Procedure::Auto,
        _ => {}
    }
}

fn run_as(model: &mut Model, time: f64, increments: usize, procedure: &str) -> Recording {
    let mut step = scene::set_free(Gravity::Constant(DOWN), time, increments, 5e-3, -0.05);
    by(&mut step, procedure);
    step.increments.min *= 1e-2;
    model.steps = vec![step];
    let begin = std::time::Instant::now();
    let recording = scene::completed(model);
    println!("  {:.2} s", begin.elapsed().as_secs_f64());
    rows(&recording);
    recording
}

#[test]
fn dominoes_fall_one_on_the_other() {
    for procedure in ["quasi_static", "dynamic", "auto"] {
        let mut model = scene::empty();
        floor(&mut model, 2000.0);
        let solid = scene::heavy(E, 0.2, DENSITY);
        let mut stones = Vec::new();
        for i in 0..6 {
            let x = 60.0 * f64::from(i);
            stones.push(scene::block(&mut model, [x, 0.0, 0.0], [20.0, 50.0, 100.0], [1, 1, 1], &solid));
        }
        scene::turn(&mut model, &stones[0], [20.0, 0.0, 0.0], [0.0, 1.0, 0.0], 15.0_f64.to_radians());
        scene::general(&mut model, 0.4);
        println!("{procedure}");
        let recording = run_as(&mut model, 1.2, 600, procedure);
        tell(&model, &recording);
        let x = positions(&model, &recording, recording.frames.len() - 1);
        for s in &stones {
            let top = s.nodes().iter().map(|&n| x[n as usize][2]).fold(f64::MIN, f64::max);
            print!(" {top:.2}");
        }
        println!();
    }
}

#[test]
fn a_stack_topples_and_comes_to_rest() {
    for procedure in ["quasi_static", "dynamic", "auto"] {
        let mut model = scene::empty();
        floor(&mut model, 2000.0);
        let solid = scene::heavy(E, 0.2, DENSITY);
        let mut stones = Vec::new();
        for i in 0..5 {
            let z = 60.0 * f64::from(i);
            stones.push(scene::block(&mut model, [0.0, 0.0, z], [80.0, 80.0, 60.0], [1, 1, 1], &solid));
        }
        for (i, s) in stones.iter().enumerate() {
            scene::throw(&mut model, s, [250.0 * i as f64, 20.0 * i as f64, 0.0]);
        }
        scene::general(&mut model, 0.6);
        println!("{procedure}");
        let recording = run_as(&mut model, 1.5, 600, procedure);
        tell(&model, &recording);
        let x = positions(&model, &recording, recording.frames.len() - 1);
        for s in &stones {
            let top = s.nodes().iter().map(|&n| x[n as usize][2]).fold(f64::MIN, f64::max);
            print!(" {top:.2}");
        }
        println!();
    }
}

#[test]
fn a_heap_of_blocks_is_thrown_together() {
    for procedure in ["quasi_static", "auto", "dynamic"] {
        let mut model = scene::empty();
        floor(&mut model, 3000.0);
        let solid = scene::heavy(E, 0.2, DENSITY);
        let mut random = common::Random(7);
        let mut stones = Vec::new();
        for i in 0..20 {
            let size = [0, 1, 2].map(|_| 60.0 + 60.0 * random.uniform());
            let at = [80.0 * random.signed(), 80.0 * random.signed(), 120.0 + 170.0 * f64::from(i)];
            let s = scene::block(&mut model, at, size, [1, 1, 1], &solid);
            let axis = [random.signed(), random.signed(), random.signed()];
            let centre = [0, 1, 2].map(|d| at[d] + 0.5 * size[d]);
            scene::turn(&mut model, &s, centre, axis, 3.0 * random.uniform());
            scene::throw(&mut model, &s, [200.0 * random.signed(), 200.0 * random.signed(), -1000.0]);
            stones.push(s);
        }
        scene::general(&mut model, 0.6);
        println!("{procedure}");
        let recording = run_as(&mut model, 1.5, 750, procedure);
        tell(&model, &recording);
        let x = positions(&model, &recording, recording.frames.len() - 1);
        for s in &stones {
            let top = s.nodes().iter().map(|&n| x[n as usize][2]).fold(f64::MIN, f64::max);
            let low = s.nodes().iter().map(|&n| x[n as usize][2]).fold(f64::MAX, f64::min);
            print!(" {low:.1}-{top:.1}");
        }
        println!();
    }
}
