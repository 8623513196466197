//! The real program in a pseudo-terminal, and the screen that a person would see.

use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};

/// Generous, since test machines are slow and loaded; nothing waits longer than it must.
const PATIENCE: Duration = Duration::from_mins(1);

/// The program in a pseudo-terminal.
pub struct Terminal {
    master: Box<dyn MasterPty + Send>,
    child: Box<dyn Child + Send + Sync>,
    keys: Box<dyn Write + Send>,
    output: Receiver<Vec<u8>>,
    parser: vt100::Parser,
    /// The line discipline's settings before the program ran.
    modes_before: String,
}

impl Terminal {
    /// Starts `raylab` with `args` in `dir`, in a terminal of `cols` by `rows`.
    pub fn start(args: &[&str], env: &[(&str, &str)], dir: &Path, cols: u16, rows: u16) -> Self {
        let pair = native_pty_system()
            .openpty(size(cols, rows))
            .expect("a pseudo-terminal can be had");
        let modes_before = modes(pair.master.as_ref());
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_raylab"));
        command.args(args);
        command.cwd(dir);
        command.env("TERM", "xterm-256color");
        command.env_remove("NO_COLOR");
        command.env_remove("COLORTERM");
        for (key, value) in env {
            command.env(key, value);
        }
        let child = pair
            .slave
            .spawn_command(command)
            .expect("the program starts");
        let mut reader = pair
            .master
            .try_clone_reader()
            .expect("the pseudo-terminal can be read");
        let (sender, output) = channel();
        thread::spawn(move || {
            let mut buffer = [0; 8192];
            while let Ok(n @ 1..) = reader.read(&mut buffer) {
                if sender.send(buffer[..n].to_vec()).is_err() {
                    break;
                }
            }
        });
        Self {
            keys: pair
                .master
                .take_writer()
                .expect("the pseudo-terminal can be written"),
            master: pair.master,
            child,
            output,
            parser: vt100::Parser::new(cells(rows), cells(cols), 0),
            modes_before,
        }
    }

    /// Types.
    pub fn press(&mut self, keys: &str) {
        self.keys
            .write_all(keys.as_bytes())
            .expect("the program reads keys");
        self.keys.flush().expect("the program reads keys");
    }

    /// Changes the terminal's size, as dragging a window's corner does.
    pub fn resize(&mut self, cols: u16, rows: u16) {
        self.master
            .resize(size(cols, rows))
            .expect("a pseudo-terminal can be resized");
        self.parser.screen_mut().set_size(cells(rows), cells(cols));
    }

