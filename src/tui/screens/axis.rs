//! Logarithmic axes of charts: where a value lies in cells and dots, and round ticks.

/// An axis: logarithms of its ends, to whatever base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    pub lo: f64,
    pub hi: f64,
}

impl Axis {
    /// The column, of `columns`, in which a logarithm lies: that of its braille dot, two a column.
    pub fn column(self, x: f64, columns: u16) -> u16 {
        self.dot(x, columns * 2) / 2
    }

    /// The row from above, of `rows`, in which a logarithm lies: that of its braille dot, four a row.
    pub fn row(self, y: f64, rows: u16) -> u16 {
        self.dot(self.hi - (y - self.lo), rows * 4) / 4
    }

    fn dot(self, x: f64, dots: u16) -> u16 {
        let last = f64::from(dots.saturating_sub(1));
        let share = (x - self.lo) / (self.hi - self.lo);
        (share * last).round().clamp(0.0, last) as u16
    }

    pub fn ends(self) -> [f64; 2] {
        [self.lo, self.hi]
    }

    /// Ticks at 1, 2 and 5 times powers of ten, at most one in two of `rows`; at powers alone where these would be too many.
    pub fn ticks(self, rows: u16) -> Vec<(f64, String)> {
        let most = (rows / 2).max(2) as usize;
        let decades = || self.lo.floor() as i32..=self.hi.ceil() as i32;
        let within = |values: Vec<f64>| -> Vec<(f64, String)> {
            values
                .into_iter()
                .map(|v| (v.log10(), short(v)))
                .filter(|(log, _)| (self.lo..=self.hi).contains(log))
                .collect()
        };
        let fine = within(
            decades()
                .flat_map(|d| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(d)))
                .collect(),
        );
        if fine.len() <= most {
            return fine;
        }
        let mut step = 1;
        loop {
            let coarse = within(
                decades()
                    .filter(|d| d.rem_euclid(step) == 0)
                    .map(|d| 10f64.powi(d))
                    .collect(),
            );
            if coarse.len() <= most || step > 64 {
                return coarse;
            }
            step *= 2;
        }
    }
}

/// A tick's value without digits that say nothing: `0.05`, `2`, `500`, `10k`.
pub fn short(value: f64) -> String {
    match value {
        v if v >= 0.999e9 => format!("{}G", (v / 1e9).round()),
        v if v >= 0.999e6 => format!("{}M", (v / 1e6).round()),
        v if v >= 0.999e4 => format!("{}k", (v / 1e3).round()),
        v if v >= 0.999 => format!("{}", v.round()),
        v if v >= 0.000_999 => {
            let digits = (-v.log10()).ceil().max(1.0) as usize;
            format!("{v:.digits$}")
        }
        v => format!("{v:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few_enough() {
        let names = |lo: f64, hi: f64, rows| -> Vec<String> {
            let axis = Axis {
                lo: lo.log10(),
                hi: hi.log10(),
            };
            axis.ticks(rows).into_iter().map(|t| t.1).collect()
        };
        assert_eq!(names(0.9, 60.0, 20), ["1", "2", "5", "10", "20", "50"]);
        assert_eq!(names(0.04, 300.0, 10), ["0.1", "1", "10", "100"]);
        assert_eq!(names(0.015, 0.06, 10), ["0.02", "0.05"]);
        assert!(names(1e-300, 1e300, 10).len() <= 10);
    }
}
