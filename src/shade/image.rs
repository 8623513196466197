//! Images in sRGB, and how light becomes bytes.
//!
//! **Source:** IEC 61966-2-1 (sRGB) for the transfer function.

use thiserror::Error;

use crate::geometry::Vec3;

/// Rows of sRGB pixels, the upper left one first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` colours: red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

/// Why there is no image.
#[derive(Debug, Error)]
pub enum ImageError {
    /// A written size that is none.
    #[error("'{0}' is not a size; write width x height in pixels, each from 1 to {max}, e.g. 640x480", max = Image::MAX_SIDE)]
    Size(String),
    /// PNG knows no image without pixels.
    #[error("an image of {width}x{height} pixels cannot be encoded; both sides must be at least 1")]
    Empty {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The encoder refused.
    #[error("the image could not be encoded as PNG: {0}")]
    Encoding(#[from] png::EncodingError),
}

impl Image {
    /// Longest side that is rendered: 16384, at most 1 GB of pixels and numbers at work.
    pub const MAX_SIDE: u32 = 1 << 14;

    /// An image of one colour.
    #[must_use]
    pub fn filled(width: u32, height: u32, colour: [u8; 3]) -> Self {
        Self {
            width,
            height,
            pixels: vec![colour; width as usize * height as usize],
        }
    }

    /// The colour of the pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// The pixel lies outside the image.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The image as a PNG file: 8 bits a channel, marked as sRGB.
    ///
    /// # Errors
    /// An image without pixels.
    pub fn png(&self) -> Result<Vec<u8>, ImageError> {
        if self.pixels.is_empty() {
            return Err(ImageError::Empty {
                width: self.width,
                height: self.height,
            });
        }
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// Reads a size written as `640x480`.
///
/// # Errors
/// Anything else, a side of 0, or one longer than [`Image::MAX_SIDE`].
pub fn parse_size(text: &str) -> Result<(u32, u32), ImageError> {
    let side = |text: &str| match text.trim().parse::<u32>() {
        Ok(side) if (1..=Image::MAX_SIDE).contains(&side) => Some(side),
        _ => None,
    };
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| ImageError::Size(text.to_owned()))
}

/// The sRGB bytes of linear light; 0..1 is the range of the screen, what lies outside is cut off, NaN is black.
#[must_use]
pub fn to_srgb(light: Vec3) -> [u8; 3] {
    light.to_array().map(|x| {
        let encoded = if x <= 0.003_130_8 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        };
        // A float becomes an integer by cutting off, out of range by the nearest bound, NaN as 0.
        (encoded * 255.0 + 0.5) as u8
    })
}

/// The linear light of sRGB bytes, 0..1.
#[must_use]
pub fn to_linear(colour: [u8; 3]) -> Vec3 {
    Vec3::from_array(colour.map(|byte| {
        let encoded = f32::from(byte) / 255.0;
        if encoded <= 0.040_45 {
            encoded / 12.92
        } else {
            ((encoded + 0.055) / 1.055).powf(2.4)
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_to_light_and_back() {
        for byte in 0..=255 {
            assert_eq!(to_srgb(to_linear([byte; 3])), [byte; 3]);
        }
    }

    #[test]
    fn light_out_of_range_is_cut_off_and_nan_is_black() {
        let light = Vec3::new(-1.0, 7.0, f32::NAN);
        assert_eq!(to_srgb(light), [0, 255, 0]);
        assert_eq!(to_srgb(Vec3::splat(0.214_041_14)), [128; 3]);
    }

    #[test]
    fn a_png_holds_the_pixels_that_were_put_in() {
        let mut image = Image::filled(3, 2, [10, 20, 30]);
        image.pixels[4] = [255, 0, 128];
        let bytes = image.png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; 3 * 2 * 3];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (3, 2));
        assert_eq!(pixels, image.pixels.as_flattened());
    }

    #[test]
    fn an_image_without_pixels_is_refused_with_its_size() {
        let message = Image::filled(0, 7, [0; 3]).png().unwrap_err().to_string();
        assert!(message.contains("0x7"), "{message}");
    }

    #[test]
    fn sizes_are_read_and_nonsense_is_refused() {
        assert_eq!(parse_size("640x480").unwrap(), (640, 480));
        for bad in ["", "640", "0x4", "4x0", "axb", "1x99999", "-1x4", "4x4x4"] {
            let message = parse_size(bad).unwrap_err().to_string();
            assert!(message.contains("640x480"), "{message}");
        }
    }
}
