//! Files of a limit analysis, read back.

use super::{along, near, read};
use wythe::results::limit::{CORNERS, JOINTS, MECHANISM, TABLE};
use wythe::results::vtkhdf::field::Values;
use wythe::results::{FieldsFile, FoundLimit};

fn field(file: &FieldsFile, name: &str) -> Vec<f64> {
    match file.field(name, 0).unwrap() {
        Values::Real { values, .. } => values,
        Values::Code(codes) => panic!("{codes:?}"),
    }
}

#[test]
fn files_have_the_mechanism_and_the_forces() {
    let folder = tempfile::tempdir().unwrap();
    let arch = read("docs/validation/05-arches/tilted-27-12.toml");
    let limit = FoundLimit::of(arch, &along(0)).unwrap();
    let paths = limit.write(folder.path()).unwrap();
    assert_eq!(paths.len(), 5);
    let open = |name: &str| FieldsFile::open(&folder.path().join(name)).unwrap();
    let moved = open(MECHANISM);
    let mesh = &limit.model.mesh;
    assert_eq!(moved.mesh().unwrap().nodes, mesh.nodes);
    let velocity = field(&moved, "velocity");
    assert_eq!(velocity, limit.velocities().as_flattened());
    // Each node moves as its unit does: v + ω × r.
    for unit in &limit.found.mechanism {
        let own = mesh.unit.iter().position(|u| *u == unit.unit).unwrap();
        let n = mesh.elements[own][3] as usize;
        let r = [0, 1, 2].map(|i| mesh.nodes[n][i] - unit.centre_mm[i]);
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let turned = unit.spin[j] * r[k] - unit.spin[k] * r[j];
            // Rounding of numbers up to 1.
            assert!((velocity[3 * n + i] - unit.velocity[i] - turned).abs() < 1e-12);
        }
    }
    let fastest = velocity
        .chunks_exact(3)
        .map(|v| v[0].hypot(v[1]).hypot(v[2]));
    near(fastest.fold(0.0, f64::max), 1.0, 1e-12);
    let joints = open(JOINTS);
    let resultants = limit.found.joints.iter().flat_map(|joint| joint.force);
    assert_eq!(field(&joints, "force"), resultants.collect::<Vec<f64>>());
    let normal = limit.found.joints.iter().map(|joint| joint.normal);
    assert_eq!(field(&joints, "normal_force"), normal.collect::<Vec<f64>>());
    assert!(
        field(&joints, "sliding")
            .iter()
            .all(|part| *part <= 1.0 + 1e-2)
    );
    // The forces at the corners are those of the joints.
    let corners = field(&open(CORNERS), "force");
    let mut corners = corners.chunks_exact(3);
    for joint in &limit.found.joints {
        let mut sum = [0.0; 3];
        for force in corners.by_ref().take(joint.corners_mm.len()) {
            (0..3).for_each(|i| sum[i] += force[i]);
        }
        // Rounding of four forces.
        let same = (0..3).all(|i| (sum[i] - joint.force[i]).abs() <= 1e-12 * joint.normal.abs());
        assert!(same, "{sum:?} {joint:?}");
    }
    assert_eq!(corners.len(), 0);
    let table = std::fs::read_to_string(folder.path().join(TABLE)).unwrap();
    let table: serde_json::Value = serde_json::from_str(&table).unwrap();
    assert_eq!(table["factor"].as_f64(), Some(limit.found.factor));
}
