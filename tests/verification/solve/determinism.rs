//! Results are bitwise equal on any number of threads.

use crate::common::scene::{self, Recording};
use wythe::model::Model;

fn on_threads(model: &Model, threads: usize) -> Recording {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let (recording, summary) = pool.install(|| scene::run(model));
    // The run used the given thread pool.
    assert_eq!(summary.threads, threads);
    recording
}

/// All numbers of a recording with enough digits to reproduce their bits.
fn digits(recording: &Recording) -> String {
    format!(
        "{:?} {:?} {:?}",
        recording.rows, recording.states, recording.frames
    )
}

#[test]
fn a_small_wall_has_the_same_history_on_1_2_and_4_threads() {
    for (procedure, end) in [
        (scene::SECANT, 0.3),
        (scene::IMPLEX, 0.3),
        (scene::DIRECT, 0.2),
    ] {
        let mut model = crate::common::small_wall();
        for motion in &mut model.steps[1].motion[0] {
            if let wythe::model::scene::BeamMotion::Driven(by) = motion {
                *by = end;
            }
        }
        model.steps[1].increments.max = 0.02;
        for step in &mut model.steps {
            (step.procedure, step.tangent) = procedure;
            step.tolerance.residual = 5e-3;
        }
        let one = on_threads(&model, 1);
        let last = one.rows.last().unwrap();
        println!("{procedure:?}: {} increments, {last:?}", one.rows.len());
        assert!(
            last.open_points > 20 && last.sliding_points > 10 && last.max_interface_damage > 0.1
        );
        let reference = digits(&one);
        for threads in [2, 4] {
            assert!(
                digits(&on_threads(&model, threads)) == reference,
                "{procedure:?}, {threads}"
            );
        }
    }
}
