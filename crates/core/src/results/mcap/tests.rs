//! Round trips with the MCAP library, and files truncated and damaged at many positions.

use super::*;
use crate::experiment::Experiment;
use crate::model::scene::MeasuredCurve;
use crate::results::fake;
use salvage::{SalvageError, Salvaged, salvage};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// Number of increments of the small run.
const INCREMENTS: usize = 4;

fn model() -> Model {
    let mut model = fake::model();
    model.contact.slave_facets = vec![[1, 2, 6, 5]];
    model.output.experiment = Some(MeasuredCurve {
        file: "wall.csv".to_owned(),
        text: "displacement_mm,force_kN\n1,2\n2,3\n".to_owned(),
        curve: Experiment {
            name: "wall".to_owned(),
            points: vec![(1.0, 2.0), (2.0, 3.0)],
        },
    });
    model
}

/// A run of [`INCREMENTS`] increments with a frame at every second one, and the length of the file after each.
fn record(path: &Path, model: &Model) -> (McapWriter, Vec<u64>) {
    let mut run = McapWriter::create(path, model).unwrap();
    run.attach("model.toml", "application/toml", "format = 1\n")
        .unwrap();
    let mut ends = vec![std::fs::metadata(path).unwrap().len()];
    for i in 1..=INCREMENTS {
        run.progress(1, i as f64, 1);
        run.progress(1, i as f64, 2);
        run.note("a joint has gone; continues with direct");
        let frame = fake::frame(model, 0.2 * i as f64);
        let frame = (i % 2 == 0).then_some(&frame);
        run.increment(model, &fake::row(i, 1, i as f64, 0.1 * i as f64), frame)
            .unwrap();
        ends.push(std::fs::metadata(path).unwrap().len());
    }
    (run, ends)
}

fn whole(path: &Path) -> Vec<u64> {
    let model = model();
    let (run, ends) = record(path, &model);
    let mut summary = fake::summary(Status::Completed);
    summary.warnings.push("beware".to_owned());
    run.finish(&model, None, &summary, &["mind".to_owned()])
        .unwrap();
    ends
}

/// Log times and messages by topic.
fn messages(path: &Path) -> BTreeMap<String, Vec<(u64, Value)>> {
    let bytes = std::fs::read(path).unwrap();
    assert!(::mcap::Summary::read(&bytes).unwrap().is_some());
    let mut messages = BTreeMap::<String, Vec<_>>::new();
    for message in ::mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let value = serde_json::from_slice(&message.data).unwrap();
        let topic = messages.entry(message.channel.topic.clone()).or_default();
        topic.push((message.log_time, value));
    }
    messages
}

#[test]
fn a_run_reads_back_with_uniform_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    whole(&path);
    let topics = messages(&path);
    let steps = &topics["/step"];
    for (i, (time, row)) in steps.iter().enumerate() {
        assert_eq!(*time, (i as u64 + 1) * TICK);
        assert_eq!(row["increment"], i + 1);
        assert_eq!(row["force_kN"], 0.1 * (i + 1) as f64);
        assert_eq!(row["procedure"], "static");
    }
    assert_eq!(steps.len(), INCREMENTS);
    let (times, solves): (Vec<u64>, Vec<_>) = topics["/iteration"].iter().cloned().unzip();
    assert_eq!(times.len(), 2 * INCREMENTS);
    assert!(times.is_sorted() && times.iter().all(|t| t % TICK != 0));
    assert_eq!(
        (&solves[2]["increment"], &solves[3]["iterations"]),
        (&2.into(), &2.into())
    );
    assert_eq!(topics["/procedures"].len(), INCREMENTS);
    // The wall at rest, then a frame at every second increment.
    for topic in ["/scene", "/interfaces"] {
        let times: Vec<u64> = topics[topic].iter().map(|(t, _)| *t).collect();
        assert_eq!(times, [0, 2 * TICK, 4 * TICK]);
    }
    let log: Vec<_> = topics["/log"].iter().map(|(_, l)| &l["message"]).collect();
    assert_eq!(log.len(), INCREMENTS + 4);
    assert_eq!(log[INCREMENTS + 1..], ["mind", "beware", "completed"]);
    let bytes = std::fs::read(&path).unwrap();
    let summary = ::mcap::Summary::read(&bytes).unwrap().unwrap();
    let attached = ::mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!(attached.name, "model.toml");
    assert_eq!(attached.data.as_ref(), b"format = 1\n");
    for channel in summary.channels.values() {
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!(schema.encoding, "jsonschema");
        let text: Value = serde_json::from_slice(&schema.data).unwrap();
        let messages = &topics[&channel.topic];
        let fields = messages[0].1.as_object().unwrap();
        for (name, _) in fields {
            assert!(text["properties"].get(name).is_some(), "{name}");
        }
    }
}

