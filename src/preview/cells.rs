//! Terminal cells: a character and two colours each.

use crate::shade::{Image, to_linear};

use super::ColorMode;
use super::fit::fit;
use super::palette::{five_bits, nearest_16, nearest_256, nearest_shade};
use super::sample::resampled;
use super::symbols::{RAMP, Symbols};

/// A colour as a terminal is told it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Ink {
    /// The terminal's own.
    #[default]
    Default,
    /// 24 bits.
    Rgb([u8; 3]),
    /// An entry from 16 to 255 of the 256-colour palette.
    Indexed(u8),
    /// One of the sixteen named colours, 0–15.
    Named(u8),
}

impl Ink {
    /// `colour` as `mode` can show it.
    pub(super) fn of(colour: [u8; 3], mode: ColorMode) -> Self {
        match mode {
            ColorMode::True => Self::Rgb(colour),
            ColorMode::Ansi256 => Self::Indexed(nearest_256(colour)),
            ColorMode::Ansi16 => Self::Named(nearest_16(colour)),
            ColorMode::None => Self::Default,
        }
    }
}

/// One character cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// One column wide.
    pub symbol: char,
    /// Foreground.
    pub fg: Ink,
    /// Background.
    pub bg: Ink,
}

impl Cell {
    /// A character in the terminal's own colours.
    pub(super) const fn plain(symbol: char) -> Self {
        Self {
            symbol,
            fg: Ink::Default,
            bg: Ink::Default,
        }
    }
}

/// Rows of cells, the upper left one first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cells {
    /// Cells in a row.
    pub columns: u16,
    /// Rows.
    pub rows: u16,
    /// `columns · rows` cells.
    pub cells: Vec<Cell>,
}

impl Cells {
    /// `image` in `columns` by `rows` cells, as well as `symbols` can show it in `mode`.
    ///
    /// Render the image in the size that [`super::pixel_size`] names: then nothing is stretched, and half blocks in
    /// true colour show every pixel exactly. Without colours characters stand for brightness, whatever the symbols, and
    /// with sixteen colours shade characters mix them: blocks of so few colours show outlines only.
    #[must_use]
    pub fn of(image: &Image, columns: u16, rows: u16, symbols: &Symbols, mode: ColorMode) -> Self {
        let (wide, high) = (
            usize::from(columns) * symbols.across,
            usize::from(rows) * symbols.down,
        );
        let one_each = || resampled(image, usize::from(columns), usize::from(rows)).into_iter();
        let cells = if symbols.drawn_in(mode).is_ramp() {
            one_each().map(|colour| ramp_cell(colour, mode)).collect()
        } else if mode == ColorMode::Ansi16 {
            one_each().map(shade_cell).collect()
        } else {
            let pixels = resampled(image, wide, high);
            let mut cells = Vec::with_capacity(usize::from(columns) * usize::from(rows));
            let mut blocks = Vec::with_capacity(symbols.blocks());
            for row in 0..usize::from(rows) {
                for column in 0..usize::from(columns) {
                    blocks.clear();
                    for y in 0..symbols.down {
                        let start = (row * symbols.down + y) * wide + column * symbols.across;
                        blocks.extend_from_slice(&pixels[start..start + symbols.across]);
                    }
                    cells.push(block_cell(&blocks, symbols, mode));
                }
            }
            cells
        };
        Self {
            columns,
            rows,
            cells,
        }
    }

    /// The same with 5 bits a channel instead of 8: about an eighth fewer bytes to send, hardly a difference to see.
    /// Palette colours stay as they are.
    #[must_use]
    pub fn coarsened(mut self) -> Self {
        let coarse = |ink: Ink| match ink {
            Ink::Rgb(colour) => Ink::Rgb(five_bits(colour)),
            other => other,
        };
        for cell in &mut self.cells {
            // Only true colours change. Characters that stand for brightness have no ink, or no ground, of that kind.
            if let (Ink::Rgb(_), Ink::Rgb(_)) = (cell.fg, cell.bg) {
                *cell = two_inks(cell.symbol, coarse(cell.fg), coarse(cell.bg));
            } else {
                (cell.fg, cell.bg) = (coarse(cell.fg), coarse(cell.bg));
            }
        }
        self
    }

