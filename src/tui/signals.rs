//! Signals that concern a terminal program: end, suspend, resume. Where there are none, nothing ever comes.

/// What a signal asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Signal {
    /// End the program; the signal's number.
    End(i32),
    /// Hand the terminal back and stop.
    Suspend,
    /// The program goes on after it was stopped.
    Resumed,
}

#[cfg(unix)]
mod platform {
    use std::io;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGTSTP};
    use signal_hook::{flag, low_level};

    use super::Signal;

    /// Flags that signal handlers set.
    #[derive(Debug, Default)]
    pub(in crate::tui) struct Signals {
        end: Arc<AtomicUsize>,
        suspend: Arc<AtomicBool>,
        resumed: Arc<AtomicBool>,
    }

    impl Signals {
        /// Takes the signals over from their default actions, for the rest of the process.
        pub(in crate::tui) fn register() -> io::Result<Self> {
            let signals = Self::default();
            for signal in [SIGHUP, SIGINT, SIGTERM] {
                flag::register_usize(signal, Arc::clone(&signals.end), signal as usize)?;
            }
            flag::register(SIGTSTP, Arc::clone(&signals.suspend))?;
            flag::register(SIGCONT, Arc::clone(&signals.resumed))?;
            Ok(signals)
        }

        /// The most pressing signal that came since the last call.
        pub(in crate::tui) fn take(&self) -> Option<Signal> {
            match self.end.swap(0, Ordering::Relaxed) {
                0 => {}
                signal => return Some(Signal::End(signal as i32)),
            }
            if self.suspend.swap(false, Ordering::Relaxed) {
                return Some(Signal::Suspend);
            }
            self.resumed
                .swap(false, Ordering::Relaxed)
                .then_some(Signal::Resumed)
        }
    }

    /// Stops the process until the shell resumes it.
    pub(in crate::tui) fn stop() -> io::Result<()> {
        low_level::emulate_default_handler(SIGTSTP)
    }
}

#[cfg(not(unix))]
mod platform {
    use std::io;

    use super::Signal;

    /// No signals.
    #[derive(Debug, Default)]
    pub(in crate::tui) struct Signals;

    impl Signals {
        /// Nothing to take over.
        pub(in crate::tui) fn register() -> io::Result<Self> {
            Ok(Self)
        }

        /// Never anything.
        pub(in crate::tui) fn take(&self) -> Option<Signal> {
            None
        }
    }

    /// There is no stopping.
    pub(in crate::tui) fn stop() -> io::Result<()> {
        Ok(())
    }
}

pub(super) use platform::{Signals, stop};

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_resume_signal_is_reported_once() {
        let signals = Signals::register().unwrap();
        signal_hook::low_level::raise(signal_hook::consts::SIGCONT).unwrap();
        assert_eq!(signals.take(), Some(Signal::Resumed));
        assert_eq!(signals.take(), None);
    }
}
