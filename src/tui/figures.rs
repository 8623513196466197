//! Figures as short texts.

/// Bytes in MiB.
#[must_use]
pub fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
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
