//! The legend of a heat map as one line of cells.
//!
//! ```text
//!   cells per ray  1 ░░░░│▒▒▒▒▒▒▓▓▓▓▓▓▓███████ 92  median 14, log scale
//!                      └ the median
//! ```

use crate::shade::Legend;

use super::ColorMode;
use super::cells::{Cell, Cells, Ink};
use super::symbols::Symbols;
use crate::shade::Image;

/// Fewest columns of a bar that still shows a range.
const LEAST_BAR: usize = 8;

/// `legend` in one row of `columns` cells: title, range, bar and median, of which the narrower line leaves out the last
/// part, then the title. Empty cells where not even the range fits.
#[must_use]
pub fn legend_bar(legend: &Legend, columns: u16, mode: ColorMode) -> Cells {
    let columns = usize::from(columns);
    let [min, median, max] = legend.labels();
    let (start, end) = (format!("{min} "), format!(" {max}"));
    let title = format!("{}  ", legend.title);
    let note = format!("  median {median}, {}", legend.scale);
    let chars = |text: &str| text.chars().count();
    let range = chars(&start) + chars(&end) + LEAST_BAR;
    let with_note = range + chars(&note);
    let with_title = with_note + chars(&title);
    let mut parts = [start.as_str(), end.as_str()].map(str::to_owned);
    if with_title <= columns {
        parts[0].insert_str(0, &title);
    }
    if with_note <= columns {
        parts[1].push_str(&note);
    }
    let mut cells: Vec<Cell> = Vec::with_capacity(columns);
    if range <= columns {
        let bar = columns - chars(&parts[0]) - chars(&parts[1]);
        cells.extend(parts[0].chars().map(Cell::plain));
        cells.extend(gradient(legend, bar.min(MOST_BAR), mode));
        cells.extend(parts[1].chars().map(Cell::plain));
    }
    cells.resize(columns, Cell::plain(' '));
    Cells {
        columns: columns as u16,
        rows: 1,
        cells,
    }
}

/// Most columns of a bar: beyond that it says no more.
const MOST_BAR: usize = 48;

/// The colours from the least to the greatest number, with a mark at the median.
fn gradient(legend: &Legend, columns: usize, mode: ColorMode) -> Vec<Cell> {
    let middle = |i: usize| (i as f32 + 0.5) / columns as f32;
    let image = Image {
        width: columns as u32,
        height: 1,
        pixels: (0..columns).map(|i| legend.colour_at(middle(i))).collect(),
    };
    let symbols = Symbols::solid();
    let mut cells = Cells::of(&image, columns as u16, 1, &symbols, mode).cells;
    let marked = ((legend.position(legend.median) * columns as f32) as usize).min(columns - 1);
    if mode == ColorMode::None {
        cells[marked] = Cell::plain('|');
    } else {
        let [r, g, b] = legend.colour_at(middle(marked)).map(u32::from);
        let bright = 2 * r + 5 * g + b > 8 * 110;
        let ink = if bright { [0; 3] } else { [255; 3] };
        cells[marked].symbol = '│';
        cells[marked].fg = Ink::of(ink, mode);
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::to_ansi;
    use crate::shade::{View, channel, render};

    fn legend() -> Legend {
        let scene = crate::scene::load("teapot:2").unwrap();
        let accel = crate::accel::parse("bvh").unwrap();
        let kernel = crate::kernel::parse("moller-trumbore").unwrap();
        let accel = crate::accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX).unwrap();
        let view = View {
            scene: &scene,
            camera: &scene.camera,
            accel: &*accel,
            channel: channel("tests").unwrap(),
            width: 40,
            height: 40,
        };
        render(&view).legend.unwrap()
    }

    fn text(columns: u16) -> String {
        to_ansi(&legend_bar(&legend(), columns, ColorMode::None))
    }

    #[test]
    fn a_wide_line_says_everything() {
        let legend = legend();
        let line = text(100);
        let [min, median, max] = legend.labels();
        assert!(
            line.starts_with(&format!("{}  {min} ", legend.title)),
            "{line}"
        );
        assert!(
            line.contains(&format!(" {max}  median {median}, {}", legend.scale)),
            "{line}"
        );
        assert!(line.contains('|') && line.contains('%'), "{line}");
    }

    #[test]
    fn a_narrow_line_leaves_out_the_title_then_the_median_then_all() {
        assert!(!text(46).contains("tests") && text(46).contains("median"));
        assert!(!text(20).contains("median") && text(20).contains('|'));
        assert_eq!(text(5), "     \n");
        for columns in [0, 1, 10, 30, 60, 200] {
            assert_eq!(
                legend_bar(&legend(), columns, ColorMode::True).cells.len(),
                usize::from(columns)
            );
        }
    }
}
