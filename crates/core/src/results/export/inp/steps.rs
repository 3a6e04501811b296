//! Supports, beams and steps. A beam is a rigid body without rotation, moved by a reference node.

use std::fmt::Write as _;

use super::Names;
use crate::model::Model;
use crate::model::scene::{Beam, BeamMotion, Gravity, Procedure, Step};

/// Writes beams as rigid bodies, supports, initial velocities and the steps.
pub(super) fn steps(text: &mut String, model: &Model, names: &Names) -> std::fmt::Result {
    rigid_bodies(text, model, names)?;
    for tie in &model.ties {
        let name = tie.name.replace('\n', " ");
        writeln!(text, "** Not translated: the tie {name}")?;
    }
    for floor in &model.floors {
        let name = floor.name.replace('\n', " ");
        writeln!(
            text,
            "** Not translated: the floor {name}, {:?} tonne",
            floor.mass()
        )?;
    }
    for spring in &model.springs {
        writeln!(
            text,
            "** Not translated: the spring {}, {:?} N/mm on the mean displacement of {} nodes",
            spring.name.replace('\n', " "),
            spring.stiffness,
            spring.nodes.len()
        )?;
    }
    if model.initial_velocity.iter().any(|v| *v != [0.0; 3]) {
        writeln!(text, "*INITIAL CONDITIONS, TYPE=VELOCITY")?;
        for (n, velocity) in model.initial_velocity.iter().enumerate() {
            for (d, v) in velocity.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                writeln!(text, "{}, {}, {v:?}", n + 1, d + 1)?;
            }
        }
    }
    if !names.supports.is_empty() || !names.beams.is_empty() {
        writeln!(text, "*BOUNDARY")?;
        held(text, model, names)?;
    }
    // Displacement of each beam, as long as it is known. `[beam][xyz]`
    let mut at = vec![[Some(0.0); 3]; names.beams.len()];
    for step in &model.steps {
        let name = step.name.replace(['\n', '"', ','], " ");
        writeln!(text, "*STEP, NAME=\"{name}\", NLGEOM=YES, INC=100000")?;
        procedure(text, step)?;
        writeln!(text, "*BOUNDARY, OP=NEW")?;
        held(text, model, names)?;
        let beams = model.beams.iter().zip(&mut at).enumerate();
        for (b, (beam, at)) in beams.filter(|(_, (beam, _))| beam.settles()) {
            settle(text, beam, step.motion.get(b), at)?;
        }
        motion(text, step, (&model.beams, &names.beams), &mut at)?;
        loads(text, model, step)?;
        writeln!(text, "*END STEP")?;
    }
    Ok(())
}

/// Writes the beams as rigid bodies with a reference node each; ground that settles has none.
fn rigid_bodies(text: &mut String, model: &Model, names: &Names) -> std::fmt::Result {
    let first = model.mesh.nodes.len() + 1;
    let beams = model.beams.iter().zip(&names.beams).enumerate();
    for (b, (beam, name)) in beams.filter(|(_, (beam, _))| !beam.settles()) {
        let count = beam.nodes.len().max(1) as f64;
        let middle = [0, 1, 2].map(|d| {
            let x = beam.nodes.iter().map(|n| model.mesh.nodes[*n as usize][d]);
            x.sum::<f64>() / count
        });
        let [x, y, z] = middle;
        writeln!(text, "** What moves the beam {name}")?;
        writeln!(
            text,
            "*NODE, NSET=REFERENCE_{name}\n{}, {x:?}, {y:?}, {z:?}",
            first + b
        )?;
        writeln!(
            text,
            "*RIGID BODY, REF NODE={}, TIE NSET=BEAM_{name}",
            first + b
        )?;
    }
    Ok(())
}

/// Boundary conditions of all steps: the supports and the fixed rotation of beams.
fn held(text: &mut String, model: &Model, names: &Names) -> std::fmt::Result {
    for (support, name) in model.supports.iter().zip(&names.supports) {
        for (i, _) in support.fixed.iter().enumerate().filter(|(_, held)| **held) {
            writeln!(text, "SUPPORT_{name}, {0}, {0}", i + 1)?;
        }
    }
    let beams = model.beams.iter().zip(&names.beams);
    for (_, name) in beams.filter(|(beam, _)| !beam.settles()) {
        writeln!(text, "REFERENCE_{name}, 4, 6")?;
    }
    Ok(())
}

/// Writes the places of nodes on ground that settles at the end of a step, and keeps those of the ground.
fn settle(
    text: &mut String,
    beam: &Beam,
    motions: Option<&[BeamMotion; 3]>,
    at: &mut [Option<f64>; 3],
) -> std::fmt::Result {
    for (d, at) in at.iter_mut().enumerate() {
        let by = match motions.map(|motions| motions[d]) {
            Some(BeamMotion::Driven(by)) => by,
            _ => 0.0,
        };
        let to = at.unwrap_or(0.0) + by;
        *at = Some(to);
        for (n, part) in beam.nodes.iter().zip(&beam.shape) {
            writeln!(text, "{}, {1}, {1}, {2:?}", n + 1, d + 1, part * to)?;
        }
    }
    Ok(())
}

