//! The input thread: waits for keys, and wakes the UI thread at once.

use std::sync::mpsc::Sender;
use std::thread;
use std::time::Duration;

use crossterm::event::{self, KeyEventKind};

use super::app::Message;
use super::signals::Signals;
use super::update::Event;

/// How often signals are looked at while no key comes.
const GLANCE: Duration = Duration::from_millis(100);

/// Starts the thread. It ends with the channel, or when the terminal is gone.
pub(super) fn spawn(signals: Signals, to: Sender<Message>) {
    thread::spawn(move || {
        loop {
            let message = match event::poll(GLANCE) {
                Ok(true) => match event::read() {
                    Ok(event) => translated(event),
                    Err(error) => Some(Message::InputLost(error)),
                },
                Ok(false) => None,
                Err(error) => Some(Message::InputLost(error)),
            };
            let signal = signals.take().map(Message::Signal);
            for message in [message, signal].into_iter().flatten() {
                let lost = matches!(message, Message::InputLost(_));
                if to.send(message).is_err() || lost {
                    return;
                }
            }
        }
    });
}

fn translated(event: event::Event) -> Option<Message> {
    let event = match event {
        // Some terminals tell of releases too.
        event::Event::Key(key) if key.kind != KeyEventKind::Release => Event::Key(key),
        event::Event::Paste(text) => Event::Paste(text),
        event::Event::Resize(columns, rows) => Event::Resize(columns, rows),
        _ => return None,
    };
    Some(Message::Input(event))
}
