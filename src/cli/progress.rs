//! A progress bar with an estimate on standard error, where that is a terminal.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Redrawn at most this often, so that drawing never takes time from a sample worth mentioning.
const INTERVAL: Duration = Duration::from_millis(250);

/// Columns of the bar itself.
const BAR: usize = 24;

/// A line that is redrawn in place; silent where standard error is not a terminal.
pub struct Progress {
    shown: bool,
    last: Option<Instant>,
    /// Share done, and seconds left.
    rest: (f64, f64),
}

impl Progress {
    /// A bar that is drawn only if `wanted` and standard error is a terminal.
    pub fn new(wanted: bool) -> Self {
        Self {
            shown: wanted && std::io::stderr().is_terminal(),
            last: None,
            rest: (0.0, 0.0),
        }
    }

    /// Shows the share that is done (0 to 1) and the estimated rest, kept as they were where they are `None`, and what is
    /// going on.
    pub fn update(&mut self, rest: Option<(f64, f64)>, doing: &str) {
        self.rest = rest.unwrap_or(self.rest);
        if !self.shown || self.last.is_some_and(|at| at.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        let (done, seconds_left) = self.rest;
        // A terminal that has gone away is no reason to stop measuring.
        let _ = write!(
            std::io::stderr(),
            "\r\x1b[K{}",
            line(done, seconds_left, doing)
        );
    }

    /// Removes the bar.
    pub fn clear(&mut self) {
        if self.shown && self.last.take().is_some() {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }

    /// Says something above the bar.
    pub fn say(&mut self, text: &str) {
        self.clear();
        eprintln!("{text}");
    }
}

/// The bar as text.
fn line(done: f64, seconds_left: f64, doing: &str) -> String {
    let done = done.clamp(0.0, 1.0);
    let full = (done * BAR as f64).round() as usize;
    format!(
        "[{}{}] {:3.0} %  {} left  {doing}",
        "#".repeat(full),
        ".".repeat(BAR - full),
        done * 100.0,
        duration(seconds_left)
    )
}

/// Seconds as a person says them: `8 s`, `2 min 05 s`, `1 h 12 min`.
pub fn duration(seconds: f64) -> String {
    let s = if seconds.is_finite() {
        seconds.max(0.0).round() as u64
    } else {
        0
    };
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {:02} s", s / 60, s % 60),
        _ => format!("{} h {:02} min", s / 3600, s % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_as_a_person_says_them() {
        assert_eq!(duration(8.4), "8 s");
        assert_eq!(duration(125.0), "2 min 05 s");
        assert_eq!(duration(4320.0), "1 h 12 min");
        assert_eq!(duration(f64::NAN), "0 s");
    }

    #[test]
    fn the_bar_keeps_its_length() {
        for done in [-1.0, 0.0, 0.33, 1.0, 7.0] {
            let text = line(done, 1.0, "");
            assert_eq!(text.find(']'), Some(BAR + 1), "{text}");
        }
    }
}