/// Writes the motion of the beams in a step, and moves them to their places at its end as far as these are known.
fn motion(
    text: &mut String,
    step: &Step,
    (beams, names): (&[Beam], &[String]),
    at: &mut [[Option<f64>; 3]],
) -> std::fmt::Result {
    let mut locked = String::new();
    let mut velocities = String::new();
    let mut forces = String::new();
    let beams = beams.iter().zip(names).enumerate();
    for (b, (_, name)) in beams.filter(|(_, (beam, _))| !beam.settles()) {
        let motions = step.motion.get(b).copied();
        let motions = motions.unwrap_or([BeamMotion::Locked; 3]);
        for (d, motion) in motions.into_iter().enumerate() {
            let direction = d + 1;
            let moved = format!("REFERENCE_{name}, {direction}, {direction}");
            match (motion, at[b][d]) {
                (BeamMotion::Locked, Some(known)) => writeln!(text, "{moved}, {known:?}")?,
                (BeamMotion::Locked, None) => writeln!(locked, "{moved}")?,
                (BeamMotion::Driven(by), Some(known)) => {
                    let to = known + by;
                    at[b][d] = Some(to);
                    writeln!(text, "{moved}, {to:?}")?;
                }
                (BeamMotion::Driven(by), None) => {
                    let speed = by / step.duration;
                    writeln!(velocities, "{moved}, {speed:?}")?;
                }
                (BeamMotion::Force(force), _) => {
                    at[b][d] = None;
                    writeln!(forces, "REFERENCE_{name}, {direction}, {force:?}")?;
                }
            }
        }
    }
    if !locked.is_empty() {
        writeln!(
            text,
            "** Held where the step before left them\n*BOUNDARY, OP=NEW, FIXED"
        )?;
        *text += &locked;
    }
    if !velocities.is_empty() {
        writeln!(text, "*BOUNDARY, OP=NEW, TYPE=VELOCITY")?;
        *text += &velocities;
    }
    if !forces.is_empty() {
        writeln!(text, "*CLOAD, OP=NEW")?;
        *text += &forces;
    }
    Ok(())
}

/// Writes the procedure and its increments. Path-following procedures have no exact counterpart in Abaqus.
fn procedure(text: &mut String, step: &Step) -> std::fmt::Result {
    let keyword = match step.procedure {
        Procedure::Dynamic { alpha, .. } => {
            writeln!(
                text,
                "** Rayleigh damping, if any, belongs to the materials"
            )?;
            format!("*DYNAMIC, ALPHA={alpha:?}")
        }
        Procedure::QuasiStatic => "*DYNAMIC, APPLICATION=QUASI-STATIC".to_owned(),
        Procedure::ArcLength | Procedure::Dissipation | Procedure::DisplacementControl => {
            writeln!(
                text,
                "** Of wythe's procedures the nearest is *STATIC, RIKS"
            )?;
            "*STATIC".to_owned()
        }
        Procedure::Auto | Procedure::Static | Procedure::Implex => "*STATIC".to_owned(),
    };
    let (of, total) = (&step.increments, step.duration);
    let [initial, least, most] = [of.initial, of.min, of.max].map(|part| part * total);
    writeln!(
        text,
        "{keyword}\n{initial:?}, {total:?}, {least:?}, {most:?}"
    )
}

fn loads(text: &mut String, model: &Model, step: &Step) -> std::fmt::Result {
    if let Gravity::Turning { angle, .. } = step.gravity {
        let degrees = angle.to_degrees();
        writeln!(
            text,
            "** Gravity turns evenly by {degrees:?} deg in this step; its components at the end are"
        )?;
    }
    let gravity = step.gravity.at(1.0);
    let size = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    if size > 0.0 {
        let [x, y, z] = gravity.map(|g| g / size);
        writeln!(
            text,
            "*DLOAD, OP=NEW\nALL_ELEMENTS, GRAV, {size:?}, {x:?}, {y:?}, {z:?}"
        )?;
    }
    if step.ground.acceleration.iter().any(|rows| !rows.is_empty()) {
        writeln!(text, "** Not translated: the acceleration of the ground")?;
    }
    for (spring, by) in model.springs.iter().zip(&step.springs) {
        if *by != [0.0; 3] {
            let name = spring.name.replace('\n', " ");
            writeln!(
                text,
                "** Not translated: the far end of {name} moves by {by:?} mm"
            )?;
        }
    }
    Ok(())
}
