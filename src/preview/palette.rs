//! Nearest palette entries: 256 colours, 16 colours, 5 bits a channel.
//!
//! Distance is squared, in sRGB, with red, green and blue weighted 2 : 4 : 3, about as the eye notices them. The weights
//! keep the axes apart, so the nearest entry of the cube is found one axis at a time.
//!
//! **Source:** ISO 8613-6 and xterm for the palettes; Riemersma, "Colour metric" (2008), for the weights.

/// Weights of red, green and blue.
const WEIGHTS: [i32; 3] = [2, 4, 3];

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

/// Weighted squared distance.
fn distance(a: [u8; 3], b: [u8; 3]) -> i32 {
    (0..3)
        .map(|i| WEIGHTS[i] * (i32::from(a[i]) - i32::from(b[i])).pow(2))
        .sum()
}

/// The colour of an entry from 16 to 255; black for the others, which differ from terminal to terminal.
#[must_use]
pub(super) fn entry(index: u8) -> [u8; 3] {
    match index {
        0..=15 => [0; 3],
        16..=231 => {
            let i = usize::from(index - 16);
            [LEVELS[i / 36], LEVELS[i / 6 % 6], LEVELS[i % 6]]
        }
        _ => [8 + 10 * (index - 232); 3],
    }
}

/// The entry from 16 to 255 of the 256-colour palette that is nearest to `colour`; the cube before the greys, the lower
/// index before the higher where two are equally near.
#[must_use]
pub fn nearest_256(colour: [u8; 3]) -> u8 {
    // The nearest level of each axis; halfway the lower one.
    let level = |x: u8| {
        LEVELS
            .windows(2)
            .filter(|pair| u16::from(x) * 2 > u16::from(pair[0]) + u16::from(pair[1]))
            .count() as u8
    };
    let [r, g, b] = colour.map(level);
    let cube = 16 + 36 * r + 6 * g + b;
    // Among greys the distance is least at the weighted mean, and grows to both sides of it.
    let sum: i32 = (0..3).map(|i| WEIGHTS[i] * i32::from(colour[i])).sum();
    let mean = f64::from(sum) / f64::from(WEIGHTS.iter().sum::<i32>());
    let step = ((mean - 8.0) / 10.0).round().clamp(0.0, 23.0) as u8;
    let grey = 232 + step;
    if distance(entry(grey), colour) < distance(entry(cube), colour) {
        grey
    } else {
        cube
    }
}

/// The one of the sixteen named colours, 0–15, that is nearest to `colour` as xterm shows them; the lower of equals.
#[must_use]
pub fn nearest_16(colour: [u8; 3]) -> u8 {
    (0..16u8)
        .min_by_key(|&i| distance(NAMED[usize::from(i)], colour))
        .unwrap_or_default()
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
        // Every colour on a grid that holds all levels' surroundings and both ends.
        let axis: Vec<u8> = (0..=255).step_by(5).chain([254]).collect();
        for &r in &axis {
            for &g in &axis {
                for &b in &axis {
                    let colour = [r, g, b];
                    let least = (16..=255).map(|i| distance(entry(i), colour)).min();
                    let found = nearest_256(colour);
                    assert!(found >= 16);
                    assert_eq!(Some(distance(entry(found), colour)), least, "{colour:?}");
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
        }
    }

    #[test]
    fn five_bits_keep_black_and_white_and_leave_32_levels() {
        let levels: std::collections::BTreeSet<_> =
            (0..=255).map(|x| five_bits([x; 3])[0]).collect();
        assert_eq!(levels.len(), 32);
        assert_eq!(five_bits([255, 0, 255]), [255, 0, 255]);
    }
}