    /// The cells of a row, none where there is no such row.
    #[must_use]
    pub fn row(&self, row: u16) -> &[Cell] {
        let columns = usize::from(self.columns);
        self.cells
            .get(usize::from(row) * columns..(usize::from(row) + 1) * columns)
            .unwrap_or_default()
    }
}

/// The cell whose blocks have these colours.
fn block_cell(blocks: &[[u8; 3]], symbols: &Symbols, mode: ColorMode) -> Cell {
    let fit = fit(blocks);
    two_inks(
        symbols.glyphs[fit.pattern],
        Ink::of(fit.fg, mode),
        Ink::of(fit.bg, mode),
    )
}

/// A block character, or a space where both colours became the same: each look has one way to be written.
fn two_inks(symbol: char, fg: Ink, bg: Ink) -> Cell {
    if fg == bg || symbol == ' ' {
        Cell {
            symbol: ' ',
            fg: Ink::Default,
            bg,
        }
    } else {
        Cell { symbol, fg, bg }
    }
}

/// The character for a colour's brightness, in that colour where the mode has any.
fn ramp_cell(colour: [u8; 3], mode: ColorMode) -> Cell {
    let symbol = RAMP[ramp_step(colour)];
    let fg = if symbol == ' ' {
        Ink::Default
    } else {
        Ink::of(colour, mode)
    };
    Cell {
        symbol,
        fg,
        bg: Ink::Default,
    }
}

/// The mixture of named colours that looks like `colour`.
fn shade_cell(colour: [u8; 3]) -> Cell {
    let shade = nearest_shade(colour);
    two_inks(shade.symbol, Ink::Named(shade.fg), Ink::Named(shade.bg))
}

/// Lightness up to which a cell stays empty: the grounds of scenes, which would only distract as a field of dots.
const EMPTY: f32 = 0.23;

