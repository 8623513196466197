//! Colour maps: how a number between 0 and 1 becomes a colour. Lightness rises with the number all the way, so that a
//! map still reads in grey, by colour-blind eyes, and as a ramp of characters.

/// Colours at equal distances from 0 to 1, interpolated in sRGB between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ColorMap {
    /// Kebab-case name.
    pub name: &'static str,
    stops: &'static [[u8; 3]],
}

/// Black over purple and orange to pale yellow.
///
/// **Source:** Smith, van der Walt, Firing, "inferno" of matplotlib (CC0), at nine stops.
pub const INFERNO: ColorMap = ColorMap {
    name: "inferno",
    stops: &[
        [0, 0, 4],
        [33, 12, 74],
        [86, 16, 110],
        [137, 34, 106],
        [187, 55, 84],
        [227, 89, 50],
        [249, 140, 10],
        [249, 201, 50],
        [252, 255, 164],
    ],
};

/// Dark grey to white: the dark end stays above black, so that what is far is not taken for the background.
pub const GREY: ColorMap = ColorMap {
    name: "grey",
    stops: &[[40, 42, 46], [250, 250, 248]],
};

impl ColorMap {
    /// The colour at `x`, which is moved into 0..1; NaN is 0.
    #[must_use]
    pub fn at(&self, x: f32) -> [u8; 3] {
        let last = self.stops.len() - 1;
        // A comparison with NaN is false.
        let place = if x > 0.0 { x.min(1.0) } else { 0.0 } * last as f32;
        let below = (place as usize).min(last - 1);
        let share = place - below as f32;
        let (a, b) = (self.stops[below], self.stops[below + 1]);
        std::array::from_fn(|i| {
            let (a, b) = (f32::from(a[i]), f32::from(b[i]));
            (a + (b - a) * share + 0.5) as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::to_linear;

    #[test]
    fn every_map_gets_lighter_all_the_way() {
        for map in [INFERNO, GREY] {
            let luminance = |i: usize| {
                let [r, g, b] = to_linear(map.at(i as f32 / 64.0)).to_array();
                0.2126 * r + 0.7152 * g + 0.0722 * b
            };
            assert!(
                (1..=64).all(|i| luminance(i) > luminance(i - 1)),
                "{}",
                map.name
            );
        }
    }

    #[test]
    fn the_ends_are_the_outer_stops_and_nothing_lies_beyond() {
        assert_eq!(INFERNO.at(0.0), [0, 0, 4]);
        assert_eq!(INFERNO.at(1.0), [252, 255, 164]);
        assert_eq!(INFERNO.at(9.0), INFERNO.at(1.0));
        assert_eq!(INFERNO.at(-9.0), INFERNO.at(0.0));
        assert_eq!(INFERNO.at(f32::NAN), INFERNO.at(0.0));
    }
}
