//! Channels: what a picture shows.

use crate::geometry::Ray;
use crate::registry::ChoiceError;

use super::legend::Ramp;
use super::render::{RayCounts, View};
use super::{color, depth, id, normal, work};

/// A row of the channel registry.
#[derive(Debug, Clone, Copy)]
pub struct Channel {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Prepares the channel for a view.
    pub(super) paint: for<'a> fn(&View<'a>) -> Painter<'a>,
}

impl PartialEq for Channel {
    /// Names are unique.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Channel {}

/// All channels, in the order in which they are listed and stepped through.
pub const CHANNELS: &[Channel] = &[
    color::CHANNEL,
    id::CHANNEL,
    depth::CHANNEL,
    normal::CHANNEL,
    work::CELLS,
    work::TESTS,
];

/// The channel of that name.
///
/// # Errors
/// There is none; the message names the nearest.
pub fn channel(name: &str) -> Result<&'static Channel, ChoiceError> {
    CHANNELS
        .iter()
        .find(|row| row.name == name)
        .ok_or_else(|| ChoiceError::unknown("channel", name, CHANNELS.iter().map(|row| row.name)))
}

/// What a tile of rays shows, pixel by pixel; counts every ray that it traces.
type Tile<'a, T> = Box<dyn Fn(&[Ray], &mut RayCounts) -> Vec<T> + Sync + 'a>;

/// What a channel does with tiles of rays.
pub(super) enum Painter<'a> {
    /// Each pixel has its colour.
    Colours {
        /// sRGB of each ray's pixel.
        tile: Tile<'a, [u8; 3]>,
        /// What the scene was found to need.
        found: String,
    },
    /// Each pixel has a number, and colours follow from the range of all of them.
    Numbers {
        /// The number of each ray's pixel, NaN for the background.
        tile: Tile<'a, f32>,
        /// How numbers become colours.
        ramp: Ramp,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_kebab_case_and_descriptions_are_sentences() {
        for (i, row) in CHANNELS.iter().enumerate() {
            assert!(row.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'));
            assert!(CHANNELS[..i].iter().all(|other| other.name != row.name));
            assert!(row.about.ends_with('.') && row.about.starts_with(char::is_uppercase));
        }
    }

    #[test]
    fn a_misspelt_channel_is_answered_with_the_nearest() {
        assert_eq!(channel("depth").unwrap().name, "depth");
        let message = channel("dept").unwrap_err().to_string();
        assert!(message.contains("did you mean 'depth'?"), "{message}");
    }
}
