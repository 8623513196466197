//! Legends: what the colours of a picture of numbers mean.

use std::fmt;

use super::color_map::ColorMap;

/// How numbers are spread over a colour map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences look equal.
    Linear,
    /// Equal ratios look equal; counts are taken one higher, so that 0 has a place.
    Log,
}

impl fmt::Display for Scale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linear => "linear scale",
            Self::Log => "log scale",
        })
    }
}

/// The range of the numbers in a picture and how they became colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// What the numbers are.
    pub title: &'static str,
    /// Least number.
    pub min: f32,
    /// Median.
    pub median: f32,
    /// Mean.
    pub mean: f32,
    /// Greatest number.
    pub max: f32,
    /// How they are spread over the map.
    pub scale: Scale,
    /// The colours.
    pub map: ColorMap,
    /// The least number has the map's upper end.
    pub reversed: bool,
    /// Added before a logarithm is taken: 1 for counts.
    shift: f32,
}

/// How a channel wants its numbers shown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ramp {
    /// What the numbers are.
    pub title: &'static str,
    /// The colours.
    pub map: ColorMap,
    /// Least numbers at the map's upper end.
    pub reversed: bool,
    /// Whether the numbers are counts, which may be 0.
    pub counts: bool,
}

impl Legend {
    /// The legend of `numbers`, NaN left out; `None` where nothing is left.
    ///
    /// Logarithmic where the greatest is more than eight times the median: linear colours would show only the peaks.
    pub(super) fn of(ramp: Ramp, numbers: &[f32]) -> Option<Self> {
        let mut known: Vec<f32> = numbers.iter().copied().filter(|x| !x.is_nan()).collect();
        if known.is_empty() {
            return None;
        }
        let (min, max) = known
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), &x| {
                (lo.min(x), hi.max(x))
            });
        let mean = known.iter().map(|&x| f64::from(x)).sum::<f64>() / known.len() as f64;
        let middle = (known.len() - 1) / 2;
        let (_, &mut median, _) = known.select_nth_unstable_by(middle, f32::total_cmp);
        let shift = if ramp.counts { 1.0 } else { 0.0 };
        let uneven = min + shift > 0.0 && (max + shift) > 8.0 * (median + shift);
        Some(Self {
            title: ramp.title,
            min,
            median,
            mean: mean as f32,
            max,
            scale: if uneven { Scale::Log } else { Scale::Linear },
            map: ramp.map,
            reversed: ramp.reversed,
            shift,
        })
    }

    /// Least number, median and greatest number, as written beside a picture.
    #[must_use]
    pub fn labels(&self) -> [String; 3] {
        [self.min, self.median, self.max].map(label)
    }

    /// Where `number` lies between `min` (0) and `max` (1); 0 where these are equal.
    #[must_use]
    pub fn position(&self, number: f32) -> f32 {
        let (part, whole) = match self.scale {
            Scale::Linear => (number - self.min, self.max - self.min),
            Scale::Log => {
                let log = |x: f32| (x + self.shift).ln();
                (log(number) - log(self.min), log(self.max) - log(self.min))
            }
        };
        if whole > 0.0 { part / whole } else { 0.0 }
    }

    /// The colour at a position between 0 and 1 of the range.
    #[must_use]
    pub fn colour_at(&self, position: f32) -> [u8; 3] {
        self.map.at(if self.reversed {
            1.0 - position
        } else {
            position
        })
    }

    /// The colour of `number`.
    #[must_use]
    pub fn colour(&self, number: f32) -> [u8; 3] {
        self.colour_at(self.position(number))
    }
}

/// As written beside a picture: `cells per ray: 1 … median 12 … 57, linear scale`.
impl fmt::Display for Legend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [min, median, max] = self.labels();
        let Self { title, scale, .. } = self;
        write!(f, "{title}: {min} … median {median} … {max}, {scale}")
    }
}

/// A number in few characters: whole where it is whole, else three significant digits.
fn label(number: f32) -> String {
    let size = number.abs();
    if number.fract() == 0.0 && size < 1e6 {
        format!("{number}")
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{number:.decimals$}")
    } else {
        format!("{number:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::{GREY, INFERNO};

    const COUNTS: Ramp = Ramp {
        title: "tests",
        map: INFERNO,
        reversed: false,
        counts: true,
    };

    #[test]
    fn even_numbers_get_a_linear_scale() {
        let legend = Legend::of(COUNTS, &[0.0, 5.0, 10.0, f32::NAN]).unwrap();
        assert_eq!(
            (legend.min, legend.median, legend.max, legend.mean),
            (0.0, 5.0, 10.0, 5.0)
        );
        assert_eq!(legend.scale, Scale::Linear);
        assert_eq!(legend.position(2.5), 0.25);
        assert_eq!(legend.to_string(), "tests: 0 … median 5 … 10, linear scale");
    }

    #[test]
    fn numbers_with_far_peaks_get_a_logarithmic_scale() {
        let legend = Legend::of(COUNTS, &[0.0, 3.0, 1023.0]).unwrap();
        assert_eq!(legend.scale, Scale::Log);
        assert_eq!(legend.position(0.0), 0.0);
        assert!((legend.position(31.0) - 0.5).abs() < 1e-6);
        assert_eq!(legend.position(1023.0), 1.0);
    }

    #[test]
    fn equal_numbers_have_one_colour_and_no_numbers_have_no_legend() {
        let legend = Legend::of(COUNTS, &[4.0; 3]).unwrap();
        assert_eq!(legend.colour(4.0), INFERNO.at(0.0));
        assert_eq!(Legend::of(COUNTS, &[f32::NAN]), None);
    }

    #[test]
    fn a_reversed_legend_shows_the_least_number_brightest() {
        let ramp = Ramp {
            map: GREY,
            reversed: true,
            ..COUNTS
        };
        let legend = Legend::of(ramp, &[1.0, 2.0]).unwrap();
        assert_eq!(legend.colour(1.0), GREY.at(1.0));
        assert_eq!(legend.colour(2.0), GREY.at(0.0));
    }

    #[test]
    fn labels_are_short() {
        let cases = [
            (0.0, "0"),
            (1234.0, "1234"),
            (12.345, "12.3"),
            (0.012_345, "0.0123"),
            (1e9, "1.00e9"),
        ];
        for (number, text) in cases {
            assert_eq!(label(number), text);
        }
    }
}
