//! Cells as a ratatui widget.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::widgets::Widget;

use super::cells::{Cells, Ink};

/// Draws cells into the middle of its area; what does not fit is cut off, what is left over stays as it was.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    cells: &'a Cells,
}

impl<'a> Picture<'a> {
    /// Draws `cells`.
    #[must_use]
    pub fn new(cells: &'a Cells) -> Self {
        Self { cells }
    }
}

impl Widget for Picture<'_> {
    fn render(self, area: Rect, buffer: &mut Buffer) {
        let area = area.intersection(buffer.area);
        let left = area.x + area.width.saturating_sub(self.cells.columns) / 2;
        let top = area.y + area.height.saturating_sub(self.cells.rows) / 2;
        for (y, row) in (top..area.bottom()).zip(0..self.cells.rows) {
            for (x, cell) in (left..area.right()).zip(self.cells.row(row)) {
                let style = Style::reset().fg(color(cell.fg)).bg(color(cell.bg));
                if let Some(place) = buffer.cell_mut((x, y)) {
                    place.set_char(cell.symbol).set_style(style);
                }
            }
        }
    }
}

/// The colour as ratatui names it.
fn color(ink: Ink) -> Color {
    match ink {
        Ink::Default => Color::Reset,
        Ink::Rgb([r, g, b]) => Color::Rgb(r, g, b),
        Ink::Indexed(index) | Ink::Named(index) => Color::Indexed(index),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::{ColorMode, symbols};
    use crate::shade::Image;

    /// Two cells: white over black, then grey.
    fn cells(mode: ColorMode) -> Cells {
        let image = Image {
            width: 2,
            height: 2,
            pixels: vec![[255; 3], [128; 3], [0; 3], [128; 3]],
        };
        Cells::of(&image, 2, 1, symbols("half").unwrap(), mode)
    }

    fn drawn(cells: &Cells, area: Rect) -> Buffer {
        let mut buffer = Buffer::filled(Rect::new(0, 0, 4, 3), ratatui::buffer::Cell::new("·"));
        Picture::new(cells).render(area, &mut buffer);
        buffer
    }

    #[test]
    fn cells_are_drawn_in_the_middle_with_their_colours() {
        let mut expected = Buffer::with_lines(["····", "·▄ ·", "····"]);
        let (white, black) = (Color::Rgb(255, 255, 255), Color::Rgb(0, 0, 0));
        expected[(1, 1)].set_style(Style::reset().fg(black).bg(white));
        let grey = Color::Rgb(128, 128, 128);
        expected[(2, 1)].set_style(Style::reset().bg(grey));
        assert_eq!(
            drawn(&cells(ColorMode::True), Rect::new(0, 0, 4, 3)),
            expected
        );
    }

    #[test]
    fn without_colour_characters_stand_for_brightness() {
        let expected = Buffer::with_lines(["····", "·#=·", "····"]);
        assert_eq!(
            drawn(&cells(ColorMode::None), Rect::new(0, 0, 4, 3)),
            expected
        );
    }

    #[test]
    fn what_does_not_fit_is_cut_off() {
        let expected = Buffer::with_lines(["····", "····", "···#"]);
        assert_eq!(
            drawn(&cells(ColorMode::None), Rect::new(3, 2, 9, 9)),
            expected
        );
        assert_eq!(
            drawn(&cells(ColorMode::None), Rect::new(9, 9, 2, 2)),
            Buffer::with_lines(["····"; 3])
        );
    }
}
