//! Writing, reading, killed runs and full disks.

use hdf5_metno::types::{FixedAscii, VarLenUnicode};

use super::read::FieldsFile;
use super::*;
use crate::model::probes::Probe;
use crate::model::probes::ProbeQuantity;
use crate::model::scene::{Beam, HeldBy, Support};
use crate::results::fake;

#[test]
fn every_step_reads_back_from_its_own_offset() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = fake::model();
    let (nodes, elements) = (model.mesh.nodes.len(), model.mesh.elements.len());
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    let frames: Vec<_> = [0.5, 1.0, 1.5].map(|t| fake::frame(&model, t)).into();
    for frame in &frames {
        writer.append(frame).unwrap();
    }
    assert_eq!(writer.steps(), 3);
    drop(writer);

    let file = hdf5::File::open(&path).unwrap();
    let root = file.group("VTKHDF").unwrap();
    let steps = root.group("Steps").unwrap();
    assert_eq!(
        steps.attr("NSteps").unwrap().read_scalar::<i64>().unwrap(),
        3
    );
    assert_eq!(
        steps.dataset("Values").unwrap().read_raw::<f64>().unwrap(),
        [0.5, 1.0, 1.5]
    );
    let offsets = steps.dataset("PointDataOffsets/displacement").unwrap();
    let offsets = offsets.read_raw::<i64>().unwrap();
    assert_eq!(offsets, [0, nodes as i64, 2 * nodes as i64]);
    let stored = root
        .dataset("PointData/displacement")
        .unwrap()
        .read_raw::<f64>()
        .unwrap();
    let stress = root
        .dataset("CellData/stress")
        .unwrap()
        .read_raw::<f64>()
        .unwrap();
    for (i, frame) in frames.iter().enumerate() {
        assert_eq!(
            &stored[3 * nodes * i..][..3 * nodes],
            frame.displacement.as_flattened()
        );
        assert_eq!(
            &stress[6 * elements * i..][..6 * elements],
            frame.stress.as_flattened()
        );
    }
    let unit = root
        .dataset("CellData/unit")
        .unwrap()
        .read_raw::<i64>()
        .unwrap();
    assert_eq!(unit.len(), elements);
}

#[test]
fn a_frame_of_another_mesh_is_rejected_and_leaves_the_steps_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = fake::model();
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    writer.append(&fake::frame(&model, 1.0)).unwrap();
    let mut wrong = fake::frame(&model, 2.0);
    wrong.stress.pop();
    let error = writer.append(&wrong).unwrap_err().to_string();
    assert!(error.contains("stress"), "{error}");
    // The next complete frame replaces it.
    writer.append(&fake::frame(&model, 3.0)).unwrap();
    drop(writer);
    let file = hdf5::File::open(&path).unwrap();
    let values = file
        .dataset("VTKHDF/Steps/Values")
        .unwrap()
        .read_raw::<f64>()
        .unwrap();
    assert_eq!(values, [1.0, 3.0]);
}

/// A model with interfaces, probes, a beam and a support.
fn whole_model() -> Model {
    let mut model = fake::model();
    model.contact.slave_facets = vec![[1, 2, 6, 5], [8, 11, 15, 12]];
    model.contact.slave_law = vec![0, 1];
    model.probes = vec![Probe {
        column: "gap_mm".to_owned(),
        nodes: vec![0],
        minus: Vec::new(),
        direction: [1.0, 0.0, 0.0],
        quantity: ProbeQuantity::Displacement,
        over: 1.0,
    }];
    model.beams = vec![Beam {
        name: "top".to_owned(),
        nodes: vec![4],
        area: 1.0,
        normal: [0.0, 0.0, 1.0],
        shape: Vec::new(),
        free: Vec::new(),
        depth: 0.0,
    }];
    model.supports = vec![Support {
        name: "bottom".to_owned(),
        nodes: vec![0],
        fixed: [true; 3],
        by: HeldBy::Ground,
    }];
    model
}

/// Increment n at time n/2, with a frame at every second increment.
fn record(writer: &mut VtkHdfWriter, model: &Model, increments: std::ops::RangeInclusive<usize>) {
    for n in increments {
        let time = 0.5 * n as f64;
        let row = HistoryRow {
            increment: n,
            time,
            force_kN: 1.0 / n as f64,
            // The probe, then base shear and reactions of the support.
            probes: vec![0.1 * time, time, -time, 0.0, n as f64],
            reactions: vec![[time, 0.0, 1.0], [-time, 0.0, n as f64]],
            ..HistoryRow::default()
        };
        writer.row(&row);
        if n.is_multiple_of(2) {
            let frame = Frame {
                increment: n,
                probes: row.probes.clone(),
                ..fake::frame(model, time)
            };
            writer.append(&frame).unwrap();
        }
    }
}

