//! A desk with room for one request: a newer one takes the place of an older one, and ends the work on it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

#[derive(Debug)]
struct Shared<T> {
    next: Mutex<Option<T>>,
    came: Condvar,
    /// The request in work is out of date.
    cancel: AtomicBool,
}

/// Shared by who asks and the thread that works.
#[derive(Debug)]
pub(super) struct Desk<T> {
    shared: Arc<Shared<T>>,
}

impl<T> Default for Desk<T> {
    fn default() -> Self {
        Self {
            shared: Arc::new(Shared {
                next: Mutex::new(None),
                came: Condvar::new(),
                cancel: AtomicBool::new(false),
            }),
        }
    }
}

impl<T> Clone for Desk<T> {
    fn clone(&self) -> Self {
        Self {
            shared: Arc::clone(&self.shared),
        }
    }
}

impl<T> Desk<T> {
    /// Asks for something instead of what is in work.
    pub(super) fn ask(&self, request: T) {
        let mut next = (self.shared.next.lock()).unwrap_or_else(PoisonError::into_inner);
        *next = Some(request);
        self.shared.cancel.store(true, Ordering::Relaxed);
        self.shared.came.notify_one();
    }

    /// The next request, waited for.
    pub(super) fn wait(&self) -> T {
        let shared = &self.shared;
        let mut next = shared.next.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if let Some(request) = next.take() {
                shared.cancel.store(false, Ordering::Relaxed);
                return request;
            }
            next = (shared.came.wait(next)).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Says whether a newer request came.
    pub(super) fn cancel(&self) -> &AtomicBool {
        &self.shared.cancel
    }

    /// Whether a newer request came.
    pub(super) fn cancelled(&self) -> bool {
        self.shared.cancel.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_request_is_served_and_ends_the_work_on_the_one_before() {
        let desk = Desk::default();
        desk.ask(1);
        desk.ask(2);
        assert_eq!(desk.wait(), 2);
        assert!(!desk.cancelled());
        desk.clone().ask(3);
        assert!(desk.cancelled());
        assert_eq!(desk.wait(), 3);
    }
}
