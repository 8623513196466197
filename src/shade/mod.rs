//! Images: which colour a pixel has, and no more model than the scene needs.
//!
//! ```text
//!   View (scene, camera, accelerator, channel, size)
//!     |  rays in tiles, in the rayon pool of the caller
//!     v
//!   Channel ── colours of pixels ──────────────────────────┐
//!     └─────── numbers of pixels ── Legend (range, map) ───┴──> Rendered { image, legend, stats }
//! ```
//!
//! A channel is one row of [`CHANNELS`] and one file. Rendering is pure: the same view gives the same bytes, whatever
//! the thread count. Nothing here knows of time, files or terminals.
//!
//! To add a channel: a file here that says what a tile of rays shows, and a row in [`CHANNELS`].

mod channel;
mod color;
mod color_map;
mod depth;
mod id;
mod image;
mod legend;
mod light;
mod model;
mod normal;
mod render;
mod scatter;
mod shadow;
mod work;

pub use channel::{CHANNELS, Channel, channel};
pub use color_map::{ColorMap, GREY, INFERNO};
pub use image::{Image, ImageError, parse_size, to_linear, to_srgb};
pub use legend::{Legend, Scale};
pub use render::{PASSES, Pass, RayCounts, RenderStats, Rendered, View, render};
