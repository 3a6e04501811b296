//! A run in a process of its own, which is ended at its time limit.

use std::ffi::OsString;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use wythe_core::deck::Strategy;
use wythe_core::results::usage;

/// Interval between two checks of the process.
const PAUSE: Duration = Duration::from_millis(20);
/// Time in which the process may end by itself after the user asked to stop: Ctrl-C on a terminal reaches it too.
const GRACE: Duration = Duration::from_secs(5);
/// Largest wall time over the limit of CPU time, for a busy machine: a process that waits for ever uses no CPU
/// time.
const BUSY: f64 = 20.0;

/// End of a process.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Whether the process exceeded its time limit.
    pub out_of_time: bool,
    /// Exit code; none if a signal ended the process.
    pub code: Option<i32>,
    /// CPU time [s].
    pub cpu_s: f64,
    /// Text of standard error.
    pub stderr: String,
}

/// A call of the program.
#[derive(Clone, Copy)]
pub struct Call<'a> {
    /// The program, with the arguments that precede its command.
    pub program: &'a [OsString],
    /// The command and its arguments.
    pub arguments: &'a [OsString],
    /// Limit of CPU time if the system reports that of another process, of wall time elsewhere.
    pub limit: Duration,
}

/// Arguments of `run DECK --out FOLDER` with this number of threads and these keys of the deck.
pub fn run_of(
    deck: &Path,
    folder: &Path,
    set: &[(String, String)],
    threads: usize,
) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = vec![
        "run".into(),
        deck.into(),
        "--out".into(),
        folder.into(),
        "--quiet".into(),
        "--threads".into(),
        threads.to_string().into(),
    ];
    arguments.extend(overrides(set));
    arguments
}

/// Arguments of `limit DECK --associated --out FOLDER` with these keys of the deck. Associated friction needs one
/// program only, and its factor is an upper bound.
pub fn limit_of(deck: &Path, folder: &Path, set: &[(String, String)]) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = vec![
        "limit".into(),
        deck.into(),
        "--associated".into(),
        "--out".into(),
        folder.into(),
    ];
    arguments.extend(overrides(set));
    arguments
}

/// `--set KEY=VALUE` of each key.
fn overrides(set: &[(String, String)]) -> impl Iterator<Item = OsString> + '_ {
    set.iter()
        .flat_map(|(key, value)| ["--set".into(), format!("{key}={value}").into()])
}

/// Key that a strategy sets in the deck.
pub fn key_of(strategy: Strategy) -> (String, String) {
    ("strategy".to_owned(), format!("\"{}\"", strategy.name()))
}

/// Runs a program. Returns none if the user stopped it. Files written by the process remain.
///
/// # Errors
/// The process cannot be started or waited for.
pub fn run(call: &Call<'_>, stop: &(dyn Fn() -> bool + Sync)) -> io::Result<Option<Ended>> {
    let Some((first, rest)) = call.program.split_first() else {
        return Err(io::Error::other("there is no program to run it with"));
    };
    let mut command = Command::new(first);
    command.args(rest).args(call.arguments);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut child = command.spawn()?;
    let mut errors = child.stderr.take();
    std::thread::scope(|scope| {
        // Standard error is read while the process runs: a full pipe would block the process.
        let said = scope.spawn(move || {
            let mut bytes = Vec::new();
            if let Some(errors) = &mut errors {
                // A part of a message is better than none.
                let _ = errors.read_to_end(&mut bytes);
            }
            String::from_utf8_lossy(&bytes).into_owned()
        });
        let waited = wait(&mut child, call.limit, stop);
        if waited.is_err() {
            end(&mut child);
        }
        let stderr = said.join().unwrap_or_default();
        Ok(waited?.map(|ended| Ended { stderr, ..ended }))
    })
}

/// Waits until the process ends, or ends it at its limit.
fn wait(
    child: &mut Child,
    limit: Duration,
    stop: &(dyn Fn() -> bool + Sync),
) -> io::Result<Option<Ended>> {
    let started = Instant::now();
    let mut asked: Option<Instant> = None;
    let mut cpu_s = 0.0;
    loop {
        // The CPU time must be read before the exit status: afterwards the system has discarded it.
        let cpu = usage::cpu_seconds_of(child.id());
        let elapsed = started.elapsed().as_secs_f64();
        cpu_s = cpu.unwrap_or(elapsed).max(cpu_s);
        if let Some(status) = child.try_wait()? {
            let ended = Ended {
                out_of_time: false,
                code: status.code(),
                cpu_s,
                stderr: String::new(),
            };
            return Ok(Some(ended).filter(|_| asked.is_none() && !stop()));
        }
        let limit = limit.as_secs_f64();
        if cpu_s > limit || elapsed > BUSY * limit {
            end(child);
            return Ok(Some(Ended {
                out_of_time: true,
                code: None,
                cpu_s,
                stderr: String::new(),
            }));
        }
        if stop() && asked.get_or_insert_with(Instant::now).elapsed() > GRACE {
            end(child);
            return Ok(None);
        }
        std::thread::sleep(PAUSE);
    }
}

/// Ends the process at once. An error is ignored: the process may have ended already.
fn end(child: &mut Child) {
    let _ = child.kill();
    let _ = child.wait();
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// A program in place of wythe: it receives `run DECK …` as `$1`, `$2` ….
    fn shell(script: &str) -> Vec<OsString> {
        ["sh", "-c", script, "sh"].map(OsString::from).to_vec()
    }

    fn run(script: &str, limit: f64, stop: &(dyn Fn() -> bool + Sync)) -> Option<Ended> {
        let set = [("output.mcap".to_owned(), "false".to_owned())];
        let arguments = run_of(Path::new("1.toml"), Path::new("1.out"), &set, 1);
        let call = Call {
            program: &shell(script),
            arguments: &arguments,
            limit: Duration::from_secs_f64(limit),
        };
        super::run(&call, stop).unwrap()
    }

    #[test]
    fn a_process_gets_its_arguments_and_gives_its_code_and_its_errors() {
        let ended = run("echo \"$@\" >&2; exit 3", 60.0, &|| false).unwrap();
        assert_eq!((ended.code, ended.out_of_time), (Some(3), false));
        let wanted = "run 1.toml --out 1.out --quiet --threads 1 --set output.mcap=false\n";
        assert_eq!(ended.stderr, wanted);
    }

    #[test]
    fn one_that_never_ends_is_ended_by_its_cpu_time_and_one_that_waits_by_the_clock() {
        let busy = run("while :; do :; done", 0.2, &|| false).unwrap();
        assert!(busy.out_of_time && busy.cpu_s > 0.2, "{busy:?}");
        let waits = run("exec sleep 600", 0.01, &|| false).unwrap();
        assert!(waits.out_of_time && waits.cpu_s < 10.0, "{waits:?}");
    }

    #[test]
    fn one_that_the_user_stopped_has_no_end() {
        assert_eq!(run("exit 130", 60.0, &|| true), None);
    }

    #[test]
    fn a_program_that_is_not_there_is_an_error() {
        let program = [OsString::from("/no/such/wythe")];
        for program in [&program[..], &[]] {
            let call = Call {
                program,
                arguments: &[],
                limit: Duration::from_secs(1),
            };
            assert!(super::run(&call, &|| false).is_err());
        }
    }
}
