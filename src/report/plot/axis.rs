//! A logarithmic axis: what range it shows, which values get a tick, and how they are written.
//!
//! ```text
//!   zero row   break        ticks, evenly spaced in log
//!      |        //     |---------|---------|---------|
//!      0              0.1        1         10       100
//! ```
//!
//! Zeros have no place on it; where they occur, a row below the range takes them.

use std::ops::Range;

/// Which numbers are round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Base {
    /// 1, 2, 4, 8, …
    Two,
    /// Decades, split into 1-2-5 where there is room.
    Ten,
}

/// A labelled place on the axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    pub label: String,
}

/// Range and ticks of an axis. `0 < lo < hi`, both finite.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    pub lo: f64,
    pub hi: f64,
    /// The value at whose place zeros are drawn; inside `lo..hi`, below [`Axis::bottom`]. `None` without zeros.
    pub zero: Option<f64>,
    /// Lowest value that the logarithmic part shows.
    pub bottom: f64,
    /// By rising value.
    pub ticks: Vec<Tick>,
    /// Places between the labelled ones, by rising value.
    pub minor: Vec<f64>,
}

/// Values beyond these are drawn at them: products and ratios of what lies between stay finite.
const LEAST: f64 = 1e-120;
const GREATEST: f64 = 1e120;

impl Axis {
    /// An axis that shows all `values` (not NaN, at least 0) on `pixels`, with labels at least `gap` pixels apart.
    pub fn new(values: impl IntoIterator<Item = f64>, base: Base, pixels: f64, gap: f64) -> Self {
        let (mut zeros, mut least, mut greatest) = (false, f64::INFINITY, 0.0_f64);
        for value in values.into_iter().filter(|v| !v.is_nan()) {
            if value <= 0.0 {
                zeros = true;
            } else {
                let value = value.clamp(LEAST, GREATEST);
                least = least.min(value);
                greatest = greatest.max(value);
            }
        }
        if greatest == 0.0 {
            (least, greatest) = (1.0, 10.0);
        }
        let Range {
            start: bottom,
            end: hi,
        } = padded(least, greatest, base);
        // The zero row takes a sixth of the height, half of it above the row.
        let step = (hi / bottom).powf(1.0 / 10.0);
        let (lo, zero) = if zeros {
            (bottom / (step * step), Some(bottom / step))
        } else {
            (bottom, None)
        };
        let scale = pixels / (hi / lo).ln();
        let (mut ticks, minor) = ticks(bottom..hi, base, scale, gap);
        if zero.is_some() {
            let label = "0".to_owned();
            ticks.insert(0, Tick { value: 0.0, label });
        }
        Self {
            lo,
            hi,
            zero,
            bottom,
            ticks,
            minor,
        }
    }

    /// Where `value` is drawn: itself within the range, else the nearest place of the axis.
    pub fn place(&self, value: f64) -> f64 {
        match self.zero {
            Some(zero) if value <= 0.0 => zero,
            _ => value.clamp(self.bottom, self.hi),
        }
    }
}

/// The range around `least..=greatest` with room at both ends, and wide enough to have ticks.
fn padded(least: f64, greatest: f64, base: Base) -> Range<f64> {
    // A curve that is flat within its noise shall look flat: at least a third between bottom and top.
    let (min_ratio, share) = match base {
        Base::Two => (4.0, 0.03),
        Base::Ten => (1.35, 0.06),
    };
    let ratio = greatest / least;
    let widen = if ratio < min_ratio {
        (min_ratio / ratio).sqrt()
    } else {
        1.0
    };
    let pad = widen * ratio.max(min_ratio).powf(share);
    least / pad..greatest * pad
}