#[test]
fn the_same_run_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a", "b"].map(|name| folder.path().join(name));
    for path in &paths {
        whole(path);
    }
    let [a, b] = paths.map(|path| std::fs::read(path).unwrap());
    assert!(a == b);
}

#[test]
fn the_last_frame_is_shown_however_many_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut model = model();
    model.output.scene_every = 3;
    let (run, _) = record(&path, &model);
    let last = fake::frame(&model, 1.0);
    run.finish(
        &model,
        Some(&last),
        &fake::summary(Status::Interrupted),
        &[],
    )
    .unwrap();
    let topics = messages(&path);
    let times: Vec<u64> = topics["/scene"].iter().map(|(t, _)| *t).collect();
    assert_eq!(times, [0, 4 * TICK]);
}

/// Result of repairing a file of these bytes.
fn salvaged(folder: &Path, bytes: &[u8]) -> Result<(Salvaged, usize), SalvageError> {
    let path = folder.join("cut.mcap");
    std::fs::write(&path, bytes).unwrap();
    let found = salvage(&path, None)?;
    let steps = messages(&path).get("/step").map_or(0, Vec::len);
    assert!(!folder.join("cut.mcap.tmp").exists());
    Ok((found, steps))
}

#[test]
fn a_file_cut_anywhere_keeps_its_whole_increments() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let ends = whole(&path);
    let bytes = std::fs::read(&path).unwrap();
    let last = ends[INCREMENTS] as usize;
    // Every byte of the beginning, of one increment and of the end; the others in steps.
    let dense = (0..200).chain(ends[2] as usize..ends[3] as usize);
    let cuts = dense
        .chain((200..bytes.len()).step_by(37))
        .chain(last..bytes.len());
    for cut in cuts {
        let expected = ends
            .iter()
            .skip(1)
            .filter(|end| **end as usize <= cut)
            .count();
        match salvaged(folder.path(), &bytes[..cut]) {
            Ok((found, steps)) => {
                // A chunk may be complete before the index of its messages is.
                assert!(steps == expected || steps == expected + 1, "{cut}");
                assert!(!found.was_whole, "{cut}");
                assert_eq!(found.attachments, u64::from(cut as u64 >= ends[0]), "{cut}");
            }
            Err(SalvageError::NotMcap(_)) => assert!(cut < 64, "{cut}"),
            Err(error) => panic!("{cut}: {error}"),
        }
    }
    let (found, steps) = salvaged(folder.path(), &bytes).unwrap();
    assert!(found.was_whole && steps == INCREMENTS && found.lost_bytes == 0);
}

#[test]
fn a_damaged_file_keeps_what_stands_before_the_damage() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let ends = whole(&path);
    let bytes = std::fs::read(&path).unwrap();
    for at in (0..bytes.len())
        .step_by(23)
        .chain(ends.iter().map(|e| *e as usize))
    {
        for value in [0x00, 0xff, bytes[at] ^ 1] {
            let mut damaged = bytes.clone();
            damaged[at] = value;
            match salvaged(folder.path(), &damaged) {
                Ok((_, steps)) => {
                    let before = ends.iter().skip(1).filter(|end| **end as usize <= at);
                    assert!(steps >= before.count(), "{at}");
                }
                Err(SalvageError::NotMcap(_)) => assert!(at < 64, "{at}"),
                Err(error) => panic!("{at}: {error}"),
            }
        }
    }
    // Trailing zeros, as a power failure leaves them.
    let mut zeros = bytes[..ends[2] as usize].to_vec();
    zeros.resize(bytes.len(), 0);
    let (found, steps) = salvaged(folder.path(), &zeros).unwrap();
    assert_eq!((steps, found.lost_bytes), (2, bytes.len() as u64 - ends[2]));
}

