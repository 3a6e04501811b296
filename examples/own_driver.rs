//! Builds a wall of dry blocks without a deck, pushes it increment by increment and reads its forces.
//! `cargo run --release --example own_driver` runs it.
//!
//! Five courses in running bond stand on the ground under a pressed beam, which is pushed sideways. Coulomb's limit
//! for sliding along a bed joint is F = μ N. The program stops when the beam has moved by 0.2 mm.
use std::sync::Arc;
use wythe::contact::InterfaceLaw;
use wythe::element::hexahedron::Face;
use wythe::material::{ElasticParameters, MaterialParameters};
use wythe::model::Model;
use wythe::model::builder::{Block, BuildError, ModelBuilder};
use wythe::model::scene::{BeamMotion, Driven, Increments, Step};
use wythe::solve::Stepper;

/// Edges of a block [mm], and the number of blocks along the wall and upwards.
const BLOCK: [f64; 3] = [200.0, 100.0, 100.0];
const BLOCKS: [usize; 2] = [3, 5];
/// Friction μ [-] and force N on the beam [N].
const MU: f64 = 0.4;
const PRESS: f64 = 20e3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut stepper = Stepper::new(Arc::new(wall()?));
    println!("pushed [mm]  beam [kN]  ground [kN]  μ N [kN]");
    for increment in stepper.by_ref() {
        let pushed = increment.row.displacement_mm;
        let frame = increment.frame.ok_or("a frame of each increment")?;
        // Forces on the beam, then on the ground [N].
        let [beam, ground] = [0, 1].map(|i| 1e-3 * frame.reactions[i][0]);
        println!(
            "{pushed:11.4}  {beam:9.3}  {ground:11.3}  {:.3}",
            1e-3 * MU * PRESS
        );
        if pushed >= 0.2 {
            break;
        }
    }
    let end = stepper.finish()?.ok_or("a run of at least one increment")?;
    println!("{} increments, {} solves", end.increments, end.iterations);
    Ok(())
}

/// The wall with its beam, a step that presses it and a step that pushes it.
#[allow(non_snake_case, reason = "E is Young's modulus")]
fn wall() -> Result<Model, BuildError> {
    let mut wall = ModelBuilder::new("a wall of dry blocks");
    // The density [tonne/mm³] gives inertia to what slides.
    let [E, nu, density] = [5000.0, 0.2, 2e-9];
    let stone = MaterialParameters::Elastic(ElasticParameters { E, nu, density });
    let stone = wall.material("stone", stone);
    let [long, high] = BLOCKS;
    let mut courses: Vec<Vec<Block>> = Vec::new();
    for course in 0..high {
        let start = 0.5 * BLOCK[0] * (course % 2) as f64;
        let block = |i: usize| {
            let low = [start + i as f64 * BLOCK[0], 0.0, course as f64 * BLOCK[2]];
            wall.block(&format!("{course}.{i}"), low, BLOCK, [4, 1, 2], stone)
        };
        courses.push((0..long).map(block).collect());
    }
    // 500 times the stiffness of the elements beside the joint, as in the paper.
    let [k_n, k_s] = wall.stiffness(500.0, 2, [&courses[0][0], &courses[1][0]]);
    let dry = wall.law("dry", InterfaceLaw::dry(MU, k_n, k_s));
    for (course, blocks) in courses.iter().enumerate() {
        for (i, block) in blocks.iter().enumerate() {
            if course > 0 {
                wall.slave(block, Face::Bottom, dry);
            }
            if course + 1 < high {
                wall.master(block, Face::Top);
            }
            if i > 0 {
                wall.slave(block, Face::Left, dry);
                wall.master(&blocks[i - 1], Face::Right);
            }
        }
    }
    let foot = courses[0].iter().flat_map(|b| b.face(Face::Bottom));
    wall.support("ground", foot.collect(), [true; 3]);
    let top: Vec<_> = courses[high - 1].iter().map(|b| (b, Face::Top)).collect();
    wall.beam("beam", &top);
    let still = BeamMotion::Locked;
    let press = [still, still, BeamMotion::Force(-PRESS)];
    let push = [BeamMotion::Driven(1.0), still, press[2]];
    for (name, motion, size) in [("press", press, 0.5), ("push", push, 0.02)] {
        wall.step(Step {
            name: name.to_owned(),
            motion: vec![motion],
            driven: Some(Driven::along(0, 0)),
            increments: Increments {
                initial: size,
                max: size,
                ..Increments::default()
            },
            ..Step::default()
        });
    }
    wall.build()
}
