//! Colours, markers and dashes. A line is told from the others by all three, so none of them is needed alone.
//!
//! **Source:** Okabe and Ito 2008, "Color universal design": a palette that colour-blind readers can tell apart.
//! **Differs:** its yellow is left out (invisible as a thin line on white); on dark ground its blue is lighter, and its
//! black is the colour of the text.

use plotters::style::RGBColor;

/// The colours of a figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Theme {
    pub ground: RGBColor,
    pub ink: RGBColor,
    pub muted: RGBColor,
    pub grid: RGBColor,
    pub axis: RGBColor,
    pub lines: [RGBColor; 7],
}

const fn rgb(hex: u32) -> RGBColor {
    RGBColor((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// Dark on white, for paper.
pub(super) const LIGHT: Theme = Theme {
    ground: rgb(0xFF_FFFF),
    ink: rgb(0x1B_1F24),
    muted: rgb(0x5B_636D),
    grid: rgb(0xE7_E9EC),
    axis: rgb(0x9A_A1A9),
    lines: [
        rgb(0x00_72B2), // blue
        rgb(0xD5_5E00), // vermillion
        rgb(0x00_9E73), // bluish green
        rgb(0xCC_79A7), // reddish purple
        rgb(0xE6_9F00), // orange
        rgb(0x56_B4E9), // sky blue
        rgb(0x2A_2E33), // black
    ],
};

/// Light on dark, for screens. The same places hold the same roles as in [`LIGHT`].
pub(super) const DARK: Theme = Theme {
    ground: rgb(0x0F_1318),
    ink: rgb(0xE8_ECF0),
    muted: rgb(0x9C_A6B0),
    grid: rgb(0x25_2B33),
    axis: rgb(0x68_717C),
    lines: [
        rgb(0x3A_94DB),
        rgb(0xE8_702A),
        rgb(0x14_B387),
        rgb(0xD6_8AB5),
        rgb(0xEB_AC1D),
        rgb(0x7C_C6F0),
        rgb(0xD5_DADF),
    ],
};

impl Theme {
    /// All colours, in an order that is the same for every theme.
    pub fn colours(&self) -> Vec<RGBColor> {
        let mut all = vec![self.ground, self.ink, self.muted, self.grid, self.axis];
        all.extend(self.lines);
        all
    }
}

/// A colour as SVG writes it.
pub(super) fn hex(colour: RGBColor) -> String {
    format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2)
}

/// A rule that gives an SVG drawn in [`LIGHT`] the colours of [`DARK`] where the reader prefers dark.
pub(super) fn dark_style() -> String {
    let mut rules = Vec::new();
    for (light, dark) in LIGHT.colours().into_iter().zip(DARK.colours()) {
        for attribute in ["fill", "stroke"] {
            let (light, dark) = (hex(light), hex(dark));
            rules.push(format!("[{attribute}=\"{light}\"]{{{attribute}:{dark}}}"));
        }
    }
    let rules = rules.concat();
    format!("<style>@media (prefers-color-scheme:dark){{{rules}}}</style>")
}

/// Shape drawn at a line's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    Up,
    Diamond,
    Down,
    Cross,
    Plus,
    Ring,
}

const MARKERS: [Marker; 8] = [
    Marker::Circle,
    Marker::Square,
    Marker::Up,
    Marker::Diamond,
    Marker::Down,
    Marker::Cross,
    Marker::Plus,
    Marker::Ring,
];

/// Lengths of dash, gap, dash, gap … in pixels; empty is unbroken.
const DASHES: [&[f64]; 4] = [&[7.0, 3.0], &[2.0, 2.5], &[9.0, 2.5, 2.0, 2.5], &[4.0, 2.0]];

/// How a line looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Look {
    /// Index into [`Theme::lines`].
    pub colour: usize,
    pub marker: Marker,
    /// Index among all lines of a report.
    index: usize,
}

impl Look {
    /// The look of the line with this index: no two of the first 56 share both colour and marker.
    pub fn of(index: usize) -> Self {
        // 7 colours and 8 markers have no common factor, so stepping through both at once meets every pair.
        Self {
            colour: index % 7,
            marker: MARKERS[index % MARKERS.len()],
            index,
        }
    }

    /// Dashes of the line: lines over n are unbroken while there are few, level lines never are.
    pub fn dashes(self, level: bool) -> &'static [f64] {
        match (level, self.index / 7) {
            (true, _) => DASHES[self.index % DASHES.len()],
            (false, 0) => &[],
            (false, round) => DASHES[(round - 1) % DASHES.len()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Contrast of two colours, 1 to 21 (WCAG 2).
    fn contrast(a: RGBColor, b: RGBColor) -> f64 {
        let luminance = |c: RGBColor| {
            let linear = |x: u8| (f64::from(x) / 255.0).powf(2.2);
            0.2126 * linear(c.0) + 0.7152 * linear(c.1) + 0.0722 * linear(c.2)
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn texts_and_lines_stand_out_from_the_ground() {
        for theme in [LIGHT, DARK] {
            assert!(contrast(theme.ink, theme.ground) > 12.0);
            assert!(contrast(theme.muted, theme.ground) > 4.5);
            for line in theme.lines {
                assert!(contrast(line, theme.ground) > 2.0, "{}", hex(line));
            }
        }
    }

    #[test]
    fn colours_of_a_theme_are_distinct_so_that_they_can_be_exchanged() {
        for theme in [LIGHT, DARK] {
            let distinct: HashSet<String> = theme.colours().into_iter().map(hex).collect();
            assert_eq!(distinct.len(), theme.colours().len());
        }
    }

    #[test]
    fn fifty_lines_differ_in_colour_or_marker() {
        let looks: HashSet<String> = (0..56)
            .map(|i| format!("{} {:?}", Look::of(i).colour, Look::of(i).marker))
            .collect();
        assert_eq!(looks.len(), 56);
    }
}