/// Which of the ramp's characters is as bright: equal steps of lightness (CIE L*), which the eye sees as equal.
fn ramp_step(colour: [u8; 3]) -> usize {
    let [r, g, b] = to_linear(colour).to_array();
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let lightness = if luminance > 0.008_856 {
        1.16 * luminance.cbrt() - 0.16
    } else {
        9.033 * luminance
    };
    let place = (lightness - EMPTY) / (1.0 - EMPTY);
    // Below 0 the nearest integer is 0.
    ((place * RAMP.len() as f32).ceil() as usize).min(RAMP.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Accelerator;
    use crate::geometry::Vec3;
    use crate::preview::{SYMBOLS, pixel_size, symbols};
    use crate::shade::{View, render};

    /// A round, shaded thing on a dark ground with a hard edge, in `width` by `height` pixels.
    fn ball(width: u32, height: u32) -> Image {
        let pixels = (0..width * height)
            .map(|i| {
                let at = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
                let (x, y) = (at(i % width, width), at(i / width, height));
                let r2 = x * x + y * y;
                if r2 > 0.7 {
                    return [30, 34, 44];
                }
                let light = (1.0 - r2).sqrt() * 0.7 - 0.3 * (x + y) * 0.7;
                [220.0, 150.0, 90.0].map(|c: f64| (c * light.clamp(0.0, 1.0)) as u8)
            })
            .collect();
        Image {
            width,
            height,
            pixels,
        }
    }

    fn built(scene: &crate::scene::Scene) -> Box<dyn Accelerator> {
        let accel = crate::accel::parse("bvh").unwrap();
        let kernel = crate::kernel::parse("moller-trumbore").unwrap();
        crate::accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX).unwrap()
    }

    fn picture(
        scene: &crate::scene::Scene,
        accel: &dyn Accelerator,
        channel: &str,
        width: u32,
        height: u32,
    ) -> Image {
        let view = View {
            scene,
            camera: &scene.camera,
            accel,
            channel: crate::shade::channel(channel).unwrap(),
            width,
            height,
        };
        render(&view).image
    }

    /// A rendered picture: curved surfaces, edges, and a handle that is thin.
    fn teapot(width: u32, height: u32) -> Image {
        let scene = crate::scene::load("teapot:6").unwrap();
        picture(&scene, &*built(&scene), "color", width, height)
    }

    /// The picture that true-colour cells show, in the pixels of `image`'s size.
    fn shown(cells: &Cells, symbols: &Symbols, width: u32, height: u32) -> Vec<[u8; 3]> {
        let rgb = |ink| match ink {
            Ink::Rgb(colour) => colour,
            other => panic!("{other:?} is not a true colour"),
        };
        (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width) as usize, (i / width) as usize);
                let across = usize::from(cells.columns) * symbols.across;
                let down = usize::from(cells.rows) * symbols.down;
                let (bx, by) = (x * across / width as usize, y * down / height as usize);
                let (column, row) = (bx / symbols.across, by / symbols.down);
                let cell = cells.row(row as u16)[column];
                let block = by % symbols.down * symbols.across + bx % symbols.across;
                let pattern = symbols
                    .glyphs
                    .iter()
                    .position(|&g| g == cell.symbol)
                    .unwrap();
                rgb(if pattern >> block & 1 == 1 {
                    cell.fg
                } else {
                    cell.bg
                })
            })
            .collect()
    }

    fn psnr(image: &Image, symbols: &Symbols) -> f64 {
        let cells = Cells::of(image, 40, 20, symbols, ColorMode::True);
        let shown = shown(&cells, symbols, image.width, image.height);
        let squares: f64 = (image.pixels.iter().flatten().zip(shown.iter().flatten()))
            .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
            .sum();
        let mean = squares / (3.0 * image.pixels.len() as f64);
        10.0 * (255.0_f64.powi(2) / mean).log10()
    }

    #[test]
    fn finer_symbols_show_a_picture_better() {
        let image = teapot(320, 320);
        let order = ["solid", "half", "quadrant", "sextant", "octant"];
        let quality = order.map(|name| psnr(&image, symbols(name).unwrap()));
        assert!(quality.is_sorted(), "{quality:?}");
        assert!(quality[4] > quality[0] + 2.0, "{quality:?}");
    }

    #[test]
    fn half_blocks_in_true_colour_show_every_pixel_exactly() {
        let half = symbols("half").unwrap();
        let (width, height) = pixel_size(40, 20, half);
        let image = ball(width, height);
        let cells = Cells::of(&image, 40, 20, half, ColorMode::True);
        assert_eq!(shown(&cells, half, width, height), image.pixels);
    }

    #[test]
    fn each_mode_uses_its_own_inks_and_256_none_that_terminals_redefine() {
        let image = ball(80, 80);
        for row in SYMBOLS {
            for (mode, is) in [
                (
                    ColorMode::True,
                    (|ink| matches!(ink, Ink::Rgb(_))) as fn(Ink) -> bool,
                ),
                (ColorMode::Ansi256, |ink| matches!(ink, Ink::Indexed(16..))),
                (ColorMode::Ansi16, |ink| matches!(ink, Ink::Named(0..16))),
                (ColorMode::None, |_| false),
            ] {
                let cells = Cells::of(&image, 20, 10, row, mode).cells;
                assert!(
                    cells
                        .iter()
                        .flat_map(|c| [c.fg, c.bg])
                        .all(|ink| ink == Ink::Default || is(ink))
                );
            }
        }
    }

    #[test]
    fn without_colour_brighter_is_denser() {
        let steps: Vec<usize> = (0..=255).map(|x| ramp_step([x; 3])).collect();
        assert!(steps.is_sorted());
        assert_eq!((steps[0], steps[255]), (0, RAMP.len() - 1));
        let half = symbols("half").unwrap();
        let none = Cells::of(&ball(80, 80), 20, 10, half, ColorMode::None);
        let used: std::collections::BTreeSet<_> = none.cells.iter().map(|c| c.symbol).collect();
        assert!(used.len() >= 4, "{used:?}");
        assert!(none.cells.iter().all(|c| RAMP.contains(&c.symbol)));
    }

    /// A ball of unit radius seen from the front, and nothing else.
    fn ball_scene() -> crate::scene::Scene {
        let (around, rings) = (48, 24);
        let vertices = (0..=rings * around)
            .map(|i| {
                let polar = (i / around) as f32 / rings as f32 * std::f32::consts::PI;
                let angle = (i % around) as f32 / around as f32 * std::f32::consts::TAU;
                Vec3::new(
                    polar.sin() * angle.cos(),
                    polar.cos(),
                    polar.sin() * angle.sin(),
                )
            })
            .collect();
        let triangles = (0..(rings - 1) * around)
            .flat_map(|i| [[i, i + 1, i + around], [i + 1, i + around + 1, i + around]])
            .collect();
        let mesh = crate::scene::Mesh::new(vertices, triangles).unwrap();
        let mut scene = crate::scene::load("one").unwrap();
        scene.material_of = vec![0; mesh.len()];
        scene.mesh = mesh.into();
        scene.camera.eye = Vec3::Z * 5.0;
        scene.camera.at = Vec3::ZERO;
        scene.background = Vec3::ZERO;
        scene
    }

    #[test]
    fn a_ball_is_round_with_all_symbols() {
        let scene = ball_scene();
        let accel = built(&scene);
        for symbols in SYMBOLS {
            let (width, height) = pixel_size(72, 30, symbols);
            let image = picture(&scene, &*accel, "normal", width, height);
            let cells = Cells::of(&image, 72, 30, symbols, ColorMode::True);
            let lit = |cell: &Cell| {
                [cell.fg, cell.bg]
                    .iter()
                    .any(|ink| !matches!(ink, Ink::Default | Ink::Rgb([0, 0, 0])))
            };
            let in_column = |x: u16| (0..30).any(|y| lit(&cells.row(y)[usize::from(x)]));
            let wide = (0..72).filter(|&x| in_column(x)).count();
            let high = (0..30).filter(|&y| cells.row(y).iter().any(lit)).count();
            // A cell is twice as high as wide; the ball ends within a cell on each side.
            assert!(
                wide.abs_diff(2 * high) <= 2,
                "{}: {wide} by {high}",
                symbols.name
            );
            assert!(wide > 20);
        }
    }

    #[test]
    fn equal_colours_are_written_as_a_space() {
        let grey = Image::filled(4, 4, [100; 3]);
        for row in SYMBOLS.iter().filter(|row| !row.is_ramp()) {
            let cells = Cells::of(&grey, 2, 1, row, ColorMode::True);
            let bg = Ink::Rgb([100; 3]);
            assert!(cells.cells.iter().all(|c| *c
                == Cell {
                    bg,
                    ..Cell::plain(' ')
                }));
        }
    }

    #[test]
    fn coarsening_keeps_characters_that_stand_for_brightness() {
        let image = Image::filled(1, 2, [200; 3]);
        for mode in [ColorMode::None, ColorMode::Ansi16, ColorMode::Ansi256] {
            let cells = Cells::of(&image, 1, 1, &Symbols::default(), mode);
            assert_eq!(cells.clone().coarsened(), cells);
        }
    }

    #[test]
    fn coarsening_merges_colours_that_differ_by_little() {
        let mut image = Image::filled(1, 2, [100; 3]);
        image.pixels[1] = [102; 3];
        let cells = Cells::of(&image, 1, 1, symbols("half").unwrap(), ColorMode::True);
        assert_eq!(cells.cells[0].symbol, '▄');
        assert_eq!(cells.coarsened().cells[0].symbol, ' ');
    }
}
