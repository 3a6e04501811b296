//! Requests to stop by Ctrl-C, SIGTERM and SIGHUP.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use crate::failure;
use crate::say::tell;

/// Flag that is set once the user has asked to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

/// The flag that signals set. It is shared, because a process has one handler per signal.
static OF_SIGNALS: OnceLock<Interrupt> = OnceLock::new();

impl Interrupt {
    /// Listens to signals from now on. The first Ctrl-C sets the flag, the second one ends the process at once with
    /// exit code 130. SIGTERM (`kill`, batch systems, `timeout`) and SIGHUP (closed terminal) set the flag too but
    /// never end the process: both often come twice, once from the shell or `timeout` and once to its whole process
    /// group. A SIGHUP that is ignored from the start, as below `nohup`, stays ignored. Where no handler can be set,
    /// the signal ends the process as usual.
    pub fn listen() -> Self {
        Self::listen_saying("stopping after this increment; Ctrl-C again stops at once")
    }

    /// [`Interrupt::listen`], which answers the first Ctrl-C with `said`.
    pub fn listen_saying(said: &'static str) -> Self {
        let interrupt = OF_SIGNALS.get_or_init(|| {
            let interrupt = Self::default();
            let flag = interrupt.clone();
            let set = ctrlc::set_handler(move || {
                if flag.0.swap(true, Ordering::SeqCst) {
                    std::process::exit(i32::from(failure::INTERRUPTED));
                }
                tell!("\n{said}");
            });
            if let Err(error) = set {
                tell!("Ctrl-C will not be waited for: {error}");
            }
            #[cfg(unix)]
            interrupt.listen_to_termination();
            interrupt
        });
        // A request to stop an earlier run of this process does not concern this one.
        interrupt.0.store(false, Ordering::SeqCst);
        interrupt.clone()
    }

    #[cfg(unix)]
    fn listen_to_termination(&self) {
        use signal_hook::consts::{SIGHUP, SIGTERM};
        let wanted = [
            (SIGTERM, "SIGTERM", true),
            (SIGHUP, "SIGHUP", hang_up_counts()),
        ];
        for (signal, name, _) in wanted.into_iter().filter(|(.., wanted)| *wanted) {
            if let Err(error) = signal_hook::flag::register(signal, Arc::clone(&self.0)) {
                tell!("{name} will not be waited for: {error}");
            }
        }
    }

    /// Whether the user has asked to stop.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }

    /// Asks to stop, as a user would.
    #[cfg(test)]
    pub fn request(&self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// Whether SIGHUP is not ignored. If the system does not say so, whether there is a terminal that may be closed
/// (`nohup` redirects standard error).
#[cfg(unix)]
fn hang_up_counts() -> bool {
    use std::io::IsTerminal as _;
    let status = std::fs::read_to_string("/proc/self/status").ok();
    let ignored = status.and_then(|status| ignores_hang_up(&status));
    ignored.map_or_else(|| std::io::stderr().is_terminal(), |ignored| !ignored)
}

/// The mask of ignored signals in `/proc/self/status` is hexadecimal; SIGHUP, signal 1, is its lowest bit.
#[cfg(unix)]
fn ignores_hang_up(status: &str) -> Option<bool> {
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"))?;
    let mask = u64::from_str_radix(mask.trim(), 16).ok()?;
    Some(mask & 1 == 1)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn an_ignored_hang_up_is_the_lowest_bit_of_its_mask() {
        let status = |mask: &str| format!("SigBlk:\t0000000000000001\nSigIgn:\t{mask}\n");
        assert_eq!(ignores_hang_up(&status("0000000000001001")), Some(true));
        assert_eq!(ignores_hang_up(&status("0000000000001000")), Some(false));
        assert_eq!(ignores_hang_up("Name:\twythe\n"), None);
    }
}