/// Labelled ticks and minor places in `range`, with `scale` pixels a unit of the natural logarithm.
fn ticks(range: Range<f64>, base: Base, scale: f64, gap: f64) -> (Vec<Tick>, Vec<f64>) {
    let fits = |values: &[f64]| values.windows(2).all(|w| (w[1] / w[0]).ln() * scale >= gap);
    let tick = |values: &[f64]| -> Vec<Tick> {
        // One way of writing an axis: beside 10⁶, 100 is 10².
        let plain = values.iter().all(|v| (1e-3..1e6).contains(v));
        let write = if plain { number } else { scientific };
        let tick = |&value| Tick {
            value,
            label: write(value),
        };
        values.iter().map(tick).collect()
    };
    let round: Vec<Vec<f64>> = match base {
        Base::Two => (1..=16).map(|k| powers(&range, 2.0, k, &[1.0])).collect(),
        Base::Ten => {
            let mut sets = vec![
                powers(&range, 10.0, 1, &[1.0, 2.0, 5.0]),
                powers(&range, 10.0, 1, &[1.0, 3.0]),
            ];
            sets.extend((1..=80).map(|k| powers(&range, 10.0, k, &[1.0])));
            sets
        }
    };
    // Linear steps where the range is too short for round numbers of the logarithm.
    let linear: Vec<Vec<f64>> = if range.end / range.start < 4.0 {
        [10, 8, 6, 5, 4, 3, 2]
            .iter()
            .map(|&count| steps(&range, count, base))
            .collect()
    } else {
        Vec::new()
    };
    let enough = |least: usize| {
        round
            .iter()
            .chain(&linear)
            .find(|values| values.len() >= least && fits(values))
    };
    let labelled = enough(3)
        .or_else(|| enough(2))
        .or_else(|| enough(1))
        .cloned()
        .unwrap_or_default();
    let decades = base == Base::Ten && labelled.len() > 1 && labelled[1] / labelled[0] > 9.0;
    // Nine small places a decade say "logarithmic" without words, unless they would run together.
    let minor = if decades && scale * (10.0_f64 / 9.0).ln() > 1.5 {
        let all = powers(
            &range,
            10.0,
            1,
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        );
        all.into_iter().filter(|v| !labelled.contains(v)).collect()
    } else if base == Base::Two {
        let all = powers(&range, 2.0, 1, &[1.0]);
        all.into_iter().filter(|v| !labelled.contains(v)).collect()
    } else {
        Vec::new()
    };
    (tick(&labelled), minor)
}

/// `multiples` of every `k`th power of `base` within `range`.
fn powers(range: &Range<f64>, base: f64, k: i32, multiples: &[f64]) -> Vec<f64> {
    let log = |x: f64| (x.ln() / base.ln()).floor() as i32;
    (log(range.start)..=log(range.end) + 1)
        .filter(|e| e.rem_euclid(k) == 0)
        .flat_map(|e| multiples.iter().map(move |m| exact(*m, base, e)))
        .filter(|v| range.contains(v))
        .collect()
}

/// `m · base^e`, rounded once where that is possible, so that 0.001 is the number written so.
fn exact(m: f64, base: f64, e: i32) -> f64 {
    if e < 0 {
        m / base.powi(-e)
    } else {
        m * base.powi(e)
    }
}

/// About `count` linear steps of 1, 2 or 5 times a power of ten within `range`.
fn steps(range: &Range<f64>, count: usize, base: Base) -> Vec<f64> {
    let raw = (range.end - range.start) / count as f64;
    let decade = raw.log10().floor() as i32;
    let step = [1.0, 2.0, 5.0, 10.0]
        .iter()
        .map(|m| exact(*m, 10.0, decade))
        .find(|s| *s >= raw)
        .unwrap_or(raw);
    // Resolutions are whole.
    let step = if base == Base::Two {
        step.max(1.0)
    } else {
        step
    };
    let first = (range.start / step).ceil() as i64;
    let last = (range.end / step).floor() as i64;
    (first..=last)
        .map(|i| {
            let value = i as f64 * step;
            // Whole multiples of 0.1 are not exact; the nearest number of 12 digits is the one meant.
            format!("{value:.12e}").parse().unwrap_or(value)
        })
        .filter(|v: &f64| *v > 0.0 && range.contains(v))
        .collect()
}

/// A number as axes and tables write it: `0.25`, `1,024`, `10⁶`, `2·10⁻⁵`.
pub(in crate::report) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return scientific(value);
    }
    // Six significant digits, without the zeros that say nothing.
    let decimals = (5 - magnitude.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let mut grouped = String::new();
    let digits = whole.trim_start_matches('-');
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    let sign = if value < 0.0 { "−" } else { "" };
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{grouped}{point}{fraction}")
}

