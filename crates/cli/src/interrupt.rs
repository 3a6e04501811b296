//! Ctrl-C: the first one asks, the second one insists.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use crate::failure;

/// Whether the user has asked to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

/// The one that Ctrl-C sets: a process has one handler.
static OF_CTRL_C: OnceLock<Interrupt> = OnceLock::new();

impl Interrupt {
    /// Listens to Ctrl-C from now on: the first one sets the flag, the second one ends the process
    /// at once with exit code 130. Where no handler can be set, Ctrl-C ends the process as usual.
    pub fn listen() -> Self {
        let interrupt = OF_CTRL_C.get_or_init(|| {
            let interrupt = Self::default();
            let flag = interrupt.clone();
            let set = ctrlc::set_handler(move || {
                if flag.0.swap(true, Ordering::SeqCst) {
                    std::process::exit(i32::from(failure::INTERRUPTED));
                }
                eprintln!("\nstopping after this increment; Ctrl-C again stops at once");
            });
            if let Err(error) = set {
                eprintln!("Ctrl-C will not be waited for: {error}");
            }
            interrupt
        });
        // What stopped an earlier run of this process is not meant for this one.
        interrupt.0.store(false, Ordering::SeqCst);
        interrupt.clone()
    }

    /// True once the user has asked.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }

    /// Asks as the user would.
    #[cfg(test)]
    pub fn request(&self) {
        self.0.store(true, Ordering::SeqCst);
    }
}
