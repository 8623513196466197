//! Straight lines through points, by least squares.

/// A line `y = at_zero + slope · x`, and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Rise a unit of x.
    pub slope: f64,
    /// y at x = 0.
    pub at_zero: f64,
    /// Coefficient of determination: the share of the variance of y that the line explains, 0 to 1; 1 where all y are
    /// equal.
    pub r2: f64,
    /// How many points it was fitted to.
    pub points: usize,
}

impl Line {
    /// The line that fits `points` best in the sense of least squares of vertical distances.
    ///
    /// `None` for fewer than two distinct x, or where a coordinate is not finite.
    #[must_use]
    pub fn through(points: &[(f64, f64)]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        // Around the means, so that large offsets cost no digits.
        let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|p| of(p.0 - x, p.1 - y)).sum()
        };
        let (xx, xy, yy) = (sum(&|a, _| a * a), sum(&|a, b| a * b), sum(&|_, b| b * b));
        // NaN is not greater than 0 either.
        if !(xx > 0.0 && xx.is_finite() && yy.is_finite()) {
            return None;
        }
        let slope = xy / xx;
        Some(Self {
            slope,
            at_zero: y - slope * x,
            r2: if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 },
            points: points.len(),
        })
    }

    /// y of the line at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.at_zero + self.slope * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_give_that_line() {
        let points = [-1.0, 0.5, 2.0, 1e3].map(|x| (x, 3.0 - 2.0 * x));
        let line = Line::through(&points).unwrap();
        assert!((line.slope + 2.0).abs() < 1e-12 && (line.at_zero - 3.0).abs() < 1e-9);
        assert!((line.r2 - 1.0).abs() < 1e-12 && (line.at(7.0) + 11.0).abs() < 1e-9);
        assert_eq!(line.points, 4);
    }

    #[test]
    fn the_squares_of_vertical_distances_are_least() {
        // By hand: means 1 and 4/3, xx = 2, xy = 1, yy = 14/3.
        let line = Line::through(&[(0.0, 0.0), (1.0, 3.0), (2.0, 1.0)]).unwrap();
        assert!((line.slope - 0.5).abs() < 1e-12 && (line.at_zero - 5.0 / 6.0).abs() < 1e-12);
        assert!((line.r2 - 3.0 / 28.0).abs() < 1e-12);
    }

    #[test]
    fn a_level_line_explains_everything() {
        let line = Line::through(&[(0.0, 2.0), (5.0, 2.0)]).unwrap();
        assert_eq!((line.slope, line.r2), (0.0, 1.0));
    }

    #[test]
    fn what_determines_no_line_gives_none() {
        let none: [&[(f64, f64)]; 5] = [
            &[],
            &[(1.0, 1.0)],
            &[(1.0, 1.0), (1.0, 2.0)],
            &[(1.0, 1.0), (f64::NAN, 2.0)],
            &[(1.0, 1.0), (2.0, f64::INFINITY)],
        ];
        for points in none {
            assert_eq!(Line::through(points), None, "{points:?}");
        }
    }
}