    /// Waits until the screen satisfies `wanted`; panics with the screen when it does not in time.
    pub fn wait_until(&mut self, what: &str, wanted: impl Fn(&str) -> bool) -> String {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let screen = self.screen();
            if wanted(&screen) {
                return screen;
            }
            assert!(
                Instant::now() < deadline,
                "waited in vain for {what}; the screen:\n{screen}"
            );
            self.take_output(Duration::from_millis(50));
        }
    }

    /// Waits until `text` stands on the screen.
    pub fn wait_for(&mut self, text: &str) -> String {
        self.wait_until(&format!("'{text}'"), |screen| screen.contains(text))
    }

    /// Waits until the program has claimed the terminal, whether it has drawn anything or not.
    pub fn wait_until_claimed(&mut self) {
        let deadline = Instant::now() + PATIENCE;
        while !self.parser.screen().alternate_screen() {
            assert!(
                Instant::now() < deadline,
                "the terminal is not claimed; the screen:\n{}",
                self.screen()
            );
            self.take_output(Duration::from_millis(50));
        }
    }

    /// The screen as text.
    pub fn screen(&mut self) -> String {
        self.take_output(Duration::ZERO);
        self.parser.screen().contents()
    }

    /// Whether any cell of the screen has a colour of its own.
    pub fn colours_seen(&mut self) -> bool {
        self.take_output(Duration::ZERO);
        let screen = self.parser.screen();
        let (rows, cols) = screen.size();
        (0..u16::from(rows)).any(|row| {
            (0..u16::from(cols)).any(|col| {
                let plain = |c: vt100::Color| c == vt100::Color::Default;
                screen
                    .cell(row, col)
                    .is_some_and(|cell| !plain(cell.fgcolor()) || !plain(cell.bgcolor()))
            })
        })
    }

    /// Sends a signal to the program.
    #[cfg(unix)]
    pub fn signal(&self, name: &str) {
        let pid = self.child.process_id().expect("the program runs");
        let sent = std::process::Command::new("kill")
            .args([&format!("-{name}"), &pid.to_string()])
            .status();
        assert!(sent.expect("kill runs").success());
    }

    /// Waits for the program's end and gives its exit code.
    pub fn wait_for_end(&mut self) -> u32 {
        let deadline = Instant::now() + PATIENCE;
        loop {
            self.take_output(Duration::from_millis(20));
            if let Some(status) = self
                .child
                .try_wait()
                .expect("the program can be waited for")
            {
                self.take_output(Duration::from_millis(200));
                return status.exit_code();
            }
            assert!(
                Instant::now() < deadline,
                "the program does not end; the screen:\n{}",
                self.screen()
            );
        }
    }

    /// Panics unless the terminal is as it was before the program ran.
    pub fn assert_restored(&mut self) {
        self.take_output(Duration::from_millis(100));
        let screen = self.parser.screen();
        assert!(
            !screen.alternate_screen(),
            "the alternate screen is still shown"
        );
        assert!(!screen.hide_cursor(), "the cursor is still hidden");
        assert!(!screen.bracketed_paste(), "bracketed paste is still on");
        assert_eq!(
            screen.mouse_protocol_mode(),
            vt100::MouseProtocolMode::None,
            "the mouse is still captured"
        );
        assert_eq!(
            modes(self.master.as_ref()),
            self.modes_before,
            "the line discipline was changed"
        );
    }

    /// Feeds what has come, waiting for more at most `patience`.
    fn take_output(&mut self, patience: Duration) {
        if let Ok(bytes) = self.output.recv_timeout(patience) {
            self.parser.process(&bytes);
        }
        while let Ok(bytes) = self.output.try_recv() {
            self.parser.process(&bytes);
        }
    }
}

/// Starts the program, waits until it has drawn something, and takes the terminal away as a closed window does; says
/// whether the program ended.
pub fn ends_when_hung_up(args: &[&str], dir: &Path) -> bool {
    let pair = native_pty_system()
        .openpty(size(80, 24))
        .expect("a pseudo-terminal can be had");
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_raylab"));
    command.args(args);
    command.cwd(dir);
    command.env("TERM", "xterm-256color");
    let mut child = pair
        .slave
        .spawn_command(command)
        .expect("the program starts");
    drop(pair.slave);
    let mut reader = pair
        .master
        .try_clone_reader()
        .expect("the pseudo-terminal can be read");
    let mut drawn = Vec::new();
    let mut buffer = [0; 8192];
    while !String::from_utf8_lossy(&drawn).contains("quit") {
        let count = reader.read(&mut buffer).expect("the program draws");
        drawn.extend_from_slice(&buffer[..count]);
    }
    drop((reader, pair.master));
    let deadline = Instant::now() + PATIENCE;
    loop {
        if child
            .try_wait()
            .expect("the program can be waited for")
            .is_some()
        {
            return true;
        }
        if Instant::now() > deadline {
            child.kill().expect("the program can be killed");
            return false;
        }
        thread::sleep(Duration::from_millis(20));
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // A failed test must not leave the program running; one that has ended cannot be killed, which is fine.
        let _ = self.child.kill();
    }
}

/// A terminal has at least one row and column.
fn cells(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).unwrap_or(NonZeroU16::MIN)
}

fn size(cols: u16, rows: u16) -> PtySize {
    PtySize {
        rows,
        cols,
        pixel_width: 0,
        pixel_height: 0,
    }
}

/// The line discipline's settings, as text to compare.
#[cfg(unix)]
fn modes(master: &dyn MasterPty) -> String {
    let termios = master
        .get_termios()
        .expect("a pseudo-terminal has settings");
    format!(
        "{:?}",
        (
            termios.input_flags,
            termios.output_flags,
            termios.local_flags,
            termios.control_flags
        )
    )
}

#[cfg(not(unix))]
fn modes(_: &dyn MasterPty) -> String {
    String::new()
}
