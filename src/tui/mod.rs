//! The terminal lab: pure state, update, view.
