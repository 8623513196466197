//! The terminal: claimed for the screens, and given back whatever happens: quit, error, panic, suspension.
//!
//! A frame leaves in one write, between the marks that let terminals show it all at once (synchronized output).

use std::cell::Cell;
use std::io::{self, IsTerminal, Write};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Once};
use std::thread::{self, ThreadId};

use crossterm::cursor::{Hide, Show};
use crossterm::event::{DisableBracketedPaste, EnableBracketedPaste};
use crossterm::terminal::{
    self, BeginSynchronizedUpdate, Clear, ClearType, EndSynchronizedUpdate, EnterAlternateScreen,
    LeaveAlternateScreen,
};
use crossterm::{execute, queue};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::layout::{Position, Rect, Size};

use super::TuiError;
use super::state::State;
use super::view::view;

/// Bytes of a frame that are kept ready: a full truecolor frame of a large terminal.
const FRAME_BYTES: usize = 256 * 1024;

/// Whether the terminal is claimed now. Global because a panic hook is: it must know what to give back.
static CLAIMED: AtomicBool = AtomicBool::new(false);

/// Collects a frame and writes it at once. What was not sent when it is dropped is never sent.
struct FrameWriter {
    frame: Vec<u8>,
    held: Rc<Cell<bool>>,
}

impl FrameWriter {
    fn send(&mut self) -> io::Result<()> {
        let mut out = io::stdout().lock();
        let sent = out.write_all(&self.frame).and_then(|()| out.flush());
        self.frame.clear();
        sent
    }
}

impl Write for FrameWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.frame.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.held.get() { Ok(()) } else { self.send() }
    }
}

/// The terminal, claimed as long as this lives.
pub(super) struct Tty {
    /// Whether a frame is being collected.
    held: Rc<Cell<bool>>,
    terminal: Terminal<CrosstermBackend<FrameWriter>>,
}

impl Tty {
    /// Claims the terminal.
    ///
    /// # Errors
    /// Standard input or output is no terminal; the terminal refuses.
    pub(super) fn claim() -> Result<Self, TuiError> {
        if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
            return Err(TuiError::NoTerminal);
        }
        restore_on_panic(thread::current().id());
        enter()?;
        let held = Rc::new(Cell::new(false));
        let writer = FrameWriter {
            frame: Vec::with_capacity(FRAME_BYTES),
            held: Rc::clone(&held),
        };
        let terminal = Terminal::new(CrosstermBackend::new(writer));
        match terminal {
            Ok(terminal) => Ok(Self { held, terminal }),
            Err(error) => {
                leave();
                Err(error.into())
            }
        }
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> io::Result<Size> {
        self.terminal.size()
    }

    /// Draws `state`: what differs from the last frame, in one write.
    pub(super) fn draw(&mut self, state: &State) -> io::Result<()> {
        self.held.set(true);
        queue!(self.terminal.backend_mut(), BeginSynchronizedUpdate)?;
        self.terminal.draw(|frame| view(state, frame))?;
        queue!(self.terminal.backend_mut(), EndSynchronizedUpdate)?;
        self.held.set(false);
        self.terminal.backend_mut().flush()
    }

    /// Forgets the last frame, so that the next is drawn whole.
    pub(super) fn forget(&mut self) -> io::Result<()> {
        // Not `clear`: that asks the terminal where its cursor is, and the answer would go to the input thread.
        let size = self.terminal.size()?;
        self.terminal.resize(Rect::from((Position::ORIGIN, size)))
    }

    /// Gives the terminal back; nothing happens where that was done before.
    pub(super) fn release() {
        leave();
    }

    /// Claims the terminal again, whatever others did to it meanwhile.
    pub(super) fn reclaim(&mut self) -> io::Result<()> {
        leave();
        enter()?;
        self.forget()
    }
}

impl Drop for Tty {
    fn drop(&mut self) {
        leave();
    }
}

fn enter() -> io::Result<()> {
    terminal::enable_raw_mode()?;
    CLAIMED.store(true, Ordering::SeqCst);
    execute!(
        io::stdout(),
        EnterAlternateScreen,
        EnableBracketedPaste,
        Hide
    )
    .inspect_err(|_| leave())
}

/// Gives the terminal back. Errors are of no use here: there is nothing left to do about them.
fn leave() {
    if CLAIMED.swap(false, Ordering::SeqCst) {
        // Cleared first: some multiplexers leave rows of a resized alternate screen behind.
        let _ = execute!(
            io::stdout(),
            EndSynchronizedUpdate,
            Clear(ClearType::All),
            DisableBracketedPaste,
            LeaveAlternateScreen,
            Show
        );
        let _ = terminal::disable_raw_mode();
    }
}

/// Gives the terminal back before a panic of the UI thread is reported. Panics of other threads are caught where they
/// run and told on the screen; their report would only spoil it.
fn restore_on_panic(ui: ThreadId) {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let report = Arc::new(std::panic::take_hook());
        std::panic::set_hook(Box::new(move |info| {
            if thread::current().id() == ui {
                leave();
            }
            if !CLAIMED.load(Ordering::SeqCst) {
                report(info);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_frame_is_not_sent_before_its_end() {
        let mut writer = FrameWriter {
            frame: Vec::new(),
            held: Rc::new(Cell::new(true)),
        };
        writer.write_all(b"abc").unwrap();
        writer.flush().unwrap();
        assert_eq!(writer.frame, b"abc");
    }

    #[test]
    fn giving_back_what_was_not_claimed_does_nothing() {
        leave();
        assert!(!CLAIMED.load(Ordering::SeqCst));
    }
}
