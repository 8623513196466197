//! raylab: architecture page comes with the rooms.

pub mod accel;
pub mod geometry;
pub mod kernel;
pub mod lab;
pub mod oracle;
pub mod preview;
pub mod registry;
pub mod report;
pub mod scene;
pub mod shade;
pub mod stats;
pub mod trace;
pub mod tui;
