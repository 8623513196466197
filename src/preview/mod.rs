//! Images as terminal cells: symbols, colours, and the two places they go to, standard output and ratatui.
//!
//! ```text
//!   Image ──area average──> blocks of a cell ──two-colour fit──> symbol + two colours ──quantised──> Cells
//!                                                                          to_ansi (render) <───┤
//!                                                                    Picture (a widget) <───────┘
//! ```
//!
//! Colours are quantised here, before anything is compared with what a terminal already shows, so a still picture sends
//! nothing. Everything is deterministic; nothing here asks the terminal or the clock.

mod ansi;
mod cells;
mod color_mode;
mod fit;
mod legend_bar;
mod palette;
mod png_file;
mod sample;
mod symbols;
mod widget;

pub use ansi::to_ansi;
pub use cells::{Cell, Cells, Ink};
pub use color_mode::{COLOR_MODES, ColorMode, ColorModeEntry};
pub use legend_bar::legend_bar;
pub use palette::{nearest_16, nearest_256};
pub use png_file::{PictureError, write_png};
pub use symbols::{SYMBOLS, Symbols, pixel_size, symbols};
pub use widget::Picture;
