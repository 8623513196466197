//! Cells as text with escape codes, for standard output.
//!
//! **Source:** ECMA-48 §8.3.117 (SGR) and ISO 8613-6 for the extended colours.

use std::fmt::Write as _;

use super::cells::{Cells, Ink};

/// The rows of `cells`, each ended by a line feed.
///
/// A run of equal colours shares one escape code, every line ends in the terminal's own colours, and cells without
/// colour give text without any escape code.
#[must_use]
pub fn to_ansi(cells: &Cells) -> String {
    let mut text = String::new();
    for row in 0..cells.rows {
        // A line begins in the terminal's own colours.
        let (mut fg, mut bg) = (Ink::Default, Ink::Default);
        for cell in cells.row(row) {
            // A space shows no foreground: whatever is set may stay.
            let wanted_fg = if cell.symbol == ' ' { fg } else { cell.fg };
            let mut codes: Vec<String> = Vec::new();
            if wanted_fg != fg {
                codes.push(code(wanted_fg, false));
                fg = wanted_fg;
            }
            if cell.bg != bg {
                codes.push(code(cell.bg, true));
                bg = cell.bg;
            }
            if !codes.is_empty() {
                // Writing to a string cannot fail.
                let _ = write!(text, "\x1b[{}m", codes.join(";"));
            }
            text.push(cell.symbol);
        }
        if (fg, bg) != (Ink::Default, Ink::Default) {
            text.push_str("\x1b[0m");
        }
        text.push('\n');
    }
    text
}

/// The parameters that set a colour.
fn code(ink: Ink, background: bool) -> String {
    let base = if background { 10 } else { 0 };
    match ink {
        Ink::Default => format!("{}", 39 + base),
        Ink::Rgb([r, g, b]) => format!("{};2;{r};{g};{b}", 38 + base),
        Ink::Indexed(index) => format!("{};5;{index}", 38 + base),
        Ink::Named(index @ 0..8) => format!("{}", 30 + base + index),
        Ink::Named(index) => format!("{}", 90 + base + index % 8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::cells::Cell;
    use crate::preview::{ColorMode, SYMBOLS};
    use crate::shade::Image;

    const RED: Ink = Ink::Rgb([255, 0, 0]);

    fn line(cells: &[Cell]) -> String {
        to_ansi(&Cells {
            columns: cells.len() as u16,
            rows: 1,
            cells: cells.to_vec(),
        })
    }

    #[test]
    fn a_run_of_equal_colours_shares_one_escape_code_and_the_line_ends_plain() {
        let cell = Cell {
            symbol: '▄',
            fg: RED,
            bg: Ink::Named(9),
        };
        let blank = Cell {
            symbol: ' ',
            fg: Ink::Default,
            bg: Ink::Named(9),
        };
        assert_eq!(
            line(&[cell, blank, cell]),
            "\x1b[38;2;255;0;0;101m▄ ▄\x1b[0m\n"
        );
    }

    #[test]
    fn colours_change_back_to_the_terminals_own() {
        let cell = Cell {
            symbol: 'x',
            fg: Ink::Indexed(196),
            bg: Ink::Default,
        };
        assert_eq!(
            line(&[cell, Cell::plain('y')]),
            "\x1b[38;5;196mx\x1b[39my\n"
        );
    }

    #[test]
    fn without_colour_there_is_no_escape_byte() {
        let pixels = (0..=255).map(|x| [x, 255 - x, x / 2]).collect();
        let image = Image {
            width: 16,
            height: 16,
            pixels,
        };
        for row in SYMBOLS {
            let text = to_ansi(&Cells::of(&image, 8, 4, row, ColorMode::None));
            assert!(text.is_ascii() && !text.contains('\x1b'), "{text:?}");
            assert_eq!(text.lines().map(str::len).collect::<Vec<_>>(), [8; 4]);
        }
    }
}
