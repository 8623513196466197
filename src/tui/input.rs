//! The input thread waits for keys and wakes the UI thread at once; the signal thread does the same for signals.
//!
//! Two threads, because a terminal that has gone away can hold the first one inside the terminal library for ever: the
//! signal that tells of it must still be heard.

use std::sync::mpsc::Sender;
use std::thread;
use std::time::Duration;

use crossterm::event::{self, KeyEventKind};

use super::app::Message;
use super::signals::Signals;
use super::update::Event;

/// How often signals are looked at.
const GLANCE: Duration = Duration::from_millis(100);

/// Starts both threads. They end with the channel; the first one also when the terminal is gone.
pub(super) fn spawn(signals: Signals, to: Sender<Message>) {
    let keys = to.clone();
    thread::spawn(move || {
        loop {
            let message = match event::read() {
                Ok(event) => translated(event),
                Err(error) => Some(Message::InputLost(error)),
            };
            if let Some(message) = message {
                let lost = matches!(message, Message::InputLost(_));
                if keys.send(message).is_err() || lost {
                    return;
                }
            }
        }
    });
    thread::spawn(move || {
        loop {
            thread::sleep(GLANCE);
            if let Some(signal) = signals.take()
                && to.send(Message::Signal(signal)).is_err()
            {
                return;
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
