//! Ctrl-C and its kin during a sweep: the first asks it to stop after the sample in progress, the second ends at once.

use std::sync::Arc;

use crate::lab::Control;

/// Watches for signals until it is dropped.
pub struct Watch {
    #[cfg(unix)]
    over: Arc<std::sync::atomic::AtomicBool>,
}

/// Stops `control` when the process is asked to end.
#[cfg(unix)]
pub fn watch(control: &Arc<Control>) -> Watch {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::flag;

    let asked = Arc::new(AtomicBool::new(false));
    let over = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        // In this order: a signal that finds the flag set ends the process, one that does not sets it. Where the system
        // refuses, the signal ends the process as it always does, and the journal holds what was measured.
        let _ = flag::register_conditional_shutdown(signal, 130, Arc::clone(&asked));
        let _ = flag::register(signal, Arc::clone(&asked));
    }
    let (control, ended) = (Arc::clone(control), Arc::clone(&over));
    std::thread::spawn(move || {
        while !ended.load(Ordering::Relaxed) {
            if asked.load(Ordering::Relaxed) {
                control.stop();
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    });
    Watch { over }
}

/// Elsewhere the system ends the process; the journal holds what was measured.
#[cfg(not(unix))]
pub fn watch(_: &Arc<Control>) -> Watch {
    Watch {}
}

impl Drop for Watch {
    fn drop(&mut self) {
        #[cfg(unix)]
        self.over.store(true, std::sync::atomic::Ordering::Relaxed);
    }
}
