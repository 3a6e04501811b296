//! Files that a run writes into its folder, and faults of the folder.

use super::*;
use crate::results::fake;
use crate::results::output::LOCK;
use crate::state::Status;

const WORK: &str = "results.vtkhdf.part";

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != LOCK)
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_leaves_its_files_and_the_summary_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/wall.out");
    let model = fake::model();
    let mut run = RunDirectory::create(&path, &model).unwrap();
    assert!(run.take(&model, &fake::row(1, 0, 0.0, 0.0), None).unwrap());
    for (i, (d, f)) in [(1.0, 10.0), (2.0, 20.0), (3.0, 10.0)]
        .into_iter()
        .enumerate()
    {
        let frame = fake::frame(&model, d);
        assert!(
            run.take(&model, &fake::row(i + 2, 1, d, f), Some(&frame))
                .unwrap()
        );
        run.fields.settled().unwrap();
        assert_eq!(
            names(&path),
            [HISTORY, FIELDS, WORK, MESSAGES],
            "nothing that says whole while it runs"
        );
    }
    let summary = run
        .finish(&model, &fake::summary(Status::Completed), &[])
        .unwrap();
    assert_eq!(
        names(&path),
        [
            CRACK_PATTERN,
            HISTORY,
            LOAD_DISPLACEMENT,
            FIELDS,
            MESSAGES,
            SUMMARY
        ]
    );
    assert_eq!(summary.peak_force_kN, Some(20.0));
    assert_eq!(summary.displacement_at_80_percent_mm, Some(2.4));
    assert_eq!(summary.initial_stiffness_kN_per_mm, Some(10.0));
    let history = std::fs::read_to_string(path.join(HISTORY)).unwrap();
    assert_eq!(history.lines().count(), 5);

    // The next run into the folder first removes the summary.
    std::fs::write(path.join("notes.txt"), "mine").unwrap();
    let _next = RunDirectory::create(&path, &model).unwrap();
    assert_eq!(names(&path), [HISTORY, "notes.txt", FIELDS, WORK, MESSAGES]);
    let header_only = std::fs::read_to_string(path.join(HISTORY)).unwrap();
    assert_eq!(header_only.lines().count(), 1);
}

#[test]
fn a_second_run_into_the_folder_of_a_running_one_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let model = fake::model();
    let mut first = RunDirectory::create(folder.path(), &model).unwrap();
    first
        .take(&model, &fake::row(1, 0, 0.0, 0.0), None)
        .unwrap();
    let before = std::fs::read(folder.path().join(HISTORY)).unwrap();
    let second = RunDirectory::create(folder.path(), &model).unwrap_err();
    assert!(matches!(&second, OutputError::Busy(path) if path == folder.path()));
    let after = std::fs::read(folder.path().join(HISTORY)).unwrap();
    assert_eq!(before, after);
    drop(first);
    assert!(RunDirectory::create(folder.path(), &model).is_ok());
}

#[test]
fn checkpoints_wait_for_frames_and_take_their_part_at_most() {
    let kept = |since: f64, took: f64, frame| Kept {
        at: Instant::now().checked_sub(Duration::from_secs_f64(since)),
        took: Duration::from_secs_f64(took),
        frame,
    };
    assert!(Kept::nothing().is_due());
    assert!(kept(1.0, 0.01, true).is_due());
    assert!(!kept(1.0, 0.01, false).is_due());
    assert!(!kept(1.0, 0.1, true).is_due());
    assert!(kept(4.0, 0.01, false).is_due());
}

#[test]
fn a_file_in_the_way_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.out");
    std::fs::write(&path, "mine").unwrap();
    let error = RunDirectory::create(&path, &fake::model()).unwrap_err();
    assert!(matches!(&error, OutputError::NotADirectory(p) if *p == path));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    let below = RunDirectory::create(&path.join("below"), &fake::model()).unwrap_err();
    assert!(matches!(below, OutputError::Create { .. }));
}

#[test]
#[cfg(target_os = "linux")]
fn links_where_files_of_a_run_belong_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let model = fake::model();
    for name in [HISTORY, MESSAGES] {
        std::os::unix::fs::symlink("/dev/full", folder.path().join(name)).unwrap();
    }
    drop(RunDirectory::create(folder.path(), &model).unwrap());
    for name in [HISTORY, MESSAGES] {
        let file = std::fs::symlink_metadata(folder.path().join(name)).unwrap();
        assert!(file.is_file(), "{name}");
    }
}

#[test]
fn messages_are_written_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let mut model = fake::model();
    drop(RunDirectory::create(folder.path(), &model).unwrap());
    model.output.mcap = false;
    let mut run = RunDirectory::create(folder.path(), &model).unwrap();
    run.note("nobody hears");
    run.progress(0, 0.0, 1);
    assert_eq!(names(folder.path()), [HISTORY, FIELDS, WORK]);
}

/// Frames every third increment: the largest force lies between two of them and gets a frame of its own, once, before
/// the frame after it. Every larger force before is forgotten.
#[test]
fn the_largest_force_has_a_frame() {
    let forces = [1.0, 4.0, 6.0, 8.0, 9.0, 7.0, 5.0, 4.0];
    let recorded = |run: &mut RunDirectory, model: &Model, from: usize, to: usize| {
        for i in from..=to {
            let row = HistoryRow {
                time: i as f64,
                ..fake::row(i, 1, i as f64, forces[i - 1])
            };
            let frame = Frame {
                increment: i,
                ..fake::frame(model, i as f64)
            };
            let due = i.is_multiple_of(3);
            run.take(model, &row, due.then_some(&frame)).unwrap();
            if !due && run.wants_fields() {
                run.keep(model, frame);
            }
        }
    };
    let increments = |folder: &Path| {
        let open = RunFolder::open(folder).unwrap();
        open.fields().unwrap().increments().to_vec()
    };
    let folder = tempfile::tempdir().unwrap();
    let model = fake::model();
    let mut run = RunDirectory::create(folder.path(), &model).unwrap();
    recorded(&mut run, &model, 1, 8);
    run.finish(&model, &fake::summary(Status::Completed), &[])
        .unwrap();
    assert_eq!(increments(folder.path()), [3, 5, 6]);
    let open = Snapshots::open(&RunFolder::open(folder.path()).unwrap()).unwrap();
    let peak = open.at(FrameChoice::Peak).unwrap();
    assert_eq!((peak.frame.time, peak.row.unwrap().force_kN), (5.0, 9.0));
    // A run that ends just after its peak has the frame as well.
    let mut run = RunDirectory::create(folder.path(), &model).unwrap();
    recorded(&mut run, &model, 1, 5);
    run.finish(&model, &fake::summary(Status::Interrupted), &[])
        .unwrap();
    assert_eq!(increments(folder.path()), [3, 5]);
}