#[test]
fn repair_into_another_file_leaves_the_original() {
    let folder = tempfile::tempdir().unwrap();
    let [path, out] = ["run.mcap", "whole.mcap"].map(|name| folder.path().join(name));
    let (run, ends) = record(&path, &model());
    std::mem::forget(run);
    let cut = &std::fs::read(&path).unwrap()[..ends[INCREMENTS] as usize - 1];
    std::fs::write(&path, cut).unwrap();
    let found = salvage(&path, Some(&out)).unwrap();
    assert!(!found.was_whole && found.lost_bytes > 0);
    assert_eq!(std::fs::read(&path).unwrap(), cut);
    assert_eq!(messages(&out)["/log"].len(), INCREMENTS + 1);
    // A second repair changes nothing.
    assert!(salvage(&out, None).unwrap().was_whole);
}

#[test]
fn other_files_are_reported_and_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let missing = salvage(&path, None).unwrap_err();
    assert!(matches!(&missing, SalvageError::Io(e) if e.why.kind() == ErrorKind::NotFound));
    std::fs::write(&path, "no MCAP").unwrap();
    let error = salvage(&path, None).unwrap_err().to_string();
    assert!(error.contains("run.mcap"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "no MCAP");
    assert!(salvage(folder.path(), None).is_err());
}

#[test]
#[cfg(target_os = "linux")]
fn a_device_is_no_file_of_messages() {
    let full = Path::new("/dev/full");
    let error = McapWriter::create(full, &model()).unwrap_err();
    assert!(error.to_string().contains("must be a file"), "{error}");
    assert!(salvage(Path::new("/dev/zero"), None).is_err());
}

/// Increment `i` of the small run and the messages after it.
fn go_on(run: &mut McapWriter, model: &Model, i: usize) {
    run.progress(1, i as f64, 1);
    let frame = fake::frame(model, 0.2 * i as f64);
    let frame = i.is_multiple_of(2).then_some(&frame);
    run.increment(model, &fake::row(i, 1, i as f64, 0.1 * i as f64), frame)
        .unwrap();
    if i == 2 {
        run.note("direct has passed the trouble");
    }
}

fn end(run: McapWriter, model: &Model) {
    run.finish(model, None, &fake::summary(Status::Completed), &[])
        .unwrap();
}

#[test]
fn a_file_continued_from_its_mark_has_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, path] = ["whole.mcap", "run.mcap"].map(|name| folder.path().join(name));
    let model = model();
    let begin = |path: &Path| {
        let mut run = McapWriter::create(path, &model).unwrap();
        run.attach("model.toml", "application/toml", "format = 1\n")
            .unwrap();
        run
    };
    let mut run = begin(&whole);
    for i in 1..=INCREMENTS {
        go_on(&mut run, &model, i);
    }
    end(run, &model);
    let wanted = std::fs::read(&whole).unwrap();
    for at in 0..=INCREMENTS {
        for ended in [true, false] {
            let mut run = begin(&path);
            (1..=at).for_each(|i| go_on(&mut run, &model, i));
            let mark = run.mark().unwrap();
            let least = std::fs::metadata(&path).unwrap().len();
            // The messages after the mark are written again, whether the file was closed, left open or truncated.
            run.progress(1, 9.0, 1);
            run.note("never mind");
            (at + 1..=INCREMENTS).for_each(|i| go_on(&mut run, &model, i));
            run.attach("model.toml", "application/toml", "format = 2\n")
                .unwrap();
            if ended {
                end(run, &model);
            } else {
                drop(run);
                let bytes = std::fs::read(&path).unwrap();
                let cut = usize::midpoint(least as usize, bytes.len());
                std::fs::write(&path, &bytes[..cut]).unwrap();
            }
            let (mut run, new) = McapWriter::resume(&path, &model, &mark).unwrap();
            new.keep().unwrap();
            assert_eq!(run.mark().unwrap(), mark);
            (at + 1..=INCREMENTS).for_each(|i| go_on(&mut run, &model, i));
            end(run, &model);
            let bytes = std::fs::read(&path).unwrap();
            assert!(bytes == wanted, "from {at}, ended: {ended}");
        }
    }
}

