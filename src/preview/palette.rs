//! Nearest palette entries: 256 colours, 16 colours with shades, 5 bits a channel.
//!
//! Distance is taken in Oklab with hue and chroma weighted twice as much as lightness: among entries that are equally
//! near by brightness, a brown surface that darkens shall not turn green and pink in turn.
//!
//! **Source:** ISO 8613-6 and xterm for the palettes; Ottosson, "A perceptual color space" (2020), for Oklab.

use std::sync::LazyLock;

use crate::geometry::Vec3;
use crate::shade::{to_linear, to_srgb};

/// Levels of the 6 × 6 × 6 cube, entries 16–231.
const LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// The sixteen named colours as xterm shows them; other terminals come close.
const NAMED: [[u8; 3]; 16] = [
    [0, 0, 0],
    [205, 0, 0],
    [0, 205, 0],
    [205, 205, 0],
    [0, 0, 238],
    [205, 0, 205],
    [0, 205, 205],
    [229, 229, 229],
    [127, 127, 127],
    [255, 0, 0],
    [0, 255, 0],
    [255, 255, 0],
    [92, 92, 255],
    [255, 0, 255],
    [0, 255, 255],
    [255, 255, 255],
];

/// Characters that show a foreground over a background, and the foreground's share of the cell.
const SHADES: [(char, f32); 3] = [('░', 0.25), ('▒', 0.5), ('▓', 0.75)];

/// A mixture of two of the sixteen named colours in one cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shade {
    /// A shade character, or a space for the background alone.
    pub symbol: char,
    /// Index of the foreground, 0–15.
    pub fg: u8,
    /// Index of the background, 0–15.
    pub bg: u8,
}

/// `colour` in Oklab, hue and chroma weighted: distances between these are Euclidean.
fn perceived(colour: [u8; 3]) -> Vec3 {
    let [r, g, b] = to_linear(colour).to_array();
    let l = (0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b).cbrt();
    let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
    let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
    let weight = 2.0;
    Vec3::new(
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        weight * (1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s),
        weight * (0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s),
    )
}

/// The index of the nearest of `palette`; the lower of equals.
fn nearest(palette: &[Vec3], colour: [u8; 3]) -> usize {
    let wanted = perceived(colour);
    let (mut best, mut least) = (0, f32::INFINITY);
    for (i, entry) in palette.iter().enumerate() {
        let distance = entry.distance_squared(wanted);
        if distance < least {
            (best, least) = (i, distance);
        }
    }
    best
}

/// The colour of an entry from 16 to 255; black for the others, which differ from terminal to terminal.
fn entry(index: u8) -> [u8; 3] {
    match index {
        0..=15 => [0; 3],
        16..=231 => {
            let i = usize::from(index - 16);
            [LEVELS[i / 36], LEVELS[i / 6 % 6], LEVELS[i % 6]]
        }
        _ => [8 + 10 * (index - 232); 3],
    }
}

/// The entry from 16 to 255 of the 256-colour palette that is nearest to `colour`; the lower of equals.
#[must_use]
pub fn nearest_256(colour: [u8; 3]) -> u8 {
    static PALETTE: LazyLock<Vec<Vec3>> =
        LazyLock::new(|| (16..=255).map(|i| perceived(entry(i))).collect());
    16 + nearest(&PALETTE, colour) as u8
}

/// The one of the sixteen named colours, 0–15, that is nearest to `colour` as xterm shows them; the lower of equals.
#[must_use]
pub fn nearest_16(colour: [u8; 3]) -> u8 {
    static PALETTE: LazyLock<[Vec3; 16]> = LazyLock::new(|| NAMED.map(perceived));
    nearest(&*PALETTE, colour) as u8
}

/// The mixture of named colours that comes nearest to `colour`.
pub(super) fn nearest_shade(colour: [u8; 3]) -> Shade {
    static SHADED: LazyLock<(Vec<Shade>, Vec<Vec3>)> =
        LazyLock::new(|| mixtures().into_iter().unzip());
    let (shades, looks) = &*SHADED;
    shades[nearest(looks, colour)]
}

/// All mixtures of two named colours that do not flicker between light and dark, and how they look from afar.
fn mixtures() -> Vec<(Shade, Vec3)> {
    let single = |bg: u8| {
        let shade = Shade {
            symbol: ' ',
            fg: bg,
            bg,
        };
        (shade, perceived(NAMED[usize::from(bg)]))
    };
    let mut all: Vec<_> = (0..16).map(single).collect();
    for bg in 0..16_u8 {
        for fg in bg + 1..16 {
            let [a, b] = [bg, fg].map(|i| NAMED[usize::from(i)]);
            // Black and white dots look like dots, not like grey.
            if perceived(a).distance(perceived(b)) > 0.66 {
                continue;
            }
            for (symbol, share) in SHADES {
                let light = to_linear(a).lerp(to_linear(b), share);
                all.push((Shade { symbol, fg, bg }, perceived(to_srgb(light))));
            }
        }
    }
    all
}

/// `colour` with 5 bits a channel, black and white unchanged.
#[must_use]
pub(super) fn five_bits(colour: [u8; 3]) -> [u8; 3] {
    colour.map(|x| x & 0xf8 | x >> 5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_of_256_is_the_nearest_of_all() {
        let axis: Vec<u8> = (0..=255).step_by(15).collect();
        for &r in &axis {
            for &g in &axis {
                for &b in &axis {
                    let colour = [r, g, b];
                    let distance = |i: u8| perceived(entry(i)).distance_squared(perceived(colour));
                    let found = nearest_256(colour);
                    assert!(found >= 16);
                    assert!(
                        (16..=255).all(|i| distance(found) <= distance(i)),
                        "{colour:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn entries_are_their_own_nearest() {
        for index in 16..=255 {
            assert_eq!(entry(nearest_256(entry(index))), entry(index));
        }
        for index in 0..16 {
            assert_eq!(nearest_16(NAMED[usize::from(index)]), index);
            let shade = nearest_shade(NAMED[usize::from(index)]);
            assert_eq!((shade.symbol, shade.bg), (' ', index));
        }
    }

    #[test]
    fn a_grey_surface_that_darkens_stays_grey() {
        for x in 0..=255 {
            let [r, g, b] = entry(nearest_256([x; 3]));
            assert!(r == g && g == b, "{x}");
        }
    }

    #[test]
    fn shades_lie_between_their_colours() {
        let dim = nearest_shade([64, 64, 64]);
        assert_eq!((dim.bg, dim.fg), (0, 8));
        assert!(['░', '▒'].contains(&dim.symbol), "{dim:?}");
    }

    #[test]
    fn five_bits_keep_black_and_white_and_leave_32_levels() {
        let levels: std::collections::BTreeSet<_> =
            (0..=255).map(|x| five_bits([x; 3])[0]).collect();
        assert_eq!(levels.len(), 32);
        assert_eq!(five_bits([255, 0, 255]), [255, 0, 255]);
    }
}
