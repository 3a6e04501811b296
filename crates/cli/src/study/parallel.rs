//! Many runs side by side, each on one thread.

use std::panic::AssertUnwindSafe;
use std::sync::Mutex;

/// Runs the jobs on this number of threads. Returns their results in the order of the jobs; none for a job that
/// had not begun when `stop` returned true.
///
/// The function uses plain threads: a worker of a shared pool would take up another run while it waits, and the
/// CPU time could not be assigned to a run.
pub fn side_by_side<J: Send, R: Send>(
    jobs: Vec<J>,
    threads: usize,
    stop: &(dyn Fn() -> bool + Sync),
    run: &(dyn Fn(J) -> R + Sync),
) -> Vec<Option<R>> {
    let done = Mutex::new(jobs.iter().map(|_| None).collect::<Vec<Option<R>>>());
    let queue = Mutex::new(jobs.into_iter().enumerate());
    let next = || queue.lock().ok().and_then(|mut jobs| jobs.next());
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((index, job)) = next().filter(|_| !stop()) {
                    let result = run(job);
                    if let Ok(mut done) = done.lock() {
                        done[index] = Some(result);
                    }
                }
            });
        }
    });
    done.into_inner().unwrap_or_default()
}

/// Runs in a pool of one thread. A panic is caught and returned as an error, so that the other runs continue.
///
/// # Errors
/// The error of the run, the reason why there is no pool, or the message of the panic.
pub fn on_one_thread<R: Send>(run: impl FnOnce() -> Result<R, String> + Send) -> Result<R, String> {
    on_threads(1, |pool| pool.install(run))
}

/// Runs `run` with a pool of its own of this number of threads. A panic is handled as in [`on_one_thread`].
///
/// # Errors
/// As [`on_one_thread`].
pub fn on_threads<R>(
    threads: usize,
    run: impl FnOnce(&rayon::ThreadPool) -> Result<R, String>,
) -> Result<R, String> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| error.to_string())?;
    let outcome = std::panic::catch_unwind(AssertUnwindSafe(|| run(&pool)));
    outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        Err(format!("panic: {}", text.unwrap_or("no message")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_jobs_and_a_panic_is_told() {
        let twice = |n: u32| on_one_thread(move || Ok(2 * n)).unwrap_or(0);
        let done = side_by_side((0..9).collect(), 3, &|| false, &twice);
        assert_eq!(done, (0..9).map(|n| Some(2 * n)).collect::<Vec<_>>());
        assert_eq!(side_by_side(vec![1], 2, &|| true, &twice), [None]);
        let broken: Result<(), String> = on_one_thread(|| panic!("wall {}", 7));
        assert_eq!(broken, Err("panic: wall 7".to_owned()));
    }
}
