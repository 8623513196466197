//! Symbols: how many blocks of its own colour a character cell is cut into.
//!
//! ```text
//!   solid   half   quadrant  sextant  octant      ascii
//!   ┌──┐    ┌──┐    ┌─┬─┐    ┌─┬─┐    ┌─┬─┐
//!   │  │    │  │    │ │ │    ├─┼─┤    ├─┼─┤        .:-=+*#%@
//!   │  │    ├──┤    ├─┼─┤    │ │ │    ├─┼─┤
//!   │  │    │  │    │ │ │    ├─┼─┤    ├─┼─┤
//!   └──┘    └──┘    └─┴─┘    └─┴─┘    └─┴─┘
//! ```
//!
//! A cell is taken to be twice as high as wide, as it is in nearly every terminal font.
//!
//! **Source:** the Unicode blocks "Block Elements" and "Symbols for Legacy Computing" with its supplement.

use ratatui::symbols::pixel::{OCTANTS, QUADRANTS, SEXTANTS};

use crate::registry::ChoiceError;

use super::ColorMode;

/// A row of the symbol registry.
#[derive(Debug, Clone, Copy)]
pub struct Symbols {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Blocks of a cell from left to right.
    pub(super) across: usize,
    /// Blocks of a cell from top to bottom.
    pub(super) down: usize,
    /// The character for each set of blocks in the foreground colour: bit `i` is block `i`, row by row from the upper
    /// left; empty where characters stand for brightness instead.
    pub(super) glyphs: &'static [char],
}

/// All symbols, in the order in which they are listed and stepped through.
pub const SYMBOLS: &[Symbols] = &[
    Symbols {
        name: "half",
        about: "Two blocks a cell, one above the other: square pixels in every font.",
        across: 1,
        down: 2,
        glyphs: &[' ', '▀', '▄', '█'],
    },
    Symbols {
        name: "quadrant",
        about: "Four blocks in two colours a cell; in nearly every font.",
        across: 2,
        down: 2,
        glyphs: &QUADRANTS,
    },
    Symbols {
        name: "sextant",
        about: "Six blocks in two colours a cell; needs a font with Unicode 13.",
        across: 2,
        down: 3,
        glyphs: &SEXTANTS,
    },
    Symbols {
        name: "octant",
        about: "Eight blocks in two colours a cell, the finest; needs a font with Unicode 16.",
        across: 2,
        down: 4,
        glyphs: &OCTANTS,
    },
    Symbols {
        name: "solid",
        about: "One colour a cell: the least to send.",
        across: 1,
        down: 1,
        glyphs: &[' ', '█'],
    },
    Symbols {
        name: "ascii",
        about: "Characters from thin to dense for dark to bright: readable without any colour.",
        across: 1,
        down: 1,
        glyphs: &[],
    },
];

/// Characters from dark to bright on a dark terminal.
pub(super) const RAMP: [char; 10] = [' ', '.', ':', '-', '=', '+', '*', '#', '%', '@'];

impl Symbols {
    /// Whether characters stand for brightness.
    #[must_use]
    pub fn is_ramp(&self) -> bool {
        self.glyphs.is_empty()
    }

    /// What is drawn in `mode` where these are asked for: without colours characters, whatever the symbols.
    #[must_use]
    pub fn drawn_in(self, mode: ColorMode) -> Self {
        if mode == ColorMode::None {
            SYMBOLS[5]
        } else {
            self
        }
    }

    /// One colour a cell.
    pub(super) fn solid() -> Self {
        SYMBOLS[4]
    }

    /// Blocks of a cell.
    pub(super) fn blocks(&self) -> usize {
        self.across * self.down
    }
}

impl Default for Symbols {
    /// Half blocks.
    fn default() -> Self {
        SYMBOLS[0]
    }
}

impl PartialEq for Symbols {
    /// Names are unique.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Symbols {}

/// The symbols of that name.
///
/// # Errors
/// There are none; the message names the nearest.
pub fn symbols(name: &str) -> Result<&'static Symbols, ChoiceError> {
    SYMBOLS
        .iter()
        .find(|row| row.name == name)
        .ok_or_else(|| ChoiceError::unknown("symbols", name, SYMBOLS.iter().map(|row| row.name)))
}

/// Width and height of the image to render for `columns` by `rows` cells: square pixels, so that nothing is stretched,
/// and no fewer than the cells have blocks.
#[must_use]
pub fn pixel_size(columns: u16, rows: u16, symbols: &Symbols) -> (u32, u32) {
    let across = symbols.across as u32;
    (u32::from(columns) * across, u32::from(rows) * across * 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_of_blocks_has_a_character_of_its_own() {
        for row in SYMBOLS.iter().filter(|row| !row.is_ramp()) {
            let distinct: std::collections::HashSet<_> = row.glyphs.iter().collect();
            assert_eq!(distinct.len(), 1 << row.blocks(), "{}", row.name);
            assert_eq!(row.glyphs[0], ' ');
            assert_eq!(row.glyphs[row.glyphs.len() - 1], '█');
        }
    }

    #[test]
    fn names_are_unique_and_descriptions_are_sentences() {
        for (i, row) in SYMBOLS.iter().enumerate() {
            assert!(SYMBOLS[..i].iter().all(|other| other != row));
            assert!(row.about.ends_with('.'));
            assert_eq!(symbols(row.name).unwrap(), row);
        }
        assert_eq!(
            (Symbols::default().name, Symbols::solid().name),
            ("half", "solid")
        );
        assert!(symbols("octan").unwrap_err().to_string().contains("octant"));
    }

    #[test]
    fn pixels_are_square_and_there_is_one_for_each_block() {
        for row in SYMBOLS {
            let (width, height) = pixel_size(80, 24, row);
            // 80 cells are 80 units wide, 24 cells 48 units high.
            assert_eq!(width * 48, height * 80, "{}", row.name);
            assert!(width as usize >= 80 * row.across && height as usize >= 24 * row.down);
        }
    }
}