/// Readable content of a file: increments and displacements of its frames, forces and reactions of its rows.
fn seen(path: &Path) -> (Vec<usize>, Vec<Frame>, Vec<f64>, Vec<f64>) {
    let read = FieldsFile::open(path).unwrap();
    let frames = (0..read.times().len()).map(|f| read.frame(f).unwrap());
    let file = hdf5::File::open(path).unwrap();
    let series = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    (
        read.increments().to_vec(),
        frames.collect(),
        series("history/force_kN"),
        series("history/supports/bottom"),
    )
}

#[test]
fn the_history_and_the_deck_lie_beside_the_fields() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = whole_model();
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    writer.keep_deck("format = 2").unwrap();
    writer.keep_deck("format = 1").unwrap();
    record(&mut writer, &model, 1..=5);
    writer.finish().unwrap();
    let file = hdf5::File::open(&path).unwrap();
    let real = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    // The row without a frame is present as well.
    assert_eq!(real("history/time"), [0.5, 1.0, 1.5, 2.0, 2.5]);
    assert_eq!(
        real("history/gap_mm"),
        [0.5, 1.0, 1.5, 2.0, 2.5].map(|t| 0.1 * t)
    );
    assert_eq!(
        real("history/beams/top")[..6],
        [0.5, 0.0, 1.0, 1.0, 0.0, 1.0]
    );
    assert_eq!(real("history/supports/bottom")[12..], [-2.5, 0.0, 5.0]);
    let increments = file.dataset("history/increment").unwrap();
    assert_eq!(increments.read_raw::<i64>().unwrap(), [1, 2, 3, 4, 5]);
    let procedure = file.dataset("history/procedure").unwrap();
    let procedure = procedure.read_raw::<FixedAscii<32>>().unwrap();
    assert_eq!(procedure[0].as_str(), "static");
    for (name, unit) in [
        ("history/force_kN", "kN"),
        ("history/beams/top", "N"),
        ("VTKHDF/CellData/stress", "MPa"),
    ] {
        let of = file.dataset(name).unwrap().attr("unit").unwrap();
        assert_eq!(of.read_scalar::<VarLenUnicode>().unwrap().as_str(), unit);
    }
    drop(file);
    let read = FieldsFile::open(&path).unwrap();
    assert_eq!(read.increments(), [2, 4]);
    assert_eq!(read.frame(1).unwrap().increment, 4);
    // From `printf 'format = 1' | sha256sum`.
    let hash = "sha256:019d488782a0f9b4fe4cf4402ed764a4aeb64adb3da27ef2d88955db704249c1";
    assert_eq!(
        read.deck().unwrap(),
        Some(("format = 1".to_owned(), hash.to_owned()))
    );
}

#[test]
fn a_reopened_file_continues_like_an_uninterrupted_one() {
    let folder = tempfile::tempdir().unwrap();
    let (straight, path) = (
        folder.path().join("a.vtkhdf"),
        folder.path().join("b.vtkhdf"),
    );
    let model = whole_model();
    let mut writer = VtkHdfWriter::create(&straight, &model).unwrap();
    record(&mut writer, &model, 1..=8);
    writer.finish().unwrap();
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    record(&mut writer, &model, 1..=7);
    drop(writer);
    // The checkpoint was taken after increment 5: frame 6 and rows 6 and 7 are written again.
    let mut writer = VtkHdfWriter::reopen(&path, &model, (5, usize::MAX)).unwrap();
    assert_eq!(writer.steps(), 2);
    assert_eq!(
        seen(&path).0,
        [2, 4, 6],
        "readers keep the old file until there is more"
    );
    record(&mut writer, &model, 6..=8);
    writer.finish().unwrap();
    let (a, b) = (seen(&straight), seen(&path));
    assert_eq!((&a.0, &a.2, &a.3), (&b.0, &b.2, &b.3));
    for (a, b) in a.1.iter().zip(&b.1) {
        assert_eq!((a.time, &a.displacement), (b.time, &b.displacement));
        assert_eq!((&a.stress, &a.interfaces), (&b.stress, &b.interfaces));
    }
    // A new run in the same file keeps nothing of the old one.
    drop(VtkHdfWriter::reopen(&path, &model, (0, usize::MAX)).unwrap());
    assert_eq!(seen(&path).0, [0; 0]);
}

#[test]
fn files_of_other_models_are_not_reopened_and_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = whole_model();
    let missing = VtkHdfWriter::reopen(&path, &model, (1, usize::MAX)).unwrap_err();
    assert_eq!(missing.kind(), io::ErrorKind::NotFound);
    drop(VtkHdfWriter::create(&path, &model).unwrap());
    let mut other = whole_model();
    other.mesh.elements.pop();
    let before = std::fs::read(&path).unwrap();
    let error = VtkHdfWriter::reopen(&path, &other, (1, usize::MAX)).unwrap_err();
    assert!(error.to_string().contains("another model"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), before);
    std::fs::write(&path, &before[..before.len() / 2]).unwrap();
    assert!(VtkHdfWriter::reopen(&path, &model, (1, usize::MAX)).is_err());
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 2, "the file and its sidecar: {left:?}");
}

