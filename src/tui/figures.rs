//! Figures as short texts.

/// Bytes in MiB.
#[must_use]
pub fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// As [`figure`]; a dash for what was not counted.
#[must_use]
pub fn counted(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), figure)
}

/// A figure with three significant digits, so that columns stay narrow: `0.0123`, `1.23`, `12.3`, `123`, `12.3k`, `1.2M`.
#[must_use]
pub fn figure(x: f64) -> String {
    let size = x.abs();
    match size {
        _ if !x.is_finite() => "-".to_owned(),
        _ if size == 0.0 => "0".to_owned(),
        _ if size < 0.000_95 => format!("{x:.0e}"),
        _ if size < 0.0995 => format!("{x:.4}"),
        _ if size < 9.995 => format!("{x:.2}"),
        _ if size < 99.95 => format!("{x:.1}"),
        _ if size < 9_999.5 => format!("{x:.0}"),
        _ if size < 999_500.0 => format!("{:.1}k", x / 1e3),
        _ if size < 999.5e6 => format!("{:.1}M", x / 1e6),
        _ => format!("{:.1}G", x / 1e9),
    }
}

/// A share in percent: `0.018 %`, `12 %`, `0 %`.
#[must_use]
pub fn percent(share: f64) -> String {
    format!("{} %", figure(share * 100.0))
}

/// A number with so many digits that it can be told from others of a range that is `span` wide: four beyond the span's
/// first, and at most those of an `f64`.
#[must_use]
pub fn fine(x: f64, span: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return format!("{x}");
    }
    let power = x.abs().log10().floor();
    let span = if span.is_finite() && span > 0.0 {
        span.log10().floor()
    } else {
        power
    };
    let digits = (power - span + 3.0).clamp(3.0, 16.0) as i32;
    let power = power as i32;
    if (-4..7).contains(&power) {
        let decimals = (digits - power).clamp(0, 20) as usize;
        format!("{x:.decimals$}")
    } else {
        let decimals = digits as usize;
        format!("{x:.decimals$e}")
    }
}

/// Seconds as `0:07`, `2:41` or `1:02:03`.
#[must_use]
pub fn clock(seconds: f64) -> String {
    let s = seconds.clamp(0.0, 359_999.0).round() as u64;
    if s >= 3600 {
        format!("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
    } else {
        format!("{}:{:02}", s / 60, s % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_narrow_range_get_the_digits_that_tell_them_apart() {
        for (x, span, text) in [
            (2.5, 1.0, "2.500"),
            (1234.5, 1.0, "1234.500"),
            (10_000.25, 1e-3, "10000.250000"),
            (0.0, 1.0, "0"),
            (1.5e-30, 1e-30, "1.500e-30"),
            (f64::INFINITY, 1.0, "inf"),
            (3.0, f64::NAN, "3.000"),
            (-250.0, 1000.0, "-250.0"),
        ] {
            assert_eq!(fine(x, span), text);
        }
    }

    #[test]
    fn figures_have_three_digits_and_stay_narrow() {
        for (x, text) in [
            (0.0, "0"),
            (0.000_012, "1e-5"),
            (0.0123, "0.0123"),
            (1.234, "1.23"),
            (12.34, "12.3"),
            (99.96, "100"),
            (1234.4, "1234"),
            (12_340.0, "12.3k"),
            (1.25e6, "1.2M"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(figure(x), text);
        }
        assert_eq!(clock(7.2), "0:07");
        assert_eq!(clock(3723.0), "1:02:03");
        assert_eq!(clock(f64::INFINITY), "99:59:59");
    }
}
