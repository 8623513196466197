//! Images in another size: each new pixel is the average, in linear light, of the area that it covers.

use crate::geometry::Vec3;
use crate::shade::{Image, to_linear, to_srgb};

/// The pixels of one axis that a new pixel covers, with the share of each; shares add up to the old length.
type Span = Vec<(usize, u64)>;

/// `image` as `columns` by `rows` pixels. Where a new pixel covers one old one it is that, byte for byte. An image
/// without pixels is black.
pub(super) fn resampled(image: &Image, columns: usize, rows: usize) -> Vec<[u8; 3]> {
    let (width, height) = (image.width as usize, image.height as usize);
    if image.pixels.is_empty() {
        return vec![[0; 3]; columns * rows];
    }
    let across = spans(width, columns);
    let down = spans(height, rows);
    let light: Vec<Vec3> = (0..=255).map(|byte| to_linear([byte; 3])).collect();
    let area = (width * height) as f32;
    let average = |columns: &Span, rows: &Span| {
        if let ([(column, _)], [(row, _)]) = (&columns[..], &rows[..]) {
            return image.pixels[row * width + column];
        }
        let mut sum = Vec3::ZERO;
        for &(row, high) in rows {
            for &(column, wide) in columns {
                let [r, g, b] = image.pixels[row * width + column].map(|x| light[usize::from(x)].x);
                sum += Vec3::new(r, g, b) * (wide * high) as f32;
            }
        }
        to_srgb(sum / area)
    };
    down.iter()
        .flat_map(|row| across.iter().map(move |column| (column, row)))
        .map(|(column, row)| average(column, row))
        .collect()
}

/// What each of `new` equal parts covers of `old` equal parts of the same length, in units of 1 / (`old` · `new`).
fn spans(old: usize, new: usize) -> Vec<Span> {
    (0..new)
        .map(|i| {
            let (start, end) = (i * old, (i + 1) * old);
            (start / new..end.div_ceil(new))
                .map(|p| {
                    let overlap = end.min((p + 1) * new) - start.max(p * new);
                    (p, overlap as u64)
                })
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_cover_everything_once() {
        for (old, new) in [(4, 3), (3, 4), (8, 8), (7, 2), (1, 5)] {
            let spans = spans(old, new);
            assert!(
                spans
                    .iter()
                    .all(|span| span.iter().map(|s| s.1).sum::<u64>() == old as u64)
            );
            for p in 0..old {
                let shares = spans.iter().flatten().filter(|s| s.0 == p).map(|s| s.1);
                assert_eq!(shares.sum::<u64>(), new as u64);
            }
        }
    }

    #[test]
    fn the_same_size_is_the_same_image() {
        let pixels = (0..12).map(|i| [i * 20, 255 - i, 7]).collect();
        let image = Image {
            width: 4,
            height: 3,
            pixels,
        };
        assert_eq!(resampled(&image, 4, 3), image.pixels);
    }

    #[test]
    fn half_black_half_white_is_half_the_light() {
        let image = Image {
            width: 2,
            height: 1,
            pixels: vec![[0; 3], [255; 3]],
        };
        assert_eq!(resampled(&image, 1, 1), [[188; 3]]);
    }
}