#[test]
fn readers_see_whole_files_while_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = whole_model();
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    // As by the checkpoint of the first increment.
    writer.publish().unwrap();
    assert!(seen(&path).0.is_empty());
    record(&mut writer, &model, 1..=2);
    assert_eq!(seen(&path).0, [2], "the first frame at once");
    let first = FieldsFile::open(&path).unwrap();
    record(&mut writer, &model, 3..=4);
    writer.publish().unwrap();
    assert_eq!(seen(&path).0, [2, 4]);
    // A reader that has the file open keeps its content.
    assert_eq!(first.times(), [1.0]);
    assert_eq!(first.frame(0).unwrap().time, 1.0);
    record(&mut writer, &model, 5..=6);
    drop(writer);
    assert_eq!(seen(&path).0, [2, 4, 6], "the last without being asked");
}

#[test]
fn the_sidecar_shows_the_interfaces_and_goes_with_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = whole_model();
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    record(&mut writer, &model, 1..=2);
    drop(writer);
    let file = hdf5::File::open(sidecar_of(&path)).unwrap();
    let damage = file.dataset("VTKHDF/CellData/damage").unwrap();
    assert_eq!(damage.shape(), [8]);
    drop((file, damage));
    drop(VtkHdfWriter::create(&path, &fake::model()).unwrap());
    assert!(!sidecar_of(&path).exists());
}

#[test]
#[cfg(target_os = "linux")]
fn errors_of_the_operating_system_are_returned() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing/results.vtkhdf");
    let error = VtkHdfWriter::create(&path, &fake::model()).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::NotFound, "{error}");
    let path = folder.path().join("results.vtkhdf");
    let work = folder.path().join("results.vtkhdf.part");
    std::fs::create_dir(&work).unwrap();
    let error = VtkHdfWriter::create(&path, &fake::model()).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::IsADirectory, "{error}");
    std::fs::remove_dir(&work).unwrap();
    // A file is never written through a link.
    let mine = folder.path().join("mine");
    std::fs::write(&mine, "mine").unwrap();
    for name in [
        "results.vtkhdf",
        "results.vtkhdf.part",
        "results.vtkhdf.tmp",
    ] {
        std::os::unix::fs::symlink(&mine, folder.path().join(name)).unwrap();
    }
    drop(VtkHdfWriter::create(&path, &fake::model()).unwrap());
    assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
    assert!(path.symlink_metadata().unwrap().is_file());
    // Without a frame it has no history yet, but it is a valid file.
    let read = FieldsFile::open(&path).unwrap();
    assert!(read.times().is_empty() && read.increments().is_empty());
}

#[test]
#[cfg(target_os = "linux")]
fn a_copy_that_cannot_be_written_is_an_error_and_loses_no_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = whole_model();
    let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
    record(&mut writer, &model, 1..=4);
    let copy = folder.path().join("results.vtkhdf.tmp");
    std::fs::create_dir(copy).unwrap();
    let error = writer.publish().unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::IsADirectory, "{error}");
    assert_eq!(seen(&path).0[0], 2, "what was seen before");
    drop(writer);
    assert_eq!(seen(&path).0, [2, 4], "the work file is whole");
}

/// Sizes in a file are not trustworthy.
#[test]
fn impossible_dataset_sizes_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.vtkhdf");
    let model = whole_model();
    let begin = || {
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        record(&mut writer, &model, 1..=2);
        writer.finish().unwrap();
    };
    let huge = 1_000_000_000_000_usize;
    // Datasets that claim 10¹² rows, in chunks of one row and of 10⁷ rows.
    for (name, wide) in [
        ("VTKHDF/Points", 3),
        ("VTKHDF/Connectivity", 1),
        ("VTKHDF/CellData/unit", 1),
        ("VTKHDF/CellData/stress", 6),
        ("VTKHDF/PointData/displacement", 3),
        ("VTKHDF/CellData/tensile_damage", 1),
        ("VTKHDF/Steps/Values", 1),
        ("history/frame_increment", 1),
        ("interfaces/Points", 3),
        ("interfaces/CellData/opening", 1),
        ("interfaces/CellData/traction", 3),
    ] {
        for rows in [1, 10_000_000] {
            begin();
            let file = hdf5::File::open_rw(&path).unwrap();
            file.unlink(name).unwrap();
            let builder = file.new_dataset::<f64>();
            if wide == 1 {
                builder.chunk(rows).shape(huge).create(name).unwrap();
            } else {
                let builder = builder.chunk((rows, wide)).shape((huge, wide));
                builder.create(name).unwrap();
            }
            file.close().unwrap();
            let all = || -> io::Result<()> {
                let file = FieldsFile::open(&path)?;
                file.mesh()?;
                file.surface()?;
                file.frame(0)?;
                for name in file.field_names()? {
                    file.field(&name, 0)?;
                }
                Ok(())
            };
            assert!(all().is_err() || rows == 1, "{name} in chunks of {rows}");
        }
    }
}