#[test]
fn a_file_that_ends_before_its_mark_is_rejected_and_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let model = model();
    let (mut run, ends) = record(&path, &model);
    let mark = run.mark().unwrap();
    drop(run);
    let bytes = std::fs::read(&path).unwrap();
    for end in [0, 5, ends[0], ends[INCREMENTS - 1]] {
        let cut = &bytes[..end as usize];
        std::fs::write(&path, cut).unwrap();
        let error = McapWriter::resume(&path, &model, &mark).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData, "{end}: {error}");
        assert_eq!(std::fs::read(&path).unwrap(), cut);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
    std::fs::remove_file(&path).unwrap();
    let error = McapWriter::resume(&path, &model, &mark).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::NotFound);
}

/// Records without a check sum are rebuilt: indices and the times of chunks.
#[test]
fn a_changed_bit_before_the_mark_is_detected_or_has_no_effect() {
    let folder = tempfile::tempdir().unwrap();
    let [path, again] = ["run.mcap", "again.mcap"].map(|name| folder.path().join(name));
    let model = model();
    let mut run = McapWriter::create(&path, &model).unwrap();
    run.attach("model.toml", "application/toml", "format = 1\n")
        .unwrap();
    go_on(&mut run, &model, 1);
    let mark = run.mark().unwrap();
    drop(run);
    let whole = std::fs::read(&path).unwrap();
    let mut seen = 0;
    // Every bit of the beginning, then every seventh bit.
    let bits = (0..8 * 100).chain((8 * 100..8 * whole.len()).step_by(7));
    let count = bits.clone().count();
    for bit in bits {
        let mut changed = whole.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        std::fs::write(&again, &changed).unwrap();
        match McapWriter::resume(&again, &model, &mark) {
            Err(error) => {
                assert_eq!(error.kind(), ErrorKind::InvalidData, "bit {bit}: {error}");
                seen += 1;
            }
            Ok((run, new)) => {
                drop((run, new.keep().unwrap()));
                assert!(std::fs::read(&again).unwrap() == whole, "bit {bit}");
            }
        }
    }
    // About a quarter of the file is messages and attachments, covered by the check sum of the mark. The rest is
    // rebuilt.
    assert!(seen > count / 5 && seen < count / 3, "{seen} of {count}");
}

/// Ten chunks of 16 MB of zeros in a file of a few kilobytes are read up to the bound for its length.
#[test]
fn a_file_that_unpacks_without_end_is_read_up_to_a_bound() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let file = std::io::BufWriter::new(std::fs::File::create(&path).unwrap());
    let mut writer = options("", "bomb").create(file).unwrap();
    let channel = writer
        .add_channel(0, "/step", "json", &BTreeMap::new())
        .unwrap();
    for sequence in 0..10 {
        let header = MessageHeader {
            channel_id: channel,
            sequence,
            log_time: 0,
            publish_time: 0,
        };
        let zeros = vec![0; 1 << 24];
        writer.write_to_known_channel(&header, &zeros).unwrap();
        writer.flush().unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let length = std::fs::metadata(&path).unwrap().len();
    assert!(length < 100_000, "{length}");
    let out = folder.path().join("salvaged.mcap");
    let found = salvage(&path, Some(&out)).unwrap();
    // 64 MB and 256 bytes per byte of the file.
    assert!(
        (3..6).contains(&found.messages) && !found.was_whole,
        "{found:?}"
    );
}
