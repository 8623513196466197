//! Elementary functions from `+ − × ÷` alone, so that scenes have the same bits on every machine.
//!
//! The system's `sin`, `exp` and `cbrt` may differ in the last place between platforms; IEEE 754 fixes only the four
//! operations and the square root. Good to about 1e-15, which is far below `f32`.

/// Cosine and sine of `part`/`whole` of a full turn; exact at quarter turns.
pub fn turn(part: u32, whole: u32) -> (f64, f64) {
    // Reduced in whole numbers to an eighth of a turn at most, on either side of a quarter.
    let part = u64::from(part % whole) * 4;
    let whole = u64::from(whole);
    let quarter = (part + whole / 2) / whole;
    let angle =
        (part as f64 - (quarter * whole) as f64) / whole as f64 * std::f64::consts::FRAC_PI_2;
    let (cos, sin) = series(angle);
    match quarter % 4 {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    }
}

/// Cosine and sine of an angle of at most an eighth of a turn, by their power series.
fn series(x: f64) -> (f64, f64) {
    let (mut cos, mut sin) = (0.0, 0.0);
    let mut term = 1.0;
    // Terms fall below 1e-20 before the 18th.
    for k in 0..18 {
        match k % 4 {
            0 => cos += term,
            1 => sin += term,
            2 => cos -= term,
            _ => sin -= term,
        }
        term *= x / f64::from(k + 1);
    }
    (cos, sin)
}

/// e to the `x`, for |x| up to 10.
pub fn exp(x: f64) -> f64 {
    // The series of a 64th, squared six times.
    let part = x / 64.0;
    let (mut sum, mut term) = (0.0, 1.0);
    for k in 0..20 {
        sum += term;
        term *= part / f64::from(k + 1);
    }
    (0..6).fold(sum, |y, _| y * y)
}

/// The `n`-th root of `x` in (0, 1e12], by Newton's method.
pub fn root(x: f64, n: u32) -> f64 {
    let power = |y: f64, n: u32| (0..n).fold(1.0, |p, _| p * y);
    // From above, it falls towards the root until rounding stops it.
    let mut y = x.max(1.0);
    loop {
        let next = y - (y - x / power(y, n - 1)) / f64::from(n);
        if next < y {
            y = next;
        } else {
            return y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_those_of_the_library_and_exact_at_quarters() {
        for whole in [1, 2, 3, 4, 5, 7, 12, 144, 256, 1000] {
            for part in 0..2 * whole {
                let angle = std::f64::consts::TAU * f64::from(part) / f64::from(whole);
                let (cos, sin) = turn(part, whole);
                assert!((cos - angle.cos()).abs() < 1e-14, "{part}/{whole}");
                assert!((sin - angle.sin()).abs() < 1e-14, "{part}/{whole}");
            }
        }
        assert_eq!([turn(0, 4), turn(1, 4)], [(1.0, 0.0), (-0.0, 1.0)]);
        assert_eq!([turn(2, 4), turn(3, 4)], [(-1.0, -0.0), (0.0, -1.0)]);
    }

    #[test]
    fn powers_and_roots_are_those_of_the_library() {
        for x in [-3.0, -0.5, 0.0, 1.0, 7.0] {
            assert!((exp(x) / f64::exp(x) - 1.0).abs() < 1e-14, "{x}");
        }
        for x in [1e-10, 0.3, 1.0, 8.0, 2e7] {
            assert!((root(x, 3) / f64::cbrt(x) - 1.0).abs() < 1e-14, "{x}");
            assert!(
                (root(x, 6) / f64::powf(x, 1.0 / 6.0) - 1.0).abs() < 1e-13,
                "{x}"
            );
        }
    }
}