/// A measured value in three significant digits.
pub(in crate::report) fn measured(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return number(value);
    }
    let decimals = 2 - value.abs().log10().floor() as i32;
    let text = if decimals > 0 && value.abs() >= 1e-3 {
        // The digits say how exact it is: 2.50, not 2.5.
        return format!("{value:.*}", decimals as usize);
    } else {
        format!("{value:.2e}")
    };
    number(text.parse().unwrap_or(value))
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.5e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    let power: String = exponent
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            '9' => '⁹',
            _ => '⁰',
        })
        .collect();
    match mantissa {
        _ if power == "⁰" => mantissa.replacen('-', "−", 1),
        "1" => format!("10{power}"),
        mantissa => format!("{mantissa}·10{power}").replacen('-', "−", 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64], base: Base) -> Vec<String> {
        Axis::new(values.iter().copied(), base, 320.0, 24.0)
            .ticks
            .into_iter()
            .map(|t| t.label)
            .collect()
    }

    #[test]
    fn resolutions_get_powers_of_two() {
        assert_eq!(
            labels(&[1.0, 256.0], Base::Two),
            ["1", "2", "4", "8", "16", "32", "64", "128", "256"]
        );
        assert_eq!(labels(&[16.0], Base::Two), ["8", "16", "32"]);
    }

    #[test]
    fn one_decade_is_split_and_many_are_not() {
        assert_eq!(labels(&[1.0, 30.0], Base::Ten), ["1", "2", "5", "10", "20"]);
        assert_eq!(
            labels(&[0.01, 30_000.0], Base::Ten),
            ["0.01", "0.1", "1", "10", "100", "1,000", "10,000"]
        );
    }

    #[test]
    fn a_narrow_range_still_has_three_ticks_or_more() {
        for values in [[10.0, 10.1], [9.7, 11.4], [0.000_31, 0.000_32], [5e8, 6e8]] {
            let labels = labels(&values, Base::Ten);
            assert!(labels.len() >= 3, "{values:?}: {labels:?}");
        }
        assert!(labels(&[30.0, 40.0], Base::Two).len() >= 2);
    }

    #[test]
    fn an_axis_writes_its_numbers_in_one_way() {
        assert_eq!(
            labels(&[1e-4, 1e6], Base::Ten),
            [
                "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1", "10¹", "10²", "10³", "10⁴", "10⁵", "10⁶"
            ]
        );
    }

    #[test]
    fn a_huge_range_is_thinned_and_stays_finite() {
        for values in [[1e-9, 1e12], [5e-324, f64::MAX], [1.0, f64::INFINITY]] {
            let axis = Axis::new(values, Base::Ten, 320.0, 24.0);
            assert!(axis.lo > 0.0 && axis.hi.is_finite() && axis.lo < axis.hi);
            assert!((3..=14).contains(&axis.ticks.len()), "{:?}", axis.ticks);
        }
    }

    #[test]
    fn zeros_get_a_row_below_the_range() {
        let axis = Axis::new([0.0, 1.0, 100.0], Base::Ten, 320.0, 24.0);
        let zero = axis.zero.unwrap();
        assert!(axis.lo < zero && zero < axis.bottom && axis.bottom < 1.0);
        assert_eq!(axis.ticks[0].label, "0");
        assert_eq!(axis.place(axis.ticks[0].value), zero);
        assert_eq!(axis.place(0.0), zero);
        assert_eq!(axis.place(10.0), 10.0);
    }

    #[test]
    fn without_values_there_is_still_an_axis() {
        assert!(Axis::new([], Base::Ten, 320.0, 24.0).ticks.len() >= 2);
        let zeros = Axis::new([0.0], Base::Ten, 320.0, 24.0);
        assert!(zeros.zero.is_some());
    }

    #[test]
    fn numbers_are_written_as_readers_expect() {
        for (value, text) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (0.001, "0.001"),
            (1024.0, "1,024"),
            (999_999.0, "999,999"),
            (1e6, "10⁶"),
            (2e-5, "2·10⁻⁵"),
            (0.1 + 0.2, "0.3"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(measured(14.237), "14.2");
        assert_eq!(measured(2.5), "2.50");
        assert_eq!(measured(1_239.6), "1,240");
        assert_eq!(measured(0.031_24), "0.0312");
    }
}
