//! The command line: parse, run, exit code. Data goes to standard output, everything else to standard error.

use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use crate::scene;
use crate::tui::{self, TuiError};

mod accuracy;
mod args;
mod choices;
mod export;
mod failure;
mod inspect;
mod interrupt;
mod list;
mod progress;
mod rays;
mod render;
mod session;
mod stability;
mod sweep;
mod table;

pub use args::Cli;
pub use failure::Failure;

use args::Command;

/// Runs the program on the process's arguments.
#[must_use]
pub fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if failure.code() != 0 {
                eprintln!("raylab: {failure}");
            }
            ExitCode::from(failure.code())
        }
    }
}

/// Runs one command.
///
/// # Errors
/// What the command failed of; [`Failure::code`] is the exit code.
pub fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        None => lab(cli.scenes),
        Some(Command::List(args)) => list::run(&args),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Inspect(args)) => inspect::run(&args),
        Some(Command::Rays(args)) => rays::write(&args),
        Some(Command::Trace(args)) => rays::trace(&args),
        Some(Command::Completions { shell }) => completions(shell),
        Some(Command::Man) => manual(),
        Some(Command::Accuracy(args)) => accuracy::run(&args),
        Some(Command::Stability(args)) => stability::run(&args),
        Some(Command::Sweep(args)) => sweep::run(&args),
        Some(Command::Report(args)) => export::run(&args),
    }
}

/// Opens the terminal lab.
fn lab(scenes: Vec<String>) -> Result<(), Failure> {
    for spec in &scenes {
        scene::check(spec)?;
    }
    Ok(tui::run(&tui::Options {
        scenes,
        ..tui::Options::default()
    })?)
}

impl From<TuiError> for Failure {
    fn from(error: TuiError) -> Self {
        match error {
            TuiError::NoTerminal => Self::Usage(error.to_string()),
            TuiError::Terminal(_) => Self::Failed(error.to_string()),
            TuiError::Ended { .. } => Self::Interrupted,
        }
    }
}

/// Writes `text` to standard output.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    Ok(out.flush()?)
}

/// The command line as a reader of a report would type it: without the folder that the program lies in.
fn command_line() -> Vec<String> {
    let program = std::iter::once("raylab".to_owned());
    program.chain(std::env::args().skip(1)).collect()
}

fn completions(shell: clap_complete::Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "raylab", &mut script);
    print(&String::from_utf8_lossy(&script))
}

fn manual() -> Result<(), Failure> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Cli::command()).render(&mut page)?;
    print(&String::from_utf8_lossy(&page))
}
